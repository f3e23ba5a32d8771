// Materials: BSDF parameters as constants or textures.
#pragma once

#include <array>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "scene/ids.h"
#include "scene/texture.h"

namespace burnish {

/// A parameter in [0, 1]: the texture where it is valid, the constant otherwise. An RGB texture is
/// read as luminance.
struct ScalarInput {
    float constant = 0.0f;
    TextureId texture;
};

/// A colour parameter, linear RGB in [0, 1]. A gray texture gives gray.
struct ColorInput {
    Rgbf constant{0.5f, 0.5f, 0.5f};
    TextureId texture;
};

/// Lambertian reflection, one-sided.
struct Diffuse {
    ColorInput reflectance;
};

/// The inputs of `principled` that can carry a texture, in the order of Principled::scalars and of
/// derivatives.
enum class PrincipledScalar {
    kRoughness,
    kAnisotropic,
    kMetallic,
    kSpecTrans,
    kSpecTint,
    kSheen,
    kSheenTint,
    kFlatness,
    kClearcoat,
    kClearcoatGloss,
};
inline constexpr int kPrincipledScalars = 10;

/// Mitsuba's `principled` (Burley 2012, 2015), see shading/principled.h for the formulas.
struct Principled {
    ColorInput base_color;
    std::array<ScalarInput, kPrincipledScalars> scalars{
        {{0.5f, {}}, {}, {}, {}, {}, {}, {}, {}, {}, {}}};
    float eta = 1.5f;  ///< relative index of refraction, inside / outside
    /// Lobes that exist, from what the scene file gave: a literal 0 or an absent parameter removes
    /// the lobe, a texture keeps it whatever its values.
    bool has_spec_trans = false, has_clearcoat = false, has_sheen = false, has_flatness = false,
         has_spec_tint = false, has_sheen_tint = false, has_anisotropic = false,
         has_metallic = false;
    /// Relative rates at which the lobes are sampled.
    float specular_rate = 1.0f, clearcoat_rate = 1.0f, diffuse_rate = 1.0f;

    ScalarInput& operator[](PrincipledScalar p) { return scalars[static_cast<std::size_t>(p)]; }
    const ScalarInput& operator[](PrincipledScalar p) const {
        return scalars[static_cast<std::size_t>(p)];
    }
};

/// The lobe that each scalar belongs to; null: one that always exists, or that of another scalar.
inline constexpr std::array<bool Principled::*, kPrincipledScalars> kScalarLobes{
    nullptr,
    &Principled::has_anisotropic,
    &Principled::has_metallic,
    &Principled::has_spec_trans,
    &Principled::has_spec_tint,
    &Principled::has_sheen,
    &Principled::has_sheen_tint,
    &Principled::has_flatness,
    &Principled::has_clearcoat,
    nullptr,
};

/// To add a BSDF: a struct above and its place in this variant. The compiler then names what lacks:
///   scene/material.cpp          its colour, its scalars and whether it transmits (functions below)
///   shading/                    a file with eval / sample / pdf on a scalar type T
///   paths/bsdf_columns.h        BsdfPackets: a packet of points evaluated and sampled
///   paths/traced_scene.cpp      whether it is black whatever the light
///   render/shade.cpp            a packet of records evaluated, with derivatives
///   gradient/differentiate.cpp  the derivatives of one record
/// Only its reader in mitsuba/bsdfs.cpp is not named: there, kinds are strings.
using Bsdf = std::variant<Diffuse, Principled>;

/// Its colour: the base colour or the reflectance.
const ColorInput& color_of(const Bsdf& bsdf);
/// Its scalar inputs, in the order of derivatives; none for `diffuse`.
std::span<const ScalarInput> scalars_of(const Bsdf& bsdf);
/// Whether light passes through the surface: its back is not black.
bool transmits(const Bsdf& bsdf);
/// Whether a channel of its value depends on more than one channel of its colour.
bool mixes_channels(const Bsdf& bsdf);

/// The textures that it reads, one for each input that has one.
std::vector<TextureId> textures_of(const Bsdf& bsdf);

/// What a shape is made of. One-sided: `back` is invalid and the back is black (unless the front
/// transmits). Two-sided: the back evaluates `back` with both directions mirrored to z > 0.
struct Material {
    std::string id;  ///< the id of the scene file, or a made-up one
    BsdfId front, back;
};

}  // namespace burnish
