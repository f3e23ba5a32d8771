// Iterations are done as a whole or not at all: what one changes of a view, as it was before.
#pragma once

#include "optimize/state.h"

namespace burnish {

/// Of a view, from its first visit in an iteration on. Records are not copied: the work memory
/// keeps what visits drop.
class ViewBefore {
  public:
    ViewBefore(ViewState& view, ViewWorkspace& workspace)
        : view_(view),
          workspace_(workspace),
          visits_(view.visits),
          exposure_(view.exposure),
          backgrounds_(view.backgrounds),
          estimator_(mark(view.estimator)) {}

    void roll_back() {
        view_.visits = visits_, view_.exposure = exposure_;
        view_.backgrounds = std::move(backgrounds_);
        burnish::roll_back(std::move(estimator_), view_.estimator, workspace_.estimator);
    }
    void release() { burnish::release(workspace_.estimator); }

  private:
    ViewState& view_;
    ViewWorkspace& workspace_;
    std::uint32_t visits_;
    ExposureFactors exposure_;
    std::vector<Background> backgrounds_;
    EstimatorMark estimator_;
};

}  // namespace burnish
