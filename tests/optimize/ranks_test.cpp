// Several processes solve to the bytes of one alone.
#include <gtest/gtest.h>

#include <fstream>
#include <new>
#include <stdexcept>
#include <typeinfo>

#include "burnish/checkpoint.h"
#include "burnish/error.h"
#include "error_of.h"
#include "optimize/checkpoint.h"
#include "optimize/checkpoint_folder.h"
#include "optimize/estimators.h"
#include "optimize/ranks.h"
#include "optimize/same_run.h"
#include "optimize/state_cases.h"
#include "optimize/thread_ranks.h"
#include "optimize/view_problem.h"

namespace burnish {
namespace {

/// Nine views, two of them held out, one with an exposure of its own to fit.
Problem problem_for_ranks(const Scene& scene = test::scene_with_ids(8)) {
    Problem problem = test::problem_with_views(scene);
    const std::vector<View> views = problem.views;
    for (int i = 0; i < 5; ++i) {
        View view = views[static_cast<std::size_t>(i) % 4];
        view.name += " again " + std::to_string(i);
        for (float& v : view.image.values) v *= 1 + 0.1f * static_cast<float>(i);
        problem.views.push_back(view);
    }
    problem.views[5].exposure = FitExposure{};
    return problem;
}

TEST(Processes, AnyNumberMakesTheSameBytes) {
    const Problem problem = problem_for_ranks();
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        SCOPED_TRACE(name);
        const Options options = test::options_for_ranks(estimator, 7);
        const Summary whole = solve(problem, options);
        for (const int count : {2, 3, 4, 7})
            test::on_ranks(count, [&](const Ranks& ranks) {
                const Problem own = test::of_rank(problem, ranks);
                int heard = 0;
                const Summary found = solve(own, options, [&](const Iteration&) {
                    ++heard;
                    return Continue;
                });
                test::expect_same_run(found, whole, ranks);
                EXPECT_EQ(heard > 0, ranks.rank == 0) << "one process is asked";
                std::size_t others = 0;
                for (const ViewState& v : found.state.values().views) others += v.visits == 0;
                EXPECT_EQ(others, 7u -
                                      (7u * (static_cast<unsigned>(ranks.rank) + 1) +
                                       static_cast<unsigned>(count) - 1) /
                                          static_cast<unsigned>(count) +
                                      (7u * static_cast<unsigned>(ranks.rank) +
                                       static_cast<unsigned>(count) - 1) /
                                          static_cast<unsigned>(count))
                    << "a process holds its own views alone";
            });
    }
}

/// Large enough that each process steps a part of each level but the coarsest.
Problem problem_in_parts() { return problem_for_ranks(test::scene_with_textures(8, 80)); }

TEST(Processes, PartsOfTexturesMakeTheSameBytes) {
    const Problem problem = problem_in_parts();
    // With one gradient, and with a split one, whose gates are summed up over all parts.
    for (const Estimator& estimator :
         {Estimator{MonteCarlo{2, 1}}, Estimator{PathCache{.samples = 2, .window = 2}},
          Estimator{Reservoirs{}}}) {
        const Options options = test::options_for_ranks(estimator, 7);
        const Summary whole = solve(problem, options);
        for (const int count : {1, 2, 3, 4, 7})
            test::on_ranks(count, [&](const Ranks& ranks) {
                const Problem own = test::of_rank(problem, ranks);
                test::expect_same_run(solve(own, options), whole, ranks);
            });
    }
}

TEST(Processes, WhatASolverShowsIsWhole) {
    const Problem problem = problem_in_parts();
    const Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    Solver whole(problem, options);
    for (int i = 0; i < 3; ++i) whole.step();
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        Solver solver(own, options);
        for (int i = 0; i < 2; ++i) solver.step();
        Solver again(own, options, solver.state());
        again.step();
        EXPECT_TRUE(again.state().values().pyramids == whole.state().values().pyramids);
        const auto found = again.recovered(), expected = whole.recovered();
        for (std::size_t u = 0; u < expected.size(); ++u) {
            EXPECT_EQ(again.texture(u), whole.texture(u));
            EXPECT_EQ(found[u].values, expected[u].values);
            EXPECT_EQ(found[u].coverage, expected[u].coverage);
            EXPECT_EQ(found[u].confidence, expected[u].confidence);
        }
    });
}

