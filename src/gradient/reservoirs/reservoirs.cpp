#include "gradient/reservoirs/reservoirs.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "gradient/candidates.h"

namespace burnish {

namespace {

/// What the reservoirs' decisions are for; part of the counter of their random numbers.
enum class Decision : std::uint32_t { kCandidate, kMerge };

/// Uniforms of one decision: a function of (seed, texel, iteration, index).
std::array<float, 4> decide(std::uint32_t seed, TexelKey key, std::uint32_t iteration,
                            std::uint32_t index, Decision decision) {
    const auto bits = philox4x32(
        {index, iteration, key.texel, key.slot * 2 + static_cast<std::uint32_t>(decision)},
        {seed, static_cast<std::uint32_t>(Stream::kReservoir)});
    return {to_unit_float(bits[0]), to_unit_float(bits[1]), to_unit_float(bits[2]),
            to_unit_float(bits[3])};
}

/// A reservoir of this iteration: the index of its candidate, and W.
struct CurrentSample {
    TexelKey key;
    std::uint32_t candidate = 0;
    float W = 0;
};

/// One estimation stage's view of an iteration: textures, adjoint and how to trace under them.
struct Iteration {
    TextureTable textures;
    std::vector<int> slots;
    DerivativeInput derivative;
    TraceInput trace;
};

/// The fixed chunks in which grouped items are worked on: about kRange items each, never splitting
/// a key.
template <class Item, class KeyOf>
std::vector<std::size_t> range_starts(const std::vector<Item>& items, KeyOf key) {
    constexpr std::size_t kRange = 4096;
    std::vector<std::size_t> starts{0};
    while (starts.back() + kRange < items.size()) {
        std::size_t i = starts.back() + kRange;
        while (i < items.size() && key(items[i]) == key(items[i - 1])) ++i;
        starts.push_back(i);
    }
    if (starts.back() != items.size()) starts.push_back(items.size());
    return starts;
}

/// Calls body(range, begin, end) for each range of whole keys, in parallel.
template <class Body>
void for_ranges(const std::vector<std::size_t>& starts, Body&& body) {
    parallel_for(starts.size() - 1, [&](std::size_t r) { body(r, starts[r], starts[r + 1]); });
}

template <class T>
std::vector<T> concatenate(const std::vector<std::vector<T>>& parts) {
    std::vector<T> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

std::size_t end_of_key(const std::vector<Candidate>& items, std::size_t i, std::size_t end) {
    const TexelKey key = items[i].d.key;
    while (i < end && items[i].d.key == key) ++i;
    return i;
}

/// Baseline: the sum over all draws, each for its share.
std::vector<TexelGradient> sum_candidates(const std::vector<Candidate>& items,
                                          const std::vector<TracedPath>& paths) {
    const auto starts = range_starts(items, [](const Candidate& c) { return c.d.key; });
    std::vector<std::vector<TexelGradient>> parts(starts.size() - 1);
    for_ranges(starts, [&](std::size_t r, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end;) {
            TexelGradient sum{items[i].d.key, {}};
            for (const std::size_t next = end_of_key(items, i, end); i < next; ++i)
                sum.g += items[i].d.g * paths[items[i].path].share;
            parts[r].push_back(sum);
        }
    });
    return concatenate(parts);
}

/// The current reservoirs: candidates of weight |q| / m (or e_j of their pixels), q already divided
/// by its pdf [PR eq. 14, alg. 2].
std::vector<CurrentSample> fold_candidates(const std::vector<Candidate>& items,
                                           const std::vector<TracedPath>& paths,
                                           std::uint32_t iteration,
                                           const GradientOptions& options) {
    const Signs signs = signs_of(options.estimator);
    const auto starts = range_starts(items, [](const Candidate& c) { return c.d.key; });
    std::vector<std::vector<CurrentSample>> parts(starts.size() - 1);
    for_ranges(starts, [&](std::size_t r, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end;) {
            const TexelKey key = items[i].d.key;
            ReservoirPairBuilder<std::uint32_t> builder;
            const std::size_t next = end_of_key(items, i, end);
            for (std::uint32_t k = 0; i < next; ++i, ++k) {
                const float q = items[i].d.q;
                auto& slot = builder.slot[slot_of(signs, q)];
                // The first candidate is kept in any case: no random number is drawn for it.
                const float u = slot.weight_sum > 0 ? decide(options.seed, key, iteration, k,
                                                             Decision::kCandidate)[0]
                                                    : 0;
                update(slot, static_cast<std::uint32_t>(i), q,
                       std::fabs(double{q}) * double{paths[items[i].path].share}, u);
            }
            for (const auto& reservoir : finish(builder).slot)
                if (reservoir.W > 0) parts[r].push_back({key, reservoir.sample, reservoir.W});
        }
    });
    return concatenate(parts);
}

/// Evaluates g and q of samples (records at their texels) in one iteration's view.
template <class RecordAt, class KeyAt>
std::vector<TexelDerivative> evaluate(const Iteration& view, std::size_t count, RecordAt record,
                                      KeyAt key) {
    std::vector<TexelDerivative> values(count);
    parallel_chunks(count, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            values[i] = differentiate_at(view.derivative, record(i), key(i));
            if (!std::isfinite(values[i].q) || !is_finite(values[i].g)) values[i] = {key(i), 0, {}};
        }
    });
    return values;
}

