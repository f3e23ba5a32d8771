#include "burnish/solve.h"

#include <algorithm>
#include <new>

#include "burnish/error.h"
#include "core/stopwatch.h"
#include "optimize/check_state.h"
#include "optimize/checkpoint.h"
#include "optimize/evaluation.h"
#include "optimize/exposure.h"
#include "optimize/iterate.h"
#include "optimize/non_finite.h"
#include "optimize/ranks.h"
#include "optimize/recovered_textures.h"
#include "optimize/run_inputs.h"
#include "optimize/search_again.h"
#include "optimize/shared_pyramid.h"
#include "optimize/start_search.h"
#include "optimize/summary.h"

namespace burnish {

struct Solver::Impl {
    Setup setup;
    State::Values state;
    Workspace workspace;
    SearchReport search;
    // What Options::stop counts: of this solver, and of the run that it goes on with.
    double seconds = 0;
    std::uint32_t before = state.iteration;  ///< iterations before the first that counts
};

namespace {

/// What only the owners of views need: pictures are most of what a view takes.
void drop_pictures_of_others(Setup& setup) {
    for (std::size_t v = 0; v < setup.views.size(); ++v)
        if (!is_mine(setup, v)) setup.problem.views[v].image = setup.problem.views[v].mask = {};
}

std::unique_ptr<Solver::Impl> make_run(Setup setup, State::Values state, SearchReport search) {
    drop_pictures_of_others(setup);
    const Ranks& ranks = setup.problem.ranks;
    for (PyramidState& p : state.pyramids) keep_part(p, ranks.rank, ranks.count);
    Workspace workspace = make_workspace(setup, state);
    if (!workspace.keeps_records)  // a state under another limit may have some
        for (ViewState& view : state.views) keep_window(0, kept_cache(view.estimator));
    return std::make_unique<Solver::Impl>(
        Solver::Impl{std::move(setup), std::move(state), std::move(workspace), std::move(search)});
}

/// Searched starts are those of the state, where they fit.
void take_starts(const State::Values& state, Setup& setup) {
    for (std::size_t i = 0; i < std::min(setup.unknowns.size(), state.searched.size()); ++i) {
        UnknownTexture& u = setup.unknowns[i];
        if (u.start_kind == StartKind::kSearched && has_shape_of(state.searched[i], u.start))
            u.start = state.searched[i];
    }
}

/// Exposures that are not fitted are those of the problem.
void take_exposures(const Setup& setup, State::Values& state) {
    for (std::size_t i = 0; i < setup.fitted.size(); ++i) {
        const Exposure& exposure = setup.problem.views[setup.fitted[i]].exposure;
        if (!fits_exposure(exposure)) state.views[i].exposure = factors_of(exposure);
    }
}

/// Goes on from a state.
std::unique_ptr<Solver::Impl> resumed_run(Setup setup, State::Values state) {
    require_one_problem(setup, &state);
    take_starts(state, setup);
    require_state_of(setup, state);
    take_exposures(setup, state);
    drop_views_of_others(setup, state);
    return make_run(std::move(setup), std::move(state), {});
}

/// Tells the progress of one stage.
Progress stage_of(const StageProgress& progress, const char* stage) {
    if (!progress) return {};
    return [&progress, stage](double share) { progress(stage, share); };
}

std::unique_ptr<Solver::Impl> new_run(Setup setup, const StageProgress& progress) {
    require_one_problem(setup);
    SearchReport search = find_starts(setup, stage_of(progress, "searching the start"));
    State::Values state = make_state(setup);
    keep_search(setup.options, std::move(search.sums), search.effort, state);
    return make_run(std::move(setup), std::move(state), std::move(search));
}

}  // namespace

Solver::Solver(Problem problem, Options options, const StageProgress& progress) {
    impl_ = new_run(make_setup(std::move(problem), std::move(options)), progress);
}
Solver::Solver(Problem problem, Options options, const State& state) {
    State::Values values = state.values();
    values.patience = {};
    impl_ = resumed_run(make_setup(std::move(problem), std::move(options)), std::move(values));
}
Solver::Solver(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::~Solver() = default;

std::vector<RecoveredTexture> Solver::recovered() const {
    const State::Values& state = impl_->state;
    const Ranks& ranks = impl_->setup.problem.ranks;
    if (ranks.count == 1) return recovered_textures(impl_->setup, state);
    State::Values whole;
    whole.iteration = state.iteration, whole.theta = state.theta, whole.pyramids = state.pyramids;
    gather_parts(ranks, whole.pyramids);
    return recovered_textures(impl_->setup, whole);
}
const Problem& Solver::problem() const { return impl_->setup.problem; }
std::uint32_t Solver::iterations() const { return impl_->state.iteration; }
const Image& Solver::texture(std::size_t unknown) const {
    return impl_->state.theta.textures.at(unknown).values;
}
const Image& Solver::image(std::size_t view) const {
    static const Image kNone;
    const std::optional<std::size_t> i = which_fitted(impl_->setup, view);
    return i ? impl_->workspace.views[*i].image : kNone;
}
ExposureFactors Solver::exposure(std::size_t view) const {
    const Setup& setup = impl_->setup;
    if (const auto i = which_fitted(setup, view)) return impl_->state.views[*i].exposure;
    return factors_of(setup.problem.views.at(view).exposure);
}
State Solver::state() const {
    State state(impl_->state);
    gather_parts(impl_->setup.problem.ranks, state.values().pyramids);
    return state;
}
Evaluation Solver::evaluate(std::uint32_t samples_per_pixel, std::uint32_t salt,
                            const Progress& progress) const {
    return burnish::evaluate(impl_->setup, impl_->state.theta, samples_per_pixel, salt, progress);
}

namespace {

/// Looks every few iterations whether the loss still falls.
std::optional<double> check_patience(Solver::Impl& run) {
    constexpr std::uint32_t kPeriod = 20;
    if (run.setup.options.stop.patience == 0 || run.state.iteration % kPeriod != 0) return {};
    const double loss = check_loss(run.setup, run.state.theta);
    PatienceState& patience = run.state.patience;
    patience.failed = loss < patience.min_loss ? 0 : patience.failed + 1;
    patience.min_loss = std::min(patience.min_loss, loss);
    return loss;
}

/// The recovered textures as the renderer takes them; their values are moved, not copied.
Theta take_theta(const Setup& setup, std::vector<RecoveredTexture>& textures) {
    Theta theta;
    for (std::size_t i = 0; i < textures.size(); ++i)
        theta.textures.push_back({setup.unknowns[i].texture, std::move(textures[i].values)});
    return theta;
}

std::optional<Ending> ending_of(const Solver::Impl& run) {
    const std::uint32_t iterations = run.state.iteration - run.before;
    if (iterations == 0) return {};
    const Stop stop = effective_stop(run.setup.options);
    if (stop.patience > 0 && run.state.patience.failed >= stop.patience) return Ending::kPatience;
    if (iterations >= stop.iterations) return Ending::kIterations;
    if (run.seconds >= stop.seconds) return Ending::kTime;
    return {};
}

/// One iteration with its checks. earlier: seconds before the watch began. stop: alone may end it,
/// where it can still be given up as a whole.
Iteration iterate_once(Solver::Impl& run, const Stopwatch& watch, double earlier,
                       const StopQuestion& stop) {
    const Stoppable none(StopQuestion{});
    search_again(run.setup, run.state, stop);
    Iteration i = iterate(run.setup, run.state, run.workspace, stop);
    i.held_out_loss = check_patience(run);
    i.seconds = run.seconds = agree(run.setup.problem.ranks, earlier + watch.total());
    return i;
}

/// What the first process is told to do after an iteration.
Control asked(const Solver& solver, const Callback& callback, const Iteration& iteration) {
    const Ranks& ranks = solver.problem().ranks;
    return agree(ranks, callback && is_first(ranks) ? callback(iteration, solver) : Continue);
}

/// Memory has ended: room for writing is made first. Of several processes each would have to.
void keep_what_is_done(Solver::Impl& run, const Summary& summary, CheckpointWriter& checkpoints) {
    const bool is_between_iterations = run.state.iteration == summary.counts.iterations;
    if (run.setup.problem.ranks.count > 1 || !is_between_iterations) return;
    run.workspace = {};
    checkpoints.offer(summary, run.state, true);
}

/// summary: what an earlier process has found, or empty. checkpoints may be null. None: they were
/// asked to stop within an iteration.
std::optional<Ending> iterate_until_end(const Callback& callback, Solver& solver, Summary& summary,
                                        CheckpointWriter* checkpoints) {
    Solver::Impl& run = solver.impl();
    const Stopwatch watch;
    const double earlier = run.seconds = summary.seconds;
    run.before = run.state.iteration - summary.counts.iterations;
    while (true) {
        if (const auto ending = ending_of(run)) return ending;
        Iteration i;
        try {
            i = iterate_once(run, watch, earlier,
                             checkpoints ? checkpoints->stop() : StopQuestion{});
            add_iteration(i, summary);
            summary.seconds = i.seconds;
        } catch (const StoppedElsewhere&) {
            return {};
        } catch (const Stopped&) {
            tell_stopped(run.setup.problem.ranks);
            return {};
        } catch (const std::bad_alloc&) {
            if (checkpoints) keep_what_is_done(run, summary, *checkpoints);
            throw;
        }
        if (const std::string bad = non_finite_text(run.setup, i); !bad.empty()) {
            if (checkpoints) checkpoints->offer(summary, run.state, true);
            throw InputError(bad);
        }
        const Control control = asked(solver, callback, i);
        if (control == Cancel) return Ending::kCancelled;
        if (control == Suspend) return Ending::kSuspended;
        if (checkpoints) checkpoints->offer(summary, run.state, false);
    }
}

/// start: where the run began.
void evaluate_textures(Solver::Impl& run, const Theta& start, const StageProgress& progress,
                       Summary& summary) {
    const std::uint32_t samples = result_samples(run.setup, summary.counts.iterations);
    summary.start =
        evaluate_start(run.setup, start, samples, stage_of(progress, "rendering the start"));
    Theta theta = take_theta(run.setup, summary.textures);
    summary.result =
        evaluate_result(run.setup, theta, samples, stage_of(progress, "evaluating the result"));
    for (std::size_t i = 0; i < summary.textures.size(); ++i)
        summary.textures[i].values = std::move(theta.textures[i].values);
    summary.counts.rejected_image += summary.start.rejected + summary.result.rejected;
}

/// Whether a process is asked to stop.
bool is_stopped(const Ranks& ranks, const StopQuestion& stop) {
    const std::vector<char> asked = all_values(ranks, static_cast<char>(stop && stop()));
    return std::find(asked.begin(), asked.end(), 1) != asked.end();
}

/// What ends the run, once its last checkpoint is written; where that fails, results are all that
/// is left of one that was stopped. ended: of iterate_until_end. checkpoints may be null.
Ending end_with_checkpoint(const Solver::Impl& run, const Summary& summary,
                           std::optional<Ending> ended, CheckpointWriter* checkpoints) {
    const bool is_kept = checkpoints && checkpoints->offer(summary, run.state, true);
    if (is_kept && (!ended || is_stopped(run.setup.problem.ranks, checkpoints->stop())))
        return Ending::kSuspended;
    return ended.value_or(summary.counts.iterations > 0 ? Ending::kCancelled : Ending::kSuspended);
}

/// given: where the run starts, if not at the start of its unknowns.
Summary solve_from(Solver solver, Summary summary, const Callback& callback,
                   const StageProgress& progress, CheckpointWriter* checkpoints = nullptr,
                   std::optional<Theta> given = {}) {
    Solver::Impl& run = solver.impl();
    const std::optional<Ending> ended = iterate_until_end(callback, solver, summary, checkpoints);
    summary.ending = end_with_checkpoint(run, summary, ended, checkpoints);
    run.workspace = {};  // the textures and the evaluation take its place
    gather_parts(run.setup.problem.ranks, run.state.pyramids);
    summary.textures = recovered_textures(run.setup, run.state);
    summary.search_effort = run.state.search_effort;
    summary.searched_again = run.state.searched_again;
    if (summary.ending != Ending::kSuspended)
        evaluate_textures(run, given ? *given : initial_theta(run.setup), progress, summary);
    summary.state = State(std::move(run.state));  // not copied: a path cache is large
    return summary;
}

/// What the search has found.
Summary summary_of(SearchReport search) {
    Summary summary;
    summary.search_seconds = search.seconds;
    summary.searched = std::move(search.groups);
    return summary;
}

}  // namespace

Iteration Solver::step() {
    const Stopwatch watch;
    const double earlier = impl_->seconds;
    try {
        return iterate_once(*impl_, watch, earlier, {});
    } catch (...) {  // in a check: the iteration is done
        impl_->seconds = earlier + watch.total();
        throw;
    }
}

std::optional<Ending> Solver::ending() const { return ending_of(*impl_); }

Summary solve(Problem problem, const Options& options, const Callback& callback,
              const StageProgress& progress) {
    Solver solver(std::move(problem), options, progress);
    Summary summary = summary_of(solver.impl().search);
    return solve_from(std::move(solver), std::move(summary), callback, progress);
}

Summary solve(Problem problem, const Options& options, const State& state, const Callback& callback,
              const StageProgress& progress) {
    return solve_from(Solver(std::move(problem), options, state), {}, callback, progress, nullptr,
                      state.values().theta);
}

Summary solve(Problem problem, const Options& options, const Checkpoints& checkpoints,
              const Callback& callback, const StageProgress& progress) {
    Setup setup = make_setup(std::move(problem), options);
    const Ranks ranks = setup.problem.ranks;
    CheckpointWriter writer(checkpoints, inputs_of(setup), ranks, {});
    Solver solver(new_run(std::move(setup), progress));
    Summary summary = summary_of(solver.impl().search);
    return solve_from(std::move(solver), std::move(summary), callback, progress, &writer);
}

Summary solve(Problem problem, const Options& options, Checkpoint from,
              const Checkpoints& checkpoints, const Callback& callback,
              const StageProgress& progress) {
    Setup setup = make_setup(std::move(problem), options);
    const Ranks ranks = setup.problem.ranks;
    std::vector<Input> inputs = inputs_of(setup);
    require_same_inputs(from.problem, inputs);
    State::Values& state = from.run.state.values();
    CheckpointWriter writer(checkpoints, std::move(inputs), ranks, state.iteration);
    Solver solver(resumed_run(std::move(setup), std::move(state)));
    return solve_from(std::move(solver), std::move(from.run), callback, progress, &writer);
}

}  // namespace burnish
