#include "cli/scene_input.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/error.h"
#include "captures/views.h"
#include "captures/views_colmap.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/option_text.h"
#include "cli/progress.h"
#include "cli/settings.h"
#include "cli/texture_files.h"
#include "core/at_place.h"
#include "image/files.h"
#include "image/image.h"
#include "scene/constants.h"
#include "scene/value_range.h"

namespace burnish {

namespace {

constexpr std::size_t kMaxListed = 8;

const char* sentence(const char* name) { return find_setting(name).info.sentence; }

/// The name of --texture NAME=VALUE may hold a = itself: the longest that the scene has is meant.
std::pair<std::string, std::string> split_texture(const Scene& scene, const std::string& text) {
    for (std::size_t at = text.rfind('='); at != std::string::npos && at > 0;
         at = text.rfind('=', at - 1))
        if (means_input(scene, text.substr(0, at)))
            return {text.substr(0, at), text.substr(at + 1)};
    return split_assignment("--texture", text);
}

}  // namespace

void log_without_history(const Estimator& estimator) {
    const auto* reservoirs = std::get_if<Reservoirs>(&estimator);
    if (!reservoirs || !reservoirs->reuse) return;
    log_info(fmt::format("note: one call has no iteration before it: {} is {} here",
                         name_of(estimator), reservoirs->positivization ? "pris" : "ris"));
}

void log_first(const std::vector<std::string>& sentences, void (*log_one)(const std::string&),
               const std::string& where) {
    for (std::size_t i = 0; i < std::min(sentences.size(), kMaxListed); ++i) log_one(sentences[i]);
    if (sentences.size() > kMaxListed)
        log_info(fmt::format("... and {} more: {}", sentences.size() - kMaxListed, where));
}

void add_scene_options(CLI::App& app, SceneOptions& options) {
    add_text(app, "scene", options.file, "SCENE.xml", "The scene, a Mitsuba 3 XML file")
        ->required();
    app.add_option("-D", options.definitions, sentence("scene.definitions"))
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false)
        ->group("Scene");
    app.add_option("--size", options.size, sentence("scene.size"))
        ->type_name("W H")
        ->expected(2)
        ->check(in_range(find_setting("scene.size").info.range))
        ->group("Scene");
    app.add_flag("--ignore-unsupported", options.ignore_unsupported,
                 sentence("scene.ignore_unsupported"))
        ->group("Scene");
}

void add_render_options(CLI::App& app, SceneOptions& options) {
    add_scene_options(app, options);
    add_text(app, "--sensor", options.sensor, "ID", "Camera of the scene file, by id or number")
        ->group("Scene");
    const OptionInfo &seed = find_setting("seed").info, &threads = find_setting("run.threads").info;
    add_number(app, "--seed", options.seed, "S", seed.sentence, seed.range)->group("Scene");
    add_number(app, "--threads", options.threads, "T", threads.sentence, threads.range)
        ->group("Scene");
    add_choice(app, "--light-selection", options.light_selection, sentence("scene.light_selection"))
        ->group("Scene");
}

void add_views_options(CLI::App& app, std::string& views, std::string& images) {
    CLI::Option* option =
        add_text(app, "--views", views, "PATH", sentence("problem.views"))->group("Scene");
    add_text(app, "--images", images, "DIR", sentence("problem.images"))
        ->needs(option)
        ->group("Scene");
}

std::vector<CapturedView> read_named_views(const std::string& views, const std::string& images) {
    std::error_code ignored;  // reading them says why
    if (images.empty() && std::filesystem::is_directory(views, ignored)) {
        require_reconstruction(views);
        throw UsageError("--images: expected the folder of the pictures that " + views + " names");
    }
    return read_views(views, images);
}

void add_texture_option(CLI::App& app, std::vector<std::string>& textures) {
    app.add_option("--texture", textures,
                   "Replaces the texels of a parameter by a number or an image; repeatable")
        ->type_name("NAME=VALUE|FILE")
        ->allow_extra_args(false);
}

