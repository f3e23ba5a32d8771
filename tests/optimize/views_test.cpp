// Several views: their order, their gradients, what they share and keep.
#include "optimize/views.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include "burnish/error.h"
#include "core/parallel.h"
#include "core/transform.h"
#include "error_of.h"
#include "optimize/batch.h"
#include "optimize/estimators.h"
#include "optimize/iterate.h"
#include "optimize/loss.h"
#include "optimize/memory.h"
#include "optimize/step_gradient.h"
#include "optimize/view_problem.h"

namespace burnish {
namespace {

using test::problem_with_views;

Setup setup_of_views(std::size_t count, std::uint32_t batch) {
    Problem problem = test::problem_of(test::small_scene_of(8));
    problem.views.resize(count, problem.views[0]);
    Options options;
    options.batch = batch;
    return make_setup(problem, options);
}

TEST(Views, EachEpochVisitsEachOnceInAnOrderOfItsOwn) {
    const burnish::Setup setup = setup_of_views(12, 4);
    std::set<std::vector<std::size_t>> orders;
    for (std::uint32_t epoch = 0; epoch < 5; ++epoch) {
        std::vector<std::size_t> order;
        for (std::uint32_t k = 0; k < 3; ++k)
            for (const std::size_t view : batch_of(setup, 3 * epoch + k)) order.push_back(view);
        orders.insert(order);
        std::sort(order.begin(), order.end());
        for (std::size_t v = 0; v < order.size(); ++v) EXPECT_EQ(order[v], v);
    }
    EXPECT_EQ(orders.size(), 5u);
    EXPECT_EQ(batch_of(setup_of_views(12, Options{}.batch), 0).size(), 1u);
    EXPECT_EQ(batch_of(setup_of_views(3, 7), 0).size(), 3u);
}

TEST(Views, AnotherSeedVisitsThemInAnotherOrder) {
    const auto order_of = [](std::uint32_t batch, std::uint32_t seed) {
        burnish::Setup setup = setup_of_views(12, batch);
        setup.options.seed = seed;
        std::vector<std::vector<std::size_t>> order;
        for (std::uint32_t i = 0; i < 12; ++i) order.push_back(batch_of(setup, i));
        return order;
    };
    for (const std::uint32_t batch : {1u, 4u, 5u}) {
        EXPECT_EQ(order_of(batch, 1), order_of(batch, 1));
        EXPECT_NE(order_of(batch, 1), order_of(batch, 2)) << batch;
    }
}

TEST(Views, ABatchThatDividesThemTakesOneOfEachRun) {
    const burnish::Setup setup = setup_of_views(12, 4);
    for (std::uint32_t i = 0; i < 30; ++i) {
        const std::vector<std::size_t> batch = batch_of(setup, i);
        for (std::size_t k = 0; k < batch.size(); ++k) EXPECT_EQ(batch[k] / 3, k);
    }
    const burnish::Setup odd = setup_of_views(7, 3);
    std::vector<std::size_t> visits(7);
    for (std::uint32_t i = 0; i < 7; ++i)
        for (const std::size_t view : batch_of(odd, i)) ++visits[view];
    EXPECT_EQ(visits, std::vector<std::size_t>(7, 3)) << "three epochs";
}

/// The options with a seed for which iteration 1 visits a view twice: the last one of an epoch and
/// the first one of the next.
Options with_a_view_twice(const Problem& problem, const Estimator& estimator) {
    Options options;
    options.estimator = estimator, options.batch = 2, options.background_samples = 4;
    for (;; ++options.seed) {
        const std::vector<std::size_t> batch = batch_of(make_setup(problem, options), 1);
        if (batch[0] == batch[1]) return options;
    }
}

/// Stops within iteration `number` after more and more chunks of work, until it is done; each time
/// it must be undone.
void expect_undone(const burnish::Setup& setup, std::uint32_t number, const std::string& name) {
    State::Values state = make_state(setup);
    Workspace workspace = make_workspace(setup, state);
    for (std::uint32_t i = 0; i < number; ++i) iterate(setup, state, workspace);
    const State::Values before = state;
    State::Values whole = state;
    Workspace fresh = make_workspace(setup, whole);
    iterate(setup, whole, fresh);
    for (long last = 0;; last += 9) {
        std::atomic<long> asked = 0;
        try {
            iterate(setup, state, workspace, [&] { return ++asked > last; });
            break;
        } catch (const Stopped&) {
            ASSERT_TRUE(state == before) << name << " after " << last;
        }
    }
    EXPECT_TRUE(state == whole) << name;
}

TEST(Views, AnIterationThatIsStoppedIsUndoneWhereItVisitsAViewTwice) {
    const Problem problem = problem_with_views();
    for (const auto& [name, estimator] : test::all_estimators(2, 1))
        expect_undone(make_setup(problem, with_a_view_twice(problem, estimator)), 1, name);
    // With passes that both visits drop.
    PathCache cache;
    cache.samples = 2, cache.window = 3;
    const Options options = with_a_view_twice(problem, cache);
    const burnish::Setup setup = make_setup(problem, options);
    for (std::uint32_t number = 7; number < 40; ++number)
        if (const auto batch = batch_of(setup, number); batch[0] == batch[1])
            return expect_undone(setup, number, "with a full window");
    FAIL() << "no iteration visits a view twice";
}

TEST(Views, AnIterationWhoseLossThrowsLeavesNothingBehind) {
    const Problem problem = problem_with_views();
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options;
        options.estimator = estimator, options.batch = 3, options.background_samples = 4;
        int calls = 0, broken = 0;
        Problem own = problem;
        own.loss = [&](const Image& image, std::size_t) {
            if (++calls == broken) throw std::runtime_error("the loss is broken");
            LossValue loss{0, image};
            for (const float v : image.values) loss.value += 0.5 * double{v} * double{v};
            return loss;
        };
        const burnish::Setup setup = make_setup(own, options);
        State::Values state = make_state(setup), whole = make_state(setup);
        Workspace workspace = make_workspace(setup, state), fresh = make_workspace(setup, whole);
        iterate(setup, whole, fresh);
        const int in_iteration = calls;
        for (broken = 1; broken <= in_iteration; ++broken) {
            calls = 0;
            EXPECT_THROW(iterate(setup, state, workspace), std::runtime_error) << name;
            ASSERT_TRUE(state == make_state(setup)) << name;
        }
        calls = in_iteration + 1;
        iterate(setup, state, workspace);
        EXPECT_TRUE(state == whole) << name;
    }
}

/// The gradients of views alone, with the seeds that they have in the problem: their mean is that
/// of the problem.
TEST(Views, TheGradientIsTheMeanOverTheViews) {
    Problem problem = problem_with_views();
    for (Unknown& u : problem.unknowns) u.learning_rate = 0;  // that of the options: nothing moves
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options = test::gradient_options(estimator);
        options.seed = 5;
        options.batch = 3;
        const auto after_three = [&](const Problem& p, const Options& o) {
            Solver solver(p, o);
            for (int i = 0; i < 3; ++i) solver.step();
            return test::gradient_of(solver);
        };
        const std::vector<Image> together = after_three(problem, options);
        std::vector<Image> mean;
        for (std::size_t view = 0; view < 3; ++view) {
            Problem alone = problem;
            alone.views = {problem.views[view]};
            Options own = options;
            own.seed = seed_of_view(options.seed, view);
            const std::vector<Image> gradient = after_three(alone, own);
            if (mean.empty()) mean = gradient;
            for (std::size_t i = 0; i < mean.size(); ++i)
                for (std::size_t k = 0; k < mean[i].values.size(); ++k)
                    mean[i].values[k] =
                        (view == 0 ? 0 : mean[i].values[k]) + gradient[i].values[k] / 3;
        }
        for (std::size_t i = 0; i < mean.size(); ++i) {
            float largest = 0;
            for (const float v : mean[i].values) largest = std::max(largest, std::abs(v));
            ASSERT_GT(largest, 0) << name;
            for (std::size_t k = 0; k < mean[i].values.size(); ++k)
                EXPECT_NEAR(together[i].values[k], mean[i].values[k], 1e-5f * largest) << name;
        }
    }
}

