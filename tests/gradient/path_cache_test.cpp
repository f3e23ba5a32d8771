// The path cache. Exact: packets of packed records give the images and gradients that plain
// floats do, one record at a time. Statistical: along a script of textures that no sample has
// moved, the gradient of a noisy image agrees with that of the baseline at every iteration, with a
// window that drops records and one that keeps them all.
#include "gradient/path_cache/path_cache.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/parallel.h"
#include "gradient/differentiate.h"
#include "gradient/gradient_runs.h"
#include "gradient/small_scene.h"
#include "ledger_entries.h"
#include "optimize/loss.h"
#include "render/render.h"
#include "shading/diffuse.h"
#include "shading/principled.h"

namespace burnish {
namespace {

using test::accepted;
using test::agreement_p_value;
using test::rejected;
using test::scaled;
using test::seed_of;
using test::ledger::kPathCache;

// ---- The slow twin

/// A cache and what its stages read.
struct Cached {
    const PathCacheInput& input;
    const PathCacheState& state;
    const PathCacheWorkspace& workspace;
};

/// Calls body(record, taps) for every record of a half, in plain floats.
template <class Body>
void for_records(const Cached& cached, std::size_t which, const Body& body) {
    const Film& film = cached.input.binding.film();
    const RandomKey key{cached.input.seed, which == 0 ? Stream::kCacheA : Stream::kCacheB};
    for (const CachedPass& pass : cached.state.halves[which].passes) {
        const PassTaps taps = pass_taps(film.filter, key, pass.film_pass, 1, cached.input.sequence);
        for (std::size_t t = 0; t < pass.tiles.size(); ++t)
            for (const RecordRun& run : pass.tiles[t].runs)
                for (std::uint32_t b = run.begin; b < run.end; ++b)
                    for (std::size_t lane = 0; lane < kLanes; ++lane) {
                        PathRecord r =
                            unpack_record(pass.tiles[t].blocks[b], lane, run.bsdf,
                                          cached.workspace.tiles[t].tile, film.crop_width);
                        r.film_pass = pass.film_pass;
                        if (!is_black(r.radiance_over_pdf)) body(r, taps);
                    }
    }
}

PrincipledParameters<float> parameters_at(const TextureTable& textures, const Principled& bsdf,
                                          const Vec2f& uv) {
    PrincipledParameters<float> p;
    using enum PrincipledScalar;
    const auto scalar = [&](PrincipledScalar k) { return eval_scalar(textures, bsdf[k], uv); };
    p.base_color = eval_color(textures, bsdf.base_color, uv);
    p.roughness = scalar(kRoughness), p.anisotropic = scalar(kAnisotropic);
    p.metallic = scalar(kMetallic), p.spec_trans = scalar(kSpecTrans);
    p.spec_tint = scalar(kSpecTint), p.sheen = scalar(kSheen), p.sheen_tint = scalar(kSheenTint);
    p.flatness = scalar(kFlatness), p.clearcoat = scalar(kClearcoat);
    p.clearcoat_gloss = scalar(kClearcoatGloss);
    p.eta = bsdf.eta;
    return p;
}

Rgbf plain_value(const Scene& scene, const TextureTable& textures, const PathRecord& r) {
    if (const auto* diffuse = std::get_if<Diffuse>(&scene[r.bsdf]))
        return eval_diffuse(
                   DiffuseParameters<float>{eval_color(textures, diffuse->reflectance, r.uv)},
                   r.wi_local, r.wo_local) *
               r.radiance_over_pdf;
    const auto p = parameters_at(textures, std::get<Principled>(scene[r.bsdf]), r.uv);
    return eval_principled(p, r.wi_local, r.wo_local) * r.radiance_over_pdf;
}

Image plain_image(const Cached& cached, std::size_t which) {
    const Scene& scene = cached.input.binding.scene();
    Image image = make_image(scene.film.crop_width, scene.film.crop_height, 3);
    for_records(cached, which, [&](const PathRecord& r, const PassTaps& taps) {
        const Rgbf value = plain_value(scene, cached.input.binding.textures, r);
        const auto& [tx, ty] = taps[r.film_pass];
        const int x = static_cast<int>(r.pixel) % image.width,
                  y = static_cast<int>(r.pixel) / image.width;
        for (int j = -ty.halo; j <= ty.halo; ++j)
            for (int i = -tx.halo; i <= tx.halo; ++i) {
                if (x + i < 0 || x + i >= image.width || y + j < 0 || y + j >= image.height)
                    continue;
                const float w = tx.weight[static_cast<std::size_t>(i + tx.halo)] *
                                ty.weight[static_cast<std::size_t>(j + ty.halo)];
                for (int c = 0; c < 3; ++c) image.at(x + i, y + j, c) += value[c] * w;
            }
    });
    normalize_film(film_normalization(scene.film),
                   1 / static_cast<float>(cached.state.halves[which].passes.size()), image);
    return image;
}

std::vector<SplitGradient> plain_gradient(const Cached& cached,
                                          const std::array<Image, 2>& adjoints) {
    const Binding& binding = cached.input.binding;
    std::vector<SplitGradient> sums;
    for (const ThetaTexture& t : binding.theta.textures) {
        const Image zero = make_image(t.values.width, t.values.height, t.values.channels);
        sums.push_back({zero, zero});
    }
    for (std::size_t b = 0; b < 2; ++b) {
        const Image weights =
            normalized_adjoint(adjoints[1 - b], film_normalization(binding.film()));
        const float share = 0.5f / static_cast<float>(cached.state.halves[b].passes.size());
        for_records(cached, b, [&](const PathRecord& r, const PassTaps& taps) {
            TexelDerivatives all;
            differentiate({&binding, &weights, &taps, TargetFunction::kIntegrand}, r, all);
            for (int i = 0; i < all.count; ++i) {
                const TexelDerivative& d = all.items[static_cast<std::size_t>(i)];
                Image& image = b == 0 ? sums[d.key.slot].first : sums[d.key.slot].second;
                for (int c = 0; c < image.channels; ++c)
                    image.values[d.key.texel * static_cast<std::size_t>(image.channels) +
                                 static_cast<std::size_t>(c)] += d.g[c] * share;
            }
        });
    }
    return sums;
}

/// Largest difference of two images relative to the largest value.
double difference(const Image& a, const Image& b) {
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        worst = std::max(worst, std::abs(double{a.values[i]} - double{b.values[i]}));
        largest = std::max(largest, std::abs(double{b.values[i]}));
    }
    return worst / largest;
}

/// The small scene with other unknowns than usual.
struct Variant {
    const char* name;
    void (*change)(Scene& scene);
    std::vector<std::size_t> unknowns;  ///< parameters
};

Principled& floor_of(Scene& scene) { return std::get<Principled>(scene.bsdfs[0]); }

const Variant kVariants[] = {
    {"base colour and roughness", [](Scene&) {}, {0, 1}},
    {"base colour alone", [](Scene&) {}, {0}},
    {"roughness alone, constant base colour", [](Scene&) {}, {1}},
    {"tinted: the channels mix",
     [](Scene& s) {
         floor_of(s)[PrincipledScalar::kSpecTint].constant = 0.5f;
         floor_of(s).has_spec_tint = true;
     },
     {0, 1}},
    {"a colour texture read as a scalar, a gray one as a colour",
     [](Scene& s) {
         floor_of(s).base_color.texture = {1};
         floor_of(s)[PrincipledScalar::kRoughness].texture = {0};
     },
     {0, 1}},
    {"one texture for two inputs",
     [](Scene& s) { floor_of(s)[PrincipledScalar::kMetallic].texture = {1}; },
     {0, 1}},
    {"every lobe",
     [](Scene& s) {
         Principled& p = floor_of(s);
         p[PrincipledScalar::kClearcoat].constant = 0.7f;
         p[PrincipledScalar::kClearcoatGloss].constant = 0.4f;
         p[PrincipledScalar::kSheen].constant = 0.6f;
         p[PrincipledScalar::kFlatness].constant = 0.3f;
         p[PrincipledScalar::kAnisotropic].texture = {1};
         p[PrincipledScalar::kMetallic].constant = 0.3f;
         p[PrincipledScalar::kSpecTrans].constant = 0.4f;
         p.has_clearcoat = p.has_sheen = p.has_flatness = p.has_anisotropic = p.has_spec_trans =
             true;
     },
     {0, 1}},
    {"diffuse",
     [](Scene& s) {
         Diffuse diffuse;
         diffuse.reflectance.texture = {0};
         s.bsdfs[0] = diffuse;
     },
     {0}},
};

using Change = std::function<void(Scene& scene)>;

void compare_with_plain_floats(const char* name, const Change& change,
                               const std::vector<std::size_t>& unknowns, Sequence sequence) {
    Scene scene = test::make_small_scene({.filter = FilterKind::kMitchell});
    scene.film = {53, 44, 5, 2, 43, 37, scene.film.filter};
    change(scene);
    Theta theta;
    for (const std::size_t i : unknowns)
        theta.textures.push_back(test::theta_of(scene).textures[i]);
    const TracedScene traced = prepare(scene);
    const Binding when_traced(traced, theta);
    PathCacheState state;
    PathCacheWorkspace workspace = make_workspace(PathCache{}, when_traced);
    for (std::size_t k = 0; k < 5; ++k)
        trace_pass({when_traced, 5, sequence}, k % 2, workspace, state);
    Theta later = theta;  // shaded under other textures than traced
    for (ThetaTexture& t : later.textures)
        for (float& v : t.values.values) v = 0.9f * v + 0.03f;
    const Binding binding(traced, later);
    const PathCacheInput input{binding, 5, sequence};
    const Cached cached{input, state, workspace};
    const std::array<Image, 2> adjoints{test::make_adjoint(scene, 51, true),
                                        test::make_adjoint(scene, 52, true)};
    const auto images = shade(input, state, workspace).images;
    const auto gradient = accumulate(input, state, {&adjoints[0], &adjoints[1]}, workspace);
    for (std::size_t b = 0; b < 2; ++b)
        EXPECT_LT(difference(images[b], plain_image(cached, b)), 3e-6) << name;
    const auto expected = plain_gradient(cached, adjoints);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_LT(difference(gradient[i].first, expected[i].first), 2e-5) << name;
        EXPECT_LT(difference(gradient[i].second, expected[i].second), 2e-5) << name;
    }
}

