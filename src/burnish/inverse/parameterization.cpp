#include "burnish/inverse/parameterization.h"

#include <algorithm>
#include <array>
#include <utility>

#include "burnish/core/parallel.h"

namespace burnish {

namespace {

int half(int size) { return (size + 1) / 2; }

/// The two coarse texels that a fine one interpolates, on one axis: bilinear, texel centres at (i +
/// 1/2) / size, clamped.
struct Taps {
    std::array<int, 2> index;
    std::array<float, 2> weight;
};

Taps taps_of(int fine, int coarse_size) {
    const int near = fine / 2, far = fine % 2 == 0 ? near - 1 : near + 1;
    return {{near, std::clamp(far, 0, coarse_size - 1)}, {0.75f, 0.25f}};
}

float weight_of(const Taps& taps, int coarse) {
    return (taps.index[0] == coarse ? taps.weight[0] : 0.0f) +
           (taps.index[1] == coarse ? taps.weight[1] : 0.0f);
}

/// The transpose of add_up: each value of the result is the weighted sum of the fine texels that
/// read it.
Image sum_down(const Image& fine) {
    Image coarse = make_image(half(fine.width), half(fine.height), fine.channels);
    const auto reach = [](int i, int fine_size) {
        return std::pair{std::max(0, 2 * i - 1), std::min(fine_size, 2 * i + 3)};
    };
    parallel_for(static_cast<std::size_t>(coarse.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const auto [y0, y1] = reach(y, fine.height);
        for (int fy = y0; fy < y1; ++fy) {
            const float wy = weight_of(taps_of(fy, coarse.height), y);
            for (int x = 0; x < coarse.width; ++x) {
                const auto [x0, x1] = reach(x, fine.width);
                for (int fx = x0; fx < x1; ++fx) {
                    const float w = wy * weight_of(taps_of(fx, coarse.width), x);
                    for (int c = 0; c < fine.channels; ++c)
                        coarse.at(x, y, c) += w * fine.at(fx, fy, c);
                }
            }
        }
    });
    return coarse;
}

/// fine += coarse, interpolated.
void add_up(const Image& coarse, Image& fine) {
    parallel_for(static_cast<std::size_t>(fine.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const Taps ty = taps_of(y, coarse.height);
        for (int x = 0; x < fine.width; ++x) {
            const Taps tx = taps_of(x, coarse.width);
            for (std::size_t j = 0; j < 2; ++j)
                for (std::size_t i = 0; i < 2; ++i) {
                    const float w = ty.weight[j] * tx.weight[i];
                    for (int c = 0; c < fine.channels; ++c)
                        fine.at(x, y, c) += w * coarse.at(tx.index[i], ty.index[j], c);
                }
        }
    });
}

/// The sum of the upsampled levels, not clamped.
Image sum_levels(const TextureParameters& parameters) {
    Image sum = parameters.levels.back().values;
    for (std::size_t i = parameters.levels.size() - 1; i-- > 0;) {
        Image finer = parameters.levels[i].values;
        add_up(sum, finer);
        sum = std::move(finer);
    }
    return sum;
}

}  // namespace

TextureParameters encode(Parameterization kind, const Image& initial, int levels) {
    TextureParameters p;
    p.levels.push_back({initial, {}});
    const auto larger_side = [](const Image& image) { return std::max(image.width, image.height); };
    while (kind == Parameterization::kPyramid && static_cast<int>(p.levels.size()) < levels &&
           larger_side(p.levels.back().values) > 1) {
        const Image& last = p.levels.back().values;
        p.levels.push_back({make_image(half(last.width), half(last.height), last.channels), {}});
    }
    return p;
}

Image decode(const TextureParameters& parameters) {
    Image texture = sum_levels(parameters);
    for (float& v : texture.values) v = std::clamp(v, 0.0f, 1.0f);
    return texture;
}

Image descend(const OptimizerOptions& options, const Image& gradient,
              TextureParameters& parameters) {
    LevelState& finest = parameters.levels.front();
    step(options, gradient.values, finest.optimizer, finest.values.values);
    Image level_gradient;
    for (std::size_t i = 1; i < parameters.levels.size(); ++i) {
        level_gradient = sum_down(i == 1 ? gradient : level_gradient);
        LevelState& level = parameters.levels[i];
        step(options, level_gradient.values, level.optimizer, level.values.values);
    }
    // The finest level takes back what leaves the range, so that the parameters never run away
    // behind the clamp.
    Image texture = sum_levels(parameters);
    parallel_chunks(texture.values.size(), 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const float clamped = std::clamp(texture.values[i], 0.0f, 1.0f);
            finest.values.values[i] += clamped - texture.values[i];
            texture.values[i] = clamped;
        }
    });
    return texture;
}

}  // namespace burnish
