#include "burnish/inverse/parameterization.h"

#include <algorithm>

#include "burnish/core/parallel.h"

namespace burnish {

namespace {

int half(int size) { return (size + 1) / 2; }

/// Transposed nearest upsampling by two: each value of the result is the sum of the up to four that
/// read it.
Image sum_down(const Image& fine) {
    Image coarse = make_image(half(fine.width), half(fine.height), fine.channels);
    parallel_for(static_cast<std::size_t>(coarse.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int fy = 2 * y; fy < std::min(2 * y + 2, fine.height); ++fy)
            for (int x = 0; x < fine.width; ++x)
                for (int c = 0; c < fine.channels; ++c) coarse.at(x / 2, y, c) += fine.at(x, fy, c);
    });
    return coarse;
}

/// fine += coarse, upsampled by two.
void add_up(const Image& coarse, Image& fine) {
    parallel_for(static_cast<std::size_t>(fine.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < fine.width; ++x)
            for (int c = 0; c < fine.channels; ++c) fine.at(x, y, c) += coarse.at(x / 2, y / 2, c);
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
    Image level_gradient = gradient;
    for (std::size_t i = 0; i < parameters.levels.size(); ++i) {
        if (i > 0) level_gradient = sum_down(level_gradient);
        LevelState& level = parameters.levels[i];
        step(options, level_gradient.values, level.optimizer, level.values.values);
    }
    // The finest level takes back what leaves the range, so that the parameters never run away
    // behind the clamp.
    const Image sum = sum_levels(parameters);
    Image texture = sum;
    std::vector<float>& finest = parameters.levels.front().values.values;
    for (std::size_t i = 0; i < texture.values.size(); ++i) {
        texture.values[i] = std::clamp(sum.values[i], 0.0f, 1.0f);
        finest[i] += texture.values[i] - sum.values[i];
    }
    return texture;
}

}  // namespace burnish
