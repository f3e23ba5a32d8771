// burnish info: what a scene holds, as text or JSON on standard output.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "captures/capture_json.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/failures.h"
#include "cli/inspect.h"
#include "cli/run_views.h"
#include "cli/scene_input.h"
#include "cli/unseeing_views.h"
#include "cli/view_pictures.h"
#include "gradient/theta.h"
#include "scene/blends.h"
#include "scene/constants.h"

namespace burnish {

namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
    SceneOptions scene;
    std::string views, images;
    bool json = false;
};

/// A view of a capture or of --views.
struct ViewFacts {
    std::string name;
    bool held_out = false;
    int width = 0, height = 0;
    std::string camera, image;
};

/// Names of a scene file may hold anything.
template <class... Values>
void show_text(fmt::format_string<Values...> text, Values&&... values) {
    print(printable(fmt::format(text, std::forward<Values>(values)...)));
}

void print_sentences(const char* title, const std::vector<std::string>& sentences) {
    if (sentences.empty()) return;
    show_text("\n{}\n", title);
    for (const std::string& s : sentences) show_text("  {}\n", s);
}

void print_parameters(const SceneFacts& facts) {
    show_text("\nparameters\n");
    std::size_t width = 4;
    for (const ParameterFacts& p : facts.parameters) width = std::max(width, p.name.size());
    if (facts.parameters.empty())
        show_text("  none: no BSDF reads a bitmap that can be recovered\n");
    else
        show_text("  {:<{}}  {:<13}  {:<21}  {:<22}  {:>10}  {}\n", "name", width, "texels",
                  "read as", "min   mean  max", "in picture", "file");
    for (const ParameterFacts& p : facts.parameters)
        show_text("  {:<{}}  {:<13}  {:<21}  {:<22}  {:>8.1f} %  {}\n", p.name, width,
                  fmt::format("{}x{}x{}", p.width, p.height, p.channels),
                  fmt::format("{} {}{}", name_of(p.filter), name_of(p.wrap), p.raw ? " raw" : ""),
                  fmt::format("{:.3f} {:.3f} {:.3f}", p.low, p.mean, p.high), 100 * p.seen, p.file);
}

std::string value_text(const Image& value) {
    std::string text;
    for (const float v : value.values) text += fmt::format(" {:g}", v);
    return text;
}

/// Those that the scene file gives, each name once; they can be recovered, too.
std::vector<const ConstantParameter*> given_constants(const Scene& scene) {
    std::vector<const ConstantParameter*> given;
    for (const ConstantParameter& c : scene.constants)
        if (c.is_given && std::ranges::none_of(given, [&](const ConstantParameter* other) {
                return other->name == c.name;
            }))
            given.push_back(&c);
    return given;
}

void print_constants(const Scene& scene) {
    std::string lines;
    for (const ConstantParameter* c : given_constants(scene))
        lines += fmt::format("  {} {}\n", c->name, value_text(value_of(scene, *c)));
    if (!lines.empty()) show_text("\nconstants: one value, or NAME:SIZE for a texture\n{}", lines);
}

void print_lights(const SceneFacts& facts) {
    show_text("\nlights\n");
    if (facts.lights.empty()) show_text("  none\n");
    for (const LightFacts& l : facts.lights) {
        show_text("  {:<12} {:>4}", l.kind, l.count);
        if (l.area > 0) show_text("  area {:.4g}", l.area);
        if (l.power > 0) show_text("  power {:.4g}", l.power);
        if (l.mean_radiance > 0) show_text("  mean radiance {:.4g}", l.mean_radiance);
        if (l.irradiance > 0) show_text("  irradiance {:.4g}", l.irradiance);
        show_text("\n");
    }
}

std::string camera_text(const ViewCamera& camera) {
    if (const auto* sensor = std::get_if<Sensor>(&camera)) return "sensor " + sensor->name;
    switch (std::get<Camera>(camera).lens.kind) {
        case LensKind::kPinhole:
            return "pinhole";
        case LensKind::kBrownConrady:
            return "distorted";
        case LensKind::kFisheye:
            return "fisheye";
    }
    return {};
}

/// Those that were given, or the cameras that a view can name.
void print_views(const Scene& scene, const std::vector<ViewFacts>& views) {
    if (!views.empty()) show_text("\nviews\n");
    for (const ViewFacts& v : views)
        show_text("  {:<16} {:<5} {:>5} x {:<5} {:<16} {}\n", v.name, v.held_out ? "test" : "train",
                  v.width, v.height, v.camera, v.image.empty() ? "rendered" : v.image);
    if (views.empty() && scene.sensors.size() > 1) {
        show_text("\nsensors\n");
        for (const SceneSensor& s : scene.sensors)
            show_text("  {:<16} {} x {}\n", s.id, s.film.crop_width, s.film.crop_height);
    }
}

