// Camera samples -> samples of direct light: the incoherent, expensive half of the renderer.
// Samples are worked on in batches, as structures of arrays, so that every stage is a straight loop
// over packets of sixteen: primary rays, surfaces, light samples, BSDF samples, shadow rays.
//
// A BSDF sample matters only where its ray ends on a light. So it is first traced against the
// shapes that emit, and then, like a light sample, tested for anything in between: a question with
// yes for an answer, which costs a fraction of finding the closest surface.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "paths/accel.h"
#include "paths/columns.h"
#include "paths/lights.h"
#include "paths/path.h"
#include "shading/camera.h"
#include "shading/texture.h"

namespace burnish {

/// The order in which a batch shades: points of one kind of BSDF together, and of one BSDF.
struct BsdfOrder {
    std::vector<std::int32_t> rank;  ///< of each BSDF; -1 where it is black whatever the light
    std::array<std::size_t, std::variant_size_v<Bsdf> + 1> kind_begin{};  ///< first rank of a kind
};

/// A scene made ready for rays. The scene must outlive it.
struct TracedScene {
    const Scene* scene = nullptr;
    Accel accel;
    Accel emitting;  ///< the shapes that emit: what a BSDF sample can find
    bool has_emitting = false;
    std::unique_ptr<const TriangleTable> triangles;  ///< on the heap: lights refers to it
    Lights lights;
    CameraRays camera;
    BsdfOrder bsdf_order;
};

TracedScene prepare(const Scene& scene, LightSelection selection = kDefaultLightSelection);

/// Which surfaces go on to make samples of light; the others stop at the primary hit.
enum class SurfaceChoice {
    kAll,
    kUnknown,   ///< those whose BSDF reads an optimised texture
    kConstant,  ///< the others
};

struct TraceInput {
    const TracedScene* scene = nullptr;
    const TextureTable* textures = nullptr;  ///< what the BSDFs are sampled under
    RandomKey key;
    std::uint32_t passes_per_iteration = 1;
    SurfaceChoice choice = SurfaceChoice::kAll;
    std::span<const char>
        unknown_bsdfs;  ///< non-zero: reads an optimised texture; parallel to Scene::bsdfs
    /// Keep the samples on optimised textures whose value is zero: their derivative may not be.
    bool keep_black = false;
    /// Of the numbers of a pixel's samples from pass to pass, counted as film_pass does.
    Sequence sequence = Sequence::kIndependent;
};

/// A camera sample and the techniques to sample.
struct BatchSample {
    CameraSample camera;
    bool emitter = true, bsdf = true;
};

/// One sample of direct light that reaches the camera.
struct DirectSample {
    int sample = 0;  ///< index into the batch
    PathRecord record;
    Rgbf value;  ///< f(x) Le(x) / (p_e + p_b): what the sample adds to the image
    bool has_unknowns = false;
};

struct BatchOutput {
    std::vector<Rgbf> emitted;  ///< per sample: light that reaches the camera without scattering
    std::vector<DirectSample>
        direct_samples;  ///< light samples first, then BSDF samples; at most one each per sample
    std::size_t rejected = 0;  ///< samples whose value was not finite
};

/// Traces at most kBatchSamples samples. `out` is cleared first; it is reused to save allocations.
/// Results do not depend on batch composition.
void trace_batch(const TraceInput& input, std::span<const BatchSample> samples, BatchOutput& out);

/// The same for an image: radiance[i] is set to what samples[i] brings in all. Returns the number
/// of samples left out because their value was not finite.
std::size_t trace_radiance(const TraceInput& input, std::span<const BatchSample> samples,
                           std::span<Rgbf> radiance);

}  // namespace burnish
