// Every estimator agrees with the baseline in expectation, and the baseline with finite differences
// of rendered images. The textures, and the adjoint with its sign, follow a script over six
// iterations: in a closed loop the samples would move the textures, and hide a bias. Texels that
// are hit less than once per iteration count like all others. (Holm over iterations, texels,
// channels and random projections.)
//
// The target `luminance` is tested on a gray base colour and an adjoint whose channels share a
// sign: g / q is unbounded where the channels cancel, and no test of means applies there.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "gradient/estimator.h"
#include "gradient/estimator_script.h"
#include "optimize/loss.h"
#include "optimize/option_value.h"
#include "render/render.h"

namespace burnish {
namespace {

using test::accepted;
using test::agreement_p_value;
using test::estimate_first;
using test::Estimates;
using test::follow;
using test::follow_baseline;
using test::gris;
using test::kAdjointScale;
using test::larger_by;
using test::make_script;
using test::mc;
using test::numbers_of;
using test::pgris;
using test::pris;
using test::rejected;
using test::ris;
using test::RunningMean;
using test::Runs;
using test::scaled;
using test::Script;
using test::seed_of;
using test::sum_runs;
using test::Tamper;
using namespace test::ledger;

/// A script, and the baseline along it.
struct Expectation {
    Script script;
    Estimates baseline;

    explicit Expectation(TargetFunction target)
        : script(make_script(target == TargetFunction::kLuminance)),
          baseline(follow_baseline(kEstimators, script)) {}

