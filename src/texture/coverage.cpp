#include "texture/coverage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gradient/monte_carlo.h"
#include "texture/prolongation.h"

namespace burnish {

std::vector<std::vector<char>> visited_texels(const TracedScene& scene, const Theta& theta,
                                              std::uint32_t seed, std::uint32_t passes,
                                              const Progress& progress) {
    const Film& film = scene.film;
    const Image ones = make_image(film.crop_width, film.crop_height, 3, 1.0f);
    MonteCarlo options;
    options.adaptive_sampling = false;
    MonteCarloState state;
    const Binding binding(scene, theta);
    std::vector<std::vector<char>> visited;
    for (const ThetaTexture& t : theta.textures)
        visited.emplace_back(
            static_cast<std::size_t>(t.values.width) * static_cast<std::size_t>(t.values.height),
            char{0});
    for (std::uint32_t i = 0; i < passes; ++i) {
        const auto result = estimate_gradient(options, binding, ones, seed, i, state);
        for (const TexelGradient& g : result.gradient) visited[g.key.slot][g.key.texel] = 1;
        if (progress) progress((i + 1.0) / passes);
    }
    return visited;
}

double texture_error(const Image& texels, const Image& truth, const std::vector<char>& visited) {
    const auto channels = static_cast<std::size_t>(texels.channels);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < texels.values.size(); ++i) {
        if (!visited[i / channels]) continue;
        const double d = double{texels.values[i]} - double{truth.values[i]};
        sum += d * d;
        ++count;
    }
    return std::sqrt(sum / static_cast<double>(count));
}

namespace {

/// A level of the pyramid: values of the texels that are known, and which ones are.
struct KnownTexels {
    Image values;
    std::vector<char> known;
};

/// Half the resolution: the mean of what is known among four.
KnownTexels push(const KnownTexels& fine) {
    const Image& f = fine.values;
    KnownTexels coarse{make_image(half(f.width), half(f.height), f.channels), {}};
    Image& to = coarse.values;
    std::vector<float> counts(to.values.size() / static_cast<std::size_t>(to.channels));
    for (int y = 0; y < f.height; ++y)
        for (int x = 0; x < f.width; ++x) {
            if (!fine.known[f.index(x, y) / static_cast<std::size_t>(f.channels)]) continue;
            for (int c = 0; c < f.channels; ++c) to.at(x / 2, y / 2, c) += f.at(x, y, c);
            counts[to.index(x / 2, y / 2) / static_cast<std::size_t>(to.channels)] += 1;
        }
    for (std::size_t i = 0; i < to.values.size(); ++i)
        to.values[i] /= std::max(1.0f, counts[i / static_cast<std::size_t>(to.channels)]);
    for (const float count : counts) coarse.known.push_back(count > 0);
    return coarse;
}

/// Fills in what is not known, bilinearly from a coarser level in which all is.
void pull(const Image& coarse, KnownTexels& fine) {
    std::vector<float>& values = fine.values.values;
    std::vector<float> filled(values.size()), row;
    prolong({}, {}, coarse, fine.values.width, 0, filled.size(), row, filled.data());
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!fine.known[i / static_cast<std::size_t>(coarse.channels)]) values[i] = filled[i];
}

}  // namespace

void fill_unvisited(const std::vector<std::uint32_t>& visits, Image& texels) {
    std::vector<KnownTexels> levels{{std::move(texels), {}}};
    for (const std::uint32_t count : visits) levels[0].known.push_back(count > 0);
    const auto complete = [](const KnownTexels& level) {
        return std::find(level.known.begin(), level.known.end(), 0) == level.known.end();
    };
    while (!complete(levels.back()) && levels.back().known.size() > 1)
        levels.push_back(push(levels.back()));
    if (complete(levels.back()))
        for (std::size_t i = levels.size() - 1; i-- > 0;) pull(levels[i + 1].values, levels[i]);
    texels = std::move(levels[0].values);
}

void keep_unvisited(const std::vector<std::uint32_t>& visits, const Image& initial, Image& texels) {
    const auto channels = static_cast<std::size_t>(texels.channels);
    for (std::size_t i = 0; i < texels.values.size(); ++i)
        if (visits[i / channels] == 0) texels.values[i] = initial.values[i];
}

}  // namespace burnish