/// With L2: the loss of e I against e G is e^2 times that of I against G, and so is its gradient.
TEST(Views, TheGradientIsThatOfTheExposedLoss) {
    Problem problem = test::problem_of(test::small_scene_of(16));
    for (Unknown& u : problem.unknowns) u.learning_rate = 0;  // that of the options: nothing moves
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options = test::gradient_options(estimator);
        options.loss = Loss::kL2;
        const auto gradient = [&](float exposure) {
            Problem exposed = problem;
            exposed.views[0].exposure = ExposureFactors{exposure, exposure, exposure};
            for (float& v : exposed.views[0].image.values) v *= exposure;
            Solver solver(exposed, options);
            const Iteration i = solver.step();
            return std::pair(test::gradient_of(solver), i.loss);
        };
        const auto [plain, loss] = gradient(1);
        const auto [quadruple, exposed_loss] = gradient(2);  // a power of two: exact
        EXPECT_EQ(exposed_loss, 4 * loss) << name;
        for (std::size_t i = 0; i < plain.size(); ++i)
            for (std::size_t k = 0; k < plain[i].values.size(); ++k)
                ASSERT_EQ(quadruple[i].values[k], 4 * plain[i].values[k]) << name;
    }
}

TEST(Views, AStateGoesOnToTheSameBytes) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1))
        for (const std::uint32_t batch : {1u, 2u, 3u}) {
            Options options;
            options.estimator = estimator;
            options.batch = batch;
            options.background_samples = 4;
            Solver solver(problem_with_views(), options);
            for (int i = 0; i < 3; ++i) solver.step();
            const std::string bytes = save_state(solver.state());
            Solver again(problem_with_views(), options, load_state(bytes));
            for (int i = 0; i < 3; ++i) solver.step(), again.step();
            EXPECT_TRUE(again.state() == solver.state()) << name;
            EXPECT_EQ(again.image(2), solver.image(2)) << name;
            EXPECT_EQ(solver.image(3).width, 0) << "held out";
        }
}

