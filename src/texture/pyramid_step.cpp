#include "texture/pyramid_step.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "texture/restriction.h"

namespace burnish {

namespace {

/// A level with what lies beside it.
struct Level {
    LevelState& state;
    LevelWorkspace& work;
    const LevelPart& part;
    const ChartBorders& borders;  ///< how it reads the next coarser level

    const Image& values() const { return state.values; }
    std::size_t floats() const { return values().index(0, values().height); }
};

std::vector<Level> levels_of(const PyramidStep& step, PyramidState& state,
                             PyramidWorkspace& workspace) {
    static const ChartBorders kNone;
    workspace.levels.resize(state.levels.size());
    std::vector<Level> levels;
    for (std::size_t i = 0; i < state.levels.size(); ++i) {
        levels.push_back({state.levels[i], workspace.levels[i], step.part[i],
                          i < step.maps.borders.size() ? step.maps.borders[i] : kNone});
        levels.back().work.dirty.resize(dirty_blocks_in(levels.back().floats()));
    }
    return levels;
}

/// The level's options: the coarsest has no decay.
AdamOptions options_of(const PyramidStep& step, std::size_t level) {
    AdamOptions options = step.options;
    if (level + 1 == step.part.size()) options.weight_decay = 0;
    return options;
}

/// The gradient by the coarser levels.
void restrict_all(const PyramidStep& step, const SplitGradient& gradient,
                  std::vector<Level>& levels) {
    const auto kept = [&](const Level& l) {
        return KeptLevel{{l.values().width, l.values().height}, l.values().channels, l.part.read};
    };
    for (std::size_t i = 1; i < levels.size(); ++i)
        restrict_gradient(step.maps.prolongation, levels[i - 1].borders, kept(levels[i - 1]),
                          i == 1 ? gradient : levels[i - 1].work.gradient, kept(levels[i]),
                          levels[i].work.gradient);
}

/// Of each level, over all parts.
std::vector<RootSum> sum_roots(const PyramidStep& step, const std::vector<Level>& levels) {
    std::vector<RootSum> roots;
    for (const Level& level : levels) roots.push_back(root_sum(level.state.adam));
    if (!step.exchange.add_up || step.options.damping == 0) return roots;
    std::vector<double> sums;
    for (const RootSum& r : roots) {
        sums.insert(sums.end(), r.sum.limbs.begin(), r.sum.limbs.end());
        sums.push_back(r.count);
    }
    step.exchange.add_up(sums);
    auto next = sums.begin();
    for (RootSum& r : roots) {
        for (double& limb : r.sum.limbs) limb = *next++;
        r.count = *next++;
    }
    return roots;
}

/// Of a level's own floats.
GradientSpans spans_of(const Level& level, const SplitGradient& gradient) {
    const IndexRange& own = level.part.own;
    if (own.size() == 0) return {};
    const std::size_t at = level.part.read.place_of(own.begin);
    const auto part = [&](const auto& array, std::size_t per) {
        return array.empty() ? std::span(array)
                             : std::span(array).subspan(at / per, entries_of(own, per).size());
    };
    return {part(gradient.first.values, 1), part(gradient.second.values, 1),
            part(gradient.dirty, kDirtyBlock)};
}

/// Marks the blocks among own floats [begin, end), counted from the first own one, whose parameters
/// move.
void mark_visited(std::size_t begin, std::size_t end, Level& level) {
    char* dirty = level.work.dirty.data() + level.part.own.begin / kDirtyBlock;
    for (std::size_t s = begin / kDirtyBlock; s < dirty_blocks_in(end); ++s)
        dirty[s] |= level.state.adam.visited[s];
}

void step_coarser(const PyramidStep& step, const std::vector<RootSum>& roots,
                  std::vector<Level>& levels) {
    std::vector<MovedFloats> moved;
    for (std::size_t i = 1; i < levels.size(); ++i) {
        Level& level = levels[i];
        const IndexRange& own = level.part.own;
        burnish::step(options_of(step, i), spans_of(level, level.work.gradient), roots[i],
                      level.state.adam,
                      std::span(level.state.values.values).subspan(own.begin, own.size()));
        mark_visited(0, own.size(), level);
        moved.push_back({level.state.values.values, level.work.dirty});
    }
    if (step.exchange.share_moved && !moved.empty()) step.exchange.share_moved(moved);
}

/// Marks the blocks of a level that read dirty ones of the next coarser level, each of which is
/// propagated once. coarser: null for the coarsest.
void mark_readers_of_dirty(const Prolongation& prolongation, const Level* coarser, Level& level) {
    if (!coarser) return;
    DirtyBlocks& propagated = coarser->work.propagated;
    propagated.resize(coarser->work.dirty.size());
    for (std::size_t s = 0; s < propagated.size(); ++s)
        if (coarser->work.dirty[s] && !propagated[s]) {
            const std::size_t end = std::min(coarser->floats(), (s + 1) * kDirtyBlock);
            mark_readers(prolongation, coarser->values(), s * kDirtyBlock, end, level.values(),
                         level.work.dirty);
            propagated[s] = 1;
        }
}

/// Brings the sum of a level with all coarser ones up to date. coarser: null for the coarsest.
void sum_level(const Prolongation& prolongation, const Level* coarser, Level& level) {
    const Image& values = level.values();
    Image& sum = level.work.sum;
    const bool first = sum.width == 0;
    reshape(sum, values.width, values.height, values.channels);
    mark_readers_of_dirty(prolongation, coarser, level);
    const auto add = [&](std::size_t begin, std::size_t end, const float* coarse) {
        for (std::size_t k = begin; k < end; ++k)
            sum.values[k] = values.values[k] + (coarse ? coarse[k - begin] : 0.0f);
    };
    const std::span<const char> all, dirty = level.work.dirty;
    parallel_chunks(level.floats(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        for_prolonged(prolongation, level.borders, values.width,
                      coarser ? &coarser->work.sum : nullptr, first ? all : dirty, begin, end, add);
    });
}

/// Counts the texels of an interval of floats whose gradient is not zero.
template <std::size_t kChannels>
void count_texels(const GradientSpans& gradient, std::size_t begin, std::size_t end,
                  std::vector<std::uint32_t>& visits) {
    const float* __restrict a = gradient.first.data();
    const float* __restrict b = gradient.second.empty() ? a : gradient.second.data();
    std::uint32_t* __restrict counts = visits.data();
    for_dirty_intervals(gradient.dirty, begin, end, [&](std::size_t from, std::size_t to) {
        for (std::size_t texel = from / kChannels; texel < to / kChannels; ++texel) {
            float any = 0;
            for (std::size_t k = texel * kChannels; k < (texel + 1) * kChannels; ++k)
                any += std::abs(a[k]) + std::abs(b[k]);
            counts[texel] += any != 0;
        }
    });
}

/// Steps the own floats of the finest level and sums the texture there, in one pass over both. The
/// level takes back what leaves the range, so that the parameters never run away behind the clamp.
void step_finest(const PyramidStep& step, const RootSum& roots, const Level* coarser, Level& finest,
                 const SplitGradient& whole, std::vector<std::uint32_t>& visits, Image& texture) {
    const AdamOptions options = options_of(step, 0);
    const Prolongation& prolongation = step.maps.prolongation;
    const GradientSpans gradient = spans_of(finest, whole);
    const std::size_t first = finest.part.own.begin;
    std::vector<float>& x = finest.state.values.values;  // own ones alone
    begin_step(options, x.size(), roots, finest.state.adam);
    mark_readers_of_dirty(prolongation, coarser, finest);
    const auto clamp_sum = [&](std::size_t begin, std::size_t end, const float* coarse) {
        for (std::size_t k = begin; k < end; ++k) {
            float& own = x[k - first];
            const float sum = own + (coarse ? coarse[k - begin] : 0.0f);
            const float clamped = std::clamp(sum, 0.0f, 1.0f);
            own += clamped - sum;
            texture.values[k] = clamped;
        }
    };
    parallel_chunks(x.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        step_part(options, gradient, finest.state.adam, x, begin, end);
        mark_visited(begin, end, finest);
        for_prolonged(prolongation, finest.borders, texture.width,
                      coarser ? &coarser->work.sum : nullptr, finest.work.dirty, first + begin,
                      first + end, clamp_sum);
        (texture.channels == 1 ? count_texels<1> : count_texels<3>)(gradient, begin, end, visits);
    });
    if (step.exchange.share_moved) step.exchange.share_moved({{texture.values, finest.work.dirty}});
}

}  // namespace

void descend(const PyramidStep& step, const SplitGradient& gradient, PyramidState& state,
             PyramidWorkspace& workspace, Image& texture) {
    std::vector<Level> levels = levels_of(step, state, workspace);
    restrict_all(step, gradient, levels);
    const std::vector<RootSum> roots = sum_roots(step, levels);
    step_coarser(step, roots, levels);
    const auto coarser = [&](std::size_t i) {
        return i + 1 < levels.size() ? &levels[i + 1] : nullptr;
    };
    for (std::size_t i = levels.size() - 1; i > 0; --i)
        sum_level(step.maps.prolongation, coarser(i), levels[i]);
    step_finest(step, roots[0], coarser(0), levels[0], gradient, state.visits, texture);
}

}  // namespace burnish
