// Camera samples -> samples of direct light: the incoherent, expensive half of the renderer.
// Samples are worked on in batches, as structures of arrays, so that every stage is a straight loop
// over packets of sixteen: primary rays, surfaces, light samples, BSDF samples, shadow rays.
//
// A BSDF sample matters only where its ray ends on a light. So it is first traced against the
// shapes that emit, and then, like a light sample, tested for anything in between: a question with
// yes for an answer, which costs a fraction of finding the closest surface.
#pragma once

#include <span>
#include <vector>

#include "paths/path.h"
#include "paths/trace_input.h"

namespace burnish {

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
