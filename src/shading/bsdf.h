// Any BSDF of a scene as a function of what it reads at a point, on plain numbers or duals. To add
// a kind of BSDF: its parameters from a row here, and its overloads of eval_bsdf, pdf_bsdf and
// sample_bsdf in a file of its own; whoever visits a Bsdf then finds them.
#pragma once

#include "shading/dielectric.h"
#include "shading/diffuse.h"
#include "shading/plastic.h"
#include "shading/principled_inputs.h"
#include "shading/principled_thin.h"
#include "shading/texture.h"

namespace burnish {

// The parameters of a kind, from a row of inputs; for kinds whose constants are a row, too, from
// both: then lanes of several BSDFs can be mixed.

template <class T>
DiffuseParameters<T> bsdf_parameters(const Diffuse&, const BsdfInputs<T>& v) {
    return {color_at(v, 0)};
}
template <class T>
PrincipledParameters<T> bsdf_parameters(const Principled& bsdf, const BsdfInputs<T>& v) {
    PrincipledParameters<T> p = principled_parameters(bsdf, v);
    p.specular_rate = Plain<T>(bsdf.specular_rate);
    p.clearcoat_rate = Plain<T>(bsdf.clearcoat_rate);
    p.diffuse_rate = Plain<T>(bsdf.diffuse_rate);
    p.min_transmission = Plain<T>(min_transmission(bsdf));
    p.min_diffuse = Plain<T>(min_diffuse(bsdf));
    p.min_clearcoat = Plain<T>(min_clearcoat(bsdf));
    return p;
}

/// Which kind a row is of.
template <class Kind>
struct RowOf {};

template <class T>
ConductorParameters<T> row_parameters(RowOf<Conductor>, const BsdfInputs<T>& v,
                                      const BsdfConstants<Plain<T>>& c) {
    return {color_at(v, 0), color_at(c, 0), color_at(c, 3)};
}
template <class T>
RoughConductorParameters<T> row_parameters(RowOf<RoughConductor>, const BsdfInputs<T>& v,
                                           const BsdfConstants<Plain<T>>& c) {
    return {row_parameters(RowOf<Conductor>{}, v, c), make_facets(v[3], v[4], c.v[6])};
}
template <class T>
PlasticParameters<T> row_parameters(RowOf<Plastic>, const BsdfInputs<T>& v,
                                    const BsdfConstants<Plain<T>>& c) {
    return {color_at(v, 0),          color_at(v, 3), c.v[0], c.v[1],
            c.v[2] > Plain<T>(0.5f), c.v[5],         c.v[6]};
}
template <class T>
RoughPlasticParameters<T> row_parameters(RowOf<RoughPlastic>, const BsdfInputs<T>& v,
                                         const BsdfConstants<Plain<T>>& c) {
    return {row_parameters(RowOf<Plastic>{}, v, c), make_facets(c.v[4], c.v[4], c.v[3]), c.table};
}

template <class T>
DielectricParameters<T> row_parameters(RowOf<Dielectric>, const BsdfInputs<T>& v,
                                       const BsdfConstants<Plain<T>>& c) {
    return {color_at(v, 0), color_at(v, 3), c.v[0], c.v[1] > Plain<T>(0.5f)};
}
template <class T>
RoughDielectricParameters<T> row_parameters(RowOf<RoughDielectric>, const BsdfInputs<T>& v,
                                            const BsdfConstants<Plain<T>>& c) {
    return {row_parameters(RowOf<Dielectric>{}, v, c), make_facets(v[6], v[7], c.v[2])};
}

template <class T>
PrincipledThinParameters<T> row_parameters(RowOf<PrincipledThin>, const BsdfInputs<T>& v,
                                           const BsdfConstants<Plain<T>>& c) {
    PrincipledThinParameters<T> p;
    p.base_color = color_at(v, 0);
    p.roughness = v[3], p.anisotropic = v[4], p.spec_trans = v[5], p.spec_tint = v[6];
    p.sheen = v[7], p.sheen_tint = v[8], p.flatness = v[9];
    p.diff_trans = v[10] * Plain<T>(0.5f);
    p.eta = c.v[0];
    p.specular_reflection = c.v[1], p.specular_transmission = c.v[2];
    p.diffuse_reflection = c.v[3], p.diffuse_transmission = c.v[4];
    p.min_specular = c.v[5], p.min_side = c.v[6];
    return p;
}

template <class Kind, class T>
requires requires(const Kind& b) { bsdf_constants(b); }
auto bsdf_parameters(const Kind& bsdf, const BsdfInputs<T>& v) {
    return row_parameters(RowOf<Kind>{}, v, broadcast<Plain<T>>(bsdf_constants(bsdf)));
}

// BSDF times |cos theta_o|, without delta lobes; the density of sampling wo, without theirs; a
// direction drawn with it. wi points to the camera, wo to the light, both local. u: uniform in [0,
// 1)^2, u_lobe in [0, 1). Those of most kinds stand in the files of these.

template <class T>
Rgb<T> eval_bsdf(const DiffuseParameters<T>& p, const Vec3<Plain<T>>& wi,
                 const Vec3<Plain<T>>& wo) {
    return eval_diffuse(p, wi, wo);
}
template <class T>
Rgb<T> eval_bsdf(const PrincipledParameters<T>& p, const Vec3<Plain<T>>& wi,
                 const Vec3<Plain<T>>& wo) {
    return eval_principled(p, wi, wo);
}

template <class U>
U pdf_bsdf(const DiffuseParameters<U>& p, const Vec3<U>& wi, const Vec3<U>& wo) {
    return pdf_diffuse(p, wi, wo);
}
template <class U>
U pdf_bsdf(const PrincipledParameters<U>& p, const Vec3<U>& wi, const Vec3<U>& wo) {
    return pdf_principled(p, wi, wo);
}

template <class U>
SampledDirection<U> sample_bsdf(const DiffuseParameters<U>& p, const Vec3<U>& wi, const Vec2<U>& u,
                                const U&) {
    return sample_diffuse(p, wi, u);
}
template <class U>
SampledDirection<U> sample_bsdf(const PrincipledParameters<U>& p, const Vec3<U>& wi,
                                const Vec2<U>& u, const U& u_lobe) {
    return sample_principled(p, wi, u, u_lobe);
}

/// Whether a kind has delta lobes: SampledDirection::delta is asked for there alone.
template <class Kind>
inline constexpr bool kHasDeltaLobes = delta_lobes(Kind{}) != DeltaLobes::kNone;
/// Whether a kind has nothing else: light samples cannot reach what it scatters.
template <class Kind>
inline constexpr bool kHasOnlyDeltaLobes = delta_lobes(Kind{}) == DeltaLobes::kAll;

// The same of any kind.

/// What a BSDF, or one kind of it, reads.
inline BsdfInputs<float> bsdf_inputs(const TextureTable& textures, const auto& bsdf,
                                     const Vec2f& uv) {
    BsdfInputs<float> v{};
    std::size_t i = 0;
    for (const ColorInput& input : colors_of(bsdf)) {
        const Rgbf color = eval_color(textures, input, uv);
        v[i] = color.x, v[i + 1] = color.y, v[i + 2] = color.z;
        i += 3;
    }
    for (const ScalarInput& scalar : scalars_of(bsdf)) v[i++] = eval_scalar(textures, scalar, uv);
    return v;
}
template <class T>
Rgb<T> eval_bsdf(const Bsdf& bsdf, const BsdfInputs<T>& v, const Vec3f& wi, const Vec3f& wo) {
    return std::visit([&](const auto& b) { return eval_bsdf(bsdf_parameters(b, v), wi, wo); },
                      bsdf);
}
inline float pdf_bsdf(const Bsdf& bsdf, const BsdfInputs<float>& v, const Vec3f& wi,
                      const Vec3f& wo) {
    return std::visit([&](const auto& b) { return pdf_bsdf(bsdf_parameters(b, v), wi, wo); }, bsdf);
}
inline SampledDirection<float> sample_bsdf(const Bsdf& bsdf, const BsdfInputs<float>& v,
                                           const Vec3f& wi, const Vec2f& u, float u_lobe) {
    return std::visit(
        [&](const auto& b) { return sample_bsdf(bsdf_parameters(b, v), wi, u, u_lobe); }, bsdf);
}

}  // namespace burnish
