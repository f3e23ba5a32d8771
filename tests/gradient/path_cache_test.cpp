// The path cache: packets of packed records give the images and gradients that plain floats do, one
// record at a time.
#include "gradient/path_cache/path_cache.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gradient/blends.h"
#include "gradient/differentiate.h"
#include "gradient/estimator.h"
#include "gradient/estimators.h"
#include "gradient/small_scene.h"
#include "images.h"
#include "optimize/strip_scene.h"
#include "render/unpacked_record.h"
#include "shading/diffuse.h"
#include "shading/principled.h"

namespace burnish {
namespace {

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
                            test::unpack_record(pass.tiles[t].blocks[b], lane, run.bsdf,
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
        EXPECT_LT(test::difference(images[b], plain_image(cached, b)), 3e-6) << name;
    const auto expected = plain_gradient(cached, adjoints);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_LT(test::difference(gradient[i].first, expected[i].first), 2e-5) << name;
        EXPECT_LT(test::difference(gradient[i].second, expected[i].second), 2e-5) << name;
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
            p.has_clearcoat = p.has_sheen = p.has_flatness = p.has_anisotropic = p.has_spec_trans =
                p.has_spec_tint = true;
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
    EstimatorWorkspace workspace =
        make_workspace(estimator, small.binding, reaching_pixels(small.binding));
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

TEST(PathCache, TracesNoPassThatItDoesNotKeep) {
    SmallCache small;
    std::array<EstimatorState, 2> states;
    for (std::size_t i = 0; i < 2; ++i) {
        const Estimator estimator = PathCache{.samples = i == 0 ? 4u : 10u, .window = 2};
        states[i] = make_state(estimator);
        EstimatorWorkspace workspace =
            make_workspace(estimator, small.binding, reaching_pixels(small.binding));
        for (std::uint32_t v = 0; v < 2; ++v)
            estimate_image(estimator, small.binding, {5, v}, states[i], workspace);
        for (const CacheHalf& half : std::get<PathCacheState>(states[i]).halves)
            EXPECT_EQ(half.passes_traced, 4u) << "two in each iteration";
    }
    EXPECT_EQ(std::get<PathCacheState>(states[0]), std::get<PathCacheState>(states[1]));
}

// ---- Caches of images alone

TEST(PathCache, ImagesAloneAreThoseOfImagesAndGradients) {
    const Scene scene = test::make_strip_scene(24, 4);  // every kind of unknown
    const Theta theta = test::theta_of(scene);
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    const PathCacheInput input{binding, 5};
    PathCacheWorkspace both = make_workspace(PathCache{}, binding),
                       alone = make_workspace(PathCache{}, binding, CacheUse::kImage);
    PathCacheState state;
    trace_passes(input, 5, both, state);
    EXPECT_EQ(shade(input, state, alone).images, shade(input, state, both).images);
    EXPECT_LT(size_of(state, alone).bytes, size_of(state, both).bytes);
    const auto planned = [&](CacheUse use) {
        return plan({}, binding, use, reaching_pixels(binding)).bytes_per_pass;
    };
    EXPECT_LT(planned(CacheUse::kImage), planned(CacheUse::kImageAndGradient));
}

/// One pixel in every tile: its records fill packets, and each tile has lists of its own.
TEST(PathCache, APlanCountsWhatSparsePixelsTake) {
    const Scene scene = test::make_strip_scene(256, 4);
    const Theta theta = test::theta_of(scene);
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    std::vector<char> reaching = reaching_pixels(binding);
    for (std::size_t i = 0; i < reaching.size(); ++i)
        if (i % kRecordTile != 16 || i / 256 % kRecordTile != 16) reaching[i] = 0;
    const PathCachePlan planned = plan({}, binding, CacheUse::kImageAndGradient, reaching);
    ASSERT_GT(planned.pixels, 20u);
    constexpr std::uint32_t kOfHalf = 3;
    PathCacheWorkspace workspace =
        make_workspace({}, binding, reaching, CacheUse::kImageAndGradient, kAllBands);
    PathCacheState state;
    trace_passes({binding, 5}, kOfHalf, workspace, state);
    shade({binding, 5}, state, workspace);
    const std::size_t taken = size_of(state, workspace).bytes;
    EXPECT_LE(taken, 2 * kOfHalf * planned.bytes_per_pass);
    EXPECT_GT(taken, 2 * kOfHalf * 4 * planned.pixels * bytes_per_record(binding.shaders[0]));
}

/// Parts whose weights alone are unknown have lists of records, too.
TEST(PathCache, APlanCountsPartsOfBlends) {
    for (const int side : {2, 4}) {
        Scene scene = test::make_small_scene_of_blends();
        scene.film = {side, side, 0, 0, side, side, {FilterKind::kBox, 0.5f}};
        const Theta all = test::theta_of(scene);
        const Theta weights{{all.textures[2], all.textures[3]}};
        const TracedScene traced = prepare(scene);
        const Binding binding(traced, weights);
        const std::vector<char> reaching = reaching_pixels(binding);
        const PathCachePlan planned = plan({}, binding, CacheUse::kImageAndGradient, reaching);
        PathCacheWorkspace workspace =
            make_workspace({}, binding, reaching, CacheUse::kImageAndGradient, kAllBands);
        PathCacheState state;
        trace_passes({binding, 5}, 3, workspace, state);
        shade({binding, 5}, state, workspace);
        EXPECT_LE(size_of(state, workspace).bytes, 2 * 3 * planned.bytes_per_pass) << side;
    }
}

/// An estimator that keeps the samples of its image has the image of a path cache, and derivatives
/// of its own.
TEST(PathCache, ServesTheImageOfOtherEstimators) {
    SmallCache small;
    PathCache cache{.samples = 3, .window = 2};
    Reservoirs fresh = test::pgris(), kept = fresh;
    kept.image_samples = cache.samples, kept.image_window = cache.window;
    std::array<Estimator, 3> estimators{cache, kept, fresh};
    std::array<EstimatorState, 3> states;
    std::array<EstimatorWorkspace, 3> workspaces;
    for (std::size_t e = 0; e < 3; ++e) {
        states[e] = make_state(estimators[e]);
        workspaces[e] =
            make_workspace(estimators[e], small.binding, reaching_pixels(small.binding));
    }
    const auto image = [&](std::size_t e, std::uint32_t v) {
        return estimate_image(estimators[e], small.binding, {5, v}, states[e], workspaces[e]);
    };
    const Image adjoint = test::make_adjoint(small.scene, 51, true);
    const auto gradient = [&](std::size_t e, std::uint32_t v) {
        return estimate_gradient(estimators[e], small.binding, {&adjoint, 1}, {5, v}, states[e],
                                 workspaces[e])
            .gradient[1]
            .first;
    };
    for (std::uint32_t v = 0; v < 4; ++v) {
        const ImageEstimate halves = image(0, v), own = image(1, v);
        ASSERT_EQ(own.images.size(), 1u);
        EXPECT_EQ(own.images[0], mean_of(halves.images[0], halves.images[1])) << v;
        EXPECT_NE(own.images[0], image(2, v).images[0]) << v;
        EXPECT_EQ(gradient(1, v), gradient(2, v)) << v;
    }
    EXPECT_EQ(std::get<ReservoirsState>(states[1]).image, std::get<PathCacheState>(states[0]));
}

}  // namespace
}  // namespace burnish
