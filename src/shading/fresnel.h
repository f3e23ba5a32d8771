// Fresnel reflection and refraction at a smooth interface. eta is the relative index of refraction,
// inside / outside; "outside" is the side of the normal. Directions point away from the surface.
#pragma once

#include "core/scalar.h"
#include "core/vec.h"

namespace burnish {

template <class U>
struct FresnelResult {
    U reflectance{};  ///< unpolarised, in [0, 1]
    U cos_t{};        ///< cosine of the refracted direction to the normal, sign opposite to cos_i
    U eta_ti{};       ///< index of the incident side / index of the other side
};

/// Dielectric interface seen under the cosine cos_i (negative: from inside). Total internal
/// reflection gives reflectance 1 and cos_t 0; matched indices give reflectance 0.
template <class U>
FresnelResult<U> fresnel_dielectric(const U& cos_i, const U& eta) {
    const U zero(0.0f), one(1.0f);
    const auto outside = cos_i >= zero;
    const U eta_it = select(outside, eta, one / eta), eta_ti = select(outside, one / eta, eta);
    const U c_i = abs(cos_i);
    const U c_t = safe_sqrt(one - sqr(eta_ti) * (one - sqr(cos_i)));
    const U s = safe_divide(c_i - eta_it * c_t, c_i + eta_it * c_t);
    const U p = safe_divide(c_t - eta_it * c_i, c_t + eta_it * c_i);
    const U r = select(c_i == zero, one, U(0.5f) * (sqr(s) + sqr(p)));
    return {select(eta == one, zero, r), select(outside, -c_t, c_t), eta_ti};
}

/// (1 - cos)^5, the weight of Schlick's approximation, for cos in [0, 1].
template <class U>
U schlick_weight(const U& cosine) {
    return pow5(clamp01(U(1.0f) - cosine));
}

/// Schlick's approximation r0 + (1 - r0) weight.
template <class T>
T schlick(const T& r0, const Plain<T>& weight) {
    return r0 + (Plain<T>(1.0f) - r0) * weight;
}

/// Reflectance at normal incidence.
template <class U>
U schlick_r0(const U& eta) {
    return sqr((eta - U(1.0f)) / (eta + U(1.0f)));
}

/// wi mirrored about the unit vector h.
template <class U>
Vec3<U> reflect(const Vec3<U>& wi, const Vec3<U>& h) {
    return h * (U(2.0f) * dot(wi, h)) - wi;
}

/// wi refracted at a facet with normal h, where `f` is the Fresnel result for dot(wi, h).
template <class U>
Vec3<U> refract(const Vec3<U>& wi, const Vec3<U>& h, const FresnelResult<U>& f) {
    return h * (dot(wi, h) * f.eta_ti + f.cos_t) - wi * f.eta_ti;
}

}  // namespace burnish
