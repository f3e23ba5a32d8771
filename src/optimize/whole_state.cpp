#include "optimize/whole_state.h"

#include <fmt/format.h>

#include <exception>

#include "optimize/iterate.h"
#include "optimize/owners.h"
#include "optimize/pieces.h"
#include "optimize/shared_pyramid.h"

namespace burnish {

namespace {

/// What the first process takes from another one at once: a view, a part of it, or an array of the
/// pyramids that lies in parts.
struct Piece {
    std::size_t which = 0;   ///< views first, then the arrays
    std::uint32_t part = 0;  ///< of a view whose bands are shared out: see write_part
};

IndexRange bands_of_view(const WholeState& state, std::size_t which, int rank) {
    const std::vector<ViewState>& views = state.own.views;
    return bands_of(state.ranks, rank, which, views.size(), shares_bands(views[which].estimator));
}

/// Those that have bands of a view, in order.
std::vector<int> owners_of_view(const WholeState& state, std::size_t which) {
    std::vector<int> owners;
    for (int r = 0; r < state.ranks.count; ++r)
        if (!bands_of_view(state, which, r).empty()) owners.push_back(r);
    return owners;
}

/// A view without its records and its backgrounds' rows.
ViewState outline_of(const ViewState& view) {
    ViewState outline;
    outline.visits = view.visits, outline.exposure = view.exposure;
    PathCacheState cache;
    for (std::size_t h = 0; h < 2; ++h) {
        const CacheHalf& half = std::get<PathCacheState>(view.estimator).halves[h];
        cache.halves[h].passes_traced = half.passes_traced;
        for (const CachedPass& p : half.passes)
            cache.halves[h].passes.push_back(
                {p.film_pass, std::vector<TileRecords>(p.tiles.size())});
    }
    outline.estimator = std::move(cache);
    for (const Background& b : view.backgrounds) {
        const Image& mean = b.mean;
        outline.backgrounds.push_back({{mean.width, mean.height, mean.channels, {}}, {}, b.passes});
    }
    return outline;
}

/// Writes a part of what a process has of a view: the first is its outline; then come the records
/// of each pass, and the mean and the counts of each background.
void write_part(const ViewState& view, const IndexRange& bands, std::uint32_t part,
                ArchiveWriter& archive) {
    if (part == 0) return archive(outline_of(view));
    std::size_t number = part - 1;
    for (const CacheHalf& half : std::get<PathCacheState>(view.estimator).halves) {
        if (number < half.passes.size()) {
            const std::vector<TileRecords>& tiles = half.passes[number].tiles;
            const IndexRange own = tiles_of(bands, tiles.size());
            for (std::size_t i = own.begin; i < own.end; ++i) archive(tiles[i]);
            return;
        }
        number -= half.passes.size();
    }
    const Background& b = view.backgrounds[number / 2];
    if (number % 2 == 0)
        archive.raw(b.mean.values.data(), b.mean.values.size() * sizeof(float));
    else
        archive.raw(b.counts.data(), b.counts.size() * sizeof b.counts[0]);
}

std::uint32_t parts_of(const ViewState& view) {
    std::size_t parts = 1 + 2 * view.backgrounds.size();
    for (const CacheHalf& half : std::get<PathCacheState>(view.estimator).halves)
        parts += half.passes.size();
    return static_cast<std::uint32_t>(parts);
}

/// Calls body(array) for the entries that this process has of array `which`, all pyramids' counted.
template <class Body>
void with_array(const std::vector<PyramidState>& pyramids, std::size_t which, const Body& body) {
    std::size_t number = 0;
    for (const PyramidState& pyramid : pyramids)
        for_parted_arrays(pyramid, [&](const auto& array, std::size_t, std::size_t) {
            if (number++ == which) body(array);
        });
}

/// Whether each array of the pyramids lies in parts, as the first process sees it.
std::string parted_arrays(const WholeState& state) {
    std::string flags;
    for (const PyramidState& pyramid : state.own.pyramids)
        for_parted_arrays(pyramid, [&](const auto& array, std::size_t floats, std::size_t per) {
            flags += static_cast<char>(is_part(array.size(), floats, per, state.ranks));
        });
    return flags;
}

/// What one of the others has, in the order in which the first process takes it.
std::vector<Piece> pieces_of(const WholeState& state, const std::string& parted) {
    std::vector<Piece> pieces;
    const std::size_t views = state.own.views.size();
    for (std::size_t i = 0; i < parted.size(); ++i)
        if (parted[i]) pieces.push_back({views + i});
    for (std::size_t v = 0; v < views; ++v) {
        if (bands_of_view(state, v, state.ranks.rank).empty()) continue;
        const bool is_shared = owners_of_view(state, v).size() > 1;
        const std::uint32_t parts = is_shared ? parts_of(state.own.views[v]) : 1;
        for (std::uint32_t part = 0; part < parts; ++part) pieces.push_back({v, part});
    }
    return pieces;
}

void write_piece(const WholeState& state, const Piece& piece, const ByteSink& sink) {
    const std::size_t views = state.own.views.size();
    ArchiveWriter archive(sink);
    if (piece.which < views && owners_of_view(state, piece.which).size() > 1)
        write_part(state.own.views[piece.which],
                   bands_of_view(state, piece.which, state.ranks.rank), piece.part, archive);
    else if (piece.which < views)
        archive(state.own.views[piece.which]);
    else
        with_array(state.own.pyramids, piece.which - views,
                   [&](const auto& array) { sink(array.data(), array.size() * sizeof array[0]); });
}

/// What one of its owners has of a view whose bands are shared out.
void take_part(const WholeState& state, const Piece& piece, int owner, TakenPieces& others,
               ArchiveWriter& archive) {
    if (owner != state.ranks.rank) return take_piece(others, owner, archive);
    write_part(state.own.views[piece.which], bands_of_view(state, piece.which, owner), piece.part,
               archive);
}

/// The outlines that the owners have of a view.
std::vector<ViewState> outlines_of(const WholeState& state, std::size_t which,
                                   const std::vector<int>& owners, TakenPieces& others) {
    std::vector<ViewState> outlines;
    for (const int owner : owners) {
        std::string bytes;
        ArchiveWriter writer(sink_into(bytes));
        take_part(state, {which}, owner, others, writer);
        reader_of(bytes)(outlines.emplace_back());
    }
    return outlines;
}

/// As the fields of ViewState, from several owners.
void write_shared_view(ArchiveWriter& archive, const WholeState& state, std::size_t which,
                       const std::vector<int>& owners, TakenPieces& others) {
    const std::vector<ViewState> outlines = outlines_of(state, which, owners, others);
    const ViewState& view = outlines.front();
    std::uint32_t part = 0;
    const auto next_part = [&] {
        ++part;
        for (const int owner : owners) take_part(state, {which, part}, owner, others, archive);
    };
    archive(view.visits, static_cast<std::uint32_t>(view.estimator.index()));
    for (const CacheHalf& half : std::get<PathCacheState>(view.estimator).halves) {
        archive(std::uint64_t{half.passes.size()});
        for (const CachedPass& pass : half.passes) {
            archive(pass.film_pass, std::uint64_t{pass.tiles.size()});
            next_part();
        }
        archive(half.passes_traced);
    }
    archive(std::uint64_t{view.backgrounds.size()});
    for (std::size_t b = 0; b < view.backgrounds.size(); ++b) {
        Image mean = view.backgrounds[b].mean;
        mean.height = 0;
        for (const ViewState& outline : outlines) mean.height += outline.backgrounds[b].mean.height;
        const std::uint64_t floats = mean.index(0, mean.height);
        archive(mean.width, mean.height, mean.channels, floats);
        next_part();
        archive(std::uint64_t{mean.channels > 0 ? floats / 3 : 0});
        next_part();
        archive(view.backgrounds[b].passes);
    }
    archive(view.exposure);
}

void write_view(ArchiveWriter& archive, const WholeState& state, std::size_t which,
                TakenPieces& others) {
    const std::vector<int> owners = owners_of_view(state, which);
    if (owners.size() > 1)
        write_shared_view(archive, state, which, owners, others);
    else if (owners.front() == state.ranks.rank)
        archive(state.own.views[which]);
    else
        take_piece(others, owners.front(), archive);
}

void read_cache(ArchiveReader& archive, const IndexRange& bands, PathCacheState& cache) {
    for (CacheHalf& half : cache.halves) {
        std::uint64_t passes = 0;
        for (archive(passes); passes > 0; --passes) {
            CachedPass pass;
            archive(pass);
            keep_bands(bands, pass);
            half.passes.push_back(std::move(pass));
        }
        archive(half.passes_traced);
    }
}

/// Of what a file holds.
Background checked_rows(const ArchiveReader& archive, const Background& background,
                        const IndexRange& bands) {
    const Image& mean = background.mean;
    if (!is_whole(background))
        archive.fail(
            fmt::format("a background of {} x {} x {} with {} values and {} counts", mean.width,
                        mean.height, mean.channels, mean.values.size(), background.counts.size()),
            "a count for each pixel of three values");
    return rows_of(background, items_of(bands, static_cast<std::size_t>(mean.height)));
}

/// As the fields of ViewState, of which a process keeps what is its own.
ViewState read_view(ArchiveReader& archive, const Ranks& ranks, std::size_t which,
                    std::size_t views) {
    ViewState view;
    std::uint32_t estimator = 0;
    archive(view.visits, estimator);
    const bool shared = estimator == EstimatorState(PathCacheState{}).index();
    const IndexRange bands = bands_of(ranks, ranks.rank, which, views, shared);
    if (shared)
        read_cache(archive, bands, view.estimator.emplace<PathCacheState>());
    else
        archive.alternative(estimator, view.estimator);
    archive(view.backgrounds, view.exposure);
    if (bands.empty()) return {};
    if (bands != kAllBands)
        for (Background& b : view.backgrounds) b = checked_rows(archive, b, bands);
    return view;
}

/// As the fields of PyramidState, for all of them. Arrays come in the order of for_parted_arrays.
void write_pyramids(ArchiveWriter& archive, const WholeState& state, TakenPieces& others) {
    archive(std::uint64_t{state.own.pyramids.size()});
    for (const PyramidState& pyramid : state.own.pyramids) {
        const auto array = [&](const auto& own, const Image& level, std::size_t per) {
            const std::size_t floats = level.index(0, level.height);
            if (is_part(own.size(), floats, per, state.ranks)) {
                archive(std::uint64_t{entries_of({0, floats}, per).size()});
                archive.raw(own.data(), own.size() * sizeof own[0]);
                for (int r = 1; r < state.ranks.count; ++r) take_piece(others, r, archive);
            } else {
                archive(own);
            }
        };
        archive(std::uint64_t{pyramid.levels.size()});
        for (const LevelState& level : pyramid.levels) {
            const Image& v = level.values;
            const AdamState& adam = level.adam;
            archive(v.width, v.height, v.channels);
            if (&level == &pyramid.levels.front())
                array(v.values, v, 1);
            else
                archive(v.values);
            for (const auto* moments : {&adam.mean, &adam.square, &adam.noise, &adam.initial})
                array(*moments, v, 1);
            array(adam.roots, v, kDirtyBlock);
            archive(adam.mean_root, adam.steps);
            array(adam.visited, v, kDirtyBlock);
        }
        const Image& finest = pyramid.levels.front().values;
        array(pyramid.visits, finest, static_cast<std::size_t>(finest.channels));
    }
}

}  // namespace

void drop_views_of_others(const Setup& setup, State::Values& state) {
    for (std::size_t i = 0; i < state.views.size(); ++i) {
        const IndexRange bands = own_bands(setup, i);
        if (bands.empty())
            state.views[i] = make_view_state(setup, setup.fitted[i]);
        else
            keep_bands(bands, scene_of(setup, setup.fitted[i]).film, state.views[i]);
    }
}

void write_whole(const WholeState& state, const std::function<void()>& write) {
    if (state.ranks.count == 1) return write();
    const std::string parted = from_first(state.ranks, parted_arrays(state));
    std::exception_ptr caught;
    if (is_first(state.ranks)) {
        try {
            write();
        } catch (const FailedElsewhere&) {
            throw;
        } catch (...) {  // the others wait
            caught = std::current_exception();
        }
        end_pieces(state.ranks);
    } else {
        const std::vector<Piece> pieces = pieces_of(state, parted);
        give_pieces(state.ranks, {pieces.size(), [&](std::size_t i, const ByteSink& sink) {
                                      write_piece(state, pieces[i], sink);
                                  }});
    }
    throw_from_first(state.ranks, caught);
}

void fields(ArchiveWriter& archive, const WholeState& v) {
    TakenPieces others{v.ranks, v.slice};
    const auto pyramids = [&] { write_pyramids(archive, v, others); };
    const auto views = [&] {
        archive(std::uint64_t{v.own.views.size()});
        for (std::size_t i = 0; i < v.own.views.size(); ++i) write_view(archive, v, i, others);
    };
    state_fields(archive, v.own, pyramids, views);
}

void fields(ArchiveReader& archive, OwnState& v) {
    const auto pyramids = [&] { archive(v.values.pyramids); };
    const auto views = [&] {
        std::uint64_t count = 0;
        archive(count);
        v.values.views.clear();
        for (std::uint64_t i = 0; i < count; ++i)
            v.values.views.push_back(read_view(archive, v.ranks, i, count));
    };
    state_fields(archive, v.values, pyramids, views);
}

}  // namespace burnish
