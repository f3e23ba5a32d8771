// Known answers for every number that iterations and summaries report.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "image/quality.h"
#include "ledger_entries.h"
#include "optimize/estimators.h"
#include "optimize/evaluation.h"
#include "optimize/floor_scene.h"
#include "optimize/loss.h"
#include "optimize/small_problem.h"
#include "optimize/step_gradient.h"
#include "optimize/summary.h"
#include "student.h"

namespace burnish {
namespace {

/// The small scene behind the camera's back: every pixel is the sky, without noise.
Problem sky_problem() {
    Scene scene = test::make_small_scene({.filter = FilterKind::kBox, .filter_radius = 0.5f});
    scene.camera.to_world = look_at({0, 0, 5}, {0, 0, 10}, {0, 1, 0});
    return test::problem_of(scene);
}

std::vector<Options> an_option_of_each() {
    std::vector<Options> all(3);
    all[1].estimator = Reservoirs{}, all[2].estimator = MonteCarlo{};
    for (Options& o : all) o.loss = Loss::kL2, o.evaluation_samples = 5;
    return all;
}

/// A matt floor of a colour that is a little wrong, beside its picture: few samples say what many
/// do. Their noise would count decibels.
TEST(Summary, PsnrIsWithoutTheNoiseOfTheRender) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].constant = 0.8f;
    const Scene scene =
        test::floor_scene(floor, {test::bitmap_of(8, 3, [](int, int, int) { return 0.5f; })});
    const Problem problem = test::searched_problem(scene, 0.45f);
    const Solver solver(problem, {});
    const Evaluation few = solver.evaluate(4), many = solver.evaluate(1024);
    const double psnr_of_many = many.views[0].psnr;
    EXPECT_NEAR(few.views[0].psnr, psnr_of_many, 0.3);
    const Image &picture = problem.views[0].image, &noisy = few.views[0].image;
    EXPECT_LT(psnr_without_noise(noisy, noisy, picture, white_of(picture)), psnr_of_many - 1);
}

/// Of a grey picture two channels say what all three do, whatever the third one holds.
TEST(Summary, PsnrIsOfTheChannelsThatCount) {
    Principled floor;
    floor.base_color.texture = {0};
    const Scene scene =
        test::floor_scene(floor, {test::bitmap_of(8, 3, [](int, int, int) { return 0.5f; })});
    Problem problem = test::searched_problem(scene, 0.45f);
    const double psnr_of_all = Solver(problem, {}).evaluate(16).views[0].psnr;
    View& view = problem.views[0];
    view.mask = make_image(48, 48, 3, 1);
    for (std::size_t i = 0; i < view.mask.values.size(); i += 3)
        view.mask.values[i] = 0, view.image.values[i] = 9;
    EXPECT_NEAR(Solver(problem, {}).evaluate(16).views[0].psnr, psnr_of_all, 0.1);
}

