#include "cli/solve_run.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include "cli/interrupt.h"
#include "cli/solve_progress.h"
#include "core/parallel.h"

namespace burnish {

namespace {

/// Whether the run begins with a search for the start. A signal in it ends the program: there is no
/// result yet.
bool begins_with_search(const Problem& problem, bool goes_on) {
    return !goes_on && std::any_of(problem.unknowns.begin(), problem.unknowns.end(), [](auto& u) {
        return std::holds_alternative<SearchStart>(u.start);
    });
}

}  // namespace

EvaluatedRun solve_with_progress(Problem problem, const Options& options,
                                 RunCheckpoints& checkpoints, std::optional<Checkpoint> from,
                                 LiveView live) {
    const std::vector<Iteration> earlier = from ? from->run.iterations : std::vector<Iteration>{};
    SolveProgress progress(options, from ? from->run.counts.iterations : 0);
    checkpoints.begin(earlier);
    const Callback show = progress.callback();
    const Callback callback = [&](const Iteration& i, const Solver& solver) {
        checkpoints.add(i);
        live.update(solver);
        return show(i, solver);
    };
    std::atomic<bool> searches = begins_with_search(problem, from.has_value());
    const StageProgress stages = [&, tell = progress.stages()](const char* stage, double share) {
        if (share == 1) searches = false;
        tell(stage, share);
    };
    EvaluatedRun run{options, {}, {}};
    try {
        const StopQuestion stop = [&] { return searches && interrupted(); };
        const Stoppable stoppable(stop);
        run.summary =
            from ? solve(std::move(problem), options, std::move(*from), checkpoints.options(),
                         callback, stages)
                 : solve(std::move(problem), options, checkpoints.options(), callback, stages);
    } catch (const Stopped&) {
        end_interrupted("stopped while the start was searched: nothing of this run is kept");
    }
    if (run.summary.ending == Ending::kSuspended) checkpoints.suspend();
    run.summary.state = State();  // a path cache is large, and nothing goes on from here
    live.finish(run.summary);
    return run;
}

}  // namespace burnish
