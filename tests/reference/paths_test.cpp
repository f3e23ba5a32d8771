// The batches of paths/trace.h against the reference, which follows one path at a time in plain
// floats: the same paths and values, bit by bit.
#include <gtest/gtest.h>

#include <set>
#include <variant>

#include "core/sobol.h"
#include "gradient/binding.h"
#include "paths/lamps.h"
#include "reference/compare.h"
#include "reference/interfaces.h"
#include "reference/layers.h"
#include "worst.h"

namespace burnish {
namespace {

using test::floor_of;

/// The textures of the scene itself: no unknowns.
const Theta kNoUnknowns;

struct Numbering {
    RandomKey key{77, Stream::kTest};
    Sequence sequence = Sequence::kIndependent;
};
constexpr std::uint32_t kPathPasses = 8, kPathIteration = 3;

reference::Numbers numbers_of(const Numbering& n, const PathSample& sample) {
    if (n.sequence == Sequence::kIndependent)
        return reference::numbers_of({n.key, kPathPasses}, sample);
    const std::uint32_t pass = film_pass(sample.camera, kPathPasses);
    return {film_offset(n.key, pass, n.sequence),
            sobol_uniforms(n.key, sample.camera.pixel, pass,
                           static_cast<std::uint32_t>(sample.technique)),
            sobol_fifth(n.key, sample.camera.pixel, pass, 0)};
}

/// exact: as they are; else the factors of a path are multiplied in another order.
bool is_equal(const Rgbf& a, const Rgbf& b, bool exact) {
    constexpr float kReordered = 3e-7f;
    return a == b || (!exact && length(a - b) <= kReordered * length(b));
}

bool is_the_same(const reference::World& world, const PathRecord& fast,
                 const reference::Path& slow) {
    const auto value = [&] { return contribution(world, test::path_of(world, fast, slow.film)); };
    return fast.bsdf == slow.bsdf && fast.uv == slow.uv && fast.wi_local == slow.wi &&
           fast.wo_local == slow.wo &&
           (test::is_within_light(world, fast.bsdf)
                ? is_equal(value(), contribution(world, slow), false)
                : fast.radiance_over_pdf == slow.light);
}

struct Comparison {
    int values = 0;     ///< not black
    int different = 0;  ///< values, paths, sums of both techniques
};

/// One pass of a 16 x 16 film.
void compare_pass(const TraceInput& input, const reference::World& world,
                  const Numbering& numbering, std::uint32_t pass, Comparison& c) {
    std::vector<BatchSample> samples(256);
    for (std::uint32_t j = 0; j < 256; ++j) samples[j].camera = {j, kPathIteration, pass};
    BatchOutput out;
    trace_batch(input, samples, out);
    EXPECT_EQ(out.rejected, 0u);
    std::vector<Rgbf> radiance(256);
    EXPECT_EQ(trace_radiance(input, samples, radiance), 0u);
    std::array<std::vector<const DirectSample*>, 2> fast;
    fast.fill(std::vector<const DirectSample*>(256, nullptr));
    for (const DirectSample& d : out.direct_samples)
        fast[static_cast<std::size_t>(d.record.technique)][static_cast<std::size_t>(d.sample)] = &d;
    for (std::size_t j = 0; j < 256; ++j) {
        Rgbf sum;
        bool all_exact = true;
        for (const Technique technique : {Technique::kEmitter, Technique::kBsdf}) {
            const PathSample sample{samples[j].camera, technique};
            const auto x = reference::make_path(world, sample, numbers_of(numbering, sample));
            const Rgbf value = reference::contribution(world, x);
            const DirectSample* d = fast[static_cast<std::size_t>(technique)][j];
            c.values += !is_black(value);
            const bool is_exact = !x.bsdf || !test::is_within_light(world, x.bsdf);
            all_exact &= is_exact;
            c.different +=
                d ? !(is_equal(d->value, value, is_exact) && is_the_same(world, d->record, x))
                  : !is_black(value);
            if (technique == Technique::kEmitter) {
                c.different += !(out.emitted[j] == x.seen);
                sum = x.seen;
            }
            sum += value;
        }
        c.different += !is_equal(radiance[j], sum, all_exact);
    }
}

/// traced, traced_slow: views that are meant to be the same.
Comparison compare(const TracedScene& traced, const TracedScene& traced_slow,
                   const Numbering& numbering = {}) {
    const TextureTable textures{traced.scene->textures, {}};
    const TraceInput input{&traced, &textures, numbering.key,     kPathPasses, SurfaceChoice::kAll,
                           {},      false,     numbering.sequence};
    const reference::World world{traced_slow, kNoUnknowns};
    Comparison c;
    for (std::uint32_t pass = 0; pass < kPathPasses; ++pass)
        compare_pass(input, world, numbering, pass, c);
    return c;
}

Comparison compare(const Scene& fast, const Scene& slow, const Numbering& numbering = {},
                   LightSelection selection = LightSelection::kUniform) {
    return compare(prepare(fast, selection), prepare(slow, selection), numbering);
}

void expect_same(const Scene& scene, const char* what, const Numbering& numbering = {},
                 LightSelection selection = LightSelection::kUniform) {
    const Comparison c = compare(scene, scene, numbering, selection);
    EXPECT_GT(c.values, 1000) << what;
    EXPECT_EQ(c.different, 0) << what;
}

/// The small scene through lenses, of which the second one does not see the corners of its film.
TEST(ReferencePaths, ThroughLensesAreThoseOfTheBatches) {
    const Scene scene = test::make_small_scene();
    const TracedScene straight = prepare(scene);
    Camera camera{16, 16, 24, 25, 8.5, 7.5};
    const Transform& m = scene.camera.to_world;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            camera.camera_to_world[static_cast<std::size_t>(4 * row + column)] =
                (column < 2 ? -1 : 1) * m(row, column);
    for (const Lens& lens : {Lens{LensKind::kBrownConrady, {-0.2, 0.05, 0.02, -0.03}},
                             Lens{LensKind::kFisheye, {-1.4}}}) {
        camera.lens = lens;
        const TracedScene bent =
            with_camera(straight, make_camera_rays(camera, 0.01f, 1000), scene.film);
        const Comparison c = compare(bent, bent);
        EXPECT_GT(c.values, 1000);
        EXPECT_EQ(c.different, 0);
        EXPECT_GT(compare(bent, straight).different, 1000) << "other rays are noticed";
    }
}

TEST(ReferencePaths, AreThoseOfTheBatchesBitByBit) {
    Scene scene = test::make_small_scene();
    expect_same(scene, "small scene");
    expect_same(scene, "Sobol's numbers", {.sequence = Sequence::kSobol});
    floor_of(scene).specular_rate = 2.5f, floor_of(scene).diffuse_rate = 0.5f;
    expect_same(scene, "sampling rates");
    scene.film = {40, 50, 17, 20, 16, 16, scene.film.filter};
    scene.camera.fov_x = 90;
    expect_same(scene, "cropped film");
    scene.hide_emitters = true;
    expect_same(scene, "hidden emitters");
    for (const LightSelection selection : test::kSelections)
        expect_same(test::make_lamps(), "lamps", {}, selection);
    expect_same(scene, "a candidate of each light", {}, LightSelection::kResampled);
    expect_same(scene, "Sobol's numbers for candidates", {.sequence = Sequence::kSobol},
                LightSelection::kResampled);
}

TEST(ReferencePaths, AreThoseOfTheBatchesForEveryLobe) {
    Scene scene = test::make_small_scene();
    Principled& p = floor_of(scene);
    p[PrincipledScalar::kClearcoat].constant = 0.7f;
    p[PrincipledScalar::kClearcoatGloss].constant = 0.4f;
    p[PrincipledScalar::kSheen].constant = 0.6f;
    p[PrincipledScalar::kSheenTint].constant = 0.2f;
    p[PrincipledScalar::kSpecTint].constant = 0.5f;
    p[PrincipledScalar::kFlatness].constant = 0.3f;
    p[PrincipledScalar::kAnisotropic].texture = {1};
    p.has_clearcoat = p.has_sheen = p.has_sheen_tint = p.has_flatness = p.has_anisotropic =
        p.has_spec_tint = true;
    expect_same(scene, "all that reflects");
    p[PrincipledScalar::kSpecTrans].constant = 0.4f;
    p[PrincipledScalar::kMetallic].constant = 0.2f;
    p.has_spec_trans = true;
    expect_same(scene, "glass, two-sided");
    scene.materials[0].back = {};
    expect_same(scene, "glass");
    Diffuse diffuse;
    diffuse.reflectance.texture = {0};
    scene.bsdfs[0] = diffuse;
    expect_same(scene, "diffuse");
}

std::vector<test::FloorKind> all_floors() {
    auto floors = test::interface_floors();
    const auto smooth = test::smooth_floors();
    floors.insert(floors.end(), smooth.begin(), smooth.end());
    return floors;
}

/// Diffuse and principled ones have tests of their own.
TEST(InterfaceFloors, HaveEveryKind) {
    std::set<std::size_t> kinds{Bsdf(Diffuse{}).index(), Bsdf(Principled{}).index()};
    for (const test::FloorKind& floor : all_floors()) kinds.insert(floor.bsdf.index());
    EXPECT_EQ(kinds.size(), std::variant_size_v<Bsdf>);
}

TEST(InterfaceFloors, HaveTheDeltaLobesThatAreDrawn) {
    for (const test::FloorKind& floor : all_floors()) {
        const BsdfInputs<float> inputs = bsdf_inputs({}, floor.bsdf, {});
        const Vec3f wi = normalize(Vec3f{0.3f, 0.2f, 0.9f});
        int proper = 0, delta = 0;
        for (std::uint32_t i = 0; i < 64; ++i) {
            const auto u = uniforms({24, Stream::kTest}, i, 0, 0);
            const SampledDirection<float> s =
                sample_bsdf(floor.bsdf, inputs, wi, {u[0], u[1]}, u[2]);
            proper += s.proper, delta += s.proper && s.delta;
        }
        using enum DeltaLobes;
        const DeltaLobes drawn = delta == 0 ? kNone : delta < proper ? kSome : kAll;
        EXPECT_EQ(std::visit([](const auto& b) { return delta_lobes(b); }, floor.bsdf), drawn)
            << floor.name;
    }
}

TEST(ReferencePaths, AreThoseOfTheBatchesForInterfaces) {
    const auto floors = all_floors();
    for (const test::FloorKind& floor : floors) {
        Scene scene = test::make_small_scene();
        scene.bsdfs[0] = floor.bsdf;
        expect_same(scene, floor.name);
        if (transmits(floor.bsdf)) {
            scene.materials[0].back = {};
            expect_same(scene, floor.name);
        }
        set_texture(scene.bsdfs[0], 0, {0});
        if (const auto scalars = scalars_of(scene.bsdfs[0]); !scalars.empty())
            set_texture(scene.bsdfs[0], static_cast<int>(first_scalar(scene.bsdfs[0])), {1});
        expect_same(scene, floor.name);
    }
    // All kinds in one batch.
    Scene mixed = test::make_small_scene();
    mixed.bsdfs.clear(), mixed.materials.clear();
    const Shape floor = mixed.shapes[0];
    mixed.bsdfs.push_back(Diffuse{{{0, 0, 0}, {}}});
    mixed.materials.push_back({"light", {0}, {}});
    for (Shape& shape : mixed.shapes) shape.material = {0};
    mixed.shapes[0].geometry = test::make_quad({5, 5, 0}, {1, 0, 0}, {0, 1, 0});
    for (std::size_t k = 0; k < floors.size(); ++k) {
        const auto id = static_cast<std::int32_t>(k + 1);
        mixed.bsdfs.push_back(floors[k].bsdf);
        mixed.materials.push_back({"strip", {id}, {id}});
        const float width = 2 / static_cast<float>(floors.size());
        mixed.shapes.push_back(
            {"strip",
             test::make_quad({-1 + width * static_cast<float>(k), -1, 0}, {width, 0, 0}, {0, 2, 0}),
             {id},
             {}});
    }
    expect_same(mixed, "strips of every kind");
}

TEST(ReferencePaths, AreThoseOfTheBatchesForBlendsAndNormalMaps) {
    const Dielectric nothing{{kWhite, kWhite}, 1, true};
    expect_same(test::blended_floor(Diffuse{{{0.3f, 0.5f, 0.7f}, {}}}, true), "blend");
    expect_same(test::blended_floor(nothing, false), "mask");
    expect_same(test::turned_floor(), "normal map");
    expect_same(test::turned_floor(false, false), "normal map without corrections");
    expect_same(test::turned_floor_of_two_sides(), "normal map on two sides");
    expect_same(test::turned_blend(), "normal map on a blend");
    expect_same(test::bumpy_floor(), "bump map");
    expect_same(test::mirrored_floor(), "bump map inside of two sides");
    const Scene plain = test::make_small_scene();
    for (const Scene& scene :
         {test::bumpy_floor(), test::turned_floor(), test::turned_floor(false),
          test::turned_floor(true, false), test::blended_floor(nothing, false)})
        EXPECT_GT(compare(scene, plain).different, 100) << "layers are noticed";
    EXPECT_GT(compare(test::turned_floor(), test::turned_floor(false)).different, 10);
    EXPECT_GT(compare(test::turned_floor(), test::turned_floor(true, false)).different, 100);
}

/// Unknown weights, under other values than the scene's. slow: the textures of the reference.
Comparison compare_unknown(const Scene& scene, const Theta& fast, const Theta& slow) {
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, fast);
    const Numbering numbering;
    TraceInput input = unknown_part(binding, numbering.key, kPathPasses);
    input.choice = SurfaceChoice::kAll;
    const reference::World world{traced, slow};
    Comparison c;
    for (std::uint32_t pass = 0; pass < kPathPasses; ++pass)
        compare_pass(input, world, numbering, pass, c);
    return c;
}

TEST(ReferencePaths, AreThoseOfTheBatchesForUnknownWeights) {
    for (const auto& [name, scene] : test::floors_of_unknown_weights()) {
        const Theta all = test::theta_of(scene);
        Theta weight_alone;
        weight_alone.textures = {all.textures[2]};
        for (const Theta& theta : {all, weight_alone}) {
            const Comparison c = compare_unknown(scene, theta, theta);
            EXPECT_GT(c.values, 1000) << name;
            EXPECT_EQ(c.different, 0) << name;
        }
        Theta known = all;
        known.textures.erase(known.textures.begin() + 2, known.textures.end());
        EXPECT_GT(compare_unknown(scene, all, known).different, 100) << name;
    }
}

std::vector<Rgbf> radiance_of(const Scene& scene, std::uint32_t pass) {
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced,     &textures,           {77, Stream::kTest},
                           kPathPasses, SurfaceChoice::kAll, {}};
    std::vector<BatchSample> samples(256);
    for (std::uint32_t j = 0; j < 256; ++j) samples[j].camera = {j, kPathIteration, pass};
    std::vector<Rgbf> radiance(256);
    EXPECT_EQ(trace_radiance(input, samples, radiance), 0u);
    return radiance;
}

