#include "gradient/monte_carlo.h"

#include "gradient/texel_ranges.h"

namespace burnish {

namespace {

/// The sum over all candidates of a texel, each for its share: of a texel that fills the picture,
/// millions.
std::vector<TexelGradient> sum_by_texel(const Candidates& candidates) {
    const std::vector<Candidate>& items = candidates.items;
    return by_texel<TexelGradient>(items, [&](std::size_t i, std::size_t end, auto& sums) {
        const TexelKey key = items[i].d.key;
        Rgb<double> sum;
        for (; i < end; ++i)
            sum += to_double(items[i].d.g) * double{candidates.traced.paths[items[i].path].share};
        sums.push_back({key, to_float(sum)});
    });
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
