// burnish reproduce: runs the paper's experiments and writes one report.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/folder_content.h"
#include "cli/interrupt.h"
#include "cli/option_text.h"
#include "cli/output_folder.h"
#include "cli/reproduce_parts.h"
#include "cli/reproduce_report.h"
#include "cli/run_checkpoints.h"
#include "cli/settings.h"
#include "cli/summary.h"
#include "core/joined.h"
#include "core/parallel.h"
#include "experiments/experiments.h"
#include "image/files.h"

namespace burnish {

namespace {

struct CommandLine {
    std::vector<std::string> names;        ///< of experiments; empty: all
    std::vector<std::string> scene_names;  ///< of target scenes; empty: all
    std::vector<std::string> only;         ///< SCENE/EXPERIMENT; empty: all
    std::string scenes;                    ///< folder of the published scenes
    std::string output;
    std::vector<int> size;
    double time_scale = 1;
    std::uint32_t seed = 0;
    int threads = 0;
    bool full = false, force = false, fresh_image = false;
};

constexpr std::uint32_t kFreshImageSamples = 32;  ///< of an iteration's image [PR sec. 5]

/// The published scenes with the paper's settings, and the built-in ones.
struct KnownScene {
    const char* name;
    bool own;
    const char* parameter;
    float learning_rate, confidence_cap;
};
constexpr KnownScene kScenes[] = {
    {"ashtray", false, "mat-ashtray.brdf_0.anisotropic.data", 0.01f, 16},
    {"tire", false, "mat-tire.brdf_0.roughness.data", 0.005f, 16},
    {"chalice", false, "mat-chalice.brdf_0.roughness.data", 0.01f, 16},
    {"goblet", true, "mat-goblet.brdf_0.roughness.data", 0.01f, 16},
    {"tyre", true, "mat-tyre.brdf_0.roughness.data", 0.005f, 16},
    {"bowl", true, "mat-bowl.brdf_0.anisotropic.data", 0.01f, 16},
    {"tree", true, "mat-tree.brdf_0.base_color.data", 0.1f, 32},
};

ReproduceOptions settings_of(const CommandLine& options) {
    ReproduceOptions r;
    r.seed = options.seed;
    if (options.full) {
        r.width = r.height = 1400;
        r.texture_side = 0;
        r.target_samples = 512;
        r.reference_samples = 512;
        r.budget = {100, 500, 60, 120};
        r.runs = 1;
        r.sweep_seconds = 20;
        r.max_samples = 256;
    }
    if (!options.size.empty()) {
        r.width = options.size[0], r.height = options.size[1];
        // As many samples per texel as in the paper: 1400 pixels for 2048 texels.
        if (!options.full)
            r.texture_side = std::clamp(std::max(r.width, r.height) * 2048 / 1400, 16, 8192);
    }
    const auto scaled = [&](std::uint32_t samples) {
        return static_cast<std::uint32_t>(std::max(8.0, samples * options.time_scale));
    };
    for (std::uint32_t* n : {&r.budget.iterations, &r.budget.long_iterations})
        *n = static_cast<std::uint32_t>(std::max(1.0, std::round(*n * options.time_scale)));
    r.budget.derivative_seconds *= options.time_scale, r.budget.seconds *= options.time_scale;
    r.sweep_seconds *= options.time_scale;
    if (options.fresh_image) r.image_samples = kFreshImageSamples, r.image_window = 0;
    r.reference_samples = scaled(r.reference_samples);
    r.max_samples = scaled(r.max_samples);
    return r;
}

/// SCENE/EXPERIMENT; what is missing is empty.
std::array<std::string, 2> split_part(const std::string& part) {
    const std::size_t slash = part.find('/');
    return {part.substr(0, slash), slash == std::string::npos ? "" : part.substr(slash + 1)};
}

template <class T>
bool contains(const std::vector<T>& list, const T& item) {
    return std::find(list.begin(), list.end(), item) != list.end();
}

template <class Known>
void check_names(const char* what, const std::vector<std::string>& names, const Known& known) {
    std::vector<std::string> all;
    for (const auto& k : known) all.emplace_back(k.name);
    for (const std::string& name : names) require_known(what, name, all);
}

/// Whether the command line asks for an experiment, a scene, the one with the other.
bool is_wanted(const CommandLine& line, const Experiment& e) {
    if (!line.names.empty() && !contains(line.names, std::string(e.name))) return false;
    const auto names_it = [&](const std::string& part) { return split_part(part)[1] == e.name; };
    return line.only.empty() || std::any_of(line.only.begin(), line.only.end(), names_it);
}

bool is_wanted(const CommandLine& line, const KnownScene& s) {
    if (!line.scene_names.empty() && !contains(line.scene_names, std::string(s.name))) return false;
    const auto names_it = [&](const std::string& part) { return split_part(part)[0] == s.name; };
    return line.only.empty() || std::any_of(line.only.begin(), line.only.end(), names_it);
}

bool is_wanted(const CommandLine& line, const Experiment& e, const KnownTarget& t) {
    return line.only.empty() || contains(line.only, t.source.name + "/" + e.name);
}

bool names_scenes(const CommandLine& line) {
    return !line.scene_names.empty() || !line.only.empty();
}

/// Throws InputError where a published scene is not there and the command line names it, or where
/// --scenes names a folder that has none.
std::vector<KnownTarget> find_known_scenes(const CommandLine& options) {
    std::vector<KnownTarget> targets;
    std::vector<std::string> missing;
    std::error_code ignored;
    bool has_published = options.scenes.empty();
    for (const KnownScene& s : kScenes) {
        if (!is_wanted(options, s)) continue;
        const auto file = std::filesystem::path(options.scenes) / s.name / "scene.xml";
        if (!s.own && (options.scenes.empty() || !std::filesystem::exists(file, ignored))) {
            missing.emplace_back(s.name);
            continue;
        }
        has_published |= !s.own;
        targets.push_back(
            {{s.name, s.own ? "" : file, s.parameter, s.learning_rate, s.confidence_cap},
             s.own,
             s.own ? nlohmann::json()
                   : files_of(file.parent_path(), {options.output, kept_folder(options.output)})});
    }
    if (!missing.empty() && (names_scenes(options) || !has_published))
        throw InputError(fmt::format(
            "--scenes: found {}, expected the folder that holds {}/scene.xml",
            options.scenes.empty() ? "none" : options.scenes, fmt::join(missing, "/scene.xml, ")));
    if (!missing.empty())
        log_info(fmt::format(
            "without the published scenes {}: --scenes names the folder that holds NAME/scene.xml",
            fmt::join(missing, ", ")));
    return targets;
}

void write_results(const Reproduction& run, OutputFolder& output) {
    write_bytes(output.unfinished / "index.html", reproduction_html(run));
    write_bytes(output.unfinished / "results.json", reproduction_json(run));
    write_bytes(output.unfinished / "results.csv", reproduction_csv(run));
    std::vector<std::string> files = unfinished_files(output);
    files.push_back(kSummary);
    write_bytes(output.unfinished / kSummary, list_json(files));
    move_into_place(output);
}

/// Whether an experiment that is wanted takes scenes.
bool any_takes_scenes(const CommandLine& line) {
    return std::ranges::any_of(
        experiments(), [&](const Experiment& e) { return is_wanted(line, e) && e.max_scenes > 0; });
}

/// Every wanted experiment with its scenes, or with all that are named, experiment by experiment.
std::vector<Part> wanted_parts(const CommandLine& line, std::span<const KnownTarget> targets) {
    const bool are_named = !line.only.empty() || !line.scene_names.empty();
    std::vector<Part> parts;
    for (const Experiment& e : experiments()) {
        if (!is_wanted(line, e)) continue;
        if (e.max_scenes == 0) parts.push_back({&e, nullptr});
        std::size_t left = line.full ? e.full_scenes : e.max_scenes;
        if (are_named && left > 0) left = targets.size();
        for (const KnownTarget& t : targets)
            if (left > 0 && is_wanted(line, e, t)) parts.push_back({&e, &t}), --left;
    }
    return parts;
}

/// Refuses parts that are not SCENE/EXPERIMENT of those that are known, and of those that are
/// named.
void check_parts(const CommandLine& line) {
    const auto agrees = [](const std::vector<std::string>& named, const std::string& name) {
        return named.empty() || contains(named, name);
    };
    for (const std::string& part : line.only) {
        const auto [scene, experiment] = split_part(part);
        if (scene.empty() || experiment.empty())
            throw UsageError(fmt::format("--only {}: expected SCENE/NAME, as tire/inverse", part));
        check_names("scene", {scene}, std::span<const KnownScene>(kScenes));
        check_names("experiment", {experiment}, experiments());
        if (std::ranges::find(experiments(), experiment, &Experiment::name)->max_scenes == 0)
            throw UsageError(
                fmt::format("--only {0}: {1} takes no scene: `burnish reproduce {1}` makes it",
                            part, experiment));
        if (!agrees(line.scene_names, scene) || !agrees(line.names, experiment))
            throw UsageError(fmt::format(
                "--only {}: expected a part of the experiments and scenes that are named", part));
    }
}

/// Refuses options that have an effect with scenes alone, where nothing takes one.
void check_scene_options(const CommandLine& line, const CLI::App& command) {
    if (any_takes_scenes(line)) return;
    std::vector<std::string> given;
    for (const char* name :
         {"--scene", "--scenes", "--size", "--time-scale", "--full", "--fresh-image"})
        if (command.count(name) > 0) given.emplace_back(name);
    if (!given.empty())
        throw UsageError(
            fmt::format("{} {} no effect: the experiments that are named take no scene",
                        fmt::join(given, ", "), given.size() == 1 ? "has" : "have"));
}

void reproduce(const CommandLine& line, const CLI::App& command) {
    check_names("experiment", line.names, experiments());
    check_names("scene", line.scene_names, std::span<const KnownScene>(kScenes));
    check_parts(line);
    check_scene_options(line, command);
    const ReproduceOptions r = settings_of(line);
    OutputFolder output =
        open_output_folder(line.output, line.force ? Found::kAllowed : Found::kRefused);
    if (output.replaces)
        log_info(line.output + " exists from an earlier run: replacing it when this run is done");
    const ThreadLimit threads(line.threads);
    const Machine machine = machine_of(line.threads);
    const InterruptGuard guard;
    const std::vector<KnownTarget> targets =
        any_takes_scenes(line) ? find_known_scenes(line) : std::vector<KnownTarget>{};
    std::vector<Part> parts = wanted_parts(line, targets);
    const KeptResults kept = keep_results(kept_folder(line.output));
    if (std::filesystem::exists(kept.folder))
        set_kept(kept);
    else
        set_on_disk(OnDisk::kAll,
                    "stopped before anything was kept: the same command begins again");
    run_parts(r, machine, kept, output.unfinished / "scenes", parts);
    const std::size_t done = count_done(parts);
    if (done == 0 && interrupted()) end_interrupted();  // an earlier report stays

    Reproduction run = reproduction_of(parts);
    run.settings =
        settings_text(r, line.time_scale, machine,
                      joined(targets, [](const KnownTarget& t) { return t.source.name; }));
    if (done < parts.size())
        run.stopped = fmt::format("stopped with {} of {} parts done: the same command goes on",
                                  done, parts.size());
    write_results(run, output);
    log_info(fmt::format("finished parts are kept in {}; remove it to make them again",
                         kept.folder.string()));
    log_info(fmt::format("the report is {}",
                         (std::filesystem::path(line.output) / "index.html").string()));
    if (!run.stopped.empty()) throw Suspended(run.stopped);
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
    auto options = std::make_shared<CommandLine>();
    CLI::App* command = app.add_subcommand(
        "reproduce", "Runs the paper's experiments and says of each claim whether it holds");
    command
        ->add_option("names", options->names,
                     "Of experiments: " + joined(experiments(), &Experiment::name) + "; else all")
        ->type_name("NAME");
    add_text(*command, "-o,--output", options->output, "DIR", "The folder of the report")
        ->required();
    add_text(*command, "--scenes", options->scenes, "DIR",
             "Folder of the published scenes: chalice, tire and ashtray");
    command->add_option("--scene", options->scene_names, "Only these scenes; repeatable")
        ->type_name("NAME")
        ->allow_extra_args(false);
    command
        ->add_option("--only", options->only,
                     "Only this part, e.g. tire/inverse; repeatable: a part is one experiment with "
                     "one scene")
        ->type_name("SCENE/NAME")
        ->allow_extra_args(false);
    command
        ->add_option("--size", options->size,
                     "Of the images; textures follow in the paper's proportion, with --full those "
                     "of the scene stay")
        ->type_name("W H")
        ->expected(2)
        ->check(in_range({16, 8192, true}));
    add_number(*command, "--time-scale", options->time_scale, "X",
               "Multiplies the seconds and iterations of optimisation runs, and the samples of "
               "references and of equal-error",
               {0.01, 1000, false});
    command->add_flag("--full", options->full,
                      "The paper's sizes and budgets: takes hours. One run of each method, so that "
                      "its ratios have no interval and no verdict, but in adam and positivization");
    command->add_flag("--fresh-image", options->fresh_image,
                      "Images of iterations from 32 fresh samples per pixel, as in the paper; kept "
                      "samples are shaded again otherwise");
    add_number(*command, "--seed", options->seed, "S", "Random numbers",
               find_setting("seed").info.range);
    const OptionInfo& threads = find_setting("run.threads").info;
    add_number(*command, "--threads", options->threads, "T", threads.sentence, threads.range);
    command->add_flag("--force", options->force, "Write into a folder that holds other things");
    command->callback([options, command] { reproduce(*options, *command); });
}

}  // namespace burnish
