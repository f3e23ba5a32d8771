// What a descent will take of the machine's memory, counted before it begins: from the sizes of the
// scene, the textures and the image, never from what the system says, so that a limit gives the
// same window for the same options, and the same bytes for any number of threads.
#pragma once

#include "optimize/solve.h"

namespace burnish {

/// Bytes of the whole process.
struct MemoryPlan {
    double scene = 0;     ///< the program, geometry, ray structures, textures, sky
    double textures = 0;  ///< what is optimised, with the optimiser's state and gradients
    double images = 0;    ///< all of the film's size
    double samples = 0;   ///< of estimators that are no pools: those of an iteration, reservoirs
    double records = 0;   ///< of a pool, as many as a trial of its pixels promises
    double max_records = 0;  ///< of a pool, if both draws of every sample carried light
};

/// All but the records.
inline double without_records(const MemoryPlan& p) {
    return p.scene + p.textures + p.images + p.samples;
}
inline double expected(const MemoryPlan& p) { return without_records(p) + p.records; }
/// Nothing that samples decide is left open; the other parts are estimates.
inline double most(const MemoryPlan& p) { return without_records(p) + p.max_records; }

/// For options.gradient.estimator and what `theta` optimises. A pool's window is cut, as
/// iterate_pool does, to options.pool.memory.
MemoryPlan plan_memory(const TracedScene& scene, const Theta& theta, const SolveOptions& options);

/// The share of the draws, two of each camera sample, that a pool keeps as records: of a trial of
/// some of the pixels that see an optimised texture, whose random numbers serve nothing else. 0
/// where no pixel does.
double record_share(const TracedScene& scene, const Theta& theta, std::uint32_t seed);

}  // namespace burnish
