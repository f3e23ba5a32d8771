#include "mitsuba/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/joined.h"
#include "mitsuba/loader.h"

namespace burnish::mitsuba {

namespace {

/// Blocks of 2 x 2 texels, about as many across as down.
struct Atlas {
    std::size_t across = 1, down = 1;
};

Atlas atlas_of(std::size_t triangles) {
    const auto across =
        static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(triangles))));
    return {across, (triangles + across - 1) / across};
}

/// The colour of an attribute at a vertex or a face.
std::array<float, 3> value_at(const MeshAttribute& attribute, std::size_t at, float scale) {
    std::array<float, 3> value{};
    const auto stride = static_cast<std::size_t>(attribute.channels);
    for (std::size_t c = 0; c < std::min<std::size_t>(3, stride); ++c)
        value[c] = attribute.values[at * stride + c] * scale;
    return value;
}

/// forgotten: the elements that need no other visit.
void forget_attributes(Loader& loader, const Node& node, std::set<const Node*>& forgotten) {
    if (!reads_attribute(loader, node) || !forgotten.insert(&node).second) return;
    loader.textures.erase(&node), loader.bsdfs.erase(&node), loader.materials.erase(&node);
    for (const Node& child : node.children)
        forget_attributes(loader, target_of(loader.document, child), forgotten);
}

/// Where each corner of each triangle reads the bitmaps of attribute_bitmap: [3 * triangles].
std::vector<Vec2f> attribute_uvs(std::size_t triangles) {
    const Atlas atlas = atlas_of(triangles);
    const auto at = [](std::size_t texel, std::size_t blocks) {
        return static_cast<float>((static_cast<double>(texel) + 0.5) /
                                  (2.0 * static_cast<double>(blocks)));
    };
    std::vector<Vec2f> uvs;
    uvs.reserve(3 * triangles);
    for (std::size_t i = 0; i < triangles; ++i) {
        const std::size_t x = 2 * (i % atlas.across), y = 2 * (i / atlas.across);
        const auto corner = [&](std::size_t dx, std::size_t dy) {
            return Vec2f{at(x + dx, atlas.across), at(y + dy, atlas.down)};
        };
        uvs.insert(uvs.end(), {corner(0, 0), corner(1, 0), corner(0, 1)});
    }
    return uvs;
}

/// Three where the attribute has three or more of them, else one.
int channels_of(const MeshAttribute& attribute) { return attribute.channels >= 3 ? 3 : 1; }

/// Of attribute_bitmap.
std::size_t count_values(const Atlas& atlas, const MeshAttribute& attribute) {
    return 4 * atlas.across * atlas.down * static_cast<std::size_t>(channels_of(attribute));
}

/// At least one triangle.
Bitmap attribute_bitmap(const std::vector<Triangle>& triangles, const MeshAttribute& attribute,
                        float scale) {
    const Atlas atlas = atlas_of(triangles.size());
    Bitmap bitmap;
    bitmap.width = static_cast<int>(2 * atlas.across);
    bitmap.height = static_cast<int>(2 * atlas.down);
    bitmap.channels = channels_of(attribute);
    bitmap.wrap = TextureWrap::kClamp;
    bitmap.raw = bitmap.is_attribute = true;
    bitmap.file = attribute.name;
    bitmap.values.resize(count_values(atlas, attribute));
    const auto put = [&](std::size_t x, std::size_t y, const std::array<float, 3>& value) {
        const auto channels = static_cast<std::size_t>(bitmap.channels);
        std::copy_n(value.begin(), channels, &bitmap.values[(y * 2 * atlas.across + x) * channels]);
    };
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        std::array<std::array<float, 3>, 3> corner;
        for (std::size_t k = 0; k < 3; ++k)
            corner[k] = value_at(attribute, attribute.of_faces ? i : triangles[i].vertex[k], scale);
        std::array<float, 3> opposite;  // makes the four of them affine
        for (std::size_t c = 0; c < 3; ++c)
            opposite[c] = corner[1][c] + corner[2][c] - corner[0][c];
        const std::size_t x = 2 * (i % atlas.across), y = 2 * (i / atlas.across);
        put(x, y, corner[0]), put(x + 1, y, corner[1]), put(x, y + 1, corner[2]);
        put(x + 1, y + 1, opposite);
    }
    return bitmap;
}

