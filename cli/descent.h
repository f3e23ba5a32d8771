// One descent from start to end: iterations within a budget, with progress, ended early by a
// signal.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/contributions.h"
#include "optimize/solve.h"

namespace burnish {

/// Whichever is used up first ends the descent.
struct Budget {
    std::uint32_t iterations = std::numeric_limits<std::uint32_t>::max();
    double seconds =
        std::numeric_limits<double>::infinity();  ///< of descent, checked per iteration
    /// Checks in a row, some iterations apart, that find the loss with fresh samples no lower than
    /// before; 0: no checks.
    std::uint32_t patience = 0;
};

enum class Ending { kIterations, kTime, kPatience, kSignal };

/// One line of the history.
struct HistoryRow {
    std::uint32_t iteration = 0;
    double seconds = 0;  ///< since the start of the descent, at the end of the iteration
    double image_seconds = 0, derivative_seconds = 0, step_seconds = 0;
    double loss = 0;  ///< of the iteration's noisy image, before its step
    std::size_t records = 0, candidates = 0, texels = 0, reservoirs = 0, rejected = 0;
    std::optional<double> checked_loss;  ///< see Budget::patience, after the step
};

/// What the samples of a descent said about a texture's texels.
struct TexelEvidence {
    std::vector<std::uint32_t> visits;  ///< of each: iterations for which samples had reached it
    Image confidence;                     ///< how far halves of the gradient agreed; may be empty
};

struct Descent {
    std::vector<HistoryRow> rows;
    ContributionCounts counts;  ///< of the derivative
    std::size_t rejected_image = 0;
    Theta theta;
    std::vector<TexelEvidence> evidence;  ///< parallel to theta.textures
    double seconds = 0;
    Ending ending = Ending::kIterations;
};

/// At least one iteration is done. A signal that an InterruptGuard caught ends it.
Descent descend_with_progress(const Problem& problem, const SolveOptions& options,
                      const std::vector<InitialTexture>& textures, const Budget& budget);

/// Of texture i, by name: "coverage", the share of the iterations for which samples had reached
/// each texel; "confidence", where there is one. [height, width, 1], 0 to 1.
std::vector<std::pair<std::string, Image>> evidence_maps(const Descent& descent, std::size_t i);

/// The history as CSV, one line per iteration.
std::string history_csv(const std::vector<HistoryRow>& rows);

const char* name_of(Ending ending);

}  // namespace burnish
