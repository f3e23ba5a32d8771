// A scene file as it was read: what it takes to write it again with other textures.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mitsuba/node.h"

namespace burnish {

/// Where a parameter is written: elements by their Node::order.
struct ParameterSource {
    int bsdf = -1;              ///< the bsdf that has it
    std::string property = {};  ///< its name there, say "roughness"
    int texture = -1;           ///< its texture; -1: a constant, or nothing at all
};

struct SceneSource {
    /// The <scene>, without $parameters, includes, paths, aliases and references to values.
    mitsuba::Node root = {};
    std::filesystem::path folder = {};  ///< of the top-level scene: all of its files lie within
    /// The files that it names, by the Node::order of the <string name="filename"> or of the <ref>
    /// in whose place it stands.
    std::map<int, std::filesystem::path> files = {};
    std::vector<ParameterSource> parameters = {};  ///< parallel to Scene::parameters as it was read
    std::vector<int> bsdfs = {};  ///< parallel to Scene::bsdfs; -1: made up, for a shape without
    std::map<std::int32_t, int> blends = {};  ///< of those materials that are blends
};

}  // namespace burnish
