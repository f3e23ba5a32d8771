// The fields of every struct in a state, once for writing and reading: see core/archive.h. To add a
// field to a state: here, too, and a new kStateVersion. Those of what a view or a pyramid holds
// (ViewState, PathCacheState, Background, PyramidState, LevelState, AdamState) also stand in
// whole_state.cpp, which writes them from the parts of several processes.
#pragma once

#include "core/archive.h"
#include "optimize/state.h"

namespace burnish {

inline constexpr std::uint32_t kStateVersion = 11;

template <>
inline constexpr bool kPlainBytes<RecordBlock> = true;
template <>
inline constexpr bool kPlainBytes<VertexBlock> = true;
template <>
inline constexpr bool kPlainBytes<ChainLink> = true;
template <>
inline constexpr bool kPlainBytes<PathVertex> = true;

void fields(auto& archive, Is<Image> auto& v) { archive(v.width, v.height, v.channels, v.values); }
void fields(auto& archive, Is<TextureId> auto& v) { archive(v.value); }
void fields(auto& archive, Is<BsdfId> auto& v) { archive(v.value); }
void fields(auto& archive, Is<Vec2f> auto& v) { archive(v.x, v.y); }
void fields(auto& archive, Is<Vec3f> auto& v) { archive(v.x, v.y, v.z); }
void fields(auto& archive, Is<ThetaTexture> auto& v) { archive(v.texture, v.values); }
/// A run replaces no textures but its unknowns.
void fields(auto& archive, Is<Theta> auto& v) { archive(v.textures); }
void fields(auto& archive, Is<TexelKey> auto& v) { archive(v.slot, v.texel); }
void fields(auto& archive, Is<CameraSample> auto& v) { archive(v.pixel, v.iteration, v.pass); }
void fields(auto& archive, Is<Hit> auto& v) { archive(v.shape, v.primitive, v.distance, v.u, v.v); }
void fields(auto& archive, Is<PathSample> auto& v) { archive(v.camera, v.technique, v.vertex); }
void fields(auto& archive, Is<PathRecord> auto& v) {
    archive(v.pixel, v.technique, v.bsdf, v.film_pass, v.uv, v.wi_local, v.wo_local,
            v.radiance_over_pdf);
}
void fields(auto& archive, Is<HistorySample> auto& v) {
    archive(v.key, v.q, v.W, v.path, v.record, v.hit);
}
void fields(auto& archive, Is<PathVertices> auto& v) { archive(v.vertices, v.ends); }
void fields(auto& archive, Is<History> auto& v) {
    archive(v.samples, v.confidence, v.theta, v.normalized_adjoint, v.others);
}
void fields(auto& archive, Is<PixelStatistics> auto& v) { archive(v.seen, v.squares, v.counts); }
void fields(auto& archive, Is<RecordRun> auto& v) { archive(v.bsdf, v.begin, v.end); }
void fields(auto& archive, Is<TileRecords> auto& v) {
    archive(v.blocks, v.vertices, v.chains, v.runs, v.count);
}
void fields(auto& archive, Is<CachedPass> auto& v) { archive(v.film_pass, v.tiles); }
void fields(auto& archive, Is<CacheHalf> auto& v) { archive(v.passes, v.passes_traced); }
void fields(auto& archive, Is<PathCacheState> auto& v) { archive(v.halves[0], v.halves[1]); }
void fields(auto& archive, Is<ReservoirsState> auto& v) { archive(v.history, v.pixels, v.image); }
void fields(auto& archive, Is<MonteCarloState> auto& v) { archive(v.pixels, v.image); }
void fields(auto& archive, Is<BlockRoots> auto& v) { archive(v.sum, v.count); }
void fields(auto& archive, Is<AdamState> auto& v) {
    archive(v.mean, v.square, v.noise, v.initial, v.roots, v.mean_root, v.steps, v.visited);
}
void fields(auto& archive, Is<LevelState> auto& v) { archive(v.values, v.adam); }
void fields(auto& archive, Is<PyramidState> auto& v) { archive(v.levels, v.visits); }
void fields(auto& archive, Is<Background> auto& v) { archive(v.mean, v.counts, v.passes); }
void fields(auto& archive, Is<PatienceState> auto& v) { archive(v.min_loss, v.failed); }
void fields(auto& archive, Is<ViewState> auto& v) {
    archive(v.visits, v.estimator, v.backgrounds, v.exposure);
}
void fields(auto& archive, Is<SearchedCosts> auto& v) { archive(v.squares, v.costs); }
void fields(auto& archive, Is<SearchedAgain> auto& v) { archive(v.iteration, v.texels); }
/// pyramids(), views(): write or read those of v.
template <class Pyramids, class Views>
void state_fields(auto& archive, Is<State::Values> auto& v, const Pyramids& pyramids,
                  const Views& views) {
    archive(v.iteration, v.theta);
    pyramids();
    views();
    archive(v.patience, v.searched, v.search_effort, v.search_costs, v.searched_again);
}
void fields(auto& archive, Is<State::Values> auto& v) {
    const auto pyramids = [&] { archive(v.pyramids); };
    const auto views = [&] { archive(v.views); };
    state_fields(archive, v, pyramids, views);
}

}  // namespace burnish
