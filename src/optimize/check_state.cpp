#include "optimize/check_state.h"

#include <algorithm>
#include <cmath>

#include "burnish/error.h"
#include "image/whole.h"
#include "optimize/batch.h"
#include "optimize/iterate.h"
#include "optimize/owners.h"
#include "optimize/search_again.h"

namespace burnish {

namespace {

bool has_shape(const Image& image, int width, int height, int channels) {
    return image.width == width && image.height == height && image.channels == channels &&
           is_whole(image);
}

/// An array with one entry for each of something, or not made yet.
template <class T>
bool is_array_of(const std::vector<T>& array, std::size_t size) {
    return array.empty() || array.size() == size;
}

bool is_level(const LevelState& level, const Vec2<int>& size, int channels) {
    const AdamState& adam = level.adam;
    const std::size_t count = level.values.values.size();
    return has_shape(level.values, size.x, size.y, channels) && is_array_of(adam.mean, count) &&
           is_array_of(adam.square, count) && is_array_of(adam.noise, count) &&
           is_array_of(adam.roots, dirty_blocks_in(count)) &&
           is_array_of(adam.visited, dirty_blocks_in(count));
}

/// Whether it is the start, or, after another search, a value of each texel.
bool is_initial(const std::vector<float>& initial, const std::vector<float>& of_start,
                std::size_t floats, bool searched_again) {
    return initial == of_start || (searched_again && !of_start.empty() && initial.size() == floats);
}

bool is_pyramid(const UnknownTexture& unknown, const PyramidState& pyramid, bool searched_again) {
    const PyramidState start = encode(unknown.maps, unknown.start, true);
    const bool asked = unknown.adam.weight_decay > 0;
    bool fits = pyramid.levels.size() == start.levels.size() &&
                pyramid.visits.size() == start.visits.size();
    for (std::size_t i = 0; fits && i < start.levels.size(); ++i)
        fits = is_level(pyramid.levels[i], unknown.maps.sizes[i], unknown.start.channels) &&
               ((!asked && pyramid.levels[i].adam.initial.empty()) ||
                is_initial(pyramid.levels[i].adam.initial, start.levels[i].adam.initial,
                           start.levels[i].values.values.size(), searched_again));
    return fits;
}

bool is_theta(const Setup& setup, const Theta& theta) {
    return std::equal(theta.textures.begin(), theta.textures.end(), setup.unknowns.begin(),
                      setup.unknowns.end(), [](const ThetaTexture& t, const UnknownTexture& u) {
                          return t.texture == u.texture && has_shape_of(t.values, u.start);
                      });
}

/// Whether a start is there exactly where one was searched.
bool is_searched(const Setup& setup, const std::vector<Image>& starts) {
    return std::equal(starts.begin(), starts.end(), setup.unknowns.begin(), setup.unknowns.end(),
                      [](const Image& start, const UnknownTexture& u) {
                          return u.start_kind == StartKind::kSearched ? start == u.start
                                                                      : start == Image{};
                      });
}

/// Whole, or the rows of the bands.
bool is_background(const Background& background, const Film& film, const IndexRange& bands) {
    if (!is_whole(background)) return false;
    if (background.mean.width == 0) return true;
    const int height = background.mean.height;
    const auto whole = static_cast<std::size_t>(film.crop_height);
    return (height == film.crop_height ||
            static_cast<std::size_t>(height) == items_of(bands, whole).size()) &&
           background.mean.width == film.crop_width;
}

bool is_statistics(const PixelStatistics& pixels, const Film& film) {
    return is_array_of(pixels.seen, static_cast<std::size_t>(pixels_of(film))) &&
           pixels.squares.size() == pixels.seen.size() &&
           pixels.counts.size() == pixels.seen.size();
}

/// Whether a BSDF has unknowns.
bool has_unknowns(BsdfId bsdf, const Binding& binding) {
    const auto i = static_cast<std::size_t>(bsdf.value);
    return i < binding.unknown_bsdfs.size() && binding.unknown_bsdfs[i];
}

/// Whether a sample was traced at one of so many visits.
bool is_camera_sample(const HistorySample& s, std::uint32_t passes, std::uint32_t visits) {
    const CameraSample& camera = s.path.camera;
    return camera.iteration < visits && camera.pass < passes &&
           s.record.film_pass == film_pass(camera, passes);
}

bool is_sample(const HistorySample& s, const Binding& binding) {
    if (s.key.slot >= binding.theta.textures.size()) return false;
    const Image& texels = binding.theta.textures[s.key.slot].values;
    const TriangleTable& triangles = binding.traced.geometry->triangles;
    return s.key.texel < texels.values.size() / static_cast<std::size_t>(texels.channels) &&
           s.path.camera.pixel < pixels_of(binding.film()) &&
           s.record.pixel < pixels_of(binding.film()) && has_unknowns(s.record.bsdf, binding) &&
           (has_bounces(binding.scene()) || is_hit(binding.scene(), triangles, s.hit));
}

/// Whether each path has a list of vertices that scatter by unknowns; none has where they are not
/// kept.
bool are_others(const PathVertices& others, std::size_t paths, const Binding& binding) {
    return others.ends.size() == paths && std::ranges::is_sorted(others.ends) &&
           others.vertices.size() == (others.ends.empty() ? 0 : others.ends.back()) &&
           std::ranges::all_of(others.vertices, [&](const PathVertex& v) {
               return has_unknowns(v.bsdf, binding) && std::isfinite(v.uv.x) &&
                      std::isfinite(v.uv.y);
           });
}

/// By texel, at most one of each sign.
bool are_sorted(const std::vector<HistorySample>& samples) {
    const auto key = [](const HistorySample& s) { return s.key; };
    if (!std::ranges::is_sorted(samples, {}, key)) return false;
    for (std::size_t i = 2; i < samples.size(); ++i)
        if (samples[i].key == samples[i - 2].key) return false;
    return true;
}

bool is_history(const Reservoirs& options, const History& history, const Setup& setup,
                const Binding& binding, std::uint32_t visits) {
    const std::size_t paths = keeps_vertices(options, binding.scene()) ? history.samples.size() : 0;
    if (!are_others(history.others, paths, binding)) return false;
    if (!(history.confidence > 0)) return history.samples.empty();
    const Film& film = binding.film();
    const std::uint32_t passes =
        passes_per_iteration({options.samples, options.adaptive_sampling, 0, false});
    return is_theta(setup, history.theta) &&
           has_shape(history.normalized_adjoint, film.crop_width, film.crop_height, 3) &&
           are_sorted(history.samples) &&
           std::ranges::all_of(history.samples, [&](const HistorySample& s) {
               return is_camera_sample(s, passes, visits) && is_sample(s, binding);
           });
}

bool is_run(const RecordRun& run, std::size_t blocks, const Binding& binding) {
    return run.begin <= run.end && run.end <= blocks && has_unknowns(run.bsdf, binding);
}

template <class Block>
bool are_in_tile(const std::vector<Block>& blocks, const Tile& tile) {
    const int pixels = tile.width * tile.height;
    return std::all_of(blocks.begin(), blocks.end(), [&](const Block& block) {
        return std::all_of(block.pixel.begin(), block.pixel.end(),
                           [&](std::uint16_t pixel) { return pixel < pixels; });
    });
}

bool are_chains(const TileRecords& records) {
    return (records.chains.empty() || records.chains.back().is_last()) &&
           std::all_of(records.chains.begin(), records.chains.end(), [&](const ChainLink& link) {
               return link.block() < records.vertices.size();
           });
}

bool is_tile(const TileRecords& records, const Tile& tile, const Binding& binding) {
    const bool bounces = has_bounces(binding.scene());
    const std::size_t blocks = bounces ? records.vertices.size() : records.blocks.size();
    return (bounces ? records.blocks.empty() : records.vertices.empty()) && are_chains(records) &&
           are_in_tile(records.blocks, tile) && are_in_tile(records.vertices, tile) &&
           std::all_of(records.runs.begin(), records.runs.end(),
                       [&](const RecordRun& run) { return is_run(run, blocks, binding); });
}

bool is_cache(const std::optional<KeptCache>& kept, const PathCacheState& cache,
              const Binding& binding) {
    if (!kept) return cache == PathCacheState{};
    const auto tiles = make_cache_tiles(binding.film(), reaching_pixels(binding));
    const auto is_pass = [&](const CachedPass& pass) {
        return std::equal(pass.tiles.begin(), pass.tiles.end(), tiles.begin(), tiles.end(),
                          [&](const TileRecords& records, const CacheTile& tile) {
                              return is_tile(records, tile.tile, binding);
                          });
    };
    return std::all_of(cache.halves.begin(), cache.halves.end(), [&](const CacheHalf& half) {
        return std::all_of(half.passes.begin(), half.passes.end(), is_pass);
    });
}

// Of each estimator. To add one: its overload here; the visit below asks for it.

bool is_state(const MonteCarlo& options, const ViewState& view, const Setup&,
              const Binding& binding) {
    const auto* own = std::get_if<MonteCarloState>(&view.estimator);
    return own && is_statistics(own->pixels, binding.film()) &&
           is_cache(kept_cache(options), own->image, binding);
}

bool is_state(const Reservoirs& options, const ViewState& view, const Setup& setup,
              const Binding& binding) {
    const auto* own = std::get_if<ReservoirsState>(&view.estimator);
    return own && is_statistics(own->pixels, binding.film()) &&
           is_history(options, own->history, setup, binding, view.visits) &&
           is_cache(kept_cache(options), own->image, binding);
}

bool is_state(const PathCache& options, const ViewState& view, const Setup&,
              const Binding& binding) {
    const auto* own = std::get_if<PathCacheState>(&view.estimator);
    return own && is_cache(kept_cache(options), *own, binding);
}

/// Whether the iterations have visited the view as often as they have each one at least, or once
/// more: the state of one of several processes knows of its own views alone.
bool has_its_visits(const Setup& setup, std::size_t which, const State::Values& state) {
    const std::size_t min = std::size_t{state.iteration} * batch_size(setup) / setup.fitted.size();
    const std::size_t visits = state.views[which].visits;
    return own_bands(setup, which).empty() || (visits >= min && visits <= min + 1);
}

bool is_view_state(const Setup& setup, std::size_t which, const State::Values& state) {
    const ViewState& view = state.views[which];
    const Binding binding(scene_of(setup, setup.fitted[which]), state.theta);
    const auto fits = [&](const Background& b) {
        return is_background(b, binding.film(), own_bands(setup, which));
    };
    return view.backgrounds.size() ==
               make_view_state(setup, setup.fitted[which]).backgrounds.size() &&
           std::all_of(view.backgrounds.begin(), view.backgrounds.end(), fits) &&
           std::all_of(view.exposure.begin(), view.exposure.end(),
                       [](float e) { return e > 0 && std::isfinite(e); }) &&
           std::visit([&](const auto& own) { return is_state(own, view, setup, binding); },
                      setup.options.estimator);
}

}  // namespace

bool has_shape_of(const Image& image, const Image& other) {
    return has_shape(image, other.width, other.height, other.channels);
}

void require_state_of(const Setup& setup, const State::Values& state) {
    bool fits = is_theta(setup, state.theta) && is_searched(setup, state.searched) &&
                state.views.size() == setup.fitted.size() &&
                state.pyramids.size() == setup.unknowns.size();
    for (std::size_t i = 0; fits && i < setup.unknowns.size(); ++i)
        fits = is_pyramid(setup.unknowns[i], state.pyramids[i], !state.searched_again.empty());
    for (std::size_t i = 0; fits && i < state.views.size(); ++i)
        fits = has_its_visits(setup, i, state) &&
               (own_bands(setup, i).empty() || is_view_state(setup, i, state));
    if (fits && are_search_costs(setup, state)) return;
    throw InputError(
        "the state is that of another problem or of other options: expected the same scene, "
        "views, estimator, loss, unknowns with their starts, pyramid.levels and batch; of pgris, "
        "gris, pris or ris any of them with the same samples, adaptive_sampling and shift; "
        "pyramid.weight_decay 0 where it was 0, and an image_window above 0 where it was above 0");
}

}  // namespace burnish
