#include "optimize/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "burnish/error.h"
#include "core/parallel.h"
#include "core/positive_float.h"
#include "core/random.h"
#include "core/require.h"
#include "image/image.h"
#include "image/quality.h"
#include "image/whole.h"
#include "optimize/loss.h"
#include "optimize/ranks.h"
#include "paths/traced_scene.h"
#include "render/film.h"
#include "render/lens_pixels.h"
#include "render/renderer.h"
#include "render/visible_pixels.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

bool fits(const Image& image, const Renderer& renderer) {
    return image.width == renderer.width() && image.height == renderer.height();
}

void check_exposure(const Problem& problem, const View& view) {
    if (const auto* factors = std::get_if<ExposureFactors>(&view.exposure)) {
        for (const float e : *factors)
            if (!is_positive_float(double{e}))
                throw InputError(
                    fmt::format("the exposure is {:g}: expected {}", e, kPositiveFloat));
    } else if (problem.loss) {
        throw InputError(
            "the exposure is to be fitted, but a loss of your own does not say how: expected a "
            "number");
    }
}

void check_sizes(const View& view, const Renderer& renderer) {
    const std::string expected = size_text(renderer.width(), renderer.height()) + " pixels";
    require(
        fits(view.image, renderer) && view.image.channels == 3,
        fmt::format(
            "the target image has {} pixels and {} channels: expected RGB of the film's size, {}",
            size_text(view.image.width, view.image.height), view.image.channels, expected));
    const int channels = view.mask.channels;
    require(
        view.mask.width == 0 || (fits(view.mask, renderer) && (channels == 1 || channels == 3)),
        fmt::format("the mask has {} pixels and {} channels: expected one or three of the film's "
                    "size, {}",
                    size_text(view.mask.width, view.mask.height), channels, expected));
    require_whole(view.image, "the target image");
    if (view.mask.width != 0) require_whole(view.mask, "the mask");
}

void check_picture(const View& view, const Renderer& renderer) {
    check_sizes(view, renderer);
    if (view.mask.width != 0) require_weights(view.mask, "the mask");
    if (is_finite(view.image)) return;
    const Image zeros = make_image(view.image.width, view.image.height, 3);
    require_finite(
        view.mask.width == 0 ? view.image : alike_where_uncounted(view.image, zeros, view.mask),
        "the target image");
}

/// The image of a sky that is prepared; none: there is no such sky.
SharedImage prepared_sky(const Renderer& renderer) {
    const auto& environment = renderer.data().traced.lights->environment;
    return environment ? environment->sky->image : nullptr;
}

/// The renderer under a view's lights: that of an earlier view with the same ones, where there is;
/// or one that shares what an earlier view under the same sky has prepared.
Renderer lit_as(const Problem& problem, std::size_t view, const std::vector<Renderer>& earlier) {
    Lighting lighting = problem.views[view].lighting;
    if (lighting == Lighting{}) return problem.renderer;
    for (std::size_t i = 0; i < view; ++i)
        if (problem.views[i].lighting == lighting) return earlier[i];
    const bool has_own = lighting.environment && lighting.environment->image;
    const SharedImage sky =
        has_own ? lighting.environment->image : sky_of(*problem.renderer.data().traced.scene);
    for (std::size_t i = 0; sky && i < view; ++i) {
        const SharedImage prepared = prepared_sky(earlier[i]);
        if (!prepared || (prepared != sky && *prepared != *sky)) continue;
        if (has_own) lighting.environment->image = prepared;
        return earlier[i].with_lighting(lighting);
    }
    return problem.renderer.with_lighting(lighting);
}

/// What `lit` shows through the camera of another renderer of its scene.
Renderer through_camera_of(const Renderer& own, const Renderer& lit) {
    const TracedScene& view = own.data().traced;
    return Renderer(std::make_shared<const RendererData>(
        RendererData{lit.data().loaded, with_camera(lit.data().traced, view.camera, view.film)}));
}

/// Gives the weight 0 to what is at most `reach` away from the marked pixels. Returns its share.
double mask_out(const Renderer& renderer, const std::vector<char>& pixels, int reach, View& view) {
    const int width = renderer.width(), height = renderer.height();
    const std::vector<char> out = dilate(pixels, width, height, reach);
    const auto count = std::count(out.begin(), out.end(), 1);
    if (count == 0) return 0;
    if (view.mask.width == 0) view.mask = make_image(width, height, 1, 1.0f);
    for (std::size_t k = 0; k < view.mask.values.size(); ++k)
        if (out[k / static_cast<std::size_t>(view.mask.channels)]) view.mask.values[k] = 0;
    return static_cast<double>(count) / static_cast<double>(out.size());
}

bool any_pixel_counts(const View& view) {
    return view.mask.width == 0 ||
           std::ranges::any_of(view.mask.values, [](float weight) { return weight > 0; });
}

}  // namespace

SharedImage sky_of(const Scene& scene) {
    const EnvironmentEmitter* map = environment_map(scene);
    return map ? map->image : nullptr;
}

