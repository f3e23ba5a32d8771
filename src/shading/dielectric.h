// Mitsuba's `dielectric`, `thindielectric` and `roughdielectric`: glass, smooth or of facets, from
// both sides. Of facets
//
//   f |cos_o| = reflectance F D G1(wi) G1(wo) / (4 |cos_i|)                              same side
//             + transmittance (1 - F) D G1(wi) G1(wo) |wi . h| |wo . h|
//                             / (|cos_i| (wi . h + eta' wo . h)^2)                      other side
//
// where eta' is the index behind the surface over that before it. Transmission is of radiance,
// which refraction compresses by 1 / eta'^2. wi points to the camera, wo to the light; both local.
// What eval_bsdf, pdf_bsdf and sample_bsdf return: bsdf.h.
#pragma once

#include "shading/facets.h"
#include "shading/principled_geometry.h"
#include "shading/warp.h"

namespace burnish {

template <class T>
struct DielectricParameters {
    Rgb<T> reflectance{}, transmittance{};  ///< times Fresnel's
    Plain<T> eta{1.5f};                     ///< index of refraction inside / outside
    MaskOf<T> thin{};                       ///< two interfaces, parallel: light goes on straight
};

template <class T>
struct RoughDielectricParameters {
    DielectricParameters<T> glass;
    Facets<T> facets;
};

/// eta, thin.
inline BsdfConstants<float> bsdf_constants(const Dielectric& b) {
    return {{b.eta, b.thin ? 1.0f : 0.0f}, {}};
}
/// eta, 0, the distribution.
inline BsdfConstants<float> bsdf_constants(const RoughDielectric& b) {
    return {{b.eta, 0, facet_code(b.roughness)}, {}};
}

/// Of delta lobes alone.
template <class T>
Rgb<T> eval_bsdf(const DielectricParameters<T>&, const Vec3<Plain<T>>&, const Vec3<Plain<T>>&) {
    return {};
}
template <class U>
U pdf_bsdf(const DielectricParameters<U>&, const Vec3<U>&, const Vec3<U>&) {
    return U(0.0f);
}

/// The mirrored or the passing direction.
template <class U>
SampledDirection<U> sample_bsdf(const DielectricParameters<U>& p, const Vec3<U>& wi, const Vec2<U>&,
                                const U& u_lobe) {
    const U zero(0.0f), one(1.0f);
    const auto f = fresnel_dielectric(select(p.thin, abs(wi.z), wi.z), p.eta);
    // Of a pane: what its interfaces send back and forth, r + t^2 r + t^2 r^3 + ...
    const U r = select(p.thin, U(U(2.0f) * f.reflectance / (one + f.reflectance)), f.reflectance);
    const auto mirror = u_lobe < r;
    const U eta_ti = select(p.thin, one, f.eta_ti);
    const Vec3<U> passed = select(p.thin, -wi, Vec3<U>{-wi.x * eta_ti, -wi.y * eta_ti, f.cos_t});
    const Rgb<U> share =
        select(mirror, p.reflectance * r, p.transmittance * ((one - r) * sqr(eta_ti)));
    SampledDirection<U> s;
    s.wo_local = select(mirror, Vec3<U>{-wi.x, -wi.y, wi.z}, passed);
    s.proper = s.delta = abs(wi.z) > zero && abs(s.wo_local.z) > zero;
    s.lobe = {share, select(mirror, r, U(one - r))};
    s.eta = select(mirror, one, U(one / eta_ti));
    return s;
}

template <class T>
Rgb<T> eval_bsdf(const RoughDielectricParameters<T>& p, const Vec3<Plain<T>>& wi,
                 const Vec3<Plain<T>>& wo) {
    using U = Plain<T>;
    const U zero(0.0f), one(1.0f);
    const auto g = principled_geometry(wi, wo, p.glass.eta);
    const T d_v = facet_d(p.facets, g.h) * facet_visibility(p.facets, wi, wo);
    const U jacobian =
        safe_divide(U(U(4.0f) * abs(g.wi_h * g.wo_h)), U(sqr(g.wi_h + g.eta_path * g.wo_h)));
    const U reflected = select(g.reflects, g.fresnel, zero);
    const U refracted = select(g.refracts, U((one - g.fresnel) * jacobian), zero);
    const T lobe = select(g.reflects || g.refracts, d_v * g.cos_o, T(zero));
    const Rgb<T>&r = p.glass.reflectance, &t = p.glass.transmittance;
    const auto channel = [&](const T& mirror, const T& passing) {
        return T((mirror * reflected + passing * refracted) * lobe);
    };
    return {channel(r.x, t.x), channel(r.y, t.y), channel(r.z, t.z)};
}

template <class U>
U pdf_bsdf(const RoughDielectricParameters<U>& p, const Vec3<U>& wi, const Vec3<U>& wo) {
    const U zero(0.0f), one(1.0f);
    const auto g = principled_geometry(wi, wo, p.glass.eta);
    const U mirrored = g.fresnel * safe_divide(U(0.25f), U(abs(g.wo_h)));
    const U refracted = (one - g.fresnel) * safe_divide(U(sqr(g.eta_path) * abs(g.wo_h)),
                                                        U(sqr(g.wi_h + g.eta_path * g.wo_h)));
    const U dh = select(g.reflects, mirrored, select(g.refracts, refracted, zero));
    return select(g.reflects || g.refracts, pdf_facet(p.facets, wi, g.h) * dh, zero);
}

template <class U>
SampledDirection<U> sample_bsdf(const RoughDielectricParameters<U>& p, const Vec3<U>& wi,
                                const Vec2<U>& u, const U& u_lobe) {
    const U zero(0.0f), one(1.0f);
    const Vec3<U> h = sample_facet(p.facets, select(wi.z > zero, wi, -wi), u);
    const auto f = fresnel_dielectric(U(dot(wi, h)), p.glass.eta);
    const auto mirror = u_lobe < f.reflectance;
    SampledDirection<U> s;
    s.wo_local = select(mirror, reflect(wi, h), refract(wi, h, f));
    const U sides = s.wo_local.z * wi.z;
    s.proper = (mirror && sides > zero) || (!mirror && sides < zero);
    s.eta = select(mirror, one, U(one / f.eta_ti));
    return s;
}

}  // namespace burnish
