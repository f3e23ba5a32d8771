#include "experiments/inverse_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/stopwatch.h"
#include "texture/coverage.h"

namespace burnish {

namespace {

Budget budget_of(const Method& method, Budget budget) {
    if (!method.is_long) budget.long_iterations = budget.iterations;
    return budget;
}

/// The budgets that a run has passed.
std::array<bool, kMoments> passed(const Budget& budget, const Moment& now) {
    return {now.iteration >= budget.iterations, now.iteration >= budget.long_iterations,
            now.derivative_seconds >= budget.derivative_seconds, now.seconds >= budget.seconds};
}

double share_done(const Budget& budget, const Moment& now) {
    return std::min({1.0, 1.0 * now.iteration / budget.long_iterations,
                     now.derivative_seconds / budget.derivative_seconds,
                     now.seconds / budget.seconds});
}

}  // namespace

InverseRuns planned_runs(const TargetScene& scene, const ReproduceOptions& options) {
    Reservoirs replay = paper_estimator(scene, options), identity = replay, gris = replay;
    identity.shift = Shift::kIdentity;
    gris.positivization = false;
    return {{{"mc", baseline_estimator(options), true},
             {"gris, replay", gris},
             {"pgris, replay", replay, true},
             {"pgris, identity", identity},
             {"path cache", PathCache{}}}};
}

Moment evaluate_moment(const TargetScene& scene, const ReproduceOptions& options,
                       const Solver& solver) {
    // The same samples for all: what differs is the texture.
    Evaluation e = solver.evaluate(options.evaluation_samples);
    Moment m;
    m.iteration = solver.iterations();
    m.loss = e.loss - e.noise_floor, m.noise_floor = e.noise_floor;
    m.texture_error = texture_error(solver.texture(0), scene.truth, scene.visited);
    m.image = std::move(e.views[0].image), m.texture = solver.texture(0);
    return m;
}

Run run_method(const TargetScene& scene, const Method& method, const ReproduceOptions& options,
               std::uint32_t k, const WorkNote& note) {
    note(fmt::format("{}: {}, run {} of {}", scene.source.name, method.name, k + 1, options.runs));
    const Stopwatch watch;
    Options run_options = paper_options(scene, options);
    run_options.estimator = method.estimator;
    run_options.seed = options.seed + k;
    const Budget budget = budget_of(method, options.budget);
    Solver solver(problem_of(scene), run_options);
    Run run;
    run.losses.name = method.name;
    Moment now;
    std::array<bool, kMoments> done{};
    while (!std::all_of(done.begin(), done.end(), [](bool d) { return d; })) {
        const Iteration i = solver.step();
        now.iteration = solver.iterations();
        now.seconds += stage_seconds(i), now.derivative_seconds += i.derivative_seconds;
        run.losses.points.push_back({now.derivative_seconds, i.loss});
        const auto before = std::exchange(done, passed(budget, now));
        if (note.share) note.share(share_done(budget, now));
        if (before == done) continue;
        Moment m = evaluate_moment(scene, options, solver);
        m.seconds = now.seconds, m.derivative_seconds = now.derivative_seconds;
        for (std::size_t b = 0; b < kMoments; ++b)
            if (done[b] && !before[b]) run.at[b] = m;
    }
    for (std::size_t b = 0; b < kMoments; ++b)
        if (k > 0 || b != kDerivative) run.at[b].image = {}, run.at[b].texture = {};
    run.seconds = watch.total();
    return run;
}

std::shared_ptr<const InverseRuns> make_runs(const TargetScene& scene,
                                             const ReproduceOptions& options, const GetRun& get) {
    InverseRuns runs = planned_runs(scene, options);
    for (Method& method : runs.methods)
        for (std::uint32_t k = 0; k < options.runs; ++k) {
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

}  // namespace burnish