    double p_value(const Estimator& estimator, const Tamper& tamper = {}) const {
        return agreement_p_value(follow(kEstimators, script, estimator, tamper), baseline);
    }
};

Reservoirs with(Reservoirs options, TargetFunction target) {
    options.target_function = target;
    options.confidence_cap = 4;
    return options;
}

TEST(SmallScene, HasTexelsThatAreHitRarely) {
    const Script script = make_script(false);
    const TracedScene traced = prepare(script.scene);
    const Binding binding(traced, script.theta[0]);
    std::vector<double> hits(64);
    for (std::uint32_t seed = 0; seed < 100; ++seed)
        for (const TexelGradient& g :
             estimate_first(mc(), binding, script.adjoint[0], seed).gradient)
            if (g.key.slot == 1) hits[g.key.texel] += 0.01;
    const auto rare = std::count_if(hits.begin(), hits.end(), [](double h) { return h < 0.9; });
    EXPECT_GE(rare, 8);
    EXPECT_GT(*std::max_element(hits.begin(), hits.end()), 0.99);
}

void expect_agreement_without_history(const Expectation& expected,
                                      const Choice<TargetFunction>& target) {
    for (const Estimator& e : {Estimator{mc()}, Estimator{with(ris(), target.value)},
                               Estimator{with(pris(), target.value)}})
        EXPECT_TRUE(accepted(kEstimators, fmt::format("{}, {}", test::name_of(e), target.name),
                             expected.p_value(e)));
}

void expect_agreement_with_history(const Expectation& expected,
                                   const Choice<TargetFunction>& target) {
    for (Reservoirs options : {with(gris(), target.value), with(pgris(), target.value)})
        for (const Choice<Shift>& shift : choices<Shift>())
            for (const Choice<MergeRule>& rule : choices<MergeRule>()) {
                options.shift = shift.value;
                options.merge = rule.value;
                const std::string what = fmt::format("{}, {}, {}, {}", test::name_of(options),
                                                     target.name, shift.name, rule.name);
                EXPECT_TRUE(accepted(kEstimators, what, expected.p_value(options)));
            }
}

TEST(Estimators, AgreeWithTheBaselineAtEveryIteration) {
    for (const Choice<TargetFunction>& target : choices<TargetFunction>()) {
        const Expectation expected(target.value);
        expect_agreement_without_history(expected, target);
        expect_agreement_with_history(expected, target);
    }
}

// ---- Seeded defects, injected into the history

/// W divided by a wrong M.
void scale_weights(ReservoirsState& state, std::size_t) {
    for (HistorySample& s : state.history.samples) s.W *= 0.8f;
}

/// Samples whose sign flipped are forgotten, their confidence is not.
void drop_flipped(ReservoirsState& state, std::size_t v) {
    if (v > 0 && kAdjointScale[v] * kAdjointScale[v - 1] < 0) state.history.samples.clear();
}

/// q_{v-1} under an adjoint of another size than that of the samples: stale.
void stale_target(ReservoirsState& state, std::size_t v) {
    if (v < 2) return;
    for (float& a : state.history.normalized_adjoint.values)
        a *= kAdjointScale[v - 2] / kAdjointScale[v - 1];
}

/// Half of the texels lose their reservoirs, but not their confidence.
void forget_some(ReservoirsState& state, std::size_t) {
    std::erase_if(state.history.samples,
                  [](const HistorySample& s) { return s.key.texel % 2 == 0; });
}

TEST(Estimators, DefectsAreRejected) {
    const Expectation expected(TargetFunction::kIntegrand);
    Reservoirs options = with(pgris(), TargetFunction::kIntegrand);
    options.shift = Shift::kIdentity;
    const auto expect_rejected = [&](const char* defect, const Tamper& tamper) {
        EXPECT_TRUE(rejected(kEstimators, defect, expected.p_value(options, tamper)));
    };
    expect_rejected("W divided by a wrong M", scale_weights);
    expect_rejected("history dropped where the adjoint flips", drop_flipped);
    expect_rejected("stale q of the iteration before", stale_target);
    expect_rejected("reservoirs lost, their confidence kept", forget_some);

    const Estimates estimates = follow(kEstimators, expected.script, options);
    for (std::size_t v = 0; v < estimates.along.size(); ++v)
        fmt::print(
            "iteration {}: standard error along the gradient {:.2f} %, baseline {:.2f} %\n", v,
            100 * estimates.along[v].standard_error() / estimates.along[v].mean,
            100 * expected.baseline.along[v].standard_error() / expected.baseline.along[v].mean);
    EXPECT_TRUE(rejected(kEstimators, "gradient 10 % larger",
                         agreement_p_value(larger_by(1.1, estimates), expected.baseline)));
}

// ---- The baseline against finite differences of the rendered image

/// sum A * image of one batch of samples.
double weighted_image(const TracedScene& traced, const Theta& theta, const Image& adjoint,
                      std::uint32_t seed) {
    const TextureTable textures = texture_table(*traced.scene, theta);
    const TraceInput input{&traced, &textures, {seed, Stream::kTest}, 16, SurfaceChoice::kAll, {}};
    const Image image = render(input, 0, 16);
    double sum = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i)
        sum += double{image.values[i]} * double{adjoint.values[i]};
    return sum;
}

/// Texture `slot` moves, each texel by a random amount in [0, 1], the others rest.
Theta random_direction(const Theta& theta, std::size_t slot, std::uint32_t seed) {
    Theta direction = theta;
    test::RandomSource random{seed};
    for (std::size_t t = 0; t < direction.textures.size(); ++t)
        for (float& v : direction.textures[t].values.values) v = t == slot ? random.next() : 0.0f;
    return direction;
}

Theta moved(const Theta& theta, const Theta& direction, float step) {
    Theta result = theta;
    for (std::size_t t = 0; t < theta.textures.size(); ++t)
        for (std::size_t i = 0; i < theta.textures[t].values.values.size(); ++i)
            result.textures[t].values.values[i] += step * direction.textures[t].values.values[i];
    return result;
}

/// Slopes of the image along a direction, and the products of gradients with it.
struct Slopes {
    RunningMean slope, product;
};

Slopes slopes_along(const Binding& binding, const Theta& direction, const Image& adjoint) {
    constexpr float kStep = 0.01f;
    const std::size_t batches = scaled(kSlope, std::size_t{200});
    const TracedScene& traced = binding.traced;
    const Theta& theta = binding.theta;
    const Theta up = moved(theta, direction, kStep), down = moved(theta, direction, -kStep);
    std::vector<double> slopes(batches), products(batches);
    parallel_for(batches, [&](std::size_t b) {
        const std::uint32_t seed = seed_of(kSlope, static_cast<std::uint32_t>(b));
        slopes[b] = (weighted_image(traced, up, adjoint, seed) -
                     weighted_image(traced, down, adjoint, seed)) /
                    (2 * double{kStep});
        const std::uint32_t own = seed_of(kSlope, 5000 + static_cast<std::uint32_t>(b));
        const auto images =
            dense_gradient(theta, estimate_first(mc(16), binding, adjoint, own).gradient);
        for (std::size_t t = 0; t < images.size(); ++t)
            for (std::size_t i = 0; i < images[t].values.size(); ++i)
                products[b] +=
                    double{images[t].values[i]} * double{direction.textures[t].values.values[i]};
    });
    Slopes result;
    for (const double s : slopes) result.slope.add(s);
    for (const double s : products) result.product.add(s);
    return result;
}

/// p-value of "the gradient times `gain` has the slope of the image along all directions".
double slope_p_value(const std::vector<Slopes>& directions, double gain) {
    std::vector<double> p;
    for (Slopes d : directions)
        p.push_back(test::welch_p_value(test::estimate_of(d.slope),
                                        test::estimate_of(larger_by(gain, d.product))));
    return test::holm_minimum(p);
}

/// Three random directions for each texture.
TEST(Baseline, IsTheSlopeOfTheRenderedImage) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    Image adjoint = test::make_adjoint(scene, 91, true);
    for (float& a : adjoint.values) a += 1.5f;  // slopes that do not cancel
    std::vector<Slopes> directions;
    for (std::uint32_t d = 0; d < 6; ++d)
        directions.push_back(
            slopes_along(binding, random_direction(theta, d % 2, 92 + d), adjoint));
    EXPECT_TRUE(accepted(kSlope, "directions", slope_p_value(directions, 1)));
    EXPECT_TRUE(rejected(kSlope, "gradient 10 % larger", slope_p_value(directions, 1.1)));
}

