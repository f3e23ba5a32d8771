// What is not finite is counted and left out, never reaches a texture, and ends a run where it is
// more than one in a thousand samples.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "burnish/checkpoint.h"
#include "burnish/error.h"
#include "core/constants.h"
#include "optimize/estimators.h"
#include "optimize/loss.h"
#include "optimize/small_problem.h"

namespace burnish {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

bool all_finite(const Image& image) {
    return std::all_of(image.values.begin(), image.values.end(),
                       [](float v) { return std::isfinite(v) && v >= 0 && v <= 1; });
}

/// A loss whose derivative is not finite in so many values.
LossFunction broken_loss(std::size_t values, float value) {
    return [=](const Image& image, std::size_t) {
        LossValue loss = evaluate_loss(Loss::kL2, image, make_image(24, 24, 3, 0.2f), {});
        for (std::size_t i = 0; i < values; ++i) loss.adjoint.values[37 * i] = value;
        return loss;
    };
}

TEST(NonFinite, AdjointsAreCountedAndLeftOut) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1))
        for (const float value : {kNan, kInfinity, -kInfinity}) {
            Problem problem = test::problem_of(test::small_scene_of(24));
            problem.loss = broken_loss(3, value);
            Options options;
            options.estimator = estimator;
            Solver solver(problem, options);
            const bool has_halves = std::holds_alternative<PathCache>(estimator);
            for (int i = 0; i < 5; ++i) {
                const Iteration iteration = solver.step();
                EXPECT_EQ(iteration.rejected_image, has_halves ? 6u : 3u) << name;
                EXPECT_EQ(iteration.rejected_derivatives, 0u) << name;
                for (std::size_t u = 0; u < problem.unknowns.size(); ++u)
                    EXPECT_TRUE(all_finite(solver.texture(u))) << name;
            }
        }
}

/// Finite factors whose product is not.
TEST(NonFinite, GradientsThatOverflowAreCountedAndLeftOut) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Problem problem = test::problem_of(test::small_scene_of(24));
        problem.loss = [](const Image& image, std::size_t) {
            LossValue loss;
            loss.adjoint = make_image(image.width, image.height, 3, 3e38f);
            return loss;
        };
        Options options;
        options.estimator = estimator;
        Solver solver(problem, options);
        std::size_t rejected = 0;
        for (int i = 0; i < 5; ++i) rejected += solver.step().rejected_derivatives;
        EXPECT_GT(rejected, 0u) << name;
        for (std::size_t u = 0; u < problem.unknowns.size(); ++u)
            EXPECT_TRUE(all_finite(solver.texture(u))) << name;
    }
}

TEST(NonFinite, MoreThanOneInAThousandEndsTheRunWithACheckpoint) {
    std::string folder = (std::filesystem::temp_directory_path() / "burnish-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    Options options;
    options.estimator = MonteCarlo{4, 1};
    options.evaluation_samples = 2, options.stop.iterations = 3;
    Problem problem = test::problem_of(test::small_scene_of(24));
    problem.loss = broken_loss(2, kNan);  // of 2304 samples of the image, and the derivative's
    EXPECT_EQ(solve(problem, options).iterations.size(), 3u);
    problem.loss = broken_loss(6, kNan);
    Checkpoints checkpoints;
    checkpoints.folder = folder;
    std::string error;
    try {
        solve(problem, options, checkpoints);
    } catch (const InputError& e) {
        error = e.what();
    }
    EXPECT_NE(error.find("iteration 0: 6 of about "), std::string::npos) << error;
    const Checkpoint kept = load_checkpoint(folder);
    EXPECT_EQ(kept.run.iterations.size(), 1u);
    std::filesystem::remove_all(folder);
}

TEST(NonFinite, LightsAreCountedAndLeftOut) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1))
        for (const float value : {kNan, kInfinity}) {
            Scene scene = test::small_scene_of(24);
            auto& light = std::get<AreaEmitter>(scene.emitters[1]);
            light.radiance.y = value;
            Problem problem = test::problem_of(scene);
            Options options;
            options.estimator = estimator;
            Solver solver(problem, options);
            std::size_t rejected = 0;
            for (int i = 0; i < 3; ++i) {
                const Iteration iteration = solver.step();
                rejected += iteration.rejected_image + iteration.rejected_derivatives;
                EXPECT_TRUE(std::isfinite(iteration.loss)) << name;
                for (std::size_t u = 0; u < problem.unknowns.size(); ++u)
                    EXPECT_TRUE(all_finite(solver.texture(u))) << name;
            }
            EXPECT_GT(rejected, 0u) << name;
            options.evaluation_samples = 2, options.stop.iterations = 1;
            EXPECT_THROW(solve(problem, options), InputError) << name;
        }
}

TEST(NonFinite, PicturesAndMasksAreRefused) {
    const auto refused = [](auto&& spoil) {
        Problem problem = test::problem_of(test::small_scene_of(24));
        problem.views[0].mask = make_image(24, 24, 1, 1);
        spoil(problem);
        EXPECT_THROW(Solver(problem, Options{}), InputError);
    };
    for (const float value : {kNan, kInfinity, -kInfinity}) {
        refused([=](Problem& p) { p.views[0].image.values[7] = value; });
        refused([=](Problem& p) { p.views[0].mask.values[7] = value; });
        // Where the mask leaves it out, it does not matter.
        Problem masked = test::problem_of(test::small_scene_of(24));
        masked.views[0].mask = make_image(24, 24, 1, 1);
        masked.views[0].mask.values[2] = 0;
        const Image whole = [&] {
            Solver solver(masked, Options{});
            solver.step();
            return solver.texture(0);
        }();
        masked.views[0].image.values[7] = value;
        Solver solver(masked, Options{});
        EXPECT_TRUE(std::isfinite(solver.step().loss));
        EXPECT_EQ(solver.texture(0), whole);
        refused([=](Problem& p) { std::get<Image>(p.unknowns[0].start).values[3] = value; });
    }
}

}  // namespace
}  // namespace burnish