void replace_textures(Scene& scene, const std::vector<std::string>& assignments) {
    std::vector<std::string> names;
    std::vector<TextureId> replaced;
    for (const std::string& assignment : assignments) {
        const auto [name, value] = split_texture(scene, assignment);
        if (value.empty())
            throw UsageError("--texture: " + name + ": " + complaint_of_empty(value));
        const Parameter p = scene.parameters[require_parameter(scene, name)];
        if (const auto same = std::ranges::find(replaced, p.texture); same != replaced.end()) {
            const std::string& other = names[static_cast<std::size_t>(same - replaced.begin())];
            throw UsageError(other == name ? fmt::format("--texture: '{}' is given twice", name)
                                           : fmt::format("--texture: '{}' and '{}' are one texture",
                                                         other, name));
        }
        names.push_back(name), replaced.push_back(p.texture);
        auto& bitmap = std::get<Bitmap>(scene[p.texture]);
        const Image texels = read_texels(bitmap, value, "the texture for " + p.name);
        const float max = largest_value(scene, p.texture);
        if (!std::all_of(texels.values.begin(), texels.values.end(),
                         [&](float v) { return v >= 0 && v <= max; }))
            throw InputError(
                fmt::format("the texture for {} holds values outside of [0, {}]", p.name, max));
        replace_texels(bitmap, texels);
    }
}

std::pair<std::string, std::string> split_assignment(const std::string& option,
                                                     const std::string& text) {
    const std::size_t at = text.find('=');
    if (at == std::string::npos || at == 0)
        throw UsageError(fmt::format("{}: expected NAME=VALUE, found '{}'", option, text));
    return {text.substr(0, at), text.substr(at + 1)};
}

std::map<std::string, std::string> definitions_of(const SceneOptions& options) {
    std::map<std::string, std::string> definitions;
    for (const std::string& definition : options.definitions) {
        const auto [name, value] = split_assignment("-D", definition);
        if (!definitions.emplace(name, value).second)
            throw UsageError(fmt::format("-D: '{}' is defined twice", name));
    }
    return definitions;
}

namespace {

/// Throws InputError where views are given in the place of their scene.
void require_no_views(const std::string& file) {
    if (is_capture(file) && std::filesystem::exists(status_of(file)))
        throw InputError(fmt::format(
            "{}: found a JSON file, expected a Mitsuba scene in XML: `burnish optimize` and "
            "`burnish info` read a capture.json in its place, a transforms.json as --views",
            file));
}

}  // namespace

LoadedScene load_scene_quietly(const SceneOptions& options) {
    LoadOptions load;
    load.definitions = definitions_of(options);
    load.ignore_unsupported = options.ignore_unsupported;
    load.before_reading = options.before_reading;
    if (!options.size.empty()) load.width = options.size[0], load.height = options.size[1];
    const TickingLine line("loading " + options.file);
    return at_place(options.place, [&] {
        require_no_views(options.file);
        return load_scene(options.file, load);
    });
}

LoadedScene load_scene_with_progress(const SceneOptions& options) {
    LoadedScene loaded = load_scene_quietly(options);
    log_first(loaded.warnings, log_warning, "`burnish info` lists them");
    log_first(
        loaded.notes, [](const std::string& text) { log_info("note: " + text); },
        "`burnish info` lists them");
    return loaded;
}

Renderer make_renderer_with_progress(LoadedScene loaded, LightSelection selection,
                                     const std::string& sensor) {
    const TickingLine line("building the ray structure");
    const Renderer renderer = make_renderer(std::move(loaded), selection);
    if (sensor.empty()) return renderer;
    return at_place("--sensor", [&] { return renderer.with_camera(Sensor{sensor}); });
}

Image render_with_progress(const Renderer& renderer, RandomKey key, std::uint32_t samples_per_pixel,
                           const std::string& title) {
    const TextureTable textures{renderer.data().scene().textures, {}};
    const TraceInput input{.scene = &renderer.data().traced, .textures = &textures, .key = key};
    ProgressLine line(title);
    RenderCounts counts;
    Image image = render(input, 0, samples_per_pixel, &counts, progress_of(line));
    if (counts.rejected > 0)
        log_warning(fmt::format("{} samples of the image were not finite and were left out",
                                count_text(counts.rejected)));
    return image;
}

}  // namespace burnish
