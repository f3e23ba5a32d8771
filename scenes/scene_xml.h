// Pieces of scene.xml that the procedural scenes share. Every piece ends with a line break.
#pragma once

#include <string>

#include "core/vec.h"

namespace burnish::procedural {

/// Where the picture is taken from; fov is horizontal, degrees.
struct View {
    Vec3<double> origin, target;
    double fov = 30;
};

/// A perspective sensor: pixels, the horizontal field of view in degrees, the element within its
/// to_world; the clipping planes and the offset of the principal point, in widths and heights of
/// the film, which are written where they are not Mitsuba's own.
struct SensorText {
    int width = 512, height = 512;
    double fov = 40;
    std::string to_world = {};
    double near = 0.01, far = 10000;
    double offset_x = 0, offset_y = 0;
};

/// From the scene's element to the sensor, with 64 samples.
std::string scene_top(const SensorText& sensor);

/// From the comment on top to the sensor: 512 x 512 pixels, 64 samples. `parameter` is words:
/// "mat-goblet's roughness".
std::string scene_head(const std::string& name, const std::string& parameter, const View& view);

/// <rgb name="..." value="..."/>, linear, without a line break.
std::string rgb(const char* name, const Rgbf& color);

/// A mesh of the folder meshes/ with the BSDF of that id; `to_world` is the transform's children.
std::string ply_shape(const std::string& name, const std::string& bsdf,
                      const std::string& to_world = "");

/// `shape` is a shape element that is still open.
std::string area_light(const std::string& shape, const Rgbf& radiance);

/// A rectangle that shines towards a point.
struct Panel {
    Vec3<double> origin, target;
    double half_width = 1, half_height = 1;
};
std::string panel_light(const Panel& panel, const Rgbf& radiance);

/// A mesh of the folder meshes/, scaled and moved, that shines.
std::string lamp(const std::string& mesh, const Vec3<double>& position, double size,
                 const Rgbf& radiance);

}  // namespace burnish::procedural
