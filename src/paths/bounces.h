// Paths that are scattered several times, traced bounce by bounce: the stages of scatter.h go round
// until no path of the batch goes on.
#pragma once

#include <span>
#include <vector>

#include "paths/path.h"
#include "paths/trace_input.h"

namespace burnish {

/// A vertex on a surface with unknowns. Directions are local, as those of PathRecord.
struct ChainVertex {
    int sample = 0;  ///< index into the batch
    BsdfId bsdf;
    Vec2f uv;
    Vec3f wi;                        ///< towards the camera
    Vec3f wo_light{0, 0, 1};         ///< to the light sample; means nothing where E is black
    Vec3f wo_next{0, 0, 1};          ///< to the next vertex; where D and C are black: nothing
    Rgbf f_light, f_next;            ///< BSDF times cosine, under the textures of tracing
    Rgbf emitted, gathered, onward;  ///< E, D, C
};

/// Traces at most kBatchSamples paths, whatever techniques a sample asks for, and appends the
/// vertices with unknowns, bounce by bounce. emitted[i] is set to what path i brings without being
/// scattered by an unknown; black for SurfaceChoice::kUnknown.
void trace_vertices(const TraceInput& input, std::span<const BatchSample> samples,
                    std::span<Rgbf> emitted, std::vector<ChainVertex>& vertices);

/// The same for an image: sets radiance[i] to what path i brings. SurfaceChoice::kUnknown: the part
/// that an unknown scatters; kConstant: the rest.
void trace_bounces(const TraceInput& input, std::span<const BatchSample> samples,
                   std::span<Rgbf> radiance);

}  // namespace burnish