/// By its name, or else by that without "_color": vertex_tint finds vertex_tint_color, and vertex
/// the colour. nullptr: none.
const MeshAttribute* find_attribute(const std::vector<MeshAttribute>& attributes,
                                    const std::string& name) {
    for (const std::string& wanted : {name, name + "_color"})
        for (const MeshAttribute& a : attributes)
            if (a.name == wanted) return &a;
    return nullptr;
}

/// What is there beside the scene, and the bitmap that is about to be.
void tell_bitmap(const Loader& loader, const MeshAttribute& attribute) {
    if (!loader.options.before_reading) return;
    const AttributeSource& source = loader.attributes;
    std::size_t values = count_values(atlas_of(source.triangles.size()), attribute);
    for (const MeshAttribute& a : source.attributes) values += a.values.size();
    loader.options.before_reading(
        source.file,
        static_cast<double>(values * sizeof(float) + source.triangles.size() * sizeof(Triangle)),
        loader.kept);
}

}  // namespace

Bitmap read_mesh_attribute(Loader& loader, Properties& properties) {
    const std::string name = take_string(properties, "name", "");
    const float scale = take_float(properties, "scale", 1);
    const std::vector<MeshAttribute>& attributes = loader.attributes.attributes;
    if (const MeshAttribute* a = find_attribute(attributes, name)) {
        loader.outside[properties.node] =
            outside_values(fmt::format("the mesh attribute \"{}\"", name), a->values, scale);
        tell_bitmap(loader, *a);
        Bitmap bitmap = attribute_bitmap(loader.attributes.triangles, *a, scale);
        loader.kept += static_cast<double>(bitmap.values.size() * sizeof(float));
        return bitmap;
    }
    const std::string known =
        joined(attributes, [](const MeshAttribute& a) { return "\"" + a.name + "\""; });
    fail(properties.node->place, fmt::format("the shape has no attribute \"{}\": expected {}", name,
                                             known.empty() ? "a PLY mesh that has it" : known));
}

void use_attributes(Loader& loader, const Properties& properties, Shape& shape,
                    const std::vector<TextureId>& textures) {
    const auto is_attribute = [&](TextureId id) {
        const Bitmap* bitmap = bitmap_of(loader.result.scene[id]);
        return bitmap && bitmap->is_attribute;
    };
    if (std::none_of(textures.begin(), textures.end(), is_attribute)) return;
    if (!std::all_of(textures.begin(), textures.end(), is_attribute))
        fail_unsupported(properties.node->place,
                         "a shape whose bsdf or emitter reads a mesh attribute beside another "
                         "texture is not supported yet: expected mesh attributes alone");
    auto& mesh = std::get<Mesh>(shape.geometry);
    mesh.lookup_uvs = attribute_uvs(mesh.triangles.size());
    loader.kept += static_cast<double>(mesh.lookup_uvs.size() * sizeof(Vec2f));
}

bool reads_attribute(Loader& loader, const Node& node) {
    if (const auto known = loader.attribute_readers.find(&node);
        known != loader.attribute_readers.end())
        return known->second;
    bool reads = node.tag == "texture" && attribute(node, "type") == "mesh_attribute";
    for (const Node& child : node.children)
        reads = reads || reads_attribute(loader, target_of(loader.document, child));
    loader.attribute_readers.emplace(&node, reads);
    return reads;
}

void forget_attributes(Loader& loader, const Node& node) {
    std::set<const Node*> forgotten;
    forget_attributes(loader, node, forgotten);
}

}  // namespace burnish::mitsuba