// ---- The filter is normalised by its integral, not by realised weights

/// What normalising by the weights that a pass realises would make of an adjoint.
Image realised_adjoint(const Film& film, const Image& adjoint, const Vec2f& offset) {
    const FilmNormalization exact = film_normalization(film);
    const auto realised = [&](float at, int size) {
        const FilterTaps taps = filter_taps(film.filter, at);
        std::vector<float> sum(static_cast<std::size_t>(size));
        for (int from = 0; from < size; ++from)
            for (int k = -taps.halo; k <= taps.halo; ++k)
                if (from + k >= 0 && from + k < size)
                    sum[static_cast<std::size_t>(from + k)] +=
                        taps.weight[static_cast<std::size_t>(k + taps.halo)];
        return sum;
    };
    const auto x = realised(offset.x, adjoint.width), y = realised(offset.y, adjoint.height);
    Image result = adjoint;
    for (int j = 0; j < adjoint.height; ++j)
        for (int i = 0; i < adjoint.width; ++i)
            for (int c = 0; c < 3; ++c)
                result.at(i, j, c) /=
                    x[static_cast<std::size_t>(i)] * y[static_cast<std::size_t>(j)] *
                    exact.x[static_cast<std::size_t>(i)] * exact.y[static_cast<std::size_t>(j)];
    return result;
}

