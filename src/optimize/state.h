// What survives an iteration: values only, so that a run can be copied, stored and resumed. What
// can be computed again is in a Workspace.
#pragma once

#include <limits>

#include "burnish/solve.h"
#include "gradient/background.h"
#include "gradient/estimator.h"
#include "texture/pyramid.h"

namespace burnish {

/// What Stop::patience remembers of its checks.
struct PatienceState {
    double min_loss = std::numeric_limits<double>::infinity();
    std::uint32_t failed = 0;  ///< checks in a row that found no lower loss

    friend bool operator==(const PatienceState&, const PatienceState&) = default;
};

struct State::Values {
    std::uint32_t iteration = 0;         ///< the next one
    Theta theta;                         ///< the unknowns, clamped
    std::vector<PyramidState> pyramids;  ///< parallel to theta.textures
    EstimatorState estimator;
    Background background;
    PatienceState patience;

    friend bool operator==(const Values&, const Values&) = default;
};

/// Work memory of a run: follows from setup and state.
struct Workspace {
    EstimatorWorkspace estimator;
    NearUnknown near;
    std::vector<PyramidWorkspace> pyramids;
    Image image;  ///< of the last iteration
};

}  // namespace burnish
