#include "experiments/inverse_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/stopwatch.h"
#include "experiments/interval.h"
#include "gradient/estimator.h"
#include "optimize/state.h"
#include "texture/coverage.h"

namespace burnish {

namespace {

constexpr float kStart = 0.5f;  ///< of all texels

Budget budget_of(const Method& method, Budget budget) {
    if (!method.is_long) budget.long_iterations = budget.iterations;
    return budget;
}

/// The moments that a run has passed.
std::array<bool, kMoments> passed(const Method& method, const Budget& budget, const Moment& now) {
    const double late = method.is_late ? 2.0 / 3 : 1;
    return {now.iteration >= budget.iterations, now.iteration >= budget.long_iterations,
            now.derivative_seconds >= budget.derivative_seconds, now.seconds >= budget.seconds,
            now.derivative_seconds >= late * budget.derivative_seconds};
}

double share_done(const Budget& budget, const Moment& now) {
    return std::min({1.0, 1.0 * now.iteration / budget.long_iterations,
                     now.derivative_seconds / budget.derivative_seconds,
                     now.seconds / budget.seconds});
}

/// A run on its way.
struct RunSoFar {
    Run run;
    Moment now;
    std::array<bool, kMoments> done{};  ///< the moments that it has passed
};

bool is_over(const RunSoFar& so_far) {
    return std::all_of(so_far.done.begin(), so_far.done.end(), [](bool d) { return d; });
}

void add(const Method& method, const Iteration& i, RunSoFar& so_far) {
    Moment& now = so_far.now;
    now.iteration = i.number + 1;
    now.seconds += stage_seconds(i);
    now.derivative_seconds +=
        i.derivative_seconds + (has_own_derivatives(method.estimator) ? 0 : i.image_seconds);
    so_far.run.losses.points.push_back({now.derivative_seconds, i.loss});
}

/// What is kept of a run; none: not all of it.
std::optional<RunSoFar> run_of(const RunKeeper& keeper, const Method& method,
                               const Budget& budget) {
    const Summary& kept = keeper.from->run;
    if (kept.iterations.size() != kept.counts.iterations) return {};
    RunSoFar so_far;
    for (const Iteration& i : kept.iterations) add(method, i, so_far);
    so_far.run.seconds = kept.seconds;
    so_far.done = passed(method, budget, so_far.now);
    for (std::size_t b = 0; b < kMoments; ++b) {
        if (!so_far.done[b]) continue;
        if (!keeper.moments[b]) return {};
        so_far.run.at[b] = *keeper.moments[b];
    }
    return so_far;
}

/// Root mean square of the values that a step has moved, in units of the rate.
double step_length(const Image& before, const Image& after, double rate) {
    double squares = 0;
    std::size_t moved = 0;
    for (std::size_t i = 0; i < after.values.size(); ++i) {
        const double step = double{after.values[i]} - double{before.values[i]};
        squares += step * step, moved += step != 0;
    }
    return moved > 0 ? std::sqrt(squares / static_cast<double>(moved)) / rate : 0;
}

/// Where a run begins or goes on.
Image first_texture(const TargetScene& scene, const RunKeeper* keeper) {
    if (keeper && keeper->from)
        return copy_of(keeper->from->run.state.values().theta.textures[0].values);
    return make_image(scene.truth.width, scene.truth.height, scene.truth.channels, kStart);
}

/// The textures as they are at `now`, evaluated.
Moment moment_of(const TargetScene& scene, const ReproduceOptions& options, const Solver& solver,
                 const Moment& now) {
    Moment m = evaluate_moment(scene, options, solver);
    m.seconds = now.seconds, m.derivative_seconds = now.derivative_seconds;
    return m;
}

/// As of late_changes.
double late_change(const Run& run) {
    const Moment &late = run.at[kLate], &end = run.at[kDerivative];
    if (late.iteration == end.iteration) return std::numeric_limits<double>::quiet_NaN();
    return positive_ratio(end.loss, late.loss);
}

}  // namespace

InverseRuns planned_runs(const TargetScene& scene, const ReproduceOptions& options) {
    Reservoirs replay = paper_estimator(scene, options), identity = replay, gris = replay;
    identity.shift = Shift::kIdentity;
    gris.positivization = false;
    return {
        {{.name = "mc", .estimator = baseline_estimator(options), .is_long = true, .is_late = true},
         {"gris, replay", gris},
         {.name = "pgris, replay", .estimator = replay, .is_long = true, .is_late = true},
         {.name = "pgris, identity", .estimator = identity, .is_late = true},
         {"path cache", PathCache{}}}};
}

Moment evaluate_moment(const TargetScene& scene, const ReproduceOptions& options,
                       const Solver& solver) {
    // The same samples for all: what differs is the texture.
    Evaluation e = solver.evaluate(options.evaluation_samples);
    Moment m;
    m.iteration = solver.iterations();
    m.loss = loss_without_noise(e), m.noise_floor = e.noise_floor;
    m.texture_error = texture_error(solver.texture(0), scene.truth, scene.visited);
    m.image = std::move(e.views[0].image), m.texture = solver.texture(0);
    return m;
}

std::optional<Run> run_method(const TargetScene& scene, const Method& method,
                              const ReproduceOptions& options, std::uint32_t k,
                              const WorkNote& note, RunKeeper* keeper) {
    note(fmt::format("{}: {}, run {} of {}", scene.source.name, method.name, k + 1, options.runs));
    const Stopwatch watch;
    Options run_options = paper_options(scene, options);
    run_options.estimator = method.estimator;
    run_options.seed = options.seed + k;
    run_options.stop.seconds = 1e9;  // its budgets end it
    // Of a run that is stopped and whose checkpoint cannot be written.
    run_options.evaluation_samples = 2;
    const Budget budget = budget_of(method, options.budget);
    RunSoFar so_far;
    if (keeper && keeper->from) {
        if (auto earlier = run_of(*keeper, method, budget))
            so_far = std::move(*earlier);
        else
            keeper->from.reset();
    }
    so_far.run.losses.name = method.name;
    const auto tell_share = [&] {
        if (note.share) note.share(share_done(budget, so_far.now));
    };
    tell_share();
    const double earlier_seconds = so_far.run.seconds;

    Image before_step;
    const auto is_before_step = [&] { return so_far.now.iteration + 1 == budget.iterations; };
    if (is_before_step()) before_step = first_texture(scene, keeper);
    const auto after = [&](const Iteration& i, const Solver& solver) {
        add(method, i, so_far);
        if (is_before_step()) before_step = copy_of(solver.texture(0));
        const auto before = std::exchange(so_far.done, passed(method, budget, so_far.now));
        tell_share();
        if (before == so_far.done) return Continue;
        Moment m = moment_of(scene, options, solver, so_far.now);
        if (m.iteration == budget.iterations)
            m.step_length = step_length(before_step, m.texture, *run_options.learning_rate);
        for (std::size_t b = 0; b < kMoments; ++b) {
            if (!so_far.done[b] || before[b]) continue;
            Moment& at = so_far.run.at[b] = m;
            if (k > 0 || b != kDerivative) at.image = {}, at.texture = {};
            if (keeper) keeper->keep(b, at);
        }
        return is_over(so_far) ? Suspend : Continue;
    };
    Problem problem = problem_of(scene, kStart);
    if (!keeper)
        solve(std::move(problem), run_options, after);
    else if (!keeper->from)
        solve(std::move(problem), run_options, keeper->checkpoints, after);
    else if (!is_over(so_far))
        solve(std::move(problem), run_options, std::move(*keeper->from), keeper->checkpoints,
              after);
    if (!is_over(so_far)) return {};
    so_far.run.seconds = earlier_seconds + watch.total();
    return std::move(so_far.run);
}

std::shared_ptr<const InverseRuns> make_runs(const TargetScene& scene,
                                             const ReproduceOptions& options, const GetRun& get) {
    InverseRuns runs = planned_runs(scene, options);
    // Method by method within a seed: the runs of a ratio see the machine at nearly the same time.
    for (std::uint32_t k = 0; k < options.runs; ++k)
        for (Method& method : runs.methods) {
            std::optional<Run> run = get(method, k);
            if (!run) return nullptr;
            method.runs.push_back(std::move(*run));
        }
    return std::make_shared<const InverseRuns>(std::move(runs));
}

const InverseRuns& runs_of(TargetScene& scene, const ReproduceOptions& options,
                           const WorkNote& note) {
    if (!scene.runs)
        scene.runs = make_runs(scene, options, [&](const Method& method, std::uint32_t k) {
            return run_method(scene, method, options, k, note);
        });
    return *scene.runs;
}

std::vector<double> late_changes(const Method& method) {
    std::vector<double> ratios;
    for (const Run& run : method.runs) ratios.push_back(late_change(run));
    return ratios;
}

}  // namespace burnish
