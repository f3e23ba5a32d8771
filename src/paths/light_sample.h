// What a light sample is.
#pragma once

#include "core/vec.h"

namespace burnish {

/// One sample of the emitter technique.
struct LightSample {
    Vec3f direction_world;  ///< unit, from the surface to the light
    float distance = 0;     ///< to the light; infinity for light from infinity
    Rgbf radiance;          ///< black where the sample failed (the light faces away)
    float pdf = 0;          ///< solid angle (at a light with interpolated normals measured by the
                            ///< shading normal, as in Mitsuba), choice of the emitter included; of
                            ///< a delta light the probability of its choice
    /// A point, beam or direction: no other technique finds it; radiance is intensity / distance^2,
    /// or the irradiance of light from infinity.
    bool delta = false;
};

}  // namespace burnish
