// What looks wrong with the textures of unknowns: texels that two places share, more texels than
// pixels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cli/findings.h"
#include "cli/mesh_check.h"

namespace burnish {

namespace {

/// Onto the unit square: a mesh that goes around a texture several times means that.
UvTransform fitted(const Mesh& mesh) {
    Vec2f low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    for (const Vec2f& uv : mesh.uvs) {
        low = {std::min(low.x, uv.x), std::min(low.y, uv.y)};
        high = {std::max(high.x, uv.x), std::max(high.y, uv.y)};
    }
    const float x = 1 / std::max(high.x - low.x, 1e-20f), y = 1 / std::max(high.y - low.y, 1e-20f);
    return {{x, 0, -low.x * x, 0, y, -low.y * y}};
}

/// Whether a material reads the bitmap of a parameter.
bool has_parameter(const Scene& scene, MaterialId material) {
    for (const TextureId id : textures_of(scene, material))
        for (const Parameter& p : scene.parameters)
            if (p.texture == id) return true;
    return false;
}

}  // namespace

void check_overlaps(const Scene& scene, Findings& findings) {
    constexpr int kSide = 512;            // of the grid: a share of the area is all that is asked
    constexpr double kWorthSaying = 0.1;  // a seam or a hidden rim overlaps, too
    std::set<const Mesh*> known;          // several instances may show one
    std::size_t count = 0;
    double most = 0;
    std::string worst;
    for (const Shape& shape : scene.shapes) {
        const Mesh* mesh = shown_mesh(scene, shape);
        if (!mesh || mesh->uvs.empty() || !mesh->lookup_uvs.empty() ||
            !has_parameter(scene, shape.material) || !known.insert(mesh).second)
            continue;
        UvCovers covers = make_covers(kSide, kSide);
        add_covers(*mesh, fitted(*mesh), covers);
        const double share = shares_of(covers).overlapping;
        if (share <= kWorthSaying) continue;
        ++count;
        if (share > most) most = share, worst = shape.id;
    }
    if (count == 0) return;
    const std::string which = count == 1 ? fmt::format("shape '{}'", worst)
                                         : fmt::format("{} shapes, '{}' most of all", count, worst);
    findings.push_back(fmt::format(
        "{}: {:.0f} % of its texture lies on several places of the surface, which overlap in "
        "texture coordinates and get one value together",
        which, 100 * most));
}

void check_resolution(const Scene& scene, std::span<const double> pixels, Findings& findings) {
    constexpr double kMaxTexelsPerPixel = 100;
    std::size_t count = 0, worst = 0;
    double most = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const auto& bitmap = std::get<Bitmap>(scene[scene.parameters[i].texture]);
        const double texels = 1.0 * bitmap.width * bitmap.height;
        if (!(pixels[i] > 0) || texels <= kMaxTexelsPerPixel * pixels[i]) continue;
        ++count;
        if (texels / pixels[i] > most) most = texels / pixels[i], worst = i;
    }
    if (count > 0)
        findings.push_back(fmt::format(
            "{} of the {} parameters have over {:.0f} texels for each pixel that shows them "
            "({:.0f} "
            "of {}): a picture cannot tell these apart",
            count, pixels.size(), kMaxTexelsPerPixel, most, scene.parameters[worst].name));
}

}  // namespace burnish