TEST(Views, AnyNumberOfThreadsGivesTheSameBytes) {
    Options options;
    options.batch = 2;
    std::string first;
    for (const int threads : {1, 2, 3, 5}) {
        const ThreadLimit limit(threads);
        Solver solver(problem_with_views(), options);
        for (int i = 0; i < 4; ++i) solver.step();
        const std::string bytes = save_state(solver.state());
        if (first.empty()) first = bytes;
        EXPECT_EQ(bytes, first) << threads;
    }
}

std::size_t kept_passes(const Solver& solver) {
    std::size_t passes = 0;
    const State state = solver.state();
    for (const ViewState& view : state.values().views)
        for (const CacheHalf& half : std::get<PathCacheState>(view.estimator).halves)
            passes += half.passes.size();
    return passes;
}

std::size_t bytes_per_pass(const Problem& problem, const PathCache& cache) {
    const burnish::Setup setup = make_setup(problem, {});
    std::vector<TracedScene> views;
    for (const std::size_t v : setup.fitted) views.push_back(scene_of(setup, v));
    const Theta theta = initial_theta(setup);
    return max_bytes_per_pass(plan_caches(cache, views, reaching_pixels(views, theta), theta));
}

TEST(Views, ShareTheMemoryOfThePathCache) {
    const Problem problem = problem_with_views();
    PathCache cache{.samples = 4, .window = 6};
    const auto passes_with = [&](std::size_t bytes) {
        Options options;
        options.estimator = cache;
        std::get<PathCache>(options.estimator).max_bytes = bytes;
        options.batch = 3;
        Solver solver(problem, options);
        for (int i = 0; i < 4; ++i) solver.step();
        EXPECT_GT(solver.texture(0).width, 0);
        return kept_passes(solver);
    };
    const std::size_t pass = bytes_per_pass(problem, cache);
    EXPECT_EQ(passes_with(0), 3u * 2 * 6);
    EXPECT_LT(passes_with(3 * 2 * 3 * pass), 3u * 2 * 6);
    EXPECT_GE(passes_with(3 * 2 * 3 * pass), 3u * 2 * 3);
    EXPECT_EQ(passes_with(3 * 2 * pass - 1), 0u) << "nothing is kept";
    EXPECT_THROW(passes_with(2 * pass - 1), ResourceError);
    cache.samples = 1;
    EXPECT_EQ(passes_with(3 * 2 * pass - 1), 0u) << "a pass in each half all the same";
}

