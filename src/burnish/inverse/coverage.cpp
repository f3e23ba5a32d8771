#include "burnish/inverse/coverage.h"

#include <cmath>

namespace burnish {

std::vector<std::vector<char>> reached_texels(const TracedScene& scene, const Theta& theta,
                                              std::uint32_t seed, std::uint32_t passes,
                                              const Progress& progress) {
    const Film& film = scene.scene->film;
    const Image ones = make_image(film.crop_width, film.crop_height, 3, 1.0f);
    GradientOptions options;
    options.estimator = Estimator::kMc;
    options.seed = seed;
    std::vector<std::vector<char>> reached;
    for (const ThetaTexture& t : theta.textures)
        reached.emplace_back(
            static_cast<std::size_t>(t.values.width) * static_cast<std::size_t>(t.values.height),
            char{0});
    for (std::uint32_t i = 0; i < passes; ++i) {
        const auto result = estimate_gradient(scene, theta, ones, i, options, History{});
        for (const TexelGradient& g : result.gradient) reached[g.key.slot][g.key.texel] = 1;
        if (progress) progress((i + 1.0) / passes);
    }
    return reached;
}

double texture_error(const Image& texels, const Image& truth, const std::vector<char>& reached) {
    const auto channels = static_cast<std::size_t>(texels.channels);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < texels.values.size(); ++i) {
        if (!reached[i / channels]) continue;
        const double d = double{texels.values[i]} - double{truth.values[i]};
        sum += d * d;
        ++count;
    }
    return std::sqrt(sum / static_cast<double>(count));
}

}  // namespace burnish
