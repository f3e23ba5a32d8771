// What follows from the index and the roughness of `roughplastic`: how much light its interface
// lets pass.
#pragma once

#include "scene/material.h"

namespace burnish {

/// The same BSDF with its transmittance and internal reflectance, from eta, shape and alpha:
///
///   T(wi) = integral of (1 - F(wi . h)) G1(refracted wi) over the facet normals h that wi sees
///
/// at 64 cosines by Gauss-Legendre quadrature. The internal reflectance is twice the mean over
/// these cosines of the cosine times the same integral of F(wi . h) G1(mirrored wi), with 1 / eta,
/// as in Mitsuba.
RoughPlastic make_rough_plastic(RoughPlastic bsdf);

}  // namespace burnish