/// Under a limit that leaves no room for them, and where an iteration is given up.
TEST(Views, RecordsOfAStateThatCannotBeKeptAreLeftOut) {
    Problem problem = problem_with_views();
    int calls = 0, broken = 0;
    problem.loss = [&](const Image& image, std::size_t view) {
        if (++calls == broken) throw std::runtime_error("the loss is broken");
        return evaluate_loss(Loss::kL2, image, problem.views[view].image, {});
    };
    PathCache cache{.samples = 4, .window = 6};
    Options options;
    options.estimator = cache, options.batch = 3;
    Solver whole(problem, options);
    whole.step();
    const State with_records = whole.state();
    ASSERT_GT(kept_passes(whole), 0u);
    cache.max_bytes = 3 * 2 * bytes_per_pass(problem, cache) - 1;
    options.estimator = cache;
    Solver solver(problem, options, with_records), same(problem, options, with_records);
    const State before = solver.state();
    EXPECT_EQ(kept_passes(solver), 0u);
    broken = std::exchange(calls, 0);  // in the last visit
    EXPECT_THROW(solver.step(), std::runtime_error);
    EXPECT_TRUE(solver.state() == before);
    broken = 0;
    solver.step(), same.step();
    EXPECT_TRUE(solver.state() == same.state());
}

TEST(Views, AreEvaluatedEachOnItsOwn) {
    const Problem problem = problem_with_views();
    const Evaluation all = Solver(problem, {}).evaluate(64);
    ASSERT_EQ(all.views.size(), 4u);
    double mean = 0;
    for (std::size_t v = 0; v < 3; ++v) mean += all.views[v].loss / 3;
    EXPECT_NEAR(all.loss, mean, 1e-12) << "the one that is held out counts for nothing";
    EXPECT_EQ(all.views[2].image.width, 20);
    Image exposed = all.views[2].image;
    for (std::size_t k = 0; k < exposed.values.size(); ++k)
        exposed.values[k] *= all.views[2].exposure[k % 3];
    EXPECT_DOUBLE_EQ(all.views[2].loss,
                     loss_value(Loss::kRelMse, exposed, problem.views[2].image, {}));
}

TEST(Views, ARenderWithoutSamplesOrWithFarTooManyIsRefused) {
    const Renderer renderer = make_renderer(test::scene_with_ids(16));
    for (const std::uint32_t samples : {0u, (1u << 20) + 1})
        EXPECT_THROW(renderer.render(samples), InputError) << samples;
}

TEST(Views, ACameraOfTheSensorsNumbersSeesTheSame) {
    Scene scene = test::scene_with_ids(16);
    const Renderer renderer = make_renderer(scene);
    Camera camera;
    camera.width = camera.height = 16;
    const double focal = 8 / std::tan(scene.camera.fov_x * std::numbers::pi / 360);
    camera.focal_x = camera.focal_y = focal, camera.center_x = camera.center_y = 8;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t c = 0; c < 4; ++c)  // Mitsuba's x points left, y up
            camera.camera_to_world[4 * row + c] =
                (c < 2 ? -1 : 1) *
                scene.camera.to_world(static_cast<int>(row), static_cast<int>(c));
    const Image expected = renderer.render(16), image = renderer.with_camera(camera).render(16);
    double difference = 0, sum = 0;
    for (std::size_t k = 0; k < image.values.size(); ++k) {
        difference += std::abs(double{image.values[k]} - double{expected.values[k]});
        sum += double{expected.values[k]};
    }
    EXPECT_LT(difference, 1e-3 * sum);  // rays differ by rounding
    EXPECT_GT(sum, 0);
}

/// What projects points onto the film takes its sides to be perpendicular.
TEST(Views, AMatrixThatIsNearARotationBecomesOne) {
    const Renderer renderer = make_renderer(test::scene_with_ids(16));
    const auto axes_of = [&](const Camera& camera) {
        return renderer.with_camera(camera).data().traced.camera.bent.axes;
    };
    const Matrix turned = (translation({0, 0, 3}) * rotation({1, 2, 3}, 200)).m;
    Camera camera = test::above();
    camera.camera_to_world = turned;
    const auto exact = axes_of(camera);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t row = 0; row < 3; ++row)
            EXPECT_EQ(exact[i][static_cast<int>(row)], turned[4 * row + i]) << "as it is";
    for (std::size_t row = 0; row < 3; ++row)
        camera.camera_to_world[4 * row + 1] += 0.0009 * turned[4 * row];
    const auto axes = axes_of(camera);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            EXPECT_NEAR(dot(axes[i], axes[j]), i == j ? 1 : 0, 1e-12) << i << j;
}

