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

/// To add a kind: a struct above and its place in this variant. The compiler then names what lacks:
/// paths/lights.cpp, cli/inspect.cpp and cli/findings.cpp; a kind of its own in Lights::Kind also
/// paths/light_columns.cpp. Only its reader in mitsuba/emitters.cpp is not named.
using Emitter = std::variant<AreaEmitter, EnvironmentEmitter, ConstantEmitter, PointEmitter>;

}  // namespace burnish
