// A glTF 2.0 model in the making: the document, and the bytes of its binary chunk. Keys are the
// specification's.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "core/vec.h"
#include "scene/texture.h"

namespace burnish {

using GltfJson = nlohmann::json;

struct GltfModel {
    GltfJson json;
    std::string bytes;
};

/// The index of `value` in an array of the document, where it is added unless it is there already.
int index_in(GltfModel& model, const char* array, const GltfJson& value);

// Accessors of new data: their indices. No array may be empty.
int add_positions(GltfModel& model, std::span<const Vec3f> positions);
/// Not of unit length: they are normalised, and where they vanish +z.
int add_normals(GltfModel& model, std::span<const Vec3f> normals);
int add_uvs(GltfModel& model, std::span<const Vec2f> uvs);
int add_indices(GltfModel& model, std::span<const std::uint32_t> indices);

struct GltfTexture {
    std::string png;  ///< of 8 bits
    TextureFilter filter = TextureFilter::kBilinear;
    TextureWrap wrap = TextureWrap::kRepeat;
};
/// Its index.
int add_texture(GltfModel& model, const GltfTexture& texture);

/// Says that the document uses an extension.
void use_extension(GltfModel& model, const char* name);

/// The file: both chunks padded to whole words.
std::string glb_bytes(GltfModel model);

}  // namespace burnish
