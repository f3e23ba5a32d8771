#include "cli/run_views.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/view_pictures.h"
#include "core/at_place.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"
#include "render/renderer.h"
#include "render/view.h"

namespace burnish {

namespace {

[[noreturn]] void refuse_option(const char* option, const std::string& why) {
    throw UsageError(fmt::format("{}: {}", option, why));
}

std::vector<CapturedView> views_of_sensors(const RunSettings& run) {
    if (!run.targets.empty() && run.targets.size() != run.sensors.size())
        refuse_option("--target",
                      fmt::format("{} for {}: expected one after each --sensor, or none",
                                  run.targets.size(), count_text(run.sensors.size(), "sensor")));
    if (!run.mask.empty() && run.sensors.size() > 1)
        refuse_option("--mask",
                      "one for several sensors: expected a capture.json, which names the mask of "
                      "each view");
    std::vector<CapturedView> views;
    for (std::size_t i = 0; i < run.sensors.size(); ++i) {
        if (std::count(run.sensors.begin(), run.sensors.end(), run.sensors[i]) > 1)
            refuse_option("--sensor", fmt::format("'{}' is given twice: expected each view once",
                                                  run.sensors[i]));
        View view;
        view.name = run.sensors[i];
        view.camera = Sensor{run.sensors[i]};
        views.push_back({view, run.targets.empty() ? "" : run.targets[i], run.mask});
        views.back().places.camera = "--sensor";
    }
    return views;
}

/// The scene's own look, as the view's exposure shows it.
Image rendered(const Settings& settings, const View& view, const Renderer& renderer,
               std::size_t number, const std::string& what) {
    const RandomKey key{seed_of_view(settings.options.seed, number), Stream::kTarget};
    return exposed(
        factors_of(view.exposure),
        render_with_progress(renderer, key, settings.run.target_samples, "rendering " + what));
}

/// The option among those that say what the views are, of which only one kind may be given.
void refuse_view_options(const RunSettings& run, const char* what, const std::string& why) {
    for (const auto& [option, is_given] :
         {std::pair{"--target", !run.targets.empty()}, std::pair{"--sensor", !run.sensors.empty()},
          std::pair{"--mask", !run.mask.empty()}})
        if (is_given) refuse_option(option, std::string(what) + " " + why);
    if (!run.size.empty())
        refuse_option("--size",
                      std::string(what) + " says how large the pictures of its views are");
}

}  // namespace

void use_capture(const Capture& capture, SceneOptions& scene) {
    scene.place = scene.file + ": scene";
    scene.file = capture.scene;
    const std::vector<std::string> given = scene.definitions;
    for (const auto& definition : capture.definitions) {
        const std::string prefix = definition.first + "=";
        if (std::none_of(given.begin(), given.end(),
                         [&](const std::string& text) { return text.starts_with(prefix); }))
            scene.definitions.push_back(prefix + definition.second);
    }
}

namespace {

std::vector<CapturedView> named_views(const RunSettings& run,
                                      const std::optional<Capture>& capture) {
    if (capture) {
        if (!run.views.empty()) refuse_option("--views", "the capture names its views");
        refuse_view_options(run, "the capture",
                            "names the pictures, cameras and masks of its views");
        return capture->views;
    }
    if (!run.views.empty()) {
        if (!run.mask.empty())
            refuse_option(
                "--mask",
                "one for all of --views: expected a capture.json, which names the mask of "
                "each view; `burnish info --views ... --json` holds one as \"capture\"");
        refuse_view_options(run, "--views", "names the pictures and cameras of its views");
        return read_named_views(run.views, run.images);
    }
    if (!run.sensors.empty()) return views_of_sensors(run);
    if (run.targets.size() > 1)
        refuse_option("--target",
                      fmt::format("{} without --sensor: expected one", run.targets.size()));
    return {{{}, run.targets.empty() ? "" : run.targets.front(), run.mask}};
}

}  // namespace

std::vector<CapturedView> views_of(const RunSettings& run, const std::optional<Capture>& capture) {
    std::vector<CapturedView> views = named_views(run, capture);
    if (!capture)
        for (CapturedView& v : views) v.view.exposure = *parse_exposure(run.exposure);
    std::vector<std::string> names;
    for (const CapturedView& v : views) names.push_back(v.view.name);
    for (const std::string& name : run.held_out)
        views[find_view(names, name, "--hold-out")].view.held_out = true;
    return views;
}

namespace {

/// naming_view, of a view that has no place, with which errors would begin.
template <class Body>
auto naming_unplaced(const std::vector<CapturedView>& views, std::size_t i, const Body& body) {
    if (!views[i].places.view.empty()) return body();
    return naming_view(views[i].view, i, views.size(), body);
}

/// Throws InputError, which begins with the place of the key.
void require_sensor_and_emitters(const Renderer& renderer, const CapturedView& view) {
    const auto* sensor = std::get_if<Sensor>(&view.view.camera);
    if (sensor && !view.places.camera.empty())
        at_place(view.places.camera, [&] { (void)renderer.with_camera(*sensor); });
    if (const auto& emitters = view.view.lighting.emitters)
        at_place(view.places.emitters,
                 [&] { require_emitters(renderer.data().scene(), *emitters); });
}

}  // namespace

void size_cameras(const RunSettings& run, const Renderer& renderer,
                  const std::vector<Photograph>& photographs, std::vector<CapturedView>& views) {
    for (std::size_t i = 0; i < views.size(); ++i) {
        require_sensor_and_emitters(renderer, views[i]);
        views[i].view.camera = naming_unplaced(
            views, i, [&] { return camera_for(run, views[i], photographs[i], renderer); });
    }
}

std::vector<Renderer> make_captured_views(const Problem& problem,
                                          const std::vector<CapturedView>& views) {
    std::vector<Renderer> renderers;
    for (std::size_t i = 0; i < views.size(); ++i) {
        require_sensor_and_emitters(problem.renderer, views[i]);
        renderers.push_back(
            at_place(views[i].places.view, [&] { return make_view(problem, i, renderers); }));
    }
    return renderers;
}

namespace {

/// Of all views: what shows no surface.
void mask_backgrounds(const std::vector<Renderer>& renderers, std::vector<View>& views) {
    double min = 1, max = 0;
    for (std::size_t i = 0; i < views.size(); ++i)
        naming_view(views[i], i, views.size(), [&] {
            const double share = mask_background(renderers[i], views[i]);
            min = std::min(min, share), max = std::max(max, share);
        });
    const auto percent = [](double share) { return fmt::format("{:.0f}", 100 * share); };
    const std::string from = percent(min), to = percent(max);
    log_info(fmt::format("left out: {} % of a picture, which show no surface or its edge",
                         from == to ? to : from + " to " + to));
}

}  // namespace

std::vector<View> with_pictures(const Settings& settings, const std::vector<CapturedView>& views,
                                const std::vector<Renderer>& renderers,
                                std::vector<Photograph>& photographs) {
    std::vector<View> result;
    for (std::size_t i = 0; i < views.size(); ++i) {
        View view = views[i].view;
        const Renderer& renderer = renderers[i];
        const std::string what =
            "the target" + (views.size() == 1 ? "" : " of " + name_of(view, i));
        if (views[i].image.empty()) {
            view.mask = std::move(photographs[i].mask);
            photographs[i].mask = {};
            view.image = rendered(settings, view, renderer, i, what);
        } else {
            view.mask = weights_of(photographs[i]);
            view.image = std::move(photographs[i].image);
            photographs[i].image = {}, photographs[i].mask = {};
        }
        if (const std::string text = leave_out_blind_pixels(renderer, i, view); !text.empty())
            log_warning(text);
        result.push_back(std::move(view));
    }
    if (settings.run.ignore_background) mask_backgrounds(renderers, result);
    return result;
}

}  // namespace burnish
