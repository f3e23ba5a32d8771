// Materials: BSDF parameters as constants or textures.
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "scene/ids.h"
#include "scene/texture.h"

namespace burnish {

/// A parameter in [0, 1]: the texture where it is valid, the constant otherwise. The colours of a
/// bitmap are read as luminance, those of a checkerboard as their mean.
struct ScalarInput {
    float constant = 0.0f;
    TextureId texture;
};

/// A colour parameter, linear RGB in [0, 1]. A gray texture gives gray.
struct ColorInput {
    Rgbf constant{0.5f, 0.5f, 0.5f};
    TextureId texture;
};

inline constexpr ColorInput kWhite{{1.0f, 1.0f, 1.0f}, {}};

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
         has_spec_tint = false, has_sheen_tint = false, has_anisotropic = false;
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
    nullptr,
    &Principled::has_spec_trans,
    &Principled::has_spec_tint,
    &Principled::has_sheen,
    &Principled::has_sheen_tint,
    &Principled::has_flatness,
    &Principled::has_clearcoat,
    nullptr,
};

/// How the slopes of facets are distributed.
enum class FacetShape { kBeckmann, kGgx };

/// Roughness of a surface of facets: alpha along u and v, at least 1e-4.
struct FacetRoughness {
    FacetShape shape = FacetShape::kBeckmann;
    bool anisotropic = false;  ///< otherwise the first alpha is both
    std::array<ScalarInput, 2> alpha{{{0.1f, {}}, {0.1f, {}}}};
};

/// Complex index of refraction eta + i k of a metal, RGB, relative to the outside.
struct MetalIndex {
    Rgbf eta{0.0f, 0.0f, 0.0f}, k{1.0f, 1.0f, 1.0f};  ///< as they are: a perfect mirror
};

/// Mitsuba's `conductor`: a mirror, one-sided.
struct Conductor {
    ColorInput reflectance = kWhite;
    MetalIndex index;
};

/// Mitsuba's `roughconductor`, one-sided.
struct RoughConductor {
    ColorInput reflectance = kWhite;
    MetalIndex index;
    FacetRoughness roughness;
};

/// Mitsuba's `plastic`: a diffuse base under a smooth dielectric, one-sided.
struct Plastic {
    std::array<ColorInput, 2> colors{ColorInput{}, kWhite};  ///< diffuse and specular reflectance
    float eta = 1.0f;        ///< relative index of refraction, inside / outside
    bool nonlinear = false;  ///< the base's colour shifts by what the interface reflects inside
};

/// Entries of RoughPlastic::transmittance.
inline constexpr std::size_t kTransmittances = 64;

/// Mitsuba's `roughplastic`: the same under a rough dielectric. Made by make_rough_plastic
/// (shading/rough_plastic.h), which fills in what follows from index and roughness.
struct RoughPlastic {
    std::array<ColorInput, 2> colors{ColorInput{}, kWhite};  ///< diffuse and specular reflectance
    float eta = 1.0f;
    bool nonlinear = false;
    FacetShape shape = FacetShape::kBeckmann;
    float alpha = 0.1f;
    /// Share of light that enters from outside, at cosines k / 63.
    std::array<float, kTransmittances> transmittance{};
    float internal_reflectance = 0;  ///< of diffuse light from inside
};

/// Mitsuba's `dielectric`: smooth glass, from both sides; `thindielectric`, a pane of it, which
/// light leaves in the direction in which it came; and `null`, a pane of nothing.
struct Dielectric {
    std::array<ColorInput, 2> colors{kWhite, kWhite};  ///< specular reflectance, transmittance
    float eta = 1.0f;
    bool thin = false;
};

/// Mitsuba's `roughdielectric`: glass of facets, from both sides.
struct RoughDielectric {
    std::array<ColorInput, 2> colors{kWhite, kWhite};  ///< specular reflectance, transmittance
    float eta = 1.0f;
    FacetRoughness roughness;
};

/// The scalars of `principledthin`, in the order of PrincipledThin::scalars.
enum class ThinScalar {
    kRoughness,
    kAnisotropic,
    kSpecTrans,
    kSpecTint,
    kSheen,
    kSheenTint,
    kFlatness,
    kDiffTrans,  ///< in [0, 2]
};
inline constexpr int kThinScalars = 8;

