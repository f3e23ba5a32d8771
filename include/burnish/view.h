// What a picture was taken with: a camera, and the lights that were on.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "burnish/image.h"

namespace burnish {

/// A 4x4 matrix that acts on column vectors, row by row.
using Matrix = std::array<double, 16>;
inline constexpr Matrix kIdentityMatrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// What bends a camera's rays. To add one: here, its name in python/cameras.cpp, and where the
/// compiler asks; which files have it: captures/camera_model.cpp.
enum class LensKind {
    kPinhole,       ///< nothing; no coefficient
    kBrownConrady,  ///< radial and tangential: k1 k2 p1 p2 k3 k4 k5 k6, as OpenCV and COLMAP
    kFisheye,       ///< equidistant: k1 k2 k3 k4, as OpenCV and COLMAP
};

/// The distortion of a lens. It acts on directions, so it does not depend on the picture's size. A
/// direction with the axis' angle a lies at the focal length times
///   kBrownConrady: p r + 2 (q p) p + t q,
///                  r = (1 + k1 t + k2 t^2 + k3 t^3) / (1 + k4 t + k5 t^2 + k6 t^3),
///                  p: the direction's (x / z, y / z), t = |p|^2, q = (p2, p1);
///   kFisheye:      a (1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8), outwards
/// from the principal point. Nothing is seen outside of the lens's field: the widest cone around
/// the axis, at most 89 degrees to each side of it (kFisheye: 180), in which these grow with the
/// angle.
struct Lens {
    LensKind kind = LensKind::kPinhole;
    std::array<double, 8> coefficients{};  ///< in the order above; the others are 0

    friend bool operator==(const Lens&, const Lens&) = default;
};

/// A camera with a lens. Pictures are never resampled: the lens bends its rays.
struct Camera {
    int width = 0, height = 0;  ///< of the picture, in pixels, 1 to 32768
    /// Focal lengths in pixels, above 0: the picture reaches at most 1e5 times as far to a side as
    /// ahead.
    double focal_x = 0, focal_y = 0;
    double center_x = 0, center_y = 0;  ///< principal point in pixels; the upper left corner of the
                                        ///< first pixel lies at (0, 0), its centre at (0.5, 0.5)
    /// A rotation, off by a thousandth at most (its columns are made perpendicular and of length
    /// 1), and a translation. The camera's x points right, y down, z forward.
    Matrix camera_to_world = kIdentityMatrix;
    Lens lens = {};

    friend bool operator==(const Camera&, const Camera&) = default;
};

/// A sensor of the scene file, by its id or its number from 0; empty: the first one. As a View's
/// camera, Sensor{} is the renderer's; "0" is the first one there, too.
struct Sensor {
    std::string name = {};
    /// Of the picture, in the place of the film's, unless both are 0: of the aspect ratio of the
    /// film, or of its crop window, to less than a pixel, where `scaled` may have left out a row
    /// more. The field of view stays.
    int width = 0, height = 0;

    friend bool operator==(const Sensor&, const Sensor&) = default;
};

using ViewCamera = std::variant<Sensor, Camera>;

/// The camera of a picture that `scaled` of burnish/photograph.h has made smaller. factor: in
/// (0, 1]. Throws InputError for others, and for a camera without pixels.
Camera scaled(const Camera& camera, double factor);

/// Light from infinity, as Mitsuba's `envmap`.
struct Environment {
    /// Radiance [height, width, 3], linear RGB, finite, at least 2 x 2; none: that of the scene. A
    /// channel may be negative, the luminance of a texel not. Of two rows the last counts twice.
    /// Views under one sky, turned or scaled, should share it: then it is prepared once.
    SharedImage image = {};
    /// Of the radiance, 0 to 3.4e38; empty: 1 of an image of its own, else the scene's.
    std::optional<double> scale = {};
    /// A rotation; empty: none of an image of its own, else the scene's.
    std::optional<Matrix> to_world = {};

    /// Of the images' pixels, not of who holds them.
    friend bool operator==(const Environment& a, const Environment& b) {
        return a.scale == b.scale && a.to_world == b.to_world &&
               (a.image == b.image || (a.image && b.image && *a.image == *b.image));
    }
};

/// What shines in a view.
struct Lighting {
    /// Ids of the emitters that are on; the others are dark. An area emitter without an id goes by
    /// that of its shape. Empty: all of the scene.
    std::optional<std::vector<std::string>> emitters = {};
    /// In the place of the scene's environment; it is on whatever `emitters` says.
    std::optional<Environment> environment = {};

    friend bool operator==(const Lighting&, const Lighting&) = default;
};

}  // namespace burnish
