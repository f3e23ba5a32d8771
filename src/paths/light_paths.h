// Chains as paths to one light each: what is left of a chain where a single sample of it is kept.
//
// A path from the camera to vertex n and on to a light brings f_1 ... f_n K, where f_j is the BSDF
// times the cosine at vertex j and K = C_0 ... C_{n-1} E_n, or D_n in place of E_n
// (paths/chains.h). K holds all that was fixed when the path was traced, densities and the survival
// of Russian roulette within; the f_j are all that depends on textures. So a path is shaded under
// any textures by a product, and, unlike a sum over paths of many lengths, its values under two
// textures have a ratio that no density of its birth enters: what the weights of PR eq. 13 need.
#pragma once

#include <span>
#include <vector>

#include "paths/chains.h"

namespace burnish {

/// A vertex that scatters a path on its way. Directions are local, as those of PathRecord.
struct PathVertex {
    BsdfId bsdf;
    Vec2f uv;
    Vec3f wi_local, wo_local;  ///< towards the camera, towards the light

    friend bool operator==(const PathVertex&, const PathVertex&) = default;
};
static_assert(sizeof(PathVertex) == 36);

/// Of each of many paths some vertices; all in one array. No path has any where light is direct.
struct PathVertices {
    std::vector<PathVertex> vertices;
    std::vector<std::uint32_t> ends;  ///< of each path's, in `vertices`

    friend bool operator==(const PathVertices&, const PathVertices&) = default;
};
/// Those of path i.
inline std::span<const PathVertex> vertices_of(const PathVertices& paths, std::size_t i) {
    if (paths.ends.empty()) return {};
    const std::size_t begin = i == 0 ? 0 : paths.ends[i - 1];
    return std::span(paths.vertices).subspan(begin, paths.ends[i] - begin);
}
/// One more path.
void append(PathVertices& paths, std::span<const PathVertex> vertices);
/// The paths of another, behind those that there are.
void append(PathVertices& paths, const PathVertices& more);

/// Where a path lies within the vertices of chains: [begin, last]. It is differentiated at one.
struct ChainPlace {
    std::uint32_t begin = 0, vertex = 0, last = 0;
    Technique technique = Technique::kBsdf;  ///< of the direction at the last one: E or D
};

/// A path to one light, differentiated at one of its vertices.
struct LightPath {
    int sample = 0;     ///< index into the batch
    PathRecord record;  ///< of the vertex; its radiance is K over the probability of the choice
    ChainPlace place;
};

/// Of each vertex of each chain up to two paths: to its light sample, and to one light behind its
/// BSDF sample, chosen in proportion to the sum of the channels' magnitudes of what each brings to
/// the camera under the textures of tracing, f of the vertex itself left out. In expectation over
/// the choice they are the two samples of append_samples. Returns the number of those that were not
/// finite.
std::size_t append_light_paths(const TraceInput& input, std::span<const BatchSample> samples,
                               const ChainOutput& chains, std::vector<LightPath>& out);

/// The vertices of a path but that of its record, from the camera on: appended to `others`.
void append_others(std::span<const ChainVertex> chains, const ChainPlace& place,
                   std::vector<PathVertex>& others);

/// The product of their f under the textures of tracing, in the same order.
Rgbf scattered_by_others(std::span<const ChainVertex> chains, const ChainPlace& place);

}  // namespace burnish
