// What the tests of the procedural scenes look at: how well a mesh is shaded, and its textures.
#pragma once

#include <algorithm>
#include <cmath>

#include "image/image.h"
#include "scenes/scene_files.h"

namespace burnish::test {

/// The smallest cosine between a triangle's plane and the normal of one of its vertices; -2 where a
/// normal is not of length 1.
inline double worst_normal(const Mesh& mesh) {
    double worst = 1;
    for (const auto& [t] : mesh.triangles) {
        const Vec3f face = normalize(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                           mesh.positions[t[2]] - mesh.positions[t[0]]));
        for (const std::uint32_t v : t) {
            if (!(std::fabs(length(mesh.normals[v]) - 1) < 1e-5f)) return -2;
            worst = std::min(worst, static_cast<double>(dot(face, mesh.normals[v])));
        }
    }
    return worst;
}

/// Area of all triangles in texture coordinates.
inline double uv_area(const Mesh& mesh) {
    double area = 0;
    for (const auto& [t] : mesh.triangles) {
        const Vec2f a = mesh.uvs[t[1]] - mesh.uvs[t[0]], b = mesh.uvs[t[2]] - mesh.uvs[t[0]];
        area += 0.5 * static_cast<double>(std::fabs(a.x * b.y - a.y * b.x));
    }
    return area;
}

/// Root mean square difference between the means of neighbouring blocks of `block` x `block`
/// texels, over sqrt 2: how much there is to see at that scale.
inline double contrast_at(const Image& image, int block, int channel = 0) {
    double sum = 0;
    int count = 0;
    for (int y = 0; y + 2 * block <= image.height; y += 2 * block) {
        for (int x = 0; x + 2 * block <= image.width; x += 2 * block) {
            double mean[2] = {0, 0};
            for (int side = 0; side < 2; ++side)
                for (int j = 0; j < block; ++j)
                    for (int i = 0; i < block; ++i)
                        mean[side] += static_cast<double>(
                            image.at(x + (side ? block : 0) + i, y + j, channel));
            sum += std::pow((mean[0] - mean[1]) / (block * block), 2);
            ++count;
        }
    }
    return std::sqrt(0.5 * sum / count);
}

}  // namespace burnish::test
