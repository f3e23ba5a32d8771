// Any BSDF of a scene as a function of what it reads at a point, on plain numbers or duals. To add
// a kind of BSDF: its overloads here; whoever visits a Bsdf then finds them.
#pragma once

#include <span>

#include "shading/diffuse.h"
#include "shading/principled_inputs.h"
#include "shading/texture.h"

namespace burnish {

/// What a BSDF reads: the three channels of its colour, then its scalars; kinds with fewer scalars
/// ignore the rest.
template <class T>
using BsdfInputs = std::array<T, kBsdfInputs>;

inline const ColorInput& color_input(const Diffuse& bsdf) { return bsdf.reflectance; }
inline const ColorInput& color_input(const Principled& bsdf) { return bsdf.base_color; }
inline std::span<const ScalarInput> scalar_inputs(const Diffuse&) { return {}; }
inline std::span<const ScalarInput> scalar_inputs(const Principled& b) { return b.scalars; }

template <class T>
DiffuseParameters<T> bsdf_parameters(const Diffuse&, const BsdfInputs<T>& v) {
    return {{v[0], v[1], v[2]}};
}
template <class T>
PrincipledParameters<T> bsdf_parameters(const Principled& bsdf, const BsdfInputs<T>& v) {
    PrincipledParameters<T> p = principled_parameters(bsdf, v);
    p.specular_rate = Plain<T>(bsdf.specular_rate);
    p.clearcoat_rate = Plain<T>(bsdf.clearcoat_rate);
    p.diffuse_rate = Plain<T>(bsdf.diffuse_rate);
    return p;
}

// BSDF times |cos theta_o|; the density of sampling wo; a direction drawn with it. wi points to the
// camera, wo to the light, both local. u: uniform in [0, 1)^4.

template <class T>
Rgb<T> eval_bsdf(const DiffuseParameters<T>& p, const Vec3f& wi, const Vec3f& wo) {
    return eval_diffuse(p, wi, wo);
}
template <class T>
Rgb<T> eval_bsdf(const PrincipledParameters<T>& p, const Vec3f& wi, const Vec3f& wo) {
    return eval_principled(p, wi, wo);
}
inline float pdf_bsdf(const DiffuseParameters<float>& p, const Vec3f& wi, const Vec3f& wo) {
    return pdf_diffuse(p, wi, wo);
}
inline float pdf_bsdf(const PrincipledParameters<float>& p, const Vec3f& wi, const Vec3f& wo) {
    return pdf_principled(p, wi, wo);
}
inline BsdfSample<float> sample_bsdf(const DiffuseParameters<float>& p, const Vec3f& wi,
                                     const std::array<float, 4>& u) {
    return sample_diffuse(p, wi, {u[0], u[1]});
}
inline BsdfSample<float> sample_bsdf(const PrincipledParameters<float>& p, const Vec3f& wi,
                                     const std::array<float, 4>& u) {
    return sample_principled(p, wi, {u[0], u[1]}, u[2]);
}

// The same of any kind.

inline ColorInput color_input(const Bsdf& bsdf) {
    return std::visit([](const auto& b) { return color_input(b); }, bsdf);
}
inline std::span<const ScalarInput> scalar_inputs(const Bsdf& bsdf) {
    return std::visit([](const auto& b) { return scalar_inputs(b); }, bsdf);
}
inline BsdfInputs<float> bsdf_inputs(const TextureTable& textures, const Bsdf& bsdf,
                                     const Vec2f& uv) {
    const Rgbf color = eval_color(textures, color_input(bsdf), uv);
    BsdfInputs<float> v{color.x, color.y, color.z};
    std::size_t i = kBsdfColor;
    for (const ScalarInput& scalar : scalar_inputs(bsdf))
        v[i++] = eval_scalar(textures, scalar, uv);
    return v;
}
/// The transpose of reading: the derivative by the channels of a texel (x alone where it has one)
/// from that by what a BSDF reads there, a colour or a scalar.
inline Rgbf color_to_texel(const Bitmap& bitmap, const Rgbf& d) {
    return bitmap.channels == 1 ? Rgbf{d.x + d.y + d.z, 0, 0} : d;
}
inline Rgbf scalar_to_texel(const Bitmap& bitmap, float d) {
    return bitmap.channels == 1 ? Rgbf{d, 0, 0} : luminance_derivative(d);
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
inline BsdfSample<float> sample_bsdf(const Bsdf& bsdf, const BsdfInputs<float>& v, const Vec3f& wi,
                                     const std::array<float, 4>& u) {
    return std::visit([&](const auto& b) { return sample_bsdf(bsdf_parameters(b, v), wi, u); },
                      bsdf);
}

}  // namespace burnish