/// Mitsuba's `principledthin`: a sheet without thickness, alike from both sides.
struct PrincipledThin {
    ColorInput base_color;
    std::array<ScalarInput, kThinScalars> scalars{{{0.5f, {}}, {}, {}, {}, {}, {}, {}, {}}};
    float eta = 1.5f;
    /// Rates at which lobes are sampled: specular reflection and transmission, diffuse reflection
    /// and transmission.
    std::array<float, 4> rates{1.0f, 1.0f, 1.0f, 1.0f};
};

/// To add a BSDF: a struct above and its place in this variant. The compiler then names what lacks:
///   scene/material.h            its colours and scalars, which lobes of it are delta lobes, and
///                               the functions of material.cpp
///   shading/                    its parameters, and eval / sample / pdf on a scalar type T, in a
///                               file of its own; its parameters from a row in bsdf.h
///   paths/traced_scene.cpp      whether it is black whatever the light
///   cli/blender_script.cpp, models/gltf_material.cpp   what other programs get of it
/// The compiler does not name:
///   mitsuba/bsdfs.cpp           its reader, and its name in kSupported: there, kinds are strings
///   docs/reference/mitsuba.md   its row
///   tests/reference/interfaces.h   a floor of it, which a test asks for
///   shading/bsdf_row.h, paths/bsdf_columns.h   kBsdfInputs and kBsdfRowInputs, where its row is
///                               longer, which ends the program
using Bsdf = std::variant<Diffuse, Principled, Conductor, RoughConductor, Plastic, RoughPlastic,
                          Dielectric, RoughDielectric, PrincipledThin>;

// A BSDF's inputs as numbers in a row: the three channels of each colour, then the scalars. An
// input is named by its first place in the row.

template <class B, class Kind>
concept IsKind = std::same_as<std::remove_const_t<B>, Kind>;

auto colors_of(IsKind<Diffuse> auto& b) { return std::span(&b.reflectance, 1); }
auto colors_of(IsKind<Principled> auto& b) { return std::span(&b.base_color, 1); }
auto colors_of(IsKind<Conductor> auto& b) { return std::span(&b.reflectance, 1); }
auto colors_of(IsKind<RoughConductor> auto& b) { return std::span(&b.reflectance, 1); }
auto colors_of(IsKind<Plastic> auto& b) { return std::span(b.colors); }
auto colors_of(IsKind<RoughPlastic> auto& b) { return std::span(b.colors); }
auto colors_of(IsKind<Dielectric> auto& b) { return std::span(b.colors); }
auto colors_of(IsKind<RoughDielectric> auto& b) { return std::span(b.colors); }
auto colors_of(IsKind<PrincipledThin> auto& b) { return std::span(&b.base_color, 1); }

auto scalars_of(IsKind<FacetRoughness> auto& r) {
    return std::span(r.alpha.data(), r.anisotropic ? 2 : 1);
}
inline std::span<ScalarInput> scalars_of(const Diffuse&) { return {}; }
auto scalars_of(IsKind<Principled> auto& b) { return std::span(b.scalars); }
inline std::span<ScalarInput> scalars_of(const Conductor&) { return {}; }
auto scalars_of(IsKind<RoughConductor> auto& b) { return scalars_of(b.roughness); }
inline std::span<ScalarInput> scalars_of(const Plastic&) { return {}; }
inline std::span<ScalarInput> scalars_of(const RoughPlastic&) { return {}; }
inline std::span<ScalarInput> scalars_of(const Dielectric&) { return {}; }
auto scalars_of(IsKind<RoughDielectric> auto& b) { return scalars_of(b.roughness); }
auto scalars_of(IsKind<PrincipledThin> auto& b) { return std::span(b.scalars); }

/// Of any kind, in the order of the row. Nothing is converted to a Bsdf: a kind without its own
/// overload does not compile.
std::span<const ColorInput> colors_of(const IsKind<Bsdf> auto& bsdf) {
    return std::visit([](const auto& b) { return std::span<const ColorInput>(colors_of(b)); },
                      bsdf);
}
std::span<const ScalarInput> scalars_of(const IsKind<Bsdf> auto& bsdf) {
    return std::visit([](const auto& b) { return std::span<const ScalarInput>(scalars_of(b)); },
                      bsdf);
}
/// The place of the first scalar.
inline std::size_t first_scalar(const Bsdf& bsdf) { return 3 * colors_of(bsdf).size(); }
/// The input at a place in the row where one begins: null where it is not of that type.
const ColorInput* color_at(const Bsdf& bsdf, int place);
const ScalarInput* scalar_at(const Bsdf& bsdf, int place);
/// The texture of the input at a place.
TextureId texture_at(const Bsdf& bsdf, int place);
/// Lets the input at a place read a texture; its lobe exists.
void set_texture(Bsdf& bsdf, int place, TextureId texture);
/// The textures that it reads as roughness.
std::vector<TextureId> roughness_textures(const Bsdf& bsdf);