/// Of a lens that turns back within the picture, pixels that see nothing count nothing, whatever
/// the target shows there.
TEST(Views, WhatALensDoesNotSeeIsLeftOut) {
    Problem problem = problem_with_views();
    View view = problem.views[2];
    view.mask = make_image(20, 14, 3, 0.5f);
    auto& camera = std::get<Camera>(view.camera);
    camera.focal_x = camera.focal_y = 9;
    camera.lens = {LensKind::kBrownConrady, {-0.3}};
    problem.views = {view};
    const Renderer renderer = make_views(problem)[0];
    View masked = view;
    const double share = mask_blind_pixels(renderer, masked);
    EXPECT_GT(share, 0.1);
    EXPECT_LT(share, 0.9);
    EXPECT_EQ(masked.mask.at(0, 0, 0), 0);
    EXPECT_EQ(masked.mask.at(9, 7, 1), 0.5f);
    const auto zeros = std::count(masked.mask.values.begin(), masked.mask.values.end(), 0.0f);
    EXPECT_NEAR(static_cast<double>(zeros) / (20 * 14 * 3), share, 1e-12);
    EXPECT_EQ(mask_blind_pixels(renderer, masked), share);

    Options options;
    options.stop.iterations = 2, options.evaluation_samples = 4;
    const Summary plain = solve(problem, options);
    for (std::size_t k = 0; k < masked.mask.values.size(); ++k)
        if (masked.mask.values[k] == 0) problem.views[0].image.values[k] = 1000;
    const Summary changed = solve(problem, options);
    EXPECT_EQ(plain.result.loss, changed.result.loss);
    EXPECT_EQ(plain.textures[0].values, changed.textures[0].values);
    std::get<Camera>(problem.views[0].camera).center_x = -1000;
    EXPECT_NE(
        test::error_of([&] { make_views(problem); }).find("no part of the picture lies in the"),
        std::string::npos);
}

TEST(Views, CamerasWhoseRaysOverflowAreRefused) {
    const Renderer renderer = make_renderer(test::scene_with_ids(16));
    const auto message = [&](const Camera& camera) {
        return test::error_of([&] { static_cast<void>(renderer.with_camera(camera)); });
    };
    Camera wide = test::above(), aside = test::above();
    wide.focal_x = wide.focal_y = 1e-20;
    aside.center_y = 1e30;
    EXPECT_EQ(message(test::above()), "");
    Camera large = test::above();
    large.width = 16384, large.height = 8193;
    EXPECT_NE(message(large).find("16384 x 8193 pixels: expected at most 134217728 in all"),
              std::string::npos);
    for (const Camera& camera : {wide, aside})
        EXPECT_NE(message(camera).find("the camera sees more than 1e5 times as far to a side"),
                  std::string::npos)
            << message(camera);
}

TEST(Views, LightsThatAreOffAreNotThere) {
    const Scene scene = test::scene_with_ids(16);
    Scene without = scene;
    without.emitters = {scene.emitters[1], scene.emitters[2]};
    without.shapes[1].emitter = {};
    without.shapes[2].emitter = {0};
    const Renderer all = make_renderer(scene);
    const Lighting some{std::vector<std::string>{"sky", "ball"}, {}};
    EXPECT_EQ(all.with_lighting(some).render(8), make_renderer(without).render(8));
    EXPECT_NE(all.with_lighting(some).render(8), all.render(8));
    const Image dark = all.with_lighting({std::vector<std::string>{}, {}}).render(2);
    EXPECT_EQ(dark, make_image(16, 16, 3));
}

