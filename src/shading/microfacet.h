// Microfacet distributions: anisotropic GGX with separable Smith masking [Walter et al. 2007; Heitz
// 2018, "Sampling the GGX Distribution of Visible Normals"] and isotropic GTR1 [Burley 2012].
// Roughnesses are of the scalar type T, directions of its plain type U. Facet normals h have h.z >=
// 0.
#pragma once

#include "core/angle.h"
#include "core/scalar.h"
#include "core/vec.h"

namespace burnish {

template <class T>
struct Ggx {
    T alpha_x{}, alpha_y{};  ///< > 0
};

/// D(h) = 1 / (pi ax ay (hx^2/ax^2 + hy^2/ay^2 + hz^2)^2), per unit area and solid angle.
template <class T>
T ggx_d(const Ggx<T>& g, const Vec3<Plain<T>>& h) {
    using U = Plain<T>;
    const T inverse_x = reciprocal(g.alpha_x), inverse_y = reciprocal(g.alpha_y);
    const T e = sqr(h.x * inverse_x) + sqr(h.y * inverse_y) + sqr(h.z);
    return U(std::numbers::inv_pi) * inverse_x * inverse_y * sqr(reciprocal(e));
}

/// What masking divides |v.z| by: G1(v) = 2 |v.z| / ggx_slant(v), where v sees the front of the
/// facet.
template <class T>
T ggx_slant(const Ggx<T>& g, const Vec3<Plain<T>>& v) {
    const T slope = sqr(g.alpha_x * v.x) + sqr(g.alpha_y * v.y);
    return abs(v.z) + safe_sqrt(slope + sqr(v.z));
}

/// Smith masking G1(v) = 2 / (1 + sqrt(1 + ((ax vx)^2 + (ay vy)^2) / vz^2)), written without the
/// quotient; 0 where v sees the back of the facet.
template <class T>
T ggx_g1(const Ggx<T>& g, const Vec3<Plain<T>>& v, const Vec3<Plain<T>>& h) {
    using U = Plain<T>;
    const T g1 = U(2.0f) * abs(v.z) / ggx_slant(g, v);
    return select(dot(v, h) * v.z > U(0.0f), g1, T(0.0f));
}

/// G1(wi) G1(wo) / (4 |wi.z| |wo.z|), where both see the front of the facet.
template <class T>
T ggx_visibility(const Ggx<T>& g, const Vec3<Plain<T>>& wi, const Vec3<Plain<T>>& wo) {
    return reciprocal(ggx_slant(g, wi) * ggx_slant(g, wo));
}

/// Density of sample_ggx_visible in solid angle of h: D(h) G1(v, h) |v.h| / |v.z|.
template <class T>
T pdf_ggx_visible(const Ggx<T>& g, const Vec3<Plain<T>>& v, const Vec3<Plain<T>>& h) {
    using U = Plain<T>;
    const U cosine = abs(v.z);
    return ggx_d(g, h) * ggx_g1(g, v, h) * safe_divide(U(abs(dot(v, h))), cosine);
}

/// The facet normal that v sees (v.z > 0) for a point of the unit disk. Uniform points give the
/// density of visible normals.
template <class U>
Vec3<U> ggx_visible_normal(const Ggx<U>& g, const Vec3<U>& v, const Vec2<U>& disk) {
    const U zero(0.0f), one(1.0f);
    // Stretch to the unit sphere, and a frame about the stretched direction.
    const Vec3<U> w = normalize(Vec3<U>{g.alpha_x * v.x, g.alpha_y * v.y, v.z});
    const U squared = sqr(w.x) + sqr(w.y);
    const auto tilted = squared > zero;
    const U inverse = one / sqrt(select(tilted, squared, one));
    const Vec3<U> s{select(tilted, -w.y * inverse, one), select(tilted, w.x * inverse, zero), zero};
    const Vec3<U> t = cross(w, s);
    // A point on the projected hemisphere, and back to the ellipsoid.
    const U p = disk.x, blend = U(0.5f) * (one + w.z);
    const U q = lerp(safe_sqrt(one - sqr(p)), disk.y, blend);
    const U n = safe_sqrt(one - sqr(p) - sqr(q));
    const Vec3<U> m = s * p + t * q + w * n;
    return normalize(Vec3<U>{g.alpha_x * m.x, g.alpha_y * m.y, max(m.z, zero)});
}

/// A facet normal that v sees (v.z > 0), from u uniform in [0, 1)^2.
template <class U>
Vec3<U> sample_ggx_visible(const Ggx<U>& g, const Vec3<U>& v, const Vec2<U>& u) {
    const U r = safe_sqrt(u.x);
    const SinCos<U> phi = sin_cos_turns(u.y);
    return ggx_visible_normal(g, v, {r * phi.cos, r * phi.sin});
}

/// GTR1: D(h) = (a^2 - 1) / (pi ln a^2 (1 + (a^2 - 1) hz^2)), with 1 - hz^2 taken from hx and hy.
template <class T>
T gtr1_d(const T& alpha, const Vec3<Plain<T>>& h) {
    using U = Plain<T>;
    const T a2 = sqr(alpha);
    const T e = a2 * sqr(h.z) + (sqr(h.x) + sqr(h.y));
    return (a2 - U(1.0f)) / (U(std::numbers::pi) * log(a2) * e);
}

/// Density of sample_gtr1 in solid angle of h.
template <class T>
T pdf_gtr1(const T& alpha, const Vec3<Plain<T>>& h) {
    return gtr1_d(alpha, h) * max(h.z, Plain<T>(0.0f));
}

/// A facet normal distributed as D(h) hz, from u uniform in [0, 1)^2.
template <class U>
Vec3<U> sample_gtr1(const U& alpha, const Vec2<U>& u) {
    const U one(1.0f), a2 = sqr(alpha);
    const U sin2 = clamp01((exp(log(a2) * (one - u.x)) - a2) / (one - a2));
    const U sine = safe_sqrt(sin2);
    const SinCos<U> phi = sin_cos_turns(u.y);
    return {sine * phi.cos, sine * phi.sin, safe_sqrt(one - sin2)};
}

}  // namespace burnish
