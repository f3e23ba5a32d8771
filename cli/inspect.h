// What a scene holds, and what looks wrong in it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "paths/trace.h"

namespace burnish {

struct ParameterFacts {
    std::string name, file;
    int width = 0, height = 0, channels = 0;
    TextureFilter filter = TextureFilter::kBilinear;
    TextureWrap wrap = TextureWrap::kRepeat;
    bool raw = false;
    double low = 0, mean = 0, high = 0;  ///< of the linear values
    double seen = 0;  ///< share of the pictures whose first surface reads the texture
};

/// The emitters of one kind.
struct LightFacts {
    std::string kind;
    std::size_t count = 0;
    double area = 0;           ///< of area lights, world units squared
    double power = 0;          ///< luminance of what lights at finite distance give off
    double mean_radiance = 0;  ///< luminance of light from infinity, over the sphere
    double irradiance = 0;     ///< luminance of parallel light, on what faces it
};

struct SceneFacts {
    std::size_t meshes = 0, spheres = 0, disks = 0, cylinders = 0, instances = 0;
    std::size_t triangles = 0, vertices = 0;  ///< in memory: of what instances show once
    std::vector<ParameterFacts> parameters;
    std::vector<LightFacts> lights;
    double seconds = 0;  ///< of one sample per pixel of the picture, measured here and now
    double memory = 0;   ///< bytes of the process once it is ready to be rendered: an estimate
    std::vector<std::string> findings;  ///< what looks wrong, one sentence each
};

/// Looks at everything once; a grid of camera rays tells what the pictures show. views: the cameras
/// of pictures to fit, if there are some: they take the place of the scene's own.
SceneFacts inspect(const TracedScene& traced, std::span<const TracedScene> views = {});

/// Of one sample per pixel, taken here and now of a picture of at most about 200000 pixels.
double seconds_of_a_pass(const TracedScene& traced);

/// Whether a shape is seen in a coarse picture: small ones may be missed.
bool shows_a_shape(const TracedScene& view);

const char* name_of(TextureFilter filter);
const char* name_of(TextureWrap wrap);
const char* name_of(FilterKind filter);

}  // namespace burnish
