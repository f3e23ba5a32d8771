// Camera samples -> draws of direct light: the incoherent, expensive half of the renderer. Samples
// are worked on in batches so that every stage is a straight loop: primary rays, surfaces, light
// draws, BSDF draws, shadow rays.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "burnish/paths/accel.h"
#include "burnish/paths/lights.h"
#include "burnish/paths/path.h"
#include "burnish/shading/camera.h"
#include "burnish/shading/texture.h"

namespace burnish {

/// A scene made ready for rays. The scene must outlive it.
struct TracedScene {
    const Scene* scene = nullptr;
    Accel accel;
    std::unique_ptr<const TriangleTable> triangles;  ///< on the heap: lights refers to it
    Lights lights;
    CameraRays camera;
};

TracedScene prepare(const Scene& scene);

/// Which surfaces go on to make draws; the others stop at the primary hit.
enum class SurfaceChoice {
    kAll,
    kDynamic,  ///< those whose BSDF reads an optimised texture
    kStatic,   ///< the others
};

struct TraceInput {
    const TracedScene* scene = nullptr;
    const TextureTable* textures = nullptr;  ///< what the BSDFs are sampled under
    RandomKey key;
    std::uint32_t passes_per_iteration = 1;
    SurfaceChoice choice = SurfaceChoice::kAll;
    std::span<const char>
        dynamic_bsdfs;  ///< non-zero: reads an optimised texture; parallel to Scene::bsdfs
    /// Keep the draws on optimised textures whose value is zero: their derivative may not be.
    bool keep_black = false;
};

/// The most samples in one batch.
inline constexpr int kBatchSamples = 256;

/// A camera sample and the techniques to draw.
struct BatchSample {
    CameraSample camera;
    bool emitter = true, bsdf = true;
};

/// One draw that carries light to the camera.
struct Draw {
    int sample = 0;  ///< index into the batch
    PathRecord record;
    Rgbf value;  ///< f(x) Le(x) / (p_e + p_b): what the draw adds to the image
    bool dynamic = false;
};

struct BatchOutput {
    std::vector<Rgbf> emitted;  ///< per sample: light that reaches the camera without scattering
    std::vector<Draw> draws;    ///< emitter draws first, then BSDF draws, each in order of samples
    std::size_t rejected = 0;   ///< draws whose value was not finite
};

/// Traces at most kBatchSamples samples. `out` is cleared first; it is reused to save allocations.
void trace_batch(const TraceInput& input, std::span<const BatchSample> samples, BatchOutput& out);

}  // namespace burnish
