// Searches during a run: a region that lies in the wrong valley is found out by fresh samples, what
// is right stays as descent has made it, and the state holds all that this follows from.
#include "optimize/search_again.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "burnish/error.h"
#include "core/parallel.h"
#include "optimize/floor_scene.h"
#include "optimize/recovered_textures.h"
#include "optimize/thread_ranks.h"

namespace burnish {
namespace {

using namespace test;

Options options_with(std::uint32_t search_again) {
    Options options;
    options.search_again = search_again;
    options.evaluation_samples = 2;
    options.stop.iterations = 3;
    return options;
}

constexpr std::size_t kCandidates = 10, kHalf = 7;  // of a roughness; 0.5 among them

/// The state of a run that a poor search began at 0.5 everywhere, a little for it and nothing else.
State::Values misled_state(const Problem& problem, const Options& options) {
    Problem half = problem;
    half.unknowns[0].start = 0.5f;
    const State from_half = Solver(half, options).state();
    State::Values state = Solver(problem, options).state().values();
    state.theta.textures[0] = from_half.values().theta.textures[0];
    state.pyramids[0] = from_half.values().pyramids[0];
    state.searched[0] = state.theta.textures[0].values;
    SearchedCosts& costs = state.search_costs.at(0);
    for (std::size_t i = 0; i < costs.costs.size(); ++i)
        costs.costs[i] = i % kCandidates == kHalf ? 0 : 1;
    std::fill(costs.squares.begin(), costs.squares.end(), 1);
    return state;
}

/// The seeded defect is a run that does not search again.
TEST(SearchAgain, LeavesAValleyThatFreshSamplesContradict) {
    const Scene scene = smooth_scene();
    const Problem problem = searched_problem(scene, SearchStart{});
    const Image truth = truth_of(scene, 0);
    const auto ends_right = [&](std::uint32_t search_again) {
        Options options = options_with(2);
        const State misled(misled_state(problem, options));
        options.search_again = search_again;
        Solver solver(problem, options, misled);
        EXPECT_GT(distance_of(solver.texture(0), truth), 0.3);
        solver.step();
        EXPECT_GT(distance_of(solver.texture(0), truth), 0.3) << "it comes before the second";
        solver.step();
        return distance_of(solver.texture(0), truth) < 0.1;
    };
    EXPECT_TRUE(ends_right(2));
    EXPECT_FALSE(ends_right(0));
}

/// Regions that no sample decided take their value once samples do, the first one, too, which they
/// had as a label without knowing.
TEST(SearchAgain, RegionsThatBecomeKnownTakeTheirValue) {
    const Problem problem = searched_problem(smooth_scene(), SearchStart{});
    const Options options = options_with(2);
    State::Values state = misled_state(problem, options);
    SearchedCosts& costs = state.search_costs.at(0);
    for (double& cost : costs.costs) cost *= 1e6;
    const std::size_t region = costs.squares.size() / 2;
    costs.squares[region] = 0.3;
    for (std::size_t k = 0; k < kCandidates; ++k)
        costs.costs[region * kCandidates + k] = k == 0 ? 0 : 1e6;
    Solver solver(problem, options, State(state));
    for (int i = 0; i < 2; ++i) solver.step();
    ASSERT_GE(solver.state().values().search_costs.at(0).squares[region], 0.5);
    const std::vector<float> texels = solver.texture(0).values;
    EXPECT_GT(std::count_if(texels.begin(), texels.end(), [](float v) { return v < 0.1f; }), 0);
}

/// Where all that is known is sure, texels keep what descent has made of them, bit by bit.
TEST(SearchAgain, KeepsWhatNoOtherValueBeats) {
    const Problem problem = searched_problem(smooth_scene(), SearchStart{});
    State::Values sure = misled_state(problem, options_with(2));
    for (double& cost : sure.search_costs[0].costs) cost *= 1e6;
    Solver again(problem, options_with(2), State(sure)),
        alone(problem, options_with(0), State(sure));
    for (int i = 0; i < 3; ++i) again.step(), alone.step();
    EXPECT_EQ(again.texture(0), alone.texture(0));
    EXPECT_EQ(again.state().values().searched_again, (std::vector<SearchedAgain>{{1, 0}}));
    EXPECT_TRUE(alone.state().values().searched_again.empty());
}

/// The seeded defect is a search whose half is kept: the next one adds it up again.
TEST(SearchAgain, OneThatIsStoppedBeginsAnew) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    const Options options = options_with(2);
    const State::Values misled = misled_state(problem, options);
    const burnish::Setup setup = make_setup(problem, options);
    State::Values at_once = misled;
    at_once.iteration = 1;
    State::Values stopped = at_once, twice = at_once;
    search_again(setup, at_once);
    ASSERT_EQ(at_once.searched_again.size(), 1u);
    std::atomic<int> asked = 0;
    EXPECT_THROW(search_again(setup, stopped, [&] { return ++asked > 3; }), Stopped);
    EXPECT_TRUE(stopped.search_costs == misled.search_costs && stopped.theta == misled.theta);
    search_again(setup, stopped);
    EXPECT_TRUE(stopped == at_once);
    twice.search_costs = at_once.search_costs;
    search_again(setup, twice);
    EXPECT_FALSE(twice == at_once);
}

TEST(SearchAgain, WhatItFindsIsKeptWhereNoSampleCame) {
    std::vector<Options> all(3, options_with(2));
    all[1].parameterization = Parameterization::kTexels;
    all[2].pyramid.weight_decay = 0;
    const Problem problem = searched_problem(smooth_scene(), SearchStart{});
    for (Options& options : all) {
        options.unvisited = Unvisited::kKeep;
        const burnish::Setup setup = make_setup(problem, options);
        State::Values state = misled_state(problem, options);
        state.iteration = 1;
        search_again(setup, state);
        ASSERT_GT(state.searched_again.at(0).texels, 0u);
        const Image kept = recovered_textures(setup, state)[0].values;
        EXPECT_EQ(kept, state.theta.textures[0].values);
        EXPECT_NE(kept, setup.unknowns[0].start);
        Solver solver(problem, options, State(misled_state(problem, options)));
        for (int i = 0; i < 3; ++i) solver.step();
        EXPECT_NO_THROW(Solver(problem, options, solver.state()));
    }
}

/// As the search for the start does.
TEST(SearchAgain, IsTheSameWhateverTheScaleOfAMask) {
    const Options options = options_with(2);
    const auto costs_under = [&](float weight) {
        Problem problem = searched_problem(smooth_scene(), SearchStart{});
        problem.views[0].mask = make_image(48, 48, 1, weight);
        State::Values state = misled_state(problem, options);
        state.iteration = 1;
        search_again(make_setup(problem, options), state);
        return state.search_costs.at(0).costs;
    };
    EXPECT_EQ(costs_under(std::ldexp(1.0f, -10)), costs_under(1));
}

/// Of a texture of as many texels with other channels.
TEST(SearchAgain, AStateWhoseStartsAreOfAnotherShapeIsRefused) {
    const auto problem = [](int channels) {
        Principled floor = metal();
        floor.base_color.texture = {0};
        return searched_problem(
            floor_scene(floor, {bitmap_of(16, channels, [](int, int, int) { return 0.3f; })}),
            SearchStart{});
    };
    const State gray = Solver(problem(1), options_with(2)).state();
    EXPECT_NO_THROW(Solver(problem(1), options_with(2), gray));
    EXPECT_THROW(Solver(problem(3), options_with(2), gray), InputError);
}

double sum_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// The first after a quarter of the iterations, each with samples of its own, added to those
/// before.
TEST(SearchAgain, AddsSamplesEverySoManyIterations) {
    const Problem problem = searched_problem(smooth_scene(), SearchStart{});
    Solver solver(problem, options_with(3));
    std::vector<SearchedCosts> costs{solver.state().values().search_costs[0]};
    for (int i = 0; i < 7; ++i) {
        solver.step();
        if (i == 1 || i == 4) costs.push_back(solver.state().values().search_costs[0]);
    }
    std::vector<std::uint32_t> iterations;
    const State end = solver.state();
    for (const SearchedAgain& s : end.values().searched_again) iterations.push_back(s.iteration);
    EXPECT_EQ(iterations, (std::vector<std::uint32_t>{1, 4}));
    for (std::size_t k = 1; k < 3; ++k)  // single regions gain or lose with the passes' distances
        EXPECT_NEAR(sum_of(costs[k].squares), static_cast<double>(k + 1) * sum_of(costs[0].squares),
                    0.02 * sum_of(costs[0].squares));
    std::size_t other = 0;
    for (std::size_t i = 0; i < costs[0].costs.size(); ++i)
        other += std::abs(costs[2].costs[i] - 2 * costs[1].costs[i] + costs[0].costs[i]) > 1e-6;
    EXPECT_GT(other, costs[0].costs.size() / 2) << "other random numbers";
}

/// Before its first visit nothing is known of an exposure that is fitted.
TEST(SearchAgain, LeavesOutAViewWhoseExposureIsNotKnown) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    problem.views.push_back(problem.views[0]);
    for (View& v : problem.views) v.exposure = FitExposure{};
    Options options = options_with(2);
    options.batch = 1;
    const burnish::Setup setup = make_setup(problem, options);
    Solver solver(problem, options);
    State::Values state = solver.state().values();
    state.iteration = 1;
    const double before = sum_of(state.search_costs[0].squares);
    search_again(setup, state);
    EXPECT_EQ(sum_of(state.search_costs[0].squares), before) << "none was visited";
    state = solver.state().values();
    state.iteration = 1, state.views[0].visits = 1;
    search_again(setup, state);
    EXPECT_NEAR(sum_of(state.search_costs[0].squares), 1.5 * before, 0.05 * before);
}

