// What a run will take of the machine's memory, estimated before it begins: from the sizes of the
// scene, the textures and the image, never from what the system says, so that a limit gives the
// same window for the same options, and the same bytes for any number of threads.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "burnish/options.h"
#include "gradient/binding.h"
#include "gradient/estimator.h"
#include "gradient/path_cache/path_cache.h"

namespace burnish {

/// Bytes of the process, were it alone: of several each takes its part of the records and of the
/// optimiser's state, which the limit on the records may not depend on.
struct MemoryEstimate {
    double scene = 0;        ///< the program, geometry, ray structures, textures, sky
    double textures = 0;     ///< the unknowns, with the optimiser's state and gradients
    double images = 0;       ///< all of the film's size, and the results of a run before
    double samples = 0;      ///< fresh samples of an iteration, of path caches too, and reservoirs
    double records = 0;      ///< of kept path caches, as many as a trial of their pixels promises
    double max_records = 0;  ///< of a path cache, if both samples of every camera sample carried
                             ///< light
    double pictures = 0;  ///< beside the scene while files of pictures are read: they, and a state
                          ///< that the run goes on from
};

/// All but the records.
inline double without_records(const MemoryEstimate& m) {
    return m.scene + m.textures + m.images + m.samples;
}
inline double expected(const MemoryEstimate& m) {
    return std::max(without_records(m) + m.records, m.scene + m.pictures);
}
/// Nothing that samples decide is left open; the other parts are estimates.
inline double maximum(const MemoryEstimate& m) {
    return std::max(without_records(m) + m.max_records, m.scene + m.pictures);
}

/// The pixels of each view that light from an unknown can reach.
std::vector<std::vector<char>> reaching_pixels(std::span<const TracedScene> views,
                                               const Theta& theta);

/// Of the path cache of each view, without a limit of memory; empty where the estimator keeps none.
/// reaching: reaching_pixels of each view.
std::vector<PathCachePlan> plan_caches(const Estimator& estimator,
                                       std::span<const TracedScene> views,
                                       std::span<const std::vector<char>> reaching,
                                       const Theta& theta);

/// The views that a run fits, and those that are held out to judge it.
struct RunViews {
    std::span<const TracedScene> fitted, held_out;
    /// reaching_pixels of those that are fitted: all of them where memory is estimated.
    std::span<const std::vector<char>> reaching = {};
    double results = 0;  ///< bytes of the results of a run before, which stay
};

/// plans: of plan_caches. seed: of the trial of a path cache. batch: views that an iteration
/// visits.
MemoryEstimate estimate_memory(const Estimator& estimator, const RunViews& views,
                               std::span<const PathCachePlan> plans, const Theta& theta,
                               std::uint32_t seed, std::size_t batch = 1);

/// The estimator of each view, with its share of PathCache::max_bytes. Where not every view can
/// keep one pass in each half, none keeps records from visit to visit, and the view that is visited
/// has all of the memory.
struct ViewShare {
    Estimator estimator;
    bool keeps_records = true;
};
ViewShare share_memory(const Estimator& estimator, std::span<const PathCachePlan> plans);
/// The same, with plans only where there is a limit to share. reaching: reaching_pixels of each
/// view.
ViewShare share_memory(const Estimator& estimator, std::span<const TracedScene> views,
                       std::span<const std::vector<char>> reaching, const Theta& theta);

/// The most that a pass of a view's path cache takes, 0 without plans.
std::size_t max_bytes_per_pass(std::span<const PathCachePlan> plans);

/// The most that the passes take which an iteration traces into path caches, beside those that they
/// replace: these are kept until the iteration is done. As estimate_memory.
double fresh_bytes(const PathCache& cache, std::span<const PathCachePlan> plans, std::size_t batch);

/// The bytes that a scene takes once it is ready to be rendered.
double scene_memory(const Scene& scene);

/// The share of the samples, two of each camera sample, that a path cache keeps as records: of a
/// trial of some of the pixels that see an unknown, whose random numbers serve nothing else. 0
/// where no pixel does. reaching: reaching_pixels.
double record_share(const Binding& binding, const std::vector<char>& reaching, std::uint32_t seed);

}  // namespace burnish
