// burnish scene: writes a scene that the program makes itself.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/option_text.h"
#include "cli/output_folder.h"
#include "cli/settings.h"
#include "scenes/procedural.h"

namespace burnish {

namespace {

struct WriteOptions {
    std::string name, output;
    ProceduralOptions scene;
};

std::string known_scenes() { return fmt::format("{}", fmt::join(procedural_scene_names(), ", ")); }

/// What else the folder holds stays, results too. Where a file cannot be written, all does.
void write_built_in(const WriteOptions& options) {
    require_known("scene", options.name, procedural_scene_names());
    OutputFolder output = open_output_folder(options.output, Found::kAllowed);
    output.earlier_files.clear();  // nothing is replaced as a whole
    write_procedural_scene(options.name, output.unfinished, options.scene);
    move_scene_into_place(output);
    log_info(options.output + "/scene.xml: the scene '" + options.name + "'");
}

}  // namespace

void add_scene_command(CLI::App& app) {
    auto options = std::make_shared<WriteOptions>();
    CLI::App* command =
        app.add_subcommand("scene", "Writes a built-in scene as a Mitsuba 3 scene folder");
    command->add_option("name", options->name, "The scene: " + known_scenes())
        ->type_name("NAME")
        ->required();
    add_text(*command, "-o,--output", options->output, "DIR",
             "The folder; files in it are replaced")
        ->required();
    add_number(*command, "--texture-size", options->scene.texture_size, "N",
               "Side of the main texture", {16, 8192, true});
    add_number(*command, "--seed", options->scene.seed, "S",
               "Moves scratches, spots, lights and clouds", find_setting("seed").info.range);
    command->callback([options] { write_built_in(*options); });
}

}  // namespace burnish