/// A narrow Gaussian: the gradient at one sample per pixel is that at many, but not where the
/// filter is normalised by the weights that a pass realises.
TEST(Film, RealisedWeightsWouldBiasTheGradient) {
    Scene scene = test::make_small_scene();
    scene.film.filter = {FilterKind::kGaussian, 1.0f, 0.3f};
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    const Image adjoint = test::make_adjoint(scene, 95, true);
    const auto estimates = [&](std::size_t runs, std::uint32_t samples, bool defect) {
        Runs numbers(runs);
        parallel_for(runs, [&](std::size_t run) {
            const std::uint32_t seed =
                seed_of(kFilmGradient, 9000 * (samples - 1) + static_cast<std::uint32_t>(run));
            const Vec2f offset = film_offset({seed, Stream::kDerivative}, 0);
            const Image used = defect ? realised_adjoint(scene.film, adjoint, offset) : adjoint;
            numbers[run] = {
                numbers_of(theta, estimate_first(mc(samples), binding, used, seed).gradient)};
        });
        return sum_runs(numbers);
    };
    const Estimates many = estimates(scaled(kFilmGradient, std::size_t{320}), 16, false);
    const auto p_value = [&](bool by_realised_weights) {
        return agreement_p_value(
            estimates(scaled(kFilmGradient, std::size_t{4000}), 1, by_realised_weights), many);
    };
    EXPECT_TRUE(accepted(kFilmGradient, "narrow Gaussian", p_value(false)));
    EXPECT_TRUE(rejected(kFilmGradient, "normalisation by realised weights", p_value(true)));
}

// ---- Image and derivative need independent samples [PR sec. 2.2]

/// The gradient under adjoints of noisy images is that under adjoints of images from a stream of
/// their own. Neither image is taken for exact: the adjoint is affine in the image, so that their
/// noise adds none to the expectation.
TEST(Streams, ImageAndDerivativeMustNotShareTheirSamples) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    const Image target = make_image(16, 16, 3, 0.2f);
    const auto image_of = [&](Stream from, std::uint32_t seed, std::uint32_t passes) {
        const TraceInput input{&traced, &binding.textures,   {seed, from},
                               passes,  SurfaceChoice::kAll, {}};
        return render(input, 0, passes);
    };
    const std::size_t runs = scaled(kStreams, std::size_t{4000});
    const auto estimates = [&](auto&& adjoint_of) {
        Runs numbers(runs);
        parallel_for(runs, [&](std::size_t run) {
            const std::uint32_t seed = seed_of(kStreams, static_cast<std::uint32_t>(run));
            const Image adjoint = evaluate_loss(Loss::kL2, adjoint_of(seed), target, {}).adjoint;
            numbers[run] = {
                numbers_of(theta, estimate_first(mc(), binding, adjoint, seed).gradient)};
        });
        return sum_runs(numbers);
    };
    const Estimates expected =
        estimates([&](std::uint32_t seed) { return image_of(Stream::kEvaluation, seed, 4); });
    const auto p_value = [&](Stream stream) {
        return agreement_p_value(
            estimates([&](std::uint32_t seed) { return image_of(stream, seed, 1); }), expected);
    };
    EXPECT_TRUE(accepted(kStreams, "independent", p_value(Stream::kImage)));
    EXPECT_TRUE(
        rejected(kStreams, "one stream for image and derivative", p_value(Stream::kDerivative)));
}

TEST(Streams, TheImageOfAnIterationHasItsOwn) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    Reservoirs reservoirs = pgris();
    reservoirs.image_samples = 2;
    for (const Estimator& e : {Estimator{MonteCarlo{2, 1, false}}, Estimator{reservoirs}}) {
        EstimatorState state = make_state(e);
        EstimatorWorkspace workspace = make_workspace(e, binding, reaching_pixels(binding));
        const Image image = estimate_image(e, binding, {7, 3}, state, workspace).images.front();
        const auto of_stream = [&](Stream stream) {
            return render(unknown_part(binding, {7, stream}, 2), 3, 2);
        };
        EXPECT_EQ(image, of_stream(Stream::kImage));
        EXPECT_NE(image, of_stream(Stream::kDerivative));
    }
}

}  // namespace
}  // namespace burnish
