// Light that bounces: chains against the image of the same paths, packets of packed chains against
// plain floats, derivatives against finite differences, estimators against one another, and a scene
// whose image and derivatives are known in closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numeric>

#include "burnish/error.h"
#include "gradient/estimator_script.h"
#include "gradient/integrating_sphere.h"
#include "gradient/path_cache/path_cache.h"
#include "gradient/room.h"
#include "paths/chains.h"
#include "render/render.h"

namespace burnish {
namespace {

using namespace test::ledger;
using test::accepted;
using test::exact_gradient;
using test::exact_image;
using test::IntegratingSphere;
using test::kAllBounces;
using test::kGridSlack;
using test::make_integrating_sphere;
using test::one_of_each_pixel;
using test::rejected;
using test::scaled;
using test::seed_of;

double largest(const Rgbf& v) {
    return std::max({std::abs(double{v.x}), std::abs(double{v.y}), std::abs(double{v.z})});
}

/// The room, ready to be traced, under its own textures.
struct Room {
    Scene scene = test::make_room();
    TracedScene traced = prepare(scene);
    Theta theta = test::theta_of(scene);
    Binding binding{traced, theta};

    TraceInput input(SurfaceChoice choice) const {
        TraceInput input = unknown_derivatives(binding, {7, Stream::kTest}, 1);
        input.choice = choice;
        return input;
    }
};

// ---- Chains

TEST(Chains, GiveTheImageOfTheSamePaths) {
    const Room room;
    for (std::uint32_t pass = 0; pass < 16; ++pass) {
        const auto samples = one_of_each_pixel(room.scene, pass);
        const auto radiance_of = [&](SurfaceChoice choice) {
            std::vector<Rgbf> radiance(samples.size());
            trace_bounces(room.input(choice), samples, radiance);
            return radiance;
        };
        const auto all = radiance_of(SurfaceChoice::kAll);
        const auto unknown = radiance_of(SurfaceChoice::kUnknown);
        const auto constant = radiance_of(SurfaceChoice::kConstant);
        for (const SurfaceChoice choice : {SurfaceChoice::kAll, SurfaceChoice::kUnknown}) {
            ChainOutput out;
            trace_chains(room.input(choice), samples, out);
            std::vector<Rgbf> sum = out.emitted;
            for (const Chain& chain : out.chains)
                sum[static_cast<std::size_t>(chain.sample)] +=
                    value_of(std::span(out.vertices).subspan(chain.begin, chain.end - chain.begin));
            const auto& expected = choice == SurfaceChoice::kAll ? all : unknown;
            for (std::size_t i = 0; i < sum.size(); ++i)
                EXPECT_LE(largest(sum[i] - expected[i]), 1e-5 * (1 + largest(expected[i])));
        }
        for (std::size_t i = 0; i < all.size(); ++i)
            EXPECT_LE(largest(unknown[i] + constant[i] - all[i]), 1e-5 * (1 + largest(all[i])));
    }
}

TEST(Chains, HaveAllLengthsThatTheDepthAllows) {
    const Room room;
    std::array<int, 6> lengths{};
    for (std::uint32_t pass = 0; pass < 16; ++pass) {
        ChainOutput out;
        trace_chains(room.input(SurfaceChoice::kUnknown), one_of_each_pixel(room.scene, pass), out);
        for (const Chain& chain : out.chains) {
            ASSERT_LT(chain.end - chain.begin, static_cast<std::uint32_t>(room.scene.max_depth));
            ++lengths[chain.end - chain.begin];
        }
    }
    for (int length = 1; length < room.scene.max_depth; ++length)
        EXPECT_GT(lengths[static_cast<std::size_t>(length)], 0) << length;
}

TEST(Chains, OfTwoSegmentsAreDirectLight) {
    Scene scene = test::make_room();
    scene.max_depth = 2;
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {7, Stream::kTest}, 1, SurfaceChoice::kAll, {}};
    for (std::uint32_t pass = 0; pass < 4; ++pass) {
        const auto samples = one_of_each_pixel(scene, pass);
        std::vector<Rgbf> direct(samples.size()), bounced(samples.size());
        trace_radiance(input, samples, direct);
        trace_bounces(input, samples, bounced);
        for (std::size_t i = 0; i < direct.size(); ++i)
            EXPECT_LE(largest(direct[i] - bounced[i]), 2e-6 * (1 + largest(direct[i])));
    }
}

// ---- The path cache on chains

/// A cache of some passes, and what its stages read.
struct CachedRoom {
    Room room;
    PathCacheState state;
    PathCacheWorkspace workspace = make_workspace(PathCache{}, room.binding);
    PathCacheInput input{room.binding, 5, Sequence::kSobol};