/// Values of the gradient that are too large for a step: each is counted by who steps its texel.
TEST(Processes, CountWhatIsLeftOutOnce) {
    Problem problem = problem_in_parts();
    problem.views[5].exposure = ExposureFactors{1, 1, 1};
    problem.loss = [](const Image& image, std::size_t view) {
        LossValue loss{1, image};
        for (float& v : loss.adjoint.values) v *= view % 3 == 0 ? 1e18f : 1e-3f;
        return loss;
    };
    const Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    Solver whole(problem, options);
    const std::size_t expected = whole.step().rejected_derivatives;
    EXPECT_GT(expected, 100u);
    for (const int count : {2, 5})
        test::on_ranks(count, [&](const Ranks& ranks) {
            const Problem own = test::of_rank(problem, ranks);
            Solver solver(own, options);
            EXPECT_EQ(solver.step().rejected_derivatives, expected);
            for (std::size_t u = 0; u < 2; ++u) EXPECT_EQ(solver.texture(u), whole.texture(u));
        });
}

TEST(Processes, BatchesThatLeaveSomeWithoutAViewMakeTheSameBytes) {
    const Problem problem = problem_for_ranks();
    const Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 3);
    const Summary whole = solve(problem, options);
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        test::expect_same_run(solve(own, options), whole, ranks);
    });
}

TEST(Processes, ChecksOfPatienceMakeTheSameBytes) {
    const Problem problem = problem_for_ranks();
    Options options = test::options_for_ranks(MonteCarlo{1, 1}, 7);
    options.stop = {.iterations = 60, .patience = 1};
    const Summary whole = solve(problem, options);
    EXPECT_TRUE(whole.iterations[19].held_out_loss);
    test::on_ranks(4, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        const Summary found = solve(own, options);
        EXPECT_EQ(found.ending, whole.ending);
        test::expect_same_run(found, whole, ranks);
    });
}

TEST(Processes, TheFirstOneEndsTheRun) {
    Problem problem = problem_for_ranks();
    const Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    test::on_ranks(2, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        const Summary summary = solve(own, options, [&](const Iteration& i) {
            EXPECT_EQ(ranks.rank, 0);
            return i.number == 2 ? Cancel : Continue;
        });
        EXPECT_EQ(summary.ending, Ending::kCancelled);
        EXPECT_EQ(summary.iterations.size(), 3u);
    });
}

TEST(Processes, MoreThanTheViewsOfAnIterationAreRefused) {
    const auto message = [](std::uint32_t batch, int count) {
        Problem problem = problem_for_ranks();
        problem.ranks.count = count;
        problem.ranks.exchange = [](std::vector<std::string> messages) { return messages; };
        return test::error_of(
            [&] { Solver(problem, test::options_for_ranks(PathCache{}, batch)).step(); });
    };
    EXPECT_EQ(
        message(3, 4),
        "4 processes share out the views of an iteration: found 3 of 7, expected at least one "
        "for each process, or at most 3 processes; the option batch says how many");
    EXPECT_EQ(
        message(6, 8),
        "8 processes share out the views of an iteration: found 6 of 7, expected all of them, or "
        "at most 6 processes; the option batch says how many");
}

TEST(Processes, AnotherProblemIsNamed) {
    const Problem problem = problem_for_ranks();
    const Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    test::on_ranks(3, [&](const Ranks& ranks) {
        Problem own = test::of_rank(problem, ranks);
        if (ranks.rank == 2) own.views[1].image.at(3, 3, 1) += 0.5f;
        EXPECT_EQ(test::error_of([&] { solve(own, options); }),
                  "process 2 has another problem than process 0, expected the same: the image of "
                  "side");
    });
}

/// Processes decide by them which messages they exchange.
TEST(Processes, AnotherEndIsNamed) {
    const Problem problem = problem_for_ranks();
    const auto error = [&](auto change) {
        std::string said;
        test::on_ranks(2, [&](const Ranks& ranks) {
            Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
            if (ranks.rank == 1) change(options);
            const std::string own =
                test::error_of([&] { solve(test::of_rank(problem, ranks), options); });
            if (ranks.rank == 0) said = own;
        });
        return said;
    };
    const std::string begin = "process 1 has another problem than process 0, expected the same: ";
    EXPECT_EQ(error([](Options& o) { o.stop.seconds = 77; }), begin + "the option stop.seconds");
    EXPECT_EQ(error([](Options& o) { o.stop.patience = 3; }), begin + "the option stop.patience");
    EXPECT_EQ(error([](Options& o) { o.evaluation_samples = 6; }),
              begin + "the option evaluation_samples");
}