/// A sample of either side, ready to be merged.
struct Shifted {
    HistorySample sample;  // under the current iteration: q is q_now, record is the shifted one
    Rgbf g;
    float q_before = 0;
};

std::vector<Shifted> shift_history(const Iteration& now, Shift shift,
                                   const std::vector<HistorySample>& history) {
    std::vector<Shifted> shifted(history.size());
    for (std::size_t i = 0; i < history.size(); ++i) shifted[i] = {history[i], {}, history[i].q};
    if (shift == Shift::kReplay) {
        std::vector<PathSample> paths(history.size());
        for (std::size_t i = 0; i < history.size(); ++i) paths[i] = history[i].path;
        const std::vector<PathRecord> records = replay_paths(now.trace, paths);
        for (std::size_t i = 0; i < history.size(); ++i) shifted[i].sample.record = records[i];
    }
    const auto values = evaluate(
        now, shifted.size(),
        [&](std::size_t i) -> const PathRecord& { return shifted[i].sample.record; },
        [&](std::size_t i) { return shifted[i].sample.key; });
    for (std::size_t i = 0; i < shifted.size(); ++i)
        shifted[i].sample.q = values[i].q, shifted[i].g = values[i].g;
    return shifted;
}

/// The current samples with what the iteration before would have made of them: q_{v-1} [PR eq. 13].
std::vector<Shifted> look_back(const Iteration* before, Shift shift,
                               const std::vector<CurrentSample>& current,
                               const std::vector<Candidate>& candidates,
                               const std::vector<TracedPath>& paths) {
    std::vector<Shifted> result(current.size());
    for (std::size_t i = 0; i < current.size(); ++i) {
        const Candidate& c = candidates[current[i].candidate];
        const TracedPath& path = paths[c.path];
        result[i] = {{c.d.key, c.d.q, current[i].W, path.path, path.record}, c.d.g, 0};
    }
    if (!before) return result;
    std::vector<PathRecord> records;
    if (shift == Shift::kReplay) {
        std::vector<PathSample> samples(current.size());
        for (std::size_t i = 0; i < current.size(); ++i) samples[i] = result[i].sample.path;
        records = replay_paths(before->trace, samples);
    }
    const auto values = evaluate(
        *before, result.size(),
        [&](std::size_t i) -> const PathRecord& {
            return shift == Shift::kReplay ? records[i] : result[i].sample.record;
        },
        [&](std::size_t i) { return result[i].sample.key; });
    for (std::size_t i = 0; i < result.size(); ++i) result[i].q_before = values[i].q;
    return result;
}

