// A state is all that survives an iteration: runs that go on from a copy, from bytes, or in another
// process end at the same bytes.
#include "optimize/state.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "file_bytes.h"
#include "optimize/checkpoint_folder.h"
#include "optimize/state_cases.h"
#include "temporary_folder.h"

namespace burnish {
namespace {

State state_after(const Options& options, std::uint32_t iterations) {
    Solver solver(test::state_problem(), options);
    test::step_to(iterations, solver);
    return solver.state();
}

TEST(State, CopiedAndGoneOnTwiceIsTheSame) {
    for (const auto& [name, options] : test::state_cases()) {
        Solver solver(test::state_problem(), options);
        test::step_to(test::kStored, solver);
        const State stored = solver.state();
        test::step_to(test::kAll, solver);
        EXPECT_FALSE(solver.state() == stored) << name;
        for (int i = 0; i < 2; ++i) {
            Solver again(test::state_problem(), options, stored);
            EXPECT_EQ(again.iterations(), test::kStored);
            EXPECT_TRUE(again.state() == stored) << name;
            test::step_to(test::kAll, again);
            EXPECT_TRUE(again.state() == solver.state()) << name;
            for (std::size_t u = 0; u < 2; ++u) EXPECT_EQ(again.texture(u), solver.texture(u));
            EXPECT_EQ(again.image(), solver.image()) << name;
            EXPECT_EQ(save_state(again.state()), save_state(solver.state())) << name;
        }
    }
}

TEST(State, LoadedIsTheSavedOne) {
    for (const auto& [name, options] : test::state_cases())
        for (const std::uint32_t iterations : {0u, 1u, 3u}) {
            const State state = state_after(options, iterations);
            const std::string bytes = save_state(state);
            const State loaded = load_state(bytes);
            EXPECT_TRUE(loaded == state) << name;
            EXPECT_EQ(save_state(loaded), bytes) << name;
        }
}

TEST(State, GoesOnInAFreshProcess) {
    const test::TemporaryFolder temporary;
    const auto cases = test::state_cases();
    const auto file = [&](std::size_t i, const char* extension) {
        return temporary.path / (std::to_string(i) + extension);
    };
    for (std::size_t i = 0; i < cases.size(); ++i)
        std::ofstream(file(i, ".state"), std::ios::binary)
            << save_state(state_after(cases[i].options, test::kStored));
    ASSERT_EQ(std::system((std::string(BURNISH_GO_ON) + " " + temporary.path.string()).c_str()), 0);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const std::string bytes = test::bytes_of(file(i, ".after"));
        const State whole = state_after(cases[i].options, test::kAll);
        EXPECT_TRUE(bytes == save_state(whole)) << cases[i].name;
        EXPECT_TRUE(load_state(bytes) == whole) << cases[i].name;
    }
}

TEST(State, SolveGoesOnFromTheStateOfItsSummary) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options;
        options.estimator = estimator;
        options.evaluation_samples = 2;
        options.stop.iterations = test::kAll;
        const Summary whole = solve(test::state_problem(), options);
        options.stop.iterations = test::kStored;
        const Summary first = solve(test::state_problem(), options);
        options.stop.iterations = test::kAll - test::kStored;
        const Summary second = solve(test::state_problem(), options, first.state);
        ASSERT_EQ(second.iterations.size(), test::kAll - test::kStored);
        EXPECT_EQ(second.iterations.front().number, test::kStored);
        EXPECT_NE(second.start.loss, first.start.loss) << name << ": it starts at the state";
        EXPECT_EQ(second.iterations.back().loss, whole.iterations.back().loss) << name;
        EXPECT_TRUE(second.state == whole.state) << name;
        for (std::size_t u = 0; u < 2; ++u) {
            EXPECT_EQ(second.textures[u].values, whole.textures[u].values) << name;
            EXPECT_EQ(second.textures[u].coverage, whole.textures[u].coverage) << name;
            EXPECT_EQ(second.textures[u].confidence, whole.textures[u].confidence) << name;
        }
        EXPECT_EQ(second.result.views[0].image, whole.result.views[0].image) << name;
    }
}

/// The offsets of a test: all of the first ones, then some.
std::vector<std::size_t> offsets_in(const std::string& bytes) {
    std::vector<std::size_t> offsets;
    for (std::size_t i = 0; i < bytes.size(); i += i < 256 ? 1 : bytes.size() / 200 + 1)
        offsets.push_back(i);
    offsets.push_back(bytes.size() - 1);
    return offsets;
}

TEST(State, DamagedBytesAreRefusedWithTheirOffset) {
    for (const auto& [name, options] : test::state_cases()) {
        const std::string bytes = save_state(state_after(options, 2));
        for (const std::size_t at : offsets_in(bytes)) {
            const std::string cut = test::error_of([&] { load_state(bytes.substr(0, at)); });
            EXPECT_NE(cut.find("byte "), std::string::npos) << name << ", cut at " << at;
            std::string damaged = bytes;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
            const std::string flipped = test::error_of([&] { load_state(damaged); });
            EXPECT_NE(flipped.find("byte "), std::string::npos) << name << ", flipped at " << at;
        }
        EXPECT_NE(test::error_of([&] { load_state(bytes + "x"); }), "");
    }
    EXPECT_NE(test::error_of([&] { load_state(""); }), "");
    EXPECT_NE(test::error_of([&] { load_state(std::string(1000, 'x')); }), "");
}

