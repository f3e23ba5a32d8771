// Light that is scattered several times. A path is a chain of vertices on surfaces with unknowns;
// what lies between them is constant under theta. At vertex k
//
//   R_k = f_k(wo_light) E_k + f_k(wo_next) (D_k + C_k R_{k+1}),      pixel = D_0 + C_0 R_1.
//
// E_k: light sample, radiance / (p_e + p_b). D_k: light gathered on the stretch to the next vertex,
// by emission and by light samples at constant surfaces. C_k: throughput of that stretch. D_k and
// C_k are divided by the density of wo_next and by the probability that Russian roulette let the
// path go on. All are fixed when the chain is traced, so that it is shaded and differentiated
// backwards without a ray. C_0 is kept within E_1, D_1 and C_1.
//
// P_k = f_1(wo_next) C_1 ... f_{k-1}(wo_next) C_{k-1}: throughput from the camera to vertex k.
#pragma once

#include <span>
#include <vector>

#include "paths/bounces.h"

namespace burnish {

/// The vertices of one path, from the camera on: [begin, end) of ChainOutput::vertices.
struct Chain {
    int sample = 0;  ///< index into the batch
    std::uint32_t begin = 0, end = 0;
};

struct ChainOutput {
    std::vector<Rgbf> emitted;  ///< D_0 of each sample; black for SurfaceChoice::kUnknown
    std::vector<Chain> chains;  ///< those that carry light, in order of samples
    std::vector<ChainVertex> vertices;
    std::size_t rejected = 0;  ///< samples that were not finite
};

/// Traces at most kBatchSamples paths with all of their vertices, whatever techniques a sample asks
/// for. `out` is cleared first.
void trace_chains(const TraceInput& input, std::span<const BatchSample> samples, ChainOutput& out);

/// R_1 of a chain under the textures that it was traced under.
Rgbf value_of(std::span<const ChainVertex> chain);

/// Each vertex of each chain as up to two samples of light, the rest of the path on either side
/// within their radiance. Returns the number of samples that were not finite.
std::size_t append_samples(const TraceInput& input, std::span<const BatchSample> samples,
                           const ChainOutput& chains, std::vector<DirectSample>& out);

}  // namespace burnish
