// Rough surfaces as facets whose slopes follow GGX or Beckmann's distribution, with separable Smith
// masking [Walter et al. 2007]. Directions and normals as in microfacet.h. Both are sampled as the
// facets that a direction sees [Heitz and d'Eon 2014], so that value over density is at most
// about 1.
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
    const T min_alpha(U(1e-4f)), u = max(alpha_u, min_alpha), v = max(alpha_v, min_alpha);
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

/// The facets that v sees: D(h) G1(v) |v.h| / |v.z|, per solid angle of h, with the G1 that makes
/// it a density: 2 / (1 + erf(a) + exp(-a^2) / (sqrt(pi) a)), a = |v.z| / sqrt((ax vx)^2 + (ay
/// vy)^2).
template <class U>
U pdf_beckmann_visible(const Ggx<U>& g, const Vec3<U>& v, const Vec3<U>& h) {
    const U zero(0.0f), one(1.0f), cosine = abs(v.z);
    const U slant = safe_sqrt(U(sqr(g.alpha_x * v.x) + sqr(g.alpha_y * v.y)));
    const U a = cosine / select(slant > zero, slant, one);  // large enough where v is the normal
    const U seen = cosine * (one + select(slant > zero, erf(a), one)) +
                   slant * (U(std::numbers::inv_sqrtpi) * exp(-sqr(a)));
    const U v_h = dot(v, h);
    return select(v_h * v.z > zero, beckmann_d(g, h) * safe_divide(U(U(2.0f) * abs(v_h)), seen),
                  zero);
}

/// The slope x of Beckmann's facets of roughness 1 towards v, tilted by an angle of cotangent a,
/// that v sees: its density is (a - x) exp(-x^2), x < a. From u uniform in (0, 1).
///
/// With b = erf(x) the distribution function is h(b) = sqrt(pi) a (1 + b) + exp(-x^2), over h at
/// b = erf(a). It rises less and less, so Newton's steps come from below after the first.
template <class U>
U sample_beckmann_slope(const U& a, const U& u) {
    constexpr int kSteps = 3;  // the distribution function is right to 3e-6
    constexpr float kBelowOne = 1 - 0x1p-22f;
    const U one(1.0f), scaled = U(1 / std::numbers::inv_sqrtpi) * a, top = erf(a);
    const U goal = u * (scaled * (one + top) + exp(-sqr(a)));
    U b = top - (one + top) * erf(sqrt(U(-log(u))));  // exact where a is 0
    for (int step = 0; step < kSteps; ++step) {
        b = min(max(b, U(-kBelowOne)), U(top - U(1e-6f)));
        const U x = inverse_erf(b);
        const U slope = max(U(scaled - U(1 / std::numbers::inv_sqrtpi) * x), U(1e-6f));
        b = b - (scaled * (one + b) + exp(-sqr(x)) - goal) / slope;
    }
    return inverse_erf(U(min(max(b, U(-kBelowOne)), min(top, U(kBelowOne)))));
}

/// A facet normal that v sees (v.z > 0), from u uniform in [0, 1)^2.
template <class U>
Vec3<U> sample_beckmann_visible(const Ggx<U>& g, const Vec3<U>& v, const Vec2<U>& u) {
    constexpr float kMin = 0x1p-25f, kBelowOne = 1 - 0x1p-22f;
    const U zero(0.0f), one(1.0f);
    // Stretched to roughness 1; (c, s) is the azimuth of v there.
    const Vec2<U> tilt{g.alpha_x * v.x, g.alpha_y * v.y};
    const U sine = safe_sqrt(U(sqr(tilt.x) + sqr(tilt.y)));
    const auto tilted = sine > zero;
    const U inverse = one / select(tilted, sine, one);
    const U c = select(tilted, tilt.x * inverse, one), s = tilt.y * inverse;
    constexpr float kUpright = 1e6f;  // the tilt makes no difference from there on
    const U a = min(U(select(tilted, v.z * inverse, U(kUpright))), U(kUpright));
    const U along = sample_beckmann_slope(a, U(max(u.x, U(kMin))));
    const U across = inverse_erf(U(min(max(U(2.0f) * u.y - one, U(-kBelowOne)), U(kBelowOne))));
    return normalize(
        Vec3<U>{-g.alpha_x * (c * along - s * across), -g.alpha_y * (s * along + c * across), one});
}

/// Density of sample_facet in solid angle of h.
template <class U>
U pdf_facet(const Facets<U>& f, const Vec3<U>& v, const Vec3<U>& h) {
    if (!any(f.beckmann)) return pdf_ggx_visible(f.ggx, v, h);
    if (all(f.beckmann)) return pdf_beckmann_visible(f.ggx, v, h);
    return select(f.beckmann, pdf_beckmann_visible(f.ggx, v, h), pdf_ggx_visible(f.ggx, v, h));
}

/// A facet normal that v sees (v.z > 0), from u uniform in [0, 1)^2.
template <class U>
Vec3<U> sample_facet(const Facets<U>& f, const Vec3<U>& v, const Vec2<U>& u) {
    if (!any(f.beckmann)) return sample_ggx_visible(f.ggx, v, u);
    if (all(f.beckmann)) return sample_beckmann_visible(f.ggx, v, u);
    return select(f.beckmann, sample_beckmann_visible(f.ggx, v, u),
                  sample_ggx_visible(f.ggx, v, u));
}

}  // namespace burnish
