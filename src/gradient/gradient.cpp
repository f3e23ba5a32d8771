#include "burnish/gradient.h"

#include <algorithm>

#include "burnish/error.h"
#include "gradient/monte_carlo.h"
#include "render/renderer.h"

namespace burnish {

namespace {

void require(bool holds, const std::string& message) {
    if (!holds) throw InputError(message);
}

/// The parameters, each once, then what else `textures` replaces.
Theta theta_of(const Scene& scene, const std::vector<std::string>& parameters,
               const TextureValues& textures) {
    Theta theta;
    const auto find = [&](TextureId id) {
        return std::find_if(theta.textures.begin(), theta.textures.end(),
                            [&](const ThetaTexture& t) { return t.texture == id; });
    };
    for (const std::string& name : parameters) {
        const TextureId id = find_texture(scene, name);
        require(find(id) == theta.textures.end(),
                "the parameter " + name + " is the same texture as another one");
        theta.textures.push_back({id, linear_image(std::get<Bitmap>(scene[id]))});
    }
    for (const auto& [name, image] : textures) {
        const TextureId id = find_texture(scene, name);
        Image texels = texels_of(std::get<Bitmap>(scene[id]), name, image);
        if (const auto at = find(id); at != theta.textures.end())
            at->values = std::move(texels);
        else
            theta.textures.push_back({id, std::move(texels)});
    }
    return theta;
}

/// All calls have the same number of passes, so that the film offsets of all form one sequence; few
/// of them, so that memory does not grow with the samples.
std::uint32_t passes_per_call(std::uint32_t samples) {
    for (const std::uint32_t passes : {4u, 3u, 2u})
        if (samples % passes == 0) return passes;
    return 1;
}

}  // namespace

std::vector<Image> estimate_gradient(const Renderer& renderer,
                                     const std::vector<std::string>& parameters,
                                     const Image& adjoint, const GradientOptions& options,
                                     const Progress& progress) {
    require(!parameters.empty(), "no parameter is given: expected at least one");
    require(options.samples > 0, "samples per pixel are 0: expected at least 1");
    require(adjoint.width == renderer.width() && adjoint.height == renderer.height() &&
                adjoint.channels == 3,
            "the adjoint image has " + std::to_string(adjoint.width) + " x " +
                std::to_string(adjoint.height) + " pixels and " + std::to_string(adjoint.channels) +
                " channels: expected " + std::to_string(renderer.width()) + " x " +
                std::to_string(renderer.height()) + " and 3");
    const Theta theta = theta_of(renderer.data().scene(), parameters, options.textures);
    const Binding binding(renderer.data().traced, theta);

    const std::uint32_t passes = passes_per_call(options.samples);
    const std::uint32_t calls = options.samples / passes;
    std::vector<Image> mean;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const Image& texels = theta.textures[i].values;
        mean.push_back(make_image(texels.width, texels.height, texels.channels));
    }
    const float share = 1 / static_cast<float>(calls);
    for (std::uint32_t call = 0; call < calls; ++call) {
        MonteCarloState state;
        const GradientResult result =
            estimate_gradient(MonteCarlo{.samples = passes, .adaptive_sampling = false}, binding,
                              adjoint, options.seed, call, state);
        const std::vector<Image> dense = dense_gradient(theta, result.gradient);
        for (std::size_t i = 0; i < mean.size(); ++i)
            for (std::size_t k = 0; k < mean[i].values.size(); ++k)
                mean[i].values[k] += share * dense[i].values[k];
        if (progress) progress((call + 1.0) / calls);
    }
    return mean;
}

}  // namespace burnish