/// Two views, with two unknowns of two materials, one of them a colour.
Problem mixed_problem() {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    Scene scene =
        floor_scene(floor, {bitmap_of(16, 1, [](int x, int, int) { return x < 8 ? 0.08f : 0.15f; }),
                            bitmap_of(8, 3, [](int, int, int) { return 0.3f; })});
    Diffuse wall;
    wall.reflectance.texture = {1};
    scene.bsdfs.push_back(wall);
    scene.materials.push_back({"wall", {2}, {2}});
    scene.shapes.push_back({"wall", make_quad({-1, 1, 0}, {2, 0, 0}, {0, 0, 0.5f}), {2}, {}});
    Problem problem = searched_problem(scene, SearchStart{});
    for (View v : {problem.views[0], problem.views[0]}) {
        v.name = "view " + std::to_string(problem.views.size());
        problem.views.push_back(v);
    }
    problem.views[2].exposure = FitExposure{};
    return problem;
}

TEST(SearchAgain, IsTheSameForAnyNumberOfThreadsAndFromAnyState) {
    const Problem problem = mixed_problem();
    const Options options = options_with(3);
    const State misled(misled_state(problem, options));
    std::set<std::string> ends;
    std::vector<std::string> states;
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        Solver solver(problem, options, misled);
        for (int i = 0; i < 6; ++i) states.push_back(save_state(solver.state())), solver.step();
        ends.insert(save_state(solver.state()));
        EXPECT_TRUE(solver.state().values().search_costs[1].costs.empty()) << "of a colour";
        EXPECT_GT(solver.state().values().searched_again[0].texels, 0u);
    }
    for (const std::size_t from : {1, 2}) {  // the search comes between them
        Solver solver(problem, options, load_state(states[from]));
        while (solver.iterations() < 6) solver.step();
        ends.insert(save_state(solver.state()));
    }
    EXPECT_EQ(ends.size(), 1u);
}

