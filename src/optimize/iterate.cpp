#include "optimize/iterate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <optional>

#include "burnish/error.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "optimize/batch.h"
#include "optimize/memory.h"
#include "optimize/non_finite.h"
#include "optimize/ranks.h"
#include "optimize/shared_pyramid.h"
#include "optimize/view_before.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"

namespace burnish {

namespace {

/// to += scale (a + b + ...), value by value.
void add(Image& to, float scale, std::span<const Image> images) {
    parallel_chunks(to.values.size(), std::size_t{1} << 16, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) {
            float sum = images[0].values[i];
            for (std::size_t k = 1; k < images.size(); ++k) sum += images[k].values[i];
            to.values[i] += scale * sum;
        }
    });
}

/// The mean image with the background, and the adjoint of each image with it.
struct Losses {
    double value = 0;
    Image mean;
    std::vector<Image> adjoints;
    std::size_t rejected = 0;  ///< values of the loss and of the adjoints that were not finite
};

/// Images [of one half or two] without the background become those of a visit.
Losses all_losses(const Setup& setup, std::size_t view, const Image& background,
                  const ExposureFactors& exposure, std::vector<Image>& images) {
    Losses losses;
    losses.mean = background;
    add(losses.mean, 1 / static_cast<float>(images.size()), images);
    if (images.size() == 1 || has_own_derivatives(setup.options.estimator)) {
        LossValue loss = loss_of(setup, view, exposure, losses.mean);
        losses.value = loss.value;
        losses.adjoints.push_back(std::move(loss.adjoint));
        return losses;
    }
    losses.value = loss_value_of(setup, view, exposure, losses.mean);
    for (Image& image : images) {
        add(image, 1.0f, {&background, 1});
        losses.adjoints.push_back(loss_of(setup, view, exposure, image).adjoint);
    }
    return losses;
}

/// The same with adjoints that are finite: a loss of one's own may be anything, and images may be
/// too large for it.
Losses find_losses(const Setup& setup, std::size_t view, const Image& background,
                   const ExposureFactors& exposure, std::vector<Image>& images) {
    Losses losses = all_losses(setup, view, background, exposure, images);
    losses.rejected = !std::isfinite(losses.value);
    for (Image& adjoint : losses.adjoints) losses.rejected += leave_out_non_finite(adjoint);
    return losses;
}

/// Adds this visit's passes to the background: where there are two, in turns.
std::size_t gather_backgrounds(const Setup& setup, const Binding& binding, const NearUnknown& near,
                               std::uint32_t seed, ViewState& own) {
    const Options& o = setup.options;
    const auto halves = static_cast<std::uint32_t>(own.backgrounds.size());
    std::size_t rejected = 0;
    for (std::uint32_t half = 0; half < halves; ++half) {
        if (own.visits > 0 && own.visits % halves != half) continue;
        const BackgroundOptions options{std::max(1u, image_samples(o.estimator) / 8),
                                        o.background_samples / halves, seed_of_half(seed, half)};
        rejected += gather_background(binding, near, options, (own.visits + halves - 1) / halves,
                                      own.backgrounds[half]);
    }
    return rejected;
}

/// The exposure of a visit, from images without their backgrounds.
ExposureFactors find_exposure(const Setup& setup, std::size_t view, const ViewState& own,
                              const std::vector<Image>& images) {
    if (own.backgrounds.size() == 1) return own.exposure;
    Image a = own.backgrounds[0].mean, b = own.backgrounds[1].mean;
    add(a, 1.0f, {&images.front(), 1});
    add(b, 1.0f, {&images.back(), 1});
    return exposure_of(setup, view, a, b, own.exposure);
}

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
    std::size_t all = 0;
    for (const std::size_t count : all_values(ranks, rejected)) all += count;
    return all;
}

void scale(float factor, std::vector<Image>& images) {
    if (factor == 1) return;
    for (Image& image : images)
        for (float& v : image.values) v *= factor;
}

