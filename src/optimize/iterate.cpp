#include "optimize/iterate.h"

#include <algorithm>
#include <new>
#include <optional>

#include "burnish/error.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "optimize/batch.h"
#include "optimize/memory.h"
#include "optimize/non_finite.h"
#include "optimize/owners.h"
#include "optimize/ranks.h"
#include "optimize/shared_pyramid.h"
#include "optimize/view_before.h"
#include "optimize/view_loss.h"
#include "optimize/visit.h"

namespace burnish {

namespace {

/// Returns the number of values of the gradient that were left out. gradient: what this process's
/// parts read of it.
std::size_t take_step(const Setup& setup, const std::vector<SplitGradient>& gradient,
                      State::Values& state, Workspace& workspace) {
    const Ranks& ranks = setup.problem.ranks;
    const PartExchange exchange = exchange_of(ranks);
    std::size_t rejected = 0;
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        const UnknownTexture& unknown = setup.unknowns[i];
        const PyramidPart& part = workspace.parts[i];
        std::optional<SplitGradient> usable;
        if (!is_usable(gradient[i])) {
            const std::size_t own = part[0].read.place_of(part[0].own.begin);
            usable = gradient[i];
            rejected += leave_out_unusable(*usable, own, own + part[0].own.size());
        }
        descend({unknown.adam, unknown.maps, part, exchange}, usable ? *usable : gradient[i],
                state.pyramids[i], workspace.pyramids[i], state.theta.textures[i].values);
    }
    return sum_over(ranks, rejected);
}

/// Work memory of the textures' size goes from view to view: one of them uses it at a time.
void hand_over(ViewWorkspace& from, ViewWorkspace& to) {
    if (&from == &to) return;
    std::swap(from.estimator.gradient, to.estimator.gradient);
    std::swap(from.estimator.cache.sums, to.estimator.cache.sums);
    std::swap(from.estimator.cache.gradient, to.estimator.cache.gradient);
}

/// Adds up what other processes have done; seconds are those of the slowest.
void add_reports(const Ranks& ranks, Iteration& report) {
    const std::vector<Iteration> all = all_values(ranks, report);
    for (const auto count :
         {&Iteration::paths, &Iteration::derivatives, &Iteration::texels, &Iteration::reservoirs,
          &Iteration::rejected_image, &Iteration::rejected_derivatives}) {
        report.*count = 0;
        for (const Iteration& one : all) report.*count += one.*count;
    }
    for (const auto seconds : {&Iteration::image_seconds, &Iteration::derivative_seconds})
        for (const Iteration& one : all) report.*seconds = std::max(report.*seconds, one.*seconds);
}

/// Whether a gradient is the sum of several.
bool is_summed_up(const Ranks& ranks, const std::vector<std::size_t>& batch) {
    return ranks.count > 1 || batch.size() > 1;
}

/// The first owners of the views of a batch.
std::vector<int> owners_of(const Setup& setup, const std::vector<std::size_t>& batch) {
    std::vector<int> owners;
    for (const std::size_t which : batch) owners.push_back(setup.owners[setup.fitted[which]]);
    return owners;
}

/// Marks where this process's own views of the batch are before their visits. One at the end of an
/// epoch may be the first one of the next, too.
std::vector<ViewBefore> mark_views(const Setup& setup, const std::vector<std::size_t>& batch,
                                   State::Values& state, Workspace& workspace) {
    std::vector<ViewBefore> before;
    for (std::size_t k = 0; k < batch.size(); ++k)
        if (!own_bands(setup, batch[k]).empty() && (k == 0 || batch[k] != batch[k - 1]))
            before.emplace_back(state.views[batch[k]], workspace.views[batch[k]]);
    return before;
}

VisitedView visited(const Setup& setup, std::size_t which, State::Values& state,
                    Workspace& workspace) {
    return {setup, which, state.theta, workspace, state.views[which], workspace.views[which]};
}

/// What all bands of the views of a batch bring to their images.
std::vector<VisitTiles> begin_visits(const Setup& setup, const std::vector<std::size_t>& batch,
                                     State::Values& state, Workspace& workspace,
                                     Iteration& report) {
    std::vector<VisitTiles> tiles(batch.size());
    for (std::size_t k = 0; k < batch.size(); ++k) {
        if (own_bands(setup, batch[k]).empty()) continue;
        tiles[k] = begin_visit(visited(setup, batch[k], state, workspace), report);
    }
    exchange_tiles(setup, batch, tiles);
    return tiles;
}

/// Adds a visit's gradient, at its place in the batch.
void add_visit(std::size_t place, const GradientEstimate& visit, ViewSum& sum) {
    const std::size_t begin = place * kViewBands;
    if (visit.bands.empty()) add_node(begin, kViewBands, visit.gradient, sum);
    for (const BandGradient& b : visit.bands)
        add_node(begin + b.bands.begin, b.bands.size(), b.gradient, sum);
}

/// Visits what is this process's own of the views of a batch. Returns the gradient of the last one.
const std::vector<SplitGradient>& visit_batch(const Setup& setup,
                                              const std::vector<std::size_t>& batch,
                                              State::Values& state, Workspace& workspace,
                                              Iteration& report) {
    static const std::vector<SplitGradient> kNone;
    const Ranks& ranks = setup.problem.ranks;
    const bool shared = shares_bands(setup);
    report.number = state.iteration;
    const float share_of_view = 1 / static_cast<float>(batch.size());
    const std::vector<SplitGradient>* gradient = &kNone;
    std::vector<double> losses(batch.size());
    std::vector<VisitTiles> tiles;
    if (shared) tiles = begin_visits(setup, batch, state, workspace, report);
    for (std::size_t k = 0; k < batch.size(); ++k) {
        const std::size_t which = batch[k];
        if (own_bands(setup, which).empty()) continue;
        hand_over(workspace.views[workspace.last], workspace.views[which]);
        workspace.last = which;
        const VisitedView view = visited(setup, which, state, workspace);
        const GradientEstimate estimate =
            shared ? finish_visit(view, share_of_view, std::move(tiles[k]), report)
                   : visit(view, share_of_view, report);
        gradient = &estimate.gradient;
        losses[k] = report.loss;
        if (is_summed_up(ranks, batch)) add_visit(k, estimate, workspace.sum);
    }
    share(ranks, owners_of(setup, batch), Recipient::kAll, losses);
    report.loss = 0;
    for (const double loss : losses) report.loss += loss;
    add_reports(ranks, report);
    return *gradient;
}

constexpr const char* kNoMemory = "there is not enough memory for the textures and their gradients";

/// What an iteration that is given up has added up.
void drop_sums(Workspace& workspace) {
    workspace.sum = {};
    for (TexelSums& sums : workspace.views[workspace.last].estimator.cache.sums) sums.bands.clear();
}

void roll_back(std::vector<ViewBefore>& before) {
    try {
        for (ViewBefore& view : before) view.roll_back();
    } catch (const std::bad_alloc&) {
        throw ResourceError(kNoMemory);
    }
}

}  // namespace

