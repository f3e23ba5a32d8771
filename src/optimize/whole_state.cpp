#include "optimize/whole_state.h"

#include <algorithm>

#include "burnish/error.h"
#include "optimize/iterate.h"

namespace burnish {

namespace {

/// What the first process asks for: bytes of a view, from one on.
struct Request {
    std::uint64_t which = 0, at = 0;
};
/// Instead of a view's number.
constexpr std::uint64_t kNoMore = ~std::uint64_t{0};

int owner_of_view(const WholeState& state, std::size_t which) {
    return owner_of(state.ranks, which, state.own.views.size());
}

/// The bytes [at, at + size) of a view, as far as there are so many. Arrays are passed over, not
/// copied.
std::string slice_of(const ViewState& view, std::uint64_t at, std::uint64_t size) {
    std::string slice;
    std::uint64_t begin = 0;  // of what comes next
    ArchiveWriter([&](const void* from, std::size_t count) {
        const std::uint64_t first = std::clamp(at, begin, begin + count);
        const std::uint64_t last = std::clamp(at + size, begin, begin + count);
        slice.append(static_cast<const char*>(from) + (first - begin), last - first);
        begin += count;
    })(view);
    return slice;
}

/// Of one of the others, until the first process asks for no more.
void serve_views(const WholeState& state) {
    for (Request r = agree(state.ranks, Request{}); r.which != kNoMore;
         r = agree(state.ranks, Request{})) {
        std::vector<std::string> messages(static_cast<std::size_t>(state.ranks.count));
        if (owner_of_view(state, r.which) == state.ranks.rank)
            messages.front() = slice_of(state.own.views[r.which], r.at, state.slice);
        state.ranks.exchange(std::move(messages));
    }
}

/// Of the first process.
std::string fetch_slice(const WholeState& state, const Request& request) {
    agree(state.ranks, request);
    std::vector<std::string> came =
        state.ranks.exchange(std::vector<std::string>(static_cast<std::size_t>(state.ranks.count)));
    return std::move(came[static_cast<std::size_t>(owner_of_view(state, request.which))]);
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
        agree(state.ranks, Request{kNoMore, 0});
    } else {
        serve_views(state);
    }
    error = from_first(state.ranks, error);
    if (!error.empty()) throw OutputError(error);
}

// As the fields of State::Values.
void fields(ArchiveWriter& archive, const WholeState& v) {
    archive(v.own.iteration, v.own.theta, v.own.pyramids, std::uint64_t{v.own.views.size()});
    for (std::size_t i = 0; i < v.own.views.size(); ++i) {
        if (owner_of_view(v, i) == v.ranks.rank) {
            archive(v.own.views[i]);
            continue;
        }
        std::string slice;
        std::uint64_t at = 0;
        do {
            slice = fetch_slice(v, {i, at});
            archive.raw(slice);
            at += slice.size();
        } while (slice.size() == v.slice);
    }
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
