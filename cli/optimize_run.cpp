#include "cli/optimize_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/demo_scene.h"
#include "cli/earlier_run.h"
#include "cli/folder_content.h"
#include "cli/interrupt.h"
#include "cli/memory_limit.h"
#include "cli/optimize_results.h"
#include "cli/options_file.h"
#include "cli/output_folder.h"
#include "cli/phases.h"
#include "cli/process_memory.h"
#include "cli/run_checkpoints.h"
#include "cli/run_evidence.h"
#include "cli/run_views.h"
#include "cli/same_settings.h"
#include "cli/scene_input.h"
#include "cli/solve_run.h"
#include "cli/target_textures.h"
#include "cli/unseeing_views.h"
#include "cli/view_pictures.h"
#include "cli/without_effect.h"
#include "core/at_place.h"
#include "core/parallel.h"
#include "gradient/estimator.h"
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

Start start_of(const TargetTexture& t) {
    if (t.start_kind == StartKind::kSearched) return SearchStart{};
    if (t.start_kind == StartKind::kConstant) return t.initial.values.front();
    return t.initial;
}

Problem make_problem(const Renderer& renderer, const RunResult& run) {
    Problem problem{renderer, std::vector<View>(run.views.size()), {}, {}};
    problem.ranks = run.ranks;
    parallel_tasks(run.views.size(), [&](std::size_t i) { problem.views[i] = run.views[i]; });
    for (const TargetTexture& t : run.textures)
        problem.unknowns.push_back({t.name, start_of(t), t.own_rate});
    return problem;
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

void measure_errors(const std::vector<TargetTexture>& textures, EvaluatedRun& run) {
    for (std::size_t i = 0; i < textures.size(); ++i)
        if (textures[i].truth)
            run.texture_errors.push_back(errors_of(textures[i], run.summary.textures[i].values));
}

/// As long as the first run, from the same start, evaluated with as many samples.
Options second_options(const RunResult& run) {
    Options options = *run.settings.compared;
    const Summary& first = run.result.summary;
    options.evaluation_samples = first.result.samples_per_pixel;
    if (!first.searched.empty()) options.search_effort = first.search_effort;
    options.stop = Stop{};
    if (run.settings.run.compare_iterations > 0)
        options.stop.iterations = run.settings.run.compare_iterations;
    else if (first.ending == Ending::kTime)
        options.stop.seconds = first.seconds;
    else
        options.stop.iterations = first.counts.iterations;
    return options;
}

/// Of several processes: which of them have nothing to visit.
void log_idle(const RunResult& run, const Estimator& estimator) {
    const auto views = static_cast<int>(fitted_count(run));
    if (views < run.ranks.count && !shares_bands(estimator))
        log_warning(fmt::format("{} shares out whole views: {} of {} processes have none",
                                name_of(estimator), run.ranks.count - views, run.ranks.count));
}

void log_start(const RunResult& run) {
    for (const TargetTexture& t : run.textures)
        log_info(fmt::format("recovering {} ({} x {}, {}), learning rate {:g}", t.name,
                             t.initial.width, t.initial.height,
                             count_text(static_cast<std::size_t>(t.initial.channels), "channel"),
                             t.learning_rate));
    if (run.views.size() > 1)
        log_info(fmt::format("{} to fit, {} held out", count_text(fitted_count(run), "view"),
                             run.views.size() - fitted_count(run)));
    if (!run.kept_text.empty())
        log_info(fmt::format("path cache: {} can see an unknown; {}",
                             count_text(run.seeing_pixels, "pixel"), run.kept_text));
    log_info("memory: " + memory_text(run.memory));
    log_idle(run, run.settings.options.estimator);
    const auto searched =
        std::ranges::count(run.textures, StartKind::kSearched, &TargetTexture::start_kind);
    log_info(fmt::format("optimising with {}; Ctrl-C ends early and keeps the results{}",
                         name_of(run.settings.options.estimator),
                         searched > 0 && !run.goes_on ? ", once the start is found" : ""));
}

/// The descent of the first run and what its result is worth.
void solve_first(Problem problem, OutputFolder& output, std::optional<Checkpoint> from,
                 Phases& phases, RunResult& run) {
    const double earlier = from ? from->run.seconds : 0;
    const bool searches = !from;
    RunCheckpoints checkpoints(run, output);
    run.result = solve_with_progress(std::move(problem), run.settings.options, checkpoints,
                                     std::move(from), {run, output});
    if (!is_first(run.ranks)) return;
    run.similarities.resize(run.views.size());
    parallel_for(run.views.size(),
                 [&](std::size_t i) { run.similarities[i] = similarity_of(run, i); });
    Summary& summary = run.result.summary;
    for (std::size_t i = 0; i < run.textures.size(); ++i)
        run.textures[i].initial = std::move(summary.textures[i].start);
    if (!summary.searched.empty())
        run.phases.emplace_back("search for the start", summary.search_seconds);
    phases.end("optimisation", "evaluation", summary.seconds, earlier,
               searches ? summary.search_seconds : 0);
    if (run.textures.front().truth) {
        find_evidence(run);
        phases.end("visited texels");
    }
    measure_errors(run.textures, run.result);
    warn_of_unseen(run);
    log_result(run, run.result);
}

void solve_second(Problem problem, OutputFolder& output, Phases& phases, RunResult& run) {
    RunCheckpoints checkpoints(run, output, kCompared);
    // From here on a signal of the system waits for a checkpoint again.
    if (keeps_run(output)) set_on_disk(OnDisk::kPart, resume_hint(output));
    std::optional<Checkpoint> from;
    if (run.goes_on) from = load_second_run(checkpoints.options().folder, run.ranks);
    const double earlier = from ? from->run.seconds : 0;
    const bool searches = !from;
    log_idle(run, run.settings.compared->estimator);
    try {
        run.compared = solve_with_progress(std::move(problem), second_options(run), checkpoints,
                                           std::move(from), {run, output, kCompared});
    } catch (const OutputError& e) {  // it was stopped, and has no checkpoint: the first run stays
        log_warning(fmt::format("the second run is left out: {}", e.what()));
        return;
    }
    if (!is_first(run.ranks)) return;
    measure_errors(run.textures, *run.compared);
    const Summary& summary = run.compared->summary;
    if (!summary.searched.empty())
        run.phases.emplace_back("second search for the start", summary.search_seconds);
    phases.end("second optimisation", "its evaluation", summary.seconds, earlier,
               searches ? summary.search_seconds : 0);
    log_result(run, *run.compared);
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
    Problem problem = make_problem(renderer, run);
    const InterruptGuard guard;
    log_start(run);
    const bool again = settings.compared.has_value();
    if (!is_first(run.ranks) && !again) run.views.clear();  // the problem has them
    solve_first(std::move(problem), output, std::move(from), phases, run);
    if (again && agree(run.ranks, !interrupted()))
        solve_second(make_problem(renderer, run), output, phases, run);
    else if (again)
        log_warning("the second run was not begun" +
                    (keeps_run(output) ? ": " + resume_hint(output) : ""));
    if (!is_first(run.ranks)) return;
    write_results(renderer, run, output);
    log_info(fmt::format("the report is {}", (output.folder / "report.html").string()));
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