TEST(Views, UnderOneSkyShareWhatIsPrepared) {
    const Image texels = make_image(8, 4, 3, 0.5f);
    const Matrix turn{0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1};
    Problem problem = problem_with_views();
    problem.views.resize(4, problem.views[0]);
    problem.views[0].lighting = {{}, Environment{share(texels), {}, {}}};
    problem.views[1].lighting = {{}, Environment{share(texels), 2.0, turn}};  // the same values
    problem.views[2].lighting = {{}, Environment{share(make_image(8, 4, 3, 0.6f)), {}, turn}};
    problem.views[3].lighting = {{}, Environment{problem.views[2].lighting.environment->image}};
    const std::vector<Renderer> views = make_views(problem);
    const auto sky = [&](std::size_t v) { return views[v].data().traced.lights->environment->sky; };
    EXPECT_EQ(sky(1), sky(0));
    EXPECT_EQ(sky(3), sky(2));
    EXPECT_NE(sky(2), sky(0));
    for (std::size_t v = 0; v < 4; ++v) {
        const Renderer alone = problem.renderer.with_lighting(problem.views[v].lighting);
        EXPECT_NE(alone.data().traced.lights->environment->sky, sky(v));
        EXPECT_EQ(alone.with_camera(problem.views[v].camera).render(4), views[v].render(4)) << v;
    }
}

/// The problem's renderer has no sky: its lights are others.
TEST(Views, UnderTheScenesSkyTurnedShareWhatIsPrepared) {
    const Matrix turn{0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1};
    Scene scene = test::scene_with_ids(16);
    scene.emitters[2] = EnvironmentEmitter{share(make_image(8, 4, 3, 0.5f)), 1, {}};
    Problem problem{.renderer =
                        make_renderer(scene).with_lighting({std::vector<std::string>{}, {}})};
    problem.views.resize(2);
    problem.views[0].lighting.environment = Environment{{}, 2.0, {}};
    problem.views[1].lighting.environment = Environment{{}, {}, turn};
    const std::vector<Renderer> views = make_views(problem);
    const auto sky = [&](std::size_t v) { return views[v].data().traced.lights->environment->sky; };
    EXPECT_FALSE(problem.renderer.data().traced.lights->environment);
    EXPECT_EQ(sky(1), sky(0));
}

TEST(Views, AnEnvironmentReplacesTheScenes) {
    Scene scene = test::scene_with_ids(16);
    EnvironmentEmitter map;
    Image texels = make_image(8, 4, 3, 0.5f);
    for (int x = 0; x < 8; ++x) texels.at(x, 1, 0) = static_cast<float>(x);
    texels.at(3, 2, 2) = -0.01f;  // a colour outside of the gamut
    map.image = share(texels);
    Scene mapped = scene;
    mapped.emitters[2] = map;
    const Image expected = make_renderer(mapped).render(8);
    const Renderer all = make_renderer(scene);
    EXPECT_EQ(all.with_lighting({{}, Environment{map.image, {}, {}}}).render(8), expected);
    const Renderer of_mapped = make_renderer(mapped);
    const Image turned =
        of_mapped
            .with_lighting(
                {{}, Environment{{}, {}, Matrix{0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1}}})
            .render(8);
    EXPECT_NE(turned, expected);
    EXPECT_EQ(of_mapped.with_lighting({{}, Environment{{}, 1.0, kIdentityMatrix}}).render(8),
              expected);
    EXPECT_NE(test::error_of([&] {
                  all.with_lighting({{}, Environment{{}, 2.0, {}}});
              }).find("no environment map"),
              std::string::npos);
    for (const auto& [value, words] : {std::pair{-1.0f, "texels of negative luminance"},
                                       std::pair{std::nanf(""), "not finite"}}) {
        Image spoiled = texels;
        spoiled.at(3, 2, 1) = value;
        EXPECT_NE(test::error_of([&] {
                      all.with_lighting({{}, Environment{share(spoiled), {}, {}}});
                  }).find(words),
                  std::string::npos)
            << words;
    }
    for (const auto& [wrong, words] : {std::pair{-1e-9, "the environment's scale is -1e-09:"},
                                       std::pair{1e39, "the environment's scale is 1e+39:"},
                                       std::pair{std::nan(""), "the environment's scale is nan:"}})
        EXPECT_NE(test::error_of([&, scale = wrong] {
                      of_mapped.with_lighting({{}, Environment{{}, scale, {}}});
                  }).find(words),
                  std::string::npos)
            << words;
}

