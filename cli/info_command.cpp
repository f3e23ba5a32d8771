// burnish info: what a scene holds, as text or JSON on standard output.

#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/inspect.h"
#include "cli/progress.h"
#include "cli/scene_input.h"

namespace burnish {

namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
    SceneOptions scene;
    bool json = false;
};

void print_sentences(const char* title, const std::vector<std::string>& sentences) {
    if (sentences.empty()) return;
    fmt::print("\n{}\n", title);
    for (const std::string& s : sentences) fmt::print("  {}\n", s);
}

void print_parameters(const SceneFacts& facts) {
    fmt::print("\nparameters\n");
    std::size_t width = 4;
    for (const ParameterFacts& p : facts.parameters) width = std::max(width, p.name.size());
    if (facts.parameters.empty())
        fmt::print("  none: no BSDF reads a bitmap\n");
    else
        fmt::print("  {:<{}}  {:<13}  {:<21}  {:<22}  {:>10}  {}\n", "name", width, "texels",
                   "read as", "min   mean  max", "in picture", "file");
    for (const ParameterFacts& p : facts.parameters)
        fmt::print("  {:<{}}  {:<13}  {:<21}  {:<22}  {:>8.1f} %  {}\n", p.name, width,
                   fmt::format("{}x{}x{}", p.width, p.height, p.channels),
                   fmt::format("{} {}{}", name_of(p.filter), name_of(p.wrap), p.raw ? " raw" : ""),
                   fmt::format("{:.3f} {:.3f} {:.3f}", p.low, p.mean, p.high), 100 * p.seen,
                   p.file);
}

void print_lights(const SceneFacts& facts) {
    fmt::print("\nlights\n");
    if (facts.lights.empty()) fmt::print("  none\n");
    for (const LightFacts& l : facts.lights) {
        fmt::print("  {:<12} {:>4}", l.kind, l.count);
        if (l.area > 0) fmt::print("  area {:.4g}", l.area);
        if (l.power > 0) fmt::print("  power {:.4g}", l.power);
        if (l.mean_radiance > 0) fmt::print("  mean radiance {:.4g}", l.mean_radiance);
        fmt::print("\n");
    }
}

void print_text(const std::string& file, const LoadedScene& loaded, const SceneFacts& facts) {
    const Scene& scene = loaded.scene;
    const Film& film = scene.film;
    const Vec3f eye = transform_point(scene.camera.to_world, {0, 0, 0});
    fmt::print("{}\n", file);
    fmt::print("  film     {} x {} pixels, {} filter, {} samples per pixel\n", film.crop_width,
               film.crop_height, name_of(film.filter.kind), scene.sample_count);
    fmt::print("  camera   at ({:.4g}, {:.4g}, {:.4g}), {:.4g} degrees wide\n", eye.x, eye.y, eye.z,
               scene.camera.fov_x);
    fmt::print("  shapes   {} meshes, {} spheres, {} disks; {} triangles, {} vertices\n",
               facts.meshes, facts.spheres, facts.disks, count_text(facts.triangles),
               count_text(facts.vertices));
    fmt::print("  memory   about {} once it is ready\n", bytes_text(facts.memory));
    print_parameters(facts);
    print_lights(facts);
    print_sentences("defaults that were chosen", loaded.notes);
    print_sentences("warnings of the reader", loaded.warnings);
    if (facts.findings.empty())
        fmt::print("\nnothing looks wrong\n");
    else
        print_sentences("what looks wrong", facts.findings);
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
            {"mean_radiance", l.mean_radiance}};
}

void print_json(const std::string& file, const LoadedScene& loaded, const SceneFacts& facts) {
    const Scene& scene = loaded.scene;
    Json json{{"scene", file},
              {"film", {scene.film.crop_width, scene.film.crop_height}},
              {"filter", name_of(scene.film.filter.kind)},
              {"samples_per_pixel", scene.sample_count},
              {"fov_x", scene.camera.fov_x},
              {"meshes", facts.meshes},
              {"spheres", facts.spheres},
              {"disks", facts.disks},
              {"triangles", facts.triangles},
              {"vertices", facts.vertices}};
    json["parameters"] = Json::array();
    for (const ParameterFacts& p : facts.parameters)
        json["parameters"].push_back(parameter_json(p));
    json["lights"] = Json::array();
    for (const LightFacts& l : facts.lights) json["lights"].push_back(light_json(l));
    json["memory_bytes"] = std::round(facts.memory);
    json["notes"] = loaded.notes;
    json["warnings"] = loaded.warnings;
    json["findings"] = facts.findings;
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

void run(const InfoOptions& options) {
    const Renderer renderer = make_renderer_with_progress(load_scene_quietly(options.scene),
                                                          options.scene.light_selection);
    const SceneFacts facts = inspect(renderer.data().traced);
    (options.json ? print_json : print_text)(options.scene.file, *renderer.data().loaded, facts);
}

}  // namespace

void add_info_command(CLI::App& app) {
    auto options = std::make_shared<InfoOptions>();
    CLI::App* command =
        app.add_subcommand("info", "Says what a scene holds and what looks wrong in it");
    command->add_flag("--json", options->json, "For machines");
    add_scene_options(*command, options->scene, true, false);
    command->callback([options] { run(*options); });
}

}  // namespace burnish