TEST(SearchAgain, AnyNumberOfProcessesMakesTheSameBytes) {
    Problem problem = mixed_problem();
    Options options = options_with(3);
    options.batch = 3;
    const State misled(misled_state(problem, options));
    const Summary whole = solve(problem, options, misled);
    ASSERT_EQ(whole.searched_again.size(), 1u);
    EXPECT_GT(whole.searched_again[0].texels, 0u);
    on_ranks(2, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        const Summary found = solve(own, options, misled);
        EXPECT_EQ(found.searched_again, whole.searched_again);
        EXPECT_EQ(found.state.values().search_costs, whole.state.values().search_costs);
        EXPECT_EQ(found.state.values().theta, whole.state.values().theta);
        EXPECT_EQ(found.state.values().pyramids, whole.state.values().pyramids);
    });
}

TEST(SearchAgain, CostsOfOtherRegionsAreRefused) {
    const Problem problem = searched_problem(smooth_scene(), SearchStart{});
    const Options options = options_with(2);
    const State::Values whole = Solver(problem, options).state().values();
    const auto is_taken = [&](const auto& change) {
        State::Values state = whole;
        change(state);
        try {
            Solver(problem, options, State(state));
        } catch (const InputError&) {
            return false;
        }
        return true;
    };
    EXPECT_TRUE(is_taken([](State::Values&) {}));
    EXPECT_TRUE(is_taken([](State::Values& s) { s.search_costs.clear(); })) << "none follows";
    EXPECT_FALSE(is_taken([](State::Values& s) { s.search_costs[0].costs.pop_back(); }));
    EXPECT_FALSE(is_taken([](State::Values& s) { s.search_costs[0].squares.push_back(0); }));
    EXPECT_FALSE(is_taken([](State::Values& s) { s.search_costs.push_back({}); }));
    EXPECT_FALSE(is_taken([](State::Values& s) { s.search_effort = 1e9; }));
    EXPECT_FALSE(is_taken(
        [](State::Values& s) { s.search_effort = std::numeric_limits<double>::quiet_NaN(); }));
}

}  // namespace
}  // namespace burnish
