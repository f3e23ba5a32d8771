// The samples of direct light: how one is named, and what is kept of it.
//
// A camera sample starts at one film position, meets one surface (or, where light bounces, several
// one after the other) and makes up to two samples of light there, one for each technique. The
// contribution of a sample x is f(x) Le(x) / (p_e(x) + p_b(x)): multiple importance sampling with
// the balance heuristic.
#pragma once

#include <cstdint>
#include <span>

#include "core/random.h"
#include "core/vec.h"
#include "paths/hit.h"
#include "scene/ids.h"

namespace burnish {

enum class Technique : std::uint8_t { kEmitter, kBsdf };
inline constexpr int kTechniques = 2;
/// Added to a bounce, or to the index of a vertex with an unknown, these name numbers of a camera
/// sample other than those of its directions: for the choice of a path to one light
/// (paths/light_paths.h), for that among the candidates of a light sample, and for Russian
/// roulette.
inline constexpr std::uint32_t kLightChoiceNumbers = 1u << 29, kCandidateNumbers = 1u << 30,
                               kRouletteNumbers = 1u << 31;

/// One camera sample: names its random numbers entirely. All samples of a pass share the film
/// offset.
struct CameraSample {
    std::uint32_t pixel = 0;      ///< y * crop_width + x, of the crop window
    std::uint32_t iteration = 0;  ///< in which it was traced first
    std::uint32_t pass = 0;       ///< of that iteration

    friend bool operator==(const CameraSample&, const CameraSample&) = default;
};

/// A replayable path: primary-sample space [PR sec. 4.2].
struct PathSample {
    CameraSample camera;
    Technique technique = Technique::kEmitter;
    std::uint16_t vertex = 0;  ///< which one with an unknown, counted from the camera

    friend bool operator==(const PathSample&, const PathSample&) = default;
};

/// The number of a sample's pass in its job, counted over all iterations: names the film offset.
inline std::uint32_t film_pass(const CameraSample& s, std::uint32_t passes_per_iteration) {
    return s.iteration * passes_per_iteration + s.pass;
}

/// The film position, within its pixel, of all samples of a pass: [0, 1)^2. The passes of a job
/// form one scrambled Sobol' sequence, whatever that of the samples. Where that is Sobol's too, the
/// offset has other dimensions: all six together are one sequence, and a pixel's samples are spread
/// over the pixel.
Vec2f film_offset(RandomKey key, std::uint32_t film_pass,
                  Sequence sequence = Sequence::kIndependent);

/// The numbers that say where the samples of a job pass a thin lens.
RandomKey aperture_key(RandomKey key);

/// A sample with everything that does not depend on the textures: re-shaded without rays.
/// Directions are in the shading frame of the side that was hit, mirrored to z > 0 where a
/// two-sided material was seen from behind.
struct PathRecord {
    std::uint32_t pixel = 0;
    Technique technique = Technique::kEmitter;
    BsdfId bsdf;
    std::uint32_t film_pass = 0;  ///< names the film position within the pixel
    Vec2f uv;
    Vec3f wi_local, wo_local;  ///< to the camera, to the light
    /// Le / (p_e + p_b) when traced; black: the sample failed or is occluded.
    Rgbf radiance_over_pdf;

    friend bool operator==(const PathRecord&, const PathRecord&) = default;
};

/// Makes light that is not finite black; returns the number of samples.
inline std::size_t leave_out_non_finite(std::span<Rgbf> radiance) {
    std::size_t rejected = 0;
    for (Rgbf& value : radiance)
        if (!is_finite(value)) value = {}, ++rejected;
    return rejected;
}

/// One sample of light that is scattered at a point towards the camera.
struct DirectSample {
    int sample = 0;            ///< index into the batch
    std::uint16_t vertex = 0;  ///< of its path: PathSample::vertex
    PathRecord record;
    /// f(x) Le(x) / (p_e + p_b): what the sample adds to the image. Of light that bounces all that
    /// the vertex scatters from this direction, further vertices included.
    Rgbf value;
    bool has_unknowns = false;
    Hit hit = {};  ///< of the primary ray; of direct light
};

}  // namespace burnish
