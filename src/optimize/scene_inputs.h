// What a renderer's scene is made of, as hashes.
#pragma once

#include <vector>

#include "burnish/input.h"
#include "render/renderer.h"

namespace burnish {

/// The elements of its file with the values of $names, its texels and vertices, and what was
/// chosen for the renderer: camera, light, light selection. Not the names of files, which may lie
/// elsewhere by now.
std::vector<Input> inputs_of(const RendererData& renderer);

}  // namespace burnish
