// burnish reproduce: runs the paper's experiments and writes one report.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/option_text.h"
#include "cli/output_folder.h"
#include "cli/progress.h"
#include "cli/reproduce_report.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "core/version.h"
#include "experiments/experiments.h"
#include "scenes/procedural.h"

namespace burnish {

namespace {

struct CommandLine {
    std::vector<std::string> names;        ///< of experiments; empty: all
    std::vector<std::string> scene_names;  ///< of target scenes; empty: all
    std::string scenes;                    ///< folder of the published scenes
    std::string output;
    std::vector<int> size;
    double time_scale = 1;
    std::uint32_t seed = 0;
    int threads = 0;
    bool full = false, force = false, fresh_image = false;
};

/// Of the image of an iteration, per pixel: the paper's fresh ones; and at the paper's size fresh
/// ones beside the passes that each half keeps, as many in all.
constexpr std::uint32_t kFreshImageSamples = 32, kFullImageSamples = 2, kFullImageWindow = 16;

/// The published scenes with the paper's settings, and the project's own.
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
        r.reference_samples = 1024;
        r.budget = {500, 60, 300};
        r.runs = 1;
        r.image_samples = kFullImageSamples, r.image_window = kFullImageWindow;
        r.sweep_seconds = 60;
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
    r.budget.iterations = static_cast<std::uint32_t>(
        std::max(1.0, std::round(r.budget.iterations * options.time_scale)));
    r.budget.derivative_seconds *= options.time_scale, r.budget.seconds *= options.time_scale;
    r.sweep_seconds *= options.time_scale;
    if (options.fresh_image) r.image_samples = kFreshImageSamples, r.image_window = 0;
    r.reference_samples = scaled(r.reference_samples);
    r.max_samples = scaled(r.max_samples);
    return r;
}

template <class T>
bool contains(const std::vector<T>& list, const T& item) {
    return std::find(list.begin(), list.end(), item) != list.end();
}

/// Refuses names that are not known, in one sentence.
template <class Known>
void check_names(const char* what, const std::vector<std::string>& names, const Known& known) {
    std::string all;
    for (const auto& k : known) all += (all.empty() ? "" : ", ") + std::string(k.name);
    for (const std::string& name : names)
        if (std::none_of(known.begin(), known.end(), [&](const auto& k) { return name == k.name; }))
            throw UsageError(fmt::format("there is no {} '{}', expected {}", what, name, all));
}

std::vector<TargetSource> find_known_scenes(const CommandLine& options, const ReproduceOptions& r,
                                            const std::filesystem::path& own_folder) {
    std::vector<TargetSource> sources;
    std::string missing;
    for (const KnownScene& s : kScenes) {
        if (!options.scene_names.empty() && !contains(options.scene_names, std::string(s.name)))
            continue;
        std::filesystem::path file;
        if (s.own) {
            file = own_folder / s.name / "scene.xml";
            const TickingLine line(fmt::format("making the scene {}", s.name));
            write_procedural_scene(s.name, file.parent_path(),
                                   {.texture_size = r.texture_side > 0 ? r.texture_side : 2048});
        } else {
            file = std::filesystem::path(options.scenes) / s.name / "scene.xml";
            if (options.scenes.empty() || !std::filesystem::exists(file)) {
                missing += (missing.empty() ? "" : ", ") + std::string(s.name);
                continue;
            }
        }
        sources.push_back({s.name, file, s.parameter, s.learning_rate, s.confidence_cap});
    }
    if (!missing.empty())
        log_info(
            fmt::format("without the published scenes {}: --scenes names the folder that holds "
                        "NAME/scene.xml",
                        missing));
    return sources;
}

/// The line that is rewritten while an experiment works: the seconds of what is being done, or the
/// time left once it says how far it is.
class NoteLine {
  public:
    explicit NoteLine(std::string title) : title_(std::move(title)) {}
    void begin(const std::string& text) {
        ticking_.reset();
        bar_ = std::make_unique<ProgressLine>(title_ + ": " + text);
        ticking_ = std::make_unique<TickingLine>(title_ + ": " + text);
    }
    void share(double done) {
        ticking_.reset();
        if (bar_) bar_->show_share(done);
    }