std::string view_text(const PerspectiveCamera& camera) {
    if (camera.orthographic_width > 0)
        return fmt::format("orthographic, {:.4g} wide", camera.orthographic_width);
    const std::string wide = fmt::format("{:.4g} degrees wide", camera.fov_x);
    if (!(camera.aperture_radius > 0)) return wide;
    return fmt::format("{}, aperture {:.4g}, in focus at {:.4g}", wide, camera.aperture_radius,
                       camera.focus_distance);
}

void print_text(const std::string& file, const LoadedScene& loaded, const SceneFacts& facts,
                const std::vector<ViewFacts>& views) {
    const Scene& scene = loaded.scene;
    const Film& film = scene.film;
    const Vec3f eye = transform_point(scene.camera.to_world, {0, 0, 0});
    show_text("{}\n", file);
    show_text("  film     {} x {} pixels, {} filter, {} per pixel\n", film.crop_width,
              film.crop_height, name_of(film.filter.kind),
              count_text(static_cast<std::size_t>(scene.sample_count), "sample"));
    show_text("  camera   at ({:.4g}, {:.4g}, {:.4g}), {}\n", eye.x, eye.y, eye.z,
              view_text(scene.camera));
    show_text("  shapes   {}, {}, {}, {}, {}; {}, {}\n", count_text(facts.meshes, "mesh", "meshes"),
              count_text(facts.spheres, "sphere"), count_text(facts.disks, "disk"),
              count_text(facts.cylinders, "cylinder"), count_text(facts.instances, "instance"),
              count_text(facts.triangles, "triangle"),
              count_text(facts.vertices, "vertex", "vertices"));
    show_text("  memory   about {} once it is ready\n", bytes_text(facts.memory));
    show_text("  time     about {} for one sample per pixel\n", short_duration_text(facts.seconds));
    print_parameters(facts);
    print_constants(scene);
    print_lights(facts);
    if (!scene.emitter_ids.empty()) show_text("  ids: {}\n", fmt::join(scene.emitter_ids, ", "));
    print_views(scene, views);
    print_sentences("defaults that were chosen", loaded.notes);
    print_sentences("warnings of the reader", loaded.warnings);
    print_sentences("what looks wrong", facts.findings);
    if (facts.findings.empty() && loaded.warnings.empty()) show_text("\nnothing looks wrong\n");
}

Json parameter_json(const ParameterFacts& p) {
    return {{"name", p.name}, {"size", {p.width, p.height, p.channels}},
            {"file", p.file}, {"filter", name_of(p.filter)},
            {"raw", p.raw},   {"wrap", name_of(p.wrap)},
            {"min", p.low},   {"mean", p.mean},
            {"max", p.high},  {"share_of_picture", p.seen}};
}

Json light_json(const LightFacts& l) {
    return {{"kind", l.kind},
            {"count", l.count},
            {"area", l.area},
            {"power", l.power},
            {"mean_radiance", l.mean_radiance},
            {"irradiance", l.irradiance}};
}