TEST(PathCache, PacketsAgreeWithPlainFloats) {
    for (const Variant& variant : kVariants)
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol})
            compare_with_plain_floats(variant.name, variant.change, variant.unknowns, sequence);
}

/// Each scalar input as the only unknown, on a material that has every lobe.
TEST(PathCache, DerivativesByEachInputAloneAgreeWithPlainFloats) {
    for (int i = 0; i < kPrincipledScalars; ++i) {
        const auto change = [&](Scene& scene) {
            Principled& p = floor_of(scene);
            p.base_color.texture = {};
            p.base_color.constant = {0.6f, 0.4f, 0.7f};
            for (ScalarInput& scalar : p.scalars) scalar.texture = {}, scalar.constant = 0.45f;
            p.scalars[static_cast<std::size_t>(i)].texture = {1};
            p.has_metallic = p.has_clearcoat = p.has_sheen = p.has_flatness = p.has_anisotropic =
                p.has_spec_trans = p.has_spec_tint = true;
        };
        compare_with_plain_floats(fmt::format("scalar {}", i).c_str(), change, {1},
                                  Sequence::kSobol);
    }
}

/// An empty cache of the small scene.
struct SmallCache {
    Scene scene = test::make_small_scene();
    Theta theta = test::theta_of(scene);
    TracedScene traced = prepare(scene);
    Binding binding{traced, theta};
    PathCacheInput input{binding, 5, Sequence::kIndependent};
    PathCacheState state;
    PathCacheWorkspace workspace = make_workspace(PathCache{}, binding);
};

