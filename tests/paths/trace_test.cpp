// trace_batch against a slow twin that follows one sample at a time in plain float: the same draws,
// bit by bit. And replay: a path that is traced again alone is the path that was traced.
#include "paths/trace.h"

#include <gtest/gtest.h>

#include "core/sobol.h"
#include "gradient/candidates.h"
#include "paths/lamps.h"
#include "paths/one_ray.h"
#include "paths/ray_columns.h"
#include "shading/principled.h"

namespace burnish {
namespace {

/// What a sample adds, by technique: black where a draw fails.
struct SlowDraws {
    Rgbf emitted;
    std::array<Rgbf, 2> value;
};

PrincipledParameters<float> parameters_at(const TextureTable& textures, const Principled& bsdf,
                                          const Vec2f& uv) {
    const auto scalar = [&](PrincipledScalar k) { return eval_scalar(textures, bsdf[k], uv); };
    PrincipledParameters<float> p;
    p.base_color = eval_color(textures, bsdf.base_color, uv);
    p.roughness = scalar(PrincipledScalar::kRoughness);
    p.metallic = scalar(PrincipledScalar::kMetallic);
    p.eta = bsdf.eta;
    p.specular_rate = bsdf.specular_rate;
    p.diffuse_rate = bsdf.diffuse_rate;
    p.has_spec_trans = p.has_clearcoat = p.has_sheen = p.has_flatness = p.has_spec_tint =
        p.has_anisotropic = false;
    return p;
}

/// A point on the floor, seen from the camera; both sides reflect.
struct FloorPoint {
    Surface surface;
    Vec3f wi;
    float side = 1;
    PrincipledParameters<float> bsdf;

