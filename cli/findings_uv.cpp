// What looks wrong with the textures of unknowns: texels that two places share, more texels than
// pixels.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "cli/console.h"
#include "cli/findings.h"
#include "cli/mesh_check.h"
#include "core/parallel.h"

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

constexpr double kWorthSaying = 0.1;  // a seam or a hidden rim overlaps, too

/// Of a grid for each of so many meshes: a share of the area is all that is asked, and all grids
/// together are filled in about a second.
int grid_side(std::size_t meshes) {
    constexpr double kMaxCells = 1 << 26;  // of all grids
    return static_cast<int>(
        std::clamp(std::sqrt(kMaxCells / static_cast<double>(meshes)), 32.0, 512.0));
}

UvCovers covers_of(const Mesh& mesh, const UvTransform& to_uv, int side) {
    UvCovers covers = make_covers(side, side);
    add_covers(mesh, to_uv, covers);
    return covers;
}

/// The mesh that a shape shows, null where it has no texture coordinates to read textures at.
const Mesh* unwrapped_mesh(const Scene& scene, const Shape& shape) {
    const Mesh* mesh = shown_mesh(scene, shape);
    return mesh && !mesh->uvs.empty() && mesh->lookup_uvs.empty() ? mesh : nullptr;
}

struct TextureReader {
    const Mesh* mesh;
    std::string shape;  ///< several instances may show the mesh: the first one
};

std::vector<TextureReader> readers_of(const Scene& scene, TextureId texture) {
    std::vector<TextureReader> readers;
    std::set<const Mesh*> known;
    for (const Shape& shape : scene.shapes) {
        const Mesh* mesh = unwrapped_mesh(scene, shape);
        if (mesh && std::ranges::count(textures_of(scene, shape.material), texture) > 0 &&
            known.insert(mesh).second)
            readers.push_back({mesh, shape.id});
    }
    return readers;
}

std::vector<const Mesh*> meshes_of(const std::vector<TextureReader>& readers) {
    std::vector<const Mesh*> meshes;
    for (const TextureReader& reader : readers) meshes.push_back(reader.mesh);
    return meshes;
}

/// Those that read a parameter.
std::vector<TextureReader> readers_of_parameters(const Scene& scene) {
    std::vector<TextureReader> readers;
    std::set<const Mesh*> known;
    for (const Shape& shape : scene.shapes) {
        const Mesh* mesh = unwrapped_mesh(scene, shape);
        if (mesh && has_parameter(scene, shape.material) && known.insert(mesh).second)
            readers.push_back({mesh, shape.id});
    }
    return readers;
}

/// How many of the meshes cover each texel, at most 2.
UvCovers count_meshes(const std::vector<TextureReader>& readers, const UvTransform& to_uv,
                      int side) {
    UvCovers meshes = make_covers(side, side);
    for (const TextureReader& reader : readers) {
        const UvCovers covers = covers_of(*reader.mesh, to_uv, side);
        for (std::size_t i = 0; i < covers.count.size(); ++i)
            if (covers.count[i] > 0 && meshes.count[i] < 2) ++meshes.count[i];
    }
    return meshes;
}

/// Those that share so much of what they cover themselves. Where so much of all is shared, they are
/// two at least.
std::string sharing_shapes(const std::vector<TextureReader>& readers, const UvTransform& to_uv,
                           const UvCovers& meshes) {
    std::vector<std::string> names;
    for (const TextureReader& reader : readers) {
        const UvCovers covers = covers_of(*reader.mesh, to_uv, meshes.width);
        std::size_t own = 0, shared = 0;
        for (std::size_t i = 0; i < covers.count.size(); ++i)
            if (covers.count[i] > 0) ++own, shared += meshes.count[i] > 1;
        if (static_cast<double>(shared) > kWorthSaying * static_cast<double>(own))
            names.push_back("'" + reader.shape + "'");
    }
    const std::size_t others = names.size() - std::min<std::size_t>(names.size(), 2);
    names.resize(names.size() - others);
    if (others == 0) return fmt::format("{}", fmt::join(names, " and "));
    return fmt::format("{} and {}", fmt::join(names, ", "), count_text(others, "other"));
}

}  // namespace

