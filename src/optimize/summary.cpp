#include "optimize/summary.h"

#include <bit>
#include <cmath>

namespace burnish {

namespace {

constexpr std::uint32_t kMaxKept = 1 << 14;

/// One in so many iterations is kept where there were `count` before.
std::uint32_t stride_after(std::uint32_t count) {
    return count < kMaxKept ? 1 : 2 * std::bit_floor(count / kMaxKept);
}

}  // namespace

void add_iteration(const Iteration& iteration, Summary& summary) {
    RunCounts& counts = summary.counts;
    // The last of each stride: patience is checked after even numbers of iterations.
    const auto is_left_out = [stride = stride_after(counts.iterations)](const Iteration& i) {
        return (i.number + 1) % stride != 0;
    };
    if (summary.iterations.size() == kMaxKept) std::erase_if(summary.iterations, is_left_out);
    if (!is_left_out(iteration)) summary.iterations.push_back(iteration);
    ++counts.iterations;
    counts.paths += iteration.paths;
    counts.derivatives += iteration.derivatives;
    counts.rejected_image += iteration.rejected_image;
    counts.rejected_derivatives += iteration.rejected_derivatives;
}

double loss_without_noise(const ViewEvaluation& e) {
    return std::isfinite(e.noise_floor) ? e.loss - e.noise_floor : e.loss;
}
double loss_without_noise(const Evaluation& e) {
    return loss_without_noise(ViewEvaluation{.loss = e.loss, .noise_floor = e.noise_floor});
}

const char* name_of(Ending ending) {
    switch (ending) {
        case Ending::kIterations:
            return "iterations";
        case Ending::kTime:
            return "time";
        case Ending::kPatience:
            return "patience";
        case Ending::kCancelled:
            return "cancelled";
        case Ending::kSuspended:
            return "suspended";
    }
    return "";
}

}  // namespace burnish
