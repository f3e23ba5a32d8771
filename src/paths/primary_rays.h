// The rays of a batch from the camera, and what they see of the lights.
#pragma once

#include "paths/seen.h"

namespace burnish {

/// Where the primary rays of a batch begin.
struct FilmLanes {
    std::array<std::uint32_t, kBatchSamples> film_pass;
    Column x, y;  ///< as fractions of the whole film
};

/// Traces the primary rays of a batch. emitted[i] is set to what sample i sees of the lights
/// directly; black where constant surfaces are not asked for.
void trace_primary_rays(const TraceInput& input, std::span<const BatchSample> samples,
                        FilmLanes& film, RayLanes& primary, std::span<Rgbf> emitted);

/// The same rays where it is known what they hit: of samples whose light arrived before.
void repeat_primary_rays(const TraceInput& input, std::span<const BatchSample> samples,
                         std::span<const Hit> hits, FilmLanes& film, RayLanes& primary);

/// Of each sample of a batch, in the first channel, 1 where it meets a surface, else 0; in the
/// second 1. Without Scene::direct_alpha the first is 1 where it sees an environment, too, and what
/// masks and panes let through straight on counts as what is behind them, as far as paths go.
/// Where Scene::max_depth is 0, so is the first.
void trace_coverage(const TraceInput& input, std::span<const BatchSample> samples,
                    std::span<Rgbf> seen);

}  // namespace burnish