TEST(PathCache, KeepsAWindowOfTheLastPasses) {
    SmallCache small;
    for (std::size_t k = 0; k < 9; ++k)
        trace_pass(small.input, k % 2, small.workspace, small.state);
    keep_window(3, small.state);
    for (std::size_t b = 0; b < 2; ++b) {
        const auto& passes = small.state.halves[b].passes;
        ASSERT_EQ(passes.size(), 3u);
        EXPECT_EQ(passes[2].film_pass, b == 0 ? 4u : 3u);
    }
    const PathCacheSize size = size_of(small.state, small.workspace);
    EXPECT_GT(size.records, 500u);
    EXPECT_GT(size.bytes, 30 * size.records);
}

TEST(PathCache, LeavesOutAndCountsWhatIsNotFinite) {
    SmallCache small;
    auto& [scene, theta, traced, binding, input, state, workspace] = small;
    trace_pass(input, 0, workspace, state), trace_pass(input, 1, workspace, state);
    EXPECT_EQ(shade(input, state, workspace).rejected, 0u);
    RecordBlock& block = state.halves[0].passes[0].tiles[0].blocks[0];
    block.radiance_over_pdf[1][0] = std::numeric_limits<float>::quiet_NaN();
    block.radiance_over_pdf[0][1] = std::numeric_limits<float>::infinity();
    const auto [images, rejected] = shade(input, state, workspace);
    EXPECT_EQ(rejected, 2u);
    for (const float v : images[0].values) EXPECT_TRUE(std::isfinite(v));
    const std::array<Image, 2> adjoints{test::make_adjoint(scene, 51, true),
                                        test::make_adjoint(scene, 52, true)};
    for (const SplitGradient& g : accumulate(input, state, {&adjoints[0], &adjoints[1]}, workspace))
        for (const float v : sum_of(g).values) EXPECT_TRUE(std::isfinite(v));
}

