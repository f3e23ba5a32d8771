// Numbers of the specification of glTF 2.0 that its reader and its writer share.
#pragma once

#include <cstdint>

namespace burnish::gltf {

constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

/// Types of components.
constexpr unsigned kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125,
                   kFloat = 5126;

}  // namespace burnish::gltf
