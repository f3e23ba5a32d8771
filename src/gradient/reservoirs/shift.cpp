#include "gradient/reservoirs/shift.h"

#include <atomic>
#include <cmath>

#include "core/parallel.h"

namespace burnish {

namespace {

/// Evaluates g and q of samples (records at their texels) under an integrand. Those that are not
/// finite become 0, and rejected grows by them.
template <class RecordAt, class KeyAt>
std::vector<TexelDerivative> evaluate(const Integrand& integrand, std::size_t count,
                                      RecordAt record, const PathVertices& others, KeyAt key,
                                      std::size_t& rejected) {
    std::atomic<std::size_t> not_finite{0};
    std::vector<TexelDerivative> values(count);
    parallel_chunks(count, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            values[i] = others.ends.empty()
                            ? differentiate_at(integrand.derivative, record(i), key(i))
                            : differentiate_at(integrand.derivative, record(i),
                                               vertices_of(others, i), key(i));
            if (std::isfinite(values[i].q) && is_finite(values[i].g)) continue;
            values[i] = {key(i), 0, {}};
            ++not_finite;
        }
    });
    rejected += not_finite;
    return values;
}

}  // namespace

std::vector<ShiftedSample> shift_history(const Integrand& now, Shift shift, const History& history,
                                         std::size_t& rejected) {
    const std::vector<HistorySample>& samples = history.samples;
    std::vector<ShiftedSample> shifted(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) shifted[i] = {samples[i], {}, samples[i].q};
    if (shift == Shift::kReplay) {
        std::vector<PathSample> paths(samples.size());
        for (std::size_t i = 0; i < samples.size(); ++i) paths[i] = samples[i].path;
        const std::vector<PathRecord> records = replay_paths(now.trace, paths, rejected);
        for (std::size_t i = 0; i < samples.size(); ++i) shifted[i].sample.record = records[i];
    }
    const auto values = evaluate(
        now, shifted.size(),
        [&](std::size_t i) -> const PathRecord& { return shifted[i].sample.record; },
        history.others, [&](std::size_t i) { return shifted[i].sample.key; }, rejected);
    for (std::size_t i = 0; i < shifted.size(); ++i)
        shifted[i].sample.q = values[i].q, shifted[i].g = values[i].g;
    return shifted;
}

PathVertices others_of(const std::vector<CurrentSample>& current, const Candidates& candidates) {
    const TracedPaths& traced = candidates.traced;
    PathVertices others;
    if (traced.places.empty()) return others;
    for (const CurrentSample& c : current) {
        const ChainPlace& place = traced.places[candidates.items[c.candidate].path];
        append_others(traced.chains, place, others.vertices);
        others.ends.push_back(static_cast<std::uint32_t>(others.vertices.size()));
    }
    return others;
}

std::vector<ShiftedSample> shift_current(const Integrand* before, Shift shift,
                                         const std::vector<CurrentSample>& current,
                                         const PathVertices& others, const Candidates& candidates,
                                         std::size_t& rejected) {
    std::vector<ShiftedSample> result(current.size());
    for (std::size_t i = 0; i < current.size(); ++i) {
        const Candidate& c = candidates.items[current[i].candidate];
        const TracedPath& path = candidates.traced.paths[c.path];
        result[i] = {{c.d.key, c.d.q, current[i].W, path.path, path.record}, c.d.g, 0};
    }
    if (!before) return result;
    std::vector<PathRecord> records;
    if (shift == Shift::kReplay) {
        std::vector<PathSample> samples(current.size());
        for (std::size_t i = 0; i < current.size(); ++i) samples[i] = result[i].sample.path;
        records = replay_paths(before->trace, samples, rejected);
    }
    const auto values = evaluate(
        *before, result.size(),
        [&](std::size_t i) -> const PathRecord& {
            return shift == Shift::kReplay ? records[i] : result[i].sample.record;
        },
        others, [&](std::size_t i) { return result[i].sample.key; }, rejected);
    for (std::size_t i = 0; i < result.size(); ++i) result[i].q_before = values[i].q;
    return result;
}

}  // namespace burnish
