// What a binary glTF 2.0 file has to keep to, of the rules of the specification (and of Khronos'
// validator) that a writer of meshes, materials and pictures can break.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace burnish::testing {

struct GlbContent {
    nlohmann::json json;
    std::string data;
};

template <class T>
T read_at(const std::string& bytes, std::size_t offset) {
    T value{};
    if (offset + sizeof(T) <= bytes.size()) std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return value;
}

/// The two chunks; checks their header, lengths and padding.
inline GlbContent open_glb_content(const std::string& bytes) {
    const auto word = [&](std::size_t at) { return read_at<std::uint32_t>(bytes, at); };
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word(4), 2u);
    EXPECT_EQ(word(8), bytes.size());
    const std::size_t text = word(12);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    EXPECT_EQ(text % 4, 0u);
    const std::size_t data = word(20 + text);
    EXPECT_EQ(bytes.substr(24 + text, 4), std::string("BIN\0", 4));
    EXPECT_EQ(data % 4, 0u);
    EXPECT_EQ(28 + text + data, bytes.size());
    return {nlohmann::json::parse(bytes.substr(20, text)), bytes.substr(28 + text)};
}

/// The numbers of an accessor of floats, flat.
inline std::vector<float> floats_of(const GlbContent& glb, std::size_t accessor) {
    const auto& a = glb.json["accessors"][accessor];
    const auto& view = glb.json["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::map<std::string, std::size_t> sizes{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}};
    std::vector<float> values(a["count"].get<std::size_t>() * sizes.at(a["type"]));
    std::memcpy(values.data(), glb.data.data() + view["byteOffset"].get<std::size_t>(),
                values.size() * sizeof(float));
    return values;
}

inline std::vector<std::uint32_t> indices_of(const GlbContent& glb, std::size_t accessor) {
    const std::vector<float> raw = floats_of(glb, accessor);
    std::vector<std::uint32_t> values(raw.size());
    if (!raw.empty()) std::memcpy(values.data(), raw.data(), 4 * raw.size());
    return values;
}

inline void check_views(const GlbContent& glb) {
    const std::size_t length = glb.json["buffers"][0]["byteLength"];
    EXPECT_EQ(glb.json["buffers"].size(), 1u);
    EXPECT_LE(length, glb.data.size());
    EXPECT_LT(glb.data.size() - length, 4u);
    std::size_t end = 0;
    for (const auto& view : glb.json["bufferViews"]) {
        const std::size_t from = view["byteOffset"];
        EXPECT_EQ(from % 4, 0u);
        EXPECT_GE(from, end);  // none overlaps another
        EXPECT_GT(view["byteLength"].get<std::size_t>(), 0u);
        end = from + view["byteLength"].get<std::size_t>();
    }
    EXPECT_LE(end, length);
}

inline void check_accessors(const GlbContent& glb) {
    const std::map<std::string, std::size_t> sizes{{"SCALAR", 4}, {"VEC2", 8}, {"VEC3", 12}};
    for (const auto& a : glb.json["accessors"]) {
        const auto& view = glb.json["bufferViews"][a["bufferView"].get<std::size_t>()];
        EXPECT_GT(a["count"].get<std::size_t>(), 0u);
        EXPECT_EQ(a["count"].get<std::size_t>() * sizes.at(a["type"]), view["byteLength"]);
        EXPECT_TRUE(a["componentType"] == 5126 || a["componentType"] == 5125);
    }
}

/// Exact bounds, normals of unit length, indices within, as many of everything as positions.
inline void check_primitive(const GlbContent& glb, const nlohmann::json& primitive) {
    const auto& attributes = primitive["attributes"];
    const std::vector<float> positions = floats_of(glb, attributes["POSITION"]);
    const auto& accessor = glb.json["accessors"][attributes["POSITION"].get<std::size_t>()];
    for (std::size_t c = 0; c < 3; ++c) {
        float low = std::numeric_limits<float>::infinity(), high = -low;
        for (std::size_t i = c; i < positions.size(); i += 3)
            low = std::min(low, positions[i]), high = std::max(high, positions[i]);
        EXPECT_EQ(accessor["min"][c].get<float>(), low);
        EXPECT_EQ(accessor["max"][c].get<float>(), high);
    }
    for (const auto& [name, index] : attributes.items())
        EXPECT_EQ(glb.json["accessors"][index.get<std::size_t>()]["count"], positions.size() / 3)
            << name;
    if (attributes.contains("NORMAL")) {
        const std::vector<float> n = floats_of(glb, attributes["NORMAL"]);
        for (std::size_t i = 0; i < n.size(); i += 3)
            EXPECT_NEAR(n[i] * n[i] + n[i + 1] * n[i + 1] + n[i + 2] * n[i + 2], 1, 1e-5);
    }
    const std::vector<std::uint32_t> indices = indices_of(glb, primitive["indices"]);
    EXPECT_EQ(indices.size() % 3, 0u);
    for (const std::uint32_t i : indices) EXPECT_LT(i, positions.size() / 3);
}

/// Calls check(texture info) for every texture below an object.
template <class Check>
void for_each_texture(const nlohmann::json& object, const Check& check) {
    for (const auto& [key, value] : object.items()) {
        if (key.size() > 7 && key.substr(key.size() - 7) == "Texture") check(value);
        if (value.is_object()) for_each_texture(value, check);
    }
}

inline void check_materials(const GlbContent& glb) {
    std::set<std::string> used, said;
    for (const auto& name : glb.json.value("extensionsUsed", nlohmann::json::array()))
        said.insert(name);
    for (const auto& mesh : glb.json["meshes"])
        for (const auto& primitive : mesh["primitives"]) {
            const auto& material = glb.json["materials"][primitive["material"].get<std::size_t>()];
            for_each_texture(material, [&](const nlohmann::json& texture) {
                EXPECT_LT(texture["index"].get<std::size_t>(), glb.json["textures"].size());
                EXPECT_TRUE(primitive["attributes"].contains(
                    "TEXCOORD_" + std::to_string(texture["texCoord"].get<int>())))
                    << texture;
            });
            const auto extensions = material.value("extensions", nlohmann::json::object());
            for (const auto& [name, value] : extensions.items()) used.insert(name);
        }
    EXPECT_EQ(used, said);
    for (const auto& texture : glb.json.value("textures", nlohmann::json::array())) {
        EXPECT_LT(texture["source"].get<std::size_t>(), glb.json["images"].size());
        EXPECT_LT(texture["sampler"].get<std::size_t>(), glb.json["samplers"].size());
    }
}

/// The PNG of a texture.
inline std::string png_of(const GlbContent& glb, const nlohmann::json& texture_info) {
    const auto& texture = glb.json["textures"][texture_info["index"].get<std::size_t>()];
    const auto& image = glb.json["images"][texture["source"].get<std::size_t>()];
    EXPECT_EQ(image["mimeType"], "image/png");
    const auto& view = glb.json["bufferViews"][image["bufferView"].get<std::size_t>()];
    return glb.data.substr(view["byteOffset"], view["byteLength"]);
}

inline GlbContent check_glb(const std::string& bytes) {
    GlbContent glb = open_glb_content(bytes);
    EXPECT_EQ(glb.json["asset"]["version"], "2.0");
    check_views(glb);
    check_accessors(glb);
    for (const auto& mesh : glb.json["meshes"])
        for (const auto& primitive : mesh["primitives"]) check_primitive(glb, primitive);
    check_materials(glb);
    for (const auto& [name, value] : glb.json.items())
        EXPECT_FALSE(value.is_array() && value.empty()) << name << " is empty";
    return glb;
}

}  // namespace burnish::testing
