// The inputs of a BSDF in a row, and `principled`'s parameters from them.
#pragma once

#include <array>

#include "burnish/scene/material.h"
#include "burnish/shading/principled.h"

namespace burnish {

/// Three channels of a colour (a base colour or a reflectance), then the scalars.
inline constexpr std::size_t kBsdfColor = 3;
inline constexpr std::size_t kBsdfInputs = kBsdfColor + kPrincipledScalars;

/// Sampling rates stay at their defaults: values and derivatives do not read them.
template <class T>
PrincipledParameters<T> principled_parameters(const Principled& bsdf,
                                              const std::array<T, kBsdfInputs>& v) {
    PrincipledParameters<T> p;
    p.base_color = {v[0], v[1], v[2]};
    p.roughness = v[3], p.anisotropic = v[4], p.metallic = v[5], p.spec_trans = v[6];
    p.spec_tint = v[7], p.sheen = v[8], p.sheen_tint = v[9], p.flatness = v[10];
    p.clearcoat = v[11], p.clearcoat_gloss = v[12];
    p.eta = Plain<T>(bsdf.eta);
    p.has_spec_trans = bsdf.has_spec_trans, p.has_clearcoat = bsdf.has_clearcoat;
    p.has_sheen = bsdf.has_sheen, p.has_flatness = bsdf.has_flatness;
    p.has_spec_tint = bsdf.has_spec_tint, p.has_anisotropic = bsdf.has_anisotropic;
    return p;
}

}  // namespace burnish
