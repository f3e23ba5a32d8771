// Unknown weights of blends and opacities of masks: chains against the image of the same paths,
// records that are shaded again against finite differences of themselves, and every estimator
// against finite differences of images in which the weights are known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "gradient/blends.h"
#include "gradient/estimators.h"
#include "gradient/path_cache/path_cache.h"
#include "ledger_entries.h"
#include "paths/chains.h"
#include "render/render.h"
#include "student.h"

namespace burnish {
namespace {

using namespace test::ledger;
using test::accepted;
using test::one_of_each_pixel;
using test::rejected;
using test::RunningMean;
using test::scaled;
using test::seed_of;

/// One texture moved along a direction.
Theta moved_by(Theta theta, std::size_t slot, const Image& direction, double step) {
    Image& values = theta.textures[slot].values;
    for (std::size_t i = 0; i < values.values.size(); ++i)
        values.values[i] += static_cast<float>(step * double{direction.values[i]});
    return theta;
}

Image direction_of(const Theta& theta, std::size_t slot, std::uint32_t seed) {
    Image direction = theta.textures[slot].values;
    test::RandomSource random{seed};
    for (float& v : direction.values) v = random.next(0.4f, 1);
    return direction;
}

TEST(BlendChains, GiveTheImageOfTheSamePaths) {
    const Scene scene = test::make_room_of_blends();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    const TraceInput input = unknown_derivatives(binding, {7, Stream::kTest}, 1);
    int vertices_within_light = 0;
    for (std::uint32_t pass = 0; pass < 16; ++pass) {
        const auto samples = one_of_each_pixel(scene, pass);
        std::vector<Rgbf> expected(samples.size());
        trace_bounces(input, samples, expected);
        ChainOutput out;
        trace_chains(input, samples, out);
        std::vector<Rgbf> sum = out.emitted;
        for (const Chain& chain : out.chains)
            sum[static_cast<std::size_t>(chain.sample)] +=
                value_of(std::span(out.vertices).subspan(chain.begin, chain.end - chain.begin));
        for (const ChainVertex& v : out.vertices)
            vertices_within_light += binding.shader(v.bsdf).is_within_light;
        for (std::size_t i = 0; i < sum.size(); ++i)
            EXPECT_LE(length(sum[i] - expected[i]), 1e-5f * (1 + length(expected[i])));
    }
    EXPECT_GT(vertices_within_light, 500);
}

/// Shades the records of a cache under textures to either side: the derivative by each texture.
void expect_finite_differences(const Scene& scene) {
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    PathCacheState state;
    PathCacheWorkspace workspace = make_workspace(PathCache{}, binding);
    const PathCacheInput input{binding, 5, Sequence::kSobol};
    trace_passes(input, 8, workspace, state);
    const Image adjoint = test::make_adjoint(scene, 74, true);
    EXPECT_EQ(shade(input, state, workspace).rejected, 0u);
    std::vector<Image> gradient;
    for (const SplitGradient& g : accumulate(input, state, {&adjoint, &adjoint}, workspace))
        gradient.push_back(sum_of(g));
    for (std::size_t slot = 0; slot < gradient.size(); ++slot) {
        const Image direction = direction_of(theta, slot, 75);
        const double step = 4e-3;
        double difference = 0;
        for (const double side : {-1.0, 1.0}) {
            const Theta other = moved_by(theta, slot, direction, side * step);
            const Binding there(traced, other);
            for (const Image& image : shade({there, 5, Sequence::kSobol}, state, workspace).images)
                difference += side * 0.5 * dot(image, adjoint) / (2 * step);
        }
        EXPECT_NEAR(dot(gradient[slot], direction), difference,
                    2e-3 * (0.01 + std::abs(difference)))
            << slot;
    }
}

TEST(BlendRecords, DerivativesAreFiniteDifferences) {
    expect_finite_differences(test::make_small_scene_of_blends());
    expect_finite_differences(test::make_room_of_blends());
}

// ---- Against images of known weights

/// What is compared: derivatives by the last two textures along a direction of each.
struct WeightSlopes {
    Scene scene;
    TracedScene traced = prepare(scene);
    Theta theta = test::theta_of(scene);
    Image adjoint = test::make_adjoint(scene, 91, true);

