// Rays against spheres, disks and triangles, compared with textbook formulas in double; surfaces at
// the hits; shadow rays.
#include <gtest/gtest.h>

#include "gradient/small_scene.h"
#include "paths/one_ray.h"
#include "paths/points.h"

namespace burnish {
namespace {

using Double3 = Vec3<double>;

Double3 wide(const Vec3f& v) { return {double{v.x}, double{v.y}, double{v.z}}; }

/// Distance to the sphere, or infinity.
double sphere_distance(const Sphere& s, const Double3& o, const Double3& d) {
    const Double3 oc = o - wide(s.center);
    const double b = dot(oc, d), c = dot(oc, oc) - double{s.radius} * double{s.radius};
    const double root = b * b - c;
    if (root < 0) return INFINITY;
    const double near = -b - std::sqrt(root), far = -b + std::sqrt(root);
    return near > 0 ? near : far > 0 ? far : INFINITY;
}

double disk_distance(const Disk& disk, const Double3& o, const Double3& d) {
    const auto& m = disk.to_world.m;
    const Double3 center{m[3], m[7], m[11]}, x{m[0], m[4], m[8]}, y{m[1], m[5], m[9]};
    const Double3 n = cross(x, y);
    const double t = dot(center - o, n) / dot(d, n);
    if (!(t > 0)) return INFINITY;
    const Double3 p = o + d * t - center;
    const double a = dot(p, x) / dot(x, x), b = dot(p, y) / dot(y, y);
    return a * a + b * b <= 1 ? t : INFINITY;
}

double triangle_distance(const Mesh& mesh, const Triangle& t, const Double3& o, const Double3& d) {
    const Double3 p0 = wide(mesh.positions[t.vertex[0]]);
    const Double3 e1 = wide(mesh.positions[t.vertex[1]]) - p0,
                  e2 = wide(mesh.positions[t.vertex[2]]) - p0;
    const Double3 n = cross(e1, e2);
    const double distance = dot(p0 - o, n) / dot(d, n);
    if (!(distance > 0)) return INFINITY;
    const Double3 p = o + d * distance - p0;
    const double u = dot(cross(p, e2), n) / dot(n, n), v = dot(cross(e1, p), n) / dot(n, n);
    return u >= 0 && v >= 0 && u + v <= 1 ? distance : INFINITY;
}

Disk tilted_disk() {
    Disk disk;
    disk.to_world =
        translation({0.4, -0.3, 0.2}) * rotation({1, 2, 0.5}, 50) * scaling({1.2, 0.7, 1});
    disk.to_local = inverse(disk.to_world);
    return disk;
}

Mesh random_triangles() {
    Mesh mesh;
    test::RandomSource random{3001};
    for (std::uint32_t i = 0; i < 20; ++i) {
        for (int k = 0; k < 3; ++k)
            mesh.positions.push_back({random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)});
        mesh.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
    }
    return mesh;
}

Scene scene_of(std::vector<Geometry> geometries) {
    Scene scene;
    scene.bsdfs = {Diffuse{}};
    scene.materials = {{"m", {0}, {}}};
    for (const Geometry& g : geometries) scene.shapes.push_back({"s", g, {0}, {}});
    return scene;
}

struct Closest {
    double distance = INFINITY, next = INFINITY;
    int shape = -1;
    void offer(double t, int s) {
        if (t < distance)
            next = distance, distance = t, shape = s;
        else
            next = std::min(next, t);
    }
};

Closest closest(const Scene& scene, const Double3& o, const Double3& d) {
    Closest best;
    for (int i = 0; i < static_cast<int>(scene.shapes.size()); ++i) {
        const Geometry& g = scene.shapes[static_cast<std::size_t>(i)].geometry;
        if (const auto* sphere = std::get_if<Sphere>(&g))
            best.offer(sphere_distance(*sphere, o, d), i);
        if (const auto* disk = std::get_if<Disk>(&g)) best.offer(disk_distance(*disk, o, d), i);
        if (const auto* mesh = std::get_if<Mesh>(&g))
            for (const Triangle& t : mesh->triangles)
                best.offer(triangle_distance(*mesh, t, o, d), i);
    }
    return best;
}

struct TestRay {
    Vec3f origin, direction;
};

TestRay random_ray(test::RandomSource& random) {
    const Vec3f origin{random.next(-3, 3), random.next(-3, 3), random.next(-3, 3)};
    const Vec3f target{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)};
    return {origin, normalize(target - origin)};
}

