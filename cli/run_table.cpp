// The options of a run beside burnish::Options, one row each.
#include <algorithm>

#include "burnish/live.h"
#include "captures/capture.h"
#include "cli/rated_name.h"
#include "cli/settings.h"
#include "image/image.h"
#include "render/renderer.h"

namespace burnish {

namespace {

constexpr OptionLevel kBasic = OptionLevel::kBasic;
constexpr Range kPositive{0, 1e6, false, true};

bool renders_target(const RunSettings& s) { return s.targets.empty() && s.views.empty(); }
bool has_views(const RunSettings& s) { return !s.views.empty(); }
bool has_no_capture(const RunSettings& s) { return !is_capture(s.scene); }
bool compares(const RunSettings& s) { return s.compare.has_value(); }

constexpr RunRow kTable[] = {
    {.info = {.name = "scene.file",
              .sentence =
                  "A Mitsuba 3 XML file, or a capture.json; without one the built-in goblet",
              .unit = "FILE",
              .unset = "none"},
     .field = &RunSettings::scene},
    {.info = {.name = "scene.definitions",
              .flag = "-D",
              .level = kBasic,
              .sentence = "Sets a <default> of the scene file; repeatable",
              .unit = "NAME=VALUE"},
     .field = &RunSettings::definitions},
    {.info = {.name = "scene.size",
              .flag = "--size",
              .level = kBasic,
              .sentence = "Replaces the size of the film, in pixels",
              .range = {1, kMaxImageSide, true}},
     .field = &RunSettings::size},
    {.info = {.name = "scene.ignore_unsupported",
              .flag = "--ignore-unsupported",
              .sentence = "Goes on without what is not supported, and says what was left out"},
     .field = &RunSettings::ignore_unsupported},
    {.info =
         {.name = "scene.light_selection",
          .sentence =
              "Which light a light sample goes to: resampled, uniform, by power, by a light tree"},
     .field = &RunSettings::light_selection},
    {.info = {.name = "problem.parameters",
              .flag = "--parameter",
              .level = kBasic,
              .sentence =
                  "Texture or constant to recover, Mitsuba's name or a short form; a constant "
                  "as one value or a texture of SIZE; repeatable",
              .unit = "NAME[:SIZE][@RATE]"},
     .field = &RunSettings::parameters},
    {.info = {.name = "problem.target",
              .flag = "--target",
              .level = kBasic,
              .sentence = "Image to match; without one rendered from the scene's textures",
              .unit = "IMAGE",
              .unset = "none"},
     .field = &RunSettings::targets},
    {.info = {.name = "problem.sensors",
              .flag = "--sensor",
              .sentence = "Camera of the scene file, by id or number; repeatable, each before its "
                          "--target",
              .unit = "ID"},
     .field = &RunSettings::sensors},
    {.info = {.name = "problem.views",
              .flag = "--views",
              .level = kBasic,
              .sentence =
                  "Cameras and pictures: a transforms.json, or the folder of a COLMAP model",
              .unit = "PATH",
              .unset = "none"},
     .field = &RunSettings::views},
    {.info = {.name = "problem.images",
              .flag = "--images",
              .sentence = "Folder of the pictures that --views names",
              .unit = "DIR",
              .unset = "none"},
     .field = &RunSettings::images,
     .needs = "--views",
     .holds = has_views},
    {.info = {.name = "problem.target_samples",
              .flag = "--target-spp",
              .sentence = "Samples per pixel of a rendered target",
              .range = {1, kMaxSamplesPerPixel, true}},
     .field = &RunSettings::target_samples,
     .needs = "a target that is rendered, not a file",
     .holds = renders_target},
    {.info = {.name = "problem.mask",
              .flag = "--mask",
              .level = kBasic,
              .sentence = "Weights of the pixels",
              .unit = "IMAGE",
              .unset = "none"},
     .field = &RunSettings::mask},
    {.info = {.name = "problem.ignore_background",
              .flag = "--ignore-background",
              .sentence = "Leaves out the pixels of pictures that show no surface of the scene"},
     .field = &RunSettings::ignore_background},
    {.info = {.name = "problem.held_out",
              .flag = "--hold-out",
              .sentence = "Name of a view that is not fitted, but evaluated; repeatable",
              .unit = "VIEW"},
     .field = &RunSettings::held_out},
    {.info = {.name = "problem.exposure",
              .flag = "--exposure",
              .level = kBasic,
              .sentence = "Factor of the rendered image before it meets the target; fit_rgb: and "
                          "white balance",
              .unit = "fit|fit_rgb|X"},
     .field = &RunSettings::exposure,
     .needs = "views that no capture describes",
     .holds = has_no_capture},
    {.info = {.name = "problem.scale",
              .flag = "--scale",
              .sentence = "Fits at a fraction of the pictures' size",
              .range = {0, 1, false, true}},
     .field = &RunSettings::scale},
    {.info = {.name = "problem.initial_values",
              .flag = "--init",
              .level = kBasic,
              .sentence = "Initial values, once or per parameter; 'scene': its texels [search]",
              .unit = "search|VALUE|FILE|scene"},
     .field = &RunSettings::starts},
    {.info = {.name = "problem.learning_rates",
              .flag = "--learning-rate",
              .level = kBasic,
              .sentence =
                  "Step of the optimiser for each parameter, not divided; once or per parameter "
                  "[0.003 to 0.01, by the start, divided by the unknowns of the material]",
              .range = {kMinLearningRate, kMaxLearningRate, false, true}},
     .field = &RunSettings::learning_rates,
     .needs = "a parameter without a learning rate of its own",
     .holds = has_unrated},
    {.info = {.name = "run.compare",
              .flag = "--compare",
              .sentence = "A second run with another estimator, for the same time or iterations",
              .unset = "none"},
     .field = &RunSettings::compare},
    {.info = {.name = "run.compare_iterations",
              .sentence = "The second run ends after N iterations, whatever the first one did",
              .range = {1, 1e9, true},
              .unset = "none"},
     .field = &RunSettings::compare_iterations,
     .needs = "a second run, --compare",
     .holds = compares},
    {.info = {.name = "run.max_memory",
              .flag = "--max-memory",
              .level = kBasic,
              .sentence = "What the process may take [path_cache: half of the machine's memory, or "
                          "of its control group; others: any]",
              .unit = "GiB",
              .range = kPositive,
              .unset = "auto"},
     .field = &RunSettings::max_memory},
    {.info = {.name = "run.threads",
              .flag = "--threads",
              .level = kBasic,
              .sentence = "Number of threads; 0: all cores",
              .range = {0, 4096, true}},
     .field = &RunSettings::threads,
     .recorded = false},
    {.info = {.name = "run.output",
              .flag = "-o,--output",
              .level = kBasic,
              .sentence = "Folder for the results",
              .unit = "DIR"},
     .field = &RunSettings::output,
     .recorded = false},
    {.info = {.name = "run.force",
              .flag = "--force",
              .sentence = "Writes into a folder that holds other things, too"},
     .field = &RunSettings::force,
     .recorded = false},
    {.info = {.name = "run.checkpoint_seconds",
              .flag = "--checkpoint-every",
              .sentence = "Between two checkpoints, from which --resume goes on; longer where "
                          "writing takes more than 2 % of the time",
              .unit = "seconds",
              .range = kPositive},
     .field = &RunSettings::checkpoint_seconds,
     .recorded = false},
    {.info = {.name = "run.live",
              .flag = "--live",
              .sentence = "Shows textures and images in a running tev",
              .unit = "HOST:PORT",
              .unset = "none"},
     .field = &RunSettings::live,
     .recorded = false,
     .alone = Live::kAddress},
};

}  // namespace

bool has_unrated(const RunSettings& settings) {
    return !std::ranges::all_of(settings.parameters, ends_in_rate);
}

std::span<const RunRow> run_table() { return kTable; }

}  // namespace burnish