void check_overlaps(const Scene& scene, Findings& findings) {
    const std::vector<TextureReader> meshes = readers_of_parameters(scene);
    std::vector<double> shares(meshes.size());
    const int side = grid_side(meshes.size());
    parallel_for(meshes.size(), [&](std::size_t i) {
        const Mesh& mesh = *meshes[i].mesh;
        shares[i] = shares_of(covers_of(mesh, fitted(mesh), side)).overlapping;
    });
    std::size_t count = 0;
    double max = 0;
    std::string worst;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (shares[i] <= kWorthSaying) continue;
        ++count;
        if (shares[i] > max) max = shares[i], worst = meshes[i].shape;
    }
    if (count == 0) return;
    const std::string which = count == 1 ? fmt::format("shape '{}'", worst)
                                         : fmt::format("{} shapes, '{}' most of all", count, worst);
    findings.push_back(fmt::format(
        "{}: {:.0f} % of its texture lies on several places of the surface, which overlap in "
        "texture coordinates and get one value together",
        which, 100 * max));
}

void check_shared_textures(const Scene& scene, Findings& findings) {
    std::size_t count = 0;
    double max = 0;
    std::string worst;
    const int side = grid_side(readers_of_parameters(scene).size());
    std::vector<TextureId> known;  // several parameters may be one
    std::map<std::pair<std::vector<const Mesh*>, std::array<float, 6>>, double> shares;
    for (const Parameter& p : scene.parameters) {
        if (std::ranges::count(known, p.texture) > 0) continue;
        known.push_back(p.texture);
        const std::vector<TextureReader> readers = readers_of(scene, p.texture);
        if (readers.size() < 2) continue;
        const UvTransform& to_uv = std::get<Bitmap>(scene[p.texture]).to_uv;
        // The textures of a material have the same readers, so they are counted once.
        const auto [of_readers, is_new] = shares.try_emplace({meshes_of(readers), to_uv.m});
        double& share = of_readers->second;
        std::optional<UvCovers> meshes;
        if (is_new)
            share = shares_of(meshes.emplace(count_meshes(readers, to_uv, side))).overlapping;
        if (share <= kWorthSaying) continue;
        ++count;
        if (share <= max) continue;  // so are those of others with the same readers
        max = share;
        worst = fmt::format(
            "shapes {} share {:.0f} % of the used texels of {}, which get one value together",
            sharing_shapes(readers, to_uv, *meshes), 100 * share, p.name);
    }
    if (count > 1)
        worst +=
            fmt::format("; so it is with {} other parameter{}", count - 1, count == 2 ? "" : "s");
    if (count > 0) findings.push_back(worst);
}

void check_resolution(const Scene& scene, std::span<const double> pixels, Findings& findings) {
    constexpr double kMaxTexelsPerPixel = 100;
    std::size_t count = 0, worst = 0;
    double max = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const auto& bitmap = std::get<Bitmap>(scene[scene.parameters[i].texture]);
        const double texels = 1.0 * bitmap.width * bitmap.height;
        if (!(pixels[i] > 0) || texels <= kMaxTexelsPerPixel * pixels[i]) continue;
        ++count;
        if (texels / pixels[i] > max) max = texels / pixels[i], worst = i;
    }
    if (count > 0)
        findings.push_back(fmt::format(
            "{} of the {} parameters have over {:.0f} texels for each pixel that shows them "
            "({:.0f} "
            "of {}): a picture cannot tell these apart",
            count, pixels.size(), kMaxTexelsPerPixel, max, scene.parameters[worst].name));
}

}  // namespace burnish