Renderer make_view(const Problem& problem, std::size_t view, const std::vector<Renderer>& earlier) {
    const View& v = problem.views[view];
    return naming_view(v, view, problem.views.size(), [&] {
        const Renderer lit = lit_as(problem, view, earlier);
        return v.camera == ViewCamera{} ? through_camera_of(problem.renderer, lit)
                                        : lit.with_camera(v.camera);
    });
}

std::vector<Renderer> make_views(const Problem& problem) {
    std::vector<Renderer> renderers;
    for (std::size_t i = 0; i < problem.views.size(); ++i)
        renderers.push_back(make_view(problem, i, renderers));
    return renderers;
}

void check_pictures(Problem& problem, const std::vector<Renderer>& views) {
    parallel_tasks(problem.views.size(), [&](std::size_t i) {
        View& view = problem.views[i];
        naming_view(view, i, problem.views.size(), [&] {
            check_picture(view, views[i]);
            check_exposure(problem, view);
            mask_blind_pixels(views[i], view);
        });
    });
    const auto counts = [](const View& view) { return !view.held_out && any_pixel_counts(view); };
    const auto is_fitted = [](const View& view) { return !view.held_out; };
    if (std::ranges::any_of(problem.views, is_fitted) &&
        std::ranges::none_of(problem.views, counts))
        throw InputError(
            "no pixel counts: the mask of every view that is fitted is 0 wherever its camera sees");
}

double mask_blind_pixels(const Renderer& renderer, View& view) {
    const TracedScene& scene = renderer.data().traced;
    if (!has_lens(scene.camera)) return 0;
    return mask_out(renderer, blind_pixels(scene), filter_halo(scene.film.filter), view);
}

double mask_background(const Renderer& renderer, View& view) {
    check_sizes(view, renderer);
    const TracedScene& scene = renderer.data().traced;
    require(!has_aperture(scene.camera),
            "the camera has an aperture, through which the background has no sharp edge: expected "
            "a mask of the view");
    std::vector<char> pixels =
        visible_pixels(scene, std::vector<char>(scene.scene->bsdfs.size(), 1));
    if (std::ranges::none_of(pixels, [](char seen) { return seen != 0; }))
        throw InputError(
            "no pixel shows a surface of the scene: do cameras and meshes have the same units and "
            "axes?");
    for (char& p : pixels) p = !p;
    const int reach = filter_halo(scene.film.filter) + 1;  // those at the edge show a part of it
    const double share = mask_out(renderer, pixels, reach, view);
    if (share == 1)
        throw InputError(
            fmt::format("every pixel that shows a surface lies at most {} pixel{} from the "
                        "background: expected a larger picture",
                        reach, reach == 1 ? "" : "s"));
    if (!any_pixel_counts(view))
        throw InputError(
            "no pixel counts: each that shows a surface has a mask or an alpha of 0, or is "
            "clipped; a mask is white where a pixel counts");
    return share;
}

std::vector<std::size_t> fitted_views(const Problem& problem) {
    std::vector<std::size_t> fitted;
    for (std::size_t i = 0; i < problem.views.size(); ++i)
        if (!problem.views[i].held_out) fitted.push_back(i);
    if (fitted.empty())
        throw InputError(
            "the problem has no view to fit: expected at least one that is not held "
            "out");
    return fitted;
}

std::vector<int> owners_of_views(const Problem& problem, std::size_t batch) {
    const Ranks& ranks = problem.ranks;
    const std::size_t fitted = fitted_views(problem).size();
    const auto count = static_cast<std::size_t>(ranks.count);
    if (batch < std::min(count, fitted))
        throw InputError(fmt::format(
            "{} processes share out the views of an iteration: found {} of {}, expected {}, or at "
            "most {} process{}; the option batch says how many",
            count, batch, fitted, count > fitted ? "all of them" : "at least one for each process",
            batch, batch == 1 ? "" : "es"));
    const std::vector<int> of_fitted = shared_out(ranks, fitted);
    const std::vector<int> of_held_out = shared_out(ranks, problem.views.size() - fitted);
    std::vector<int> owners;
    std::size_t f = 0, h = 0;
    for (const View& v : problem.views)
        owners.push_back(v.held_out ? of_held_out[h++] : of_fitted[f++]);
    return owners;
}

std::string name_of(const View& view, std::size_t number) {
    return view.name.empty() ? fmt::format("view {}", number) : view.name;
}

std::size_t find_view(const std::vector<std::string>& names, const std::string& name,
                      const std::string& option) {
    if (const auto found = std::ranges::find(names, name); found != names.end())
        return static_cast<std::size_t>(found - names.begin());
    std::vector<std::string> named = names;
    std::erase(named, "");
    throw InputError(fmt::format(
        "{}: no view is named \"{}\": {}", option, name,
        named.empty() ? "they have no names" : "expected one of " + list_of(std::move(named))));
}

std::uint32_t seed_of_view(std::uint32_t seed, std::size_t view) {
    if (view == 0) return seed;
    return philox4x32({static_cast<std::uint32_t>(view), 0, 1, 0},
                      {seed, static_cast<std::uint32_t>(Stream::kViews)})[0];
}

}  // namespace burnish
