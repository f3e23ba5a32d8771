// Scripted trajectories: replaying one gives the run's own gradient, every estimator's expectation
// is the converged derivative, which knows its own error, and errors are what they are called.
#include "experiments/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "burnish/error.h"
#include "core/random.h"
#include "experiments/experiments.h"
#include "experiments/small_target_scene.h"
#include "ledger_entries.h"
#include "optimize/iterate.h"
#include "student.h"
#include "temporary_folder.h"
#include "texture/coverage.h"

namespace burnish {
namespace {

using test::small_options;
using test::small_target_scene;

Trajectory record(const TargetScene& scene, const ReproduceOptions& options) {
    return record_trajectory(scene, paper_options(scene, options), options.iterations);
}

TEST(Reproduce, TexturesAreAveragedToSize) {
    const TargetScene scene = small_target_scene(small_options());
    EXPECT_EQ(scene.truth.width, 32);
    EXPECT_EQ(scene.truth.height, 32);
    EXPECT_EQ(scene.renderer.texture(scene.source.parameter), scene.truth);
    EXPECT_EQ(texture_error(scene.truth, scene.truth, scene.visited), 0.0);
    const auto visited = std::count(scene.visited.begin(), scene.visited.end(), 1);
    EXPECT_GT(visited, 100);
    EXPECT_LE(visited, 32 * 32);
}

TEST(Reproduce, AnUnknownParameterIsRefused) {
    const test::TemporaryFolder folder;
    write_procedural_scene("goblet", folder.path, {.texture_size = 16});
    EXPECT_THROW(load_target_scene({"goblet", folder.path / "scene.xml", "nothing", 0.02f, 16},
                                   small_options()),
                 InputError);
}

/// The estimator that recorded a trajectory sees the same textures, adjoints and random numbers
/// again: the same bytes as in the run.
TEST(Reproduce, ReplayingATrajectoryIsTheRun) {
    const ReproduceOptions options = small_options();
    const TargetScene scene = small_target_scene(options);
    const Options paper = paper_options(scene, options);
    const Trajectory trajectory = record(scene, options);
    ASSERT_EQ(trajectory.theta.size(), options.iterations + 1);

    const burnish::Setup setup = make_setup(problem_of(scene), paper);
    State::Values state = make_state(setup);
    Workspace workspace = make_workspace(setup, state);
    for (std::uint32_t v = 0; v <= options.iterations; ++v) {
        EXPECT_EQ(state.theta, trajectory.theta[v]);
        iterate(setup, state, workspace);
    }
    const Image own = sum_of(workspace.views[0].estimator.gradient[0]);
    const auto replayed = [&](std::uint32_t seed) {
        return estimate_along(scene.traced(), trajectory, paper.estimator, seed).gradient;
    };
    EXPECT_EQ(replayed(paper.seed), own);
    EXPECT_NE(replayed(5), own);
}

/// Where not all passes are drawn at once, the estimate is the mean over chunks of passes that no
/// other estimate has.
TEST(Reproduce, ManySamplesAreTheMeanOfChunks) {
    const ReproduceOptions options = small_options();
    const TargetScene scene = small_target_scene(options);
    const Trajectory trajectory = record(scene, options);
    const auto pixels = static_cast<std::size_t>(options.width * options.height);
    const Image chunked = estimate_along(scene.traced(), trajectory, baseline_estimator(6), 0, {},
                                         5 * pixels)
                              .gradient;  // 3 and 3 passes
    std::vector<Image> half;
    for (const std::uint32_t k : {0u, 1u}) {
        ScriptedEstimator alone(baseline_estimator(3), 0);
        half.push_back(estimate_next(scene.traced(), trajectory.theta.back(),
                                     trajectory.adjoint.back(), 2 * options.iterations + k, alone));
    }
    EXPECT_NE(half[0], half[1]);
    for (std::size_t i = 0; i < chunked.values.size(); ++i)
        EXPECT_EQ(chunked.values[i],
                  static_cast<float>((double{half[0].values[i]} + double{half[1].values[i]}) / 2));
}

/// |a - b|^2
double distance2(const Image& a, const Image& b) { return dot(a, a) - 2 * dot(a, b) + dot(b, b); }

double zero_mean_p_value(const test::RunningMean& m) {
    return test::welch_p_value(test::estimate_of(m), {});
}

/// Two independent derivatives differ by twice the squared error of one, on average: no third one
/// has to stand for the truth.
TEST(Reproduce, AConvergedDerivativeStatesItsOwnError) {
    const test::LedgerEntry& entry = test::ledger::kConvergedError;
    const ReproduceOptions options = small_options();
    const TargetScene scene = small_target_scene(options);
    const Trajectory trajectory = record(scene, options);
    const std::uint32_t pairs = test::scaled(entry, 200u);
    test::RunningMean excess, excess_of_a_half;
    for (std::uint32_t k = 0; k < pairs; ++k) {
        std::array<DerivativeReference, 2> d;
        for (std::uint32_t i = 0; i < 2; ++i)
            d[i] = converged_derivative(scene.traced(), trajectory, 8,
                                        test::seed_of(entry, 2 * k + i));
        const double actual = distance2(d[0].gradient, d[1].gradient) / 2;
        const double stated = (d[0].squared_error + d[1].squared_error) / 2;
        excess.add(stated - actual);
        excess_of_a_half.add(2 * stated - actual);
    }
    EXPECT_TRUE(test::accepted(entry, "stated - actual", zero_mean_p_value(excess)));
    EXPECT_TRUE(test::rejected(entry, "error of a half", zero_mean_p_value(excess_of_a_half)));
}

/// The squared error, found from pairs, falls as one over the number of samples.
TEST(Reproduce, MoreSamplesComeNearerToTheConvergedDerivative) {
    const test::LedgerEntry& entry = test::ledger::kMoreSamples;
    const ReproduceOptions options = small_options();
    const TargetScene scene = small_target_scene(options);
    const Trajectory trajectory = record(scene, options);
    const auto errors = [&](std::uint32_t samples, std::uint32_t first_seed) {
        test::RunningMean mean;
        const std::uint32_t pairs = test::scaled(entry, 200u);
        for (std::uint32_t k = 0; k < pairs; ++k) {
            std::array<Image, 2> d;
            for (std::uint32_t i = 0; i < 2; ++i)
                d[i] = converged_derivative(scene.traced(), trajectory, samples,
                                            test::seed_of(entry, first_seed + 2 * k + i))
                           .gradient;
            mean.add(samples * distance2(d[0], d[1]) / 2);
        }
        return test::estimate_of(mean);
    };
    const test::MeanEstimate few = errors(8, 0), more = errors(16, 100000);
    EXPECT_TRUE(test::accepted(entry, "8 and 16 samples", test::welch_p_value(few, more)));
    test::MeanEstimate repeated = few;  // 16 samples with the error of 8
    repeated.mean *= 2, repeated.standard_error *= 2;
    EXPECT_TRUE(test::rejected(entry, "samples that repeat each other",
                               test::welch_p_value(few, repeated)));
}

/// <estimate, r>, with r a derivative that no estimate shares its samples with: the same for all
/// estimators along the same script.
TEST(Reproduce, EstimatorsAgreeAtTheEndOfATrajectory) {
    const test::LedgerEntry& entry = test::ledger::kAlongTrajectory;
    const ReproduceOptions options = small_options();
    const TargetScene scene = small_target_scene(options);
    const Trajectory trajectory = record(scene, options);
    const Image r =
        converged_derivative(scene.traced(), trajectory, 256, test::seed_of(entry, 1)).gradient;
    const auto project = [&](std::uint32_t first_seed, const auto& gradient_of) {
        test::RunningMean mean;
        const std::uint32_t runs = test::scaled(entry, 200u);
        for (std::uint32_t k = 0; k < runs; ++k)
            mean.add(dot(r, gradient_of(test::seed_of(entry, first_seed + k))));
        return test::estimate_of(mean);
    };
    const auto baseline = [&](const Image& adjoint) {
        return [&](std::uint32_t seed) {
            ScriptedEstimator mc(baseline_estimator(8), seed);
            return estimate_next(scene.traced(), trajectory.theta.back(), adjoint, 0, mc);
        };
    };
    const auto along = [&](const Estimator& estimator) {
        return [&, estimator](std::uint32_t seed) {
            return estimate_along(scene.traced(), trajectory, estimator, seed).gradient;
        };
    };
    const test::MeanEstimate expected = project(100000, baseline(trajectory.adjoint.back()));
    const auto p_value = [&](const test::MeanEstimate& e) {
        return test::welch_p_value(expected, e);
    };
    EXPECT_TRUE(test::accepted(entry, "pgris",
                               p_value(project(200000, along(paper_estimator(scene, options))))));
    EXPECT_TRUE(test::accepted(entry, "path cache", p_value(project(300000, along(PathCache{})))));
    EXPECT_TRUE(test::rejected(entry, "adjoint of another iteration",
                               p_value(project(400000, baseline(trajectory.adjoint.front())))));
}

TEST(Reproduce, ErrorsAreWhatTheyAreCalled) {
    Image b = make_image(2, 2, 1), a = b;
    b.values = {1, 0, -2, 4};
    a.values = {2, 1, -2, 2};
    const DerivativeError e = derivative_error(a, {b, 0, 0});
    EXPECT_NEAR(e.nmse, 6.0 / 21, 1e-12);
    EXPECT_NEAR(e.paper, (1 / 1.01 + 1 / 0.01 + 4 / 16.01) / 3, 1e-6);
    EXPECT_NEAR(e.median_relative, 0.5, 1e-12);
}

TEST(Reproduce, TheNmseIsWithoutTheNoiseOfItsReference) {
    Image b = make_image(2, 2, 1), a = b;
    b.values = {1, 0, -2, 4};
    a.values = {2, 1, -2, 2};
    const DerivativeError whole = derivative_error(a, {b, 0, 0}),
                          e = derivative_error(a, {b, 1.5, 1.5 / 19.5});
    EXPECT_NEAR(e.nmse, 4.5 / 19.5, 1e-12);
    EXPECT_GT(whole.nmse, 1.2 * e.nmse);
    EXPECT_EQ(e.paper, whole.paper);
    EXPECT_EQ(e.median_relative, whole.median_relative);
    for (const double s : {6.0, 7.0, 21.0, 30.0})  // of the difference, of the power, too
        EXPECT_TRUE(std::isnan(derivative_error(a, {b, s, INFINITY}).nmse)) << s;
    EXPECT_TRUE(std::isnan(derivative_error(b, {b, 0.1, 0.1 / 20.9}).nmse));
}

/// Each has a seed of its own.
TEST(Reproduce, HalvesOfAConvergedDerivativeShareNoSequence) {
    const ReproduceOptions options = small_options();
    const TargetScene scene = small_target_scene(options);
    const Trajectory trajectory = record(scene, options);
    const DerivativeReference reference = converged_derivative(scene.traced(), trajectory, 20, 7);
    const std::size_t n = reference.gradient.values.size();
    std::array<std::vector<double>, 2> half{std::vector<double>(n), std::vector<double>(n)};
    for (std::uint32_t k = 0; k < 5; ++k) {  // of four passes
        ScriptedEstimator alone(baseline_estimator(4), seed_of_half(7 + 0x9e3779b9u, k % 2));
        const Image block = estimate_next(scene.traced(), trajectory.theta.back(),
                                          trajectory.adjoint.back(), k / 2, alone);
        for (std::size_t i = 0; i < n; ++i)
            half[k % 2][i] += double{block.values[i]} / (k % 2 == 0 ? 3 : 2);
    }
    double squared_error = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double difference = half[0][i] - half[1][i];
        squared_error += difference * difference / 4;
        const double mean = (half[0][i] + half[1][i]) / 2;
        EXPECT_NEAR(double{reference.gradient.values[i]}, mean, 1e-6 * std::abs(mean));
    }
    ASSERT_GT(squared_error, 0);
    EXPECT_NEAR(reference.squared_error / squared_error, 1, 1e-9);
}

TEST(Reproduce, AffordableSamplesFollowTheCostLine) {
    const CostLine cost{0.5, 0.25};
    EXPECT_EQ(affordable_samples(cost, 0.5), 1u);
    EXPECT_EQ(affordable_samples(cost, 0.7499), 1u);
    EXPECT_EQ(affordable_samples(cost, 1.5), 5u);
    EXPECT_EQ(affordable_samples(cost, 0.1), 1u) << "one sample is the least";
    EXPECT_EQ(affordable_samples(cost, 1e9), 256u) << "the most by default";
    EXPECT_EQ(affordable_samples(cost, 1e9, 64), 64u);
}

TEST(Reproduce, PositivizationHoldsInOneDimension) {
    const ExperimentResult result =
        run_positivization({}, small_options(), {[](const std::string&) {}, {}});
    ASSERT_EQ(result.figures.size(), 2u);
    for (const Figure& f : result.figures) EXPECT_EQ(f.verdict, Verdict::kHolds) << f.measured;
}

}  // namespace
}  // namespace burnish