    Vec3f local(const Vec3f& world) const {
        const Vec3f d = to_local(surface.shading, world);
        return {d.x, d.y, d.z * side};
    }
    Vec3f world(const Vec3f& d) const {
        return to_world(surface.shading, Vec3f{d.x, d.y, d.z * side});
    }
    Vec3f leave(const Vec3f& direction) const {
        return leave_surface(surface.position, surface.geometric_normal, direction);
    }
};

Rgbf slow_emitter_draw(const TracedScene& traced, const FloorPoint& p,
                       const std::array<float, 4>& u) {
    const LightSample light = sample_light(traced.lights, p.surface.position, u);
    if (!(light.pdf > 0)) return {};
    const Vec3f wo = p.local(light.direction_world), origin = p.leave(light.direction_world);
    Vec3f direction = light.direction_world;
    float distance = std::numeric_limits<float>::infinity();
    if (std::isfinite(light.distance)) {
        const Vec3f to_light = p.surface.position + light.direction_world * light.distance - origin;
        distance = length(to_light);
        direction = to_light * (1 / distance);
        distance *= 1 - 8.9e-4f;
    }
    if (is_occluded(traced.accel, origin, direction, distance)) return {};
    const float other = light.delta ? 0 : pdf_principled(p.bsdf, p.wi, wo);
    const Rgbf weight = light.radiance * (1 / (light.pdf + other));
    return eval_principled(p.bsdf, p.wi, wo) * weight;
}

Rgbf slow_bsdf_draw(const TracedScene& traced, const FloorPoint& p, const std::array<float, 4>& u) {
    const auto drawn = sample_principled(p.bsdf, p.wi, Vec2f{u[0], u[1]}, u[2]);
    if (!drawn.valid) return {};
    const Vec3f direction = p.world(drawn.wo_local);
    const Hit hit = first_hit(traced.emitting, p.leave(direction), direction);
    const EmissionSample e =
        hit.shape < 0 ? emission_at_infinity(traced.lights, p.surface.position, direction)
                      : emission_at_hit(traced.lights, hit, p.surface.position, direction);
    const float distance =
        hit.shape < 0 ? std::numeric_limits<float>::infinity() : hit.distance * (1 - 8.9e-4f);
    if (is_occluded(traced.accel, p.leave(direction), direction, distance)) return {};
    return eval_principled(p.bsdf, p.wi, drawn.wo_local) * (e.radiance * (1 / (e.pdf + drawn.pdf)));
}

std::array<float, 4> numbers_of(const TraceInput& input, const CameraSample& s,
                                std::uint32_t technique) {
    if (input.sequence == Sequence::kIndependent)
        return uniforms(input.key, s.pixel, s.iteration, s.pass * 2 + technique);
    return sobol_uniforms(input.key, s.pixel, film_pass(s, input.passes_per_iteration), technique);
}

SlowDraws slow_sample(const TraceInput& input, const CameraSample& s) {
    const TracedScene& traced = *input.scene;
    const Scene& scene = *traced.scene;
    const Film& film = scene.film;
    const Vec2f offset =
        film_offset(input.key, film_pass(s, input.passes_per_iteration), input.sequence);
    const auto width = static_cast<std::uint32_t>(film.crop_width);
    const Vec2f at{
        (static_cast<float>(s.pixel % width) + offset.x) * (1 / static_cast<float>(film.width)),
        (static_cast<float>(s.pixel / width) + offset.y) * (1 / static_cast<float>(film.height))};
    const CameraRay<float> ray = camera_ray(traced.camera, at);
    const Hit hit = first_hit(traced.accel, ray.origin, ray.direction, ray.max_distance);
    SlowDraws direct_samples;
    if (hit.shape < 0) {
        direct_samples.emitted =
            emission_at_infinity(traced.lights, ray.origin, ray.direction).radiance;
        return direct_samples;
    }
    direct_samples.emitted =
        emission_at_hit(traced.lights, hit, ray.origin, ray.direction).radiance;
    const Material& material = scene[scene.shapes[static_cast<std::size_t>(hit.shape)].material];
    const auto* principled = std::get_if<Principled>(&scene[material.front]);
    if (!principled) return direct_samples;
    FloorPoint p{surface_at(scene, *traced.triangles, hit, ray.origin, ray.direction), {}, 1, {}};
    p.wi = to_local(p.surface.shading, -ray.direction);
    if (p.wi.z < 0) p.side = -1, p.wi.z = -p.wi.z;
    p.bsdf = parameters_at(*input.textures, *principled, p.surface.uv);
    direct_samples.value[0] = slow_emitter_draw(traced, p, numbers_of(input, s, 0));
    direct_samples.value[1] = slow_bsdf_draw(traced, p, numbers_of(input, s, 1));
    return direct_samples;
}

/// The number of draws compared.
int compare_with_twin(const Scene& scene, Sequence sequence = Sequence::kIndependent,
                      LightSelection selection = LightSelection::kUniform) {
    const TracedScene traced = prepare(scene, selection);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {77, Stream::kTest}, 8, SurfaceChoice::kAll, {},
                           false,   sequence};
    int direct_samples = 0;
    for (std::uint32_t pass = 0; pass < 8; ++pass) {
        std::vector<BatchSample> samples(256);
        for (std::uint32_t i = 0; i < 256; ++i) samples[i].camera = {i, 3, pass};
        BatchOutput out;
        trace_batch(input, samples, out);
        EXPECT_EQ(out.rejected, 0u);
        std::vector<Rgbf> radiance(256);
        EXPECT_EQ(trace_radiance(input, samples, radiance), 0u);
        std::vector<std::array<Rgbf, 2>> fast(256);
        for (const DirectSample& d : out.direct_samples)
            fast[static_cast<std::size_t>(d.sample)][static_cast<std::size_t>(d.record.technique)] =
                d.value;
        for (std::size_t i = 0; i < 256; ++i) {
            const SlowDraws slow = slow_sample(input, samples[i].camera);
            EXPECT_EQ(out.emitted[i], slow.emitted);
            for (std::size_t t = 0; t < 2; ++t) {
                EXPECT_EQ(fast[i][t], slow.value[t]) << "pixel " << i << ", technique " << t;
                direct_samples += !is_black(slow.value[t]);
            }
            EXPECT_EQ(radiance[i], slow.emitted + slow.value[0] + slow.value[1]);
        }
    }
    return direct_samples;
}

TEST(TraceBatch, AgreesWithItsSlowTwinBitByBit) {
    Scene scene = test::make_small_scene();
    EXPECT_GT(compare_with_twin(scene), 1000);
    EXPECT_GT(compare_with_twin(scene, Sequence::kSobol), 1000);
    auto& floor = std::get<Principled>(scene.bsdfs[0]);
    floor.specular_rate = 2.5f, floor.diffuse_rate = 0.5f;
    EXPECT_GT(compare_with_twin(scene), 1000);
    for (const LightSelection selection : test::kSelections)
        EXPECT_GT(compare_with_twin(test::make_lamps(), Sequence::kIndependent, selection), 1000);
}

/// A sample gives the same bits alone, in a full batch, and in any order.
TEST(TraceBatch, ASampleDoesNotDependOnItsCompany) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {80, Stream::kTest}, 8, SurfaceChoice::kAll, {}};
    std::vector<BatchSample> samples(kBatchSamples);
    for (std::uint32_t i = 0; i < kBatchSamples; ++i) samples[i].camera = {i % 256, 0, i / 256};
    std::vector<Rgbf> together(samples.size());
    trace_radiance(input, samples, together);
    std::reverse(samples.begin(), samples.end());
    std::size_t begin = 0;
    for (const std::size_t size : {1u, 15u, 16u, 17u, 300u, 675u}) {
        std::vector<Rgbf> part(size);
        trace_radiance(input, std::span(samples).subspan(begin, size), part);
        for (std::size_t i = 0; i < size; ++i)
            EXPECT_EQ(part[i], together[samples.size() - 1 - begin - i]);
        begin += size;
    }
    EXPECT_EQ(begin, samples.size());
}

