// Which pixels can see given BSDFs: a conservative projection of the shapes that carry them. Rays
// are not asked, so nothing is ever missed; what lies behind other shapes counts as seen.
#pragma once

#include <span>
#include <vector>

#include "paths/traced_scene.h"

namespace burnish {

/// One entry per pixel of the crop window, row by row: 0 only where no camera sample within the
/// pixel can meet a shape with one of the BSDFs; through a thin lens every pixel may. bsdfs:
/// non-zero where asked for, parallel to Scene::bsdfs.
std::vector<char> visible_pixels(const TracedScene& view, std::span<const char> bsdfs);

/// The same of the pixels that light from these BSDFs may reach: where light bounces, all.
std::vector<char> reaching_pixels(const TracedScene& view, std::span<const char> bsdfs);

/// The pixels at most `reach` away from a marked one, on each axis.
std::vector<char> dilate(const std::vector<char>& pixels, int width, int height, int reach);

}  // namespace burnish