TEST(Intersection, FirstHitIsThatOfTheFormulas) {
    Sphere sphere;
    sphere.center = {-0.5f, 0.4f, 0.1f};
    sphere.radius = 0.6f;
    const Scene scene = scene_of({sphere, tilted_disk(), random_triangles()});
    const TracedScene traced = prepare(scene);
    test::RandomSource random{3002};
    int hits = 0, edges = 0;
    for (int i = 0; i < 20000; ++i) {
        const TestRay ray = random_ray(random);
        const Hit hit = first_hit(traced.geometry->accel, ray.origin, ray.direction);
        const Closest expected = closest(scene, wide(ray.origin), wide(ray.direction));
        if (hit.shape != expected.shape) {
            ++edges;  // an edge, decided by rounding
            continue;
        }
        if (hit.shape < 0) continue;
        ++hits;
        if (std::abs(double{hit.distance} - expected.distance) > 1e-4) ++edges;
        const Surface s =
            surface_at(scene, traced.geometry->triangles, hit, ray.origin, ray.direction);
        const Double3 p = wide(ray.origin) + wide(ray.direction) * double{hit.distance};
        EXPECT_LT(length(wide(s.position) - p), 2e-5);
        EXPECT_NEAR(length(s.geometric_normal), 1, 1e-5);
        EXPECT_NEAR(dot(s.shading.n, s.shading.s), 0, 1e-5);
        EXPECT_TRUE(
            is_occluded(traced.geometry->accel, ray.origin, ray.direction, hit.distance * 1.001f));
        EXPECT_FALSE(
            is_occluded(traced.geometry->accel, ray.origin, ray.direction, hit.distance * 0.999f));
    }
    EXPECT_GT(hits, 5000);
    EXPECT_LE(edges, 4);
}

RayPacket packet_of(const std::array<TestRay, kPacketRays>& rays) {
    RayPacket packet;
    packet.valid.fill(-1);
    packet.max_distance.fill(INFINITY);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const auto& [o, d] = rays[k];
        packet.origin_x[k] = o.x, packet.origin_y[k] = o.y, packet.origin_z[k] = o.z;
        packet.direction_x[k] = d.x, packet.direction_y[k] = d.y, packet.direction_z[k] = d.z;
    }
    return packet;
}

Sphere sphere_at(const Vec3f& center, float radius, bool flipped) {
    Sphere sphere{center, radius, {}, flipped};
    sphere.to_world = rotation({1, -2, 0.5}, 70);
    return sphere;
}

/// Structures of a few primitives, where packets stay together, and of more.
TEST(Intersection, PacketsMeetWhatSingleRaysMeet) {
    const Sphere left = sphere_at({-0.5f, 0.4f, 0.1f}, 0.6f, false),
                 right = sphere_at({0.6f, 0, 0.3f}, 0.5f, true);
    const Geometry triangles = random_triangles();
    for (const Scene& scene :
         {scene_of({left, right, tilted_disk(), triangles}),
          scene_of({left, right, tilted_disk(), triangles, triangles, triangles})}) {
        const TracedScene traced = prepare(scene);
        const Accel& accel = traced.geometry->accel;
        test::RandomSource random{3004};
        for (int i = 0; i < 500; ++i) {
            std::array<TestRay, kPacketRays> rays;
            for (TestRay& ray : rays) ray = random_ray(random);
            const HitPacket hits = accel.intersect(packet_of(rays), Coherence::kIncoherent);
            const auto blocked = accel.occluded(packet_of(rays), Coherence::kIncoherent);
            for (std::size_t k = 0; k < rays.size(); ++k) {
                const Hit hit = first_hit(accel, rays[k].origin, rays[k].direction);
                EXPECT_EQ(hits.shape[k] < 0, hit.shape < 0);
                EXPECT_EQ(blocked[k] != 0, hit.shape >= 0);
                if (hit.shape >= 0) {
                    EXPECT_EQ(hits.distance[k], hit.distance);
                }
            }
        }
    }
}

