// What the procedural scenes are made with, and one entry per scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burnish/core/vec.h"
#include "scenes/procedural.h"

namespace burnish::procedural {

/// A goblet of engraved silver among coloured lamps; the texture to recover is mat-goblet's
/// roughness.
void write_goblet(const std::filesystem::path& folder, const ProceduralOptions& options);

/// Replaces the file by these bytes, whole or not at all. Throws InputError.
void write_whole_file(const std::filesystem::path& file, const std::string& bytes);

struct PatchPoint {
    Vec3<double> position;
    Vec2<double> uv;
};

/// Triangles with smooth normals and texture coordinates, as PLY holds them.
struct PatchMesh {
    std::vector<Vec3f> positions, normals;  ///< per vertex, normals unit
    std::vector<Vec2f> uvs;                 ///< per vertex
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A grid of columns x rows quads over surface(a, b), a and b in [0, 1]. It faces (dp/db) x
/// (dp/da), and so do the normals, by differences; where dp/da vanishes (a pole) the normal is +y
/// and triangles without area are left out.
template <class Surface>
PatchMesh tessellate(int columns, int rows, const Surface& surface);

/// Binary little-endian PLY with x y z nx ny nz u v.
std::string ply_bytes(const PatchMesh& mesh);

// ---- bodies

template <class Surface>
PatchMesh tessellate(int columns, int rows, const Surface& surface) {
    PatchMesh mesh;
    const double step = 1e-4;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            const double a = static_cast<double>(i) / columns, b = static_cast<double>(j) / rows;
            const PatchPoint p = surface(a, b);
            const double b0 = std::fmax(b - step, 0.0), b1 = std::fmin(b + step, 1.0);
            const Vec3<double> da = surface(a + step, b).position - surface(a - step, b).position;
            const Vec3<double> db = surface(a, b1).position - surface(a, b0).position;
            Vec3<double> n = cross(db, da);
            // At a pole da vanishes; the axis of revolution is the normal there.
            n = length_squared(da) < 1e-24 ? Vec3<double>{0, 1, 0} : normalize(n);
            const auto to_float = [](const Vec3<double>& v) {
                return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y),
                             static_cast<float>(v.z)};
            };
            mesh.positions.push_back(to_float(p.position));
            mesh.normals.push_back(to_float(n));
            mesh.uvs.push_back({static_cast<float>(p.uv.x), static_cast<float>(p.uv.y)});
        }
    }
    const auto vertex = [&](int i, int j) {
        return static_cast<std::uint32_t>(j * (columns + 1) + i);
    };
    const auto add = [&](std::uint32_t v0, std::uint32_t v1, std::uint32_t v2) {
        const Vec3f e1 = mesh.positions[v1] - mesh.positions[v0];
        const Vec3f e2 = mesh.positions[v2] - mesh.positions[v0];
        if (length_squared(cross(e1, e2)) > 1e-18f) mesh.triangles.push_back({v0, v1, v2});
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            add(vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1));
            add(vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j));
        }
    }
    return mesh;
}

}  // namespace burnish::procedural
