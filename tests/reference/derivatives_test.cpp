// The derivatives of the fast code against the reference, to rounding, for every kind of unknown:
// those of single records (gradient/differentiate.h), and those of the path cache's packets, from
// the same packed records.
#include <gtest/gtest.h>

#include "gradient/candidates.h"
#include "gradient/path_cache/path_cache.h"
#include "gradient/small_scene.h"
#include "reference/compare.h"
#include "reference/interfaces.h"
#include "reference/layers.h"
#include "render/unpacked_record.h"
#include "worst.h"

namespace burnish {
namespace {

using test::floor_of;

/// The small scene with other unknowns than usual.
struct Variant {
    std::string name;
    Scene scene;
    std::vector<std::size_t> unknowns;  ///< parameters of the scene
};

/// Every lobe, and no input that the others hide.
Scene rich_scene() {
    Scene scene = test::make_small_scene({.filter = FilterKind::kMitchell});
    Principled& p = floor_of(scene);
    const std::array<float, kPrincipledScalars> constants{0.4f, 0.5f, 0.4f, 0.3f, 0.5f,
                                                          0.6f, 0.3f, 0.3f, 0.7f, 0.4f};
    for (std::size_t k = 0; k < constants.size(); ++k) p.scalars[k] = {constants[k], {}};
    p.has_spec_trans = p.has_clearcoat = p.has_sheen = p.has_flatness = p.has_spec_tint =
        p.has_sheen_tint = p.has_anisotropic = true;
    return scene;
}

/// Each input of each kind of interface alone, and all of them.
void add_interfaces(std::vector<Variant>& variants) {
    for (const test::FloorKind& floor : test::interface_floors()) {
        Scene all = test::make_small_scene();
        all.bsdfs[0] = floor.bsdf;
        for (int input = 0; input < floor.unknown_inputs; ++input) {
            const int place = test::place_of(floor.bsdf, input);
            const bool is_color = color_at(floor.bsdf, place) != nullptr;
            const TextureId texture{is_color ? 0 : 1};
            Scene alone = test::make_small_scene();
            alone.bsdfs[0] = floor.bsdf;
            set_texture(alone.bsdfs[0], place, texture);
            set_texture(all.bsdfs[0], place, texture);
            variants.push_back({std::string(floor.name) + ", input " + std::to_string(input),
                                alone,
                                {static_cast<std::size_t>(texture.value)}});
        }
        const bool has_scalar = !scalars_of(floor.bsdf).empty();
        variants.push_back(
            {std::string(floor.name) + ", all inputs", all,
             has_scalar ? std::vector<std::size_t>{0, 1} : std::vector<std::size_t>{0}});
    }
}

std::vector<Variant> make_variants() {
    std::vector<Variant> variants;
    const auto add = [&](std::string name, Scene scene, std::vector<std::size_t> unknowns) {
        variants.push_back({std::move(name), std::move(scene), std::move(unknowns)});
    };
    add("base colour and roughness", test::make_small_scene(), {0, 1});
    add("base colour alone", test::make_small_scene(), {0});
    add("base colour alone, of every lobe", rich_scene(), {0});
    for (std::size_t k = 0; k < kPrincipledScalars; ++k) {
        Scene alone = rich_scene();
        floor_of(alone).scalars[k].texture = {1};
        add("scalar " + std::to_string(k) + " alone, of every lobe", alone, {1});
    }
    Scene metallic = test::make_small_scene();
    floor_of(metallic)[PrincipledScalar::kRoughness] = {0.4f, {}};
    floor_of(metallic)[PrincipledScalar::kMetallic].texture = {1};
    add("metallic alone", metallic, {1});
    Scene crossed = test::make_small_scene();
    floor_of(crossed).base_color.texture = {1};
    floor_of(crossed)[PrincipledScalar::kRoughness].texture = {0};
    add("a colour texture read as a scalar, a gray one as a colour", crossed, {0, 1});
    Scene shared = test::make_small_scene();
    floor_of(shared)[PrincipledScalar::kMetallic].texture = {1};
    add("one texture for two inputs", shared, {0, 1});
    Scene diffuse = test::make_small_scene();
    diffuse.bsdfs[0] = Diffuse{{{}, {0}}};
    add("diffuse", diffuse, {0});
    add_interfaces(variants);
    add("a blend", test::blended_floor(Diffuse{{{0.3f, 0.5f, 0.7f}, {}}}, true), {0, 1});
    add("a blend of two with unknowns", test::blended_floor(Diffuse{{{}, {0}}}, true), {0, 1});
    add("a normal map", test::turned_floor(), {0, 1});
    for (const auto& [name, scene] : test::floors_of_unknown_weights()) {
        add(name, scene,
            scene.parameters.size() > 3 ? std::vector<std::size_t>{0, 1, 2, 3}
                                        : std::vector<std::size_t>{0, 1, 2});
        add(std::string(name) + ", alone", scene, {2});
    }
    return variants;
}

Theta theta_of(const Variant& variant) {
    Theta theta;
    for (const std::size_t i : variant.unknowns)
        theta.textures.push_back(test::theta_of(variant.scene).textures[i]);
    return theta;
}

/// Shaded under other textures than traced.
Theta moved(Theta theta) {
    for (ThetaTexture& t : theta.textures)
        for (float& v : t.values.values) v = 0.9f * v + 0.03f;
    return theta;
}

const RandomKey kKey{6400, Stream::kDerivative};
constexpr std::uint32_t kPasses = 4;
/// w(x) is summed in another order, and its terms differ in sign.
constexpr double kRounding = 3e-5;

/// The largest difference of g and q, of any record at any texel, relative to their mean size.
double difference_of_records(const Variant& variant, float scale = 1) {
    const TracedScene traced = prepare(variant.scene);
    const Theta birth = theta_of(variant), theta = moved(birth);
    const Binding when_traced(traced, birth), binding(traced, theta);
    const reference::World world{traced, theta};
    const Film& film = variant.scene.film;
    const Image adjoint = test::make_adjoint(variant.scene, 6410, true);
    const Image normalized = normalized_adjoint(adjoint, film_normalization(film), scale);
    const PassTaps taps = pass_taps(film.filter, kKey, 0, kPasses);
    double worst = 0, sum = 0, count = 0;
    const TracedPaths traced_paths =
        trace_paths(unknown_derivatives(when_traced, kKey, kPasses), 0, kPasses);
    for (const TracedPath& p : traced_paths.paths) {
        TexelDerivatives fast;
        differentiate({&binding, &normalized, &taps, TargetFunction::kLuminance}, p.record, fast);
        auto slow = derivatives(
            world, adjoint, test::path_of(world, p.record, film_offset(kKey, p.record.film_pass)));
        EXPECT_EQ(slow.size(), static_cast<std::size_t>(fast.count)) << variant.name;
        for (std::size_t k = 0; k < static_cast<std::size_t>(fast.count); ++k) {
            const TexelDerivative& d = fast.items[k];
            const reference::Derivative& other = slow[{d.key.slot, d.key.texel}];
            worst = test::worse(test::worse(worst, double{length(d.g - other.g)}),
                                std::abs(double{d.q - other.q}));
            sum += double{length(other.g)}, ++count;
        }
    }
    EXPECT_GT(count, 500) << variant.name;
    return worst * count / sum;
}

TEST(ReferenceDerivatives, AreThoseOfRecords) {
    for (const Variant& variant : make_variants())
        EXPECT_LT(difference_of_records(variant), 20 * kRounding) << variant.name;
    EXPECT_GT(difference_of_records(make_variants()[0], 1.003f), 20 * kRounding);
}

/// The gradient of a half of the cache, from its packed records.
reference::Gradient gradient_of_half(const PathCacheInput& input, const PathCacheState& state,
                                     const PathCacheWorkspace& workspace, std::size_t half,
                                     const Image& adjoint) {
    const Binding& binding = input.binding;
    const reference::World world{binding.traced, binding.theta};
    reference::Gradient gradient;
    const auto& passes = state.halves[half].passes;
    const float share = 0.5f / static_cast<float>(passes.size());
    for (const CachedPass& pass : passes) {
        const Vec2f film = film_offset(half_key(input, half), pass.film_pass, input.sequence);
        for (std::size_t t = 0; t < pass.tiles.size(); ++t)
            for (const RecordRun& run : pass.tiles[t].runs)
                for (std::size_t i = kLanes * run.begin; i < kLanes * run.end; ++i) {
                    const PathRecord r =
                        test::unpack_record(pass.tiles[t].blocks[i / kLanes], i % kLanes, run.bsdf,
                                            workspace.tiles[t].tile, binding.film().crop_width);
                    for (const auto& [texel, d] :
                         derivatives(world, adjoint, test::path_of(world, r, film)))
                        gradient[texel] += d.g * share;
                }
    }
    return gradient;
}

reference::Gradient by_texel(const std::vector<SplitGradient>& gradient, std::size_t half) {
    reference::Gradient all;
    for (std::uint32_t t = 0; t < gradient.size(); ++t) {
        const Image& image = half == 0 ? gradient[t].first : gradient[t].second;
        for (std::size_t k = 0; k < image.values.size(); ++k) {
            const auto channels = static_cast<std::size_t>(image.channels);
            all[{t, static_cast<std::uint32_t>(k / channels)}][static_cast<int>(k % channels)] =
                image.values[k];
        }
    }
    return all;
}

/// The largest difference over both halves. own: each half weighed by its own image's adjoint.
double difference_of_cache(const Variant& variant, Sequence sequence, bool own = false) {
    const TracedScene traced = prepare(variant.scene);
    const Theta birth = theta_of(variant), theta = moved(birth);
    const Binding when_traced(traced, birth), binding(traced, theta);
    PathCacheState state;
    PathCacheWorkspace workspace = make_workspace(PathCache{}, when_traced);
    for (std::size_t k = 0; k < 5; ++k)
        trace_pass({when_traced, 6420, sequence}, k % 2, workspace, state);
    const PathCacheInput input{binding, 6420, sequence};
    const std::array<Image, 2> adjoints{test::make_adjoint(variant.scene, 6421, true),
                                        test::make_adjoint(variant.scene, 6422, true)};
    shade(input, state, workspace);
    const auto& fast = accumulate(input, state, {&adjoints[0], &adjoints[1]}, workspace);
    double worst = 0;
    for (std::size_t half = 0; half < 2; ++half)
        worst =
            test::worse(worst, test::difference(by_texel(fast, half),
                                                gradient_of_half(input, state, workspace, half,
                                                                 adjoints[own ? half : 1 - half])));
    return worst;
}

TEST(ReferenceDerivatives, AreThoseOfThePathCache) {
    for (const Variant& variant : make_variants())
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol})
            EXPECT_LT(difference_of_cache(variant, sequence), kRounding) << variant.name;
    EXPECT_GT(difference_of_cache(make_variants()[0], Sequence::kSobol, true), kRounding);
}

}  // namespace
}  // namespace burnish