    explicit CachedRoom(std::uint32_t passes) { trace_passes(input, passes, workspace, state); }
};

/// The records of a half's chains in plain floats, pass by pass: body(sample of light, film pass).
void for_light_samples(const CachedRoom& cached, std::size_t half,
                       const std::function<void(const DirectSample&)>& body) {
    TraceInput input = unknown_derivatives(cached.room.binding, half_key(cached.input, half), 1);
    input.sequence = cached.input.sequence;
    for (const CachedPass& pass : cached.state.halves[half].passes) {
        const auto samples = one_of_each_pixel(cached.room.scene, pass.film_pass);
        ChainOutput out;
        trace_chains(input, samples, out);
        std::vector<DirectSample> light;
        append_samples(input, samples, out, light);
        for (const DirectSample& d : light) body(d);
    }
}

TEST(ChainsInTheCache, GiveTheImageOfPlainFloats) {
    CachedRoom cached(8);
    const HalfImages halves = shade(cached.input, cached.state, cached.workspace);
    EXPECT_EQ(halves.rejected, 0u);
    for (std::size_t h = 0; h < 2; ++h) {
        std::vector<double> plain(halves.images[h].values.size());
        for_light_samples(cached, h, [&](const DirectSample& d) {
            if (d.vertex > 0) return;  // within the value of the first one
            for (int c = 0; c < 3; ++c)
                plain[3 * d.record.pixel + static_cast<std::size_t>(c)] += double{d.value[c]} / 4;
        });
        for (std::size_t i = 0; i < plain.size(); ++i)
            EXPECT_NEAR(double{halves.images[h].values[i]}, plain[i], 1e-3 * (0.1 + plain[i]));
    }
}

TEST(ChainsInTheCache, GiveTheGradientOfPlainFloats) {
    CachedRoom cached(8);
    shade(cached.input, cached.state, cached.workspace);
    const Image adjoint = test::make_adjoint(cached.room.scene, 73, true);
    const auto& gradient =
        accumulate(cached.input, cached.state, {&adjoint, &adjoint}, cached.workspace);
    const Film& film = cached.room.scene.film;
    const Image weights = normalized_adjoint(adjoint, film_normalization(film));
    std::vector<Image> plain;
    for (const ThetaTexture& t : cached.room.theta.textures)
        plain.push_back(make_image(t.values.width, t.values.height, t.values.channels));
    for (std::size_t h = 0; h < 2; ++h) {
        const PassTaps taps =
            pass_taps(film.filter, half_key(cached.input, h), 0, 8, cached.input.sequence);
        for_light_samples(cached, h, [&](const DirectSample& d) {
            TexelDerivatives all;
            differentiate({&cached.room.binding, &weights, &taps, TargetFunction::kIntegrand},
                          d.record, all);
            for (int i = 0; i < all.count; ++i) {
                const TexelDerivative& t = all.items[static_cast<std::size_t>(i)];
                Image& image = plain[t.key.slot];
                for (int c = 0; c < image.channels; ++c)
                    image.values[t.key.texel * static_cast<std::size_t>(image.channels) +
                                 static_cast<std::size_t>(c)] += t.g[c] * 0.5f / 4;
            }
        });
    }
    for (std::size_t t = 0; t < plain.size(); ++t) {
        const Image sum = sum_of(gradient[t]);
        double scale = 0;
        for (const float v : plain[t].values) scale = std::max(scale, std::abs(double{v}));
        ASSERT_GT(scale, 0);
        for (std::size_t i = 0; i < sum.values.size(); ++i)
            EXPECT_NEAR(double{sum.values[i]}, double{plain[t].values[i]}, 2e-3 * scale)
                << t << " " << i;
    }
}

TEST(ChainsInTheCache, DerivativesAreFiniteDifferences) {
    CachedRoom cached(8);
    const Image adjoint = test::make_adjoint(cached.room.scene, 74, true);
    shade(cached.input, cached.state, cached.workspace);
    const auto& split =
        accumulate(cached.input, cached.state, {&adjoint, &adjoint}, cached.workspace);
    std::vector<Image> gradient;
    for (const SplitGradient& g : split) gradient.push_back(sum_of(g));
    for (std::size_t moved = 0; moved < gradient.size(); ++moved) {  // one texture at a time
        test::RandomSource random{75};
        std::vector<float> direction(gradient[moved].values.size());
        for (float& d : direction) d = random.next(-1, 1);
        const double step = 4e-3;
        double along = 0, difference = 0;
        for (std::size_t i = 0; i < direction.size(); ++i)
            along += double{direction[i]} * double{gradient[moved].values[i]};
        for (const double side : {-1.0, 1.0}) {
            Theta theta = cached.room.theta;
            for (std::size_t i = 0; i < direction.size(); ++i)
                theta.textures[moved].values.values[i] +=
                    static_cast<float>(side * step * double{direction[i]});
            const Binding binding(cached.room.traced, theta);
            const auto halves =
                shade({binding, 5, Sequence::kSobol}, cached.state, cached.workspace);
            for (const Image& image : halves.images)
                for (std::size_t i = 0; i < image.values.size(); ++i)
                    difference += side * 0.5 * double{image.values[i]} * double{adjoint.values[i]} /
                                  (2 * step);
        }
        EXPECT_NEAR(along, difference, 2e-3 * (0.01 + std::abs(difference))) << moved;
    }
}

// ---- Estimators

/// The room with a lamp at its right wall: a choice of lights.
Scene make_room_of_two_lamps() {
    Scene scene = test::make_room();
    scene.emitters.push_back(AreaEmitter{{6, 7, 9}, {7}});
    scene.shapes.push_back(
        {"lamp", test::make_quad({0.9f, 0.2f, 0.8f}, {0, 0, 0.4f}, {0, 0.4f, 0}), {3}, {1}});
    return scene;
}

/// Along the script, and a quarter larger.
void expect_agreement(const test::Script& script, const test::Estimates& baseline,
                      const Reservoirs& options, const std::string& what) {
    const test::Estimates estimates = test::follow(kBounces, script, options);
    EXPECT_TRUE(accepted(kBounces, what, test::agreement_p_value(estimates, baseline)));
    EXPECT_TRUE(rejected(kBounces, "gradient a quarter larger",
                         test::agreement_p_value(test::larger_by(1.25, estimates), baseline)));
}

TEST(Bounces, EstimatorsAgreeWithTheBaselineAtEveryIterationOfAScript) {
    test::Script script = test::make_script(make_room_of_two_lamps(), true);
    const test::Estimates baseline = test::follow_baseline(kBounces, script);
    for (const Reservoirs& o :
         {test::pris(), test::gris(), test::pgris(), test::by_integrand(test::gris()),
          test::by_integrand(test::pgris())})
        expect_agreement(
            script, baseline, o,
            fmt::format("{}, {}", test::name_of(Estimator{o}), test::name_of(o.shift)));
    const test::Tamper take_next = [](ReservoirsState& state, std::size_t) {
        for (HistorySample& s : state.history.samples) ++s.path.vertex;
    };
    EXPECT_TRUE(rejected(kBounces, "history takes the next vertex",
                         test::agreement_p_value(
                             test::follow(kBounces, script, test::pgris(), take_next), baseline)));
    // As a run has them by default.
    script.lights = LightSelection::kResampled;
    for (Reservoirs o : {test::pgris(), test::by_integrand(test::pgris())}) {
        o.adaptive_sampling = true;
        expect_agreement(
            script, baseline, o,
            fmt::format("pgris, {}, adaptive, resampled lights", test::name_of(o.shift)));
    }
}

/// A red lamp, and a wall that reflects no red in the first half of the iterations: what it shines
/// on has no history of that light in the iteration after.
test::Script script_of_a_red_lamp() {
    test::Script script{test::make_room(), {}, {}};
    std::get<AreaEmitter>(script.scene.emitters[0]).radiance = {14, 0, 0};
    for (int v = 0; v < test::kScriptIterations; ++v) {
        script.theta.push_back(test::theta_of(script.scene));
        std::vector<float>& wall = script.theta.back().textures[2].values.values;
        for (std::size_t i = 0; i < wall.size(); ++i)
            wall[i] = i % 3 == 0 && v < test::kScriptIterations / 2 ? 0.0f : 0.8f;
        script.adjoint.push_back(test::make_adjoint(script.scene, 81, false));
    }
    script.direction = test::direction_of(test::runs_along(script, test::mc(64), 4, 84000));
    return script;
}

TEST(Bounces, EstimatorsAgreeAfterTexturesThatLetNoLightThrough) {
    const test::Script script = script_of_a_red_lamp();
    const test::Estimates baseline = test::follow_baseline(kColoredBounces, script);
    const auto p_value = [&](const Reservoirs& options, const test::Tamper& tamper = {}) {
        const std::size_t runs = scaled(kColoredBounces, std::size_t{800});
        return test::agreement_p_value(
            test::sum_runs(
                test::runs_along(script, options, runs, seed_of(kColoredBounces), tamper),
                script.direction),
            baseline);
    };
    Reservoirs identity = test::pgris();
    identity.shift = Shift::kIdentity;
    Reservoirs defensive = identity;
    defensive.merge = MergeRule::kDefensive;
    EXPECT_TRUE(accepted(kColoredBounces, "identity shift", p_value(identity)));
    EXPECT_TRUE(accepted(kColoredBounces, "identity shift, defensive", p_value(defensive)));
    EXPECT_TRUE(accepted(kColoredBounces, "identity shift, integrand",
                         p_value(test::by_integrand(test::pgris()))));
    EXPECT_TRUE(rejected(kColoredBounces, "vertices of kept paths scatter twice, coloured",
                         p_value(identity, test::scatter_twice)));
}

/// The room lit by its ceiling alone, which the panel shines at, with a smooth floor that reads a
/// texture of ones: what is matt of it is seen by light from all over the ceiling.
Scene make_room_of_a_smooth_floor(PrincipledScalar of_texture) {
    Scene scene = test::make_room();
    scene.max_depth = 3;
    scene.shapes[6] = {
        "panel", test::make_quad({-0.3f, 0.1f, 1.6f}, {0.5f, 0, 0}, {0, 0.5f, 0}), {3}, {0}};
    Bitmap ones;
    ones.width = ones.height = ones.channels = 1, ones.values = {1};
    scene.textures.push_back(ones);
    Principled floor;
    floor.base_color.constant = {0.8f, 0.8f, 0.8f};
    floor[PrincipledScalar::kRoughness].constant = 0.05f;
    floor.has_spec_trans = true;
    floor[of_texture].texture = {3};
    scene.bsdfs[0] = floor;
    scene.parameters = {{"floor", {3}}};
    return scene;
}

/// No path meets this floor twice: its image is linear in the texel.
TEST(Bounces, TexelsThatLeaveNoDiffuseLobeHaveTheDerivativesOfTheImage) {
    constexpr std::uint32_t kPasses = 1024;
    for (const PrincipledScalar s : {PrincipledScalar::kMetallic, PrincipledScalar::kSpecTrans}) {
        const Scene scene = make_room_of_a_smooth_floor(s);
        const TracedScene traced = prepare(scene);
        const auto image_sum = [&](float texel) {
            Theta theta = test::theta_of(scene);
            theta.textures[0].values.values = {texel};
            const Binding binding(traced, theta);
            const Image image =
                render(unknown_part(binding, {91, Stream::kTest}, kPasses), 0, kPasses);
            return std::accumulate(image.values.begin(), image.values.end(), 0.0);
        };
        const Theta theta = test::theta_of(scene);
        const GradientResult estimate = test::estimate_first(
            test::mc(kPasses), Binding(traced, theta), make_image(16, 16, 3, 1.0f), 92);
        const double slope = image_sum(1) - image_sum(0);
        ASSERT_LT(slope, 0);
        ASSERT_EQ(estimate.gradient.size(), 1u);
        // Bounds that any seed keeps.
        EXPECT_LT(double{estimate.gradient[0].g.x}, 0.5 * slope);
        EXPECT_GT(double{estimate.gradient[0].g.x}, 2 * slope);
    }
}

// ---- An integrating sphere, in closed form

/// What the identity shift says at the last of four iterations, under other textures before.
std::vector<test::RunningMean> slopes_of_kept_paths(const IntegratingSphere& form,
                                                    const Image& adjoint, std::uint32_t runs,
                                                    const test::Tamper& tamper) {
    test::Script script{form.scene, {}, std::vector<Image>(4, adjoint)};
    test::RandomSource random{68};
    for (int v = 0; v < 4; ++v) {
        script.theta.push_back(test::theta_of(form.scene));
        for (float& texel : script.theta.back().textures[0].values.values)
            if (v < 3) texel *= random.next(0.7f, 1.15f);
    }
    Reservoirs o = test::by_integrand(test::pgris());
    o.samples = 4, o.confidence_cap = 8;
    const test::Estimates all = test::sum_runs(
        test::runs_along(script, o, runs, seed_of(kIntegratingSphere, 2000), tamper));
    return {all.numbers[3].begin(), all.numbers[3].end() - test::kProjections};
}

TEST(IntegratingSphere, HasTheDerivativesOfItsSeriesInKeptPaths) {
    const IntegratingSphere form = make_integrating_sphere();
    const Image adjoint = test::make_adjoint(form.scene, 73, true);
    const auto p_value = [&](std::uint32_t runs, const test::Tamper& tamper) {
        return test::exact_p_value(
            slopes_of_kept_paths(form, adjoint, scaled(kIntegratingSphere, runs), tamper),
            exact_gradient(form, adjoint, true), kGridSlack);
    };
    EXPECT_TRUE(accepted(kIntegratingSphere, "derivatives by kept paths", p_value(800, {})));
    EXPECT_TRUE(rejected(kIntegratingSphere, "vertices of kept paths scatter twice",
                         p_value(200, test::scatter_twice)));
}

TEST(IntegratingSphere, ShowsAllOfItsBounces) {
    const IntegratingSphere form = make_integrating_sphere();
    const TracedScene traced = prepare(form.scene);
    const TextureTable textures{form.scene.textures, {}};
    std::vector<test::RunningMean> means(3 * form.shown.size());
    constexpr std::uint32_t kPasses = 64;
    for (std::uint32_t b = 0; b < scaled(kIntegratingSphere, 256u); ++b) {
        const TraceInput input{
            &traced, &textures,           {seed_of(kIntegratingSphere, b), Stream::kTest},
            kPasses, SurfaceChoice::kAll, {}};
        const Image image = render(input, 0, kPasses);
        for (std::size_t i = 0; i < means.size(); ++i) means[i].add(double{image.values[i]});
    }
    EXPECT_TRUE(accepted(kIntegratingSphere, "image",
                         test::exact_p_value(means, exact_image(form, kAllBounces), kGridSlack)));
    EXPECT_TRUE(rejected(kIntegratingSphere, "five bounces instead of all",
                         test::exact_p_value(means, exact_image(form, 5), kGridSlack)));
}

TEST(IntegratingSphere, HasTheDerivativesOfItsSeries) {
    const IntegratingSphere form = make_integrating_sphere();
    const TracedScene traced = prepare(form.scene);
    const Theta theta = test::theta_of(form.scene);
    const Binding binding(traced, theta);
    const Image adjoint = test::make_adjoint(form.scene, 73, true);
    std::vector<test::RunningMean> means(3 * form.share.size());
    for (std::uint32_t b = 0; b < scaled(kIntegratingSphere, 400u); ++b) {
        const auto estimate = test::estimate_first(test::mc(16), binding, adjoint,
                                                   seed_of(kIntegratingSphere, 1000 + b));
        const Image image = dense_gradient(theta, estimate.gradient)[0];
        for (std::size_t i = 0; i < means.size(); ++i) means[i].add(double{image.values[i]});
    }
    EXPECT_TRUE(
        accepted(kIntegratingSphere, "derivatives",
                 test::exact_p_value(means, exact_gradient(form, adjoint, true), kGridSlack)));
    EXPECT_TRUE(
        rejected(kIntegratingSphere, "derivatives without further vertices",
                 test::exact_p_value(means, exact_gradient(form, adjoint, false), kGridSlack)));
}

}  // namespace
}  // namespace burnish