TEST(Processes, AnotherStateIsNamed) {
    const Problem problem = problem_for_ranks();
    Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    const auto state_after = [&](std::uint32_t iterations) {
        options.stop.iterations = iterations;
        return solve(problem, options).state;
    };
    const State later = state_after(3), earlier = state_after(2);
    test::on_ranks(2, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        EXPECT_EQ(
            test::error_of([&] { Solver(own, options, ranks.rank == 1 ? earlier : later); }),
            "process 1 has another problem than process 0, expected the same: the state after 3 "
            "iterations, the state after 2 iterations");
    });
}

TEST(Processes, MessagesThatWereNotSentAreRefused) {
    const auto error = [](std::size_t size) -> std::string {
        const Ranks ranks = stoppable({0, 2, [size](std::vector<std::string> messages) {
                                           for (std::string& m : messages) m.assign(size, '\0');
                                           return messages;
                                       }});
        return test::error_of<Error>([&] {
            agree(ranks, 1.5);
            all_values(ranks, 1.5);
        });
    };
    EXPECT_EQ(error(0), "an exchange gave an empty message, expected those that were sent");
    EXPECT_EQ(error(3), "an exchange gave a message of 2 bytes, expected 8");
    EXPECT_EQ(error(9), "");
}

/// An exchange is no input: nobody's file or number is to be corrected.
TEST(Processes, MessagesThatHoldSomethingElseAreNoInput) {
    const std::vector<std::vector<float>> sent{{1}, {2, 3}};
    std::string right;
    ArchiveWriter{sink_into(right)}(sent[1]);
    const auto share_with_one_that_sends = [&](const std::string& message) {
        const Ranks ranks{0, 2, [&](std::vector<std::string> messages) {
                              return std::vector{messages[0], message};
                          }};
        std::vector<std::vector<float>> items{sent[0], {}};
        share(ranks, {0, 1}, Recipient::kAll, items);
        return items;
    };
    EXPECT_EQ(share_with_one_that_sends(right), sent);
    for (const std::string& message : {std::string(), right.substr(0, 5), right.substr(0, 12),
                                       right + '\0', std::string(right.size(), '\xff')}) {
        try {
            share_with_one_that_sends(message);
            ADD_FAILURE() << "it is read";
        } catch (const Error& e) {
            EXPECT_TRUE(typeid(e) == typeid(Error)) << e.what();
        }
    }
}

TEST(Processes, WhatEndsWritingEndsAll) {
    const State::Values none;
    test::on_ranks(2, [&](const Ranks& ranks) {
        const WholeState state{none, ranks};
        EXPECT_THROW(write_whole(state, [] { throw OutputError(""); }), OutputError);
        EXPECT_THROW(write_whole(state, [] { throw std::bad_alloc(); }), std::bad_alloc);
        const auto fail = [&] { write_whole(state, [] { throw std::logic_error("a defect"); }); };
        if (ranks.rank == 0) {
            EXPECT_THROW(fail(), std::logic_error);
        } else {
            EXPECT_THROW(fail(), Error);
        }
        EXPECT_NO_THROW(write_whole(state, [] {}));
    });
}

/// As the jobs of a batch do, each of which goes on after the exchange where one has failed.
TEST(Processes, AnotherThatFailsEndsWriting) {
    const State::Values none;
    test::on_ranks(2, [&](const Ranks& ranks) {
        const Ranks together = failable(ranks);
        if (ranks.rank == 0) {
            const auto write = [&] { together.exchange(to_each(together)); };
            EXPECT_THROW(write_whole({none, together}, write), FailedElsewhere);
        } else {
            from_first(together, "");  // which arrays lie in parts
            tell_stopped(together);
        }
        EXPECT_EQ(all_values(ranks, ranks.rank), (std::vector<int>{0, 1}));
    });
}

struct ProcessesAndCheckpoints : test::CheckpointFolder {};