  private:
    std::string title_;
    std::unique_ptr<ProgressLine> bar_;
    std::unique_ptr<TickingLine> ticking_;
};

std::vector<std::pair<std::string, std::string>> settings_text(const CommandLine& options,
                                                               const ReproduceOptions& r,
                                                               const std::vector<TargetSource>& s) {
    std::string scenes;
    for (const TargetSource& source : s) scenes += (scenes.empty() ? "" : ", ") + source.name;
    return {
        {"image", fmt::format("{} x {}", r.width, r.height)},
        {"texture", r.texture_side > 0 ? fmt::format("at most {} texels a side", r.texture_side)
                                       : "as in the scene"},
        {"scenes", scenes},
        {"samples per pixel of an iteration's image",
         r.image_window == 0
             ? fmt::format("{}, fresh", r.image_samples)
             : fmt::format("{} fresh ones, and those of the last {} passes, shaded again",
                           r.image_samples, 2 * r.image_window)},
        {"samples per pixel of the target", fmt::format("{}", r.target_samples)},
        {"samples per pixel of the converged derivative", fmt::format("{}", r.reference_samples)},
        {"samples per pixel that evaluate a run", fmt::format("{}", r.evaluation_samples)},
        {"iterations before a derivative is evaluated", fmt::format("{}", r.iterations)},
        {"budget of an optimisation run",
         fmt::format("{} iterations, {:g} s of derivatives and {:g} s", r.budget.iterations,
                     r.budget.derivative_seconds, r.budget.seconds)},
        {"runs with seeds of their own behind an interval", fmt::format("{}", r.runs)},
        {"seconds of a run over Adam's decay rates", fmt::format("{:g}", r.sweep_seconds)},
        {"time scale", fmt::format("{:g}", options.time_scale)},
        {"seed", fmt::format("{}", r.seed)}};
}

void log_figures(const ExperimentResult& result) {
    for (const Figure& f : result.figures)
        log_info(fmt::format("  {}: {}. {}", f.title, name_of(f.verdict), f.measured));
}

void write_results(const Reproduction& run, OutputFolder& output) {
    const auto& folder = output.unfinished;
    write_bytes(folder / "index.html", reproduction_html(run));
    write_bytes(folder / "results.json", reproduction_json(run));
    write_bytes(folder / "results.csv", reproduction_csv(run));
    std::vector<std::string> files = unfinished_files(output);
    files.push_back("summary.json");
    const nlohmann::ordered_json summary{{"burnish", version_text()}, {"files", files}};
    write_bytes(folder / "summary.json", summary.dump(2) + "\n");
    move_into_place(output);
}

bool is_wanted(const CommandLine& line, const Experiment& e) {
    return line.names.empty() || contains(line.names, std::string(e.name));
}

/// The wanted scenes, where an experiment needs any. Throws InputError where none of them is there
/// and nothing can be done without.
std::vector<TargetSource> find_sources(const CommandLine& line, const ReproduceOptions& r,
                                       const std::filesystem::path& own_folder) {
    bool any_needs = false, all_need = true;
    for (const Experiment& e : experiments()) {
        if (!is_wanted(line, e)) continue;
        any_needs |= e.needs_scenes, all_need &= e.needs_scenes;
    }
    if (!any_needs) return {};
    std::vector<TargetSource> sources = find_known_scenes(line, r, own_folder);
    if (sources.empty() && all_need)
        throw InputError(
            "none of the wanted scenes is there: --scenes DIR names the folder of "
            "the published ones");
    return sources;
}

std::vector<TargetScene> prepare_scenes(const std::vector<TargetSource>& sources,
                                        const ReproduceOptions& r) {
    std::vector<TargetScene> scenes;
    for (const TargetSource& source : sources) {
        NoteLine note("preparing");
        note.begin(source.name);
        scenes.push_back(prepare_target_scene(source, r, [&](double done) { note.share(done); }));
    }
    return scenes;
}

ExperimentResult run_experiment(const Experiment& e, std::vector<TargetScene>& scenes,
                                const ReproduceOptions& r, const std::string& title) {
    const Stopwatch watch;
    NoteLine note(title);
    ExperimentResult result = e.run(scenes, r,
                                    {[&](const std::string& text) { note.begin(text); },
                                     [&](double done) { note.share(done); }});
    result.title = e.title;
    result.seconds = watch.total();
    return result;
}

void reproduce(const CommandLine& line) {
    check_names("experiment", line.names, experiments());
    check_names("scene", line.scene_names, std::span<const KnownScene>(kScenes));
    const ReproduceOptions r = settings_of(line);
    OutputFolder output = open_output_folder(line.output, line.force);
    if (output.replaces)
        log_info(line.output + " exists from an earlier run: replacing it when this run is done");
    const ThreadLimit threads(line.threads);
    const InterruptGuard guard;
    const Stopwatch watch;
    const auto own_folder = output.unfinished / "scenes";
    const std::vector<TargetSource> sources = find_sources(line, r, own_folder);
    std::vector<TargetScene> scenes = prepare_scenes(sources, r);
    std::filesystem::remove_all(own_folder);

    Reproduction run;
    run.settings = settings_text(line, r, sources);
    std::size_t at = 0;
    const auto all = std::count_if(experiments().begin(), experiments().end(),
                                   [&](const Experiment& e) { return is_wanted(line, e); });
    for (const Experiment& e : experiments()) {
        if (!is_wanted(line, e) || interrupted()) continue;
        run.experiments.push_back(
            run_experiment(e, scenes, r, fmt::format("{} ({} of {})", e.name, ++at, all)));
        const ExperimentResult& result = run.experiments.back();
        log_info(fmt::format("{} ({}):", e.title, duration_text(result.seconds)));
        log_figures(result);
    }
    run.seconds = watch.total();
    write_results(run, output);
    log_info(fmt::format("the report is {}",
                         (std::filesystem::path(line.output) / "index.html").string()));
}

std::string names_text() {
    std::string text;
    for (const Experiment& e : experiments())
        text += (text.empty() ? "" : ", ") + std::string(e.name);
    return text;
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
    auto options = std::make_shared<CommandLine>();
    CLI::App* command = app.add_subcommand(
        "reproduce", "Runs the paper's experiments and says of each claim whether it holds");
    command->add_option("names", options->names, "Of experiments: " + names_text() + "; else all")
        ->type_name("NAME");
    command->add_option("-o,--output", options->output, "Folder of the report")
        ->type_name("DIR")
        ->required();
    command
        ->add_option("--scenes", options->scenes,
                     "Folder of the published scenes: chalice, tire and ashtray")
        ->type_name("DIR");
    command->add_option("--scene", options->scene_names, "Only these scenes; repeatable")
        ->type_name("NAME")
        ->allow_extra_args(false);
    command
        ->add_option("--size", options->size,
                     "Of the images; textures follow in the paper's proportion")
        ->type_name("W H")
        ->expected(2)
        ->check(in_range({16, 8192, true}));
    command
        ->add_option("--time-scale", options->time_scale,
                     "Multiplies the seconds of optimisation runs and the samples of references")
        ->type_name("X")
        ->check(in_range({0.01, 1000, false}))
        ->capture_default_str();
    command->add_flag("--full", options->full, "The paper's sizes and budgets: takes hours");
    command->add_flag("--fresh-image", options->fresh_image,
                      "Images of iterations from 32 fresh samples per pixel, as in the paper; with "
                      "--full kept samples are shaded again otherwise");
    command->add_option("--seed", options->seed, "Random numbers")
        ->type_name("S")
        ->check(in_range({0, 4294967295.0, true}))
        ->capture_default_str();
    command->add_option("--threads", options->threads, "0: all cores")
        ->type_name("T")
        ->check(in_range({0, 4096, true}))
        ->capture_default_str();
    command->add_flag("--force", options->force, "Write into a folder that holds other things");
    command->callback([options] { reproduce(*options); });
}

}  // namespace burnish
