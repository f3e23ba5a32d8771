#include "gradient/reservoirs/reservoirs.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "gradient/reservoirs/merge.h"
#include "gradient/reservoirs/shift.h"
#include "gradient/texel_ranges.h"

namespace burnish {

namespace {

/// What the stages of one estimate share.
struct Iteration {
    const Reservoirs& options;
    std::uint32_t seed = 0, number = 0;
    Confidence confidence;
    Shift shift = Shift::kReplay;
    bool keeps_vertices = false;  ///< see below

    Signs signs() const { return options.positivization ? Signs::kPositivized : Signs::kAbsolute; }
};

/// What the reservoirs' decisions are for; part of the counter of their random numbers.
enum class Decision : std::uint32_t { kCandidate, kMerge };

/// Uniforms of one decision: a function of (seed, texel, iteration, index).
std::array<float, 4> decide(const Iteration& iteration, TexelKey key, std::uint32_t index,
                            Decision decision) {
    return uniforms({iteration.seed, Stream::kReservoir}, index, iteration.number, key.texel,
                    key.slot * 2 + static_cast<std::uint32_t>(decision));
}

TexelKey key_of(const ShiftedSample& s) { return s.sample.key; }

/// The candidates [i, end) of one texel in reservoirs: of weight |q| / m (or e_j of their pixels),
/// q already divided by its pdf [PR eq. 14, alg. 2].
ReservoirPair<std::uint32_t> fold_texel(const Candidates& candidates, std::size_t i,
                                        std::size_t end, const Iteration& iteration) {
    ReservoirPairBuilder<std::uint32_t> builder;
    const TexelKey key = candidates.items[i].d.key;
    for (std::uint32_t k = 0; i < end; ++i, ++k) {
        const Candidate& c = candidates.items[i];
        auto& slot = builder.slot[slot_of(iteration.signs(), c.d.q)];
        // The first candidate is kept in any case: no random number is needed for it.
        double u = 0;
        if (slot.weight_sum > 0) {
            const auto drawn = decide(iteration, key, k, Decision::kCandidate);
            u = fine_uniform(drawn[0], drawn[1]);
        }
        update(slot, static_cast<std::uint32_t>(i), c.d.q,
               std::fabs(double{c.d.q}) * double{candidates.traced.paths[c.path].share}, u);
    }
    return finish(builder);
}

/// The current reservoirs of all texels.
std::vector<CurrentSample> fold_candidates(const Candidates& candidates,
                                           const Iteration& iteration) {
    const auto& items = candidates.items;
    return by_texel<CurrentSample>(items, [&](std::size_t i, std::size_t end, auto& samples) {
        for (const auto& reservoir : fold_texel(candidates, i, end, iteration).slot)
            if (reservoir.W > 0) samples.push_back({items[i].d.key, reservoir.sample, reservoir.W});
    });
}

using Index = std::uint32_t;
using Samples = std::span<const ShiftedSample>;

ReservoirPair<Index> merge_inputs(std::span<const MergeInput<Index>> current,
                                  std::span<const MergeInput<Index>> history,
                                  const Iteration& iteration, std::span<const float> u) {
    const auto by = [&](const auto& weights) {
        return merge(current, history, iteration.confidence, iteration.signs(), weights, u);
    };
    switch (iteration.options.merge) {
        case MergeRule::kBalance:
            return by(BalanceWeights{});
        case MergeRule::kDefensive:
            return by(DefensiveWeights{});
    }
    return {};
}

struct Merged {
    std::vector<TexelGradient> gradient;
    std::vector<HistorySample> samples;
    PathVertices others;
    std::size_t rejected = 0;  ///< samples that were not finite, or whose W was not
};

/// Merges the samples of one texel and appends its gradient and its reservoirs [PR alg. 3].
void merge_texel(Samples current, Samples history, const Iteration& iteration, Merged& out) {
    const TexelKey key = key_of(current.empty() ? history.front() : current.front());
    const auto sample_at = [&](Index i) -> const ShiftedSample& {
        return i < current.size() ? current[i] : history[i - current.size()];
    };
    std::array<MergeInput<Index>, 4> inputs;
    Index count = 0;
    for (; count < current.size() + history.size(); ++count) {
        const ShiftedSample& s = sample_at(count);
        inputs[count] = {count, s.sample.q, s.q_before, s.sample.W};
        out.rejected += !std::isfinite(s.sample.W);  // such a sample is never kept
    }
    const std::span<const MergeInput<Index>> all(inputs.data(), count);
    auto pair = merge_inputs(all.first(current.size()), all.subspan(current.size()), iteration,
                             decide(iteration, key, 0, Decision::kMerge));
    for (auto& reservoir : pair.slot) {
        if (!std::isfinite(reservoir.W)) reservoir = {}, ++out.rejected;
        if (!(reservoir.W > 0)) continue;
        const ShiftedSample& kept = sample_at(reservoir.sample);
        out.samples.push_back(kept.sample);
        out.samples.back().W = reservoir.W;
        if (iteration.keeps_vertices) append(out.others, kept.others);
    }
    const Rgbf g = estimate(
        pair, [&](Index i) { return sample_at(i).g; }, Rgbf{});
    if (!is_black(g)) out.gradient.push_back({key, g});
}

/// The samples at the front that have a key.
Samples front_of(Samples samples, TexelKey key) {
    std::size_t n = 0;
    while (n < samples.size() && key_of(samples[n]) == key) ++n;
    return samples.first(n);
}

/// Merges two runs of samples, each sorted by key.
void merge_range(Samples current, Samples history, const Iteration& iteration, Merged& out) {
    out.samples.reserve(current.size() + history.size());
    while (!current.empty() || !history.empty()) {
        const TexelKey key = current.empty() ? key_of(history.front())
                             : history.empty()
                                 ? key_of(current.front())
                                 : std::min(key_of(current.front()), key_of(history.front()));
        const Samples c = front_of(current, key), h = front_of(history, key);
        merge_texel(c, h, iteration, out);
        current = current.subspan(c.size()), history = history.subspan(h.size());
    }
}

Merged join(const std::vector<Merged>& parts) {
    Merged all;
    concatenate(parts, &Merged::gradient, all.gradient);
    concatenate(parts, &Merged::samples, all.samples);
    for (const Merged& part : parts) {
        append(all.others, part.others);
        all.rejected += part.rejected;
    }
    return all;
}

/// Those of this iteration's passes, and of the passes that samples alive in it were traced in: few
/// of all since the oldest, where some texels are seldom seen.
PassTaps taps_alive(const Binding& binding, const Sampling& sampling, const History& history,
                    std::uint32_t iteration) {
    const std::uint32_t first = first_pass(sampling, iteration);
    PassTaps all = derivative_taps(binding, sampling, iteration);
    std::uint32_t oldest = first;
    for (const HistorySample& s : history.samples) oldest = std::min(oldest, s.record.film_pass);
    std::vector<char> is_alive(first - oldest, 0);
    for (const HistorySample& s : history.samples)
        if (s.record.film_pass < first) is_alive[s.record.film_pass - oldest] = 1;
    for (std::uint32_t pass = oldest; pass < first; ++pass) {
        if (!is_alive[pass - oldest]) continue;
        all.earlier.push_back(pass);
        all.earlier_taps.push_back(
            pass_taps(binding.film().filter, {sampling.seed, Stream::kDerivative}, pass, 1)
                .taps.front());
    }
    return all;
}

/// Merges the current reservoirs with the history, under the integrands of this iteration and of
/// the one before (null: the first). What is shifted lives for a range of texels alone.
Merged merge_all(const Integrand& now, const Integrand* before, const Candidates& candidates,
                 const std::vector<CurrentSample>& current, const Iteration& iteration,
                 const History& history) {
    const auto ranges = common_ranges(current, history.samples);
    std::vector<Merged> parts(ranges.size());
    parallel_for(ranges.size(), [&](std::size_t r) {
        const auto& [of_current, of_history] = ranges[r];
        const auto own = std::span(current).subspan(of_current.begin, of_current.size());
        const PathVertices others = others_of(own, candidates);
        Merged& part = parts[r];
        const auto fresh =
            shift_current(before, iteration.shift, own, others, candidates, part.rejected);
        const auto kept = shift_history(now, iteration.shift, history, of_history, part.rejected);
        merge_range(fresh, kept, iteration, part);
    });
    return join(parts);
}

/// The same, with the integrand that the history keeps.
Merged reuse(const Integrand& now, const PassTaps& taps, const Sampling& sampling,
             const Candidates& candidates, const std::vector<CurrentSample>& current,
             const Iteration& iteration, const History& history) {
    if (!(iteration.confidence.history > 0))
        return merge_all(now, nullptr, candidates, current, iteration, {});
    const Binding before(now.derivative.binding->traced, history.theta);
    const Integrand integrand_before = make_integrand(before, history.normalized_adjoint, taps,
                                                      sampling, iteration.options.target_function);
    return merge_all(now, &integrand_before, candidates, current, iteration, history);
}

/// A replayed path of direct light is the path itself where no unknown draws paths: the same shift
/// without a ray. Colours that would choose another candidate of a light sample do not count: there
/// it is the identity shift, which is unbiased, too.
Shift shift_of(const Reservoirs& options, const Binding& binding) {
    const Scene& scene = binding.scene();
    if (has_bounces(scene)) return options.shift;
    for (const ThetaTexture& t : binding.theta.textures)
        if (draws_paths(scene, t.texture)) return options.shift;
    return Shift::kIdentity;
}

}  // namespace

bool keeps_vertices(const Reservoirs& options, const Scene& scene) {
    return options.reuse && options.shift == Shift::kIdentity && has_bounces(scene);
}

GradientResult estimate_gradient(const Reservoirs& options, const Binding& binding,
                                 const Image& adjoint, std::uint32_t seed, std::uint32_t number,
                                 ReservoirsState& state, std::optional<History>* replaced) {
    const Sampling sampling{options.samples, options.adaptive_sampling, seed,
                            keeps_vertices(options, binding.scene())};
    History& history = state.history;
    Image weights = normalized_adjoint(adjoint, film_normalization(binding.film()));
    const PassTaps taps = taps_alive(binding, sampling, history, number);
    const Integrand now = make_integrand(binding, weights, taps, sampling, options.target_function);

    const Candidates candidates = draw_candidates(now, number, sampling, state.pixels);
    // c_current is m, whatever the pixel got: weights that knew of e_j would depend on the
    // history's own samples, from which e_j was learnt. Where e_j settles, both sides have the same
    // share of their confidence, and the weights are right.
    const Iteration iteration{
        options,
        seed,
        number,
        {static_cast<float>(options.samples),
         options.reuse ? std::min(history.confidence, options.confidence_cap) : 0.0f},
        shift_of(options, binding),
        sampling.keep_vertices};
    const auto current = fold_candidates(candidates, iteration);
    Merged merged = reuse(now, taps, sampling, candidates, current, iteration, history);

    GradientResult result;
    result.counts = {candidates.traced.paths.size(),
                     candidates.items.size(),
                     merged.gradient.size(),
                     options.reuse ? merged.samples.size() : 0,
                     candidates.rejected + merged.rejected,
                     candidates.largest};
    result.gradient = std::move(merged.gradient);
    if (options.reuse) {
        History next{std::move(merged.samples),
                     iteration.confidence.current + iteration.confidence.history, binding.theta,
                     std::move(weights), std::move(merged.others)};
        std::swap(history, next);
        if (replaced && !*replaced) *replaced = std::move(next);
    }
    return result;
}

}  // namespace burnish
