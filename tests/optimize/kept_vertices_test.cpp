// Runs whose reservoirs keep the vertices of paths, in the room where light bounces: the same bytes
// for any number of threads and after loading; states whose vertices, or under direct light hits,
// cannot be are refused; memory.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "core/parallel.h"
#include "gradient/room.h"
#include "optimize/memory.h"
#include "optimize/small_problem.h"
#include "optimize/state.h"
#include "optimize/state_cases.h"

namespace burnish {
namespace {

Options keeping(Shift shift) {
    Reservoirs r;
    r.image_samples = 4, r.samples = 2, r.shift = shift;
    Options options;
    options.estimator = r, options.seed = 9;
    return options;
}

Problem room_problem() { return test::problem_of(test::make_room()); }

State room_after(std::uint32_t iterations, const Options& options) {
    Solver solver(room_problem(), options);
    test::step_to(iterations, solver);
    return solver.state();
}

History& history_of(State::Values& state) {
    return std::get<ReservoirsState>(state.views[0].estimator).history;
}

TEST(KeptVertices, AreTheSameForAnyNumberOfThreads) {
    const Options options = keeping(Shift::kIdentity);
    const auto bytes_with = [&](int threads) {
        const ThreadLimit limit(threads);
        tbb::task_arena arena(threads);
        return arena.execute([&] { return save_state(room_after(4, options)); });
    };
    const std::string one = bytes_with(1);
    for (const int threads : {2, 3, 5}) EXPECT_TRUE(bytes_with(threads) == one) << threads;
}

TEST(KeptVertices, GoOnAfterLoading) {
    const Options options = keeping(Shift::kIdentity);
    const State stored = room_after(test::kStored, options);
    State::Values values = stored.values();
    EXPECT_FALSE(history_of(values).others.vertices.empty());
    const State loaded = load_state(save_state(stored));
    EXPECT_TRUE(loaded == stored);
    Solver on(room_problem(), options, loaded);
    test::step_to(test::kAll, on);
    EXPECT_TRUE(on.state() == room_after(test::kAll, options));
}

TEST(KeptVertices, ThatCannotBeAreRefused) {
    const Options options = keeping(Shift::kIdentity);
    const State stored = room_after(2, options);
    const auto error_with = [&](const auto& damage, const Options& under) {
        State::Values values = stored.values();
        damage(history_of(values));
        const State state{std::move(values)};
        return test::error_of([&] { Solver(room_problem(), under, state); });
    };
    const auto expect_refused = [&](const auto& damage) {
        EXPECT_NE(error_with(damage, options).find("another problem"), std::string::npos);
    };
    EXPECT_EQ(error_with([](History&) {}, options), "");
    expect_refused([](History& h) { h.others = {}; });
    expect_refused([](History& h) { h.others.ends.pop_back(); });
    expect_refused([](History& h) { h.others.vertices.pop_back(); });
    expect_refused([](History& h) { h.others.vertices.push_back(h.others.vertices.back()); });
    expect_refused([](History& h) { h.others.ends[3] = ~0u; });
    expect_refused([](History& h) { h.others.vertices[5].bsdf = {2}; });  // a constant one
    expect_refused([](History& h) { h.others.vertices[5].bsdf = {-7}; });
    expect_refused([](History& h) { h.others.vertices[5].uv.x = NAN; });
    EXPECT_NE(error_with([](History&) {}, keeping(Shift::kReplay)), "");
}

TEST(KeptHits, ThatCannotBeAreRefused) {
    const Problem problem = test::problem_of(test::small_scene_of(16));
    const Options options = keeping(Shift::kReplay);
    Solver solver(problem, options);
    test::step_to(2, solver);
    const State stored = solver.state();
    const auto error_with = [&](const auto& damage) {
        State::Values values = stored.values();
        damage(history_of(values).samples.at(7).hit);
        const State state{std::move(values)};
        return test::error_of([&] { Solver(problem, options, state); });
    };
    EXPECT_EQ(error_with([](Hit&) {}), "");
    const auto expect_refused = [&](const auto& damage) {
        EXPECT_NE(error_with(damage).find("another problem"), std::string::npos);
    };
    expect_refused([](Hit& h) { h.shape = -1; });
    expect_refused([](Hit& h) { h.shape = 3; });
    expect_refused([](Hit& h) { h.primitive = 2; });
    expect_refused([](Hit& h) { h.primitive = -2; });
    expect_refused([](Hit& h) { h.u = NAN; });
    expect_refused([](Hit& h) { h.v = 1e30f; });
    expect_refused([](Hit& h) { h.distance = -1; });
    expect_refused([](Hit& h) { h.distance = INFINITY; });
}

TEST(KeptVertices, AreWithinTheMemoryEstimate) {
    const Scene scene = test::make_room();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const std::vector<std::vector<char>> reaching = reaching_pixels({&traced, 1}, theta);
    const auto estimate = [&](Shift shift) {
        return estimate_memory(keeping(shift).estimator, {{&traced, 1}, {}, reaching}, {}, theta, 4)
            .samples;
    };
    State::Values values = room_after(8, keeping(Shift::kIdentity)).values();
    const History& history = history_of(values);
    const auto bytes = static_cast<double>(history.samples.size() * sizeof(HistorySample) +
                                           history.others.ends.size() * sizeof(std::uint32_t) +
                                           history.others.vertices.size() * sizeof(PathVertex));
    EXPECT_LT(bytes, estimate(Shift::kIdentity));
    EXPECT_LT(estimate(Shift::kReplay), estimate(Shift::kIdentity));
}

}  // namespace
}  // namespace burnish
