// burnish new: a scene folder to begin with, from a mesh and a sky.

#include <fmt/format.h>

#include <CLI/App.hpp>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/new_scene.h"
#include "cli/option_text.h"
#include "cli/scene_input.h"
#include "core/at_place.h"
#include "optimize/views.h"

namespace burnish {

namespace {

struct NewOptions {
    NewScene scene;
    std::string views, images, output, up = "y";
};

/// Of the views, the first of which the scene can have.
std::vector<Camera> read_cameras(const NewOptions& options) {
    std::vector<Camera> cameras;
    const std::vector<CapturedView> views = read_named_views(options.views, options.images);
    for (const CapturedView& v : views) cameras.push_back(std::get<Camera>(v.view.camera));
    const std::string& place = views.front().places.camera;
    at_place(place.empty() ? options.views + ": " + name_of(views.front().view, 0) : place,
             [&] { require_scene_camera(cameras.front()); });
    return cameras;
}

void run(const NewOptions& options) {
    NewScene scene = options.scene;
    scene.up = options.up == "z" ? UpAxis::kZ : UpAxis::kY;
    if (!options.views.empty()) scene.cameras = read_cameras(options);
    const NewSceneReport report = write_new_scene(scene, options.output);
    const std::string file = (std::filesystem::path(options.output) / "scene.xml").string();
    log_info(fmt::format("{}: {} in {}, {:.0f} % of the texture is used", file,
                         count_text(report.triangles, "triangle"),
                         count_text(report.charts, "chart"), 100 * report.used_share));
    for (const std::string& text : report.warnings)
        log_warning(fmt::format("{}: {}", scene.mesh.string(), text));
    for (const std::string& text : report.camera_warnings)
        log_warning(fmt::format("{}: {}", options.views, text));
    for (const std::string& text : report.notes) log_info("note: " + text);
    if (scene.environment.empty())
        log_info("note: no --environment: light of radiance 1 comes from everywhere");
    log_info(fmt::format("look at it:       burnish render {} -o look.png", shell_word(file)));
    std::string pictures = "--target PHOTO";
    if (!options.views.empty()) pictures = "--views " + shell_word(options.views);
    if (!options.images.empty()) pictures += " --images " + shell_word(options.images);
    log_info(
        fmt::format("recover textures: burnish optimize {} {} --exposure fit --ignore-background "
                    "--parameter {}.base_color --parameter {}.roughness -o out",
                    shell_word(file), pictures, report.material, report.material));
}

}  // namespace

void add_new_command(CLI::App& app) {
    auto options = std::make_shared<NewOptions>();
    CLI::App* command = app.add_subcommand(
        "new", "Makes a scene folder from a mesh and a sky: textures at 0.5, to be recovered");
    add_text(*command, "--mesh", options->scene.mesh, "FILE",
             "The mesh, with texture coordinates: OBJ, PLY or GLB")
        ->required();
    add_text(*command, "--environment", options->scene.environment, "FILE",
             "Radiance from all directions, longitude and latitude: HDR, EXR or PFM [1 from "
             "everywhere]");
    add_views_options(*command, options->views, options->images);
    add_text(*command, "-o,--output", options->output, "DIR", "The folder; a new or an empty one")
        ->required();
    add_number(*command, "--texture-size", options->scene.texture_size, "N", "Side of the textures",
               {1, 8192, true});
    command->add_option("--up", options->up, "The axis of the mesh that points up")
        ->type_name("y|z")
        ->check(CLI::Validator(
            [](const std::string& text) {
                return text == "y" || text == "z" ? "" : "expected y or z, found '" + text + "'";
            },
            ""))
        ->capture_default_str();
    command->callback([options, command] {
        if (command->count("--up") > 0 && !options->views.empty() &&
            options->scene.environment.empty())
            throw UsageError("--up has no effect with --views: it needs --environment");
        run(*options);
    });
}

}  // namespace burnish
