// What a BSDF sampler returns, and maps from the unit square.
#pragma once

#include "burnish/core/scalar.h"
#include "burnish/core/vec.h"

namespace burnish {

/// A sampled direction. pdf: solid angle, equal to pdf_*(wi, wo). Where invalid, pdf is 0 and wo
/// means nothing.
template <class U>
struct BsdfSample {
    Vec3<U> wo_local{};
    U pdf{};
    MaskOf<U> valid{};
};

template <class U>
Vec3<U> select(const MaskOf<U>& m, const Vec3<U>& a, const Vec3<U>& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// Cosine-distributed direction about +z; pdf z / pi.
template <class U>
Vec3<U> square_to_cosine_hemisphere(const Vec2<U>& u) {
    const U r = safe_sqrt(u.x), phi = U(2.0 * std::numbers::pi) * u.y;
    return {r * cos(phi), r * sin(phi), safe_sqrt(U(1.0f) - u.x)};
}

}  // namespace burnish
