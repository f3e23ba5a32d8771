// What reservoirs keep from one iteration to the next, exactly: confidence, signs, every texel, and
// the integrand of the iteration before.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "gradient/estimators.h"
#include "gradient/small_scene.h"
#include "optimize/strip_scene.h"
#include "render/film.h"
#include "shading/rough_plastic.h"

namespace burnish {
namespace {

using test::by_integrand;
using test::gris;
using test::make_adjoint;
using test::pgris;
using test::theta_of;

/// A scene whose textures and adjoint stay as they are.
struct Frozen {
    Scene scene;
    Theta theta = theta_of(scene);
    TracedScene traced = prepare(scene);
    Binding binding{traced, theta};
    Image adjoint = make_adjoint(scene, 61, true);

    explicit Frozen(Scene s = test::make_small_scene()) : scene(std::move(s)) {}

    /// The state after so many iterations.
    ReservoirsState after(const Reservoirs& options, std::uint32_t iterations) const {
        ReservoirsState state;
        for (std::uint32_t v = 0; v < iterations; ++v)
            estimate_gradient(options, binding, adjoint, 3, v, state);
        return state;
    }
};

std::map<TexelKey, std::vector<HistorySample>> by_texel(const History& history) {
    std::map<TexelKey, std::vector<HistorySample>> texels;
    for (const HistorySample& s : history.samples) texels[s.key].push_back(s);
    return texels;
}

TEST(History, ConfidenceGrowsByEachIterationsSamplesUpToTheCap) {
    const Frozen frozen;
    Reservoirs options = by_integrand(pgris());
    options.samples = 2, options.confidence_cap = 7;
    const float expected[] = {2, 4, 6, 8, 9, 9};
    for (std::uint32_t v = 0; v < 6; ++v)
        EXPECT_EQ(frozen.after(options, v + 1).history.confidence, expected[v]) << v;
}

TEST(History, HoldsASampleOfEachSignWherePositivised) {
    const Frozen frozen;
    std::size_t both = 0;
    for (const auto& [key, samples] : by_texel(frozen.after(by_integrand(pgris()), 4).history)) {
        ASSERT_LE(samples.size(), 2u);
        if (samples.size() < 2) continue;
        ++both;
        EXPECT_LT(samples[0].q * samples[1].q, 0.0f);
    }
    EXPECT_GT(both, 20u);
    for (const auto& [key, samples] : by_texel(frozen.after(by_integrand(gris()), 4).history))
        EXPECT_EQ(samples.size(), 1u);
}

/// Whether paths traced under some textures are replayed as they were when one of them changes.
bool is_replayed_as_it_was(const Scene& scene, std::size_t changed) {
    const TracedScene traced = prepare(scene);
    const auto input_under = [&](const Binding& binding) {
        return unknown_derivatives(binding, {79, Stream::kDerivative}, 16);
    };
    const Theta theta = theta_of(scene);
    const Binding born(traced, theta);
    const auto paths = trace_paths(input_under(born), 0, 16).paths;
    EXPECT_GT(paths.size(), 5000u);
    std::vector<PathSample> names;
    for (const TracedPath& p : paths) names.push_back(p.path);

    Theta other = theta;
    for (float& v : other.textures[changed].values.values) v = 1.2f * v - 0.1f;
    const Binding later(traced, other);
    std::size_t rejected = 0;
    const auto records = trace_again(input_under(later), names, rejected);
    return std::equal(records.begin(), records.end(), paths.begin(), paths.end(),
                      [](const PathRecord& r, const TracedPath& p) { return r == p.record; });
}

TEST(History, IsReplayedAsItWasWhereNoUnknownDrawsPaths) {
    const Scene scene = test::make_strip_scene(24, 4);
    const std::set<std::string> fixed{"base_color", "reflectance"};
    for (std::size_t i = 0; i < scene.parameters.size(); ++i) {
        const auto& [name, texture] = scene.parameters[i];
        EXPECT_EQ(draws_paths(scene, texture), fixed.count(name) == 0) << name;
        if (name == "spec_tint") continue;  // draws nothing, but is a scalar: it counts as one
        EXPECT_EQ(is_replayed_as_it_was(scene, i), !draws_paths(scene, texture)) << name;
    }
}

/// Plastics weigh their lobes by their colours, other kinds do not.
TEST(History, OfColorsIsReplayedAsItWasButOnPlastic) {
    const ColorInput textured{{}, {0}};
    RoughPlastic rough;
    rough.colors[0] = textured, rough.alpha = 0.2f, rough.eta = 1.5f;
    rough = make_rough_plastic(rough);
    Plastic plastic;
    plastic.colors[0] = textured, plastic.eta = 1.5f;
    RoughConductor metal;
    metal.reflectance = textured;
    RoughDielectric glass;
    glass.colors[0] = textured, glass.eta = 1.5f;
    PrincipledThin thin;
    thin.base_color = textured;
    Diffuse diffuse{textured};
    for (const Bsdf& bsdf :
         {Bsdf(rough), Bsdf(plastic), Bsdf(metal), Bsdf(glass), Bsdf(thin), Bsdf(diffuse)}) {
        Scene scene = test::make_small_scene();
        scene.film = {48, 48, 0, 0, 48, 48, scene.film.filter};
        scene.bsdfs[0] = bsdf;
        scene.parameters = {{"color", {0}}};
        EXPECT_EQ(is_replayed_as_it_was(scene, 0), !draws_paths(scene, {0})) << bsdf.index();
    }
}

/// The small scene with more texels than a range of parallel work takes.
Scene make_fine_scene() {
    Scene scene = test::make_small_scene();
    scene.film = {128, 128, 0, 0, 128, 128, scene.film.filter};
    scene.textures[1] = test::make_bitmap(256, 1, TextureFilter::kNearest, 0.35f, 0.7f, 62);
    return scene;
}

TEST(History, OfNoTexelIsLostWhileNothingChanges) {
    const Frozen frozen(make_fine_scene());
    for (const Reservoirs& options : {by_integrand(pgris()), by_integrand(gris())}) {
        const auto before = by_texel(frozen.after(options, 2).history);
        const auto after = by_texel(frozen.after(options, 3).history);
        ASSERT_GT(before.size(), 10000u);
        std::size_t lost = 0;
        for (const auto& [key, samples] : before) lost += after.count(key) == 0;
        EXPECT_EQ(lost, 0u);
        EXPECT_GT(after.size(), before.size() + 100) << "fresh texels join";
    }
}

/// Without samples of the history a fresh one is merged alone, W' = m_current W, where m_current
/// [PR eq. 13] tells under which textures and adjoint q_{v-1} was evaluated.
TEST(History, WeighsFreshSamplesByTheIntegrandOfTheIterationBefore) {
    const Frozen frozen;
    Theta theta_before = frozen.theta;
    for (ThetaTexture& t : theta_before.textures)
        for (float& v : t.values.values) v = 1 - v;
    const Binding before(frozen.traced, theta_before);
    const Image adjoint_before = normalized_adjoint(make_adjoint(frozen.scene, 62, true),
                                                    film_normalization(frozen.scene.film));
    constexpr std::uint32_t kSeed = 5, kIteration = 1;
    constexpr float kHistory = 4;
    const PassTaps taps =
        pass_taps(frozen.scene.film.filter, {kSeed, Stream::kDerivative}, kIteration, 1);
    const DerivativeInput input{&before, &adjoint_before, &taps, TargetFunction::kIntegrand};

    const Reservoirs options = by_integrand(pgris());
    ReservoirsState alone, merged;
    merged.history = {{}, kHistory, theta_before, adjoint_before};
    estimate_gradient(options, frozen.binding, frozen.adjoint, kSeed, kIteration, alone);
    estimate_gradient(options, frozen.binding, frozen.adjoint, kSeed, kIteration, merged);
    ASSERT_EQ(alone.history.samples.size(), merged.history.samples.size());
    ASSERT_GT(alone.history.samples.size(), 50u);
    double largest = 0;
    for (std::size_t i = 0; i < alone.history.samples.size(); ++i) {
        const HistorySample &a = alone.history.samples[i], &m = merged.history.samples[i];
        ASSERT_EQ(a.key, m.key);
        const double q = std::abs(double{a.q}),
                     q_before = std::abs(double{differentiate_at(input, a.record, a.key).q});
        const double weight = q / (q + double{kHistory} * q_before);
        EXPECT_NEAR(double{m.W}, weight * double{a.W}, 1e-4 * double{a.W});
        // The same under today's textures: the comparison tells them apart.
        const DerivativeInput today{&frozen.binding, &adjoint_before, &taps,
                                    TargetFunction::kIntegrand};
        const double q_today = std::abs(double{differentiate_at(today, a.record, a.key).q});
        largest = std::max(largest, std::abs(q / (q + double{kHistory} * q_today) - weight));
    }
    EXPECT_GT(largest, 0.01);
}

}  // namespace
}  // namespace burnish
