#include "burnish/paths/surface.h"

#include <algorithm>
#include <numbers>

namespace burnish {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

Surface at_mesh(const Mesh& mesh, const Hit& hit) {
    const auto [i0, i1, i2] = mesh.triangles[static_cast<std::size_t>(hit.primitive)].vertex;
    const float w1 = hit.u, w2 = hit.v, w0 = 1.0f - w1 - w2;
    const Vec3f &p0 = mesh.positions[i0], &p1 = mesh.positions[i1], &p2 = mesh.positions[i2];
    const Vec3f e1 = p1 - p0, e2 = p2 - p0;

    Surface s;
    s.position = p0 * w0 + p1 * w1 + p2 * w2;
    s.geometric_normal = normalize(cross(e1, e2));
    const Vec3f n =
        mesh.normals.empty()
            ? s.geometric_normal
            : normalize(mesh.normals[i0] * w0 + mesh.normals[i1] * w1 + mesh.normals[i2] * w2);
    if (mesh.uvs.empty()) {
        s.uv = {w1, w2};
        s.shading = frame_from_tangent(n, frame_from_normal(s.geometric_normal).s);
        return s;
    }
    const Vec2f &t0 = mesh.uvs[i0], &t1 = mesh.uvs[i1], &t2 = mesh.uvs[i2];
    s.uv = t0 * w0 + t1 * w1 + t2 * w2;
    const Vec2f d1 = t1 - t0, d2 = t2 - t0;
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    const Vec3f dp_du = determinant != 0.0f ? (e1 * d2.y - e2 * d1.y) * (1.0f / determinant)
                                            : frame_from_normal(s.geometric_normal).s;
    s.shading = frame_from_tangent(n, dp_du);
    return s;
}

Surface at_sphere(const Sphere& sphere, const Vec3f& hit_position) {
    Surface s;
    const Vec3f outward = normalize(hit_position - sphere.center);
    s.position = sphere.center + outward * sphere.radius;
    // Columns of the rotation are the local axes in the world.
    const auto axis = [&](int i) {
        return normalize(Vec3f{static_cast<float>(sphere.to_world(0, i)),
                               static_cast<float>(sphere.to_world(1, i)),
                               static_cast<float>(sphere.to_world(2, i))});
    };
    const Vec3f ax = axis(0), ay = axis(1), az = axis(2);
    const Vec3f local{dot(outward, ax), dot(outward, ay), dot(outward, az)};
    float azimuth = std::atan2(local.y, local.x);
    if (azimuth < 0) azimuth += 2 * kPi;
    s.uv = {azimuth / (2 * kPi), std::acos(std::clamp(local.z, -1.0f, 1.0f)) / kPi};
    const Vec3f dp_du = local.x == 0 && local.y == 0 ? ax : ax * -local.y + ay * local.x;
    s.geometric_normal = sphere.flip_normals ? -outward : outward;
    s.shading = frame_from_tangent(s.geometric_normal, dp_du);
    return s;
}

Surface at_disk(const Disk& disk, const Vec3f& hit_position) {
    Surface s;
    s.position = hit_position;
    const Vec3f local = transform_point(disk.to_local, hit_position);
    const float r = std::sqrt(local.x * local.x + local.y * local.y);
    float azimuth = std::atan2(local.y, local.x);
    if (azimuth < 0) azimuth += 2 * kPi;
    s.uv = {r, azimuth / (2 * kPi)};
    const Vec3f n = transform_normal(disk.to_local, {0, 0, 1});
    const Vec3f radial = r > 0 ? Vec3f{local.x / r, local.y / r, 0} : Vec3f{1, 0, 0};
    s.geometric_normal = disk.flip_normals ? -n : n;
    s.shading = frame_from_tangent(s.geometric_normal, transform_vector(disk.to_world, radial));
    return s;
}

}  // namespace

Surface surface_at(const Scene& scene, const Hit& hit, const Vec3f& origin,
                   const Vec3f& direction) {
    const Geometry& geometry = scene.shapes[static_cast<std::size_t>(hit.shape)].geometry;
    if (const auto* mesh = std::get_if<Mesh>(&geometry)) return at_mesh(*mesh, hit);
    const Vec3f position = origin + direction * hit.distance;
    if (const auto* sphere = std::get_if<Sphere>(&geometry)) return at_sphere(*sphere, position);
    return at_disk(std::get<Disk>(geometry), position);
}

SurfacePoint mesh_point(const Mesh& mesh, std::int32_t triangle, float u, float v) {
    const auto [i0, i1, i2] = mesh.triangles[static_cast<std::size_t>(triangle)].vertex;
    const float w0 = 1.0f - u - v;
    const Vec3f &p0 = mesh.positions[i0], &p1 = mesh.positions[i1], &p2 = mesh.positions[i2];
    const Vec3f n = normalize(cross(p1 - p0, p2 - p0));
    return {p0 * w0 + p1 * u + p2 * v, n,
            mesh.normals.empty()
                ? n
                : normalize(mesh.normals[i0] * w0 + mesh.normals[i1] * u + mesh.normals[i2] * v)};
}

}  // namespace burnish
