// The camera and its film.
#pragma once

#include <string>

#include "core/transform.h"

namespace burnish {

enum class FilterKind { kBox, kTent, kGaussian, kMitchell, kCatmullRom, kLanczos };

/// Reconstruction filter h: separable, zero outside [-radius, radius] pixels on each axis.
struct ReconstructionFilter {
    FilterKind kind = FilterKind::kGaussian;
    float radius = 2.0f;               ///< pixels
    float stddev = 0.5f;               ///< gaussian, pixels
    float b = 1.0f / 3, c = 1.0f / 3;  ///< mitchell
};

/// What a picture's file holds.
enum class PixelFormat { kRgb, kRgba, kLuminance, kLuminanceAlpha };

/// The image is the crop window of a (width x height) film; an uncropped film has crop = whole.
struct Film {
    int width = 768, height = 576;
    int crop_x = 0, crop_y = 0, crop_width = 768, crop_height = 576;
    ReconstructionFilter filter;
    PixelFormat pixel_format = PixelFormat::kRgb;
};

/// The number of pixels of its image; a double, as is what it is multiplied with.
inline double pixels_of(const Film& film) { return double{1} * film.crop_width * film.crop_height; }

/// Of cameras, lights and shapes from the origin: rays overflow far beyond.
inline constexpr double kMaxDistance = 1e12;
/// Aside of a camera's axis, of what its rays begin at or pass: squares far beyond overflow.
inline constexpr double kMaxRayReach = 1e17;

/// Looks along local +z, +y is up, +x is left in the image. A pinhole camera, unless it is
/// orthographic or has an aperture.
struct PerspectiveCamera {
    Transform to_world;                        ///< rigid
    double fov_x = 50;                         ///< degrees, horizontal, of the whole film
    float near_clip = 1e-2f, far_clip = 1e4f;  ///< along local z
    /// Fractions of the film, added to the sample position.
    double principal_offset_x = 0, principal_offset_y = 0;
    /// Of a thin lens; 0: a pinhole.
    float aperture_radius = 0;
    float focus_distance = 1e4f;  ///< along local z, of what a thin lens shows sharp
    /// Of an orthographic camera: the width of what it sees, in world units; 0: it is none.
    double orthographic_width = 0;
};

/// A sensor of the scene file.
struct SceneSensor {
    /// "sensor_0", counted from 0, where the file gives none, and "sensor_0_" where it gives that.
    std::string id;
    PerspectiveCamera camera;
    Film film;
    std::size_t number = 0;  ///< among all sensors of the file, those that were left out included
};

}  // namespace burnish
