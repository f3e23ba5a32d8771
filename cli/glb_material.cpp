#include "cli/glb_material.h"

#include <array>
#include <cmath>
#include <optional>

namespace burnish {

namespace {

/// Nothing where the object lacks it.
std::optional<Value> find(const Value& object, const char* name) {
    if (!has(object, name)) return std::nullopt;
    return std::optional<Value>(member(object, name));
}

std::optional<Value> first_texture(const Value& material) {
    if (const auto pbr = find(material, "pbrMetallicRoughness"))
        for (const char* name : {"baseColorTexture", "metallicRoughnessTexture"})
            if (auto texture = find(*pbr, name)) return texture;
    for (const char* name : {"normalTexture", "occlusionTexture", "emissiveTexture"})
        if (auto texture = find(material, name)) return texture;
    return std::nullopt;
}

/// Translation * rotation * scale. The rotation is counterclockwise as one looks at the picture,
/// whose v runs downwards.
UvTransform uv_transform(const Value& extension) {
    constexpr double kMax = 1e9;
    const auto pair = [&](const char* name, double otherwise) {
        return has(extension, name) ? numbers(member(extension, name), 2)
                                    : std::vector<double>{otherwise, otherwise};
    };
    const std::vector<double> offset = pair("offset", 0), scale = pair("scale", 1);
    const double angle = has(extension, "rotation") ? number(member(extension, "rotation")) : 0,
                 c = std::cos(angle), s = std::sin(angle);
    const std::array<double, 6> m{scale[0] * c,  scale[1] * s, offset[0],
                                  -scale[0] * s, scale[1] * c, offset[1]};
    UvTransform t;
    for (std::size_t i = 0; i < m.size(); ++i) {
        if (!(std::abs(m[i]) < kMax)) fail(extension, "a transform of numbers below 1e9");
        t.m[i] = static_cast<float>(m[i]);
    }
    return t;
}

}  // namespace

GlbMaterial read_material(const Glb& glb, std::size_t index) {
    constexpr double kMax = 1e9;
    GlbMaterial read;
    if (index >= count_of(document(glb), "materials")) return read;
    const Value material = element(member(document(glb), "materials"), index);
    read.is_double_sided =
        has(material, "doubleSided") && member(material, "doubleSided").value == true;
    const std::optional<Value> texture = first_texture(material);
    if (!texture) return read;
    read.uv_set = whole_or(*texture, "texCoord", 0, kMax);
    const auto extensions = find(*texture, "extensions");
    if (!extensions) return read;
    if (const auto transform = find(*extensions, "KHR_texture_transform")) {
        read.uv_set = whole_or(*transform, "texCoord", read.uv_set, kMax);
        read.to_uv = uv_transform(*transform);
    }
    return read;
}

}  // namespace burnish