TEST(Summary, OfAnImageWithoutNoiseIsKnown) {
    const double loss = (2 * 0.1 * 0.1 + 0.2 * 0.2) / 3;  // the sky (0.3, 0.3, 0.4) against 0.2
    for (Options options : an_option_of_each()) {
        options.stop.iterations = 3;
        const Problem problem = sky_problem();
        std::vector<std::uint32_t> seen;
        const Summary summary = solve(problem, options, [&](const Iteration& i) {
            seen.push_back(i.number);
            return Continue;
        });
        EXPECT_EQ(seen, (std::vector<std::uint32_t>{0, 1, 2}));
        EXPECT_EQ(summary.ending, Ending::kIterations);
        EXPECT_NEAR(summary.start.loss, loss, 1e-7);
        EXPECT_NEAR(summary.start.noise_floor, 0, 1e-12);
        EXPECT_NEAR(summary.result.loss, loss, 1e-7);
        EXPECT_NEAR(summary.result.noise_floor, 0, 1e-12);
        EXPECT_EQ(summary.result.samples_per_pixel, 4u) << "an even number";
        for (std::size_t i = 0; i < summary.result.views[0].image.values.size(); ++i)
            EXPECT_NEAR(summary.result.views[0].image.values[i], i % 3 == 2 ? 0.4f : 0.3f, 1e-6f);
        double before = 0;
        for (const Iteration& i : summary.iterations) {
            EXPECT_NEAR(i.loss, loss, 1e-7);
            EXPECT_FALSE(i.held_out_loss.has_value());
            EXPECT_EQ(i.paths + i.derivatives + i.texels + i.reservoirs, 0u);
            EXPECT_EQ(i.rejected_image + i.rejected_derivatives, 0u);
            EXPECT_GE(i.seconds - before,
                      0.999 * (i.image_seconds + i.derivative_seconds + i.step_seconds));
            before = i.seconds;
        }
        EXPECT_EQ(summary.seconds, before);
        for (std::size_t u = 0; u < 2; ++u) {
            const RecoveredTexture& t = summary.textures[u];
            EXPECT_EQ(t.name, problem.unknowns[u].name);
            EXPECT_EQ(t.values, std::get<Image>(problem.unknowns[u].start)) << "nothing moved";
            EXPECT_EQ(t.coverage, make_image(t.values.width, t.values.height, 1));
            const bool split = has_split_gradient(options.estimator);
            EXPECT_EQ(t.confidence, split ? t.coverage : Image{}) << "nothing is known";
        }
    }
}

TEST(Summary, OfALongRunKeepsSomeIterationsAndCountsAll) {
    Summary summary;
    std::size_t largest = 0;
    for (std::uint32_t n = 0; n < 100000; ++n) {
        add_iteration({.number = 7 + n, .paths = 3, .derivatives = 2, .rejected_image = n % 2},
                      summary);
        largest = std::max(largest, summary.iterations.capacity());
        ASSERT_EQ(summary.counts.iterations, n + 1);
        if (n < 16384) {
            ASSERT_EQ(summary.iterations.size(), n + 1);
        }
    }
    EXPECT_LE(largest, 16384u);
    EXPECT_EQ(summary.iterations.size(), 100000u / 8);
    for (std::uint32_t k = 0; k < summary.iterations.size(); ++k)
        ASSERT_EQ(summary.iterations[k].number, 7 + 8 * k);
    EXPECT_EQ(summary.counts.paths, 300000u);
    EXPECT_EQ(summary.counts.derivatives, 200000u);
    EXPECT_EQ(summary.counts.rejected_image, 50000u);
    EXPECT_EQ(summary.counts.rejected_derivatives, 0u);
}

/// They come after every 20 iterations: strides of 2 and 4 keep each, 8 every second, 16 every
/// fourth.
TEST(Summary, OfALongRunKeepsChecksOfPatience) {
    for (const auto& [iterations, apart] :
         {std::pair(40000u, 20u), std::pair(100000u, 40u), std::pair(200000u, 80u)}) {
        Summary summary;
        for (std::uint32_t n = 0; n < iterations; ++n) {
            Iteration i{.number = n};
            if ((n + 1) % 20 == 0) i.held_out_loss = 1.0;
            add_iteration(i, summary);
        }
        std::uint32_t checks = 0;
        for (const Iteration& i : summary.iterations) checks += i.held_out_loss.has_value();
        EXPECT_EQ(checks, iterations / apart);
    }
}

