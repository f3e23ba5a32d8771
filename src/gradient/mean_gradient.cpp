#include "gradient/mean_gradient.h"

#include "burnish/error.h"
#include "core/variant.h"

namespace burnish {

namespace {

/// All estimates have the same number of passes, so that the film offsets of all form one sequence.
std::uint32_t passes_per_estimate(std::uint32_t samples) {
    for (const std::uint32_t passes : {4u, 3u, 2u})
        if (samples % passes == 0) return passes;
    return 1;
}

Estimator without_history(const Estimator& estimator, std::uint32_t passes) {
    Estimator result = estimator;
    std::visit(Overloaded{[&](MonteCarlo& o) { o.samples = passes, o.adaptive_sampling = false; },
                          [&](Reservoirs& o) {
                              o.samples = passes, o.adaptive_sampling = false, o.reuse = false;
                          },
                          [](PathCache&) {}},
               result);
    return result;
}

void add(const SplitGradient& gradient, std::vector<double>& sum) {
    for_dirty_intervals(gradient.dirty, 0, sum.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) sum[k] += double{gradient.first.values[k]};
    });
}

}  // namespace

std::vector<Image> mean_gradient(const MeanGradientOptions& options, const Binding& binding,
                                 const Image& adjoint, const EstimateReport& report) {
    if (options.samples == 0) throw InputError("samples per pixel are 0: expected at least 1");
    if (!has_own_derivatives(options.estimator))
        throw InputError("a path cache has no derivatives without its images");
    const std::uint32_t passes = passes_per_estimate(options.samples);
    const std::uint32_t count = options.samples / passes;
    const Estimator estimator = without_history(options.estimator, passes);
    std::vector<Image> mean;
    std::vector<std::vector<double>> sums;
    for (const ThetaTexture& t : binding.theta.textures) {
        mean.push_back(make_image(t.values.width, t.values.height, t.values.channels));
        sums.emplace_back(t.values.values.size(), 0.0);
    }
    EstimatorWorkspace workspace;  // no path cache: images are not asked for
    for (std::uint32_t i = 0; i < count; ++i) {
        EstimatorState state = make_state(estimator);
        const GradientEstimate estimate = estimate_gradient(estimator, binding, {&adjoint, 1},
                                                            {options.seed, i}, state, workspace);
        for (std::size_t t = 0; t < sums.size(); ++t) add(estimate.gradient[t], sums[t]);
        if (report) report(estimate.counts, i, count);
    }
    for (std::size_t t = 0; t < sums.size(); ++t)
        for (std::size_t k = 0; k < sums[t].size(); ++k)
            mean[t].values[k] = static_cast<float>(sums[t][k] / count);
    return mean;
}

}  // namespace burnish
