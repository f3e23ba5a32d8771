// One iteration of a descent on a pool: trace a little, shade everything that is kept.
#pragma once

#include "optimize/solve.h"

namespace burnish {

/// What a pool will take, known before anything is traced.
struct PoolPlan {
    std::size_t pixels = 0;          ///< that can see an optimised texture
    std::size_t bytes_per_pass = 0;  ///< at most: if both draws of every sample carried light
    std::uint32_t window = 1;        ///< K: passes that each bank keeps
};

/// K is PoolOptions::window, or less where both banks would take more than PoolOptions::memory.
/// Throws InputError where one pass in each bank does.
PoolPlan plan_pool(const Scene& scene, const Theta& theta, const PoolOptions& options);

/// iterate() for Estimator::kPool. Reads and writes state.pool and the static image, steps the
/// textures, fills the report but for state.iteration, which the caller advances.
void iterate_pool(const Problem& problem, const SolveOptions& options, SolveState& state,
                  IterationReport& report);

}  // namespace burnish
