// What a point shows where its material is a blend or has a normal map: one ray at a time.
#pragma once

#include <span>

#include "paths/bsdf_columns.h"
#include "paths/surface.h"
#include "shading/texture.h"

namespace burnish {

/// A ray that meets a surface there, seen against its direction.
struct LayeredPoint {
    Vec3f origin, direction;  ///< of the ray
    Vec2f uv;
};

/// Which weights of blends are unknowns, and what they hold.
struct UnknownWeights {
    std::span<const int> slots = {};  ///< of each texture of the scene, -1: none; empty: none is
    /// TraceInput::mixture: values in the place of texels.
    std::span<const ConstantTextures> mixture = {};
};

/// What a point shows of a blend. Where a weight is known and in [0, 1], all of it is in the
/// probability with which it was drawn. Others, w, are drawn with a probability p: what they show
/// counts w / p and (1 - w) / (1 - p). Of unknown weights both parts occur, and what counts is the
/// w of the day and the p of birth. Of known ones beyond [0, 1] the parts occur as |w| : |1 - w|.
struct ShownMaterial {
    MaterialId material;
    float share = 1;  ///< product of the unknown w, or 1 - w
    /// Product of their p, or 1 - p, and of p / w, or (1 - p) / (1 - w), of the known ones: at most
    /// 1; negative where an odd number of known factors is.
    float chance = 1;
};

/// The material that the point shows: of a blend one of the two. The number that decides is a
/// function of the ray's bits, so that the same ray shows the same.
ShownMaterial shown_material(const Scene& scene, const TextureTable& textures, MaterialId material,
                             const LayeredPoint& point, const UnknownWeights& unknowns = {});

/// The frame about the normal that a map has at a point, and the normal that it had without, on the
/// side of the material that is seen. Left-handed where a mirrored material is seen from behind.
struct TurnedFrame {
    Frame shading;
    Vec3f old_normal;
};

/// surface: that of the hit. direction: of the ray that met it.
TurnedFrame turned_frame(const NormalMap& map, const Scene& scene, const TextureTable& textures,
                         const Hit& hit, const Surface& surface, const Vec3f& direction);

/// What a normal map leaves of the light from a direction: none where the old and the new surface
/// lie on different sides of it, and less where the old one turns away from it [Conty Estevez et
/// al. 2019, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem"].
float share_of_light(const NormalMap& map, const Vec3f& old_normal, const Vec3f& new_normal,
                     const Vec3f& direction);

}  // namespace burnish
