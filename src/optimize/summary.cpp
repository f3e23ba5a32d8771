#include "optimize/summary.h"

#include <bit>

namespace burnish {

namespace {

constexpr std::uint32_t kMostIterations = 1 << 14;

/// One in so many iterations is kept where there were `count` before.
std::uint32_t stride_after(std::uint32_t count) {
    return count < kMostIterations ? 1 : 2 * std::bit_floor(count / kMostIterations);
}

void keep_every_second(std::vector<Iteration>& iterations) {
    for (std::size_t i = 0; 2 * i < iterations.size(); ++i) iterations[i] = iterations[2 * i];
    iterations.resize((iterations.size() + 1) / 2);
}

}  // namespace

void add_iteration(const Iteration& iteration, Summary& summary) {
    RunCounts& counts = summary.counts;
    if (summary.iterations.size() == kMostIterations) keep_every_second(summary.iterations);
    if (counts.iterations % stride_after(counts.iterations) == 0)
        summary.iterations.push_back(iteration);
    ++counts.iterations;
    counts.paths += iteration.paths;
    counts.derivatives += iteration.derivatives;
    counts.rejected_image += iteration.rejected_image;
    counts.rejected_derivatives += iteration.rejected_derivatives;
}

}  // namespace burnish
