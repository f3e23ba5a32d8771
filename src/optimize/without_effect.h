// Options that have no effect beside the values of others, the scene or the views.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "burnish/options.h"
#include "scene/scene.h"

namespace burnish {

/// A sentence of each one. searched: the textures whose start is searched; fitted: how many views
/// are.
std::vector<std::string> options_without_effect(const Options& options, const Scene& scene,
                                                std::span<const TextureId> searched,
                                                std::size_t fitted);

}  // namespace burnish
