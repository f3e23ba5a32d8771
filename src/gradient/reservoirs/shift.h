// Samples under the integrand of another iteration [PR sec. 4.2]: those of the history under the
// current one, and the current ones under that of the iteration before.
#pragma once

#include <span>
#include <vector>

#include "core/index_range.h"
#include "gradient/reservoirs/history.h"

namespace burnish {

/// A current reservoir: the index of its candidate, and W.
struct CurrentSample {
    TexelKey key;
    std::uint32_t candidate = 0;
    float W = 0;
};

/// A sample of either side, ready to be merged.
struct ShiftedSample {
    HistorySample sample;  ///< under the current integrand: q is q_v, record is the shifted one
    Rgbf g;                ///< under the current integrand
    float q_before = 0;    ///< q_{v-1}: under the integrand of the iteration before
    /// The other vertices of its path, where they are kept.
    std::span<const PathVertex> others = {};
};

/// Those of the history's samples that `range` names, under the current integrand. They refer to
/// the history. rejected: grows by those that are not finite, which count for nothing.
std::vector<ShiftedSample> shift_history(const Integrand& now, Shift shift, const History& history,
                                         const IndexRange& range, std::size_t& rejected);

/// The other vertices of the current samples' paths; none where they are not kept.
PathVertices others_of(std::span<const CurrentSample> current, const Candidates& candidates);

/// The current samples with what the integrand of the iteration before makes of them: q_{v-1}
/// [PR eq. 13]. before: null in the first iteration. others: as of others_of; the samples refer to
/// them. rejected: as above.
std::vector<ShiftedSample> shift_current(const Integrand* before, Shift shift,
                                         std::span<const CurrentSample> current,
                                         const PathVertices& others, const Candidates& candidates,
                                         std::size_t& rejected);

}  // namespace burnish
