// Camera samples -> draws of direct light: the incoherent, expensive half of the renderer. Samples
// are worked on in batches, as structures of arrays, so that every stage is a straight loop over
// packets of sixteen: primary rays, surfaces, light draws, BSDF draws, shadow rays.
//
// A BSDF draw matters only where its ray ends on a light. So it is first traced against the shapes
// that emit, and then, like a draw of a light, tested for anything in between: a question with
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
    Accel emitting;  ///< the shapes that emit: what a BSDF draw can find
    bool has_emitting = false;
    std::unique_ptr<const TriangleTable> triangles;  ///< on the heap: lights refers to it
    Lights lights;
    CameraRays camera;
    BsdfOrder bsdf_order;
};

TracedScene prepare(const Scene& scene, LightSelection selection = kDefaultLightSelection);

/// Which surfaces go on to make draws; the others stop at the primary hit.
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
    /// Keep the draws on optimised textures whose value is zero: their derivative may not be.
    bool keep_black = false;
    /// Of the numbers of a pixel's draws from pass to pass, counted as film_pass does.
    Sequence sequence = Sequence::kIndependent;
};

/// A camera sample and the techniques to draw.
struct BatchSample {
    CameraSample camera;
    bool emitter = true, bsdf = true;
};

/// One draw that carries light to the camera.
struct DirectSample {
    int sample = 0;  ///< index into the batch
    PathRecord record;
    Rgbf value;  ///< f(x) Le(x) / (p_e + p_b): what the draw adds to the image
    bool has_unknowns = false;
};

struct BatchOutput {
    std::vector<Rgbf> emitted;  ///< per sample: light that reaches the camera without scattering
    std::vector<DirectSample>
        direct_samples;  ///< emitter draws first, then BSDF draws; at most one each per sample
    std::size_t rejected = 0;  ///< draws whose value was not finite
};

/// Traces at most kBatchSamples samples. `out` is cleared first; it is reused to save allocations.
/// What a sample gives does not depend on its company.
void trace_batch(const TraceInput& input, std::span<const BatchSample> samples, BatchOutput& out);

/// The same for an image: radiance[i] is set to what samples[i] brings in all. Returns the number
/// of draws left out because their value was not finite.
std::size_t trace_radiance(const TraceInput& input, std::span<const BatchSample> samples,
                           std::span<Rgbf> radiance);

}  // namespace burnish
