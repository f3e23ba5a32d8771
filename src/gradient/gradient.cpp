#include "burnish/gradient.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/error.h"
#include "core/count_of.h"
#include "core/require.h"
#include "gradient/mean_gradient.h"
#include "image/image.h"
#include "image/whole.h"
#include "render/render.h"
#include "render/renderer.h"

namespace burnish {

namespace {

/// The parameters are the unknowns; what else `textures` replaces is known.
Theta theta_of(const Scene& scene, const std::vector<std::string>& parameters,
               const TextureValues& textures) {
    Theta theta;
    const std::vector<TextureId> unknowns = find_textures(scene, parameters);
    for (std::size_t i = 0; i < parameters.size(); ++i)
        add_unknown(scene, parameters[i], unknowns[i], theta);
    const std::vector<TextureId> replaced = find_replaced(scene, textures);
    std::size_t next = 0;
    for (const auto& [name, image] : textures) {
        const TextureId id = replaced[next++];
        Image texels = texels_of(std::get<Bitmap>(scene[id]), name, image);
        if (const auto at = std::ranges::find(theta.textures, id, &ThetaTexture::texture);
            at != theta.textures.end())
            at->values = std::move(texels);
        else
            theta.replaced.push_back({id, std::move(texels)});
    }
    return theta;
}

/// What was left out is little, and sums did not overflow.
void require_finite_gradient(std::size_t rejected, std::size_t kept,
                             const std::vector<Image>& gradient) {
    constexpr const char* kReason =
        "values of the scene or of the adjoint are too large, or not finite";
    require_few_rejected(rejected, rejected + kept, "contributions", kReason);
    if (std::ranges::any_of(gradient, [](const Image& g) { return !is_finite(g); }))
        throw InputError(fmt::format("the gradient is not finite: {}", kReason));
}

}  // namespace

std::vector<Image> estimate_gradient(const Renderer& renderer,
                                     const std::vector<std::string>& parameters,
                                     const Image& adjoint, const GradientOptions& options,
                                     const Progress& progress) {
    require(!parameters.empty(), "no parameter is given: expected at least one");
    require(adjoint.width == renderer.width() && adjoint.height == renderer.height() &&
                adjoint.channels == 3,
            "the adjoint image has " + size_text(adjoint.width, adjoint.height) + " pixels and " +
                count_of(adjoint.channels, "channel") + ": expected " +
                size_text(renderer.width(), renderer.height()) + " and 3");
    require_whole(adjoint, "the adjoint image");
    require_finite(adjoint, "the adjoint image");
    const Theta theta = theta_of(renderer.data().scene(), parameters, options.textures);
    const Binding binding(renderer.data().traced, theta);

    const MeanGradientOptions mean_options{MonteCarlo{}, options.samples, options.seed};
    std::size_t rejected = 0, kept = 0;
    const auto report = [&](const GradientCounts& counts, std::uint32_t number,
                            std::uint32_t count) {
        rejected += counts.rejected, kept += counts.candidates;
        if (progress) progress((number + 1.0) / count);
    };
    std::vector<Image> mean = mean_gradient(mean_options, binding, adjoint, report);
    require_finite_gradient(rejected, kept, mean);
    return mean;
}

}  // namespace burnish