TEST(Views, HaveNumbersOfTheirOwn) {
    std::set<std::uint32_t> seeds;
    for (std::uint32_t seed = 0; seed < 20; ++seed)
        for (std::size_t view = 0; view < 50; ++view) seeds.insert(seed_of_view(seed, view));
    EXPECT_EQ(seeds.size(), 1000u);
    EXPECT_EQ(seed_of_view(7, 0), 7u);
}

TEST(Views, ThatDoNotFitAreNamed) {
    const auto refused = [](const std::string& part, const std::function<void(Problem&)>& change) {
        Problem problem = problem_with_views();
        change(problem);
        const std::string message = test::error_of([&] { Solver(problem, {}); });
        EXPECT_NE(message.find(part), std::string::npos) << message;
    };
    refused("side: there is no sensor 'left'",
            [](Problem& p) { p.views[1].camera = Sensor{"left"}; });
    refused("expected front, side or a number from 0 to 1",
            [](Problem& p) { p.views[1].camera = Sensor{"2"}; });
    refused("side: there is no emitter 'sun'",
            [](Problem& p) { p.views[1].lighting.emitters->push_back("sun"); });
    refused("above: the target image has 16 x 16",
            [](Problem& p) { p.views[2].image = make_image(16, 16, 3); });
    refused("above: the exposure is 0", [](Problem& p) {
        p.views[2].exposure = ExposureFactors{1, 0, 1};
    });
    refused("above: camera_to_world",
            [](Problem& p) { std::get<Camera>(p.views[2].camera).camera_to_world[0] = 2; });
    refused("above: the camera's focal lengths are -1e-09 and 24 pixels",
            [](Problem& p) { std::get<Camera>(p.views[2].camera).focal_x = -1e-9; });
    refused("above: the mask holds -1e-09", [](Problem& p) {
        p.views[2].mask = make_image(20, 14, 1, 1), p.views[2].mask.values[5] = -1e-9f;
    });
    refused("no pixel counts", [](Problem& p) {
        for (View& v : p.views) v.mask = make_image(v.image.width, v.image.height, 1, 0);
    });
    refused("no pixel counts", [](Problem& p) {
        p.views = {p.views[2]};
        auto& camera = std::get<Camera>(p.views[0].camera);
        camera.focal_x = camera.focal_y = 2;
        camera.lens.kind = LensKind::kFisheye;
        p.views[0].mask = make_image(20, 14, 1, 0);
        p.views[0].mask.at(0, 0, 0) = 1;  // behind the camera
    });
    refused("no view to fit", [](Problem& p) {
        for (View& v : p.views) v.held_out = true;
    });
}

TEST(Views, WithoutACameraHaveThatOfTheRenderer) {
    const Renderer seen = make_renderer(test::scene_with_ids(16)).with_camera(Sensor{"side", 8, 8});
    Problem problem{.renderer = seen};
    problem.views.resize(3);
    problem.views[1].camera = Sensor{"front"};
    problem.views[1].lighting.emitters = problem.views[2].lighting.emitters = {"sky"};
    const std::vector<Renderer> views = make_views(problem);
    EXPECT_EQ(views[0].render(2), seen.render(2));
    EXPECT_EQ(views[1].width(), 16);
    EXPECT_EQ(views[2].render(2), seen.with_lighting(problem.views[2].lighting).render(2));
    EXPECT_EQ(views[2].width(), 8);
}

TEST(Views, SensorsAreFoundByTheirNumber) {
    const Renderer renderer = make_renderer(test::scene_with_ids(16));
    EXPECT_EQ(renderer.with_camera(Sensor{"1"}).render(2),
              renderer.with_camera(Sensor{"side"}).render(2));
    EXPECT_EQ(renderer.with_camera(Sensor{}).render(2), renderer.render(2));
    EXPECT_NE(renderer.with_camera(Sensor{"1"}).render(2), renderer.render(2));
}

TEST(Views, SensorsHaveBothSidesOfAPictureOrNone) {
    const Renderer renderer = make_renderer(test::scene_with_ids(16));
    for (const Sensor& sensor : {Sensor{"1", 16, 0}, Sensor{"1", 0, 16}, Sensor{"1", -16, -16}})
        EXPECT_THROW(renderer.with_camera(sensor), InputError) << sensor.width;
}

}  // namespace
}  // namespace burnish
