// Typed indices into the arrays of a Scene.
#pragma once

#include <cstdint>

namespace burnish {

template <class Tag>
struct Id {
    std::int32_t value = -1;
    explicit operator bool() const { return value >= 0; }
    friend bool operator==(Id, Id) = default;
};

using TextureId = Id<struct TextureTag>;
using BsdfId = Id<struct BsdfTag>;
using MaterialId = Id<struct MaterialTag>;
using EmitterId = Id<struct EmitterTag>;
using ShapeId = Id<struct ShapeTag>;

}  // namespace burnish
