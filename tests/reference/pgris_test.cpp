// The reservoirs of the fast code against the reference, with the same random numbers: along a
// script of textures and adjoints, the same paths are kept in the same reservoirs, and W, q and the
// gradient agree to rounding. So does the baseline.
#include <gtest/gtest.h>

#include "gradient/monte_carlo.h"
#include "gradient/reservoirs/reservoirs.h"
#include "gradient/small_scene.h"
#include "reference/compare.h"
#include "reference/layers.h"
#include "worst.h"

namespace burnish {
namespace {

using test::difference;

constexpr std::uint32_t kPgrisSeed = 6300;
/// Of q and the gradient: w(x) is summed in another order, and its terms differ in sign.
constexpr double kPgrisRounding = 3e-5;

/// What happens from outside: textures, and adjoints whose size and sign change.
struct Script {
    Scene scene;
    std::vector<reference::Integrand> iterations;
};

Script make_script(const Scene& scene, std::uint32_t iterations = 3) {
    Script script{scene, {}};
    const Image base = test::make_adjoint(scene, 6310, true),
                drift = test::make_adjoint(scene, 6311, true);
    test::RandomSource random{6312};
    for (std::uint32_t v = 0; v < iterations; ++v) {
        reference::Integrand integrand{test::theta_of(scene), base};
        for (ThetaTexture& t : integrand.pi.textures)
            for (float& x : t.values.values) x = clamp01(x + random.next(-0.06f, 0.06f));
        for (std::size_t k = 0; k < base.values.size(); ++k)
            integrand.adjoint.values[k] = (v % 2 ? -0.7f : 1.0f) * base.values[k] +
                                          0.3f * static_cast<float>(v) * drift.values[k];
        script.iterations.push_back(std::move(integrand));
    }
    return script;
}

/// The small scene with textures so fine that reservoirs are many.
Scene fine_scene() {
    Scene scene = test::make_small_scene({.filter = FilterKind::kBox, .filter_radius = 0.5f});
    scene.film = {32, 32, 0, 0, 32, 32, scene.film.filter};
    Bitmap base = test::make_bitmap(128, 3, TextureFilter::kBilinear, 0.3f, 0.8f, 6320);
    base.wrap = TextureWrap::kMirror;
    scene.textures = {base, test::make_bitmap(96, 1, TextureFilter::kBilinear, 0.35f, 0.7f, 6321)};
    return scene;
}

/// How the two sides differ after an iteration.
struct Differences {
    std::size_t reservoirs = 0;  ///< of the reference
    std::size_t others = 0;      ///< reservoirs that are not there, or hold another path
    double w_sum = 0;            ///< W |q| of the same reservoir, relative to the mean of all
    double gradient = 0;         ///< relative to its largest entry
    bool confidence = true;      ///< is the same
};

void compare_reservoirs(const History& fast, const reference::History& slow, Differences& d) {
    std::map<reference::Texel, std::vector<const HistorySample*>> by_texel;
    for (const HistorySample& s : fast.samples) by_texel[{s.key.slot, s.key.texel}].push_back(&s);
    std::size_t matched = 0;
    double worst = 0, sum = 0;
    for (const auto& [i, pair] : slow.rs)
        for (const reference::Reservoir& r : pair) {
            if (r.W == 0) continue;
            ++d.reservoirs;
            const auto& same_texel = by_texel[i];
            const auto same =
                std::find_if(same_texel.begin(), same_texel.end(), [&](const auto* s) {
                    return (s->q < 0) == (r.at_x.q < 0) && s->path == r.x.sample;
                });
            if (same == same_texel.end()) continue;
            ++matched;
            const double w_sum = double{(*same)->W} * std::abs(double{(*same)->q});
            worst = test::worse(worst, std::abs(w_sum - r.w_sum));
            sum += r.w_sum;
        }
    d.w_sum = worst * static_cast<double>(d.reservoirs) / sum;
    d.others += std::max(fast.samples.size(), d.reservoirs) - matched;
    d.confidence &= fast.confidence == slow.M;
}

Reservoirs fast_options(std::uint32_t m, bool reuse, Shift shift) {
    Reservoirs o;
    o.samples = m, o.adaptive_sampling = false, o.positivization = true, o.reuse = reuse;
    o.shift = shift, o.confidence_cap = 1.5f * static_cast<float>(m);
    return o;
}

/// The reference under the same options.
reference::Problem slow_problem(const TracedScene& traced, const Reservoirs& o) {
    return {traced,          {}, {}, {{kPgrisSeed, Stream::kDerivative}, o.samples}, o.shift,
            o.confidence_cap};
}

/// Changes what the reference reads before iteration v.
using Defect = void (*)(std::uint32_t v, reference::Problem& problem, reference::History& history);
void no_defect(std::uint32_t, reference::Problem&, reference::History&) {}

/// One entry per iteration.
std::vector<Differences> follow(const Script& script, const Reservoirs& options,
                                Defect defect = no_defect) {
    const TracedScene traced = prepare(script.scene);
    reference::Problem problem = slow_problem(traced, options);
    ReservoirsState state;
    reference::History history;
    std::vector<Differences> all;
    for (std::uint32_t v = 0; v < script.iterations.size(); ++v) {
        const reference::Integrand& now = script.iterations[v];
        const Binding binding(traced, now.pi);
        const auto fast = estimate_gradient(options, binding, now.adjoint, kPgrisSeed, v, state);
        defect(v, problem, history);
        if (!options.reuse) history = {};  // PRIS
        const auto slow = reference::reuse(
            problem, now, v, reference::generate_candidates(problem, now, v), history);
        Differences d;
        if (options.reuse) compare_reservoirs(state.history, history, d);
        d.gradient = difference(test::by_texel(fast.gradient), slow);
        all.push_back(d);
    }
    return all;
}

/// Whether both sides are one algorithm.
bool agrees(const std::vector<Differences>& all) {
    return std::all_of(all.begin(), all.end(), [](const Differences& d) {
        return d.others == 0 && d.confidence && d.w_sum < kPgrisRounding &&
               d.gradient < kPgrisRounding;
    });
}

void expect_agreement(const char* name, const std::vector<Differences>& all) {
    for (std::size_t v = 0; v < all.size(); ++v) {
        const Differences& d = all[v];
        EXPECT_EQ(d.others, 0u) << name << ", iteration " << v << ", of " << d.reservoirs;
        EXPECT_LT(d.w_sum, kPgrisRounding) << name << ", iteration " << v;
        EXPECT_LT(d.gradient, kPgrisRounding) << name << ", iteration " << v;
        EXPECT_TRUE(d.confidence) << name << ", iteration " << v;
    }
}

TEST(ReferencePgris, KeepsTheSamePathsWithTheSameWeights) {
    const Script script = make_script(test::make_small_scene());
    for (const std::uint32_t m : {1u, 3u})
        for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
            const auto all = follow(script, fast_options(m, true, shift));
            expect_agreement(shift == Shift::kReplay ? "replay" : "identity", all);
            for (const Differences& d : all) EXPECT_GT(d.reservoirs, 60u);
        }
}

TEST(ReferencePgris, KeepsTheSameOfManyReservoirs) {
    const Script script = make_script(fine_scene());
    for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
        const auto all = follow(script, fast_options(2, true, shift));
        expect_agreement(shift == Shift::kReplay ? "replay" : "identity", all);
        EXPECT_GT(all.back().reservoirs, 10000u);
    }
}