/// Work memory of the textures' size goes from view to view: one of them uses it at a time.
void hand_over(ViewWorkspace& from, ViewWorkspace& to) {
    if (&from == &to) return;
    std::swap(from.estimator.gradient, to.estimator.gradient);
    std::swap(from.estimator.cache.sums, to.estimator.cache.sums);
    std::swap(from.estimator.cache.gradient, to.estimator.cache.gradient);
}

void drop_records(EstimatorState& state, ViewWorkspace& workspace) {
    keep_window(0, kept_cache(state));
    for (auto& memory : workspace.estimator.cache.memory) memory.clear();
}

/// One visit of a view: image -> loss -> gradient, which counts `share`. report.loss: becomes its
/// share of the loss; the other numbers are added up.
const std::vector<SplitGradient>& visit(const Setup& setup, std::size_t which, float share,
                                        State::Values& state, Workspace& all, Iteration& report) {
    Stopwatch watch;
    const Options& o = setup.options;
    const std::size_t view = setup.fitted[which];
    const Binding binding(scene_of(setup, view), state.theta);
    ViewState& own = state.views[which];
    ViewWorkspace& workspace = all.views[which];
    const IterationKey key{seed_of_view(o.seed, view), own.visits};

    report.rejected_image += gather_backgrounds(setup, binding, workspace.near, key.seed, own);
    ImageEstimate image =
        estimate_image(all.estimator, binding, key, own.estimator, workspace.estimator,
                       own.backgrounds.size() > 1 ? Images::kHalves : Images::kAny);
    report.rejected_image += image.rejected_samples;
    own.exposure = find_exposure(setup, view, own, image.images);
    const Image both = own.backgrounds.size() > 1 ? mean_of(own.backgrounds) : Image{};
    const Image& background = own.backgrounds.size() > 1 ? both : own.backgrounds[0].mean;
    Losses losses = find_losses(setup, view, background, own.exposure, image.images);
    report.loss = double{share} * losses.value;
    report.rejected_image += losses.rejected;
    scale(share, losses.adjoints);
    report.image_seconds += watch.lap();

    const GradientEstimate estimate = estimate_gradient(all.estimator, binding, losses.adjoints,
                                                        key, own.estimator, workspace.estimator);
    const GradientCounts& counts = estimate.counts;
    report.paths += counts.records, report.derivatives += counts.candidates;
    report.texels += counts.texels, report.reservoirs += counts.reservoirs;
    report.rejected_derivatives += counts.rejected + image.rejected_records;
    if (!all.keeps_records) drop_records(own.estimator, workspace);
    workspace.image = std::move(losses.mean);
    ++own.visits;
    report.derivative_seconds += watch.lap();
    return estimate.gradient;
}

/// Of a process in an iteration.
struct WorkDone {
    std::array<std::size_t, 6> counts{};
    std::array<double, 2> seconds{};
};

/// Adds up what other processes have done; seconds are those of the slowest.
void add_reports(const Ranks& ranks, Iteration& report) {
    if (ranks.count == 1) return;
    std::vector<WorkDone> all = all_values(
        ranks, WorkDone{{report.paths, report.derivatives, report.texels, report.reservoirs,
                         report.rejected_image, report.rejected_derivatives},
                        {report.image_seconds, report.derivative_seconds}});
    WorkDone sum;
    for (const WorkDone& w : all) {
        for (std::size_t i = 0; i < sum.counts.size(); ++i) sum.counts[i] += w.counts[i];
        for (std::size_t i = 0; i < sum.seconds.size(); ++i)
            sum.seconds[i] = std::max(sum.seconds[i], w.seconds[i]);
    }
    report.paths = sum.counts[0], report.derivatives = sum.counts[1];
    report.texels = sum.counts[2], report.reservoirs = sum.counts[3];
    report.rejected_image = sum.counts[4], report.rejected_derivatives = sum.counts[5];
    report.image_seconds = sum.seconds[0], report.derivative_seconds = sum.seconds[1];
}

