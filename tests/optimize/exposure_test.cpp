// Exposures that are fitted: the best ones, without the noise of images, part of the state.
#include "optimize/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "burnish/error.h"
#include "core/parallel.h"
#include "error_of.h"
#include "images.h"
#include "optimize/estimators.h"
#include "optimize/loss.h"
#include "optimize/view_loss.h"
#include "optimize/view_problem.h"

namespace burnish {
namespace {

constexpr Loss kAllLosses[] = {Loss::kRelMse, Loss::kReweighted, Loss::kL2, Loss::kL1};

/// A picture, a render of it, and weights with zeros.
struct Exposed {
    Image image = test::random_image(9, 7, 3, 0.05f, 1.5f, 1), picture = image, mask;

    Exposed() : mask(test::random_image(9, 7, 3, -0.3f, 1, 2)) {
        test::RandomSource random{3};
        for (std::size_t i = 0; i < picture.values.size(); ++i)
            picture.values[i] *=
                std::array<float, 3>{0.8f, 1.7f, 2.5f}[i % 3] * random.next(0.7f, 1.3f);
        for (float& w : mask.values) w = std::max(w, 0.0f);
    }
    ExposureFactors fit(bool by_channel, Loss loss) const {
        return fit_exposure({by_channel}, loss, {image, image}, {picture, mask}, {1, 1, 1});
    }
    double loss_at(Loss loss, const ExposureFactors& e) const {
        return loss_value(loss, exposed(e, image), picture, mask);
    }
};

TEST(Exposure, MaskedPixelsMayHoldAnything) {
    const Exposed c;
    Exposed holes;
    for (std::size_t i = 0; i < holes.picture.values.size(); ++i)
        if (holes.mask.values[i] == 0)
            holes.picture.values[i] = std::numeric_limits<float>::quiet_NaN();
    for (const Loss loss : kAllLosses)
        for (const bool by_channel : {false, true})
            EXPECT_EQ(holes.fit(by_channel, loss), c.fit(by_channel, loss));
}

TEST(Exposure, IsThatOfTheLeastLoss) {
    const Exposed c;
    for (const Loss loss : kAllLosses)
        for (const bool by_channel : {false, true}) {
            const ExposureFactors best = c.fit(by_channel, loss);
            const double min = c.loss_at(loss, best);
            if (!by_channel) {
                EXPECT_EQ(best[0], best[1]);
                EXPECT_EQ(best[0], best[2]);
            }
            for (const float by : {0.97f, 0.999f, 1.001f, 1.03f}) {
                const ExposureFactors all{best[0] * by, best[1] * by, best[2] * by};
                EXPECT_GE(c.loss_at(loss, all), min);
                for (std::size_t k = 0; by_channel && k < 3; ++k) {
                    ExposureFactors other = best;
                    other[k] *= by;
                    EXPECT_GE(c.loss_at(loss, other), min) << k;
                }
            }
        }
    EXPECT_LT(c.loss_at(Loss::kL2, c.fit(true, Loss::kL2)),
              c.loss_at(Loss::kL2, c.fit(false, Loss::kL2)));
}

/// The adjoint at the fitted exposure is the derivative of the loss at the exposure that is fitted
/// anew for every image.
TEST(Exposure, TheAdjointIsTheSlopeOfTheFittedLoss) {
    const Exposed c;
    for (const Loss loss : {Loss::kRelMse, Loss::kL2})
        for (const bool by_channel : {false, true}) {
            const ExposureFactors e = c.fit(by_channel, loss);
            const Image adjoint =
                exposed(e, evaluate_loss(loss, exposed(e, c.image), c.picture, c.mask).adjoint);
            Image direction = test::random_image(9, 7, 3, 0, 1, 4);
            double slope = 0;
            for (std::size_t i = 0; i < direction.values.size(); ++i) {
                direction.values[i] *= adjoint.values[i] < 0 ? -1.0f : 1.0f;
                slope += double{adjoint.values[i]} * double{direction.values[i]};
            }
            const auto fitted_loss = [&](float by) {
                Exposed moved = c;
                for (std::size_t i = 0; i < direction.values.size(); ++i)
                    moved.image.values[i] += by * direction.values[i];
                return moved.loss_at(loss, moved.fit(by_channel, loss));
            };
            constexpr float kStep = 0.003f;
            EXPECT_NEAR((fitted_loss(kStep) - fitted_loss(-kStep)) / (2 * double{kStep}), slope,
                        2e-3 * slope);
        }
}

/// Half of the light in noise: the square of one noisy image would be too large by a quarter.
TEST(Exposure, NoiseOfTheImageDoesNotMoveIt) {
    const Image image = test::random_image(200, 200, 3, 0.2f, 1, 5);
    Image picture = image, a = image, b = image;
    test::RandomSource random{6};
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        picture.values[i] *= 1.5f;
        a.values[i] *= random.next() < 0.5f ? 0.5f : 1.5f;
        b.values[i] *= random.next() < 0.5f ? 0.5f : 1.5f;
    }
    for (const Loss loss : {Loss::kRelMse, Loss::kL2}) {
        const auto fit = [&](const Image& x, const Image& y) {
            return fit_exposure({}, loss, {x, y}, {picture, {}}, {1, 1, 1})[0];
        };
        EXPECT_NEAR(fit(a, b), 1.5f, 0.01f);
        EXPECT_LT(fit(a, a), 1.25f) << "the seeded defect";
    }
}

/// A setup whose only view is a noisy picture about one and a half times as bright as an image, in
/// blue three times; and that image with half of its light in noise, twice.
struct NoisyHalves {
    Setup setup = make_setup(test::problem_of(test::small_scene_of(64)), {});
    Image image = test::random_image(64, 64, 3, 0.1f, 1, 5), a = image, b = image;

