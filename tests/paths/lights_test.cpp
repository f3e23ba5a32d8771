// Sampling of lights: the density that a sample states is the one with which its direction is
// found, and integrals over directions come out the same as by uniform directions.
#include "paths/lights.h"

#include <gtest/gtest.h>

#include "ledger_entries.h"
#include "paths/beams.h"
#include "paths/lamps.h"
#include "paths/light_columns.h"
#include "paths/one_light.h"
#include "student.h"

namespace burnish {
namespace {

using test::RunningMean;

using test::accepted;
using test::make_light;
using test::rejected;
using test::ledger::kLateLights;
using test::ledger::kLights;

int direct_samples() { return test::scaled(kLights, 200000); }
const Vec3f kOrigin{0.3f, -0.2f, 0.1f};

EmissionSample found(const TracedScene& traced, const Vec3f& direction) {
    return test::emission_along(traced, kOrigin, direction);
}

/// Whether the light is met so obliquely that little of its cosine is left.
bool grazes(const TracedScene& traced, const Vec3f& direction) {
    const Hit hit = first_hit(traced.geometry->accel, kOrigin, direction);
    if (hit.shape < 0) return false;
    const Surface s =
        surface_at(*traced.scene, traced.geometry->triangles, hit, kOrigin, direction);
    return std::abs(dot(s.geometric_normal, direction)) < 5e-3f;
}

class LightSampling : public testing::TestWithParam<test::LightKind> {};

TEST_P(LightSampling, StatesTheDensityWithWhichItsDirectionIsFound) {
    const Scene scene = make_light(GetParam());
    const TracedScene traced = prepare(scene);
    test::RandomSource random{5002};
    int compared = 0, grazing = 0;
    const int count = test::is_late(GetParam()) ? 8000 : 4000;  // half of a cylinder faces away
    for (int i = 0; i < count; ++i) {
        const std::array<float, 4> u{random.next(), random.next(), random.next(), random.next()};
        const LightSample s = sample_light(*traced.lights, kOrigin, u);
        if (s.delta || !(s.pdf > 0)) continue;
        const EmissionSample e = found(traced, s.direction_world);
        if (e.pdf == 0 || (test::is_late(GetParam()) && grazes(traced, s.direction_world))) {
            // missed at the silhouette by rounding, or its cosine is rounding
            ++grazing;
            continue;
        }
        ++compared;
        EXPECT_NEAR(e.pdf / s.pdf, 1, 2e-3);
        EXPECT_NEAR(e.radiance.x / s.radiance.x, 1, 2e-3);
    }
    EXPECT_GT(compared, 1000);
    EXPECT_LE(grazing, test::is_late(GetParam()) ? 40 : 4);
}

/// Functions of the direction that are integrated over the light.
constexpr std::size_t kMoments = 10;
std::array<double, kMoments> moments(const Vec3f& d) {
    const double x = double{d.x}, y = double{d.y}, z = double{d.z};
    return {1, x, y, z, x * x, y * y, x * y, y * z, z * x, x * y * z};
}

using Means = std::array<RunningMean, kMoments>;

/// Integrals of radiance times moments, by samples of the light technique.
Means by_light(const Scene& scene, const test::LedgerEntry& entry) {
    const TracedScene traced = prepare(scene);
    test::RandomSource random{test::seed_of(entry)};
    Means means;
    for (int i = 0; i < direct_samples(); ++i) {
        const std::array<float, 4> u{random.next(), random.next(), random.next(), random.next()};
        const LightSample s = sample_light(*traced.lights, kOrigin, u);
        const auto m = moments(s.direction_world);
        const bool counts = !s.delta && s.pdf > 0;
        for (std::size_t k = 0; k < kMoments; ++k)
            means[k].add(counts ? m[k] * double{s.radiance.x} / double{s.pdf} : 0);
    }
    return means;
}

/// The same by uniform directions.
Means by_directions(const Scene& scene, const test::LedgerEntry& entry) {
    const TracedScene traced = prepare(scene);
    test::RandomSource random{test::seed_of(entry, 1)};
    Means means;
    for (int i = 0; i < 4 * direct_samples(); ++i) {
        const float z = random.next(-1, 1), phi = 2 * std::numbers::pi_v<float> * random.next();
        const float r = std::sqrt(1 - z * z);
        const Vec3f d{r * std::cos(phi), r * std::sin(phi), z};
        const auto m = moments(d);
        const double radiance = double{found(traced, d).radiance.x} * 4 * std::numbers::pi;
        for (std::size_t k = 0; k < kMoments; ++k) means[k].add(m[k] * radiance);
    }
    return means;
}

double integral_p_value(const Means& a, const Means& b) {
    std::vector<double> p;
    for (std::size_t k = 0; k < kMoments; ++k) {
        // One pdf for all directions: nothing varies but the rounding.
        test::MeanEstimate ours = test::estimate_of(a[k]);
        ours.standard_error = std::hypot(ours.standard_error, 1e-6 * std::abs(ours.mean));
        p.push_back(test::welch_p_value(ours, test::estimate_of(b[k])));
    }
    return test::holm_minimum(p);
}

TEST_P(LightSampling, IntegratesLikeUniformDirections) {
    const test::LedgerEntry& entry = test::is_late(GetParam()) ? kLateLights : kLights;
    const Means expected = by_directions(make_light(GetParam()), entry);
    const int kind = static_cast<int>(GetParam());
    EXPECT_TRUE(accepted(entry, "kind " + std::to_string(kind),
                         integral_p_value(by_light(make_light(GetParam()), entry), expected)));
    if (GetParam() == test::LightKind::kConstant || GetParam() == test::LightKind::kEnvironment) {
        Scene defect = make_light(GetParam());
        if (auto* sky = std::get_if<EnvironmentEmitter>(&defect.emitters[1])) sky->scale = 1.03f;
        if (auto* c = std::get_if<ConstantEmitter>(&defect.emitters[1])) c->radiance *= 1.03f;
        EXPECT_TRUE(rejected(kLights, "light 3 % brighter",
                             integral_p_value(by_light(defect, entry), expected)));
    } else if (GetParam() != test::LightKind::kFlippedSphere &&
               GetParam() != test::LightKind::kFlippedCylinder) {
        // From within, size changes nothing, or little.
        const bool late = test::is_late(GetParam());
        EXPECT_TRUE(
            rejected(entry, late ? "light 5 % larger" : "light 3 % larger",
                     integral_p_value(by_light(make_light(GetParam(), late ? 1.05f : 1.03f), entry),
                                      expected)));
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, LightSampling,
                         testing::Values(test::LightKind::kQuad, test::LightKind::kSphere,
                                         test::LightKind::kFlippedSphere, test::LightKind::kDisk,
                                         test::LightKind::kConstant, test::LightKind::kEnvironment,
                                         test::LightKind::kCylinder,
                                         test::LightKind::kFlippedCylinder,
                                         test::LightKind::kTexturedQuad,
                                         test::LightKind::kTexturedCylinder));

TEST(LightSampling, PointLightFallsWithTheSquareOfTheDistance) {
    Scene scene;
    scene.emitters = {PointEmitter{{0, 0, 3}, {9, 18, 27}}};
    const TracedScene traced = prepare(scene);
    const LightSample s = sample_light(*traced.lights, {0, 0, 0}, {0.5f, 0.5f, 0.5f, 0.5f});
    EXPECT_TRUE(s.delta);
    EXPECT_EQ(s.pdf, 1.0f);
    EXPECT_EQ(s.distance, 3.0f);
    EXPECT_FLOAT_EQ(s.radiance.x, 1);
    EXPECT_FLOAT_EQ(s.radiance.z, 3);
}

/// Towards the origin, with a place in its own axes; the numbers are Mitsuba 3.9.1's.
Transform beam_axes() { return look_at({1, 5, 2}, {0, 0, 0}, {0, 0, 1}); }

LightSample beam_sample(const Emitter& emitter, const Vec3f& local,
                        std::vector<Texture> textures = {}) {
    Scene scene;
    scene.emitters = {emitter};
    scene.textures = std::move(textures);
    const TracedScene traced = prepare(scene);
    const LightSample s =
        sample_light(*traced.lights, transform_point(beam_axes(), local), {0.5f, 0.5f, 0.5f, 0.5f});
    EXPECT_TRUE(s.delta);
    EXPECT_EQ(s.pdf, 1.0f);
    return s;
}

void expect_color(const Rgbf& color, const Rgbf& expected) {
    EXPECT_NEAR(color.x, expected.x, 2e-5f * (1 + expected.x));
    EXPECT_NEAR(color.y, expected.y, 2e-5f * (1 + expected.y));
    EXPECT_NEAR(color.z, expected.z, 2e-5f * (1 + expected.z));
}

/// Texels that name their place: 5 x 3, red the column, green the row.
Bitmap numbered_texels() {
    Bitmap bitmap;
    bitmap.width = 5, bitmap.height = 3, bitmap.channels = 3;
    bitmap.filter = TextureFilter::kNearest;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x)
            bitmap.values.insert(bitmap.values.end(),
                                 {static_cast<float>(x), static_cast<float>(y), 1});
    return bitmap;
}

TEST(LightSampling, SpotFallsLinearlyInTheAngle) {
    SpotEmitter spot;
    spot.to_world = beam_axes();
    spot.intensity = {60, 50, 70};
    spot.cutoff = 18, spot.beam_width = 9;
    expect_color(beam_sample(spot, {0.1f, 0.2f, 3}).radiance, {6.6298347f, 5.5248623f, 7.734807f});
    expect_color(beam_sample(spot, {0.5f, 0.1f, 3}).radiance, {6.01424f, 5.0118666f, 7.0166135f});
    expect_color(beam_sample(spot, {0.2f, -0.7f, 3}).radiance, {3.0498102f, 2.5415084f, 3.558112f});
    EXPECT_TRUE(is_black(beam_sample(spot, {0.3f, 0.3f, -1}).radiance));
    EXPECT_TRUE(is_black(beam_sample(spot, {1.2f, 0, 3}).radiance));
    spot.texture = {0};
    const Rgbf texel = beam_sample(spot, {0.5f, 0.1f, 3}, {numbered_texels()}).radiance;
    expect_color(texel, {3 * 6.01424f, 1 * 5.0118666f, 7.0166135f});
}

TEST(LightSampling, ProjectorShowsItsPictureUpsideDownToTheLeft) {
    ProjectorEmitter projector;
    projector.to_world = beam_axes();
    projector.irradiance = {2, 2, 2};
    projector.fov_x = 30, projector.aspect = 5.0 / 3;
    projector.texture = {0};
    const auto at = [&](const Vec3f& local) {
        return beam_sample(projector, local, {numbered_texels()}).radiance;
    };
    // 2 pi / (z^2 cosine)
    expect_color(at({0.1f, 0.2f, 3}), {2 * 0.70006937f, 0, 0.70006937f});
    expect_color(at({0.5f, 0.1f, 3}), {0, 0.70814943f, 0.70814943f});
    EXPECT_TRUE(is_black(at({-0.3f, 0.55f, 3})));
    EXPECT_TRUE(is_black(at({0.3f, 0.3f, -1})));
}

/// What chooses lights knows of it: red light that a slide lets through or not.
TEST(LightSampling, BeamsAreAsBrightAsWhatPassesTheirSlides) {
    Scene scene;
    scene.textures = {Checkerboard{{1, 0, 0}, {1, 0, 0}, {}},
                      Checkerboard{{0, 1, 1}, {0, 1, 1}, {}}};
    SpotEmitter spot;
    spot.intensity = {2, 0, 0};
    ProjectorEmitter projector;
    projector.irradiance = {2, 0, 0};
    const float spot_alone = beam_bounds(scene, spot).intensity,
                projector_alone = beam_bounds(scene, projector).intensity;
    EXPECT_GT(spot_alone, 0.0f);
    spot.texture = projector.texture = {0};
    EXPECT_FLOAT_EQ(beam_bounds(scene, spot).intensity, spot_alone);
    EXPECT_FLOAT_EQ(beam_bounds(scene, projector).intensity, projector_alone);
    spot.texture = projector.texture = {1};
    EXPECT_EQ(beam_bounds(scene, spot).intensity, 0.0f);
    EXPECT_EQ(beam_bounds(scene, projector).intensity, 0.0f);
}

TEST(LightSampling, DirectionalLightComesFromInfinity) {
    const DirectionalEmitter sun{normalize(Vec3f{-1, -2, -0.5f}), {0.6f, 0.7f, 0.9f}};
    const LightSample s = beam_sample(sun, {0.5f, 0.3f, 2});
    EXPECT_FALSE(std::isfinite(s.distance));
    expect_color(s.radiance, {0.6f, 0.7f, 0.9f});
    EXPECT_NEAR(s.direction_world.y, 0.87287164f, 1e-6f);
}

/// Of 2^16 triangles, with all u[1] of 24 bits that fall among the first 256 of them. Without the
/// bits of `rest` a small one would be drawn 0.8 % too often.
TEST(Lights, DrawManyTrianglesByArea) {
    constexpr std::uint32_t kTriangles = 1 << 16, kTried = 256, kRests = 64;
    Mesh mesh;
    for (std::uint32_t i = 0; i < kTriangles; ++i) {
        const auto x = static_cast<float>(i), size = i % 10 == 0 ? 0.9f : 0.2f;
        mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + size, 0, 0}, {x, size, 0}});
        mesh.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
    }
    Scene scene;
    scene.bsdfs = {Diffuse{}};
    scene.materials = {{"light", {0}, {}}};
    scene.shapes = {{"light", std::move(mesh), {0}, {0}}};
    scene.emitters = {AreaEmitter{{1, 1, 1}, {0}}};
    const TracedScene traced = prepare(scene);
    double expected = 0;
    for (std::uint32_t i = 0; i < kTried; ++i)
        expected += double{traced.lights->lights[0].by_area.columns[i].keep} / kTried;
    std::size_t kept = 0;
    for (std::uint32_t bits = 0; bits < kTried * 256; ++bits)
        for (std::uint32_t r = 0; r < kRests; ++r) {
            const SelectedEmitter selected{0, 1, (static_cast<float>(r) + 0.5f) / kRests};
            const std::array<float, 4> u{0, static_cast<float>(bits) * 0x1p-24f, 0.5f, 0.5f};
            kept += choose_light(*traced.lights, selected, u).triangle == bits / 256;
        }
    EXPECT_LT(expected, 0.6);
    EXPECT_NEAR(static_cast<double>(kept) / (256.0 * kTried * kRests), expected, 1e-4);
}