/// What the two calls that advance any estimator make of the stages.
TEST(PathCache, IsAnEstimatorWhoseHalvesWeighEachOther) {
    SmallCache small;
    const PathCache options{.samples = 3, .window = 2, .sequence = Sequence::kIndependent};
    const Estimator estimator = options;
    EstimatorState state = make_state(estimator);
    EstimatorWorkspace workspace = make_workspace(estimator, small.binding);
    const std::vector<Image> adjoints{test::make_adjoint(small.scene, 51, true),
                                      test::make_adjoint(small.scene, 52, true)};
    for (std::uint32_t v = 0; v < 3; ++v) {
        trace_passes(small.input, 3, small.workspace, small.state);
        keep_window(2, small.state);
        const HalfImages images = shade(small.input, small.state, small.workspace);
        const auto& gradient =
            accumulate(small.input, small.state, {&adjoints[0], &adjoints[1]}, small.workspace);
        const ImageEstimate own =
            estimate_image(estimator, small.binding, {5, v}, state, workspace);
        ASSERT_EQ(own.images.size(), 2u);
        for (std::size_t b = 0; b < 2; ++b) EXPECT_EQ(own.images[b], images.images[b]) << v;
        const GradientEstimate estimate =
            estimate_gradient(estimator, small.binding, adjoints, {5, v}, state, workspace);
        ASSERT_EQ(estimate.gradient.size(), gradient.size());
        for (std::size_t t = 0; t < gradient.size(); ++t) {
            EXPECT_EQ(estimate.gradient[t].first, gradient[t].first) << v;
            EXPECT_EQ(estimate.gradient[t].second, gradient[t].second) << v;
        }
    }
    EXPECT_EQ(std::get<PathCacheState>(state), small.state);
}

// ---- Unbiasedness

constexpr std::size_t kIterations = 6;

struct Script {
    Scene scene;
    std::vector<Theta> theta;  ///< one per iteration
    Image target;
    test::Direction direction = {};
};

Script make_script() {
    Script script;
    script.scene = test::make_small_scene();
    test::RandomSource random{91};
    for (std::size_t v = 0; v < kIterations; ++v) {
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

Image adjoint_of(const Script& script, const Image& image) {
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
                  0, 0, passes);
}

/// The baseline: an image and a derivative of 32 samples per pixel each.
test::Runs baseline_runs(const Script& script, std::size_t count, std::uint32_t seeds) {
    const TracedScene traced = prepare(script.scene);
    test::Runs runs(count);
    parallel_for(runs.size(), [&](std::size_t run) {
        const std::uint32_t seed = seeds + static_cast<std::uint32_t>(run);
        for (std::size_t v = 0; v < kIterations; ++v) {
            const Binding binding(traced, script.theta[v]);
            const auto iteration = static_cast<std::uint32_t>(v);
            const Image image = render(
                {&traced, &binding.textures, {seed, Stream::kImage}, 32, SurfaceChoice::kAll, {}},
                iteration, 0, 32);
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
    // Seeded defects:
    bool own_adjoint = false;         ///< a half's derivatives are weighed by its own image
    bool stale_textures = false;      ///< derivatives of the iteration before
    bool forgets_background = false;  ///< what no unknown reaches is left out of the image
};

test::Estimates follow(const Script& script, const Follow& how) {
    const TracedScene traced = prepare(script.scene);
    test::Runs runs(scaled(kPathCache, how.runs));
    parallel_for(runs.size(), [&](std::size_t run) {
        const std::uint32_t seed = seed_of(kPathCache, static_cast<std::uint32_t>(run));
        const Image background = background_of(traced, script.theta[0], seed, 2);
        PathCacheState state;
        PathCacheWorkspace workspace =
            make_workspace(PathCache{}, Binding(traced, script.theta[0]));
        for (std::size_t v = 0; v < kIterations; ++v) {
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

TEST(PathCache, AgreesWithTheBaselineAtEveryIterationOfAScript) {
    Script script = make_script();
    script.direction = test::direction_of(baseline_runs(script, 8, 84000));
    const test::Estimates baseline = test::sum_runs(
        baseline_runs(script, scaled(kPathCache, std::size_t{200}), seed_of(kPathCache, 50000)),
        script.direction);
    for (const std::size_t window : {std::size_t{2}, std::size_t{100}})
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol})
            EXPECT_TRUE(
                accepted(kPathCache,
                         fmt::format("window {}, {}", window,
                                     sequence == Sequence::kSobol ? "sobol" : "independent"),
                         agreement_p_value(follow(script, {.window = window, .sequence = sequence}),
                                           baseline)));
    const auto defect = [&](const char* name, const Follow& how) {
        EXPECT_TRUE(rejected(kPathCache, name, agreement_p_value(follow(script, how), baseline)));
    };
    defect("adjoint of the half's own image", {.runs = 200, .own_adjoint = true});
    defect("derivatives at the textures before", {.runs = 200, .stale_textures = true});
    defect("image without its background", {.runs = 200, .forgets_background = true});
}

}  // namespace
}  // namespace burnish