struct Merged {
    std::vector<TexelGradient> gradient;
    std::vector<HistorySample> samples;
};

using Index = std::uint32_t;
MergeInput<Index> merge_input(const Shifted& s, Index index) {
    return {index, s.sample.q, s.q_before, s.sample.W, 1.0f};
}

ReservoirPair<Index> merge_with(MergeRule rule, std::span<const MergeInput<Index>> current,
                                std::span<const MergeInput<Index>> history,
                                const Confidence& confidence, Signs signs,
                                std::span<const float> u) {
    switch (rule) {
        case MergeRule::kBalance:
            return merge(current, history, confidence, signs, BalanceWeights{}, u);
        case MergeRule::kDefensive:
            return merge(current, history, confidence, signs, DefensiveWeights{}, u);
    }
    return {};
}

/// Merges the samples of one texel and appends its gradient and its reservoirs.
void merge_texel(std::span<const Shifted> current, std::span<const Shifted> history,
                 const Confidence& confidence, std::uint32_t iteration,
                 const GradientOptions& options, Merged& out) {
    const TexelKey key = current.empty() ? history.front().sample.key : current.front().sample.key;
    std::array<MergeInput<Index>, 4> inputs;
    Index n = 0;
    const auto sample_at = [&](Index i) -> const Shifted& {
        return i < current.size() ? current[i] : history[i - current.size()];
    };
    for (; n < current.size() + history.size(); ++n) inputs[n] = merge_input(sample_at(n), n);
    const auto u = decide(options.seed, key, iteration, 0, Decision::kMerge);
    const std::span<const MergeInput<Index>> all(inputs.data(), n);
    const auto pair =
        merge_with(options.merge, all.first(current.size()), all.subspan(current.size()),
                   confidence, signs_of(options.estimator), u);
    for (const auto& reservoir : pair.slot) {
        if (!(reservoir.W > 0)) continue;
        out.samples.push_back(sample_at(reservoir.sample).sample);
        out.samples.back().W = reservoir.W;
    }
    const Rgbf g = estimate(
        pair, [&](Index i) { return sample_at(i).g; }, Rgbf{});
    if (!is_black(g)) out.gradient.push_back({key, g});
}

/// Joins both sides, each sorted by key.
Merged merge_all(const std::vector<Shifted>& current, const std::vector<Shifted>& history,
                 const Confidence& confidence, std::uint32_t iteration,
                 const GradientOptions& options) {
    const auto key_of = [](const Shifted& s) { return s.sample.key; };
    const bool by_history = history.size() > current.size();  // the longer side sets the ranges
    const auto& leading = by_history ? history : current;
    const auto& other = by_history ? current : history;
    const auto starts = range_starts(leading, key_of);
    const auto other_start = [&](std::size_t r) {
        if (r == 0) return std::size_t{0};
        if (r + 1 >= starts.size()) return other.size();
        return static_cast<std::size_t>(
            std::lower_bound(other.begin(), other.end(), key_of(leading[starts[r]]),
                             [&](const Shifted& s, TexelKey k) { return key_of(s) < k; }) -
            other.begin());
    };
    std::vector<Merged> parts(starts.size() - 1);
    for_ranges(starts, [&](std::size_t r, std::size_t begin, std::size_t end) {
        const std::span<const Shifted> a(leading.data() + begin, end - begin);
        const std::span<const Shifted> b(other.data() + other_start(r),
                                         other_start(r + 1) - other_start(r));
        std::span<const Shifted> c = by_history ? b : a, h = by_history ? a : b;
        while (!c.empty() || !h.empty()) {
            const TexelKey key = c.empty()   ? key_of(h.front())
                                 : h.empty() ? key_of(c.front())
                                             : std::min(key_of(c.front()), key_of(h.front()));
            const auto run = [&](std::span<const Shifted> s) {
                std::size_t n = 0;
                while (n < s.size() && key_of(s[n]) == key) ++n;
                return n;
            };
            const std::size_t nc = run(c), nh = run(h);
            merge_texel(c.first(nc), h.first(nh), confidence, iteration, options, parts[r]);
            c = c.subspan(nc), h = h.subspan(nh);
        }
    });
    Merged all;
    for (const Merged& part : parts) {
        all.gradient.insert(all.gradient.end(), part.gradient.begin(), part.gradient.end());
        all.samples.insert(all.samples.end(), part.samples.begin(), part.samples.end());
    }
    return all;
}