/// capture: of views that have no such file yet; else null.
void print_json(const std::string& file, const LoadedScene& loaded, const SceneFacts& facts,
                const std::vector<ViewFacts>& views, const Json& capture) {
    const Scene& scene = loaded.scene;
    Json json{{"scene", file},
              {"film", {scene.film.crop_width, scene.film.crop_height}},
              {"filter", name_of(scene.film.filter.kind)},
              {"samples_per_pixel", scene.sample_count},
              {"fov_x", scene.camera.fov_x},
              {"meshes", facts.meshes},
              {"spheres", facts.spheres},
              {"disks", facts.disks},
              {"cylinders", facts.cylinders},
              {"instances", facts.instances},
              {"triangles", facts.triangles},
              {"vertices", facts.vertices}};
    json["parameters"] = Json::array();
    for (const ParameterFacts& p : facts.parameters)
        json["parameters"].push_back(parameter_json(p));
    json["constants"] = Json::array();
    for (const ConstantParameter* c : given_constants(scene))
        json["constants"].push_back({{"name", c->name}, {"value", value_of(scene, *c).values}});
    json["lights"] = Json::array();
    for (const LightFacts& l : facts.lights) json["lights"].push_back(light_json(l));
    json["emitters"] = scene.emitter_ids;
    json["sensors"] = Json::array();
    for (const SceneSensor& s : scene.sensors)
        json["sensors"].push_back(
            {{"id", s.id}, {"film", {s.film.crop_width, s.film.crop_height}}});
    json["views"] = Json::array();
    for (const ViewFacts& v : views)
        json["views"].push_back({{"name", v.name},
                                 {"split", v.held_out ? "test" : "train"},
                                 {"size", {v.width, v.height}},
                                 {"camera", v.camera},
                                 {"image", v.image}});
    if (!capture.is_null()) json["capture"] = capture;
    json["seconds_per_sample"] = facts.seconds;
    json["memory_bytes"] = std::round(facts.memory);
    json["notes"] = loaded.notes;
    json["warnings"] = loaded.warnings;
    json["findings"] = facts.findings;
    print(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// Leaves out what optimize would refuse.
void keep_recoverable(Scene& scene) {
    separate_parts(scene);  // how many blends a texture is inside of
    std::erase_if(scene.parameters,
                  [&](const Parameter& p) { return !can_be_recovered(scene, p.texture); });
    std::erase_if(scene.constants, [&](const ConstantParameter& c) {
        return !c.blend && delta_lobes(scene, c.bsdf) != DeltaLobes::kNone;
    });
}

/// Views of their pictures' sizes, without the pictures.
Problem problem_of(const Renderer& renderer, const std::vector<CapturedView>& captured,
                   const std::vector<ViewCamera>& cameras) {
    Problem problem{renderer, {}, {}, {}};
    for (std::size_t i = 0; i < captured.size(); ++i) {
        problem.views.push_back(captured[i].view);
        problem.views[i].camera = cameras[i];
    }
    return problem;
}

std::vector<TracedScene> fitted_scenes(const Problem& problem,
                                       const std::vector<Renderer>& renderers) {
    std::vector<TracedScene> scenes;
    for (std::size_t i = 0; i < renderers.size(); ++i)
        if (!problem.views[i].held_out) scenes.push_back(renderers[i].data().traced);
    return scenes;
}

std::vector<ViewFacts> facts_of_views(const Problem& problem,
                                      const std::vector<Renderer>& renderers,
                                      const std::vector<CapturedView>& captured) {
    std::vector<ViewFacts> facts;
    for (std::size_t i = 0; i < renderers.size(); ++i)
        facts.push_back({problem.views[i].name, problem.views[i].held_out, renderers[i].width(),
                         renderers[i].height(), camera_text(problem.views[i].camera),
                         captured[i].image});
    return facts;
}

void find_blind_pixels(const Problem& problem, const std::vector<Renderer>& renderers,
                       std::vector<std::string>& findings) {
    for (std::size_t i = 0; i < renderers.size(); ++i) {
        View view = problem.views[i];
        if (std::string text = leave_out_blind_pixels(renderers[i], i, view); !text.empty())
            findings.push_back(std::move(text));
    }
}

/// Held-out ones, too: what they show tells nothing either.
void find_empty_views(const std::vector<ViewFacts>& views, const std::vector<Renderer>& renderers,
                      std::vector<std::string>& findings) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < views.size(); ++i)
        if (!shows_a_shape(renderers[i].data().traced)) names.push_back(views[i].name);
    if (names.empty()) return;
    const bool is_one = names.size() == 1;
    findings.push_back(fmt::format(
        "{} of {} {} no shape at all: expected cameras in the units and axes of the scene",
        is_one ? "a coarse picture" : "coarse pictures", views_text(std::move(names)),
        is_one ? "shows" : "show"));
}

/// What --views names, as a capture of its own.
Json capture_of_views(const InfoOptions& options, const std::vector<CapturedView>& views) {
    if (options.views.empty()) return {};
    return to_json(Capture{options.scene.file, definitions_of(options.scene), views});
}

void run(const InfoOptions& options) {
    SceneOptions scene = options.scene;
    const std::optional<Capture> capture = capture_at(scene.file);
    if (capture) use_capture(*capture, scene);
    std::vector<CapturedView> captured;
    if (capture) captured = capture->views;
    if (capture && !options.views.empty()) throw UsageError("--views: the capture names its views");
    if ((capture || !options.views.empty()) && !scene.size.empty())
        throw UsageError("--size: the views have sizes of their own");
    if (!options.views.empty()) captured = read_named_views(options.views, options.images);
    LoadedScene loaded = load_scene_quietly(scene);
    keep_recoverable(loaded.scene);
    const Renderer renderer = make_renderer_with_progress(std::move(loaded), scene.light_selection);
    CheckedViews checked = check_views(renderer, captured);
    const Problem problem = problem_of(renderer, captured, checked.cameras);
    const std::vector<Renderer> renderers = make_captured_views(problem, captured);
    SceneFacts facts = inspect(renderer.data().traced, fitted_scenes(problem, renderers));
    for (std::string& finding : checked.findings) facts.findings.push_back(std::move(finding));
    if (!captured.empty() &&
        std::ranges::all_of(captured, [](const CapturedView& v) { return v.view.held_out; }))
        facts.findings.push_back("all views are held out: none is left to be fitted");
    const std::vector<ViewFacts> views = facts_of_views(problem, renderers, captured);
    find_blind_pixels(problem, renderers, facts.findings);
    find_empty_views(views, renderers, facts.findings);
    const LoadedScene& shown = *renderer.data().loaded;
    if (options.json)
        print_json(options.scene.file, shown, facts, views, capture_of_views(options, captured));
    else
        print_text(options.scene.file, shown, facts, views);
}

}  // namespace

void add_info_command(CLI::App& app) {
    auto options = std::make_shared<InfoOptions>();
    CLI::App* command =
        app.add_subcommand("info", "Says what a scene holds and what looks wrong in it");
    command->add_flag("--json", options->json, "Writes JSON");
    add_scene_options(*command, options->scene);
    command->get_option("scene")->description("A Mitsuba 3 XML file, or a capture.json");
    add_views_options(*command, options->views, options->images);
    command->callback([options] { run(*options); });
}

}  // namespace burnish
