// Scene files of the versions before 2.0: their names and elements become today's.
#pragma once

#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// "toWorld" -> "to_world", "intIOR" -> "int_ior"; "B" stays.
std::string snake_case(const std::string& name);

/// Upgrades an element and all below it, as Mitsuba 3 does: names in camel case, diffuse's
/// `diffuse_reflectance`, a texture's offsets and scales, <lookAt>, the scale of a bump map's
/// texture, which becomes the map's, a bitmap's gamma of 1, which becomes `raw`, the version of a
/// scene; and filters of bitmaps that Mitsuba 3 no longer has.
void upgrade(Node& node);

/// Puts plugins that Mitsuba 3 has in the place of those that are read as them, in an element and
/// all below it, and takes out parameters and values that are read without a warning and that it
/// does not have.
void replace_old_plugins(Node& node);

}  // namespace burnish::mitsuba