/// Which lobes of a BSDF are delta lobes: a light sample never finds their directions.
enum class DeltaLobes { kNone, kSome, kAll };

constexpr DeltaLobes delta_lobes(const Diffuse&) { return DeltaLobes::kNone; }
constexpr DeltaLobes delta_lobes(const Principled&) { return DeltaLobes::kNone; }
constexpr DeltaLobes delta_lobes(const Conductor&) { return DeltaLobes::kAll; }
constexpr DeltaLobes delta_lobes(const RoughConductor&) { return DeltaLobes::kNone; }
constexpr DeltaLobes delta_lobes(const Plastic&) { return DeltaLobes::kSome; }
constexpr DeltaLobes delta_lobes(const RoughPlastic&) { return DeltaLobes::kNone; }
constexpr DeltaLobes delta_lobes(const Dielectric&) { return DeltaLobes::kAll; }
constexpr DeltaLobes delta_lobes(const RoughDielectric&) { return DeltaLobes::kNone; }
constexpr DeltaLobes delta_lobes(const PrincipledThin&) { return DeltaLobes::kNone; }

/// Whether light passes through the surface: its back is not black.
bool transmits(const Bsdf& bsdf);
/// The pane that it is, which lets light straight through; null: it is none.
inline const Dielectric* pane_of(const Bsdf& bsdf) {
    const auto* glass = std::get_if<Dielectric>(&bsdf);
    return glass && glass->thin ? glass : nullptr;
}
/// Whether it has no inside and is seen from both sides.
bool is_sheet(const Bsdf& bsdf);
/// Whether a channel of its value depends on more than one channel of its colour.
bool mixes_channels(const Bsdf& bsdf);

/// Whether directions are sampled by the input at a place: of plastics by their colours, and by
/// any scalar, to be on the safe side.
bool is_sampled_by(const Bsdf& bsdf, int place);

/// The textures that it reads, one for each input that has one.
std::vector<TextureId> textures_of(const Bsdf& bsdf);
/// Whether a texture is one of those.
bool reads(const Bsdf& bsdf, TextureId texture);

/// A texture that turns the shading normals of a material: Mitsuba's `normalmap` and `bumpmap`.
struct NormalMap {
    TextureId texture;         ///< of normals, n = 2 c - 1 in the shading frame; or of heights
    bool flip_invalid = true;  ///< normals that face away from the ray are turned about the old one
    bool shadowing = true;     ///< light fades where the old surface turns away from it
    std::optional<float> height_scale = {};  ///< the texture, a bitmap, holds heights
    /// It is inside `twosided`: the back is the front's mirror image, and one-sided as turned.
    bool mirrored = false;
};

/// At each point one of two materials is shown, drawn by its share: Mitsuba's `blendbsdf`, and
/// `mask`, whose first material is nothing. The expectation is their mixture. The two belong to
/// this blend alone.
struct MaterialBlend {
    ScalarInput weight;  ///< share of the second
    MaterialId first, second;
};

/// What a BSDF inside a blend counts for: the weight, or one minus it. See separate_parts
/// (scene/blends.h).
struct BlendShare {
    TextureId weight;  ///< a bitmap
    bool second = false;

    friend bool operator==(const BlendShare&, const BlendShare&) = default;
};
/// The most blends, one inside another, whose weights can be unknowns.
inline constexpr std::size_t kMaxShares = 4;

/// What a shape is made of. One-sided: `back` is invalid and the back is black (unless the front
/// transmits). Two-sided: the back evaluates `back` with both directions mirrored to z > 0.
struct Material {
    std::string id;      ///< the id of the scene file, or a made-up one
    BsdfId front, back;  ///< of a blend those of the second material, which stands for both
    std::optional<NormalMap> normals = {};
    std::optional<MaterialBlend> blend = {};

    /// Whether the side of the turned normal that a ray meets says what is evaluated.
    bool has_sides() const { return back && !(normals && normals->mirrored); }
};

}  // namespace burnish
