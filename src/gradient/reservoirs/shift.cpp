#include "gradient/reservoirs/shift.h"

#include <cmath>

namespace burnish {

namespace {

/// g and q of a sample's path under an integrand, with the record that it has there. whole: its
/// other vertices are kept. Where they are not finite they become 0, and rejected grows by one.
TexelDerivative evaluate(const Integrand& integrand, const PathRecord& record,
                         const ShiftedSample& sample, bool whole, std::size_t& rejected) {
    const TexelKey key = sample.sample.key;
    const TexelDerivative d =
        whole ? differentiate_at(integrand.derivative, record, sample.others, key)
              : differentiate_at(integrand.derivative, record, key);
    if (std::isfinite(d.q) && is_finite(d.g)) return d;
    ++rejected;
    return {key, 0, {}};
}

/// The records of the samples' paths, traced again under an integrand.
std::vector<PathRecord> replay(const Integrand& integrand,
                               const std::vector<ShiftedSample>& samples, std::size_t& rejected) {
    std::vector<PathSample> paths;
    std::vector<Hit> hits;
    std::vector<PathRecord> records;
    paths.reserve(samples.size()), hits.reserve(samples.size()), records.reserve(samples.size());
    for (const auto& [sample, g, q_before, others] : samples)
        paths.push_back(sample.path), hits.push_back(sample.hit), records.push_back(sample.record);
    return replay_paths(integrand.trace, paths, hits, std::move(records), rejected);
}

}  // namespace

std::vector<ShiftedSample> shift_history(const Integrand& now, Shift shift, const History& history,
                                         const IndexRange& range, std::size_t& rejected) {
    std::vector<ShiftedSample> shifted;
    shifted.reserve(range.size());
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const HistorySample& sample = history.samples[i];
        shifted.push_back({sample, {}, sample.q, vertices_of(history.others, i)});
    }
    if (shift == Shift::kReplay) {
        const std::vector<PathRecord> records = replay(now, shifted, rejected);
        for (std::size_t i = 0; i < shifted.size(); ++i) shifted[i].sample.record = records[i];
    }
    const bool whole = !history.others.ends.empty();
    for (ShiftedSample& s : shifted) {
        const TexelDerivative d = evaluate(now, s.sample.record, s, whole, rejected);
        s.sample.q = d.q, s.g = d.g;
    }
    return shifted;
}

PathVertices others_of(std::span<const CurrentSample> current, const Candidates& candidates) {
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
                                         std::span<const CurrentSample> current,
                                         const PathVertices& others, const Candidates& candidates,
                                         std::size_t& rejected) {
    std::vector<ShiftedSample> shifted;
    shifted.reserve(current.size());
    for (std::size_t i = 0; i < current.size(); ++i) {
        const Candidate& c = candidates.items[current[i].candidate];
        const TracedPath& path = candidates.traced.paths[c.path];
        shifted.push_back({{c.d.key, c.d.q, current[i].W, path.path, path.record, path.hit},
                           c.d.g,
                           0,
                           vertices_of(others, i)});
    }
    if (!before) return shifted;
    std::vector<PathRecord> records;
    if (shift == Shift::kReplay) records = replay(*before, shifted, rejected);
    for (std::size_t i = 0; i < shifted.size(); ++i) {
        ShiftedSample& s = shifted[i];
        const PathRecord& record = shift == Shift::kReplay ? records[i] : s.sample.record;
        s.q_before = evaluate(*before, record, s, !others.ends.empty(), rejected).q;
    }
    return shifted;
}

}  // namespace burnish
