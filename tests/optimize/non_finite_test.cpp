// What is not finite is counted and left out, never reaches a texture, and ends a run where it is
// more than one in a thousand samples.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "burnish/checkpoint.h"
#include "burnish/error.h"
#include "core/constants.h"
#include "error_of.h"
#include "optimize/checkpoint_folder.h"
#include "optimize/estimators.h"
#include "optimize/loss.h"
#include "optimize/non_finite.h"
#include "optimize/small_problem.h"
#include "optimize/state.h"
#include "temporary_folder.h"

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
    const test::TemporaryFolder temporary;
    Options options;
    options.estimator = MonteCarlo{4, 1};
    options.evaluation_samples = 2, options.stop.iterations = 3;
    Problem problem = test::problem_of(test::small_scene_of(24));
    problem.loss = broken_loss(2, kNan);  // of 2304 samples of the image, and the derivative's
    EXPECT_EQ(solve(problem, options).iterations.size(), 3u);
    problem.loss = broken_loss(6, kNan);
    Checkpoints checkpoints;
    checkpoints.folder = temporary.path.string();
    const std::string error = test::error_of([&] { solve(problem, options, checkpoints); });
    EXPECT_NE(error.find("iteration 0: 6 of about "), std::string::npos) << error;
    const Checkpoint kept = load_checkpoint(checkpoints.folder);
    EXPECT_EQ(kept.run.iterations.size(), 1u);
}

constexpr std::array kRates{1e-6, 1e-4, 1e-2};

/// Spoils one of so many values, in turns with each value that is not finite; at least one of all
/// that it sees, the first.
struct Spoiler {
    double rate = 0;
    std::size_t seen = 0, spoiled = 0;

    void operator()(float& v) {
        if (static_cast<double>(spoiled) > rate * static_cast<double>(seen++)) return;
        constexpr std::array kValues{kNan, kInfinity, -kInfinity};
        v = kValues[spoiled++ % kValues.size()];
    }
};

TEST(NonFinite, LossesAreCountedAtAnyRate) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1))
        for (const double rate : kRates) {
            Problem problem = test::problem_of(test::small_scene_of(24));
            Spoiler spoil{rate};
            bool is_value_spoiled = false;
            std::vector<std::size_t> counts;  // of each call
            problem.loss = [&](const Image& image, std::size_t) {
                LossValue loss = evaluate_loss(Loss::kL2, image, make_image(24, 24, 3, 0.2f), {});
                const std::size_t before = spoil.spoiled;
                for (float& v : loss.adjoint.values) spoil(v);
                counts.push_back(spoil.spoiled - before);
                if (is_value_spoiled) loss.value = kNan;
                return loss;
            };
            Options options;
            options.estimator = estimator;
            Solver solver(problem, options);
            for (int i = 0; i < 3; ++i) {
                counts.clear();
                is_value_spoiled = i == 2;
                const Iteration iteration = solver.step();
                // With halves the first call is for the value of their mean alone.
                if (counts.size() == 3) counts.erase(counts.begin());
                EXPECT_EQ(iteration.rejected_image,
                          std::accumulate(counts.begin(), counts.end(), std::size_t{0}) +
                              (is_value_spoiled ? 1 : 0))
                    << name << ", rate " << rate;
            }
            EXPECT_GT(spoil.spoiled, 0u);
            EXPECT_TRUE(all_finite(solver.texture(0)) && all_finite(solver.texture(1))) << name;
        }
}

/// Spoils the weights that the next iteration reads: of reservoirs, and of a path cache's newest
/// records.
struct SpoiledWeights {
    std::size_t derivatives = 0;  ///< what the derivative counts

    SpoiledWeights(EstimatorState& state, double rate) {
        Spoiler spoil{rate};
        if (auto* own = std::get_if<ReservoirsState>(&state))
            for (HistorySample& s : own->history.samples) spoil(s.W);
        for (CacheHalf& half : kept_cache(state).halves) {
            if (half.passes.empty()) continue;
            for (TileRecords& tile : half.passes.back().tiles)
                for (RecordBlock& block : tile.blocks)
                    for (std::size_t k = 0; k < kLanes; ++k)
                        if (block.radiance_over_pdf[1][k] > 0) spoil(block.radiance_over_pdf[1][k]);
        }
        derivatives = spoil.spoiled;
    }
};

TEST(NonFinite, WeightsAreCountedAndLeftOut) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1))
        for (const double rate : kRates) {
            const Problem problem = test::problem_of(test::small_scene_of(24));
            Options options;
            options.estimator = estimator;
            Solver first(problem, options);
            for (int i = 0; i < 2; ++i) first.step();
            State state = first.state();
            const SpoiledWeights spoiled(state.values().views[0].estimator, rate);
            Solver solver(problem, options, state);
            EXPECT_EQ(solver.step().rejected_derivatives, spoiled.derivatives)
                << name << ", rate " << rate;
            EXPECT_TRUE(all_finite(solver.texture(0)) && all_finite(solver.texture(1))) << name;
            const auto* reservoirs = std::get_if<Reservoirs>(&estimator);
            const bool keeps =
                std::holds_alternative<PathCache>(estimator) || (reservoirs && reservoirs->reuse);
            EXPECT_TRUE(spoiled.derivatives > 0 || !keeps) << name;
        }
}

bool is_adaptive(const Estimator& estimator) {
    const auto* mc = std::get_if<MonteCarlo>(&estimator);
    const auto* reservoirs = std::get_if<Reservoirs>(&estimator);
    return (mc && mc->adaptive_sampling) || (reservoirs && reservoirs->adaptive_sampling);
}

