// What survives an iteration: values only, so that a run can be copied, stored and resumed. What
// can be computed again is in a Workspace.
#pragma once

#include <limits>

#include "burnish/solve.h"
#include "gradient/background.h"
#include "gradient/estimator.h"
#include "optimize/view_sum.h"
#include "texture/pyramid_step.h"

namespace burnish {

/// What Stop::patience remembers of its checks.
struct PatienceState {
    double min_loss = std::numeric_limits<double>::infinity();
    std::uint32_t failed = 0;  ///< checks in a row that found no lower loss

    friend bool operator==(const PatienceState&, const PatienceState&) = default;
};

/// Of a view: its integrand is one function at each of its visits.
struct ViewState {
    std::uint32_t visits = 0;  ///< so far: what an estimator counts as iterations
    EstimatorState estimator;
    /// Two, independent of each other, where an exposure is fitted or pixels are reweighed; else
    /// one.
    std::vector<Background> backgrounds;
    ExposureFactors exposure{1, 1, 1};  ///< of the last visit, where it is fitted

    friend bool operator==(const ViewState&, const ViewState&) = default;
};

/// What all searches have found of a group of unknowns, added up: see GroupSums. Empty with
/// colours.
struct SearchedCosts {
    std::vector<double> squares, costs;

    friend bool operator==(const SearchedCosts&, const SearchedCosts&) = default;
};

struct State::Values {
    std::uint32_t iteration = 0;  ///< the next one
    Theta theta;                  ///< the unknowns, clamped
    /// Parallel to theta.textures. Of several processes, each holds its own part during a run: see
    /// keep_part.
    std::vector<PyramidState> pyramids;
    std::vector<ViewState> views;  ///< parallel to Setup::fitted
    PatienceState patience;
    std::vector<Image> searched;  ///< the start of each unknown; width 0: it was not searched
    double search_effort = 1;     ///< of the search for the start: what its regions follow from
    std::vector<SearchedCosts> search_costs;    ///< of its groups; empty: no other search follows
    std::vector<SearchedAgain> searched_again;  ///< since then

    friend bool operator==(const Values&, const Values&) = default;
};

/// Work memory of a view.
struct ViewWorkspace {
    EstimatorWorkspace estimator;
    NearUnknown near;
    Image image;  ///< of the last visit
};

/// Work memory of a run: follows from setup and state.
struct Workspace {
    Estimator estimator;               ///< of a view: with its share of the memory
    bool keeps_records = true;         ///< of path caches, from visit to visit
    std::vector<ViewWorkspace> views;  ///< parallel to State::Values::views
    std::size_t last = 0;              ///< visited, whose work memory has the textures' size
    ViewSum sum;                       ///< over the views of an iteration, where they are several
    std::vector<GradientParts> gradients;  ///< of each unknown: who gets what of the sum
    std::vector<PyramidPart> parts;        ///< of each unknown: what this process steps
    std::vector<PyramidWorkspace> pyramids;
};

}  // namespace burnish
