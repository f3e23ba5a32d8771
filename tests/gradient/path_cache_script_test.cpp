// The path cache along a script of textures that no sample has moved: the gradient of a noisy image
// agrees with that of the baseline at every iteration, with a window that drops records and one
// that keeps them all.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "gradient/gradient_runs.h"
#include "gradient/path_cache/path_cache.h"
#include "gradient/room.h"
#include "ledger_entries.h"
#include "optimize/loss.h"
#include "render/render.h"

namespace burnish {
namespace {

using test::accepted;
using test::agreement_p_value;
using test::rejected;
using test::scaled;
using test::seed_of;
using test::ledger::kBouncesInCache;
using test::ledger::kPathCache;

constexpr std::size_t kCacheIterations = 6;

struct TargetScript {
    Scene scene;
    std::vector<Theta> theta;  ///< one per iteration
    Image target;
    test::Direction direction = {};
};

TargetScript make_script(const Scene& scene) {
    TargetScript script;
    script.scene = scene;
    test::RandomSource random{91};
    for (std::size_t v = 0; v < kCacheIterations; ++v) {
        Theta theta = test::theta_of(script.scene);
        for (ThetaTexture& t : theta.textures)
            for (float& x : t.values.values)
                x = std::clamp(x + 0.08f * static_cast<float>(v) * random.next(-1, 1), 0.0f, 1.0f);
        script.theta.push_back(theta);
    }
    script.target = make_image(16, 16, 3);
    for (float& g : script.target.values) g = random.next(0.05f, 1.5f);
    return script;
}

Image adjoint_of(const TargetScript& script, const Image& image) {
    return evaluate_loss(Loss::kRelMse, image, script.target, {}).adjoint;
}

std::vector<double> numbers_of(const Theta& theta, const std::vector<SplitGradient>& gradient) {
    std::vector<TexelGradient> texels;
    for (std::uint32_t slot = 0; slot < gradient.size(); ++slot) {
        const Image image = sum_of(gradient[slot]);
        const auto channels = static_cast<std::uint32_t>(image.channels);
        for (std::uint32_t i = 0; i < image.values.size() / channels; ++i) {
            Rgbf g;
            for (std::uint32_t c = 0; c < channels; ++c)
                g[static_cast<int>(c)] = image.values[i * channels + c];
            texels.push_back({{slot, i}, g});
        }
    }
    return test::numbers_of(theta, texels);
}

/// The part of the image that does not depend on theta.
Image background_of(const TracedScene& traced, const Theta& theta, std::uint32_t seed,
                    std::uint32_t passes) {
    const Binding binding(traced, theta);
    return render({&traced,
                   &binding.textures,
                   {seed, Stream::kImage},
                   passes,
                   SurfaceChoice::kConstant,
                   binding.unknown_bsdfs},
                  0, passes);
}

/// The baseline: an image and a derivative of 32 samples per pixel each.
test::Runs baseline_runs(const TargetScript& script, std::size_t count, std::uint32_t seeds) {
    const TracedScene traced = prepare(script.scene);
    test::Runs runs(count);
    parallel_for(runs.size(), [&](std::size_t run) {
        const std::uint32_t seed = seeds + static_cast<std::uint32_t>(run);
        for (std::size_t v = 0; v < kCacheIterations; ++v) {
            const Binding binding(traced, script.theta[v]);
            const auto iteration = static_cast<std::uint32_t>(v);
            const Image image = render(
                {&traced, &binding.textures, {seed, Stream::kImage}, 32, SurfaceChoice::kAll, {}},
                iteration, 32);
            MonteCarloState state;
            const GradientResult result = estimate_gradient(
                test::mc(32), binding, adjoint_of(script, image), seed, iteration, state);
            runs[run].push_back(test::numbers_of(script.theta[v], result.gradient));
        }
    });
    return runs;
}

struct Follow {
    std::size_t runs = 1500;
    std::size_t window = 100;
    Sequence sequence = Sequence::kIndependent;
    LightSelection lights = LightSelection::kUniform;
    // Seeded defects:
    bool own_adjoint = false;         ///< a half's derivatives are weighed by its own image
    bool stale_textures = false;      ///< derivatives of the iteration before
    bool forgets_background = false;  ///< what no unknown reaches is left out of the image
};

test::Estimates follow(const test::LedgerEntry& entry, const TargetScript& script,
                       const Follow& how) {
    const TracedScene traced = prepare(script.scene, how.lights);
    test::Runs runs(scaled(entry, how.runs));
    parallel_for(runs.size(), [&](std::size_t run) {
        const std::uint32_t seed = seed_of(entry, static_cast<std::uint32_t>(run));
        const Image background = background_of(traced, script.theta[0], seed, 2);
        PathCacheState state;
        PathCacheWorkspace workspace =
            make_workspace(PathCache{}, Binding(traced, script.theta[0]));
        for (std::size_t v = 0; v < kCacheIterations; ++v) {
            const Binding binding(traced, script.theta[v]);
            const PathCacheInput input{binding, seed, how.sequence};
            trace_pass(input, v % 2, workspace, state);
            if (v == 0) trace_pass(input, 1, workspace, state);
            keep_window(how.window, state);
            auto images = shade(input, state, workspace).images;
            std::array<Image, 2> adjoints;
            for (std::size_t b = 0; b < 2; ++b) {
                for (std::size_t i = 0; i < background.values.size() && !how.forgets_background;
                     ++i)
                    images[b].values[i] += background.values[i];
                adjoints[how.own_adjoint ? 1 - b : b] = adjoint_of(script, images[b]);
            }
            if (how.stale_textures && v > 0) {
                const Binding before(traced, script.theta[v - 1]);
                shade({before, seed, how.sequence}, state, workspace);
            }
            runs[run].push_back(
                numbers_of(script.theta[v],
                           accumulate(input, state, {&adjoints[0], &adjoints[1]}, workspace)));
        }
    });
    return test::sum_runs(runs, script.direction);
}

/// The direction is that of other runs.
test::Estimates baseline_of(const test::LedgerEntry& entry, TargetScript& script) {
    script.direction = test::direction_of(baseline_runs(script, 8, 84000));
    return test::sum_runs(
        baseline_runs(script, scaled(entry, std::size_t{200}), seed_of(entry, 50000)),
        script.direction);
}

TEST(PathCache, AgreesWithTheBaselineAtEveryIterationOfAScript) {
    TargetScript script = make_script(test::make_small_scene());
    const test::Estimates baseline = baseline_of(kPathCache, script);
    for (const std::size_t window : {std::size_t{2}, std::size_t{100}})
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol})
            EXPECT_TRUE(
                accepted(kPathCache,
                         fmt::format("window {}, {}", window,
                                     sequence == Sequence::kSobol ? "sobol" : "independent"),
                         agreement_p_value(
                             follow(kPathCache, script, {.window = window, .sequence = sequence}),
                             baseline)));
    EXPECT_TRUE(accepted(
        kPathCache, "resampled lights",
        agreement_p_value(follow(kPathCache, script, {.lights = LightSelection::kResampled}),
                          baseline)));
    const auto defect = [&](const char* name, const Follow& how) {
        EXPECT_TRUE(rejected(kPathCache, name,
                             agreement_p_value(follow(kPathCache, script, how), baseline)));
    };
    defect("adjoint of the half's own image", {.runs = 200, .own_adjoint = true});
    defect("derivatives at the textures before", {.runs = 200, .stale_textures = true});
    defect("image without its background", {.runs = 200, .forgets_background = true});
}

TEST(PathCache, AgreesWithTheBaselineWhereLightBounces) {
    TargetScript script = make_script(test::make_room());
    const test::Estimates baseline = baseline_of(kBouncesInCache, script);
    for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol}) {
        const test::Estimates estimates =
            follow(kBouncesInCache, script, {.runs = 800, .sequence = sequence});
        EXPECT_TRUE(accepted(kBouncesInCache,
                             sequence == Sequence::kSobol ? "sobol" : "independent",
                             agreement_p_value(estimates, baseline)));
        EXPECT_TRUE(rejected(kBouncesInCache, "gradient 10 % larger",
                             agreement_p_value(test::larger_by(1.1, estimates), baseline)));
    }
    EXPECT_TRUE(rejected(
        kBouncesInCache, "adjoint of the half's own image, bounced",
        agreement_p_value(follow(kBouncesInCache, script, {.runs = 200, .own_adjoint = true}),
                          baseline)));
}

}  // namespace
}  // namespace burnish