/// Spheres, and other shapes of the same kind of BSDF, so that packets hold several of them; of one
/// sphere the texture is read, but only from outside.
TEST(Intersection, SurfacesOfABatchAreThoseOfSingleRays) {
    Scene scene = scene_of({sphere_at({-0.5f, 0.4f, 0.1f}, 0.6f, false),
                            sphere_at({0.6f, 0, 0.3f}, 0.5f, true), tilted_disk(),
                            random_triangles(), sphere_at({0, -0.8f, 0}, 0.4f, false)});
    scene.textures = {test::make_bitmap(4, 3, TextureFilter::kBilinear, 0, 1, 7)};
    scene.bsdfs.push_back(Diffuse{{{}, {0}}});
    scene.materials = {{"m", {0}, {0}}, {"textured", {1}, {0}}};  // both sides are seen
    scene.shapes.back().material = {1};
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {1, Stream::kTest}, 1, SurfaceChoice::kAll, {}};
    const auto rays = std::make_unique<RayLanes>();
    const auto points = std::make_unique<PointLanes>();
    test::RandomSource random{3005};
    for (std::size_t i = 0; i < kBatchSamples; ++i) {
        auto [origin, direction] = random_ray(random);
        if (i % 4 == 0) origin = origin * 0.1f + Vec3f{0, -0.8f, 0};  // most are in that sphere
        const Hit hit = first_hit(traced.geometry->accel, origin, direction);
        set(rays->rays.origin, i, origin), set(rays->rays.direction, i, direction);
        rays->shape[i] = hit.shape, rays->primitive[i] = hit.primitive;
        rays->distance[i] = hit.distance, rays->u[i] = hit.u, rays->v[i] = hit.v;
    }
    find_points(input, kBatchSamples, *rays, *points);
    std::array<int, 5> seen{};
    std::array<int, 2> of_last{};
    for (std::size_t k = 0; k < points->live.count; ++k) {
        const std::size_t i = points->live.lane[k], s = points->sample[i];
        const Surface one = surface_at(scene, traced.geometry->triangles, hit_of(*rays, s),
                                       get(rays->rays.origin, s), get(rays->rays.direction, s));
        EXPECT_EQ(get(points->position, i), one.position);
        EXPECT_EQ(get(points->geometric_normal, i), one.geometric_normal);
        EXPECT_EQ(get(points->s, i), one.shading.s);
        EXPECT_EQ(get(points->t, i), one.shading.t);
        EXPECT_EQ(get(points->n, i), one.shading.n);
        if (points->bsdf[i] == BsdfId{1}) {
            EXPECT_EQ((Vec2f{points->u[i], points->v[i]}), one.uv);
        }
        ++seen[static_cast<std::size_t>(rays->shape[s])];
        if (rays->shape[s] == 4) ++of_last[static_cast<std::size_t>(points->bsdf[i].value)];
    }
    for (const int count : of_last) EXPECT_GT(count, 10);
    for (const int count : seen) EXPECT_GT(count, 10);
}

TEST(Intersection, SphereIsLeftFromWithin) {
    Sphere sphere;
    sphere.radius = 2;
    const Scene scene = scene_of({sphere});
    const TracedScene traced = prepare(scene);
    const Hit hit = first_hit(traced.geometry->accel, {0.5f, 0, 0}, {1, 0, 0});
    EXPECT_EQ(hit.shape, 0);
    EXPECT_FLOAT_EQ(hit.distance, 1.5f);
}

TEST(Intersection, RayThatLeavesASurfaceDoesNotMeetItAgain) {
    Sphere sphere;
    sphere.center = {100, -50, 30};  // far from the origin: positions are coarse
    const Scene scene = scene_of({sphere});
    const TracedScene traced = prepare(scene);
    test::RandomSource random{3003};
    int left = 0;
    for (int i = 0; i < 5000; ++i) {
        const Vec3f origin{90, random.next(-52, -48), random.next(28, 32)};
        const Hit hit = first_hit(traced.geometry->accel, origin, {1, 0, 0});
        if (hit.shape < 0) continue;
        const Surface s = surface_at(scene, traced.geometry->triangles, hit, origin, {1, 0, 0});
        const Vec3f away = to_world(
            s.shading,
            normalize(Vec3f{random.next(-1, 1), random.next(-1, 1), random.next(0.02f, 1)}));
        const Hit again = first_hit(traced.geometry->accel,
                                    leave_surface(s.position, s.geometric_normal, away), away);
        EXPECT_LT(again.shape, 0);
        ++left;
    }
    EXPECT_GT(left, 500);
}

}  // namespace
}  // namespace burnish
