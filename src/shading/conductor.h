// Mitsuba's `conductor` and `roughconductor`: metals, smooth or of facets, one-sided.
//
//   f |cos_o| = reflectance F(wi . h) D(h) G1(wi) G1(wo) / (4 cos_i)
//
// with the Fresnel reflectance of the complex index eta + i k. wi points to the camera, wo to the
// light; both local. What eval_bsdf, pdf_bsdf and sample_bsdf return: bsdf.h.
#pragma once

#include "shading/facets.h"
#include "shading/fresnel.h"
#include "shading/warp.h"

namespace burnish {

/// Unpolarised reflectance of an interface with the index eta + i k, relative to the side that
/// cosine >= 0 belongs to.
template <class U>
U fresnel_conductor(const U& cosine, const U& eta, const U& k) {
    const U cos2 = sqr(cosine), sin2 = U(1.0f) - cos2;
    const U difference = sqr(eta) - sqr(k) - sin2;
    const U norm = safe_sqrt(U(sqr(difference) + U(4.0f) * sqr(eta) * sqr(k)));
    const U a = safe_sqrt(U(U(0.5f) * (norm + difference)));
    const U s1 = norm + cos2, s2 = U(2.0f) * cosine * a;
    const U s = safe_divide(U(s1 - s2), U(s1 + s2));
    const U p1 = norm * cos2 + sqr(sin2), p2 = s2 * sin2;
    const U p = s * safe_divide(U(p1 - p2), U(p1 + p2));
    return U(0.5f) * (s + p);
}

template <class U>
Rgb<U> fresnel_conductor(const U& cosine, const Rgb<U>& eta, const Rgb<U>& k) {
    return {fresnel_conductor(cosine, eta.x, k.x), fresnel_conductor(cosine, eta.y, k.y),
            fresnel_conductor(cosine, eta.z, k.z)};
}

template <class T>
struct ConductorParameters {
    Rgb<T> reflectance{};  ///< of the surface, times Fresnel's
    Rgb<Plain<T>> eta{}, k{};
};

template <class T>
struct RoughConductorParameters {
    ConductorParameters<T> metal;
    Facets<T> facets;
};

/// eta, k.
inline BsdfConstants<float> bsdf_constants(const Conductor& b) {
    const Rgbf &n = b.index.eta, &k = b.index.k;
    return {{n.x, n.y, n.z, k.x, k.y, k.z}, {}};
}
/// eta, k, the distribution.
inline BsdfConstants<float> bsdf_constants(const RoughConductor& b) {
    const Rgbf &n = b.index.eta, &k = b.index.k;
    return {{n.x, n.y, n.z, k.x, k.y, k.z, facet_code(b.roughness)}, {}};
}

/// Of delta lobes alone.
template <class T>
Rgb<T> eval_bsdf(const ConductorParameters<T>&, const Vec3<Plain<T>>&, const Vec3<Plain<T>>&) {
    return {};
}
template <class U>
U pdf_bsdf(const ConductorParameters<U>&, const Vec3<U>&, const Vec3<U>&) {
    return U(0.0f);
}

/// The one direction of a mirror; none from behind.
template <class U>
SampledDirection<U> sample_bsdf(const ConductorParameters<U>& p, const Vec3<U>& wi, const Vec2<U>&,
                                const U&) {
    const U zero(0.0f), one(1.0f);
    const auto front = wi.z > zero;
    const Rgb<U> f = p.reflectance * fresnel_conductor(max(wi.z, zero), p.eta, p.k);
    return {{-wi.x, -wi.y, wi.z}, front, front, {f, select(front, one, zero)}, one};
}

/// Where both directions are in front: the normal of the facet that mirrors one into the other.
template <class U>
struct MirrorFacet {
    Vec3<U> h{};
    U wi_h{};
    MaskOf<U> front{};
};

template <class U>
MirrorFacet<U> mirror_facet(const Vec3<U>& wi, const Vec3<U>& wo) {
    const U zero(0.0f), one(1.0f);
    const auto front = wi.z > zero && wo.z > zero;
    const Vec3<U> sum = wi + wo;
    const Vec3<U> h = sum * (one / sqrt(select(front, length_squared(sum), one)));
    const U wi_h = dot(wi, h);
    return {h, wi_h, front && wi_h > zero};
}

template <class T>
Rgb<T> eval_bsdf(const RoughConductorParameters<T>& p, const Vec3<Plain<T>>& wi,
                 const Vec3<Plain<T>>& wo) {
    using U = Plain<T>;
    const auto m = mirror_facet(wi, wo);
    if (!any(m.front)) return {};
    const Rgb<U> f = fresnel_conductor(clamp01(m.wi_h), p.metal.eta, p.metal.k);
    const T d_v = facet_d(p.facets, m.h) * facet_visibility(p.facets, wi, wo) * wo.z;
    const T common = select(m.front, d_v, T(U(0.0f)));
    const Rgb<T>& r = p.metal.reflectance;
    return {r.x * common * f.x, r.y * common * f.y, r.z * common * f.z};
}

template <class U>
U pdf_bsdf(const RoughConductorParameters<U>& p, const Vec3<U>& wi, const Vec3<U>& wo) {
    const auto m = mirror_facet(wi, wo);
    const U pdf = pdf_facet(p.facets, wi, m.h) * safe_divide(U(0.25f), m.wi_h);
    return select(m.front, pdf, U(0.0f));
}

template <class U>
SampledDirection<U> sample_bsdf(const RoughConductorParameters<U>& p, const Vec3<U>& wi,
                                const Vec2<U>& u, const U&) {
    const U zero(0.0f);
    const auto front = wi.z > zero;
    const Vec3<U> h = sample_facet(p.facets, select(front, wi, -wi), u);
    const Vec3<U> wo = reflect(wi, h);
    return {wo, front && wo.z > zero};
}

}  // namespace burnish