/// A batch of lanes with numbers and positions at random, some of which nobody wants.
struct LaneDraws {
    static constexpr std::size_t kCount = 512;
    std::array<Column, 4> u;
    ColumnVec3 position;
    LightColumns lanes;
    ActiveList wanted;

    explicit LaneDraws(std::uint32_t seed) {
        test::RandomSource random{seed};
        for (std::size_t i = 0; i < kCount; ++i) {
            for (Column& lane : u) lane[i] = random.next(0, 1);
            set(position, i, {random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)});
            if (i % 7 != 3) wanted.add(i);
        }
    }

    /// Lane i against a single sample, bit by bit. Returns whether it is lit.
    bool expect_single(const Lights& lights, std::size_t i, std::uint32_t candidate = 0) const {
        const LightSample one =
            sample_light(lights, get(position, i), {u[0][i], u[1][i], u[2][i], u[3][i]}, candidate);
        EXPECT_EQ(lanes.pdf[i], one.pdf) << candidate;
        EXPECT_EQ(lanes.delta[i], one.delta ? 1.0f : 0.0f);
        if (!(one.pdf > 0)) return false;
        EXPECT_EQ(get(lanes.direction_world, i), one.direction_world);
        EXPECT_EQ(lanes.distance[i], one.distance);
        EXPECT_EQ(get(lanes.radiance, i), one.radiance);
        return true;
    }
};