TEST(ReferencePgris, WithoutHistoryIsPris) {
    const Script script = make_script(test::make_small_scene());
    expect_agreement("pris", follow(script, fast_options(2, false, Shift::kReplay)));
}

TEST(ReferencePgris, DefectsAreSeen) {
    const Script script = make_script(test::make_small_scene());
    const auto is_seen = [&](Shift shift, Defect defect) {
        return !agrees(follow(script, fast_options(2, true, shift), defect));
    };
    using reference::History, reference::Problem;
    for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
        EXPECT_FALSE(is_seen(shift, no_defect));
        EXPECT_TRUE(is_seen(shift, [](std::uint32_t, Problem& p, History&) { p.M_cap = 1.5f; }));
        // Of the iteration before: today's textures in place of its own.
        EXPECT_TRUE(is_seen(shift, [](std::uint32_t, Problem&, History& h) {
            for (ThetaTexture& t : h.integrand.pi.textures)
                for (float& x : t.values.values) x = std::min(1.0f, 1.01f * x);
        }));
        EXPECT_TRUE(is_seen(shift, [](std::uint32_t, Problem&, History& h) {
            for (float& x : h.integrand.adjoint.values) x *= 1.01f;
        }));
        // One sign of the history is lost, or one texel of it.
        EXPECT_TRUE(is_seen(shift, [](std::uint32_t, Problem&, History& h) {
            for (auto& [i, pair] : h.rs) pair[1] = {};
        }));
        EXPECT_TRUE(is_seen(shift, [](std::uint32_t, Problem&, History& h) {
            if (!h.rs.empty()) h.rs.erase(std::prev(h.rs.end()));
        }));
        EXPECT_TRUE(is_seen(shift, [](std::uint32_t, Problem& p, History&) {
            p.shift = p.shift == Shift::kReplay ? Shift::kIdentity : Shift::kReplay;
        }));
        EXPECT_TRUE(is_seen(shift, [](std::uint32_t v, Problem&, History& h) {
            if (v > 0) h.M = static_cast<float>(v);  // counts what was hit
        }));
    }
}

/// The baseline of one iteration of the script, and of the reference under another adjoint.
double baseline_difference(const Script& script, float scale) {
    const TracedScene traced = prepare(script.scene);
    MonteCarlo options;
    options.samples = 3, options.adaptive_sampling = false;
    const reference::RandomStream stream{{kPgrisSeed, Stream::kDerivative}, options.samples};
    double worst = 0;
    for (std::uint32_t v = 0; v < script.iterations.size(); ++v) {
        const Binding binding(traced, script.iterations[v].pi);
        MonteCarloState state;
        const auto fast =
            estimate_gradient(options, binding, script.iterations[v].adjoint, kPgrisSeed, v, state);
        reference::Integrand now = script.iterations[v];
        now.adjoint.values[300] *= scale;
        worst = test::worse(worst, difference(test::by_texel(fast.gradient),
                                              test::monte_carlo(traced, now, stream, v)));
    }
    return worst;
}

TEST(ReferenceMonteCarlo, IsTheBaseline) {
    for (const Scene& scene : {test::make_small_scene(), fine_scene()}) {
        const Script script = make_script(scene);
        EXPECT_LT(baseline_difference(script, 1), kPgrisRounding);
    }
    for (const auto& [name, scene] : test::floors_of_unknown_weights())
        EXPECT_LT(baseline_difference(make_script(scene), 1), kPgrisRounding) << name;
    EXPECT_GT(baseline_difference(make_script(test::make_small_scene()), 1.05f), kPgrisRounding);
}

}  // namespace
}  // namespace burnish
