#include "cli/solve_runs.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/folder_content.h"
#include "cli/interrupt.h"
#include "cli/optimize_results.h"
#include "cli/process_memory.h"
#include "cli/run_checkpoints.h"
#include "cli/run_evidence.h"
#include "cli/solve_run.h"
#include "cli/target_textures.h"
#include "cli/unseeing_views.h"
#include "core/parallel.h"
#include "gradient/estimator.h"
#include "optimize/ranks.h"
#include "optimize/run_inputs.h"

namespace burnish {

namespace {

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

/// from: where it goes on.
void solve_second_from(std::optional<Checkpoint> from, const Renderer& renderer,
                       OutputFolder& output, Phases& phases, RunResult& run) {
    RunCheckpoints checkpoints(run, output, kCompared);
    const double earlier = from ? from->run.seconds : 0;
    const bool searches = !from;
    try {
        run.compared = solve_with_progress(make_problem(renderer, run), second_options(run),
                                           checkpoints, std::move(from), {run, output, kCompared});
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

/// Goes on where there is a checkpoint that is its own.
void go_on_with_second(const Renderer& renderer, OutputFolder& output, Phases& phases,
                       RunResult& run) {
    std::optional<Checkpoint> from;
    if (run.goes_on) from = load_second_run(output.checkpoints / kCompared, run.ranks);
    const std::string file = from ? from->file : "";
    try {
        return solve_second_from(std::move(from), renderer, output, phases, run);
    } catch (const ChangedRun& e) {
        log_warning(fmt::format("{}: {}: the second run begins anew", file, e.what()));
    }
    solve_second_from({}, renderer, output, phases, run);
}

}  // namespace

void solve_first(const Renderer& renderer, OutputFolder& output, std::optional<Checkpoint> from,
                 Phases& phases, RunResult& run) {
    log_start(run);
    Problem problem = make_problem(renderer, run);
    if (!is_first(run.ranks) && !run.settings.compared) run.views.clear();  // the problem has them
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

std::exception_ptr solve_second(const Renderer& renderer, OutputFolder& output, Phases& phases,
                                RunResult& run) {
    // From here on a signal of the system waits for a checkpoint again.
    if (keeps_run(output)) set_on_disk(OnDisk::kPart, resume_hint(output));
    log_idle(run, run.settings.compared->estimator);
    try {
        go_on_with_second(renderer, output, phases, run);
    } catch (const Suspended&) {
        throw;
    } catch (const std::exception&) {
        run.compared.reset();
        return std::current_exception();
    }
    return {};
}

}  // namespace burnish
