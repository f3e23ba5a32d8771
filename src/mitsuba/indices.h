// Indices of refraction by number or by name.
#pragma once

#include "mitsuba/properties.h"
#include "scene/material.h"

namespace burnish::mitsuba {

// Throw InputError: an unknown name (with the names that are known), a number that cannot be.

/// A property like `int_ior`: a number above 0 or the name of a material, `fallback` where it is
/// absent.
double take_dielectric_index(Properties& properties, const std::string& name,
                             const std::string& fallback);
/// A metal's from `material`, or from `eta` and `k`; 0 and 1 where none is given.
MetalIndex take_metal_index(Properties& properties);

}  // namespace burnish::mitsuba
