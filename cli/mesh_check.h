// What is wrong with a mesh whose textures are to be recovered.
#pragma once

#include <string>
#include <vector>

#include "core/box.h"
#include "scene/shape.h"
#include "scene/texture.h"

namespace burnish {

struct MeshCheck {
    std::size_t triangles = 0;
    std::size_t without_area = 0;     ///< triangles whose corners lie on a line
    std::size_t without_uv_area = 0;  ///< those of others that cover nothing of the texture
    std::size_t turned_normals = 0;  ///< triangles that all of whose normals look to the other side
    std::size_t outside = 0;         ///< triangles that leave the unit square of the texture
    double used_share = 0;           ///< of the texels that a triangle covers
    double overlapping_share = 0;    ///< of those: covered by more than one triangle
    bool is_closed = false;          ///< every edge has two triangles that run along it each way
    double volume = 0;               ///< of a closed mesh; below 0: its faces look inwards
    Box box;                         ///< of its vertices
};

/// How many triangles cover the centre of each texel, at most 2, the texture repeated.
struct UvCovers {
    int width = 0, height = 0;
    std::vector<unsigned char> count = {};  ///< [height, width]
};
UvCovers make_covers(int width, int height);
/// mesh: with texture coordinates. A triangle that reaches over more than two repetitions of the
/// texture from top to bottom counts as one that covers all of it, whatever its width.
void add_covers(const Mesh& mesh, const UvTransform& to_uv, UvCovers& covers);
/// Shares of the texels that are covered, and of these those that several triangles cover.
struct CoveredShares {
    double used = 0, overlapping = 0;
};
CoveredShares shares_of(const UvCovers& covers);

/// Of a surface so small, or so far from the origin, that rays begin visibly off it: what it is,
/// and what to do, as in "lies 500 times its own size from the origin, ..."; empty: it is not.
std::string complaint_of_place(const Box& box);

/// texture_size: of the texels that are counted, on a side. Without texture coordinates, what
/// belongs to these stays 0.
MeshCheck check_mesh(const Mesh& mesh, int texture_size);

/// Of a mesh with texture coordinates: one sentence for each thing that will go wrong, with what to
/// do.
std::vector<std::string> complaints(const MeshCheck& check);

}  // namespace burnish