/// Every kind of light in one scene.
void expect_lanes_to_agree(LightSelection selection) {
    Scene scene = make_light(test::LightKind::kEnvironment);
    for (const test::LightKind kind :
         {test::LightKind::kQuad, test::LightKind::kSphere, test::LightKind::kDisk,
          test::LightKind::kCylinder, test::LightKind::kQuad}) {
        Shape shape = make_light(kind).shapes[0];
        const auto at = static_cast<std::int32_t>(scene.shapes.size());
        shape.emitter = {static_cast<std::int32_t>(scene.emitters.size())};
        scene.emitters.push_back(AreaEmitter{{1, 2, 3}, {at}});
        scene.shapes.push_back(shape);
    }
    scene.textures = {test::lamp_texture()};
    std::get<AreaEmitter>(scene.emitters.back()).texture = {0};
    SpotEmitter spot;
    spot.to_world = beam_axes();
    scene.emitters.push_back(spot);
    scene.emitters.push_back(DirectionalEmitter{});
    const TracedScene traced = prepare(scene, selection);
    const auto draws = std::make_unique<LaneDraws>(5002);
    sample_lights(*traced.lights, draws->u, draws->position, draws->wanted, LaneDraws::kCount, 0,
                  draws->lanes);
    int lit = 0;
    for (std::size_t i = 0; i < LaneDraws::kCount; ++i)
        if (i % 7 == 3)
            EXPECT_EQ(draws->lanes.pdf[i], 0.0f);
        else
            lit += draws->expect_single(*traced.lights, i);
    EXPECT_GT(lit, 200);
}

