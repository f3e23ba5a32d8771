#include "texture/pyramid.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "texture/restriction.h"

namespace burnish {

namespace {

/// A level with what lies beside it.
struct Level {
    LevelState& state;
    LevelWorkspace& work;
    const ChartBorders& borders;  ///< how it reads the next coarser level

    std::size_t floats() const { return state.values.values.size(); }
};

Level level_at(const PyramidMaps& maps, PyramidState& state, PyramidWorkspace& workspace,
               std::size_t i) {
    static const ChartBorders kNone;
    return {state.levels[i], workspace.levels[i],
            i < maps.borders.size() ? maps.borders[i] : kNone};
}

/// Calls body(begin, end, coarse) for intervals of the flagged floats of a level in [begin, end);
/// all, where flags are empty. coarse: the sum of the coarser levels there; null for the coarsest
/// level.
template <class Body>
void for_sums(const Prolongation& prolongation, const ChartBorders& borders, int width,
              const Image* coarser, std::span<const char> flags, std::size_t begin, std::size_t end,
              const Body& body) {
    std::vector<float> coarse(coarser ? end - begin : 0), row;
    for_dirty_intervals(flags, begin, end, [&](std::size_t from, std::size_t to) {
        if (!coarser) return body(from, to, nullptr);
        prolong(prolongation, borders, *coarser, width, from, to, row, coarse.data());
        body(from, to, coarse.data());
    });
}

/// Marks the blocks of a level that read dirty ones of the next coarser level, each of which is
/// propagated once. coarser: null for the coarsest.
void mark_readers_of_dirty(const Prolongation& prolongation, const Level* coarser, Level& level) {
    level.work.dirty.resize(dirty_blocks_in(level.floats()));
    if (!coarser) return;
    DirtyBlocks& propagated = coarser->work.propagated;
    propagated.resize(coarser->work.dirty.size());
    for (std::size_t s = 0; s < propagated.size(); ++s)
        if (coarser->work.dirty[s] && !propagated[s]) {
            const std::size_t end = std::min(coarser->floats(), (s + 1) * kDirtyBlock);
            mark_readers(prolongation, coarser->state.values, s * kDirtyBlock, end,
                         level.state.values, level.work.dirty);
            propagated[s] = 1;
        }
}

/// And those of [begin, end) whose own parameters move.
void mark_visited(std::size_t begin, std::size_t end, Level& level) {
    for (std::size_t s = begin / kDirtyBlock; s < dirty_blocks_in(end); ++s)
        level.work.dirty[s] |= level.state.adam.visited[s];
}

/// Brings the sum of a level with all coarser ones up to date. coarser: null for the coarsest.
void sum_level(const Prolongation& prolongation, const Level* coarser, Level& level) {
    const Image& values = level.state.values;
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
        mark_visited(begin, end, level);
        for_sums(prolongation, level.borders, values.width, coarser ? &coarser->work.sum : nullptr,
                 first ? all : dirty, begin, end, add);
    });
}

GradientSpans spans_of(const SplitGradient& gradient) {
    return {gradient.first.values, gradient.second.values, gradient.dirty};
}

/// Counts the texels of an interval of floats whose gradient is not zero.
template <std::size_t kChannels>
void count_texels(const SplitGradient& gradient, std::size_t begin, std::size_t end,
                  std::vector<std::uint32_t>& visits) {
    const float* __restrict a = gradient.first.values.data();
    const float* __restrict b = gradient.second.width > 0 ? gradient.second.values.data() : a;
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

void count_visits(const SplitGradient& gradient, std::size_t begin, std::size_t end,
                  std::vector<std::uint32_t>& visits) {
    (gradient.first.channels == 1 ? count_texels<1> : count_texels<3>)(gradient, begin, end,
                                                                       visits);
}

/// Where the finest level starts, as AdamState::initial.
std::vector<float> initial_of(const Image& initial) {
    const std::vector<float>& v = initial.values;
    std::vector<float> block(
        v.begin(), v.begin() + static_cast<std::ptrdiff_t>(std::min(v.size(), kDirtyBlock)));
    const bool repeats =
        std::equal(v.begin() + static_cast<std::ptrdiff_t>(block.size()), v.end(), v.begin());
    return repeats ? block : v;
}

/// The least gate of a texel's channels.
float texel_gate(const LevelState& level, int x, int y) {
    float gate = 1;
    for (int c = 0; c < level.values.channels; ++c) {
        const std::size_t i = level.values.index(x, y) + static_cast<std::size_t>(c);
        gate = std::min(gate, snr_gate(level.adam.square[i], level.adam.noise[i]));
    }
    return gate;
}

/// Steps the finest level and sums the texture, in one pass over both. The level takes back what
/// leaves the range, so that the parameters never run away behind the clamp.
void descend_finest(const AdamOptions& options, const Prolongation& prolongation,
                    const Level* coarser, Level& finest, const SplitGradient& gradient,
                    std::vector<std::uint32_t>& visits, Image& texture) {
    std::vector<float>& x = finest.state.values.values;
    begin_step(options, x.size(), finest.state.adam);
    mark_readers_of_dirty(prolongation, coarser, finest);
    const auto clamp_sum = [&](std::size_t begin, std::size_t end, const float* coarse) {
        for (std::size_t k = begin; k < end; ++k) {
            const float sum = x[k] + (coarse ? coarse[k - begin] : 0.0f);
            const float clamped = std::clamp(sum, 0.0f, 1.0f);
            x[k] += clamped - sum;
            texture.values[k] = clamped;
        }
    };
    parallel_chunks(x.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        step_part(options, spans_of(gradient), finest.state.adam, x, begin, end);
        mark_visited(begin, end, finest);
        for_sums(prolongation, finest.borders, texture.width,
                 coarser ? &coarser->work.sum : nullptr, finest.work.dirty, begin, end, clamp_sum);
        count_visits(gradient, begin, end, visits);
    });
}

}  // namespace

