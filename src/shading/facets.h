// Rough surfaces as facets whose slopes follow GGX or Beckmann's distribution, with separable Smith
// masking [Walter et al. 2007]. Directions and normals as in microfacet.h.
//
// Beckmann's facets are sampled as GGX's visible ones of the same roughness. GGX has the longer
// tails and hides no less, so that value over density is bounded: D by 4 / e, G1 by 1.8.
#pragma once

#include "shading/bsdf_row.h"
#include "shading/microfacet.h"

namespace burnish {

template <class T>
struct Facets {
    Ggx<T> ggx;            ///< the roughness, whatever the distribution
    MaskOf<T> beckmann{};  ///< else GGX
};

/// The distribution as a number: 1 for Beckmann's, and 2 where the surface is anisotropic.
inline float facet_code(const FacetRoughness& r) {
    return (r.shape == FacetShape::kBeckmann ? 1.0f : 0.0f) + (r.anisotropic ? 2.0f : 0.0f);
}

/// alpha along u and v; the first is both where the surface is not anisotropic.
template <class T>
Facets<T> make_facets(const T& alpha_u, const T& alpha_v, const Plain<T>& code) {
    using U = Plain<T>;
    const auto anisotropic = code > U(1.5f);
    const T least(U(1e-4f)), u = max(alpha_u, least), v = max(alpha_v, least);
    return {{u, select(anisotropic, v, u)}, code - select(anisotropic, U(2.0f), U(0.0f)) > U(0.5f)};
}

/// D(h) = exp(-tan^2 / alpha^2) / (pi ax ay hz^4), per unit area and solid angle.
template <class T>
T beckmann_d(const Ggx<T>& g, const Vec3<Plain<T>>& h) {
    using U = Plain<T>;
    const auto up = h.z > U(0.0f);
    const U inverse_z2 = U(1.0f) / select(up, sqr(h.z), U(1.0f));
    const T inverse_x = reciprocal(g.alpha_x), inverse_y = reciprocal(g.alpha_y);
    const T e = (sqr(h.x * inverse_x) + sqr(h.y * inverse_y)) * inverse_z2;
    const T d = exp(-e) * inverse_x * inverse_y * (U(std::numbers::inv_pi) * sqr(inverse_z2));
    return select(up, d, T(U(0.0f)));
}

/// Smith masking of Beckmann's facets where v sees their front: the rational fit of [Walter et al.
/// 2007] to 0.35 %, as in Mitsuba.
template <class T>
T beckmann_g1(const Ggx<T>& g, const Vec3<Plain<T>>& v) {
    using U = Plain<T>;
    const U one(1.0f), z2 = sqr(v.z);
    const T slope = sqr(g.alpha_x * v.x) + sqr(g.alpha_y * v.y);
    const auto open = z2 >= U(2.56f) * value(slope);
    const T a = safe_sqrt(T(z2 / select(open, T(one), slope)));
    const T fit = a * (U(3.535f) + U(2.181f) * a) / (one + a * (U(2.276f) + U(2.577f) * a));
    return select(open, T(one), fit);
}

template <class T>
T facet_d(const Facets<T>& f, const Vec3<Plain<T>>& h) {
    if (!any(f.beckmann)) return ggx_d(f.ggx, h);
    if (all(f.beckmann)) return beckmann_d(f.ggx, h);
    return select(f.beckmann, beckmann_d(f.ggx, h), ggx_d(f.ggx, h));
}

/// G1(v), where v sees the front of the facet.
template <class T>
T facet_g1(const Facets<T>& f, const Vec3<Plain<T>>& v) {
    const T smith = Plain<T>(2.0f) * abs(v.z) / ggx_slant(f.ggx, v);
    if (!any(f.beckmann)) return smith;
    return select(f.beckmann, beckmann_g1(f.ggx, v), smith);
}

/// G1(wi) G1(wo) / (4 |wi.z| |wo.z|), where both see the front of the facet.
template <class T>
T facet_visibility(const Facets<T>& f, const Vec3<Plain<T>>& wi, const Vec3<Plain<T>>& wo) {
    using U = Plain<T>;
    const T ggx = ggx_visibility(f.ggx, wi, wo);
    if (!any(f.beckmann)) return ggx;
    const U scale = safe_divide(U(0.25f), U(abs(wi.z * wo.z)));
    return select(f.beckmann, beckmann_g1(f.ggx, wi) * beckmann_g1(f.ggx, wo) * scale, ggx);
}

/// Density of sample_facet in solid angle of h.
template <class U>
U pdf_facet(const Facets<U>& f, const Vec3<U>& v, const Vec3<U>& h) {
    return pdf_ggx_visible(f.ggx, v, h);
}

/// A facet normal that v sees (v.z > 0), from u uniform in [0, 1)^2.
template <class U>
Vec3<U> sample_facet(const Facets<U>& f, const Vec3<U>& v, const Vec2<U>& u) {
    return sample_ggx_visible(f.ggx, v, u);
}

}  // namespace burnish
