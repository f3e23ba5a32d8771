// The pool of records. Exact: packets of packed records give the images and gradients that plain
// floats do, one record at a time. Statistical: along a script of textures that no sample has
// moved, the gradient of a noisy image agrees with that of the baseline at every iteration, with a
// window that drops records and one that keeps them all.
#include "gradient/path_cache/path_cache.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "gradient/differentiate.h"
#include "optimize/loss.h"
#include "render/render.h"
#include "shading/diffuse.h"
#include "shading/principled.h"
#include "gradient/gradient_runs.h"
#include "gradient/small_scene.h"
#include "ledger_entries.h"

namespace burnish {
namespace {

using test::accepted;
using test::agreement_p_value;
using test::rejected;
using test::scaled;
using test::seed_of;
using test::ledger::kPool;

// ---- The slow twin

/// Calls body(record, taps) for every record of a bank, in plain floats.
template <class Body>
void for_records(const PoolInput& input, const Pool& pool, std::size_t which, const Body& body) {
    const Film& film = input.scene->scene->film;
    const RandomKey key{input.seed, which == 0 ? Stream::kPoolA : Stream::kPoolB};
    for (const RecordBatch& batch : pool.banks[which].batches) {
        const PassTaps taps = pass_taps(film.filter, key, batch.film_pass, 1, input.sequence);
        for (std::size_t t = 0; t < batch.tiles.size(); ++t)
            for (const RecordRun& run : batch.tiles[t].runs)
                for (std::uint32_t b = run.begin; b < run.end; ++b)
                    for (std::size_t lane = 0; lane < kLanes; ++lane) {
                        PathRecord r = unpack_record(batch.tiles[t].blocks[b], lane, run.bsdf,
                                                     pool.tiles[t].tile, film.crop_width);
                        r.film_pass = batch.film_pass;
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

Image plain_image(const PoolInput& input, const Pool& pool, std::size_t which) {
    const Scene& scene = *input.scene->scene;
    const TextureTable textures = texture_table(scene, *input.theta);
    Image image = make_image(scene.film.crop_width, scene.film.crop_height, 3);
    for_records(input, pool, which, [&](const PathRecord& r, const PassTaps& taps) {
        const Rgbf value = plain_value(scene, textures, r);
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
                   1 / static_cast<float>(pool.banks[which].batches.size()), image);
    return image;
}

std::vector<SplitGradient> plain_gradient(const PoolInput& input, const Pool& pool,
                                           const std::array<Image, 2>& adjoints) {
    const Scene& scene = *input.scene->scene;
    const TextureTable textures = texture_table(scene, *input.theta);
    const std::vector<int> slots = theta_slots(scene, *input.theta);
    std::vector<SplitGradient> sums;
    for (const ThetaTexture& t : input.theta->textures) {
        const Image zero = make_image(t.values.width, t.values.height, t.values.channels);
        sums.push_back({zero, zero});
    }
    for (std::size_t b = 0; b < 2; ++b) {
        const Image weights = normalized_adjoint(adjoints[1 - b], film_normalization(scene.film));
        const float share = 0.5f / static_cast<float>(pool.banks[b].batches.size());
        for_records(input, pool, b, [&](const PathRecord& r, const PassTaps& taps) {
            TexelDerivatives all;
            differentiate({&scene, &textures, slots, &weights, &taps, Target::kIntegrand}, r, all);
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

/// The small scene with other inputs optimised than usual.
struct Variant {
    const char* name;
    void (*change)(Scene& scene);
    std::vector<std::size_t> optimised;  ///< parameters
};

Principled& floor_of(Scene& scene) { return std::get<Principled>(scene.bsdfs[0]); }

const Variant kVariants[] = {
    {"base colour and roughness", [](Scene&) {}, {0, 1}},
    {"base colour alone", [](Scene&) {}, {0}},
    {"roughness alone, fixed base colour", [](Scene&) {}, {1}},
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

/// A contribution as plain floats have it, and the camera sample that it comes from.
struct PlainExtreme {
    Outlier named;
    std::size_t bank = 0;
    PathRecord record;
};

/// Of all records, at all texels; largest first.
std::vector<PlainExtreme> plain_extremes(const PoolInput& input, const Pool& pool,
                                         const std::array<Image, 2>& adjoints) {
    const Scene& scene = *input.scene->scene;
    const TextureTable textures = texture_table(scene, *input.theta);
    const std::vector<int> slots = theta_slots(scene, *input.theta);
    std::vector<PlainExtreme> all;
    for (std::size_t b = 0; b < 2; ++b) {
        const Image weights = normalized_adjoint(adjoints[1 - b], film_normalization(scene.film));
        for_records(input, pool, b, [&](const PathRecord& r, const PassTaps& taps) {
            TexelDerivatives touched;
            differentiate({&scene, &textures, slots, &weights, &taps, Target::kIntegrand}, r,
                          touched);
            for (int i = 0; i < touched.count; ++i) {
                const TexelDerivative& d = touched.items[static_cast<std::size_t>(i)];
                const float value = std::max({std::abs(d.g.x), std::abs(d.g.y), std::abs(d.g.z)});
                all.push_back({{value, r.pixel, d.key.slot, d.key.texel, {}}, b, r});
            }
        });
    }
    std::stable_sort(all.begin(), all.end(), [](const PlainExtreme& a, const PlainExtreme& b) {
        return a.named.value > b.named.value;
    });
    return all;
}

/// The technique of a record: its camera sample, traced again under the textures of its birth.
Technique technique_of(const PoolInput& birth, const PlainExtreme& outlier) {
    const Scene& scene = *birth.scene->scene;
    const TextureTable textures = texture_table(scene, *birth.theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, *birth.theta);
    const RandomKey key{birth.seed, outlier.bank == 0 ? Stream::kPoolA : Stream::kPoolB};
    const TraceInput trace{birth.scene, &textures, key,           1, SurfaceChoice::kUnknown,
                           unknowns,     true,      birth.sequence};
    const PathRecord& r = outlier.record;
    BatchOutput out;
    trace_batch(trace, std::vector<BatchSample>{{{r.pixel, r.film_pass, 0}}}, out);
    const auto distance = [&](const DirectSample& d) { return length(d.record.wo_local - r.wo_local); };
    const auto nearest =
        std::min_element(out.direct_samples.begin(), out.direct_samples.end(),
                         [&](const DirectSample& a, const DirectSample& b) { return distance(a) < distance(b); });
    EXPECT_LT(distance(*nearest), 1e-3f);
    return nearest->record.technique;
}

/// How often each technique was among the largest.
using TechniqueCounts = std::array<int, kTechniques>;

TechniqueCounts expect_plain_extremes(const PoolInput& input, const PoolInput& birth,
                                      const Pool& pool, const std::array<Image, 2>& adjoints) {
    const std::vector<PlainExtreme> plain = plain_extremes(input, pool, adjoints);
    TechniqueCounts counts{};
    EXPECT_EQ(pool.outliers.size(), kMaxOutliers);
    for (std::size_t k = 0; k < pool.outliers.size(); ++k) {
        const Outlier& e = pool.outliers[k];
        EXPECT_NEAR(e.value, plain[k].named.value, 1e-4f * e.value) << k;
        const auto same = std::find_if(plain.begin(), plain.end(), [&](const PlainExtreme& p) {
            return p.named.pixel == e.pixel && p.named.slot == e.slot && p.named.texel == e.texel &&
                   std::abs(p.named.value - e.value) < 1e-4f * e.value;
        });
        if (same == plain.end()) {
            ADD_FAILURE() << "contribution " << k << " is nowhere";
            continue;
        }
        EXPECT_EQ(e.technique, technique_of(birth, *same)) << k;
        ++counts[static_cast<std::size_t>(e.technique)];
    }
    return counts;
}

TechniqueCounts compare_with_plain_floats(const Variant& variant, Sequence sequence) {
    Scene scene = test::make_small_scene({.filter = FilterKind::kMitchell});
    scene.film = {53, 44, 5, 2, 43, 37, scene.film.filter};
    variant.change(scene);
    Theta theta;
    for (const std::size_t i : variant.optimised)
        theta.textures.push_back(test::theta_of(scene).textures[i]);
    const TracedScene traced = prepare(scene);
    const PoolInput input{&traced, &theta, 5, sequence};
    const Theta born = theta;
    Pool pool = make_pool(scene, theta);
    for (int k = 0; k < 5; ++k) trace_pass(input, pool, static_cast<std::size_t>(k % 2));
    for (ThetaTexture& t : theta.textures)  // shaded under other textures than at birth
        for (float& v : t.values.values) v = 0.9f * v + 0.03f;
    const std::array<Image, 2> adjoints{test::make_adjoint(scene, 51, true),
                                        test::make_adjoint(scene, 52, true)};
    const auto images = pool_images(input, pool).images;
    const auto gradient = pool_gradient(input, pool, adjoints);
    for (std::size_t b = 0; b < 2; ++b)
        EXPECT_LT(difference(images[b], plain_image(input, pool, b)), 3e-6) << variant.name;
    const auto expected = plain_gradient(input, pool, adjoints);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_LT(difference(gradient[i].first, expected[i].first), 2e-5) << variant.name;
        EXPECT_LT(difference(gradient[i].second, expected[i].second), 2e-5) << variant.name;
    }
    return expect_plain_extremes(input, {&traced, &born, 5, sequence}, pool, adjoints);
}

TEST(Pool, PacketsAgreeWithPlainFloats) {
    TechniqueCounts outliers{};
    for (const Variant& variant : kVariants)
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol}) {
            const TechniqueCounts more = compare_with_plain_floats(variant, sequence);
            for (std::size_t t = 0; t < more.size(); ++t) outliers[t] += more[t];
        }
    for (const int count : outliers) EXPECT_GT(count, 0) << "one technique is never the largest";
}

/// An empty pool of the small scene.
struct SmallPool {
    Scene scene = test::make_small_scene();
    Theta theta = test::theta_of(scene);
    TracedScene traced = prepare(scene);
    PoolInput input{&traced, &theta, 5};
    Pool pool = make_pool(scene, theta);
};

TEST(Pool, KeepsAWindowOfTheLastPasses) {
    SmallPool small;
    auto& [scene, theta, traced, input, pool] = small;
    for (int k = 0; k < 9; ++k) trace_pass(input, pool, static_cast<std::size_t>(k % 2));
    keep_window(pool, 3);
    for (std::size_t b = 0; b < 2; ++b) {
        ASSERT_EQ(pool.banks[b].batches.size(), 3u);
        EXPECT_EQ(pool.banks[b].batches[2].film_pass, b == 0 ? 4u : 3u);
    }
    const PoolSize size = pool_size(pool);
    EXPECT_GT(size.records, 500u);
    EXPECT_GT(size.bytes, 30 * size.records);
}

TEST(Pool, LeavesOutAndCountsWhatIsNotFinite) {
    SmallPool small;
    auto& [scene, theta, traced, input, pool] = small;
    trace_pass(input, pool, 0), trace_pass(input, pool, 1);
    EXPECT_EQ(pool_images(input, pool).rejected, 0u);
    RecordBlock& block = pool.banks[0].batches[0].tiles[0].blocks[0];
    block.radiance_over_pdf[1][0] = std::numeric_limits<float>::quiet_NaN();
    block.radiance_over_pdf[0][1] = std::numeric_limits<float>::infinity();
    const auto [images, rejected] = pool_images(input, pool);
    EXPECT_EQ(rejected, 2u);
    for (const float v : images[0].values) EXPECT_TRUE(std::isfinite(v));
    const std::array<Image, 2> adjoints{test::make_adjoint(scene, 51, true),
                                        test::make_adjoint(scene, 52, true)};
    for (const SplitGradient& g : pool_gradient(input, pool, adjoints))
        for (const float v : sum_of(g).values) EXPECT_TRUE(std::isfinite(v));
}

// ---- Unbiasedness

constexpr std::size_t kIterations = 6;

struct Script {
    Scene scene;
    std::vector<Theta> theta;  ///< one per iteration
    Image target;
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
Image static_part(const Script& script, const TracedScene& traced, const Theta& theta,
                  std::uint32_t seed, std::uint32_t passes) {
    const TextureTable textures = texture_table(script.scene, theta);
    const std::vector<char> unknowns = unknown_bsdfs(script.scene, theta);
    return render(
        {&traced, &textures, {seed, Stream::kImage}, passes, SurfaceChoice::kConstant, unknowns}, 0, 0,
        passes);
}

struct Follow {
    std::size_t window = 100;
    Sequence sequence = Sequence::kIndependent;
    // Seeded defects:
    bool own_adjoint = false;     ///< a bank's derivatives are weighed by its own image
    bool stale_textures = false;  ///< derivatives of the iteration before
    bool forgets_static = false;  ///< what is not optimised is left out of the image
};

test::Estimates follow(const Script& script, const Follow& how) {
    const TracedScene traced = prepare(script.scene);
    test::Runs runs(scaled(kPool, std::size_t{1500}));
    parallel_for(runs.size(), [&](std::size_t run) {
        const std::uint32_t seed = seed_of(kPool, static_cast<std::uint32_t>(run));
        const Image constant_inputs = static_part(script, traced, script.theta[0], seed, 2);
        Pool pool = make_pool(script.scene, script.theta[0]);
        for (std::size_t v = 0; v < kIterations; ++v) {
            const PoolInput input{&traced, &script.theta[v], seed, how.sequence};
            trace_pass(input, pool, v % 2);
            if (v == 0) trace_pass(input, pool, 1);
            keep_window(pool, how.window);
            auto images = pool_images(input, pool).images;
            std::array<Image, 2> adjoints;
            for (std::size_t b = 0; b < 2; ++b) {
                for (std::size_t i = 0; i < constant_inputs.values.size() && !how.forgets_static; ++i)
                    images[b].values[i] += constant_inputs.values[i];
                adjoints[how.own_adjoint ? 1 - b : b] = adjoint_of(script, images[b]);
            }
            if (how.stale_textures && v > 0)
                pool_images({&traced, &script.theta[v - 1], seed}, pool);
            runs[run].push_back(numbers_of(script.theta[v], pool_gradient(input, pool, adjoints)));
        }
    });
    return test::sum_runs(runs);
}

/// The baseline: an image and a derivative of 32 samples per pixel each.
test::Estimates follow_baseline(const Script& script) {
    const TracedScene traced = prepare(script.scene);
    test::Runs runs(scaled(kPool, std::size_t{200}));
    parallel_for(runs.size(), [&](std::size_t run) {
        const std::uint32_t seed = seed_of(kPool, 50000 + static_cast<std::uint32_t>(run));
        for (std::size_t v = 0; v < kIterations; ++v) {
            const TextureTable textures = texture_table(script.scene, script.theta[v]);
            const auto iteration = static_cast<std::uint32_t>(v);
            const Image image =
                render({&traced, &textures, {seed, Stream::kImage}, 32, SurfaceChoice::kAll, {}},
                       iteration, 0, 32);
            GradientOptions options;
            options.estimator = Estimator::kMc;
            options.samples_per_pixel = 32;
            options.seed = seed;
            runs[run].push_back(test::numbers_of(
                script.theta[v],
                estimate_gradient(traced, script.theta[v], adjoint_of(script, image), iteration,
                                  options, {})
                    .gradient));
        }
    });
    return test::sum_runs(runs);
}

TEST(Pool, AgreesWithTheBaselineAtEveryIterationOfAScript) {
    const Script script = make_script();
    const test::Estimates baseline = follow_baseline(script);
    for (const std::size_t window : {std::size_t{2}, std::size_t{100}})
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol})
            EXPECT_TRUE(
                accepted(kPool,
                         fmt::format("window {}, {}", window,
                                     sequence == Sequence::kSobol ? "sobol" : "independent"),
                         agreement_p_value(follow(script, {.window = window, .sequence = sequence}),
                                           baseline)));
    const auto defect = [&](const char* name, const Follow& how) {
        EXPECT_TRUE(rejected(kPool, name, agreement_p_value(follow(script, how), baseline)));
    };
    defect("adjoint of the bank's own image", {.own_adjoint = true});
    defect("derivatives at the textures before", {.stale_textures = true});
    defect("image without its static part", {.forgets_static = true});
}

}  // namespace
}  // namespace burnish