/// Visits the views of a batch that are this process's own, and marks in `before` where each was.
/// Returns the gradient of the last one.
const std::vector<SplitGradient>& visit_batch(const Setup& setup,
                                              const std::vector<std::size_t>& batch,
                                              State::Values& state, Workspace& workspace,
                                              std::vector<ViewBefore>& before, Iteration& report) {
    static const std::vector<SplitGradient> kNone;
    const Ranks& ranks = setup.problem.ranks;
    report.number = state.iteration;
    const float share_of_view = 1 / static_cast<float>(batch.size());
    const std::vector<SplitGradient>* gradient = &kNone;
    std::vector<double> losses(batch.size());
    std::vector<int> owners;
    for (std::size_t k = 0; k < batch.size(); ++k) {
        owners.push_back(setup.owners[setup.fitted[batch[k]]]);
        if (owners.back() != ranks.rank) continue;
        hand_over(workspace.views[workspace.last], workspace.views[batch[k]]);
        workspace.last = batch[k];
        before.emplace_back(state.views[batch[k]], workspace.views[batch[k]]);
        gradient = &visit(setup, batch[k], share_of_view, state, workspace, report);
        losses[k] = report.loss;
        if (batch.size() > 1) add_view(k, *gradient, workspace.sum);
    }
    share(ranks, owners, Recipient::kAll, losses);
    report.loss = 0;
    for (const double loss : losses) report.loss += loss;
    add_reports(ranks, report);
    return *gradient;
}

constexpr const char* kNoMemory = "there is not enough memory for the textures and their gradients";

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
    const std::size_t backgrounds = fits_exposure(v) ? 2 : 1;
    ViewState state{0, make_state(setup.options.estimator), std::vector<Background>(backgrounds)};
    if (!fits_exposure(v)) state.exposure = std::get<ExposureFactors>(v.exposure);
    return state;
}

State::Values make_state(const Setup& setup) {
    State::Values state;
    for (const std::size_t view : setup.fitted) state.views.push_back(make_view_state(setup, view));
    for (const UnknownTexture& u : setup.unknowns) {
        state.pyramids.push_back(encode(u.maps, u.start, u.adam.weight_decay > 0));
        state.theta.textures.push_back({u.texture, decode(u.maps, state.pyramids.back())});
        state.searched.push_back(u.start_kind == StartKind::kSearched ? u.start : Image{});
    }
    return state;
}

Workspace make_workspace(const Setup& setup, const State::Values& state) {
    Workspace workspace;
    std::vector<TracedScene> views;
    for (const std::size_t view : setup.fitted) views.push_back(scene_of(setup, view));
    const ViewShare share = share_memory(setup.options.estimator, views, state.theta);
    workspace.estimator = share.estimator, workspace.keeps_records = share.keeps_records;
    workspace.views = std::vector<ViewWorkspace>(views.size());
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (!is_mine(setup, setup.fitted[i])) continue;
        const Binding binding(views[i], state.theta);
        workspace.views[i].estimator = make_workspace(workspace.estimator, binding);
        workspace.views[i].near = near_unknown(binding);
        if (first) workspace.views[i].estimator.cache.sums.clear();
        if (!first) workspace.last = *(first = i);
    }
    workspace.parts = own_parts(setup), workspace.shapes = gradient_shapes(setup);
    workspace.pyramids.resize(setup.unknowns.size());
    return workspace;
}

Iteration iterate(const Setup& setup, State::Values& state, Workspace& workspace,
                  const StopQuestion& stop) {
    const std::vector<std::size_t> batch = batch_of(setup, state.iteration);
    std::vector<ViewBefore> before;
    before.reserve(batch.size());
    Iteration report;
    const std::vector<SplitGradient>* gradient = nullptr;
    try {
        const Stoppable stoppable(stop);
        gradient = &visit_batch(setup, batch, state, workspace, before, report);
    } catch (...) {
        roll_back(before);
        throw;
    }
    Stopwatch watch;
    try {
        if (batch.size() > 1)
            gradient = &sum_of_views(setup.problem.ranks, workspace.shapes, workspace.sum);
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
