#include "gradient/monte_carlo.h"

#include "gradient/texel_ranges.h"

namespace burnish {

namespace {

TexelKey key_of(const Candidate& c) { return c.d.key; }

/// The sum over all candidates of a texel, each for its share.
std::vector<TexelGradient> sum_by_texel(const Candidates& candidates) {
    const std::vector<Candidate>& items = candidates.items;
    const auto starts = texel_ranges(items, key_of);
    std::vector<std::vector<TexelGradient>> parts(starts.size() - 1);
    for_ranges(starts, [&](std::size_t r, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end;) {
            TexelGradient sum{items[i].d.key, {}};
            for (const std::size_t next = end_of_texel(items, i, end, key_of); i < next; ++i)
                sum.g += items[i].d.g * candidates.traced.paths[items[i].path].share;
            parts[r].push_back(sum);
        }
    });
    return concatenated(parts);
}

}  // namespace

GradientResult estimate_gradient(const MonteCarlo& options, const Binding& binding,
                                 const Image& adjoint, std::uint32_t seed, std::uint32_t iteration,
                                 MonteCarloState& state) {
    const Sampling sampling{options.samples, options.adaptive_sampling, seed};
    const Image weights = normalized_adjoint(adjoint, film_normalization(binding.film()));
    const PassTaps taps = derivative_taps(binding, sampling, iteration);
    const Integrand integrand =
        make_integrand(binding, weights, taps, sampling, TargetFunction::kLuminance);
    const Candidates candidates = draw_candidates(integrand, iteration, sampling, state.pixels);

    GradientResult result;
    result.gradient = sum_by_texel(candidates);
    result.counts = {candidates.traced.paths.size(),
                     candidates.items.size(),
                     result.gradient.size(),
                     0,
                     candidates.rejected,
                     candidates.largest};
    return result;
}

}  // namespace burnish
