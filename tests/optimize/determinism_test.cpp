// The same bytes for any number of threads: what iterations report, the state after them, an
// evaluation, and a gradient. More threads than cores too, in arenas of their own.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "core/parallel.h"
#include "gradient/estimator.h"
#include "optimize/estimators.h"
#include "optimize/small_problem.h"
#include "optimize/state.h"

namespace burnish {
namespace {

/// What a run leaves, as bytes.
struct Bytes {
    std::string data;

    template <class T>
    void add(const T& value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        data.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    void add(const Image& image) {
        for (const float v : image.values) add(v);
    }
    void add(const Iteration& i) {
        add(i.loss), add(i.paths), add(i.derivatives), add(i.texels), add(i.reservoirs);
        add(i.rejected_image), add(i.rejected_derivatives);
    }
    void add(const GradientCounts& counts) {
        add(counts.records), add(counts.candidates), add(counts.texels), add(counts.rejected);
        const Outlier& o = counts.largest;
        add(o.value), add(o.pixel), add(o.slot), add(o.texel), add(o.technique);
    }
};

/// The ninth gradient, of another adjoint, from a state of the second iteration.
void add_gradient(const Solver& solver, const Options& options, const Scene& scene, Bytes& bytes) {
    if (!has_own_derivatives(options.estimator)) return;
    State::Values state = solver.state().values();
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, state.theta);
    EstimatorWorkspace workspace;
    const Image adjoint = test::make_adjoint(scene, 71, true);
    const auto result = estimate_gradient(options.estimator, binding, {&adjoint, 1},
                                          {options.seed, 9}, state.views[0].estimator, workspace);
    for (const SplitGradient& g : result.gradient) bytes.add(g.first);
    bytes.add(result.counts);
    bytes.data += save_state(State(std::move(state)));
}

/// Three iterations of a run, an evaluation, and a gradient.
std::string run_all(const Options& options) {
    const Scene scene = test::small_scene_of(40);
    Solver solver(test::problem_of(scene), options);
    Bytes bytes;
    for (int i = 0; i < 3; ++i) bytes.add(solver.step());
    bytes.data += save_state(solver.state());
    bytes.add(solver.image());
    const Evaluation evaluation = solver.evaluate(2);
    bytes.add(evaluation.views[0].image), bytes.add(evaluation.loss),
        bytes.add(evaluation.noise_floor);
    add_gradient(solver, options, scene, bytes);
    return bytes.data;
}

std::string run_with(int threads, const Options& options) {
    const ThreadLimit limit(threads);
    tbb::task_arena arena(threads);
    return arena.execute([&] { return run_all(options); });
}

void expect_same_bytes(Options options, const std::string& what) {
    options.seed = 5;
    const std::string one = run_with(1, options);
    for (const int threads : {2, 3, 5})
        EXPECT_TRUE(run_with(threads, options) == one) << what << ", " << threads << " threads";
    options.seed = 6;
    EXPECT_FALSE(run_with(1, options) == one) << what << ": another seed, other bytes";
}

TEST(Determinism, ResultsAreTheSameBytesForAnyNumberOfThreads) {
    for (const auto& [name, estimator] : test::all_estimators(2, 2)) {
        Options options;
        options.estimator = estimator;
        expect_same_bytes(options, name);
    }
}

TEST(Determinism, OfTexelsOnTheirOwnToo) {
    for (const Estimator& estimator :
         {Estimator{PathCache{}}, Estimator{Reservoirs{}}, Estimator{MonteCarlo{}}}) {
        Options options;
        options.estimator = estimator;
        options.parameterization = Parameterization::kTexels;
        expect_same_bytes(options, "texels, " + std::to_string(estimator.index()));
    }
}

}  // namespace
}  // namespace burnish
