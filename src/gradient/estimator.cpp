#include "gradient/estimator.h"

#include <algorithm>

#include "core/variant.h"
#include "render/render.h"

namespace burnish {

namespace {

// Each estimator's two calls. To add an estimator: its overloads here; the visits below ask for
// them.

std::optional<KeptCache> cache_of(const PathCache& o) { return KeptCache{o}; }
template <class Options>
std::optional<KeptCache> cache_of(const Options& o) {
    if (o.image_window == 0) return {};
    return KeptCache{{.samples = o.image_samples, .window = o.image_window}, CacheUse::kImage};
}

ImageEstimate render_fresh(std::uint32_t samples, const Binding& binding, IterationKey key,
                           Images images) {
    RenderCounts counts;
    ImageEstimate estimate;
    const std::uint32_t halves = images == Images::kHalves ? 2 : 1;
    const std::uint32_t passes = std::max(1u, samples / halves);
    for (std::uint32_t half = 0; half < halves; ++half)
        estimate.images.push_back(
            render(unknown_part(binding, {seed_of_half(key.seed, half), Stream::kImage}, passes),
                   key.iteration, passes, &counts));
    estimate.rejected_samples = counts.rejected;
    return estimate;
}

/// Traces an iteration's passes into the path cache, no more than it keeps. Returns the number of
/// samples that were not finite.
std::size_t move_window(const PathCache& o, const PathCacheInput& input, PathCacheState& state,
                        EstimatorWorkspace& all) {
    const std::size_t rejected =
        trace_passes(input, fresh_passes(o.samples, all.cache.window), all.cache, state);
    // Drops old passes alone: the fresh ones fit.
    keep_window(all.cache.window, state, all.dropped);
    return rejected;
}

/// One image from each half of the path cache.
ImageEstimate shade_halves(const PathCache& o, const Binding& binding, IterationKey key,
                           PathCacheState& state, EstimatorWorkspace& all) {
    PathCacheWorkspace& workspace = all.cache;
    const PathCacheInput input{binding, key.seed, o.sequence};
    ImageEstimate estimate;
    estimate.rejected_samples = move_window(o, input, state, all);
    HalfImages halves = shade(input, state, workspace);
    for (Image& image : halves.images) estimate.images.push_back(std::move(image));
    estimate.rejected_records = halves.rejected;
    return estimate;
}

ImageEstimate image_of(const PathCache& o, const Binding& binding, IterationKey key,
                       PathCacheState& state, EstimatorWorkspace& workspace, Images) {
    return shade_halves(o, binding, key, state, workspace);
}

template <class Options, class State>
ImageEstimate image_of(const Options& o, const Binding& binding, IterationKey key, State& state,
                       EstimatorWorkspace& workspace, Images images) {
    const std::optional<KeptCache> cache = cache_of(o);
    if (!cache) return render_fresh(o.image_samples, binding, key, images);
    ImageEstimate estimate = shade_halves(cache->options, binding, key, state.image, workspace);
    if (images == Images::kAny) estimate.images = {mean_of(estimate.images[0], estimate.images[1])};
    return estimate;
}

GradientEstimate dense(const Binding& binding, GradientResult result,
                       EstimatorWorkspace& workspace) {
    make_dense(binding.theta, result.gradient, workspace.gradient);
    return {workspace.gradient, std::move(result.counts)};
}

GradientEstimate gradient_of(const MonteCarlo& o, const Binding& binding,
                             std::span<const Image> adjoints, IterationKey key,
                             MonteCarloState& state, EstimatorWorkspace& workspace) {
    return dense(binding,
                 estimate_gradient(o, binding, adjoints[0], key.seed, key.iteration, state),
                 workspace);
}

GradientEstimate gradient_of(const Reservoirs& o, const Binding& binding,
                             std::span<const Image> adjoints, IterationKey key,
                             ReservoirsState& state, EstimatorWorkspace& workspace) {
    return dense(binding,
                 estimate_gradient(o, binding, adjoints[0], key.seed, key.iteration, state,
                                   &workspace.replaced),
                 workspace);
}

GradientEstimate gradient_of(const PathCache& o, const Binding& binding,
                             std::span<const Image> adjoints, IterationKey key,
                             PathCacheState& state, EstimatorWorkspace& workspace) {
    const auto& bands = accumulate_bands({binding, key.seed, o.sequence}, state,
                                         {&adjoints.front(), &adjoints.back()}, workspace.cache);
    GradientCounts counts;
    counts.records = size_of(state, workspace.cache).records;
    return {bands.front().gradient, std::move(counts), bands};
}

PathCacheState state_of(const PathCache&) { return {}; }
ReservoirsState state_of(const Reservoirs&) { return {}; }
MonteCarloState state_of(const MonteCarlo&) { return {}; }

/// Calls body(options, state) with an estimator and its state.
template <class Body>
auto with_state(const Estimator& estimator, EstimatorState& state, const Body& body) {
    return std::visit(
        [&](const auto& options) {
            return body(options, std::get<decltype(state_of(options))>(state));
        },
        estimator);
}

std::uint32_t image_samples_of(const MonteCarlo& o) { return o.image_samples; }
std::uint32_t image_samples_of(const Reservoirs& o) { return o.image_samples; }
std::uint32_t image_samples_of(const PathCache& o) { return o.samples; }

}  // namespace

EstimatorState make_state(const Estimator& estimator) {
    return std::visit([](const auto& o) { return EstimatorState{state_of(o)}; }, estimator);
}

std::optional<KeptCache> kept_cache(const Estimator& estimator) {
    return std::visit([](const auto& o) { return cache_of(o); }, estimator);
}

PathCacheState& kept_cache(EstimatorState& state) {
    return match(
        state, [](PathCacheState& s) -> PathCacheState& { return s; },
        [](ReservoirsState& s) -> PathCacheState& { return s.image; },
        [](MonteCarloState& s) -> PathCacheState& { return s.image; });
}

namespace {

PixelStatistics* statistics(EstimatorState& state) {
    return match(
        state, [](PathCacheState&) -> PixelStatistics* { return nullptr; },
        [](ReservoirsState& s) -> PixelStatistics* { return &s.pixels; },
        [](MonteCarloState& s) -> PixelStatistics* { return &s.pixels; });
}

}  // namespace

EstimatorMark mark(EstimatorState& state) {
    const PixelStatistics* pixels = statistics(state);
    return {mark(kept_cache(state)), pixels ? *pixels : PixelStatistics{}};
}

void roll_back(EstimatorMark mark, EstimatorState& state, EstimatorWorkspace& workspace) {
    roll_back(mark.cache, std::move(workspace.dropped), kept_cache(state));
    if (PixelStatistics* pixels = statistics(state)) *pixels = std::move(mark.pixels);
    if (workspace.replaced)
        std::get<ReservoirsState>(state).history = std::move(*workspace.replaced);
    release(workspace);
}

EstimatorWorkspace make_workspace(const Estimator& estimator, const Binding& binding,
                                  const std::vector<char>& reaching, const IndexRange& bands) {
    EstimatorWorkspace workspace;
    if (const auto cache = kept_cache(estimator))
        workspace.cache = make_workspace(cache->options, binding, reaching, cache->use, bands);
    return workspace;
}

ImageEstimate estimate_image(const Estimator& estimator, const Binding& binding, IterationKey key,
                             EstimatorState& state, EstimatorWorkspace& workspace, Images images) {
    return with_state(estimator, state, [&](const auto& options, auto& own) {
        return image_of(options, binding, key, own, workspace, images);
    });
}

ImageTiles estimate_tiles(const Estimator& estimator, const Binding& binding, IterationKey key,
                          EstimatorState& state, EstimatorWorkspace& workspace) {
    const auto& o = std::get<PathCache>(estimator);
    auto& own = std::get<PathCacheState>(state);
    const PathCacheInput input{binding, key.seed, o.sequence};
    const std::size_t rejected = move_window(o, input, own, workspace);
    HalfTiles tiles = shade_tiles(input, own, workspace.cache);
    return {std::move(tiles.halves), rejected, tiles.rejected};
}

std::vector<Image> images_of_tiles(const Film& film, const std::array<TileImages, 2>& halves,
                                   const EstimatorState& state,
                                   const EstimatorWorkspace& workspace) {
    const auto& own = std::get<PathCacheState>(state);
    std::vector<Image> images;
    for (std::size_t h = 0; h < 2; ++h)
        images.push_back(half_image(film, own.halves[h], workspace.cache, halves[h]));
    return images;
}

GradientEstimate estimate_gradient(const Estimator& estimator, const Binding& binding,
                                   std::span<const Image> adjoints, IterationKey key,
                                   EstimatorState& state, EstimatorWorkspace& workspace) {
    return with_state(estimator, state, [&](const auto& options, auto& own) {
        return gradient_of(options, binding, adjoints, key, own, workspace);
    });
}

bool has_own_derivatives(const Estimator& estimator) {
    return !std::holds_alternative<PathCache>(estimator);
}

std::uint32_t image_samples(const Estimator& estimator) {
    return std::visit([](const auto& o) { return image_samples_of(o); }, estimator);
}

}  // namespace burnish
