#include "optimize/search_again.h"

#include <algorithm>
#include <optional>

#include "optimize/batch.h"
#include "optimize/exposure.h"
#include "optimize/option_table.h"
#include "optimize/ranks.h"
#include "optimize/search_choice.h"
#include "optimize/start_search.h"
#include "optimize/state_fields.h"

namespace burnish {

namespace {

/// How many searches come before an iteration, that for the start aside.
std::size_t searches_before(std::uint32_t iteration, const Options& options) {
    const std::uint32_t every = options.search_again, first = first_search(options);
    return every == 0 || iteration < first ? 0 : 1 + (iteration - first) / every;
}

bool has_costs(const State::Values& state) {
    return std::any_of(state.search_costs.begin(), state.search_costs.end(),
                       [](const SearchedCosts& c) { return !c.costs.empty(); });
}

/// With the regions of the search for the start.
SearchPlan plan_of(const Setup& setup, const SearchInput& input, const State::Values& state) {
    return make_search_plan(input.views, input.unknowns, setup.options.seed, state.search_effort);
}

/// As many passes as take about a twentieth of the time of the iterations between two searches.
std::uint32_t passes_of(const Setup& setup, const SearchPlan& plan, std::size_t views) {
    constexpr std::size_t kPasses = 80, kMinPasses = 4;
    const std::size_t passes = std::max(kMinPasses, kPasses * batch_size(setup) / views);
    return static_cast<std::uint32_t>(std::min<std::size_t>(plan.passes, passes));
}

std::vector<SearchedCosts> costs_of(std::vector<GroupSums> sums) {
    std::vector<SearchedCosts> costs;
    for (GroupSums& s : sums) costs.push_back({std::move(s.squares), std::move(s.costs)});
    return costs;
}

/// What fresh samples say in one of the views; nothing while its exposure is not known.
std::vector<SearchedCosts> search_view(const SearchPlan& plan, const SearchInput& input,
                                       const State::Values& state, std::size_t v) {
    // No group with a colour is searched again.
    const std::vector<GroupColors> none(plan.groups.size());
    const SearchView& s = input.views[v];
    const ViewState& own = state.views[input.fitted[v]];
    std::vector<GroupSums> sums;
    for (const SearchGroup& g : plan.groups) sums.push_back(make_sums(g));
    if (own.visits > 0 || !fits_exposure(s.exposure)) {
        const SearchView exposed = at_exposure(own.exposure, s);
        const std::size_t number = (state.searched_again.size() + 1) * input.views.size() + v;
        const SearchFrame frame =
            make_search_frame(plan, exposed, static_cast<std::uint32_t>(number));
        add_views({&frame, 1}, none, sums);
    }
    return costs_of(std::move(sums));
}

void add(const std::vector<double>& from, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}
void add(const std::vector<SearchedCosts>& from, std::vector<SearchedCosts>& to) {
    for (std::size_t g = 0; g < to.size(); ++g)
        add(from[g].squares, to[g].squares), add(from[g].costs, to[g].costs);
}

/// What all searches say of each group, this one of all views included, which are added in their
/// order: by one process as they are found.
std::vector<SearchedCosts> search_views(const Setup& setup, const SearchPlan& plan,
                                        const SearchInput& input, const State::Values& state) {
    const Ranks& ranks = setup.problem.ranks;
    std::vector<SearchedCosts> all = state.search_costs;
    std::vector<std::vector<SearchedCosts>> found(input.views.size());
    std::vector<int> owners;
    for (std::size_t v = 0; v < input.views.size(); ++v) {
        owners.push_back(setup.owners[setup.fitted[input.fitted[v]]]);
        if (owners.back() != ranks.rank) continue;
        std::vector<SearchedCosts> own = search_view(plan, input, state, v);
        if (ranks.count == 1)
            add(own, all);
        else
            found[v] = std::move(own);
    }
    if (ranks.count == 1) return all;
    share(ranks, owners, Recipient::kAll, found);
    for (const auto& view : found) add(view, all);
    return all;
}

/// What a search makes of a group.
struct NewChoice {
    GroupSums sums;                    ///< of all searches
    std::vector<Image> before, after;  ///< of each member: what was chosen, and what is now
};

/// known: of the searches before. all: with this one.
NewChoice choose_group(const SearchGroup& group, const SearchPlan& plan, const Scene& scene,
                       const SearchedCosts& known, SearchedCosts all) {
    const GroupSums sums{known.squares, {}, known.costs, {}};
    NewChoice choice{{std::move(all.squares), {}, std::move(all.costs), {}}, {}, {}};
    GroupChoice before = choose({plan, group, sums}, scene);
    choice.after = choose_again({plan, group, choice.sums}, before, scene).starts;
    choice.before = std::move(before.starts);
    return choice;
}

/// Returns how many texels start anew. Once more changes nothing.
std::size_t take_textures(const Setup& setup, const SearchPlan& plan, std::size_t group,
                          const SearchInput& input, const NewChoice& choice, State::Values& state) {
    const Ranks& ranks = setup.problem.ranks;
    std::size_t texels = 0;
    for (std::size_t m = 0; m < choice.after.size(); ++m) {
        const std::size_t i = input.indices[plan.groups[group].members[m]];
        Image& texture = state.theta.textures[i].values;
        const IndexRange own = own_range(texture.values.size(), ranks.rank, ranks.count);
        texels += restart(setup.unknowns[i].maps, choice.before[m], choice.after[m],
                          state.pyramids[i], texture, own.begin);
    }
    return texels;
}

}  // namespace

std::uint32_t first_search(const Options& options) {
    const std::uint32_t every = options.search_again;
    return every / 4 + (every % 4 > 0);
}

void keep_search(const Options& options, std::vector<GroupSums> sums, double effort,
                 State::Values& state) {
    state.search_effort = effort;
    if (options.search_again > 0) state.search_costs = costs_of(std::move(sums));
}

void search_again(const Setup& setup, State::Values& state, const StopQuestion& stop) {
    if (state.searched_again.size() >= searches_before(state.iteration, setup.options) ||
        !has_costs(state))
        return;
    const SearchInput input = search_input(setup);
    const Theta others = unsearched(setup, &state.theta);
    SearchPlan plan = plan_of(setup, input, state);
    plan.others = &others;
    plan.passes = passes_of(setup, plan, input.views.size());
    for (SearchGroup& g : plan.groups)
        if (!may_search_again(g)) g.candidates.clear();  // nothing is summed up at any
    std::vector<std::optional<NewChoice>> choices(plan.groups.size());
    {
        const Stoppable stoppable(stop);
        std::vector<SearchedCosts> all = search_views(setup, plan, input, state);
        for (std::size_t g = 0; g < choices.size(); ++g)
            if (!state.search_costs[g].costs.empty())
                choices[g] = choose_group(plan.groups[g], plan, scene_of(setup),
                                          state.search_costs[g], std::move(all[g]));
        state.searched_again.reserve(state.searched_again.size() + 1);
        agree(setup.problem.ranks, true);  // all have chosen: none stops from here on
    }
    SearchedAgain done{state.iteration, 0};
    for (std::size_t g = 0; g < choices.size(); ++g)
        if (choices[g]) done.texels += take_textures(setup, plan, g, input, *choices[g], state);
    // Nothing fails from here on.
    for (std::size_t g = 0; g < choices.size(); ++g)
        if (choices[g])
            state.search_costs[g] = {std::move(choices[g]->sums.squares),
                                     std::move(choices[g]->sums.costs)};
    state.searched_again.push_back(done);
}

bool are_search_costs(const Setup& setup, const State::Values& state) {
    if (state.search_costs.empty()) return true;
    if (!(state.search_effort >= 1 && state.search_effort <= kMaxSearchEffort)) return false;
    const SearchInput input = search_input(setup);
    if (input.unknowns.empty()) return false;
    const SearchPlan plan = plan_of(setup, input, state);
    return std::equal(state.search_costs.begin(), state.search_costs.end(), plan.groups.begin(),
                      plan.groups.end(), [](const SearchedCosts& c, const SearchGroup& g) {
                          const GroupSums sums = may_search_again(g) ? make_sums(g) : GroupSums{};
                          return c.costs.size() == sums.costs.size() &&
                                 c.squares.size() == sums.squares.size();
                      });
}

}  // namespace burnish
