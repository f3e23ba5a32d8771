// Camera samples -> samples of light: the incoherent, expensive half of the renderer. Samples are
// worked on in batches, as structures of arrays, so that every stage is a straight loop over
// packets of sixteen: primary rays, surfaces, light samples, BSDF samples, shadow rays.
//
// Where light bounces (Scene::max_depth), paths are chains of vertices: see paths/chains.h.
#pragma once

#include <span>
#include <vector>

#include "paths/path.h"
#include "paths/trace_input.h"

namespace burnish {

struct BatchOutput {
    /// Per sample: light that reaches the camera without scattering; where light bounces, without
    /// being scattered by an unknown.
    std::vector<Rgbf> emitted;
    /// Light samples first, then BSDF samples; at most one each per sample. Where light bounces
    /// those of all vertices with unknowns, sample by sample.
    std::vector<DirectSample> direct_samples;
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
