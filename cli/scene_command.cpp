// burnish scene: writes a scene that the program makes itself.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/option_text.h"
#include "cli/output_folder.h"
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
    OutputFolder output = open_output_folder(options.output, Found::kAllowed);
    output.earlier_files.clear();  // nothing is replaced as a whole
    write_procedural_scene(options.name, output.unfinished, options.scene);
    move_into_place(output);
    log_info(options.output + "/scene.xml: the scene '" + options.name + "'");
}

}  // namespace

void add_scene_command(CLI::App& app) {
    auto options = std::make_shared<WriteOptions>();
    CLI::App* command =
        app.add_subcommand("scene", "Writes a built-in scene as a Mitsuba 3 scene folder");
    command->add_option("name", options->name, "The scene: " + known_scenes())->required();
    command->add_option("-o,--output", options->output, "The folder; files in it are replaced")
        ->type_name("DIR")
        ->required()
        ->check(not_empty());
    command->add_option("--texture-size", options->scene.texture_size, "Side of the main texture")
        ->type_name("N")
        ->check(in_range({16, 8192, true}))
        ->capture_default_str();
    command->add_option("--seed", options->scene.seed, "Moves scratches, spots, lights and clouds")
        ->type_name("S")
        ->check(in_range({0, 4294967295.0, true}))
        ->capture_default_str();
    command->callback([options] { write_built_in(*options); });
}

}  // namespace burnish
