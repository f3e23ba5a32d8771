// One descent from start to end: iterations within a budget, with progress, ended early by a
// signal.
#pragma once

#include <limits>
#include <vector>

#include "burnish/app/contributions.h"
#include "burnish/inverse/solve.h"

namespace burnish {

/// Whichever is used up first ends the descent.
struct Budget {
    std::uint32_t iterations = std::numeric_limits<std::uint32_t>::max();
    double seconds =
        std::numeric_limits<double>::infinity();  ///< of descent, checked per iteration
};

enum class Ending { kIterations, kTime, kSignal };

/// One line of the history.
struct HistoryRow {
    std::uint32_t iteration = 0;
    double seconds = 0;  ///< since the start of the descent, at the end of the iteration
    double image_seconds = 0, derivative_seconds = 0, step_seconds = 0;
    double loss = 0;  ///< of the iteration's noisy image, before its step
    std::size_t records = 0, candidates = 0, texels = 0, reservoirs = 0, rejected = 0;
};

struct Descent {
    std::vector<HistoryRow> rows;
    ContributionCounts counts;  ///< of the derivative
    std::size_t rejected_image = 0;
    Theta theta;
    double seconds = 0;
    Ending ending = Ending::kIterations;
};

/// At least one iteration is done. A signal that an InterruptGuard caught ends it.
Descent descend_aloud(const Problem& problem, const SolveOptions& options,
                      const std::vector<InitialTexture>& textures, const Budget& budget);

/// The history as CSV, one line per iteration.
std::string history_csv(const std::vector<HistoryRow>& rows);

const char* name_of(Ending ending);

}  // namespace burnish
