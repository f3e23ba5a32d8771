#include "cli/run_views.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/texture_files.h"
#include "cli/views_colmap.h"
#include "cli/views_transforms.h"
#include "optimize/views.h"

namespace burnish {

namespace {

void refuse(const std::string& what, const std::string& why) {
    throw InputError(fmt::format("{}: {}", what, why));
}

std::vector<CapturedView> views_of_sensors(const RunSettings& run) {
    if (!run.targets.empty() && run.targets.size() != run.sensors.size())
        refuse("--target",
               fmt::format("{} for {} sensors: expected one after each --sensor, or none",
                           run.targets.size(), run.sensors.size()));
    if (!run.mask.empty() && run.sensors.size() > 1)
        refuse("--mask",
               "one for several sensors: expected a capture.json, which names the mask of "
               "each view");
    std::vector<CapturedView> views;
    for (std::size_t i = 0; i < run.sensors.size(); ++i) {
        View view;
        view.name = run.sensors[i];
        view.camera = Sensor{run.sensors[i]};
        views.push_back({view, run.targets.empty() ? "" : run.targets[i], run.mask});
    }
    return views;
}

Image picture(const Settings& settings, const CapturedView& captured, const Renderer& renderer,
              std::size_t number, bool is_one) {
    const std::string of = is_one ? "" : " of " + captured.view.name;
    if (!captured.image.empty())
        return as_rgb(
            read_radiance(captured.image, renderer.width(), renderer.height(), "the target" + of));
    return render_with_progress(renderer,
                                {seed_of_view(settings.options.seed, number), Stream::kTarget},
                                settings.run.target_samples, "rendering the target" + of);
}

/// The option among those that say what the views are, of which only one kind may be given.
void refuse_view_options(const RunSettings& run, const char* what, const std::string& why) {
    for (const auto& [option, is_given] :
         {std::pair{"--target", !run.targets.empty()}, std::pair{"--sensor", !run.sensors.empty()},
          std::pair{"--mask", !run.mask.empty()}})
        if (is_given) refuse(option, std::string(what) + " " + why);
    if (!run.size.empty())
        refuse("--size", std::string(what) + " says how large the pictures of its views are");
}

}  // namespace

std::vector<CapturedView> read_views(const std::string& views, const std::string& images) {
    if (std::filesystem::is_directory(views)) {
        if (images.empty())
            refuse("--images", "expected the folder of the pictures that " + views + " names");
        return read_colmap(views, images);
    }
    if (std::filesystem::path(views).extension() != ".json")
        refuse("--views",
               fmt::format("found {}, expected the folder of a COLMAP reconstruction, or "
                           "a transforms.json",
                           views));
    return read_transforms(views, images);
}

void use_capture(const Capture& capture, SceneOptions& scene) {
    scene.file = capture.scene;
    const std::vector<std::string> given = scene.definitions;
    for (const auto& definition : capture.definitions) {
        const std::string prefix = definition.first + "=";
        if (std::none_of(given.begin(), given.end(),
                         [&](const std::string& text) { return text.starts_with(prefix); }))
            scene.definitions.push_back(prefix + definition.second);
    }
}

std::vector<CapturedView> views_of(const RunSettings& run, const std::optional<Capture>& capture) {
    if (capture) {
        if (!run.views.empty()) refuse("--views", "the capture names its views");
        refuse_view_options(run, "the capture",
                            "names the pictures, cameras and masks of its views");
        return capture->views;
    }
    if (!run.views.empty()) {
        refuse_view_options(run, "--views", "names the pictures and cameras of its views");
        return read_views(run.views, run.images);
    }
    if (!run.sensors.empty()) return views_of_sensors(run);
    if (run.targets.size() > 1)
        refuse("--target", fmt::format("{} without --sensor: expected one", run.targets.size()));
    return {{{}, run.targets.empty() ? "" : run.targets.front(), run.mask}};
}

std::vector<View> with_pictures(const Settings& settings, const std::vector<CapturedView>& views,
                                const std::vector<Renderer>& renderers) {
    std::vector<View> result;
    for (std::size_t i = 0; i < views.size(); ++i) {
        View view = views[i].view;
        view.image = picture(settings, views[i], renderers[i], i, views.size() == 1);
        if (!views[i].mask.empty())
            view.mask = read_mask(views[i].mask, renderers[i].width(), renderers[i].height());
        if (const double share = mask_blind_pixels(renderers[i], view); share > 0)
            log_warning(
                fmt::format("{}: {:.1f} % of the pixels lie outside of the field of its lens "
                            "and are left out",
                            name_of(view, i), 100 * share));
        result.push_back(std::move(view));
    }
    return result;
}

}  // namespace burnish