TEST(Summary, SaysWhatEndedTheRun) {
    const Problem problem = sky_problem();
    Options options = an_option_of_each()[2];
    EXPECT_EQ(solve(problem, options).counts.iterations, 200u) << "without any rule";

    options.stop.seconds = 1e-9;
    const Summary timed = solve(problem, options);
    EXPECT_EQ(timed.ending, Ending::kTime);
    EXPECT_EQ(timed.iterations.size(), 1u);

    options.stop = {};
    const Summary cancelled = solve(
        problem, options, [](const Iteration& i) { return i.number == 4 ? Cancel : Continue; });
    EXPECT_EQ(cancelled.ending, Ending::kCancelled);
    EXPECT_EQ(cancelled.iterations.size(), 5u);

    // The first check finds a lower loss than none; the second and the third find the same.
    options.stop.patience = 2, options.stop.iterations = 1000;
    const Summary patient = solve(problem, options);
    EXPECT_EQ(patient.ending, Ending::kPatience);
    ASSERT_EQ(patient.iterations.size(), 60u);
    for (const Iteration& i : patient.iterations) {
        EXPECT_EQ(i.held_out_loss.has_value(), (i.number + 1) % 20 == 0);
        EXPECT_NEAR(i.held_out_loss.value_or(0.02), 0.02, 1e-7);
    }
    const Summary again = solve(problem, options, patient.state);
    EXPECT_EQ(again.ending, Ending::kPatience);
    EXPECT_EQ(again.iterations.size(), 60u) << "patience counts from the state";
}

/// Of many views it renders some, spread evenly over those that are fitted.
TEST(Summary, PatienceChecksSomeOfManyViews) {
    Problem problem = sky_problem();
    problem.views.resize(33, problem.views.front());
    problem.views[0].held_out = true;
    std::vector<std::size_t> checked;
    problem.loss = [&](const Image& image, std::size_t view) {
        checked.push_back(view);
        return LossValue{static_cast<double>(view), make_image(image.width, image.height, 3)};
    };
    const auto setup = make_setup(problem, an_option_of_each()[0]);
    EXPECT_DOUBLE_EQ(check_loss(setup, initial_theta(setup)), 16);
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < 16; ++i) expected.push_back(1 + 2 * i);
    EXPECT_EQ(checked, expected);
}

/// Of checks that find 5, 6, 4, 6, 6 the third starts the count of those in a row anew.
TEST(Summary, ALowerLossBringsPatienceBack) {
    Problem problem = sky_problem();
    const std::array<double, 5> found{5, 6, 4, 6, 6};
    std::size_t checks = 0;
    int calls = 0;  // in an iteration: its own, then the one of a check
    problem.loss = [&](const Image& image, std::size_t) {
        const bool is_check = ++calls == 2 && checks < found.size();
        return LossValue{is_check ? found[checks++] : 1, make_image(image.width, image.height, 3)};
    };
    Options options = an_option_of_each()[2];
    options.stop.patience = 2, options.stop.iterations = 1000;
    const Summary summary = solve(problem, options, [&](const Iteration&) {
        calls = 0;
        return Continue;
    });
    EXPECT_EQ(summary.ending, Ending::kPatience);
    EXPECT_EQ(summary.counts.iterations, 100u);
}

/// What stops loops around a solver would leave an iteration half made.
TEST(Iteration, IsNotCutByAQuestionAroundIt) {
    const auto texture_after = [](const StopQuestion& stop) {
        Solver solver(test::problem_of(test::small_scene_of(16)), an_option_of_each()[2]);
        const Stoppable stoppable(stop);
        solver.step();
        return copy_of(solver.texture(0));
    };
    EXPECT_EQ(texture_after([] { return true; }), texture_after({}));
}

TEST(Iteration, SecondsOfASolverAreThoseOfItsSteps) {
    Options options = an_option_of_each()[2];
    options.stop.seconds = 1e6;
    Solver solver(sky_problem(), options);
    const double before = solver.step().seconds;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const Stopwatch watch;
    const double after = solver.step().seconds;
    EXPECT_LE(after - before, watch.total());
    EXPECT_GT(after, before);
}

/// In a callback, too, and from a state: there the iterations before it do not count.
TEST(Iteration, TheLastOneIsKnownWhereItIsTold) {
    Options options = an_option_of_each()[2];
    options.stop.iterations = 3;
    std::vector<bool> over;
    const Callback look = [&](const Iteration&, const Solver& solver) {
        over.push_back(solver.ending().has_value());
        return Continue;
    };
    const Summary first = solve(sky_problem(), options, look);
    solve(sky_problem(), options, first.state, look);
    EXPECT_EQ(over, (std::vector<bool>{false, false, true, false, false, true}));
}

