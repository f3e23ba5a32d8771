#include "optimize/visit.h"

#include <algorithm>
#include <cmath>

#include "core/dirty_blocks.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "optimize/non_finite.h"
#include "optimize/owners.h"
#include "optimize/ranks.h"
#include "optimize/state_fields.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"
#include "render/render.h"

namespace burnish {

void fields(auto& archive, Is<VisitTiles> auto& v) {
    archive(v.halves[0], v.halves[1], v.backgrounds, v.rows);
}

namespace {

void add(const Image& image, Image& to) {
    parallel_chunks(to.values.size(), kParallelFloats, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) to.values[i] += image.values[i];
    });
}

/// The mean image with the background, and the adjoint of each image with it.
struct Losses {
    double value = 0;
    Image mean;
    std::vector<Image> adjoints;
    std::size_t rejected = 0;  ///< values of the loss and of the adjoints that were not finite
};

/// Of the images of a visit, one or two, which are left as they are.
Losses all_losses(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                  const std::vector<Image>& images) {
    Losses losses;
    const bool is_one = has_own_derivatives(setup.options.estimator) && !is_reweighted(setup);
    losses.mean = images.size() == 1 ? images[0] : mean_of(images[0], images[1]);
    if (images.size() == 1 || is_one) {
        LossValue loss = loss_of(setup, view, exposure, losses.mean);
        losses.value = loss.value;
        losses.adjoints.push_back(std::move(loss.adjoint));
        return losses;
    }
    losses.value = loss_value_of(setup, view, exposure, losses.mean);
    for (const Image& image : images)
        losses.adjoints.push_back(loss_of(setup, view, exposure, image).adjoint);
    if (is_reweighted(setup)) reweigh(setup, view, exposure, images, losses.adjoints);
    if (has_own_derivatives(setup.options.estimator)) {
        losses.adjoints[0] = mean_of(losses.adjoints[0], losses.adjoints[1]);
        losses.adjoints.pop_back();
    }
    return losses;
}

/// The same with adjoints that are finite: a loss of one's own may be anything, and images may be
/// too large for it.
Losses find_losses(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                   const std::vector<Image>& images) {
    Losses losses = all_losses(setup, view, exposure, images);
    losses.rejected = !std::isfinite(losses.value);
    for (Image& adjoint : losses.adjoints) losses.rejected += leave_out_non_finite(adjoint);
    return losses;
}

/// The passes of a background in a visit.
struct BackgroundVisit {
    BackgroundOptions options;
    std::uint32_t iteration = 0;
};

/// Calls body(half, its passes) for each background that gets some: where there are two, in turns.
template <class Body>
void for_backgrounds(const Setup& setup, std::uint32_t seed, const ViewState& own,
                     const Body& body) {
    const Options& o = setup.options;
    const auto halves = static_cast<std::uint32_t>(own.backgrounds.size());
    for (std::uint32_t half = 0; half < halves; ++half) {
        if (own.visits > 0 && own.visits % halves != half) continue;
        const BackgroundOptions options{std::max(1u, image_samples(o.estimator) / 8),
                                        std::max(1u, o.background_samples / halves),
                                        seed_of_half(seed, half)};
        body(half, BackgroundVisit{options, (own.visits + halves - 1) / halves});
    }
}

void scale(float factor, std::vector<Image>& images) {
    if (factor == 1) return;
    for (Image& image : images)
        parallel_chunks(image.values.size(), kParallelFloats, [&](std::size_t i, std::size_t end) {
            for (; i < end; ++i) image.values[i] *= factor;
        });
}

void drop_records(EstimatorState& state, ViewWorkspace& workspace) {
    keep_window(0, kept_cache(state));
    for (auto& memory : workspace.estimator.cache.memory) memory.clear();
}

std::size_t number_of(const VisitedView& v) { return v.setup.fitted[v.which]; }

IterationKey key_of(const VisitedView& v) {
    return {seed_of_view(v.setup.options.seed, number_of(v)), v.state.visits};
}

Binding binding_of(const VisitedView& v) { return {scene_of(v.setup, number_of(v)), v.theta}; }

/// From the images [of one half or two] of the visit, without the backgrounds, which are whole.
GradientEstimate differentiate(const VisitedView& v, float share, const Binding& binding,
                               std::vector<Image> images, Iteration& report) {
    Stopwatch watch;
    const std::size_t view = number_of(v);
    ViewState& own = v.state;
    // Each with its own background, or all with one.
    for (std::size_t h = 0; h < images.size(); ++h)
        add(own.backgrounds[h % own.backgrounds.size()].mean, images[h]);
    if (images.size() == 2)
        own.exposure = stepped_exposure_of(v.setup, view, images[0], images[1], own.exposure);
    Losses losses = find_losses(v.setup, view, own.exposure, images);
    report.loss = double{share} * losses.value;
    // Of the processes that share the view one tells of it.
    if (v.setup.owners[view] == v.setup.problem.ranks.rank)
        report.rejected_image += losses.rejected;
    scale(share, losses.adjoints);
    report.image_seconds += watch.lap();

    GradientEstimate estimate = estimate_gradient(v.run.estimator, binding, losses.adjoints,
                                                  key_of(v), own.estimator, v.workspace.estimator);
    const GradientCounts& counts = estimate.counts;
    report.paths += counts.records, report.derivatives += counts.candidates;
    report.texels += counts.texels, report.reservoirs += counts.reservoirs;
    report.rejected_derivatives += counts.rejected;
    if (!v.run.keeps_records) drop_records(own.estimator, v.workspace);
    v.workspace.image = std::move(losses.mean);
    ++own.visits;
    report.derivative_seconds += watch.lap();
    return estimate;
}