PyramidMaps make_maps(int levels, int width, int height, const ChartMap& charts, bool repeats) {
    PyramidMaps maps;
    maps.prolongation.repeats = repeats;
    maps.sizes.push_back({width, height});
    ChartMap finer_charts = charts;
    while (static_cast<int>(maps.sizes.size()) < levels && std::max(width, height) > 1) {
        ChartBorders borders;
        if (!charts.empty()) {
            ChartMap coarse_charts = halve(finer_charts, width, height);
            borders = find_borders(maps.prolongation, finer_charts, coarse_charts, width, height);
            finer_charts = std::move(coarse_charts);
        }
        maps.borders.push_back(std::move(borders));
        width = half(width), height = half(height);
        maps.sizes.push_back({width, height});
    }
    return maps;
}

PyramidState encode(const PyramidMaps& maps, const Image& initial, bool decays) {
    PyramidState state;
    for (const auto& size : maps.sizes)
        state.levels.push_back({make_image(size.x, size.y, initial.channels), {}});
    state.levels.front().values = initial;
    state.visits.resize(initial.values.size() / static_cast<std::size_t>(initial.channels));
    if (decays && maps.sizes.size() > 1) state.levels.front().adam.initial = initial_of(initial);
    return state;
}

Image decode(const PyramidMaps& maps, const PyramidState& state) {
    Image texture = state.levels.back().values;
    for (std::size_t i = state.levels.size() - 1; i-- > 0;) {
        Image finer = state.levels[i].values;
        parallel_chunks(
            finer.values.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
                for_sums(maps.prolongation, maps.borders[i], finer.width, &texture, {}, begin, end,
                         [&](std::size_t from, std::size_t to, const float* coarse) {
                             for (std::size_t k = from; k < to; ++k)
                                 finer.values[k] += coarse[k - from];
                         });
            });
        texture = std::move(finer);
    }
    for (float& v : texture.values) v = std::clamp(v, 0.0f, 1.0f);
    return texture;
}

std::size_t restart(const Image& from, const Image& to, PyramidState& state, Image& texture) {
    LevelState& finest = state.levels.front();
    std::vector<float>& initial = finest.adam.initial;
    const std::size_t period = initial.size();
    if (from != to && period > 0 && period < to.values.size()) {
        initial.resize(to.values.size());
        for (std::size_t k = period; k < initial.size(); ++k) initial[k] = initial[k % period];
    }
    std::size_t texels = 0;
    const auto channels = static_cast<std::size_t>(to.channels);
    for (std::size_t k = 0, last = to.values.size(); k < to.values.size(); ++k) {
        if (from.values[k] == to.values[k]) continue;
        texels += k / channels != last, last = k / channels;
        finest.values.values[k] += to.values[k] - texture.values[k];
        texture.values[k] = to.values[k];
        if (period > 0) initial[k] = to.values[k];
        for (std::vector<float>* of : {&finest.adam.mean, &finest.adam.square, &finest.adam.noise})
            if (!of->empty()) (*of)[k] = 0;
    }
    return texels;
}

Image confidence(const PyramidState& state) {
    const Image& finest = state.levels.front().values;
    if (state.levels.front().adam.noise.empty()) return {};
    Image result = make_image(finest.width, finest.height, 1);
    for (std::size_t i = 0; i < state.levels.size(); ++i)
        for (int y = 0; y < result.height; ++y)
            for (int x = 0; x < result.width; ++x) {
                float& best = result.values[result.index(x, y)];
                best = std::max(best, texel_gate(state.levels[i], x >> i, y >> i));
            }
    return result;
}

void descend(const AdamOptions& options, const PyramidMaps& maps, const SplitGradient& gradient,
             PyramidState& state, PyramidWorkspace& workspace, Image& texture) {
    const std::size_t count = state.levels.size();
    workspace.levels.resize(count);
    AdamOptions coarsest = options;
    coarsest.weight_decay = coarsest.snr_prior = 0;
    for (std::size_t i = 1; i < count; ++i) {
        LevelState& level = state.levels[i];
        SplitGradient& coarse = workspace.levels[i].gradient;
        restrict_gradient(maps.prolongation, maps.borders[i - 1],
                          i == 1 ? gradient : workspace.levels[i - 1].gradient, coarse);
        step(i + 1 == count ? coarsest : options, spans_of(coarse), level.adam,
             level.values.values);
    }
    std::vector<Level> levels;
    for (std::size_t i = 0; i < count; ++i) levels.push_back(level_at(maps, state, workspace, i));
    for (std::size_t i = count - 1; i > 0; --i)
        sum_level(maps.prolongation, i + 1 < count ? &levels[i + 1] : nullptr, levels[i]);
    descend_finest(count > 1 ? options : coarsest, maps.prolongation,
                   count > 1 ? &levels[1] : nullptr, levels[0], gradient, state.visits, texture);
}

}  // namespace burnish
