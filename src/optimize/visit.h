// A visit of a view: image -> loss -> gradient. Where several processes share out its bands, it is
// done in two steps, and between them each tells the others what its tiles add to the images.
#pragma once

#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

/// What the bands of a process, or of all, bring to the images of a visit.
struct VisitTiles {
    std::array<TileImages, 2> halves;     ///< as of ImageTiles
    std::vector<TileImages> backgrounds;  ///< of the visit's passes, parallel to `rows`
    std::vector<Background> rows;         ///< without these passes
};

/// A view that is visited.
struct VisitedView {
    const Setup& setup;
    std::size_t which;  ///< index of Setup::fitted
    const Theta& theta;
    const Workspace& run;
    ViewState& state;
    ViewWorkspace& workspace;
};

/// Of a process that has the whole view: one visit, whose gradient counts `share`. report.loss:
/// becomes its share of the loss; the other numbers are added up.
GradientEstimate visit(const VisitedView& v, float share, Iteration& report);

/// Of a process that has bands of the view: its part of the samples.
VisitTiles begin_visit(const VisitedView& v, Iteration& report);
/// Makes `visits`, which are parallel to the views of a batch, those of all bands, where this
/// process has some. To be called by all.
void exchange_tiles(const Setup& setup, const std::vector<std::size_t>& batch,
                    std::vector<VisitTiles>& visits);
/// The rest of the visit, as `visit`; the gradient is that of its own bands. tiles: of all.
GradientEstimate finish_visit(const VisitedView& v, float share, VisitTiles tiles,
                              Iteration& report);

}  // namespace burnish