    explicit NoisyHalves(const FitExposure& how) {
        View& view = setup.problem.views[0];
        view.exposure = how;
        view.image = image;
        test::RandomSource random{6};
        for (std::size_t i = 0; i < image.values.size(); ++i) {
            view.image.values[i] *= (i % 3 == 2 ? 2.0f : 1.0f) * random.next(0.75f, 2.25f);
            a.values[i] *= random.next() < 0.5f ? 0.5f : 1.5f;
            b.values[i] *= random.next() < 0.5f ? 0.5f : 1.5f;
        }
    }
};

/// The slope of the loss of reweighted pixels in the exposure, of one channel or of all, over the
/// sum of its pixels' sizes.
double exposure_slope(const NoisyHalves& n, const ExposureFactors& e,
                      std::optional<std::size_t> channel = {}) {
    const std::vector<Image> images{n.a, n.b};
    std::vector<Image> adjoints{loss_of(n.setup, 0, e, n.a).adjoint,
                                loss_of(n.setup, 0, e, n.b).adjoint};
    reweigh(n.setup, 0, e, images, adjoints);
    double sum = 0, size = 0;
    for (std::size_t h = 0; h < 2; ++h)
        for (std::size_t i = 0; i < n.image.values.size(); ++i) {
            if (channel && i % 3 != *channel) continue;
            const double d = double{adjoints[h].values[i]} * double{images[1 - h].values[i]};
            sum += d, size += std::abs(d);
        }
    return std::abs(sum / size);
}

/// The seeded defect is the exposure of the least loss, whose weights know nothing of the image.
TEST(Exposure, OfReweightedPixelsIsWhereTheirGradientDoesNotChange) {
    for (const bool by_channel : {false, true}) {
        const NoisyHalves n({by_channel});
        for (const float last : {0.01f, 1.0f, 100.0f}) {
            const ExposureFactors e = stepped_exposure_of(n.setup, 0, n.a, n.b, {last, last, last});
            EXPECT_LT(exposure_slope(n, e), 1e-3) << last;
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_EQ(exposure_slope(n, e, c) < 1e-3, by_channel) << last << " " << c;
            if (by_channel) {
                EXPECT_NEAR(e[1], 1.5f, 0.3f) << last;
            }
        }
        const ExposureFactors of_loss = exposure_of(n.setup, 0, n.a, n.b);
        EXPECT_GT(exposure_slope(n, of_loss), 1e-2);
        NoisyHalves dark({by_channel});
        dark.a = dark.b = make_image(64, 64, 3);
        EXPECT_EQ(stepped_exposure_of(dark.setup, 0, dark.a, dark.b, {2, 3, 4}),
                  (ExposureFactors{2, 3, 4}));
    }
}

/// A picture so noisy that the loss and the gradient ask for different exposures, and an image with
/// hardly any noise.
TEST(Exposure, IsFittedUnderTheWeightsThatStepTheTextures) {
    Problem problem = test::problem_of(test::small_scene_of(24));
    View& view = problem.views[0];
    view.exposure = FitExposure{};
    test::RandomSource random{7};
    for (float& v : view.image.values) v *= random.next(0.1f, 1.9f);
    Options options;
    options.estimator = MonteCarlo{.image_samples = 2048, .samples = 1};
    options.background_samples = 2048;
    Solver solver(problem, options);
    solver.step();
    const Image image = solver.image(0);
    const ImageHalves halves{image, image};
    const WeightedPicture picture{view.image, view.mask};
    const float stepped = fit_reweighted_exposure({}, halves, picture, {1, 1, 1})[0],
                of_loss = fit_exposure({}, Loss::kReweighted, halves, picture, {1, 1, 1})[0];
    EXPECT_NEAR(solver.exposure(0)[0] / stepped, 1, 0.01);
    EXPECT_GT(std::abs(of_loss / stepped - 1), 0.1f);
}

TEST(Exposure, StaysWhereThereIsNoLight) {
    const Image dark = make_image(4, 4, 3), gray = make_image(4, 4, 3, 0.5f);
    const Image no_weight = make_image(4, 4, 1);
    const ExposureFactors last{2, 3, 4};
    for (const Loss loss : kAllLosses)
        for (const bool by_channel : {false, true}) {
            const auto fit = [&](const Image& image, const Image& picture, const Image& mask) {
                return fit_exposure({by_channel}, loss, {image, image}, {picture, mask}, last);
            };
            EXPECT_EQ(fit(dark, gray, {}), last);
            EXPECT_EQ(fit(gray, dark, {}), last);
            EXPECT_EQ(fit(gray, gray, no_weight), last);
        }
}

/// Three views of the small scene with exposures 1 (known), 0.6 and 1.7; the last one held out.
Problem exposed_problem(int side = 16) {
    Problem problem = test::problem_with_views(side);
    problem.views[2].exposure = ExposureFactors{1, 1, 1};
    const ExposureFactors factors[] = {
        {1, 1, 1}, {0.6f, 0.6f, 0.6f}, {1.7f, 1.5f, 1.2f}, {2, 2, 2}};
    for (std::size_t i = 0; i < problem.views.size(); ++i) {
        View& v = problem.views[i];
        v.image = exposed(factors[i], problem.renderer.with_lighting(v.lighting)
                                          .with_camera(v.camera)
                                          .render(256, 17 + static_cast<std::uint32_t>(i)));
        if (i > 0) v.exposure = FitExposure{i == 2};
    }
    return problem;
}

TEST(Exposure, IsRecoveredWithTheTextures) {
    MonteCarlo mc;
    mc.image_samples = 16, mc.samples = 8;
    for (const Estimator& estimator : {Estimator{PathCache{}}, Estimator{mc}}) {
        Problem problem = exposed_problem(24);
        problem.unknowns[0].start = 0.5f, problem.unknowns[1].start = 0.5f;
        for (Unknown& u : problem.unknowns) u.learning_rate = 0.01;
        Options options;
        options.estimator = estimator;
        options.background_samples = 64;
        options.stop.iterations = 400;
        options.evaluation_samples = 256;
        const Summary summary = solve(problem, options);
        const std::vector<ViewEvaluation>& views = summary.result.views;
        EXPECT_EQ(views[0].exposure, (ExposureFactors{1, 1, 1}));
        EXPECT_NEAR(views[1].exposure[1], 0.6, 0.6 * 0.03);
        EXPECT_NEAR(views[2].exposure[0], 1.7, 1.7 * 0.03);
        EXPECT_NEAR(views[2].exposure[2], 1.2, 1.2 * 0.03);
        EXPECT_NEAR(views[3].exposure[0], 2, 2 * 0.03) << "held out";
        ASSERT_EQ(summary.start.views.size(), 4u);
        EXPECT_GT(std::abs(summary.start.views[1].exposure[0] - 0.6f), 0.03f) << "was not known";
    }
}

TEST(Exposure, OfTheTruthIsFoundByEvaluation) {
    const Problem problem = exposed_problem();
    const Evaluation e = Solver(problem, {}).evaluate(256);
    EXPECT_NEAR(e.views[1].exposure[0], 0.6, 0.006);
    EXPECT_NEAR(e.views[2].exposure[1], 1.5, 0.015);
    EXPECT_NEAR(e.views[3].exposure[2], 2, 0.02);
    for (const ViewEvaluation& v : e.views) EXPECT_LT(v.loss, 2 * v.noise_floor + 1e-3);
}

TEST(Exposure, IsPartOfTheState) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options;
        options.estimator = estimator;
        options.background_samples = 6;
        Solver solver(exposed_problem(), options);
        for (int i = 0; i < 4; ++i) solver.step();
        Solver again(exposed_problem(), options, load_state(save_state(solver.state())));
        for (int i = 0; i < 4; ++i) solver.step(), again.step();
        EXPECT_TRUE(again.state() == solver.state()) << name;
        EXPECT_EQ(again.exposure(2), solver.exposure(2)) << name;
        EXPECT_NE(solver.exposure(2), (ExposureFactors{1, 1, 1})) << name;
        EXPECT_EQ(solver.exposure(0), (ExposureFactors{1, 1, 1})) << name;
        EXPECT_EQ(solver.exposure(3), (ExposureFactors{1, 1, 1})) << "held out";
    }
}