TEST(Lights, LanesAgreeWithSingleDraws) {
    for (const LightSelection selection :
         {LightSelection::kUniform, LightSelection::kPower, LightSelection::kTree})
        expect_lanes_to_agree(selection);
}

void expect_candidates_to_agree(const Scene& scene) {
    const TracedScene traced = prepare(scene, LightSelection::kResampled);
    const std::uint32_t count = candidates_of(traced.lights->selector);
    ASSERT_GT(count, 1u);
    const auto draws = std::make_unique<LaneDraws>(5003);
    const ActiveList& wanted = draws->wanted;
    for (std::uint32_t c = 0; c < count; ++c) {
        sample_lights(*traced.lights, draws->u, draws->position, wanted, LaneDraws::kCount, c,
                      draws->lanes);
        for (std::size_t k = 0; k < wanted.count; ++k)
            draws->expect_single(*traced.lights, wanted.lane[k], c);
        EXPECT_EQ(draws->lanes.pdf[3], 0.0f) << "not wanted";
    }
}

TEST(Lights, CandidatesInLanesAgreeWithSingleDraws) {
    Scene scene = test::make_small_scene();
    expect_candidates_to_agree(scene);
    ASSERT_TRUE(std::holds_alternative<ConstantEmitter>(scene.emitters.back()));
    scene.emitters.back() = test::small_sky();
    SpotEmitter spot;
    spot.to_world = beam_axes();
    scene.emitters.push_back(spot);
    expect_candidates_to_agree(scene);
    expect_candidates_to_agree(test::make_beams());
}

}  // namespace
}  // namespace burnish
