#include "texture/coverage.h"

#include <cmath>
#include <limits>

#include "core/contract.h"
#include "core/random.h"
#include "gradient/monte_carlo.h"

namespace burnish {

namespace {

/// sqrt(weight), its sign drawn for each channel of each pixel.
Image random_signs(const Image& weights, std::uint32_t seed, std::uint32_t number) {
    Image adjoint = weights;
    for (std::size_t i = 0; i < adjoint.values.size(); ++i) {
        const std::uint32_t bits =
            philox4x32({static_cast<std::uint32_t>(i), number, 0, 0},
                       {seed, static_cast<std::uint32_t>(Stream::kProbe)})[0];
        adjoint.values[i] = (bits & 1 ? 1.0f : -1.0f) * std::sqrt(weights.values[i]);
    }
    return adjoint;
}

}  // namespace

std::vector<TexelEvidence> texel_evidence(const TracedScene& scene, const Theta& theta,
                                          const Image& weights, std::uint32_t seed,
                                          std::uint32_t passes, const Progress& progress) {
    BURNISH_REQUIRE(passes % 2, ==, 0u);
    MonteCarlo options;
    options.adaptive_sampling = false;
    MonteCarloState state;
    const Binding binding(scene, theta);
    std::vector<TexelEvidence> evidence;
    for (const ThetaTexture& t : theta.textures) {
        const auto texels =
            static_cast<std::size_t>(t.values.width) * static_cast<std::size_t>(t.values.height);
        evidence.push_back({std::vector<char>(texels), std::vector<float>(texels)});
    }
    const float share = 2 / static_cast<float>(passes);
    std::vector<Image> first;
    for (std::uint32_t i = 0; i < passes; ++i) {
        const Image adjoint = random_signs(weights, seed, i / 2);
        // A seed for each of two: the passes of one share a sequence of film offsets that fills the
        // pixel evenly, so that they are not independent.
        const auto result =
            estimate_gradient(options, binding, adjoint, seed_of_half(seed, i % 2), i / 2, state);
        for (const TexelGradient& g : result.gradient) {
            TexelEvidence& e = evidence[g.key.slot];
            e.visited[g.key.texel] = 1;
            if (i % 2 == 0) continue;
            const Image& other = first[g.key.slot];
            const std::size_t channels = static_cast<std::size_t>(other.channels);
            for (std::size_t c = 0; c < channels; ++c)
                e.sensitivity[g.key.texel] +=
                    share * g.g[static_cast<int>(c)] * other.values[channels * g.key.texel + c];
        }
        if (i % 2 == 0) first = dense_gradient(theta, result.gradient);
        if (progress) progress((i + 1.0) / passes);
    }
    return evidence;
}

void add(const std::vector<TexelEvidence>& evidence, std::vector<TexelEvidence>& to) {
    to.resize(evidence.size());
    for (std::size_t i = 0; i < to.size(); ++i) {
        to[i].visited.resize(evidence[i].visited.size());
        to[i].sensitivity.resize(evidence[i].sensitivity.size());
        for (std::size_t k = 0; k < to[i].visited.size(); ++k) {
            to[i].visited[k] |= evidence[i].visited[k];
            to[i].sensitivity[k] += evidence[i].sensitivity[k];
        }
    }
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

double weighted_texture_error(const Image& texels, const Image& truth,
                              const std::vector<float>& sensitivity) {
    const auto channels = static_cast<std::size_t>(texels.channels);
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < texels.values.size(); ++i) {
        const double d = double{texels.values[i]} - double{truth.values[i]};
        const double weight = double{sensitivity[i / channels]};
        sum += weight * d * d;
        weights += weight;
    }
    return weights > 0 && sum >= 0 ? std::sqrt(sum / weights)
                                   : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace burnish
