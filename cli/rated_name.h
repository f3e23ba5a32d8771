// Names of parameters with a learning rate.
#pragma once

#include <string>

#include "scene/scene.h"

namespace burnish {

/// "NAME@0.005": a name with a learning rate of its own; 0 where there is none. A name that holds
/// an @ itself is taken as it is where a bitmap or a constant of the scene is called so. Throws
/// UsageError: nothing is before the last @, or what follows it is not a positive number.
struct RatedName {
    std::string name;
    double learning_rate = 0;
};
RatedName split_rate(const Scene& scene, const std::string& text);

/// Whether a number follows the last @: only the scene tells whether it is part of the
/// name.
bool ends_in_rate(const std::string& text);

}  // namespace burnish
