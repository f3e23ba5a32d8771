// Sources of light.
#pragma once

#include <variant>

#include "core/transform.h"
#include "image/image.h"
#include "scene/ids.h"

namespace burnish {

/// Emits `radiance` (linear RGB) from the front side of a shape.
struct AreaEmitter {
    Rgbf radiance{1, 1, 1};
    ShapeId shape;
};

/// Light from infinity. image: [height, width, 3]; u is periodic with texel centres at (x + 1/2) /
/// width, v is aligned with the corners: row 0 is the pole +y, the last row the pole -y. Local
/// direction (sin phi sin theta, cos theta, -cos phi sin theta) with phi = 2 pi u, theta = pi v.
/// Radiance = texel * scale.
struct EnvironmentEmitter {
    Image image;
    float scale = 1;
    Transform to_world;
};

struct ConstantEmitter {
    Rgbf radiance{1, 1, 1};
};

/// intensity: W / sr per channel.
struct PointEmitter {
    Vec3f position;
    Rgbf intensity{1, 1, 1};
};

/// To add a kind: here, in paths/lights.cpp and paths/light_bounds.cpp, and its reader in
/// mitsuba/.
using Emitter = std::variant<AreaEmitter, EnvironmentEmitter, ConstantEmitter, PointEmitter>;

}  // namespace burnish