/// The film passes that an iteration's samples may take.
std::uint32_t passes_per_iteration(const GradientOptions& options) {
    return options.pixels == PixelChoice::kAdaptive ? kMaxOfMean * options.samples_per_pixel
                                                    : options.samples_per_pixel;
}

/// Points into `view`, `scene`, `theta` and `adjoint`: all must outlive it, and it must not move.
void set_up(Iteration& view, const TracedScene& scene, const Theta& theta, const Image& adjoint,
            const PassTaps& taps, const GradientOptions& options, std::span<const char> unknowns) {
    view.textures = texture_table(*scene.scene, theta);
    view.slots = theta_slots(*scene.scene, theta);
    view.derivative = {scene.scene, &view.textures, view.slots, &adjoint, &taps, options.target};
    view.trace = {&scene,
                  &view.textures,
                  {options.seed, Stream::kDerivative},
                  passes_per_iteration(options),
                  SurfaceChoice::kUnknown,
                  unknowns,
                  true};
}

/// The filter taps of all passes whose samples are still alive.
PassTaps taps_in_use(const ReconstructionFilter& filter, std::uint32_t iteration,
                     const GradientOptions& options, const History& history) {
    const std::uint32_t end = (iteration + 1) * passes_per_iteration(options);
    std::uint32_t first = end - passes_per_iteration(options);
    for (const HistorySample& s : history.samples) first = std::min(first, s.record.film_pass);
    return pass_taps(filter, {options.seed, Stream::kDerivative}, first, end - first);
}

/// An iteration's own samples.
struct FreshPaths {
    std::vector<BatchSample> samples;  ///< of an adaptive choice
    std::vector<TracedPath> paths;
    std::size_t rejected = 0;
};

FreshPaths draw_paths(const Iteration& now, std::uint32_t iteration, const GradientOptions& options,
                      const PixelStatistics& sizes) {
    FreshPaths fresh;
    const auto m = static_cast<float>(options.samples_per_pixel);
    if (options.pixels == PixelChoice::kUniform) {
        fresh.paths = trace_paths(now.trace, iteration, options.samples_per_pixel, fresh.rejected);
        for (TracedPath& p : fresh.paths) p.share = 1 / m;
        return fresh;
    }
    const Film& film = now.trace.scene->scene->film;
    const std::vector<float> expected =
        expected_samples(film, *now.derivative.normalized_adjoint, m, sizes);
    fresh.samples =
        choose_samples(film, expected, options.seed, iteration, passes_per_iteration(options));
    fresh.paths = trace_paths(now.trace, fresh.samples, fresh.rejected);
    for (TracedPath& p : fresh.paths) p.share = 1 / expected[p.record.pixel];
    return fresh;
}

}  // namespace