/// Densities of the sky and its light: what is missing of the records is counted.
TEST(NonFinite, LightAndDensitiesAreCountedAndLeftOut) {
    Scene scene = test::small_scene_of(24);
    scene.shapes = {{"floor", test::make_quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), {0}, {}}};
    scene.emitters = {EnvironmentEmitter{share(make_image(256, 128, 3, 0.7f)), 1, {}}};
    const Problem whole = test::problem_of(scene);
    for (const auto& [name, estimator] : test::all_estimators(2, 1))
        for (const bool density : {false, true})
            for (const double rate : kRates) {
                Problem problem = whole;
                auto data = std::make_shared<RendererData>(whole.renderer.data());
                auto lights = std::make_shared<Lights>(*data->traced.lights);
                Spoiler spoil{rate};
                auto sky = std::make_shared<SkyTable>(*lights->environment->sky);
                for (auto& texel : sky->texels) {
                    spoil(density ? texel.density : texel.b);
                    texel.density = std::abs(texel.density);
                }
                lights->environment->sky = std::move(sky);
                data->traced.lights = lights;
                problem.renderer = Renderer(data);
                Options options;
                options.estimator = estimator;
                Solver clean(whole, options), solver(problem, options);
                const Iteration all = clean.step(), left = solver.step();
                // A path cache's records are those of its image.
                const std::size_t rejected = std::holds_alternative<PathCache>(estimator)
                                                 ? left.rejected_image
                                                 : left.rejected_derivatives;
                // Adaptive samples follow the image, which has fewer samples, too.
                EXPECT_TRUE(left.paths + rejected == all.paths || is_adaptive(estimator))
                    << name << ", rate " << rate;
                EXPECT_TRUE(rejected > 0 || rate < 1e-2) << name;
                EXPECT_TRUE(std::isfinite(left.loss)) << name;
                for (int i = 0; i < 2; ++i) solver.step();
                EXPECT_TRUE(all_finite(solver.texture(0)) && all_finite(solver.texture(1))) << name;
            }
}

/// Light that is lost after the last iteration.
TEST(NonFinite, EvaluationsAreCountedInTheSummary) {
    Scene scene = test::small_scene_of(24);
    scene.shapes = {{"floor", test::make_quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), {0}, {}}};
    scene.emitters = {EnvironmentEmitter{share(make_image(256, 128, 3, 0.7f)), 1, {}}};
    Problem problem = test::problem_of(scene);
    auto data = std::make_shared<RendererData>(problem.renderer.data());
    const auto lights = std::make_shared<Lights>(*data->traced.lights);
    data->traced.lights = lights;
    problem.renderer = Renderer(data);
    Options options;
    options.estimator = MonteCarlo{2, 1};
    options.evaluation_samples = 4, options.stop.iterations = 2;
    const Summary summary = solve(problem, options, [&](const Iteration& i) {
        EXPECT_EQ(i.rejected_image + i.rejected_derivatives, 0u);
        if (i.number + 1 < options.stop.iterations) return Continue;
        auto sky = std::make_shared<SkyTable>(*lights->environment->sky);
        for (auto& texel : sky->texels) texel.b = kNan;
        lights->environment->sky = std::move(sky);
        return Continue;
    });
    EXPECT_GT(summary.start.rejected, 100u);
    EXPECT_GT(summary.result.rejected, 100u);
    EXPECT_EQ(summary.counts.rejected_image, summary.start.rejected + summary.result.rejected);
    EXPECT_EQ(summary.counts.rejected_derivatives, 0u);
}

TEST(NonFinite, PicturesOfTooMuchLightAreRefused) {
    Scene lamp = test::small_scene_of(16);
    lamp.shapes.resize(1);
    lamp.emitters = {PointEmitter{{0, 0, 0.3f}, {1e38f, 1e38f, 1e38f}}};
    EXPECT_NE(test::error_of([&] {
                  make_renderer(lamp).render(16);
              }).find("samples were not finite, expected at most one in 1000: values of the scene"),
              std::string::npos);
    // Each sample is finite, their sum is not.
    Scene sky;
    sky.film = {8, 8, 0, 0, 8, 8, {FilterKind::kBox, 0.5f}};
    sky.emitters = {ConstantEmitter{{1e38f, 1e38f, 1e38f}}};
    EXPECT_NE(test::error_of([&] {
                  make_renderer(sky).render(16);
              }).find("the picture: 192 of 192 values are not finite, the first one (inf)"),
              std::string::npos);
}

TEST(NonFinite, GradientsAreCountedAtAnyRate) {
    for (const bool has_halves : {false, true})
        for (const double rate : kRates) {
            SplitGradient gradient;
            clear(gradient, 1024, 512, 3, has_halves);
            mark_dirty(gradient.dirty, 0, gradient.first.values.size());
            EXPECT_TRUE(is_usable(gradient));
            Spoiler spoil{rate};
            for (Image* half : {&gradient.first, &gradient.second})
                for (float& v : half->values) v = 0.5f, spoil(v);
            EXPECT_FALSE(is_usable(gradient));
            EXPECT_EQ(leave_out_unusable(gradient), spoil.spoiled) << rate;
            EXPECT_TRUE(is_usable(gradient));
            EXPECT_TRUE(all_finite(gradient.first) && all_finite(gradient.second));
        }
}

TEST(NonFinite, TexturesAreRefused) {
    Problem problem = test::problem_of(test::small_scene_of(24));
    Image texels = std::get<Image>(problem.unknowns[0].start);
    texels.values[3] = kNan, texels.values[5] = kInfinity;
    const std::string error = test::error_of([&] {
        problem.renderer.render(1, 0, {{problem.unknowns[0].name, texels}});
    });
    EXPECT_NE(error.find(": 2 of 48 values are not finite, the first one (nan) at pixel (1, 0)"),
              std::string::npos)
        << error;
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
