// Scripted trajectories: replaying one gives the descent's own gradient, errors are what they are
// called, and the converged derivative knows its own error.
#include "experiments/trajectory.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "texture/coverage.h"
#include "experiments/experiments.h"
#include "experiments/small_subject.h"

namespace burnish {
namespace {

using test::small_options;
using test::small_subject;

TEST(Reproduce, TexturesAreAveragedToSize) {
    const auto subject = small_subject(small_options());
    EXPECT_EQ(subject->truth.width, 32);
    EXPECT_EQ(subject->truth.height, 32);
    EXPECT_EQ(texture_error(subject->truth, subject->truth, subject->reached), 0.0);
    const auto reached = std::count(subject->reached.begin(), subject->reached.end(), 1);
    EXPECT_GT(reached, 100);
    EXPECT_LE(reached, 32 * 32);
}

TEST(Reproduce, AnUnknownParameterIsRefused) {
    const auto folder = std::filesystem::temp_directory_path() / "burnish_reproduce_refused";
    write_procedural_scene("goblet", folder, {.texture_size = 16});
    EXPECT_THROW(
        prepare_subject({"goblet", folder / "scene.xml", "nothing", 0.02f, 16}, small_options()),
        std::runtime_error);
    std::filesystem::remove_all(folder);
}

/// The estimator that recorded a trajectory sees the same textures, adjoints and random numbers
/// again: the same bytes as in the descent.
TEST(Reproduce, ReplayingATrajectoryIsTheDescent) {
    const ReproduceOptions options = small_options();
    const auto subject = small_subject(options);
    const SolveOptions solve = paper_options(*subject, options);
    const Trajectory trajectory = record_trajectory(*subject, options, solve);
    ASSERT_EQ(trajectory.theta.size(), options.iterations + 1);

    SolveState state = start_gray(*subject, solve);
    for (std::uint32_t v = 0; v < options.iterations; ++v) {
        EXPECT_EQ(state.theta.textures[0].values.values,
                  trajectory.theta[v].textures[0].values.values);
        iterate(subject->problem, solve, state);
    }
    const PrimalPass primal = primal_pass(subject->problem, solve, state);
    EXPECT_EQ(primal.loss.adjoint.values, trajectory.adjoint.back().values);
    const auto result = estimate_gradient(*subject->traced, state.theta, primal.loss.adjoint,
                                          options.iterations, solve.gradient, state.history);
    const Image own = dense_gradient(state.theta, result.gradient)[0];
    EXPECT_EQ(estimate_along(*subject->traced, trajectory, solve.gradient).gradient.values,
              own.values);
    GradientOptions other = solve.gradient;
    other.seed = 5;
    EXPECT_NE(estimate_along(*subject->traced, trajectory, other).gradient.values, own.values);
}

/// Where not all passes are drawn at once, the estimate is the mean over chunks of passes that no
/// other estimate has.
TEST(Reproduce, ManySamplesAreTheMeanOfChunks) {
    const ReproduceOptions options = small_options();
    const auto subject = small_subject(options);
    const SolveOptions solve = paper_options(*subject, options);
    const Trajectory trajectory = record_trajectory(*subject, options, solve);
    GradientOptions mc = solve.gradient;
    mc.estimator = Estimator::kMc;
    mc.samples_per_pixel = 6;
    const auto pixels = static_cast<std::size_t>(options.width * options.height);
    const Image chunked = estimate_along(*subject->traced, trajectory, mc, {}, 5 * pixels)
                              .gradient;  // 3 and 3 passes
    mc.samples_per_pixel = 3;
    std::vector<Image> half;
    for (const std::uint32_t k : {0u, 1u})
        half.push_back(dense_gradient(
            trajectory.theta.back(),
            estimate_gradient(*subject->traced, trajectory.theta.back(), trajectory.adjoint.back(),
                              2 * options.iterations + k, mc, {})
                .gradient)[0]);
    EXPECT_NE(half[0].values, half[1].values);
    for (std::size_t i = 0; i < chunked.values.size(); ++i)
        EXPECT_EQ(chunked.values[i],
                  static_cast<float>((double{half[0].values[i]} + double{half[1].values[i]}) / 2));
}

TEST(Reproduce, MoreSamplesComeNearerToTheConvergedDerivative) {
    const ReproduceOptions options = small_options();
    const auto subject = small_subject(options);
    const SolveOptions solve = paper_options(*subject, options);
    const Trajectory trajectory = record_trajectory(*subject, options, solve);
    const auto many = converged_derivative(*subject, trajectory, 8192, 2);
    // The error that a derivative states of itself is the one that it has, on average over seeds:
    // the contributions are heavy-tailed, so within a factor of 1.5.
    double stated = 0, actual = 0;
    for (std::uint32_t seed = 10; seed < 16; ++seed) {
        const auto few = converged_derivative(*subject, trajectory, 512, seed);
        stated += few.nmse / 6;
        actual += derivative_error(few.gradient, many.gradient).nmse / 6;
    }
    EXPECT_GT(stated, actual / 1.5);
    EXPECT_LT(stated, actual * 1.5);
    EXPECT_LT(many.nmse, 0.5 * stated);
    GradientOptions mc = solve.gradient;
    mc.estimator = Estimator::kMc;
    const double one =
        derivative_error(estimate_along(*subject->traced, trajectory, mc).gradient, many.gradient)
            .nmse;
    EXPECT_GT(one, 100 * actual);
}

TEST(Reproduce, ErrorsAreWhatTheyAreCalled) {
    Image b = make_image(2, 2, 1), a = b;
    b.values = {1, 0, -2, 4};
    a.values = {2, 1, -2, 2};
    const DerivativeError e = derivative_error(a, b);
    EXPECT_NEAR(e.nmse, 6.0 / 21, 1e-12);
    EXPECT_NEAR(e.paper, (1 / 1.01 + 1 / 0.01 + 4 / 16.01) / 3, 1e-6);
    EXPECT_NEAR(e.median_relative, 0.5, 1e-12);
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
