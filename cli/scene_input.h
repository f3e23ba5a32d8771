// What every command that reads a scene shares: its options and the loading.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "burnish/options.h"
#include "captures/capture.h"
#include "mitsuba/load.h"
#include "render/render.h"
#include "render/renderer.h"

namespace CLI {
class App;
}

namespace burnish {

struct SceneOptions {
    std::string file;
    std::string place;  ///< that names the file, "capture.json: scene"; empty: the command line
    std::vector<std::string> definitions;  ///< "name=value"
    std::vector<int> size;                 ///< width and height, or empty: the scene's
    bool ignore_unsupported = false;
    std::string sensor;  ///< id or number; empty: the first
    std::uint32_t seed = 0;
    int threads = 0;  ///< 0: all cores
    LightSelection light_selection = SceneSettings{}.light_selection;
    BeforeReading before_reading = {};
};

/// Adds SCENE, -D, --size and --ignore-unsupported.
void add_scene_options(CLI::App& app, SceneOptions& options);
/// Adds them and what rendering takes: --sensor, --seed, --threads and --light-selection.
void add_render_options(CLI::App& app, SceneOptions& options);

/// Adds --views and --images: cameras of other programs.
void add_views_options(CLI::App& app, std::string& views, std::string& images);

/// Reads what --views and --images name. Throws UsageError where the latter is missing, and
/// InputError.
std::vector<CapturedView> read_named_views(const std::string& views, const std::string& images);

/// Adds --texture NAME=VALUE|FILE, which replace_textures reads.
void add_texture_option(CLI::App& app, std::vector<std::string>& textures);

/// Puts the named values or images in the place of the textures of parameters. Throws UsageError
/// and InputError.
void replace_textures(Scene& scene, const std::vector<std::string>& assignments);

/// Says what an estimator that reuses reservoirs is in a single call, which has no iteration before
/// it.
void log_without_history(const Estimator& estimator);

/// The first few of some sentences, and where the others are.
void log_first(const std::vector<std::string>& sentences, void (*log_one)(const std::string&),
               const std::string& where);

/// Loads with progress; says warnings and notes, the first few of them. Throws InputError and
/// UsageError.
LoadedScene load_scene_with_progress(const SceneOptions& options);

/// The same without its warnings and notes.
LoadedScene load_scene_quietly(const SceneOptions& options);

/// Builds what rays need, with progress. sensor: id or number; empty: the first.
Renderer make_renderer_with_progress(LoadedScene loaded, LightSelection selection,
                                     const std::string& sensor = {});

/// The scene's own look: an image of `samples_per_pixel` passes of a stream, with progress. Says
/// how many samples were left out because they were not finite.
Image render_with_progress(const Renderer& renderer, RandomKey key, std::uint32_t samples_per_pixel,
                           const std::string& title);

/// What -D defines. Throws UsageError.
std::map<std::string, std::string> definitions_of(const SceneOptions& options);

/// "NAME=VALUE" cut at the first =. Throws UsageError that names the option.
std::pair<std::string, std::string> split_assignment(const std::string& option,
                                                     const std::string& text);

}  // namespace burnish
