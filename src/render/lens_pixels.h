// The pixels of a camera with a lens: which see given surfaces, and which see nothing.
#pragma once

#include <functional>
#include <vector>

#include "paths/traced_scene.h"

namespace burnish {

/// One entry per pixel of the crop window: 1 where a part of the pixel lies outside of the lens's
/// field. Without a lens, zeros.
std::vector<char> blind_pixels(const TracedScene& view);

/// The marks of a pinhole camera, one per pixel of its film, for one with a lens: a pixel is marked
/// where its rays may pass a marked pixel of a face of the cube around the camera.
/// project: gives the marks of a pinhole view.
std::vector<char> visible_through_lens(
    const TracedScene& view, const std::function<std::vector<char>(const TracedScene&)>& project);

}  // namespace burnish