/// An iteration whose check raises is done, and took its time.
TEST(Iteration, ItsSecondsCountWhereItsCheckRaises) {
    Problem problem = sky_problem();
    Options options = an_option_of_each()[2];
    options.stop.iterations = 19;
    const Summary before = solve(problem, options);
    int calls = 0;  // in an iteration: its own, then the one of a check
    problem.loss = [&](const Image& image, std::size_t) {
        if (++calls == 2) throw std::runtime_error("no loss");
        return LossValue{1, make_image(image.width, image.height, 3)};
    };
    options.stop = {.seconds = 1e-9, .patience = 1};
    Solver solver(problem, options, before.state);
    EXPECT_THROW(solver.step(), std::runtime_error);
    EXPECT_EQ(solver.iterations(), 20u);
    EXPECT_EQ(solver.ending(), Ending::kTime);
}

TEST(CallbackTest, IsAnyFunctionOfAnIterationAndNoneThatIsEmpty) {
    const Solver solver(sky_problem(), an_option_of_each()[2]);
    const auto told = [&](const Callback& callback) { return callback({}, solver); };
    const Callback counts = [n = 0](const Iteration&) mutable {
        return ++n > 1 ? Cancel : Continue;
    };
    EXPECT_EQ(told(counts), Continue);
    EXPECT_EQ(told(counts), Cancel);
    std::function<Control(const Iteration&, const Solver&)> looks =
        [](const Iteration&, const Solver& s) { return s.iterations() == 0 ? Cancel : Continue; };
    EXPECT_EQ(told(looks), Cancel);
    EXPECT_EQ(told([](const auto&...) { return Cancel; }), Cancel);
    std::function<Control(const Iteration&)> own = [](const Iteration&) { return Cancel; };
    EXPECT_EQ(told(own), Cancel);
    looks = nullptr, own = nullptr;
    EXPECT_FALSE(Callback(looks));
    EXPECT_FALSE(Callback(own));
}

/// A diffuse floor with a texture of nearest look-ups fills the view under a sky.
Scene floor_scene() {
    Scene scene = test::make_small_scene({.filter = FilterKind::kBox, .filter_radius = 0.5f});
    scene.camera.to_world = look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0});
    scene.textures.erase(scene.textures.begin());
    Diffuse diffuse;
    diffuse.reflectance.texture = {0};
    scene.bsdfs = {diffuse};
    scene.materials = {{"floor", {0}, {}}};
    scene.emitters = {scene.emitters.back()};
    scene.shapes.resize(1);
    scene.parameters = {{"floor", {0}}};
    return scene;
}

TEST(Iteration, CountsAreThoseOfTheSamples) {
    const Scene scene = floor_scene();
    constexpr std::size_t kCameraSamples = 2 * 16 * 16;
    for (const auto& [name, estimator] : test::all_estimators(2, 2)) {
        if (std::holds_alternative<PathCache>(estimator)) continue;
        Solver solver(test::problem_of(scene), test::gradient_options(estimator));
        const Iteration i = solver.step();
        // Samples by the BSDF all find the sky, those by the emitter where they go up.
        const bool uniform = name.find("uniform") != std::string::npos;
        EXPECT_TRUE(!uniform || i.paths > kCameraSamples) << name;
        EXPECT_TRUE(!uniform || i.paths < 2 * kCameraSamples) << name;
        EXPECT_EQ(i.derivatives, i.paths) << name << ": each reads one texel";
        const Image gradient = test::gradient_of(solver)[0];
        EXPECT_EQ(i.texels, static_cast<std::size_t>(std::count_if(gradient.values.begin(),
                                                                   gradient.values.end(),
                                                                   [](float g) { return g != 0; })))
            << name;
        const State state = solver.state();
        const auto* own = std::get_if<ReservoirsState>(&state.values().views[0].estimator);
        EXPECT_EQ(i.reservoirs, own ? own->history.samples.size() : 0) << name;
        const auto* reservoirs = std::get_if<Reservoirs>(&estimator);
        EXPECT_GE(i.reservoirs, reservoirs && reservoirs->reuse ? i.texels : 0) << name;
    }
}