TEST(State, OfAnotherVersionIsRefused) {
    std::string bytes = save_state(state_after(Options{}, 1));
    bytes[8] = 4;
    EXPECT_NE(test::error_of([&] { load_state(bytes); }).find("version 4"), std::string::npos);
}

TEST(State, OfAnotherProblemOrOtherOptionsIsRefused) {
    const auto refused = [](const State& state, const Problem& problem, const Options& options) {
        return !test::error_of([&] { Solver(problem, options, state); }).empty();
    };
    std::vector<Options> all(3);
    all[1].estimator = Reservoirs{}, all[2].estimator = MonteCarlo{};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const State state = state_after(all[i], 2);
        for (std::size_t k = 0; k < all.size(); ++k)
            EXPECT_EQ(refused(state, test::state_problem(), all[k]), i != k);
        Options texels = all[i];
        texels.parameterization = Parameterization::kTexels;
        EXPECT_TRUE(refused(state, test::state_problem(), texels));
        Problem one = test::state_problem();
        one.unknowns.pop_back();
        EXPECT_TRUE(refused(state, one, all[i]));
        Problem exchanged = test::state_problem();
        std::swap(exchanged.unknowns[0], exchanged.unknowns[1]);
        EXPECT_TRUE(refused(state, exchanged, all[i]));
        EXPECT_TRUE(refused(state, test::problem_of(test::small_scene_of(23)), all[i]))
            << "another film";
        Scene moved = test::small_scene_of(24);
        moved.camera.to_world = look_at({0.3, -5.2, 3.6}, {0, 0.1, 0}, {0, 0, 1});
        if (i == 1) {
            Options uniform = all[i];
            std::get<Reservoirs>(uniform.estimator).adaptive_sampling = false;
            EXPECT_TRUE(refused(state, test::state_problem(), uniform)) << "other film passes";
            State::Values values = state.values();
            std::vector<HistorySample>& samples =
                std::get<ReservoirsState>(values.views[0].estimator).history.samples;
            ASSERT_GT(samples.size(), 2u);
            std::swap(samples.front(), samples.back());
            EXPECT_TRUE(refused(State(values), test::state_problem(), all[i])) << "another order";
            std::swap(samples.front(), samples.back());
            EXPECT_FALSE(refused(State(values), test::state_problem(), all[i]));
            samples[0].path.camera.iteration = 2;
            EXPECT_TRUE(refused(State(values), test::state_problem(), all[i])) << "of the future";
        }
        if (i > 0) continue;  // samples of the others are replayed
        EXPECT_TRUE(refused(state, test::problem_of(moved), all[i])) << "another camera";
    }
}

/// What was changed is among what the message names.
TEST(State, OfOtherOptionsIsRefusedWithTheirNames) {
    Problem problem = test::state_problem();
    problem.views.push_back(problem.views[0]);
    const auto refusal = [&](const Options& before, const Options& after) {
        Solver solver(problem, before);
        test::step_to(4, solver);
        const State state = solver.state();
        return test::error_of([&] { Solver(problem, after, state); });
    };
    const auto with = [](const auto& change) {
        Options options;
        change(options);
        return options;
    };
    const Options undecayed = with([](Options& o) { o.pyramid.weight_decay = 0; });
    const Options one = with([](Options&o) { o.estimator = Reservoirs{.samples = 1}; }),
                  two = with([](Options&o) { o.estimator = Reservoirs{.samples = 2}; });
    const Options kept = with([](Options&o) { o.estimator = MonteCarlo{.image_window = 2}; }),
                  fresh = with([](Options&o) { o.estimator = MonteCarlo{.image_window = 0}; });
    const Options both = with([](Options& o) { o.batch = 2; });
    const Options plain = with([](Options& o) { o.loss = Loss::kRelMse; });
    struct Change {
        const char* name;
        Options before, after;
    };
    for (const auto& [name, before, after] :
         {Change{"pyramid.weight_decay", undecayed, {}}, Change{"samples", one, two},
          Change{"image_window", kept, fresh}, Change{"batch", {}, both},
          Change{"loss", plain, {}}}) {
        EXPECT_NE(refusal(before, after).find(name), std::string::npos) << name;
        EXPECT_EQ(refusal(before, before), "") << name;
    }
    for (const bool reuse : {false, true})
        for (const bool positivization : {false, true}) {
            const Options other = with([&](Options& o) {
                o.estimator =
                    Reservoirs{.samples = 2, .positivization = positivization, .reuse = reuse};
            });
            EXPECT_EQ(refusal(two, other), "") << "the state means the same";
            EXPECT_EQ(refusal(other, two), "") << "the state means the same";
        }
    for (View& view : problem.views) view.exposure = FitExposure{};
    EXPECT_EQ(refusal(plain, {}), "") << "any loss gathers halves where an exposure is fitted";
}

}  // namespace
}  // namespace burnish
