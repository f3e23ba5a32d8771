// What the procedural scenes are made with, and one entry per scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/vec.h"
#include "scene/shape.h"
#include "scenes/procedural_options.h"

namespace burnish::procedural {

/// A goblet of engraved silver among coloured lamps; the texture to recover is mat-goblet's
/// roughness.
void write_goblet(const std::filesystem::path& folder, const ProceduralOptions& options);

/// A tyre with white letters on a workshop floor under four soft boxes; mat-tyre's roughness.
void write_tyre(const std::filesystem::path& folder, const ProceduralOptions& options);

/// A bowl of brushed bronze under a ring light; mat-bowl's anisotropic.
void write_bowl(const std::filesystem::path& folder, const ProceduralOptions& options);

/// A decorated tree among hundreds of coloured bulbs; mat-tree's base_color.
void write_tree(const std::filesystem::path& folder, const ProceduralOptions& options);

struct PatchPoint {
    Vec3<double> position;
    Vec2<double> uv;
};

/// Half-widths of the differences that normals are made of. The default gives the normal of the
/// surface itself; where relief changes within a cell that normal may turn away from the triangles,
/// and steps of a cell follow them.
struct NormalStep {
    double a = 1e-4, b = 1e-4;
};
inline NormalStep cell_step(int columns, int rows) { return {1.0 / columns, 1.0 / rows}; }

/// A grid of columns x rows quads over surface(a, b), a and b in [0, 1]. It faces (dp/db) x
/// (dp/da), and so do the normals, by differences; where dp/da vanishes (a pole of the y axis) the
/// normal is +y or -y, and triangles without area are left out.
template <class Surface>
Mesh tessellate(int columns, int rows, const Surface& surface, const NormalStep& step = {});

/// A triangle of its own three vertices with the normal of its plane, on the side from which a, b,
/// c run counterclockwise; texture coordinates 0.
void add_flat_triangle(Mesh& mesh, const Vec3<double>& a, const Vec3<double>& b,
                       const Vec3<double>& c);

/// Adds the triangles of `part`.
void append_mesh(Mesh& mesh, const Mesh& part);

/// A floor of the given half-width from z = front back to z = -back, and a wall of that height that
/// rises from it in an arc. u runs over the width, v from the front edge to the top of the wall.
struct Backdrop {
    double half_width = 3, front = 3, back = 2, height = 3, arc = 0.5;
};
Mesh make_backdrop(const Backdrop& shape);
/// v where the arc begins, at the back of the floor.
double backdrop_floor_end(const Backdrop& shape);

/// Binary little-endian PLY with x y z nx ny nz u v. The mesh has normals and texture coordinates,
/// as those made here.
std::string ply_bytes(const Mesh& mesh);

template <class Surface>
Mesh tessellate(int columns, int rows, const Surface& surface, const NormalStep& step) {
    Mesh mesh;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            const double a = static_cast<double>(i) / columns, b = static_cast<double>(j) / rows;
            const PatchPoint p = surface(a, b);
            const double b0 = std::fmax(b - step.b, 0.0), b1 = std::fmin(b + step.b, 1.0);
            const Vec3<double> da =
                surface(a + step.a, b).position - surface(a - step.a, b).position;
            const Vec3<double> db = surface(a, b1).position - surface(a, b0).position;
            Vec3<double> n = cross(db, da);
            // At a pole da vanishes; the axis of revolution is the normal there, on the side of
            // the triangles around it.
            if (length_squared(da) < 1e-24) {
                const double beside = b < 0.5 ? b + step.b : b - step.b;
                const Vec3<double> around =
                    surface(a + step.a, beside).position - surface(a - step.a, beside).position;
                n = {0, cross(db, around).y < 0 ? -1.0 : 1.0, 0};
            }
            n = normalize(n);
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