TEST(Iteration, CountsOfAPathCacheAreItsRecords) {
    PathCache cache;
    cache.samples = 4, cache.window = 2;
    Solver solver(test::problem_of(floor_scene()), test::gradient_options(cache));
    for (std::size_t passes : {2u, 2u}) {  // of each half
        const Iteration i = solver.step();
        EXPECT_GT(i.paths, 2 * passes * 16 * 16);
        EXPECT_LT(i.paths, 2 * 2 * passes * 16 * 16);
        std::size_t records = 0;
        const State state = solver.state();
        for (const CacheHalf& half :
             std::get<PathCacheState>(state.values().views[0].estimator).halves) {
            EXPECT_EQ(half.passes.size(), passes);
            for (const CachedPass& pass : half.passes)
                for (const TileRecords& tile : pass.tiles) records += tile.count;
        }
        EXPECT_EQ(i.paths, records);
    }
}

TEST(Iteration, LossIsThatOfItsImage) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options = test::gradient_options(estimator);
        const Problem problem = test::problem_of(test::small_scene_of(16));
        Solver solver(problem, options);
        for (int i = 0; i < 3; ++i) {
            const Iteration iteration = solver.step();
            EXPECT_EQ(iteration.loss,
                      loss_value(Loss::kRelMse, solver.image(), problem.views[0].image, {}))
                << name;
        }
    }
}

/// No iteration takes the samples of another one: not for its image, not for its gradient.
TEST(Iteration, SamplesAreItsOwn) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options = test::gradient_options(estimator);
        options.background_samples = 1;  // the first iteration gathers all: it hides no repetition
        Problem problem = test::problem_of(floor_scene());
        for (Unknown& u : problem.unknowns) u.learning_rate = 0;  // that of the options: none moves
        Solver solver(problem, options);
        std::vector<Image> images, gradients;
        for (int i = 0; i < 4; ++i) {
            solver.step();
            images.push_back(solver.image());
            gradients.push_back(test::gradient_of(solver)[0]);
            for (int k = 0; k < i; ++k) {
                EXPECT_NE(images[static_cast<std::size_t>(k)], images.back()) << name;
                EXPECT_NE(gradients[static_cast<std::size_t>(k)], gradients.back()) << name;
            }
        }
    }
}

/// Coverage is the share of iterations in which a texel's gradient was other than zero.
TEST(Summary, CoverageCountsTheIterationsWithAGradient) {
    for (const Estimator& estimator :
         {Estimator{PathCache{}}, Estimator{MonteCarlo{1, 1, false}}}) {
        const Problem problem = test::problem_of(test::make_small_scene());
        Options options = test::gradient_options(estimator);
        options.stop.iterations = 5, options.evaluation_samples = 2;
        options.unvisited = Unvisited::kKeep;
        Solver solver(problem, options);
        std::vector<Image> counts;
        for (std::size_t u = 0; u < problem.unknowns.size(); ++u) {
            const Image& texels = solver.texture(u);
            counts.push_back(make_image(texels.width, texels.height, 1));
        }
        for (int i = 0; i < 5; ++i) {
            solver.step();
            const auto gradient = test::gradient_of(solver);
            for (std::size_t u = 0; u < counts.size(); ++u) {
                const auto channels = static_cast<std::size_t>(gradient[u].channels);
                for (std::size_t k = 0; k < counts[u].values.size(); ++k) {
                    const auto* g = &gradient[u].values[k * channels];
                    if (std::any_of(g, g + channels, [](float v) { return v != 0; }))
                        counts[u].values[k] += 1;
                }
            }
        }
        const Summary summary = solve(problem, options);
        for (std::size_t u = 0; u < counts.size(); ++u)
            for (std::size_t k = 0; k < counts[u].values.size(); ++k)
                EXPECT_EQ(summary.textures[u].coverage.values[k], counts[u].values[k] / 5);
    }
}

