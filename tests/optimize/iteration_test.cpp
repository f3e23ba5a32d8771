// Whole iterations through Solver::step: the gradient that the optimiser gets is the slope of the
// loss, for every estimator and every kind of unknown, background and history included.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "ledger_entries.h"
#include "optimize/exposure.h"
#include "optimize/step_gradient.h"
#include "optimize/strip_scene.h"
#include "optimize/view_loss.h"

namespace burnish {
namespace {

using test::Direction;

/// A problem along three iterations of given textures.
struct Script {
    Problem problem;
    std::vector<Theta> theta;  ///< of each iteration
};

/// A target near the image of the last textures: the noise of an image is large beside the
/// residual.
Script make_script(const Scene& scene) {
    Script script{{make_renderer(scene), {}, {}}, {}};
    test::RandomSource random{211};
    const Theta last = test::theta_of(scene);
    for (const float size : {0.06f, 0.06f, 0.0f}) {
        Theta theta = last;
        for (ThetaTexture& t : theta.textures)
            for (float& v : t.values.values) v += random.next(-size, size);
        script.theta.push_back(std::move(theta));
    }
    Image target = script.problem.renderer.render(256, 212);
    for (float& v : target.values) v *= random.next(0.6f, 0.9f);
    script.problem.views = {{std::move(target), {}}};
    for (std::size_t i = 0; i < last.textures.size(); ++i)
        script.problem.unknowns.push_back(
            {scene.parameters[i].name, script.theta[0].textures[i].values});
    return script;
}

/// After the script's last iteration.
Solver run(const Script& script, const Options& options, test::Tamper tamper = test::leave_alone) {
    Solver solver(script.problem, options);
    solver.step();
    for (std::size_t i = 1; i < script.theta.size(); ++i) {
        solver = test::with_textures(script.problem, options, solver, script.theta[i], tamper);
        solver.step();
    }
    return solver;
}

Direction zeros(const Theta& theta) {
    Direction direction;
    for (const ThetaTexture& t : theta.textures)
        direction.push_back(make_image(t.values.width, t.values.height, t.values.channels));
    return direction;
}

/// The gradient by an estimate with other seeds, each texture's at most 1.
Direction own_gradient(const Script& script) {
    MonteCarlo many;
    many.image_samples = 64, many.samples = 256, many.adaptive_sampling = false;
    Options options = test::gradient_options(many);
    options.seed = 213;
    Direction direction = test::gradient_of(run(script, options));
    for (Image& image : direction) {
        float largest = 0;
        for (const float v : image.values) largest = std::max(largest, std::abs(v));
        for (float& v : image.values) v /= largest;
    }
    return direction;
}

/// The gradient's own direction in one unknown after the other, and in all; random signs.
std::vector<Direction> make_directions(const Script& script) {
    const Direction own = own_gradient(script);
    std::vector<Direction> directions;
    for (std::size_t i = 0; i < own.size(); ++i) {
        directions.push_back(zeros(script.theta.back()));
        directions.back()[i] = own[i];
    }
    directions.push_back(own);
    test::RandomSource random{214};
    directions.push_back(zeros(script.theta.back()));
    for (Image& image : directions.back())
        for (float& v : image.values) v = random.next() < 0.5f ? -1.0f : 1.0f;
    return directions;
}

/// Means over runs after the script's last iteration.
struct RunMeans {
    std::vector<test::MeanEstimate> along;      ///< of the gradient, along each direction
    std::array<test::RunningMean, 3> exposure;  ///< by channel
};

RunMeans mean_of_runs(const Script& script, const Estimator& estimator,
                      const std::vector<Direction>& directions, const test::LedgerEntry& entry,
                      std::uint32_t runs, test::Tamper tamper = test::leave_alone,
                      Loss loss = Loss::kRelMse) {
    std::vector<std::vector<double>> values(test::scaled(entry, runs));
    std::vector<ExposureFactors> exposures(values.size());
    parallel_for(values.size(), [&](std::size_t r) {
        Options options = test::gradient_options(estimator);
        options.loss = loss;
        options.seed = test::seed_of(entry, static_cast<std::uint32_t>(r));
        const Solver solver = run(script, options, tamper);
        exposures[r] = solver.exposure();
        const std::vector<Image> gradient = test::gradient_of(solver);
        for (const Direction& d : directions) values[r].push_back(test::dot(d, gradient));
    });
    RunMeans result;
    std::vector<test::RunningMean> means(directions.size());
    for (const auto& one : values)
        for (std::size_t k = 0; k < one.size(); ++k) means[k].add(one[k]);
    for (const test::RunningMean& m : means) result.along.push_back(test::estimate_of(m));
    for (const ExposureFactors& e : exposures)
        for (std::size_t c = 0; c < 3; ++c) result.exposure[c].add(double{e[c]});
    return result;
}

/// The mean over runs of the gradient along each direction.
std::vector<test::MeanEstimate> mean_along(const Script& script, const Estimator& estimator,
                                           const std::vector<Direction>& directions,
                                           const test::LedgerEntry& entry, std::uint32_t runs,
                                           test::Tamper tamper = test::leave_alone) {
    return mean_of_runs(script, estimator, directions, entry, runs, tamper).along;
}

/// p-value of "both have the same expectation along every direction".
double p_value(const std::vector<test::MeanEstimate>& a, const std::vector<test::MeanEstimate>& b) {
    std::vector<double> p;
    for (std::size_t k = 0; k < a.size(); ++k) p.push_back(test::welch_p_value(a[k], b[k]));
    return test::holm_minimum(p);
}

struct Case {
    const char* name;
    Estimator estimator;
};

Reservoirs reservoirs(bool positivization, bool reuse, Shift shift, bool adaptive) {
    Reservoirs r;
    r.image_samples = 4, r.adaptive_sampling = adaptive;
    r.positivization = positivization, r.reuse = reuse, r.shift = shift;
    return r;
}

PathCache cache(Sequence sequence, std::uint32_t window) {
    PathCache c;
    c.samples = 2, c.window = window, c.sequence = sequence;
    return c;
}

template <class E>
E keeping_image(E estimator) {
    estimator.image_samples = 1, estimator.image_window = 2;
    return estimator;
}

std::vector<Case> cases() {
    const Shift replay = Shift::kReplay, identity = Shift::kIdentity;
    return {{"mc", MonteCarlo{4, 1, true}},
            {"ris", reservoirs(false, false, replay, false)},
            {"pris", reservoirs(true, false, replay, true)},
            {"gris, replay", reservoirs(false, true, replay, true)},
            {"gris, identity", reservoirs(false, true, identity, false)},
            {"pgris, replay", reservoirs(true, true, replay, false)},
            {"pgris, identity", reservoirs(true, true, identity, true)},
            {"mc, kept image", keeping_image(MonteCarlo{4, 1, false})},
            {"ris, kept image", keeping_image(reservoirs(false, false, replay, false))},
            {"pris, kept image", keeping_image(reservoirs(true, false, replay, true))},
            {"gris, kept image", keeping_image(reservoirs(false, true, replay, true))},
            {"pgris, replay, kept image", keeping_image(reservoirs(true, true, replay, false))},
            {"pgris, kept image", keeping_image(reservoirs(true, true, identity, false))},
            {"path cache, sobol", cache(Sequence::kSobol, 2)},
            {"path cache, independent", cache(Sequence::kIndependent, 32)}};
}

TEST(Iteration, GradientIsTheSlopeOfTheLoss) {
    const test::LedgerEntry& entry = test::ledger::kIterations;
    const Script script = make_script(test::make_strip_scene(20, 3));
    const std::vector<Direction> directions = make_directions(script);
    const auto truth =
        test::slopes(script.problem, script.theta.back(), directions,
                     {.replicas = test::scaled(entry, 24u), .seed = test::seed_of(entry, 500000)});
    for (const auto& [name, estimator] : cases()) {
        auto means = mean_along(script, estimator, directions, entry, 400);
        EXPECT_TRUE(accepted(entry, name, p_value(means, truth)));
        for (test::MeanEstimate& m : means) m = test::scaled_by(m, 1.1);
        EXPECT_TRUE(rejected(entry, "gradient 10 % larger", p_value(means, truth)));
    }
}

/// The mean of images whose noise is small beside that of a mean of runs.
Image converged_image(const Script& script) {
    constexpr std::uint32_t kSamples = 1 << 15;
    return script.problem.renderer.render(
        kSamples, 890,
        test::moved(script.problem, script.theta.back(), zeros(script.theta.back()), 0));
}

/// Each estimator in the ways it comes by two images.
TEST(Iteration, GradientOfReweightedPixelsIsZeroAtTheTarget) {
    const test::LedgerEntry& entry = test::ledger::kReweighted;
    Script script = make_script(test::make_strip_scene(20, 3));
    const std::vector<Direction> directions = make_directions(script);
    const Image target = converged_image(script);
    script.problem.views[0].image = target;
    const std::vector<test::MeanEstimate> zero(directions.size(), {0, 0});
    int count = 0;
    for (const auto& [name, estimator] : cases()) {
        const std::set<std::string> some{"mc", "pgris, kept image", "path cache, sobol",
                                         "path cache, independent"};
        if (some.count(name) == 0) continue;
        ++count;
        const RunMeans means = mean_of_runs(script, estimator, directions, entry, 400,
                                            test::leave_alone, Loss::kReweighted);
        EXPECT_TRUE(accepted(entry, name, p_value(means.along, zero)));
    }
    EXPECT_EQ(count, entry.comparisons);
    script.problem.loss = [&](const Image& image, std::size_t) {
        LossValue loss = evaluate_loss(Loss::kReweighted, image, target, {});
        for (std::size_t i = 0; i < target.values.size(); ++i) {
            const float j = image.values[i], g = std::abs(target.values[i]);
            if (j > g) loss.adjoint.values[i] *= (g * g + 0.01f) / (j * j + 0.01f);
        }
        return loss;
    };
    EXPECT_TRUE(rejected(
        entry, "weights of the same samples",
        p_value(mean_along(script, MonteCarlo{4, 1, true}, directions, entry, 400), zero)));
}

/// That of converged images.
ExposureFactors converged_exposure(const Script& script, const FitExposure& how) {
    constexpr std::uint32_t kSamples = 4096, kPairs = 4;
    const View& view = script.problem.views[0];
    const TextureValues theta =
        test::moved(script.problem, script.theta.back(), zeros(script.theta.back()), 0);
    std::array<double, 3> sum{};
    for (std::uint32_t i = 0; i < kPairs; ++i) {
        const auto render = [&](std::uint32_t seed) {
            return script.problem.renderer.render(kSamples, seed, theta);
        };
        const Image a = render(900 + 2 * i), b = render(901 + 2 * i);
        const auto e = fit_exposure(how, Loss::kRelMse, {a, b}, {view.image, view.mask}, {1, 1, 1});
        for (std::size_t c = 0; c < 3; ++c) sum[c] += double{e[c]} / kPairs;
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

/// p-value of "runs find the exposure that converged images have", which is known within 0.05 %.
/// factor: a seeded defect, of what runs find. An exposure is a ratio whose denominator has noise:
/// its mean lies above the ratio of means by one to two of its relative variances, by how the noise
/// is spread over the pixels.
double exposure_p_value(const RunMeans& runs, const ExposureFactors& converged, bool by_channel,
                        double factor = 1) {
    std::vector<double> p;
    for (std::size_t c = 0; c < (by_channel ? 3u : 1u); ++c) {
        const double exact = double{converged[c]}, bias = runs.exposure[c].variance() / exact;
        test::MeanEstimate found = test::estimate_of(runs.exposure[c]);
        found.mean -= 1.5 * bias;
        found.standard_error = std::hypot(found.standard_error, 0.5 * bias, 5e-4 * exact);
        p.push_back(test::welch_p_value(test::scaled_by(found, factor), {exact, 0}));
    }
    return test::holm_minimum(p);
}

/// One of each kind; images that are made alike need no second one.
bool tries_exposure(const std::string& name, bool by_channel) {
    const std::set<std::string> some{"mc", "pgris, replay", "pgris, kept image",
                                     "path cache, sobol", "path cache, independent"};
    return by_channel ? name == "mc" || name == "path cache, sobol" : some.count(name) > 0;
}

/// At the exposure of the least loss the loss does not change with it: its slope is that at a
/// constant exposure. Which it is, is compared, too: the slope hardly tells.
TEST(Iteration, GradientAtAFittedExposureIsTheSlopeOfTheFittedLoss) {
    const test::LedgerEntry& entry = test::ledger::kFittedExposures;
    for (const bool by_channel : {false, true}) {
        Script script = make_script(test::make_strip_scene(20, 3));
        View& view = script.problem.views[0];
        for (std::size_t i = 0; i < view.image.values.size(); ++i)
            view.image.values[i] *= std::array<float, 3>{2, 1.5f, 2.5f}[by_channel ? i % 3 : 0];
        view.exposure = FitExposure{by_channel};
        const std::vector<Direction> directions = make_directions(script);
        const FitExposure how{by_channel};
        const ExposureFactors converged = converged_exposure(script, how);
        Problem at_constant = script.problem;
        at_constant.views[0].exposure = converged;
        at_constant.loss = [&](const Image& image, std::size_t) {
            LossValue loss =
                evaluate_loss(Loss::kRelMse, exposed(converged, image), view.image, view.mask);
            loss.adjoint = exposed(converged, loss.adjoint);
            return loss;
        };
        const auto truth = test::slopes(
            at_constant, script.theta.back(), directions,
            {.replicas = test::scaled(entry, 24u), .seed = test::seed_of(entry, 500000)});
        for (const auto& [name, estimator] : cases()) {
            const std::string what = name + std::string(by_channel ? ", by channel" : "");
            if (!tries_exposure(name, by_channel)) continue;
            const RunMeans runs = mean_of_runs(script, estimator, directions, entry, 400);
            EXPECT_TRUE(accepted(entry, what, p_value(runs.along, truth)));
            EXPECT_TRUE(accepted(entry, what + ", exposure",
                                 exposure_p_value(runs, converged, by_channel)));
            EXPECT_TRUE(rejected(entry, "exposure 1.2 % too small",
                                 exposure_p_value(runs, converged, by_channel, 0.988)));
        }
        // As the noise of an image would make it, were its square taken for light.
        Script biased = script;
        biased.problem.views[0].exposure =
            ExposureFactors{0.92f * converged[0], 0.92f * converged[1], 0.92f * converged[2]};
        EXPECT_TRUE(
            rejected(entry, "gradient at an exposure 8 % too small",
                     p_value(mean_along(biased, cache(Sequence::kSobol, 2), directions, entry, 400),
                             truth)));
    }
}

/// Keeps of a history what one thread merges.
void lose_all_but_the_first_range(State::Values& state) {
    auto& samples = std::get<ReservoirsState>(state.views[0].estimator).history.samples;
    samples.resize(std::min<std::size_t>(samples.size(), 4096));
}

/// The same where reservoirs come in many ranges and pixels in many batches.
TEST(Iteration, GradientOfManyReservoirsIsTheSlopeOfTheLoss) {
    const test::LedgerEntry& entry = test::ledger::kManyReservoirs;
    const Script script = make_script(test::make_strip_scene(57, 64));
    std::vector<Direction> directions = make_directions(script);
    directions.erase(directions.begin(), directions.end() - 2);  // in all unknowns
    const auto truth =
        test::slopes(script.problem, script.theta.back(), directions,
                     {.replicas = test::scaled(entry, 12u), .seed = test::seed_of(entry, 500000)});
    for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
        const Reservoirs pgris = reservoirs(true, true, shift, false);
        const Solver one = run(script, test::gradient_options(pgris));
        const State state = one.state();
        EXPECT_GT(
            std::get<ReservoirsState>(state.values().views[0].estimator).history.samples.size(),
            10000u);
        const auto p = [&](test::Tamper tamper) {
            return p_value(mean_along(script, pgris, directions, entry, 40, tamper), truth);
        };
        const bool replay = shift == Shift::kReplay;
        EXPECT_TRUE(accepted(entry, replay ? "replay" : "identity", p(test::leave_alone)));
        if (replay) continue;
        EXPECT_TRUE(
            rejected(entry, "history of the first range alone", p(lose_all_but_the_first_range)));
    }
}

}  // namespace
}  // namespace burnish
