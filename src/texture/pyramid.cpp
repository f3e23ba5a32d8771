#include "texture/pyramid.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/parallel.h"

namespace burnish {

namespace {

/// Calls body(begin, end, coarse) for intervals of the flagged floats of a level in [begin, end);
/// all, where flags are empty. coarse: the sum of the coarser levels there; null for the coarsest
/// level.
template <class Body>
void for_sums(const Prolongation& prolongation, const LevelState& level, const Image* coarser,
              std::span<const char> flags, std::size_t begin, std::size_t end, const Body& body) {
    std::vector<float> coarse(coarser ? end - begin : 0), row;
    for_dirty_intervals(flags, begin, end, [&](std::size_t from, std::size_t to) {
        if (!coarser) return body(from, to, nullptr);
        prolong(prolongation, level.borders, *coarser, level.values.width, from, to, row,
                 coarse.data());
        body(from, to, coarse.data());
    });
}

/// The level that is next coarser than `level`; null for the coarsest.
LevelState* coarser_than(TextureParameters& parameters, std::size_t level) {
    return level + 1 < parameters.levels.size() ? &parameters.levels[level + 1] : nullptr;
}

/// Marks the segments of a level whose sum a step may change from now on: those that read changed
/// ones of the next coarser level, each of which is passed on once. coarser: null for the coarsest.
void mark_moving(const Prolongation& prolongation, LevelState* coarser, LevelState& level) {
    level.unknown_inputs.resize(dirty_blocks_in(level.values.values.size()));
    if (!coarser) return;
    DirtyBlocks& passed = coarser->passed;
    passed.resize(coarser->unknown_inputs.size());
    for (std::size_t s = 0; s < passed.size(); ++s)
        if (coarser->unknown_inputs[s] && !passed[s]) {
            const std::size_t end = std::min(coarser->values.values.size(), (s + 1) * kDirtyBlock);
            mark_readers(prolongation, coarser->values, s * kDirtyBlock, end, level.values, level.unknown_inputs);
            passed[s] = 1;
        }
}

/// And those of [begin, end) whose own parameters move.
void mark_active(std::size_t begin, std::size_t end, LevelState& level) {
    for (std::size_t s = begin / kDirtyBlock; s < dirty_blocks_in(end); ++s)
        level.unknown_inputs[s] |= level.optimizer.active[s];
}

/// The sum of each level with all coarser ones, but of the finest, brought up to date.
void sum_levels(TextureParameters& parameters) {
    for (std::size_t i = parameters.levels.size() - 1; i > 0; --i) {
        LevelState& level = parameters.levels[i];
        LevelState* coarser = coarser_than(parameters, i);
        const bool first = level.sum.width == 0;
        reshape(level.sum, level.values.width, level.values.height, level.values.channels);
        mark_moving(parameters.prolongation, coarser, level);
        const auto add = [&](std::size_t begin, std::size_t end, const float* coarse) {
            for (std::size_t k = begin; k < end; ++k)
                level.sum.values[k] = level.values.values[k] + (coarse ? coarse[k - begin] : 0.0f);
        };
        const std::span<const char> all, unknown_inputs = level.unknown_inputs;
        parallel_chunks(level.values.values.size(), kParallelFloats,
                        [&](std::size_t begin, std::size_t end) {
                            mark_active(begin, end, level);
                            for_sums(parameters.prolongation, level, coarser ? &coarser->sum : nullptr,
                                     first ? all : unknown_inputs, begin, end, add);
                        });
    }
}

GradientSpans spans_of(const SplitGradient& gradient) {
    return {gradient.first.values, gradient.second.values, gradient.reached};
}

/// Counts the texels of a run of floats whose gradient is not zero.
template <std::size_t kChannels>
void count_texels(const SplitGradient& gradient, std::size_t begin, std::size_t end,
                  std::vector<std::uint32_t>& visits) {
    const float* __restrict a = gradient.first.values.data();
    const float* __restrict b = gradient.second.width > 0 ? gradient.second.values.data() : a;
    std::uint32_t* __restrict counts = visits.data();
    for_dirty_intervals(gradient.reached, begin, end, [&](std::size_t from, std::size_t to) {
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

/// Where the finest level of a pyramid starts, as OptimizerState::home.
std::vector<float> home_of(const Image& initial) {
    const std::vector<float>& v = initial.values;
    std::vector<float> home(v.begin(),
                            v.begin() + static_cast<std::ptrdiff_t>(std::min(v.size(), kDirtyBlock)));
    const bool repeats =
        std::equal(v.begin() + static_cast<std::ptrdiff_t>(home.size()), v.end(), v.begin());
    return repeats ? home : v;
}

/// The least agreement of a texel's channels.
float min_gate(const LevelState& level, int x, int y) {
    float least = 1;
    for (int c = 0; c < level.values.channels; ++c) {
        const std::size_t i = level.values.index(x, y) + static_cast<std::size_t>(c);
        least = std::min(least, snr_gate(level.optimizer.second[i], level.optimizer.noise[i]));
    }
    return least;
}

}  // namespace

TextureParameters encode(const ParameterizationOptions& options, const Image& initial,
                         const ChartMap& charts, bool repeats) {
    TextureParameters p;
    p.prolongation = {options.upsampling, repeats};
    if (options.kind == Parameterization::kSmooth) {
        p.links = link_texels(initial.width, initial.height, charts);
        p.smoothing_length = options.smoothing_length;
    }
    p.levels.push_back({initial, {}, {}, {}, {}, {}, {}});
    p.visits.resize(initial.values.size() / static_cast<std::size_t>(initial.channels));
    ChartMap finer_charts = charts;
    const auto larger_side = [](const Image& image) { return std::max(image.width, image.height); };
    while (options.kind == Parameterization::kPyramid &&
           static_cast<int>(p.levels.size()) < options.pyramid_levels &&
           larger_side(p.levels.back().values) > 1) {
        const Image& last = p.levels.back().values;
        Image coarse = make_image(half(last.width), half(last.height), last.channels);
        if (!charts.empty()) {
            ChartMap coarse_charts = halve(finer_charts, last.width, last.height);
            p.levels.back().borders =
                find_borders(p.prolongation, finer_charts, coarse_charts, last.width, last.height);
            finer_charts = std::move(coarse_charts);
        }
        p.levels.push_back({std::move(coarse), {}, {}, {}, {}, {}, {}});
    }
    if (p.levels.size() > 1) p.snr_prior = options.snr_prior;
    if (p.levels.size() > 1 && options.weight_decay > 0) {
        p.weight_decay = options.weight_decay;
        p.levels.front().optimizer.home = home_of(initial);
    }
    return p;
}

Image decode(const TextureParameters& parameters) {
    Image texture = parameters.levels.back().values;
    for (std::size_t i = parameters.levels.size() - 1; i-- > 0;) {
        const LevelState& level = parameters.levels[i];
        Image finer = level.values;
        parallel_chunks(finer.values.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
            for_sums(parameters.prolongation, level, &texture, {}, begin, end,
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

Image confidence(const TextureParameters& parameters) {
    const Image& finest = parameters.levels.front().values;
    if (parameters.levels.front().optimizer.noise.empty()) return {};
    Image result = make_image(finest.width, finest.height, 1);
    for (std::size_t i = 0; i < parameters.levels.size(); ++i) {
        const LevelState& level = parameters.levels[i];
        for (int y = 0; y < result.height; ++y)
            for (int x = 0; x < result.width; ++x) {
                float& most = result.values[result.index(x, y)];
                most = std::max(most, min_gate(level, x >> i, y >> i));
            }
    }
    return result;
}

namespace {

void descend_levels(const OptimizerOptions& options, const SplitGradient& gradient,
                    TextureParameters& parameters, Image& texture) {
    auto& levels = parameters.levels;
    OptimizerOptions detail = options;
    detail.decay = parameters.weight_decay;
    detail.snr_prior = parameters.snr_prior;
    for (std::size_t i = 1; i < levels.size(); ++i) {
        LevelState& level = levels[i];
        restrict_level(parameters.prolongation, levels[i - 1].borders,
                 i == 1 ? gradient : levels[i - 1].gradient, level.gradient);
        const bool coarsest = i + 1 == levels.size();
        step(coarsest ? options : detail, spans_of(level.gradient), level.optimizer,
             level.values.values);
    }
    sum_levels(parameters);

    LevelState& finest = levels.front();
    LevelState* coarser = coarser_than(parameters, 0);
    std::vector<float>& x = finest.values.values;
    begin_step(detail, x.size(), finest.optimizer);
    mark_moving(parameters.prolongation, coarser, finest);
    // The finest level takes back what leaves the range, so that the parameters never run away
    // behind the clamp.
    const auto clamp_sum = [&](std::size_t begin, std::size_t end, const float* coarse) {
        for (std::size_t k = begin; k < end; ++k) {
            const float sum = x[k] + (coarse ? coarse[k - begin] : 0.0f);
            const float clamped = std::clamp(sum, 0.0f, 1.0f);
            x[k] += clamped - sum;
            texture.values[k] = clamped;
        }
    };
    parallel_chunks(x.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        step_part(detail, spans_of(gradient), finest.optimizer, x, begin, end);
        mark_active(begin, end, finest);
        for_sums(parameters.prolongation, finest, coarser ? &coarser->sum : nullptr, finest.unknown_inputs,
                 begin, end, clamp_sum);
        count_visits(gradient, begin, end, parameters.visits);
    });
}

/// lambda of a step, counted from 0: the length stays for a few steps, then shrinks as 1 / step
/// down to a texel, from coarse to fine while samples gather.
float smoothing_at(const TextureParameters& parameters, std::uint32_t step) {
    constexpr float kSteps = 4, kMin = 1;
    const float first = parameters.smoothing_length;
    const float length =
        std::clamp(first * kSteps / static_cast<float>(step + 1), std::min(kMin, first), first);
    return length * length;
}

/// With u the parameters and the texture x = B u, B = rows^-1 columns^-1: the gradient by u is the
/// transpose of B times that by x, and x moves by B times the step of u. u itself is never needed,
/// so that lambda may change from step to step and the clamp acts on the texture.
void descend_smoothly(const OptimizerOptions& options, const SplitGradient& gradient,
                      TextureParameters& parameters, Image& texture) {
    LevelState& level = parameters.levels.front();
    const float lambda = smoothing_at(parameters, level.optimizer.steps);
    const auto transposed = [&](const Image& from, Image& to) {
        to = from;
        smooth_rows(parameters.links, lambda, to);
        smooth_columns(parameters.links, lambda, to);
    };
    transposed(gradient.first, level.gradient.first);
    if (gradient.second.width > 0) transposed(gradient.second, level.gradient.second);

    Image& change = level.sum;
    reshape(change, texture.width, texture.height, texture.channels);
    std::fill(change.values.begin(), change.values.end(), 0.0f);
    step(options, spans_of(level.gradient), level.optimizer, change.values);
    smooth_columns(parameters.links, lambda, change);
    smooth_rows(parameters.links, lambda, change);

    std::vector<float>& x = level.values.values;
    parallel_chunks(x.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            texture.values[k] = x[k] = std::clamp(x[k] + change.values[k], 0.0f, 1.0f);
        count_visits(gradient, begin, end, parameters.visits);
    });
}

}  // namespace

void descend(const OptimizerOptions& options, const SplitGradient& gradient,
             TextureParameters& parameters, Image& texture) {
    const bool smooth = parameters.links.width > 0;
    (smooth ? descend_smoothly : descend_levels)(options, gradient, parameters, texture);
}

}  // namespace burnish
