#include "optimize/whole_state.h"

#include <algorithm>

#include "burnish/error.h"
#include "optimize/iterate.h"
#include "optimize/shared_pyramid.h"

namespace burnish {

namespace {

/// What the first process asks for: bytes from one on, of a view or of an array of the pyramids
/// that lies in parts.
struct Request {
    std::uint64_t which = 0, at = 0;  ///< views first, then the arrays
    int owner = 0;
};
/// Instead of a view's number.
constexpr std::uint64_t kNoMore = ~std::uint64_t{0};

int owner_of_view(const WholeState& state, std::size_t which) {
    return owner_of(state.ranks, which, state.own.views.size());
}

/// Passes arrays over, but for the bytes [at, at + size) of what is written.
struct Slice {
    std::uint64_t at = 0, size = 0, begin = 0;  ///< begin: of what comes next
    std::string bytes = {};

    void take(const void* from, std::size_t count) {
        const std::uint64_t first = std::clamp(at, begin, begin + count);
        const std::uint64_t last = std::clamp(at + size, begin, begin + count);
        bytes.append(static_cast<const char*>(from) + (first - begin), last - first);
        begin += count;
    }
};

/// Calls body(array) for the entries that this process has of array `which`, all pyramids' counted.
template <class Body>
void with_array(const std::vector<PyramidState>& pyramids, std::uint64_t which, const Body& body) {
    std::uint64_t number = 0;
    for (const PyramidState& pyramid : pyramids)
        for_parted_arrays(pyramid, [&](const auto& array, std::size_t, std::size_t) {
            if (number++ == which) body(array);
        });
}

/// As many bytes as there are, of those that are asked for.
std::string slice_of(const WholeState& state, const Request& request) {
    Slice slice{request.at, state.slice};
    const auto sink = [&](const void* from, std::size_t count) { slice.take(from, count); };
    const std::size_t views = state.own.views.size();
    if (request.which < views)
        ArchiveWriter{sink}(state.own.views[request.which]);
    else
        with_array(state.own.pyramids, request.which - views,
                   [&](const auto& array) { sink(array.data(), array.size() * sizeof array[0]); });
    return std::move(slice.bytes);
}

/// Of one of the others, until the first process asks for no more.
void serve(const WholeState& state) {
    for (Request r = agree(state.ranks, Request{}); r.which != kNoMore;
         r = agree(state.ranks, Request{})) {
        std::vector<std::string> messages(static_cast<std::size_t>(state.ranks.count));
        if (r.owner == state.ranks.rank) messages.front() = slice_of(state, r);
        state.ranks.exchange(std::move(messages));
    }
}

/// Of the first process: what another one has, slice by slice.
void fetch(const WholeState& state, Request request, ArchiveWriter& archive) {
    std::size_t size = state.slice;
    for (; size == state.slice; request.at += size) {
        agree(state.ranks, request);
        const std::vector<std::string> came = state.ranks.exchange(
            std::vector<std::string>(static_cast<std::size_t>(state.ranks.count)));
        const std::string& slice = came[static_cast<std::size_t>(request.owner)];
        archive.raw(slice.data(), slice.size());
        size = slice.size();
    }
}

/// As the fields of PyramidState, for all of them. Arrays come in the order of for_parted_arrays.
void write_pyramids(ArchiveWriter& archive, const WholeState& state) {
    std::uint64_t which = state.own.views.size();
    archive(std::uint64_t{state.own.pyramids.size()});
    for (const PyramidState& pyramid : state.own.pyramids) {
        const auto array = [&](const auto& own, const Image& level, std::size_t per) {
            const std::size_t floats = level.index(0, level.height);
            if (is_part(own.size(), floats, per, state.ranks)) {
                archive(std::uint64_t{entries_of({0, floats}, per).size()});
                archive.raw(own.data(), own.size() * sizeof own[0]);
                for (int r = 1; r < state.ranks.count; ++r) fetch(state, {which, 0, r}, archive);
            } else {
                archive(own);
            }
            ++which;
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
            array(adam.gates, v, kDirtyBlock);
            archive(adam.mean_gate, adam.steps);
            array(adam.visited, v, kDirtyBlock);
        }
        const Image& finest = pyramid.levels.front().values;
        array(pyramid.visits, finest, static_cast<std::size_t>(finest.channels));
    }
}

}  // namespace

void drop_views_of_others(const Setup& setup, State::Values& state) {
    for (std::size_t i = 0; i < state.views.size(); ++i)
        if (!is_mine(setup, setup.fitted[i]))
            state.views[i] = make_view_state(setup, setup.fitted[i]);
}

void write_whole(const WholeState& state, const std::function<void()>& write) {
    if (state.ranks.count == 1) return write();
    std::string error;
    if (is_first(state.ranks)) {
        try {
            write();
        } catch (const std::exception& e) {  // the others wait
            error = e.what();
        }
        agree(state.ranks, Request{kNoMore});
    } else {
        serve(state);
    }
    error = from_first(state.ranks, error);
    if (!error.empty()) throw OutputError(error);
}

// As the fields of State::Values.
void fields(ArchiveWriter& archive, const WholeState& v) {
    archive(v.own.iteration, v.own.theta);
    write_pyramids(archive, v);
    archive(std::uint64_t{v.own.views.size()});
    for (std::size_t i = 0; i < v.own.views.size(); ++i)
        if (owner_of_view(v, i) == v.ranks.rank)
            archive(v.own.views[i]);
        else
            fetch(v, {i, 0, owner_of_view(v, i)}, archive);
    archive(v.own.patience, v.own.searched, v.own.search_effort, v.own.search_costs,
            v.own.searched_again);
}

void fields(ArchiveReader& archive, OwnState& v) {
    std::uint64_t count = 0;
    archive(v.values.iteration, v.values.theta, v.values.pyramids, count);
    v.values.views.clear();
    for (std::uint64_t i = 0; i < count; ++i) {
        ViewState view;
        archive(view);
        if (owner_of(v.ranks, i, count) != v.ranks.rank) view = {};
        v.values.views.push_back(std::move(view));
    }
    archive(v.values.patience, v.values.searched, v.values.search_effort, v.values.search_costs,
            v.values.searched_again);
}

}  // namespace burnish