ViewState make_view_state(const Setup& setup, std::size_t view) {
    const View& v = setup.problem.views[view];
    const std::size_t backgrounds = fits_exposure(v.exposure) || is_reweighted(setup) ? 2 : 1;
    ViewState state{0, make_state(setup.options.estimator), std::vector<Background>(backgrounds)};
    state.exposure = factors_of(v.exposure);
    return state;
}

State::Values make_state(const Setup& setup) {
    State::Values state;
    for (const std::size_t view : setup.fitted) state.views.push_back(make_view_state(setup, view));
    for (const UnknownTexture& u : setup.unknowns) {
        const bool keeps_start = u.adam.weight_decay > 0 || setup.options.search_again > 0;
        state.pyramids.push_back(encode(u.maps, u.start, keeps_start));
        state.theta.textures.push_back({u.texture, decode(u.maps, state.pyramids.back())});
        state.searched.push_back(u.start_kind == StartKind::kSearched ? copy_of(u.start) : Image{});
    }
    return state;
}

Workspace make_workspace(const Setup& setup, const State::Values& state) {
    Workspace workspace;
    std::vector<TracedScene> views;
    for (const std::size_t view : setup.fitted) views.push_back(scene_of(setup, view));
    const std::vector<std::vector<char>> reaching = reaching_pixels(views, state.theta);
    const ViewShare share = share_memory(setup.options.estimator, views, reaching, state.theta);
    workspace.estimator = share.estimator, workspace.keeps_records = share.keeps_records;
    workspace.views = std::vector<ViewWorkspace>(views.size());
    const auto is_own = [&](std::size_t i) { return !own_bands(setup, i).empty(); };
    for (std::size_t i = views.size(); i-- > 0;)
        if (is_own(i)) workspace.last = i;
    parallel_tasks(views.size(), [&](std::size_t i) {
        if (!is_own(i)) return;
        const Binding binding(views[i], state.theta);
        ViewWorkspace& view = workspace.views[i];
        view.estimator =
            make_workspace(workspace.estimator, binding, reaching[i], own_bands(setup, i));
        view.near = near_unknown(binding.film(), reaching[i]);
        if (i != workspace.last) view.estimator.cache.sums.clear();
    });
    workspace.parts = own_parts(setup), workspace.gradients = gradient_parts(setup);
    workspace.pyramids.resize(setup.unknowns.size());
    return workspace;
}

Iteration iterate(const Setup& setup, State::Values& state, Workspace& workspace,
                  const StopQuestion& stop) {
    const std::vector<std::size_t> batch = batch_of(setup, state.iteration);
    std::vector<ViewBefore> before;
    Iteration report;
    const std::vector<SplitGradient>* gradient = nullptr;
    try {
        if (stop && stop()) throw Stopped{};  // a process without a share runs no loop
        const Stoppable stoppable(stop);
        before = mark_views(setup, batch, state, workspace);
        gradient = &visit_batch(setup, batch, state, workspace, report);
    } catch (...) {
        drop_sums(workspace);
        roll_back(before);
        throw;
    }
    Stopwatch watch;
    try {
        if (is_summed_up(setup.problem.ranks, batch))
            gradient = &sum_of_views(setup.problem.ranks, workspace.gradients, workspace.sum);
        report.rejected_derivatives += take_step(setup, *gradient, state, workspace);
    } catch (const std::bad_alloc&) {
        throw ResourceError(kNoMemory);
    }
    for (ViewBefore& b : before) b.release();
    ++state.iteration;
    report.step_seconds = watch.lap();
    return report;
}

}  // namespace burnish
