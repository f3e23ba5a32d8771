#include "optimize/whole_state.h"

#include "burnish/error.h"
#include "optimize/iterate.h"

namespace burnish {

namespace {

/// Instead of a view's number.
constexpr std::size_t kNoMore = ~std::size_t{0};

int owner_of_view(const WholeState& state, std::size_t which) {
    return owner_of(state.ranks, which, state.own.views.size());
}

/// Of one of the others, until the first process asks for no more.
void serve_views(const WholeState& state) {
    for (std::size_t which = agree(state.ranks, kNoMore); which != kNoMore;
         which = agree(state.ranks, kNoMore)) {
        std::vector<std::string> messages(static_cast<std::size_t>(state.ranks.count));
        if (owner_of_view(state, which) == state.ranks.rank)
            ArchiveWriter{sink_into(messages.front())}(state.own.views[which]);
        state.ranks.exchange(std::move(messages));
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
        agree(state.ranks, kNoMore);
    } else {
        serve_views(state);
    }
    error = from_first(state.ranks, error);
    if (!error.empty()) throw OutputError(error);
}

std::string fetch_view(const WholeState& state, std::size_t which) {
    agree(state.ranks, which);
    const int owner = owner_of_view(state, which);
    std::vector<std::string> came =
        state.ranks.exchange(std::vector<std::string>(static_cast<std::size_t>(state.ranks.count)));
    return std::move(came[static_cast<std::size_t>(owner)]);
}

// As the fields of State::Values.
void fields(ArchiveWriter& archive, const WholeState& v) {
    archive(v.own.iteration, v.own.theta, v.own.pyramids, std::uint64_t{v.own.views.size()});
    for (std::size_t i = 0; i < v.own.views.size(); ++i) {
        if (owner_of_view(v, i) == v.ranks.rank)
            archive(v.own.views[i]);
        else
            archive.raw(fetch_view(v, i));
    }
    archive(v.own.patience, v.own.searched);
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
    archive(v.values.patience, v.values.searched);
}

}  // namespace burnish