/// Whatever it was in the run that the state is of; `mc` and reservoirs have one image here.
TEST(Exposure, ThatIsKnownIsTheProblemsWhereARunGoesOn) {
    Options options;
    options.loss = Loss::kRelMse;
    options.background_samples = 6;
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        options.estimator = estimator;
        Problem problem = test::problem_with_views();
        Solver solver(problem, options);
        solver.step();
        problem.views[2].exposure = ExposureFactors{3, 2, 1};
        Solver again(problem, options, solver.state());
        for (int i = 0; i < 4; ++i) again.step();
        EXPECT_EQ(again.exposure(2), (ExposureFactors{3, 2, 1})) << name;
    }
}

TEST(Exposure, AStateWithoutItsExposureIsRefused) {
    Problem known = exposed_problem();
    for (View& v : known.views) v.exposure = ExposureFactors{1, 1, 1};
    Options options;
    options.loss = Loss::kRelMse;  // which needs no halves otherwise
    Solver solver(known, options);
    solver.step();
    EXPECT_THROW(Solver(exposed_problem(), options, solver.state()), InputError);
}

TEST(Exposure, AnyNumberOfThreadsGivesTheSameBytes) {
    std::string first;
    for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        Problem problem = exposed_problem();
        for (Unknown& u : problem.unknowns) u.start = SearchStart{};
        Solver solver(problem, {});
        for (int i = 0; i < 4; ++i) solver.step();
        const std::string bytes = save_state(solver.state());
        if (first.empty()) first = bytes;
        EXPECT_EQ(bytes, first) << threads;
    }
}

TEST(Exposure, CannotBeFittedUnderALossOfYourOwn) {
    Problem problem = exposed_problem();
    problem.loss = [](const Image& image, std::size_t) { return LossValue{0, image}; };
    EXPECT_EQ(test::error_of([&] { Solver(problem, {}); }),
              "side: the exposure is to be fitted, but a loss of your own does not say how: "
              "expected a number");
}

}  // namespace
}  // namespace burnish
