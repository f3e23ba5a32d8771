// What a BSDF sampler returns, and maps from the unit square.
#pragma once

#include "core/angle.h"
#include "core/scalar.h"
#include "core/vec.h"

namespace burnish {

/// BSDF times |cos theta_o|, linear RGB, and the density of sampling wo.
template <class U>
struct BsdfValue {
    Rgb<U> f{};
    U pdf{};
};

/// A direction without its density. Where it is not proper, it lies on the wrong side: no sample.
template <class U>
struct SampledDirection {
    Vec3<U> wo_local{};
    MaskOf<U> proper{};
    MaskOf<U> delta{};  ///< the one direction of a delta lobe
    /// Of a delta lobe, in the place of value and density: f is the share of light that it reflects
    /// or transmits, pdf the probability with which the lobe is chosen.
    BsdfValue<U> lobe{};
    U eta{1.0f};  ///< index of refraction on the side of wo over that of wi; 1 where it reflects
};

/// Cosine-distributed direction about +z; pdf z / pi.
template <class U>
Vec3<U> square_to_cosine_hemisphere(const Vec2<U>& u) {
    const U r = safe_sqrt(u.x);
    const SinCos<U> phi = sin_cos_turns(u.y);
    return {r * phi.cos, r * phi.sin, safe_sqrt(U(1.0f) - u.x)};
}

}  // namespace burnish
