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

/// Samples of one technique, of direct light, again: under other textures their light arrived, and
/// their primary rays had these hits. No ray is traced for what no texture changes: to the hits,
/// and between them and a light sample, unless textures choose among its candidates and it was
/// another one in `records`, those of the samples under other textures. Sets the first
/// samples.size() records to those of trace_batch; black where a sample fails. Returns the number
/// of those whose value was not finite.
std::size_t replay_batch(const TraceInput& input, Technique technique,
                         std::span<const CameraSample> samples, std::span<const Hit> hits,
                         std::span<PathRecord> records);

/// The same as trace_batch for an image: radiance[i] is set to what samples[i] brings in all.
/// Returns the number of samples left out because their value was not finite.
std::size_t trace_radiance(const TraceInput& input, std::span<const BatchSample> samples,
                           std::span<Rgbf> radiance);

}  // namespace burnish
