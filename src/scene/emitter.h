// Sources of light.
#pragma once

#include <variant>

#include "core/transform.h"
#include "image/image.h"
#include "scene/ids.h"

namespace burnish {

/// Emits `radiance` (linear RGB) from the front side of a shape, times the texture where there is
/// one.
struct AreaEmitter {
    Rgbf radiance{1, 1, 1};
    ShapeId shape;
    TextureId texture = {};
};

/// Light from infinity. image: [height, width, 3]; u is periodic with texel centres at (x + 1/2) /
/// width, v is aligned with the corners: row 0 is the pole +y, the last row the pole -y. Local
/// direction (sin phi sin theta, cos theta, -cos phi sin theta) with phi = 2 pi u, theta = pi v.
/// Radiance = texel * scale.
struct EnvironmentEmitter {
    SharedImage image;  ///< there is one
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

/// Shines from the origin of to_world into a cone around its +z: with the intensity (W / sr) within
/// beam_width of the axis, with none beyond cutoff, and linearly in the angle between. The texture,
/// where there is one, covers the cone and multiplies.
struct SpotEmitter {
    Transform to_world;  ///< rigid
    Rgbf intensity{1, 1, 1};
    float cutoff = 20, beam_width = 15;  ///< degrees
    TextureId texture = {};
};

/// Parallel light from infinity.
struct DirectionalEmitter {
    Vec3f direction{0, 0, 1};  ///< unit, the way that light travels
    Rgbf irradiance{1, 1, 1};  ///< of a surface that faces it
};

/// A slide projector: a pinhole camera the other way round, with the axes of PerspectiveCamera.
/// A surface that faces it at distance 1 along +z has the irradiance pi * irradiance * texture.
struct ProjectorEmitter {
    Transform to_world;  ///< rigid
    Rgbf irradiance{1, 1, 1};
    TextureId texture = {};
    double fov_x = 50;  ///< degrees
    double aspect = 1;  ///< width / height
};

/// To add a kind: a struct above and its place in this variant. The compiler then names what lacks:
/// scene/emitter.cpp, paths/lights.cpp, render/view.cpp, optimize/scene_inputs.cpp, cli/inspect.cpp
/// and cli/findings{,_space}.cpp; a kind of its own in Lights::Kind also paths/light_columns.cpp.
/// Its reader in mitsuba/emitters.cpp is not named, nor is docs/reference/mitsuba.md.
using Emitter = std::variant<AreaEmitter, EnvironmentEmitter, ConstantEmitter, PointEmitter,
                             SpotEmitter, DirectionalEmitter, ProjectorEmitter>;

/// The texture that it reads; invalid: none.
TextureId texture_of(const Emitter& emitter);

}  // namespace burnish
