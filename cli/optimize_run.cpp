#include "cli/optimize_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/demo_scene.h"
#include "cli/earlier_run.h"
#include "cli/interrupt.h"
#include "cli/memory_limit.h"
#include "cli/optimize_results.h"
#include "cli/options_file.h"
#include "cli/output_folder.h"
#include "cli/phases.h"
#include "cli/run_checkpoints.h"
#include "cli/run_evidence.h"
#include "cli/run_views.h"
#include "cli/same_settings.h"
#include "cli/scene_input.h"
#include "cli/solve_runs.h"
#include "cli/target_textures.h"
#include "cli/unseeing_views.h"
#include "cli/view_pictures.h"
#include "cli/without_effect.h"
#include "core/at_place.h"
#include "core/parallel.h"
#include "image/files.h"
#include "optimize/loss.h"
#include "optimize/option_table.h"
#include "optimize/ranks.h"
#include "optimize/views.h"

namespace burnish {

namespace {

LoadedScene load(const RunSettings& run, const std::optional<Capture>& capture,
                 OutputFolder& output) {
    SceneOptions scene;
    scene.file = run.scene, scene.definitions = run.definitions, scene.size = run.size;
    scene.ignore_unsupported = run.ignore_unsupported;
    scene.before_reading = limit_of_files(run);
    if (capture) use_capture(*capture, scene);
    if (run.scene.empty()) scene.file = write_demo_scene(output).string();
    return load_scene_with_progress(scene);
}

/// The views that are fitted, or those that are held out.
std::vector<TracedScene> scenes_of(const RunResult& run, bool held_out) {
    std::vector<TracedScene> scenes;
    for (std::size_t i = 0; i < run.renderers.size(); ++i) {
        const TracedScene& traced = run.renderers[i].data().traced;
        if (run.sources[i].view.held_out == held_out) scenes.push_back(traced);
    }
    return scenes;
}

/// How the files were read, and what looks wrong in them.
void log_pictures(RunResult& run) {
    std::vector<std::string> sentences = mask_texts(run.sources, run.pictures.masks);
    for (std::string& text : decoding_texts(run.sources, run.pictures.photographs))
        sentences.push_back(std::move(text));
    log_first(sentences, log_info, "summary.json has them all");
    const bool has_color = std::ranges::any_of(run.textures, &TargetTexture::is_color);
    run.picture_warnings = picture_warnings(run.sources, run.pictures, has_color);
    if (const std::string text = unseeing_text(run); !text.empty())
        run.picture_warnings.insert(run.picture_warnings.begin(), text);
    log_first(run.picture_warnings, log_warning, "summary.json has them all");
}

void make_view_renderers(const Renderer& renderer, RunResult& run) {
    Problem problem{renderer, {}, {}, {}};
    for (const CapturedView& source : run.sources) problem.views.push_back(source.view);
    const RunSettings& asked = run.settings.run;
    const std::string file = is_capture(asked.scene) ? asked.scene + ": views" : asked.views;
    at_place(asked.held_out.empty() ? file : "", [&] { fitted_views(problem); });
    run.renderers = make_captured_views(problem, run.sources);
}

/// Everything that is read, and what the run is then made of.
Renderer read_run(OutputFolder& output, Phases& phases, RunResult& run) {
    const Settings& settings = run.settings;
    const ReadLog log;
    const std::optional<Capture> capture = capture_at(settings.run.scene);
    run.sources = views_of(settings.run, capture);
    const bool rendered = std::all_of(run.sources.begin(), run.sources.end(),
                                      [](const CapturedView& v) { return v.image.empty(); });
    LoadedScene loaded = load(settings.run, capture, output);
    run.warnings = loaded.warnings;
    require_scene_memory(loaded.scene, settings.run);
    run.textures = make_target_textures(settings, rendered, loaded.scene);
    warn_of_truths(run);
    Renderer renderer =
        make_renderer_with_progress(std::move(loaded), settings.run.light_selection);
    phases.end("scene");
    const std::size_t at_once = plan_pictures(renderer.data().scene(), run);
    run.pictures = read_pictures(settings.run, run.sources, at_once);
    size_cameras(settings.run, renderer, run.pictures.photographs, run.sources);
    make_view_renderers(renderer, run);
    phases.end("pictures");
    plan_memory({scenes_of(run, false), scenes_of(run, true)}, run);
    log_pictures(run);
    warn_without_effect(renderer.data().scene(), run);
    if (is_first(run.ranks)) require_place(output, renderer, run, log.files());
    log_long_phases(run);
    run.views = with_pictures(settings, run.sources, run.renderers, run.pictures.photographs);
    phases.end("target");
    for (const Input& file : log.files())
        if (output.unfinished.empty() || !file.name.starts_with(output.unfinished.string()))
            run.files.push_back(file);
    return renderer;
}

/// What is to be done: asked for, and as it is recorded where an earlier process has begun it.
struct Task {
    Settings settings, asked;
    const Ranks& ranks;
};

/// from: where the run goes on.
void run_to_the_end(const Task& task, OutputFolder& output, std::optional<Checkpoint> from) {
    const Settings& settings = task.settings;
    if (output.replaces)
        log_info(settings.run.output +
                 " exists from an earlier run: replacing it when this run is done");
    if (!is_unbiased(settings.options.loss))
        log_warning(
            fmt::format("the derivative of the loss {} is not affine in the image: noise "
                        "biases its gradient",
                        get_option(*find_option("loss"), settings.options)));
    const ThreadLimit threads(settings.run.threads);
    RunResult run;
    run.settings = settings, run.asked = task.asked;
    run.ranks = metered(task.ranks, run.traffic);
    run.goes_on = from.has_value();
    std::error_code gone;
    const auto bytes = from ? std::filesystem::file_size(from->file, gone) : 0;
    run.state_bytes = gone ? 0 : static_cast<double>(bytes) / run.ranks.count;
    Phases phases(run);
    const Renderer renderer = read_run(output, phases, run);
    const InterruptGuard guard;
    solve_first(renderer, output, std::move(from), phases, run);
    std::exception_ptr failed;
    if (settings.compared && agree(run.ranks, !interrupted()))
        failed = solve_second(renderer, output, phases, run);
    else if (settings.compared)
        log_warning("the second run was not begun" +
                    (keeps_run(output) ? ": " + resume_hint(output) : ""));
    if (is_first(run.ranks)) {
        write_results(renderer, run, output);
        log_info(fmt::format("the report is {}", (output.folder / "report.html").string()));
    }
    if (failed) std::rethrow_exception(failed);
}

void run_task(const Task& task, OutputFolder output, std::optional<Checkpoint> from) {
    try {
        run_to_the_end(task, output, std::move(from));
    } catch (const Suspended&) {
        throw;
    } catch (...) {
        if (is_first(task.ranks) && keeps_run(output)) log_info(resume_hint(output));
        throw;
    }
}

/// The first process opens the folder; the others help where it could.
OutputFolder open_together(const std::filesystem::path& folder, Found found, const Ranks& ranks) {
    if (!is_first(ranks)) {
        if (agree(ranks, true)) return helping_folder(folder);
        throw OutputError("process 0 could not open " + folder.string());
    }
    try {
        OutputFolder output = open_output_folder(folder, found);
        agree(ranks, true);
        return output;
    } catch (const OutputError&) {
        agree(ranks, false);
        throw;
    }
}

/// asked: the run must be of these settings.
void go_on(const std::string& folder, const std::vector<Given>& changes, const Settings* asked,
           const Ranks& ranks) {
    require_checkpoint(folder);
    OutputFolder output = open_together(folder, Found::kResumed, ranks);
    if (!asked) set_on_disk(OnDisk::kPart, resume_hint(output));  // a job's batch has set its own
    Checkpoint from = load_run(output, ranks);
    const std::string recorded = asked_of(from);
    const std::string other = asked ? changed_setting(recorded, *asked) : "";
    if (!other.empty())
        throw InputError(
            fmt::format("{}: holds a run of other settings ({}) that was stopped: expected one of "
                        "the job's, or another folder",
                        folder, other));
    Task task{resumed_settings(folder, settings_of(from), changes),
              resumed_settings(folder, recorded, changes), ranks};
    if (asked)
        for (Settings* own : {&task.settings, &task.asked}) take_process(asked->run, own->run);
    require_same_settings(task.settings, ranks);
    run_task(task, std::move(output), std::move(from));
}

}  // namespace

void begin_run(const Settings& settings, const Ranks& ranks) {
    require_same_settings(settings, ranks);
    require_recordable(settings);
    const Found allowed = settings.run.force ? Found::kAllowed : Found::kRefused;
    run_task({settings, settings, ranks}, open_together(settings.run.output, allowed, ranks), {});
}

void resume_run(const OptimizeArguments& arguments, const Ranks& ranks) {
    go_on(arguments.resume, changes_of(arguments), nullptr, ranks);
}

void finish_run(const Settings& asked, const Ranks& ranks) {
    if (agree(ranks, earlier_run(asked)) != EarlierRun::kStopped) return begin_run(asked, ranks);
    go_on(asked.run.output, {}, &asked, ranks);
}

}  // namespace burnish
