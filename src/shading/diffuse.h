// Lambertian reflection, one-sided: f = reflectance / pi * cos(theta_o) for both directions on the
// front. wi points to the camera, wo to the light; both away from the surface, z = normal.
#pragma once

#include "shading/warp.h"

namespace burnish {

template <class T>
struct DiffuseParameters {
    Rgb<T> reflectance{};  ///< linear RGB in [0, 1]
};

/// BSDF times |cos theta_o|, linear RGB.
template <class T>
Rgb<T> eval_diffuse(const DiffuseParameters<T>& p, const Vec3<Plain<T>>& wi_local,
                    const Vec3<Plain<T>>& wo_local) {
    using U = Plain<T>;
    const auto front = wi_local.z > U(0.0f) && wo_local.z > U(0.0f);
    return p.reflectance * T(select(front, wo_local.z * U(std::numbers::inv_pi), U(0.0f)));
}

/// Density of sample_diffuse in solid angle.
template <class T>
Plain<T> pdf_diffuse(const DiffuseParameters<T>&, const Vec3<Plain<T>>& wi_local,
                     const Vec3<Plain<T>>& wo_local) {
    using U = Plain<T>;
    const auto front = wi_local.z > U(0.0f) && wo_local.z > U(0.0f);
    return select(front, wo_local.z * U(std::numbers::inv_pi), U(0.0f));
}

/// u: uniform in [0, 1)^2. T without derivatives.
template <class T>
SampledDirection<T> sample_diffuse(const DiffuseParameters<T>&, const Vec3<T>& wi_local,
                                   const Vec2<T>& u) {
    return {square_to_cosine_hemisphere(u), wi_local.z > T(0.0f)};
}

}  // namespace burnish