/// The largest difference of light that may bounce and direct light, where behind the floor there
/// are only lights, whose surfaces are black: the same numbers, up to rounding.
float difference_of_bounces(const Scene& bouncing, const Scene& direct) {
    float worst = 0;
    for (std::uint32_t pass = 0; pass < kPathPasses; ++pass) {
        const auto a = radiance_of(bouncing, pass), b = radiance_of(direct, pass);
        for (std::size_t j = 0; j < a.size(); ++j)
            worst = test::worse(worst, length(a[j] - b[j]) / (0.1f + length(b[j])));
    }
    return worst;
}

TEST(ReferencePaths, NormalMapsDimLightThatMayBounceAsDirectLight) {
    const Scene direct = test::turned_floor();
    Scene bouncing = direct;
    bouncing.max_depth = 4;
    EXPECT_LT(difference_of_bounces(bouncing, direct), 1e-4f);
    Scene bright = bouncing;
    bright.materials[0].normals->shadowing = false;
    EXPECT_GT(difference_of_bounces(bright, direct), 0.01f);
}

/// A difference of the scenes that no tolerance may hide.
TEST(ReferencePaths, DefectsAreSeen) {
    const Scene scene = test::make_small_scene();
    const auto is_seen = [&](void (*change)(Scene&)) {
        Scene changed = scene;
        change(changed);
        return compare(changed, scene).different > 0;
    };
    EXPECT_TRUE(is_seen([](Scene& s) {  // the last bit of a light
        Rgbf& radiance = std::get<AreaEmitter>(s.emitters[0]).radiance;
        radiance.x = std::nextafter(radiance.x, 0.0f);
    }));
    EXPECT_TRUE(is_seen([](Scene& s) {  // p_b of another roughness in the weights
        auto& texels = std::get<Bitmap>(s.textures[1]).values;
        for (float& v : texels) v = std::nextafter(v, 0.0f);
    }));
    EXPECT_TRUE(is_seen([](Scene& s) { floor_of(s).specular_rate = 1.001f; }));
    EXPECT_TRUE(is_seen([](Scene& s) {
        s.materials[0].back = {};
        std::swap(std::get<Mesh>(s.shapes[0].geometry).triangles[0].vertex[0],
                  std::get<Mesh>(s.shapes[0].geometry).triangles[0].vertex[1]);
    }));
    const Numbering numbering;
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, numbering.key, kPathPasses, SurfaceChoice::kAll, {}};
    const reference::World world{traced, kNoUnknowns};
    Comparison c;  // another stream of numbers
    compare_pass(input, world, {{77, Stream::kImage}}, 0, c);
    EXPECT_GT(c.different, 100);
}

}  // namespace
}  // namespace burnish