GradientResult estimate_gradient(const TracedScene& scene, const Theta& theta, const Image& adjoint,
                                 std::uint32_t iteration, const GradientOptions& options,
                                 History history) {
    if (options.estimator == Estimator::kPool)
        throw InputError(
            "the estimator pool belongs to a descent: expected one that takes an adjoint "
            "(mc, ris, pris, gris, pgris)");
    const std::vector<char> unknowns = unknown_bsdfs(*scene.scene, theta);
    GradientResult result;
    Image weights = normalized_adjoint(adjoint, film_normalization(scene.scene->film));
    const PassTaps taps = taps_in_use(scene.scene->film.filter, iteration, options, history);
    Iteration now;
    set_up(now, scene, theta, weights, taps, options, unknowns);

    PixelStatistics sizes = std::move(history.pixels);
    const bool adaptive = options.pixels == PixelChoice::kAdaptive;
    if (adaptive && sizes.seen.empty()) sizes = make_pixel_statistics(*scene.scene, theta);
    const auto [samples, paths, rejected] = draw_paths(now, iteration, options, sizes);
    Candidates candidates = make_candidates(now.derivative, paths);
    if (adaptive) update_statistics(samples, candidates.squares, sizes);
    result.history.pixels = std::move(sizes);
    result.counts.records = paths.size();
    result.counts.candidates = candidates.items.size();
    result.counts.rejected = rejected + candidates.rejected;
    result.counts.outliers = std::move(candidates.outliers);

    if (options.estimator == Estimator::kMc) {
        result.gradient = sum_candidates(candidates.items, paths);
        result.counts.texels = result.gradient.size();
        return result;
    }
    const auto current = fold_candidates(candidates.items, paths, iteration, options);
    const bool reuses = has_history(options.estimator) && history.confidence > 0;
    Iteration before;
    if (reuses)
        set_up(before, scene, history.theta, history.normalized_adjoint, taps, options, unknowns);
    const auto shifted_current =
        look_back(reuses ? &before : nullptr, options.shift, current, candidates.items, paths);
    const auto shifted_history =
        reuses ? shift_history(now, options.shift, history.samples) : std::vector<Shifted>{};

    // m whatever the pixel got: weights that knew of e_j would depend on the history's own samples,
    // from which e_j was learnt. Where e_j settles, both sides have the same share of their
    // confidence, and the weights are right.
    const Confidence confidence{
        static_cast<float>(options.samples_per_pixel),
        reuses ? std::min(history.confidence, options.confidence_cap) : 0.0f};
    Merged merged = merge_all(shifted_current, shifted_history, confidence, iteration, options);
    result.gradient = std::move(merged.gradient);
    result.counts.texels = result.gradient.size();
    result.counts.reservoirs = merged.samples.size();
    if (has_history(options.estimator))
        result.history = {std::move(merged.samples), confidence.current + confidence.history, theta,
                          std::move(weights), std::move(result.history.pixels)};
    return result;
}

std::vector<Image> dense_gradient(const Theta& theta, const std::vector<TexelGradient>& gradient) {
    std::vector<Image> images;
    for (const ThetaTexture& t : theta.textures)
        images.push_back(make_image(t.values.width, t.values.height, t.values.channels));
    for (const TexelGradient& g : gradient) {
        Image& image = images[g.key.slot];
        for (int c = 0; c < image.channels; ++c)
            image.values[std::size_t{g.key.texel} * static_cast<std::size_t>(image.channels) +
                         static_cast<std::size_t>(c)] = g.g[c];
    }
    return images;
}

void accumulate(const std::vector<TexelGradient>& gradient, int channels,
                std::vector<double>& sum) {
    for (const TexelGradient& g : gradient)
        for (int c = 0; c < channels; ++c)
            sum[g.key.texel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] +=
                double{g.g[c]};
}

const char* name_of(Estimator e) {
    switch (e) {
        case Estimator::kMc:
            return "mc";
        case Estimator::kRis:
            return "ris";
        case Estimator::kPris:
            return "pris";
        case Estimator::kGris:
            return "gris";
        case Estimator::kPgris:
            return "pgris";
        case Estimator::kPool:
            return "pool";
    }
    return "";
}

const char* name_of(Shift s) { return s == Shift::kReplay ? "replay" : "identity"; }

}  // namespace burnish