/// Takes over the tiles that are not empty.
void join(TileImages& from, TileImages& to) {
    if (to.empty()) to.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
        if (!from[i].empty()) to[i] = std::move(from[i]);
}

/// Adds the part of the next process.
void join(VisitTiles from, VisitTiles& to) {
    if (to.rows.empty()) {
        to = std::move(from);
        return;
    }
    for (std::size_t h = 0; h < 2; ++h) join(from.halves[h], to.halves[h]);
    for (std::size_t b = 0; b < to.rows.size(); ++b) {
        join(from.backgrounds[b], to.backgrounds[b]);
        join_rows(from.rows[b], to.rows[b]);
    }
}

}  // namespace

GradientEstimate visit(const VisitedView& v, float share, Iteration& report) {
    Stopwatch watch;
    const Binding binding = binding_of(v);
    ViewState& own = v.state;
    const IterationKey key = key_of(v);
    for_backgrounds(v.setup, key.seed, own, [&](std::uint32_t half, const BackgroundVisit& b) {
        report.rejected_image += gather_background(binding, v.workspace.near, b.options,
                                                   b.iteration, own.backgrounds[half]);
    });
    ImageEstimate image =
        estimate_image(v.run.estimator, binding, key, own.estimator, v.workspace.estimator,
                       own.backgrounds.size() > 1 ? Images::kHalves : Images::kAny);
    report.rejected_image += image.rejected_samples;
    report.rejected_derivatives += image.rejected_records;
    report.image_seconds += watch.lap();
    return differentiate(v, share, binding, std::move(image.images), report);
}

VisitTiles begin_visit(const VisitedView& v, Iteration& report) {
    Stopwatch watch;
    const Binding binding = binding_of(v);
    ViewState& own = v.state;
    const IterationKey key = key_of(v);
    const IndexRange range = items_of(own_bands(v.setup, v.which), tile_count(binding.film()));
    VisitTiles tiles;
    tiles.backgrounds.resize(own.backgrounds.size());
    for_backgrounds(v.setup, key.seed, own, [&](std::uint32_t half, const BackgroundVisit& b) {
        BackgroundTiles traced = trace_background(binding, v.workspace.near, b.options, b.iteration,
                                                  own.backgrounds[half], range);
        tiles.backgrounds[half] = std::move(traced.sums);
        report.rejected_image += traced.rejected;
    });
    tiles.rows = std::move(own.backgrounds);
    ImageTiles image =
        estimate_tiles(v.run.estimator, binding, key, own.estimator, v.workspace.estimator);
    tiles.halves = std::move(image.halves);
    report.rejected_image += image.rejected_samples;
    report.rejected_derivatives += image.rejected_records;
    report.image_seconds += watch.lap();
    return tiles;
}

void exchange_tiles(const Setup& setup, const std::vector<std::size_t>& batch,
                    std::vector<VisitTiles>& visits) {
    const Ranks& ranks = setup.problem.ranks;
    const auto shared_with = [&](std::size_t k, int rank) {
        return !own_bands(setup, batch[k]).empty() && !bands_of(setup, batch[k], rank).empty();
    };
    std::vector<std::string> messages = to_each(ranks);
    for (int r = 0; r < ranks.count; ++r) {
        ArchiveWriter writer(sink_into(messages[static_cast<std::size_t>(r)]));
        for (std::size_t k = 0; k < batch.size(); ++k)
            if (r != ranks.rank && shared_with(k, r)) writer(visits[k]);
    }
    const std::vector<std::string> came = ranks.exchange(std::move(messages));
    std::vector<VisitTiles> whole(batch.size());
    for (int r = 0; r < ranks.count; ++r) {
        ArchiveReader reader = reader_of(came[static_cast<std::size_t>(r)]);
        for (std::size_t k = 0; k < batch.size(); ++k) {
            if (!shared_with(k, r)) continue;
            VisitTiles part;
            if (r == ranks.rank)
                part = std::move(visits[k]);
            else
                reader(part);
            join(std::move(part), whole[k]);
        }
        reader.require_end();
    }
    visits = std::move(whole);
}

GradientEstimate finish_visit(const VisitedView& v, float share, VisitTiles tiles,
                              Iteration& report) {
    Stopwatch watch;
    const Binding binding = binding_of(v);
    const Film& film = binding.film();
    ViewState& own = v.state;
    own.backgrounds = std::move(tiles.rows);
    for_backgrounds(v.setup, key_of(v).seed, own,
                    [&](std::uint32_t half, const BackgroundVisit& b) {
                        add_background(film, v.workspace.near, b.options, b.iteration,
                                       tiles.backgrounds[half], own.backgrounds[half]);
                    });
    std::vector<Image> images =
        images_of_tiles(film, tiles.halves, own.estimator, v.workspace.estimator);
    tiles = {};
    report.image_seconds += watch.lap();
    GradientEstimate estimate = differentiate(v, share, binding, std::move(images), report);
    keep_bands(own_bands(v.setup, v.which), film, own);
    return estimate;
}

}  // namespace burnish
