// `principled`'s parameters from a row of inputs.
#pragma once

#include "shading/bsdf_row.h"
#include "shading/principled.h"

namespace burnish {

inline float min_transmission(const Principled& bsdf) {
    using enum PrincipledScalar;
    return bsdf.has_spec_trans ? min_share({bsdf[kSpecTrans].texture, bsdf[kMetallic].texture}) : 0;
}

/// Sheen shares the directions of the diffuse lobe, but not its factor 1 - spec_trans.
inline float min_diffuse(const Principled& bsdf) {
    using enum PrincipledScalar;
    if (bsdf.has_sheen && bsdf.has_spec_trans) return kLobeShare;
    return min_share({bsdf[kMetallic].texture, bsdf[kSpecTrans].texture});
}

inline float min_clearcoat(const Principled& bsdf) {
    return min_share({bsdf[PrincipledScalar::kClearcoat].texture});
}

/// x as a To: without its derivatives where To has none.
template <class To, class T>
To carry(const T& x) {
    if constexpr (std::is_same_v<To, T>)
        return x;
    else
        return To(value(x));
}

/// The colour as a C, the shape as an S, the weights as a W. Sampling rates stay at their defaults:
/// values and derivatives do not read them.
template <class C, class S, class W, class T>
PrincipledParameters<C, S, W> principled_parameters(const Principled& bsdf,
                                                    const std::array<T, kBsdfInputs>& v) {
    PrincipledParameters<C, S, W> p;
    p.base_color = {carry<C>(v[0]), carry<C>(v[1]), carry<C>(v[2])};
    p.roughness = carry<S>(v[3]), p.anisotropic = carry<S>(v[4]);
    p.metallic = carry<W>(v[5]), p.spec_trans = carry<W>(v[6]), p.spec_tint = carry<W>(v[7]);
    p.sheen = carry<W>(v[8]), p.sheen_tint = carry<W>(v[9]), p.flatness = carry<W>(v[10]);
    p.clearcoat = carry<W>(v[11]), p.clearcoat_gloss = carry<W>(v[12]);
    p.eta = Plain<T>(bsdf.eta);
    p.has_spec_trans = bsdf.has_spec_trans, p.has_clearcoat = bsdf.has_clearcoat;
    p.has_sheen = bsdf.has_sheen, p.has_flatness = bsdf.has_flatness;
    p.has_spec_tint = bsdf.has_spec_tint, p.has_anisotropic = bsdf.has_anisotropic;
    return p;
}

template <class T>
PrincipledParameters<T> principled_parameters(const Principled& bsdf,
                                              const std::array<T, kBsdfInputs>& v) {
    return principled_parameters<T, T, T>(bsdf, v);
}

}  // namespace burnish