TEST(RayColumns, SortingByDirectionKeepsEveryLane) {
    auto direction = std::make_unique<ColumnVec3>();
    ActiveList list;
    test::RandomSource random{81};
    for (std::size_t i = 0; i < 1000; ++i) {
        set(*direction, i,
            normalize(Vec3f{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)}));
        if (i % 3 != 1) list.add(i);
    }
    direction->x[6] = NAN;
    ActiveList sorted = list;
    sort_by_direction(*direction, sorted);
    ASSERT_EQ(sorted.count, list.count);
    const auto octant = [&](std::size_t i) {
        return 4 * (direction->x[i] > 0) + 2 * (direction->y[i] > 0) + (direction->z[i] > 0);
    };
    for (std::size_t k = 1; k < sorted.count; ++k)
        EXPECT_LE(octant(sorted.lane[k - 1]), octant(sorted.lane[k]));
    std::sort(sorted.lane.begin(), sorted.lane.begin() + static_cast<int>(sorted.count));
    EXPECT_TRUE(std::equal(sorted.lane.begin(), sorted.lane.begin() + static_cast<int>(list.count),
                           list.lane.begin()));
}

TEST(TraceBatch, SplitsIntoStaticAndDynamicParts) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const TextureTable textures = texture_table(scene, theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, theta);
    std::array<double, 3> sums{};
    for (const SurfaceChoice choice :
         {SurfaceChoice::kAll, SurfaceChoice::kUnknown, SurfaceChoice::kConstant}) {
        const TraceInput input{&traced, &textures, {78, Stream::kTest}, 1, choice, unknowns};
        std::vector<BatchSample> samples(256);
        for (std::uint32_t i = 0; i < 256; ++i) samples[i].camera = {i, 0, 0};
        BatchOutput out;
        trace_batch(input, samples, out);
        double& sum = sums[static_cast<std::size_t>(choice)];
        for (const Rgbf& e : out.emitted) sum += double{e.x};
        for (const DirectSample& d : out.direct_samples) sum += double{d.value.x};
    }
    EXPECT_NEAR(sums[0], sums[1] + sums[2], 1e-9 * sums[0]);
    EXPECT_GT(sums[1], 0);
    EXPECT_GT(sums[2], 0);
}

TEST(TraceBatch, ReplayOfAPathIsThePath) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const TextureTable textures = texture_table(scene, theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, theta);
    const TraceInput input{
        &traced, &textures, {79, Stream::kDerivative}, 4, SurfaceChoice::kUnknown, unknowns};
    std::size_t rejected = 0;
    const std::vector<TracedPath> traced_paths = trace_paths(input, 5, 4, rejected);
    std::vector<PathSample> names;
    for (const TracedPath& p : traced_paths) names.push_back(p.path);
    std::reverse(names.begin(), names.end());  // in other company
    const std::vector<PathRecord> replayed = replay_paths(input, names);
    ASSERT_GT(traced_paths.size(), 500u);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const PathRecord& a = traced_paths[names.size() - 1 - i].record;
        const PathRecord& b = replayed[i];
        EXPECT_EQ(a.pixel, b.pixel);
        EXPECT_EQ(a.technique, b.technique);
        EXPECT_EQ(a.wo_local, b.wo_local);
        EXPECT_EQ(a.radiance_over_pdf, b.radiance_over_pdf);
        EXPECT_EQ(a.uv.x, b.uv.x);
    }
}

}  // namespace
}  // namespace burnish