    explicit WeightSlopes(Scene of) : scene(std::move(of)) {
        for (float& a : adjoint.values) a = 1 + 0.4f * a;  // slopes that do not cancel
    }
    std::size_t slot(std::size_t k) const { return theta.textures.size() - 2 + k; }
    Image direction(std::size_t k) const { return direction_of(theta, slot(k), 92); }
};

using SlopeMeans = std::array<RunningMean, 2>;

SlopeMeans mean_of(std::size_t batches,
                   const std::function<std::array<double, 2>(std::uint32_t)>& body) {
    std::vector<std::array<double, 2>> values(batches);
    parallel_for(batches, [&](std::size_t b) { values[b] = body(static_cast<std::uint32_t>(b)); });
    SlopeMeans means;
    for (const auto& v : values)
        for (std::size_t k = 0; k < 2; ++k) means[k].add(v[k]);
    return means;
}

/// Of images whose weights the renderer takes for known.
std::array<double, 2> slopes_of_image(const WeightSlopes& s, std::uint32_t seed) {
    std::array<double, 2> slopes{};
    for (std::size_t k = 0; k < 2; ++k) {
        const auto at = [&](double step) {
            const Theta other = moved_by(s.theta, s.slot(k), s.direction(k), step);
            const TextureTable textures = texture_table(s.scene, other);
            const TraceInput input{&s.traced, &textures,           {seed, Stream::kTest},
                                   16,        SurfaceChoice::kAll, {}};
            return dot(render(input, 0, 16), s.adjoint);
        };
        // A path has at most four vertices, one of direct light: the image is a polynomial of that
        // degree, and this its slope, whatever the step.
        constexpr double kStep = 0.14;
        slopes[k] =
            has_bounces(s.scene)
                ? (8 * (at(kStep) - at(-kStep)) - (at(2 * kStep) - at(-2 * kStep))) / (12 * kStep)
                : (at(2 * kStep) - at(-2 * kStep)) / (4 * kStep);
    }
    return slopes;
}

/// What an estimator says at the last of three iterations, under other textures before.
std::array<double, 2> slopes_of_estimator(const WeightSlopes& s, const Estimator& estimator,
                                          std::uint32_t seed) {
    const bool own = has_own_derivatives(estimator);
    const Binding last(s.traced, s.theta);
    EstimatorState state = make_state(estimator);
    EstimatorWorkspace workspace = make_workspace(estimator, last, reaching_pixels(last));
    const std::array<Image, 2> adjoints{s.adjoint, s.adjoint};
    std::array<double, 2> slopes{};
    for (std::uint32_t v = std::holds_alternative<MonteCarlo>(estimator) ? 2 : 0; v < 3; ++v) {
        Theta theta = s.theta;
        for (std::size_t k = 0; k < 2; ++k)
            theta = moved_by(theta, s.slot(k), s.direction(k), 0.12 * (v == 0) - 0.2 * (v == 1));
        const Binding binding(s.traced, theta);
        if (!own) estimate_image(estimator, binding, {seed, v}, state, workspace);
        const auto estimate =
            estimate_gradient(estimator, binding, adjoints, {seed, v}, state, workspace);
        for (std::size_t k = 0; k < 2; ++k)
            slopes[k] = dot(sum_of(estimate.gradient[s.slot(k)]), s.direction(k));
    }
    return slopes;
}

std::vector<Estimator> all_estimators() {
    std::vector<Estimator> all{test::mc(8), PathCache{.samples = 4, .window = 4}};
    for (Reservoirs o : {test::ris(), test::pris(), test::gris(), test::pgris()}) {
        o.samples = 4, o.confidence_cap = 8, o.target_function = TargetFunction::kIntegrand;
        all.push_back(o);
        o.shift = Shift::kIdentity;
        if (o.reuse) all.push_back(o);
    }
    return all;
}

std::string text_of(const Estimator& e) {
    const auto* o = std::get_if<Reservoirs>(&e);
    return o && o->reuse ? fmt::format("{}, {}", test::name_of(e), test::name_of(o->shift))
                         : test::name_of(e);
}

/// Monte Carlo and the path cache: their means are good to a hundredth.
bool has_little_noise(const Estimator& e) { return !std::holds_alternative<Reservoirs>(e); }

void expect_slopes(const test::LedgerEntry& entry, const Scene& scene) {
    const WeightSlopes s(scene);
    const SlopeMeans image = mean_of(scaled(entry, std::size_t{200}), [&](std::uint32_t b) {
        return slopes_of_image(s, seed_of(entry, b));
    });
    const auto p_value = [&](const RunningMean& slope, std::size_t k) {
        return test::welch_p_value(test::estimate_of(slope), test::estimate_of(image[k]));
    };
    for (const Estimator& e : all_estimators()) {
        const SlopeMeans slopes = mean_of(scaled(entry, std::size_t{250}), [&](std::uint32_t b) {
            return slopes_of_estimator(s, e, seed_of(entry, 300 + b));
        });
        for (std::size_t k = 0; k < 2; ++k) {
            const std::string what = fmt::format("{}, texture {}", text_of(e), s.slot(k));
            fmt::print("{}: {:.5g} +- {:.2g}, image {:.5g} +- {:.2g}\n", what, slopes[k].mean,
                       slopes[k].standard_error(), image[k].mean, image[k].standard_error());
            EXPECT_TRUE(accepted(entry, what, p_value(slopes[k], k)));
            EXPECT_TRUE(rejected(entry, "derivative with the other sign",
                                 p_value(test::larger_by(-1, slopes[k]), k)));
            if (!has_little_noise(e)) continue;
            EXPECT_TRUE(rejected(entry, "derivative 10 % larger",
                                 p_value(test::larger_by(1.1, slopes[k]), k)));
        }
    }
}

TEST(BlendEstimators, HaveTheSlopesOfTheImageOfDirectLight) {
    expect_slopes(kBlends, test::make_small_scene_of_blends());
}

TEST(BlendEstimators, HaveTheSlopesOfTheImageWhereLightBounces) {
    expect_slopes(kBouncedBlends, test::make_room_of_blends());
}

}  // namespace
}  // namespace burnish