TEST_F(ProcessesAndCheckpoints, ARunGoesOnWithAnotherNumber) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        SCOPED_TRACE(name);
        test::expect_to_go_on_with_others(problem_for_ranks(),
                                          test::options_for_ranks(estimator, 7), checkpoints,
                                          {{3, 3}, {4, 6}, {1, 8}}, 2);
    }
}

TEST_F(ProcessesAndCheckpoints, PartsGoOnWithAnotherNumber) {
    test::expect_to_go_on_with_others(
        problem_in_parts(), test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7),
        checkpoints, {{7, 1}, {3, 2}, {4, 3}, {1, 4}, {2, 5}}, 4);
}

TEST_F(ProcessesAndCheckpoints, ViewsAreSentInSlices) {
    const Problem problem = problem_for_ranks();
    Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    options.stop.iterations = 3;
    const std::string expected = test::archive_of(solve(problem, options).state.values());
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        const State part = solve(own, options).state;
        test::expect_whole_in_slices(part.values(), ranks, expected);
    });
}

TEST_F(ProcessesAndCheckpoints, PartsAreSentInSlices) {
    const Problem problem = problem_in_parts();
    Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    options.stop.iterations = 2;
    const State whole = solve(problem, options).state;
    const std::string expected = test::archive_of(whole.values());
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        State::Values part = solve(own, options).state.values();
        for (PyramidState& p : part.pyramids) keep_part(p, ranks.rank, ranks.count);
        EXPECT_FALSE(part.pyramids == whole.values().pyramids);
        test::expect_whole_in_slices(part, ranks, expected);
        test::expect_few_exchanges(part, ranks);
    });
}

TEST_F(ProcessesAndCheckpoints, AFileThatCannotBeWrittenIsSaidByAll) {
    const Problem problem = problem_for_ranks();
    const Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    std::ofstream(folder / "file") << "no folder";
    checkpoints.folder = (folder / "file/c").string();
    test::on_ranks(2, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        EXPECT_THROW(solve(own, options, checkpoints), OutputError) << ranks.rank;
        Checkpoints lost = checkpoints;
        lost.folder = (folder / "lost").string();
        const Callback replace = [&](const Iteration&) {  // the first process alone hears it
            std::filesystem::remove_all(lost.folder);
            std::ofstream(lost.folder) << "in the way";
            return Suspend;
        };
        EXPECT_THROW(solve(own, options, lost, replace), OutputError) << ranks.rank;
        Checkpoints noted = checkpoints;
        int errors = 0;
        noted.note = [&](const CheckpointNote& note) { errors += !note.error.empty(); };
        Options few = options;
        few.stop.iterations = 2;
        EXPECT_EQ(solve(own, few, noted).iterations.size(), 2u);
        EXPECT_EQ(errors > 0, ranks.rank == 0);
    });
}

TEST_F(ProcessesAndCheckpoints, WhereMemoryEndsWhileWritingAllEnd) {
    const Problem problem = problem_for_ranks();
    Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    options.stop.iterations = 1;
    int notes = 0;
    checkpoints.note = [&](const CheckpointNote&) { ++notes; };
    test::on_ranks(2, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        const State part = solve(own, options).state;
        int left = -1;  // exchanges until memory ends
        Ranks short_of_memory = ranks;
        short_of_memory.exchange = [&](std::vector<std::string> messages) {
            if (left-- == 0) throw std::bad_alloc();
            return ranks.exchange(std::move(messages));
        };
        CheckpointWriter writer(checkpoints, {}, short_of_memory, {});
        // After whether it is due, whether it is new, and which arrays lie in parts.
        if (ranks.rank == 0) left = 3;
        EXPECT_THROW(writer.offer({}, part.values(), true), std::bad_alloc) << ranks.rank;
    });
    EXPECT_EQ(notes, 0);
}

TEST_F(ProcessesAndCheckpoints, AStateOfOtherViewsIsRefused) {
    const Problem problem = problem_for_ranks();
    Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 2}, 7);
    options.stop.iterations = 3;
    std::vector<State> states(2);
    test::on_ranks(2, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        State& state = states[static_cast<std::size_t>(ranks.rank)];
        state = solve(own, options).state;
        solve(own, options, state);  // each goes on from its own
        EXPECT_NE(test::error_of([&] {
                      Solver(problem, options, state);
                  }).find("the state is that of another problem"),
                  std::string::npos)
            << "one process has not all views";
    });
}

}  // namespace
}  // namespace burnish
