#include "burnish/inverse/parameterization.h"

#include <algorithm>
#include <array>
#include <utility>

#include "burnish/core/parallel.h"

namespace burnish {

namespace {

int half(int size) { return (size + 1) / 2; }

/// The two coarse texels that a fine one interpolates, on one axis: bilinear, texel centres at (i +
/// 1/2) / size, clamped. The near one has the weight 3/4, the far one 1/4.
constexpr float kNear = 0.75f, kFar = 0.25f;
struct Taps {
    int near = 0, far = 0;
};

Taps taps_of(int fine, int coarse_size) {
    const int near = fine / 2, far = fine % 2 == 0 ? near - 1 : near + 1;
    return {near, std::clamp(far, 0, coarse_size - 1)};
}

float weight_of(const Taps& taps, int coarse) {
    return (taps.near == coarse ? kNear : 0.0f) + (taps.far == coarse ? kFar : 0.0f);
}

float* row_of(Image& image, int y) { return &image.values[image.index(0, y)]; }
const float* row_of(const Image& image, int y) { return &image.values[image.index(0, y)]; }

/// to[i] += weight * from[i]
void add_scaled(float weight, const float* __restrict from, std::size_t count,
                float* __restrict to) {
    for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// One row of sum_down: a sum of fine rows to coarse texels. Between the borders a coarse texel is
/// read by four fine ones.
template <int kChannels>
void sum_row_down(const float* __restrict fine, int fine_width, int coarse_width,
                  float* __restrict coarse) {
    const auto by_weights = [&](int x) {
        for (int c = 0; c < kChannels; ++c) {
            float sum = 0;
            for (int fx = std::max(0, 2 * x - 1); fx < std::min(fine_width, 2 * x + 3); ++fx)
                sum += weight_of(taps_of(fx, coarse_width), x) * fine[fx * kChannels + c];
            coarse[x * kChannels + c] = sum;
        }
    };
    const int inner = std::max(1, coarse_width - 1);
    by_weights(0);
    for (int x = 1; x < inner; ++x)
        for (int c = 0; c < kChannels; ++c) {
            const float* f = fine + (2 * x - 1) * kChannels + c;
            coarse[x * kChannels + c] = kFar * f[0] + kNear * f[kChannels] +
                                        kNear * f[2 * kChannels] + kFar * f[3 * kChannels];
        }
    for (int x = inner; x < coarse_width; ++x) by_weights(x);
}

std::span<const ChartBorders::Texel> row_of(const ChartBorders& borders, int y) {
    if (borders.rows.empty()) return {};
    const auto row = static_cast<std::size_t>(y);
    return std::span(borders.texels)
        .subspan(borders.rows[row], borders.rows[row + 1] - borders.rows[row]);
}

/// The same as add_scaled for a row of texels without those at borders.
void add_scaled_inside(float weight, std::span<const ChartBorders::Texel> borders, int channels,
                       const float* from, std::size_t count, float* to) {
    std::size_t begin = 0;
    for (const ChartBorders::Texel& t : borders) {
        const auto end = static_cast<std::size_t>(t.x * channels);
        add_scaled(weight, from + begin, end - begin, to + begin);
        begin = end + static_cast<std::size_t>(channels);
    }
    add_scaled(weight, from + begin, count - begin, to + begin);
}

/// Adds what the texels at borders of fine row fy give to coarse row y.
void sum_borders_down(std::span<const ChartBorders::Texel> borders, const Image& fine, int fy,
                      int y, Image& coarse) {
    const Taps rows = taps_of(fy, coarse.height);
    for (const ChartBorders::Texel& t : borders) {
        const Taps columns = taps_of(t.x, coarse.width);
        const auto give = [&](int x, float weight) {
            for (int c = 0; c < fine.channels; ++c)
                coarse.at(x, y, c) += weight * fine.at(t.x, fy, c);
        };
        if (rows.near == y) give(columns.near, t.weight[0]), give(columns.far, t.weight[1]);
        if (rows.far == y) give(columns.near, t.weight[2]), give(columns.far, t.weight[3]);
    }
}

/// The transpose of interpolate: each value of `coarse` becomes the weighted sum of the fine texels
/// that read it.
template <int kChannels>
void sum_down(const Image& fine, const ChartBorders& borders, Image& coarse) {
    const std::size_t row_floats = static_cast<std::size_t>(fine.width) * kChannels;
    parallel_chunks(
        static_cast<std::size_t>(coarse.height), 8, [&](std::size_t begin, std::size_t end) {
            std::vector<float> sum(row_floats);
            for (std::size_t row = begin; row < end; ++row) {
                const int y = static_cast<int>(row);
                std::fill(sum.begin(), sum.end(), 0.0f);
                for (int fy = std::max(0, 2 * y - 1); fy < std::min(fine.height, 2 * y + 3); ++fy)
                    add_scaled_inside(weight_of(taps_of(fy, coarse.height), y), row_of(borders, fy),
                                      kChannels, row_of(fine, fy), row_floats, sum.data());
                sum_row_down<kChannels>(sum.data(), fine.width, coarse.width, row_of(coarse, y));
                for (int fy = std::max(0, 2 * y - 1); fy < std::min(fine.height, 2 * y + 3); ++fy)
                    sum_borders_down(row_of(borders, fy), fine, fy, y, coarse);
            }
        });
}

/// Texels [x0, x1) of row y of the coarse level, interpolated at the fine one. blend: work memory
/// for a coarse row. fine: from x0 on.
template <int kChannels>
void interpolate_row(const Image& coarse, int y, int x0, int x1, float* __restrict blend,
                     float* __restrict fine) {
    const Taps rows = taps_of(y, coarse.height);
    const float* __restrict near = row_of(coarse, rows.near);
    const float* __restrict far = row_of(coarse, rows.far);
    const int first = std::max(0, x0 / 2 - 1), last = std::min(coarse.width, (x1 + 1) / 2 + 1);
    for (int i = first * kChannels; i < last * kChannels; ++i)
        blend[i] = kNear * near[i] + kFar * far[i];
    const auto by_taps = [&](int x) {
        const Taps t = taps_of(x, coarse.width);
        for (int c = 0; c < kChannels; ++c)
            fine[(x - x0) * kChannels + c] =
                kNear * blend[t.near * kChannels + c] + kFar * blend[t.far * kChannels + c];
    };
    // Pairs of fine texels whose coarse ones all exist; single ones before and behind.
    const int begin = std::min(x1, std::max(2, x0 + x0 % 2)),
              end = std::max(begin, std::min(x1, 2 * coarse.width - 2) / 2 * 2);
    for (int x = x0; x < begin; ++x) by_taps(x);
    for (int x = begin / 2; x < end / 2; ++x)
        for (int c = 0; c < kChannels; ++c) {
            const float* b = blend + x * kChannels + c;
            float* f = fine + (2 * x - x0) * kChannels + c;
            f[0] = kNear * b[0] + kFar * b[-kChannels];
            f[kChannels] = kNear * b[0] + kFar * b[kChannels];
        }
    for (int x = end; x < x1; ++x) by_taps(x);
}

/// Puts right the texels at borders among [x0, x1) of row y. fine: from x0 on.
void interpolate_borders(const Image& coarse, const ChartBorders& borders, int y, int x0, int x1,
                         float* fine) {
    const auto row = row_of(borders, y);
    const Taps rows = taps_of(y, coarse.height);
    auto t = std::lower_bound(row.begin(), row.end(), x0,
                              [](const ChartBorders::Texel& a, int x) { return a.x < x; });
    for (; t != row.end() && t->x < x1; ++t) {
        const Taps columns = taps_of(t->x, coarse.width);
        for (int c = 0; c < coarse.channels; ++c)
            fine[(t->x - x0) * coarse.channels + c] =
                t->weight[0] * coarse.at(columns.near, rows.near, c) +
                t->weight[1] * coarse.at(columns.far, rows.near, c) +
                t->weight[2] * coarse.at(columns.near, rows.far, c) +
                t->weight[3] * coarse.at(columns.far, rows.far, c);
    }
}

/// The same for a run [begin, end) of a fine image's floats, of whole texels.
template <int kChannels>
void interpolate(const Image& coarse, const ChartBorders& borders, int fine_width,
                 std::size_t begin, std::size_t end, std::vector<float>& blend, float* fine) {
    blend.resize(static_cast<std::size_t>(coarse.width) * kChannels);
    const auto width = static_cast<std::size_t>(fine_width);
    const std::size_t last = end / kChannels;
    for (std::size_t texel = begin / kChannels; texel < last;) {
        const std::size_t y = texel / width, x = texel % width;
        const std::size_t count = std::min(width - x, last - texel);
        interpolate_row<kChannels>(coarse, static_cast<int>(y), static_cast<int>(x),
                                   static_cast<int>(x + count), blend.data(), fine);
        interpolate_borders(coarse, borders, static_cast<int>(y), static_cast<int>(x),
                            static_cast<int>(x + count), fine);
        fine += count * kChannels, texel += count;
    }
}

void sum_down(const Image& fine, const ChartBorders& borders, Image& coarse) {
    (fine.channels == 1 ? sum_down<1> : sum_down<3>)(fine, borders, coarse);
}

/// Floats that are worked on at once: they stay in the cache, and are whole texels of one or three
/// channels.
constexpr std::size_t kRun = 12 * kActiveChunk;

/// Calls body(begin, end, coarse) for runs of a level's floats, in parallel. coarse: the sum of the
/// coarser levels there; null for the coarsest level.
template <class Body>
void for_runs(const LevelState& level, const Image* coarser, const Body& body) {
    const Image& image = level.values;
    parallel_chunks(image.values.size(), kRun, [&](std::size_t begin, std::size_t end) {
        if (!coarser) return body(begin, end, nullptr);
        std::vector<float> blend, coarse(end - begin);
        const auto by = image.channels == 1 ? interpolate<1> : interpolate<3>;
        by(*coarser, level.borders, image.width, begin, end, blend, coarse.data());
        body(begin, end, coarse.data());
    });
}

/// The sum of the levels that are coarser than `level`; null for the coarsest.
const Image* coarser_sum(const TextureParameters& parameters, std::size_t level) {
    return level + 1 < parameters.levels.size() ? &parameters.levels[level + 1].sum : nullptr;
}

/// The sum of each level with all coarser ones, but of the finest.
void sum_levels(TextureParameters& parameters) {
    for (std::size_t i = parameters.levels.size() - 1; i > 0; --i) {
        LevelState& level = parameters.levels[i];
        reshape(level.sum, level.values.width, level.values.height, level.values.channels);
        for_runs(level, coarser_sum(parameters, i),
                 [&](std::size_t begin, std::size_t end, const float* coarse) {
                     for (std::size_t k = begin; k < end; ++k)
                         level.sum.values[k] =
                             level.values.values[k] + (coarse ? coarse[k - begin] : 0.0f);
                 });
    }
}

GradientSpans spans_of(const HalvedGradient& gradient) {
    return {gradient.first.values, gradient.second.values};
}

/// The gradient by a level from that by the next finer one.
void sum_down(const HalvedGradient& finer, const ChartBorders& borders, LevelState& level) {
    const Image& v = level.values;
    const auto half_down = [&](const Image& fine, Image& coarse) {
        reshape(coarse, v.width, v.height, v.channels);
        sum_down(fine, borders, coarse);
    };
    half_down(finer.first, level.gradient.first);
    if (finer.second.width > 0) half_down(finer.second, level.gradient.second);
}

std::size_t texel_of(const Image& image, int x, int y) {
    return image.index(x, y) / static_cast<std::size_t>(image.channels);
}

/// The chart that most of the four texels under a coarse one belong to; of several the first; 0
/// where they belong to none.
ChartMap halve(const ChartMap& charts, const Image& fine, const Image& coarse) {
    ChartMap result;
    for (int y = 0; y < coarse.height; ++y)
        for (int x = 0; x < coarse.width; ++x) {
            std::array<std::uint32_t, 4> under{};
            for (std::size_t k = 0; k < 4; ++k) {
                const int fx = 2 * x + static_cast<int>(k % 2),
                          fy = 2 * y + static_cast<int>(k / 2);
                if (fx < fine.width && fy < fine.height) under[k] = charts[texel_of(fine, fx, fy)];
            }
            std::uint32_t most = 0;
            std::ptrdiff_t votes = 0;
            for (const std::uint32_t chart : under)
                if (const auto n = std::count(under.begin(), under.end(), chart);
                    chart != 0 && n > votes)
                    most = chart, votes = n;
            result.push_back(most);
        }
    return result;
}

/// The texels of a level that read texels of other charts than their own. Those of no chart read
/// all: nothing is known of them, and nothing reads them.
ChartBorders find_borders(const ChartMap& charts, const Image& fine, const ChartMap& coarse_charts,
                          const Image& coarse) {
    ChartBorders borders;
    for (int y = 0; y < fine.height; ++y) {
        borders.rows.push_back(borders.texels.size());
        const Taps rows = taps_of(y, coarse.height);
        for (int x = 0; x < fine.width; ++x) {
            const std::uint32_t chart = charts[texel_of(fine, x, y)];
            const Taps columns = taps_of(x, coarse.width);
            ChartBorders::Texel t{x, {kNear * kNear, kFar * kNear, kNear * kFar, kFar * kFar}};
            float sum = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                const int cx = k % 2 == 0 ? columns.near : columns.far,
                          cy = k / 2 == 0 ? rows.near : rows.far;
                if (coarse_charts[texel_of(coarse, cx, cy)] != chart) t.weight[k] = 0;
                sum += t.weight[k];
            }
            if (chart == 0 || sum == 1) continue;
            for (float& w : t.weight) w /= std::max(sum, kFar * kFar);
            borders.texels.push_back(t);
        }
    }
    borders.rows.push_back(borders.texels.size());
    return borders;
}

/// Counts the texels of a run of floats whose gradient is not zero.
void count_informed(const HalvedGradient& gradient, std::size_t begin, std::size_t end,
                    std::vector<std::uint32_t>& informed) {
    const auto channels = static_cast<std::size_t>(gradient.first.channels);
    const float* a = gradient.first.values.data();
    const float* b = gradient.second.width > 0 ? gradient.second.values.data() : a;
    for (std::size_t texel = begin / channels; texel < end / channels; ++texel) {
        bool any = false;
        for (std::size_t k = texel * channels; k < (texel + 1) * channels; ++k)
            any |= a[k] != 0 || b[k] != 0;
        informed[texel] += any;
    }
}

/// The least agreement of a texel's channels.
float least_agreement(const LevelState& level, int x, int y) {
    float least = 1;
    for (int c = 0; c < level.values.channels; ++c) {
        const std::size_t i = level.values.index(x, y) + static_cast<std::size_t>(c);
        least = std::min(least, agreement(level.optimizer.second[i], level.optimizer.noise[i]));
    }
    return least;
}

}  // namespace

TextureParameters encode(const ParameterizationOptions& options, const Image& initial,
                         const ChartMap& charts) {
    TextureParameters p;
    if (options.kind == Parameterization::kSmooth) {
        p.links = link_texels(initial.width, initial.height, charts);
        p.smoothing_length = options.smoothing_length;
    }
    p.levels.push_back({initial, {}, {}, {}, {}});
    p.informed.resize(initial.values.size() / static_cast<std::size_t>(initial.channels));
    ChartMap finer_charts = charts;
    const auto larger_side = [](const Image& image) { return std::max(image.width, image.height); };
    while (options.kind == Parameterization::kPyramid &&
           static_cast<int>(p.levels.size()) < options.pyramid_levels &&
           larger_side(p.levels.back().values) > 1) {
        const Image& last = p.levels.back().values;
        Image coarse = make_image(half(last.width), half(last.height), last.channels);
        if (!charts.empty()) {
            ChartMap coarse_charts = halve(finer_charts, last, coarse);
            p.levels.back().borders = find_borders(finer_charts, last, coarse_charts, coarse);
            finer_charts = std::move(coarse_charts);
        }
        p.levels.push_back({std::move(coarse), {}, {}, {}, {}});
    }
    return p;
}

Image decode(const TextureParameters& parameters) {
    Image texture = parameters.levels.back().values;
    for (std::size_t i = parameters.levels.size() - 1; i-- > 0;) {
        const LevelState& level = parameters.levels[i];
        Image finer = level.values;
        for_runs(level, &texture, [&](std::size_t begin, std::size_t end, const float* coarse) {
            for (std::size_t k = begin; k < end; ++k) finer.values[k] += coarse[k - begin];
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
                most = std::max(most, least_agreement(level, x >> i, y >> i));
            }
    }
    return result;
}

namespace {

void descend_levels(const OptimizerOptions& options, const HalvedGradient& gradient,
                    TextureParameters& parameters, Image& texture) {
    auto& levels = parameters.levels;
    for (std::size_t i = 1; i < levels.size(); ++i) {
        LevelState& level = levels[i];
        sum_down(i == 1 ? gradient : levels[i - 1].gradient, levels[i - 1].borders, level);
        step(options, spans_of(level.gradient), level.optimizer, level.values.values);
    }
    sum_levels(parameters);

    LevelState& finest = levels.front();
    std::vector<float>& x = finest.values.values;
    begin_step(options, x.size(), finest.optimizer);
    for_runs(finest, coarser_sum(parameters, 0),
             [&](std::size_t begin, std::size_t end, const float* coarse) {
                 step_part(options, spans_of(gradient), finest.optimizer, x, begin, end);
                 // The finest level takes back what leaves the range, so that the parameters never
                 // run away behind the clamp.
                 for (std::size_t k = begin; k < end; ++k) {
                     const float sum = x[k] + (coarse ? coarse[k - begin] : 0.0f);
                     const float clamped = std::clamp(sum, 0.0f, 1.0f);
                     x[k] += clamped - sum;
                     texture.values[k] = clamped;
                 }
                 count_informed(gradient, begin, end, parameters.informed);
             });
}

/// lambda of a step, counted from 0: the length stays for a few steps, then shrinks as 1 / step
/// down to a texel, from coarse to fine while samples gather.
float smoothing_at(const TextureParameters& parameters, std::uint32_t step) {
    constexpr float kSteps = 4, kLeast = 1;
    const float first = parameters.smoothing_length;
    const float length =
        std::clamp(first * kSteps / static_cast<float>(step + 1), std::min(kLeast, first), first);
    return length * length;
}

/// With u the parameters and the texture x = B u, B = rows^-1 columns^-1: the gradient by u is the
/// transpose of B times that by x, and x moves by B times the step of u. u itself is never needed,
/// so that lambda may change from step to step and the clamp acts on the texture.
void descend_smoothly(const OptimizerOptions& options, const HalvedGradient& gradient,
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
    parallel_chunks(x.size(), kRun, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            texture.values[k] = x[k] = std::clamp(x[k] + change.values[k], 0.0f, 1.0f);
        count_informed(gradient, begin, end, parameters.informed);
    });
}

}  // namespace

void descend(const OptimizerOptions& options, const HalvedGradient& gradient,
             TextureParameters& parameters, Image& texture) {
    const bool smooth = parameters.links.width > 0;
    (smooth ? descend_smoothly : descend_levels)(options, gradient, parameters, texture);
}

}  // namespace burnish