/// What it says of confidence, from the means of squares in the state.
TEST(Summary, ConfidenceIsTheGateOfTheGradient) {
    const Problem problem = test::problem_of(test::make_small_scene());
    Options options = test::gradient_options(PathCache{});
    options.adam.gate = true;
    options.stop.iterations = 4, options.evaluation_samples = 2;
    const Summary summary = solve(problem, options);
    std::size_t between = 0;
    for (std::size_t u = 0; u < 2; ++u) {
        const AdamState& adam = summary.state.values().pyramids[u].levels[0].adam;
        const Image& confidence = summary.textures[u].confidence;
        const std::size_t channels = adam.mean.size() / confidence.values.size();
        for (std::size_t k = 0; k < confidence.values.size(); ++k) {
            double min = 1;
            for (std::size_t i = k * channels; i < (k + 1) * channels; ++i)
                min = std::min(
                    min, adam.square[i] > 0
                             ? std::max(0.0, 1 - double{adam.noise[i]} / double{adam.square[i]})
                             : 0.0);
            EXPECT_NEAR(confidence.values[k], min, 1e-5);
            between += min > 0 && min < 1;
        }
    }
    EXPECT_GT(between, 10u);
}

/// The means over seeds of several numbers of a run.
template <std::size_t kCount, class Numbers>
std::array<test::MeanEstimate, kCount> means_of(const test::LedgerEntry& entry, std::uint32_t runs,
                                                std::uint32_t first, const Numbers& numbers) {
    std::vector<std::array<double, kCount>> values(test::scaled(entry, runs));
    parallel_for(values.size(), [&](std::size_t r) {
        values[r] = numbers(test::seed_of(entry, first + static_cast<std::uint32_t>(r)));
    });
    std::array<test::MeanEstimate, kCount> means;
    for (std::size_t k = 0; k < kCount; ++k) {
        test::RunningMean mean;
        for (const auto& v : values) mean.add(v[k]);
        means[k] = test::estimate_of(mean);
    }
    return means;
}

/// The loss at the start, and that of a result without its noise floor, are those of converged
/// images.
TEST(Summary, LossesHoldNoNoiseOnAverage) {
    const test::LedgerEntry& entry = test::ledger::kSummaryLosses;
    Problem problem = test::problem_of(test::make_small_scene());
    for (Unknown& u : problem.unknowns) u.learning_rate = 0;  // that of the options: nothing moves
    problem.views[0].image = problem.renderer.render(256, 1);
    for (float& v : problem.views[0].image.values) v *= 0.9f;
    const auto converged = [&](std::uint32_t seed) {
        const auto image = [&](std::uint32_t half) {
            return problem.renderer.render(128, 2 * seed + half);
        };
        return std::array{
            loss_of_halves(Loss::kRelMse, image(0), image(1), problem.views[0].image, {})};
    };
    const test::MeanEstimate truth = means_of<1>(entry, 40, 100000, converged)[0];
    // Evaluations follow from seed and textures alone, whatever the estimator.
    Options options = test::gradient_options(MonteCarlo{8, 1, false});
    options.stop.iterations = 1, options.evaluation_samples = 8;
    options.unvisited = Unvisited::kKeep;
    const auto numbers = [&](std::uint32_t seed) {
        Options own = options;
        own.seed = seed;
        const Summary s = solve(problem, own);
        return std::array{s.start.loss - s.start.noise_floor, s.result.loss - s.result.noise_floor,
                          s.iterations[0].loss, s.result.loss - 0.5 * s.result.noise_floor};
    };
    const auto means = means_of<4>(entry, 300, 0, numbers);
    const auto p = [&](std::size_t k) { return test::welch_p_value(means[k], truth); };
    EXPECT_TRUE(accepted(entry, "start without its noise floor", p(0)));
    EXPECT_TRUE(accepted(entry, "result without its noise floor", p(1)));
    EXPECT_TRUE(rejected(entry, "loss of a noisy image", p(2)));
    EXPECT_TRUE(rejected(entry, "half the noise floor", p(3)));
}

