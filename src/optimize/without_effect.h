// Options that have no effect beside the values of others, the scene or the views.
#pragma once

#include <string>
#include <vector>

#include "burnish/options.h"
#include "scene/scene.h"

namespace burnish {

/// The unknowns of a run.
struct UnknownTextures {
    std::vector<TextureId> all, searched;  ///< searched: those whose start is
};

/// A sentence of each one. fitted: how many views are.
std::vector<std::string> options_without_effect(const Options& options, const Scene& scene,
                                                const UnknownTextures& unknowns,
                                                std::size_t fitted);

}  // namespace burnish
