// Rays against spheres, disks and triangles, compared with textbook formulas in double; surfaces at
// the hits; shadow rays.
#include <gtest/gtest.h>

#include "gradient/small_scene.h"
#include "paths/one_ray.h"

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