TEST(Evaluation, SamplesOfTheResultFollowFromTheWork) {
    EXPECT_EQ(result_samples(0, 64), 256u) << "the most";
    EXPECT_EQ(result_samples(0, 1e9), 2u) << "the least";
    EXPECT_EQ(result_samples(5 * 1e6, 1e6), 4u) << "four million of a short run";
    EXPECT_EQ(result_samples(400 * 2e6, 2e6), 80u) << "a fifth as many as iterations";
    EXPECT_EQ(result_samples(400 * 2e6, 8 * 2e6), 10u) << "one view an iteration of eight";
}

TEST(Evaluation, SamplesOfTheStartFallWithTheNumberOfViews) {
    EXPECT_EQ(start_samples(1, 1e7), 8u);
    EXPECT_EQ(start_samples(8, 1e7), 8u);
    EXPECT_EQ(start_samples(16, 1e7), 4u);
    EXPECT_EQ(start_samples(1000, 1e7), 2u);
}

TEST(Evaluation, SamplesOfTheStartGrowWhereAllPixelsAreFew) {
    EXPECT_EQ(start_samples(1, 64 * 64), 64u) << "the most";
    EXPECT_EQ(start_samples(17, 17 * 32 * 32), 60u) << "a million of all";
    EXPECT_EQ(start_samples(1, 256 * 256), 16u);
    EXPECT_EQ(start_samples(16, 512 * 512), 4u) << "as many as the views alone ask for";
}

TEST(Summary, TheStartOfSmallViewsTakesMoreSamples) {
    Options options = test::gradient_options(MonteCarlo{1, 1, false});
    options.stop.iterations = 1, options.evaluation_samples = 4;
    EXPECT_EQ(solve(sky_problem(), options).start.samples_per_pixel, 64u);
}

/// Where it is not known what noise adds to the loss, start and result hold the noise of equally
/// many samples: textures that stay as they are have nearly the same loss.
TEST(Evaluation, WhereNoiseIsNotKnownTheStartHasTheSamplesOfTheResult) {
    Problem problem = test::problem_of(test::make_small_scene());
    for (Unknown& u : problem.unknowns) u.learning_rate = 0;  // that of the options: nothing moves
    problem.views[0].image = problem.renderer.render(1024, 1);
    Options options = test::gradient_options(MonteCarlo{4, 1, false});
    options.stop.iterations = 1, options.unvisited = Unvisited::kKeep;
    const auto samples = [&] {
        const Summary s = solve(problem, options);
        return std::array{s.start.samples_per_pixel, s.result.samples_per_pixel};
    };
    EXPECT_EQ(samples(), (std::array{64u, 256u})) << "relMSE is compared without noise";
    problem.loss = [&](const Image& image, std::size_t) {
        return evaluate_loss(Loss::kL1, image, problem.views[0].image, {});
    };
    EXPECT_EQ(samples(), (std::array{256u, 256u})) << "a loss of one's own";
    problem.loss = {};
    options.loss = Loss::kL1;
    const Summary s = solve(problem, options);
    EXPECT_EQ(s.start.samples_per_pixel, 256u);
    EXPECT_GT(s.result.loss, s.start.loss / 1.5) << "256 samples have half the noise of 64";
    EXPECT_LT(s.result.loss, s.start.loss * 1.5);
    options.evaluation_samples = 32;
    EXPECT_EQ(samples(), (std::array{32u, 32u})) << "as many as are asked for";
}

}  // namespace
}  // namespace burnish
