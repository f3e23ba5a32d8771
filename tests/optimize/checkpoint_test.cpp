// Runs that go on from their files: to the bytes of one that was never stopped, and not at all
// where something has changed.
#include "burnish/checkpoint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <thread>
#include <utility>

#include "burnish/error.h"
#include "core/parallel.h"
#include "file_bytes.h"
#include "image/image.h"
#include "optimize/checkpoint.h"
#include "optimize/checkpoint_folder.h"
#include "optimize/floor_scene.h"
#include "optimize/loss.h"
#include "optimize/same_run.h"
#include "optimize/state.h"
#include "optimize/state_cases.h"
#include "optimize/thread_ranks.h"
#include "optimize/view_problem.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

struct CheckpointTest : test::CheckpointFolder {
    std::vector<fs::path> files() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(checkpoints.folder))
            found.push_back(entry.path());
        std::sort(found.begin(), found.end());
        return found;
    }
};

/// All that a run has found, but times.
void expect_same(const Summary& a, const Summary& b, const std::string& name) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(a.state == b.state);
    EXPECT_EQ(a.ending, b.ending);
    test::expect_same_run(a, b, {});
}

/// Runs the problem whole, and stopped twice; on one thread the second time.
void expect_to_go_on(const Problem& problem, Options options, const Checkpoints& checkpoints,
                     const std::string& name) {
    options.stop.iterations = test::kAll, options.evaluation_samples = 2;
    const Summary whole = solve(problem, options);
    fs::remove_all(checkpoints.folder);
    const Summary first = solve(problem, options, checkpoints, test::stop_after(2));
    EXPECT_EQ(first.ending, Ending::kSuspended);
    EXPECT_TRUE(first.result.views.empty());
    EXPECT_EQ(first.textures.size(), problem.unknowns.size());
    {
        const ThreadLimit one(1);
        solve(problem, options, load_checkpoint(checkpoints.folder), checkpoints,
              test::stop_after(test::kAll - 1));
    }
    const Checkpoint from = load_checkpoint(checkpoints.folder);
    EXPECT_EQ(from.run.iterations.size(), test::kAll - 1u);
    const Summary last = solve(problem, options, from, checkpoints);
    expect_same(last, whole, name);
    EXPECT_GT(from.run.seconds, 0);
    EXPECT_GE(last.seconds, from.run.seconds);
    // Of the last iteration: only the result is evaluated.
    expect_same(solve(problem, options, load_checkpoint(checkpoints.folder), checkpoints), whole,
                name);
}

TEST_F(CheckpointTest, RunsOfAllEstimatorsGoOn) {
    for (const auto& [name, options] : test::state_cases())
        expect_to_go_on(test::state_problem(), options, checkpoints, name);
}

/// Stopped within iterations again and again, after so many chunks of work each time.
Summary solve_in_pieces(const Problem& problem, const Options& options, Checkpoints checkpoints,
                        long chunks, int& pieces) {
    std::atomic<long> asked{0};
    long last = chunks;
    checkpoints.stop = [&] { return ++asked > last; };
    Summary summary = solve(problem, options, checkpoints);
    for (pieces = 1; summary.ending == Ending::kSuspended; ++pieces) {
        EXPECT_LT(asked, last + 64) << "it does not stop";
        asked = 0, last = chunks + 97 * pieces;  // for what takes longer than a piece
        Checkpoint from = load_checkpoint(checkpoints.folder);
        EXPECT_EQ(from.run.counts.iterations, from.run.state.values().iteration);
        summary = solve(problem, options, std::move(from), checkpoints);
    }
    return summary;
}

TEST_F(CheckpointTest, IterationsThatAreStoppedBeginAgain) {
    for (const bool views : {false, true}) {
        Problem problem = views ? test::problem_with_views() : test::state_problem();
        if (views) problem.views[1].exposure = FitExposure{true};
        for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
            Options options;
            options.estimator = estimator, options.batch = 2, options.background_samples = 4;
            options.stop.iterations = test::kAll, options.evaluation_samples = 2;
            const Summary whole = solve(problem, options);
            fs::remove_all(checkpoints.folder);
            int pieces = 0;
            expect_same(solve_in_pieces(problem, options, checkpoints, 40, pieces), whole, name);
            EXPECT_GT(pieces, 3) << name;
        }
    }
}

/// A run of three processes, of which one alone is asked to stop after so many chunks of work: what
/// the first one has found.
Summary solve_until_one_stops(const Problem& problem, const Options& options,
                              const Checkpoints& checkpoints, bool goes_on, int who, long chunks) {
    Summary found;
    test::on_ranks(3, [&](const Ranks& ranks) {
        const ThreadLimit one(1);
        const Problem own = test::of_rank(problem, ranks);
        Checkpoints asks = checkpoints;
        std::atomic<long> asked{0};
        if (ranks.rank == who) asks.stop = [&] { return ++asked > chunks; };
        Summary summary = goes_on ? solve(own, options, load_checkpoint(asks.folder, ranks), asks)
                                  : solve(own, options, asks);
        EXPECT_LT(asked, chunks + 64) << "it does not stop";
        if (ranks.rank == 0) found = std::move(summary);
    });
    return found;
}

/// Stopped again and again, by another process each time.
void expect_stopped_together(const Problem& problem, const Options& options,
                             const Checkpoints& checkpoints, const std::string& name) {
    const Summary whole = solve(problem, options);
    fs::remove_all(checkpoints.folder);
    Summary found;
    int pieces = 0;
    do {
        ASSERT_LT(pieces, 64) << name;
        found = solve_until_one_stops(problem, options, checkpoints, pieces > 0, pieces % 3,
                                      20 + 31 * pieces);
        ++pieces;
    } while (found.ending == Ending::kSuspended);
    EXPECT_GT(pieces, 3) << name;
    SCOPED_TRACE(name);
    EXPECT_EQ(found.ending, whole.ending);
    test::expect_same_run(found, whole, {});
}

TEST_F(CheckpointTest, WhereOneProcessIsStoppedAllAreAndTheIterationBeginsAgain) {
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options;
        options.estimator = estimator, options.batch = 3, options.background_samples = 4;
        options.stop.iterations = test::kAll, options.evaluation_samples = 2;
        expect_stopped_together(test::problem_with_views(), options, checkpoints, name);
    }
}

TEST_F(CheckpointTest, ProcessesThatShareAViewStopTogether) {
    Options options;
    options.background_samples = 16, options.stop.iterations = test::kAll;
    options.evaluation_samples = 2;
    Problem problem = test::state_problem();
    expect_stopped_together(problem, options, checkpoints, "one view");
    problem.views[0].exposure = FitExposure{true};
    expect_stopped_together(problem, options, checkpoints, "one view of unknown exposure");
}

/// The loss is asked in the middle of an iteration: what was traced before is forgotten.
TEST_F(CheckpointTest, WhereMemoryEndsWhatIsDoneIsKept) {
    checkpoints.seconds = 3600;
    std::uint32_t done = 0, last = 0;  // iterations: so far, and of which no other follows
    const Callback count = [&](const Iteration& i) {
        done = i.number + 1;
        return Continue;
    };
    Problem problem = test::state_problem();
    problem.loss = [&](const Image& image, std::size_t) {
        if (done > 0 && done == last) throw std::bad_alloc();
        return evaluate_loss(Loss::kL2, image, make_image(24, 24, 3, 0.2f), {});
    };
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options;
        options.estimator = estimator;
        options.stop.iterations = test::kAll, options.evaluation_samples = 2;
        done = last = 0;
        const Summary whole = solve(problem, options);
        for (const std::uint32_t end : {1u, 4u}) {
            fs::remove_all(checkpoints.folder);
            last = end;
            EXPECT_THROW(solve(problem, options, checkpoints, count), std::bad_alloc) << name;
            done = last = 0;
            Checkpoint from = load_checkpoint(checkpoints.folder);
            EXPECT_EQ(from.run.iterations.size(), end) << name;
            expect_same(solve(problem, options, std::move(from), checkpoints), whole, name);
        }
    }
}

TEST_F(CheckpointTest, RunsWithASearchedStartGoOn) {
    Problem problem = test::state_problem();
    for (Unknown& u : problem.unknowns) u.start = SearchStart{};
    expect_to_go_on(problem, {}, checkpoints, "searched");
}

TEST_F(CheckpointTest, SaysWhatTheSearchesHaveDone) {
    Options options;
    options.search_again = 2, options.search_effort = 2;
    options.stop.iterations = 3, options.evaluation_samples = 2;
    const Problem problem = test::searched_problem(test::smooth_scene(), SearchStart{});
    const Summary whole = solve(problem, options, checkpoints);
    const Checkpoint last = load_checkpoint(checkpoints.folder);
    EXPECT_EQ(last.run.search_effort, 2);
    EXPECT_FALSE(last.run.searched_again.empty());
    EXPECT_TRUE(last.run.searched_again == whole.searched_again);
}

TEST_F(CheckpointTest, RunsOfSeveralViewsGoOn) {
    Problem problem = test::problem_with_views();
    problem.views[1].exposure = FitExposure{true};
    for (const auto& [name, estimator] : test::all_estimators(2, 1)) {
        Options options;
        options.estimator = estimator;
        options.batch = 2, options.background_samples = 4;
        expect_to_go_on(problem, options, checkpoints, name + ", views");
    }
}

TEST_F(CheckpointTest, AFolderWithoutANameIsRefusedBeforeTheRun) {
    const auto run = [] {
        solve(test::state_problem(), {}, Checkpoints{}, [](const Iteration&) {
            ADD_FAILURE() << "it runs";
            return Cancel;
        });
    };
    EXPECT_EQ(test::error_of(run), "the folder of the checkpoints has no name: expected one");
}

TEST_F(CheckpointTest, TheLastTwoAreKept) {
    Options options;
    options.stop.iterations = 4, options.evaluation_samples = 2;
    std::vector<CheckpointNote> notes;
    checkpoints.note = [&](const CheckpointNote& note) { notes.push_back(note); };
    checkpoints.settings = "of my own", checkpoints.files = {{"a.xml", 1, 2}};
    // From a writer that was killed:
    fs::create_directories(checkpoints.folder);
    std::ofstream(fs::path(checkpoints.folder) / ".0000000001.burnish.7-0.tmp") << "half";
    for (const std::uint32_t at : {1u, 2u, 3u}) {
        if (at == 1)
            solve(test::state_problem(), options, checkpoints, test::stop_after(at));
        else
            solve(test::state_problem(), options, load_checkpoint(checkpoints.folder), checkpoints,
                  test::stop_after(at));
        EXPECT_TRUE(notes.back().is_last);
        EXPECT_EQ(notes.back().iterations, at);
        EXPECT_EQ(notes.back().error, "");
    }
    ASSERT_EQ(files().size(), 2u);
    EXPECT_EQ(files()[0].filename(), "0000000002.burnish");
    EXPECT_EQ(files()[1].filename(), "0000000003.burnish");
    const Checkpoint newest = load_checkpoint(checkpoints.folder);
    EXPECT_EQ(newest.settings, "of my own");
    EXPECT_EQ(newest.files, checkpoints.files);
    EXPECT_EQ(newest.file, files()[1].string());
    EXPECT_TRUE(newest.damaged.empty());
}

/// Also of the last iteration, whose checkpoint may lie there since it ended.
TEST_F(CheckpointTest, NotesNameTheFile) {
    Options options;
    options.stop.iterations = 1, options.evaluation_samples = 2;
    std::vector<CheckpointNote> notes;
    checkpoints.seconds = 0;
    checkpoints.note = [&](const CheckpointNote& note) { notes.push_back(note); };
    solve(test::state_problem(), options, checkpoints, [](const Iteration&, const Solver&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));  // it is due
        return Continue;
    });
    ASSERT_EQ(notes.size(), 2u);
    ASSERT_EQ(files().size(), 1u);
    for (const CheckpointNote& note : notes) EXPECT_EQ(note.file, files()[0].string());
}

TEST_F(CheckpointTest, DamageIsFoundAndTheOneBeforeIsTaken) {
    Options options;
    options.estimator = MonteCarlo{1, 1};
    solve(test::state_problem(), options, checkpoints, test::stop_after(1));
    solve(test::state_problem(), options, load_checkpoint(checkpoints.folder), checkpoints,
          test::stop_after(2));
    const fs::path newest = files()[1];
    const std::string bytes = test::bytes_of(newest);
    const auto expect_refused = [&](const std::string& damaged, std::size_t at) {
        std::ofstream(newest, std::ios::binary) << damaged;
        const Checkpoint taken = load_checkpoint(checkpoints.folder);
        EXPECT_EQ(taken.run.iterations.size(), 1u) << at;
        ASSERT_EQ(taken.damaged.size(), 1u) << at;
        EXPECT_NE(taken.damaged[0].find(newest.string()), std::string::npos) << taken.damaged[0];
    };
    constexpr std::size_t kHeader = 72;
    const std::size_t step =
        std::getenv("BURNISH_FAULTS") ? 64 : std::max<std::size_t>(64, bytes.size() / 500);
    for (std::size_t at = 0; at < bytes.size(); at += at < kHeader ? 1 : step) {
        std::string flipped = bytes;
        flipped[at] = static_cast<char>(flipped[at] ^ (1 << (at % 8)));
        expect_refused(flipped, at);
    }
    for (const std::size_t size : {std::size_t{0}, std::size_t{71}, bytes.size() - 1})
        expect_refused(bytes.substr(0, size), size);
    expect_refused(bytes + "x", bytes.size());
    for (const Ranks& ranks : {Ranks{0, 0}, Ranks{2, 2}, Ranks{-1, 1}})
        EXPECT_THROW(load_checkpoint(checkpoints.folder, ranks), InputError) << ranks.rank;
    fs::remove(files()[0]);
    EXPECT_NE(test::error_of([&] { load_checkpoint(checkpoints.folder); }).find("expected"),
              std::string::npos);
    fs::remove(newest);
    EXPECT_NE(
        test::error_of([&] { load_checkpoint(checkpoints.folder); }).find("holds no checkpoint"),
        std::string::npos);
}

TEST_F(CheckpointTest, OfAnotherProgramAreWarnedOf) {
    Options options;
    options.estimator = MonteCarlo{1, 1};
    solve(test::state_problem(), options, checkpoints, test::stop_after(1));
    Checkpoint kept = load_checkpoint(checkpoints.folder);
    EXPECT_TRUE(warnings_of(kept, "the run").empty());
    const std::string program = std::exchange(kept.program, "burnish 0");
    kept.damaged = {"a file: is cut off"};
    const std::vector<std::string> warnings{
        "a file: is cut off: the one before it is taken",
        "the run began with burnish 0: with " + program + " the bytes may be others"};
    EXPECT_EQ(warnings_of(kept, "the run"), warnings);
}

/// Checkpoints of an earlier run in the same folder go once there is one of the new run, not
/// before.
TEST_F(CheckpointTest, ANewRunReplacesWhatAnEarlierOneHasLeft) {
    Options options;
    options.estimator = MonteCarlo{1, 1}, options.stop.iterations = 6;
    options.evaluation_samples = 2;
    checkpoints.seconds = 3600;  // at the end of a run alone
    solve(test::state_problem(), options, checkpoints);
    ASSERT_EQ(files().back().filename(), "0000000006.burnish");
    options.seed = 5;
    solve(test::state_problem(), options, checkpoints, test::stop_after(1));
    ASSERT_EQ(files().size(), 1u);
    EXPECT_EQ(files()[0].filename(), "0000000001.burnish");
    EXPECT_EQ(solve(test::state_problem(), options, load_checkpoint(checkpoints.folder),
                    checkpoints, test::stop_after(3))
                  .iterations.size(),
              3u);
    const fs::path damaged = files().back();
    ASSERT_EQ(damaged.filename(), "0000000003.burnish");
    std::ofstream(damaged, std::ios::binary) << "damaged";
    solve(test::state_problem(), options, load_checkpoint(checkpoints.folder), checkpoints,
          test::stop_after(2));
    EXPECT_FALSE(fs::exists(damaged)) << "a whole one would have gone in its place";
    const Checkpoint newest = load_checkpoint(checkpoints.folder);
    EXPECT_EQ(newest.run.iterations.size(), 2u);
    EXPECT_TRUE(newest.damaged.empty());
}

/// Also one that was stopped in its first iteration, and what belongs to it elsewhere.
TEST_F(CheckpointTest, NothingOfAnEarlierRunStaysBesideTheFirstOfANewOne) {
    Options options;
    options.estimator = MonteCarlo{1, 1};
    const fs::path own = checkpoints.folder, elsewhere = folder / "elsewhere";
    fs::create_directories(own);
    for (const fs::path& file : {own / "0000000000.burnish", own / "0000000009.burnish", elsewhere})
        std::ofstream(file) << "of an earlier run";
    checkpoints.replaced = {elsewhere.string()};
    checkpoints.note = [&](const CheckpointNote& note) {
        ASSERT_EQ(files().size(), 1u);
        EXPECT_EQ(files()[0].string(), note.file);
        EXPECT_FALSE(fs::exists(elsewhere));
    };
    solve(test::state_problem(), options, checkpoints, [&](const Iteration&, const Solver&) {
        EXPECT_EQ(files().size(), 2u) << "before there is one of the new run";
        EXPECT_TRUE(fs::exists(elsewhere));
        return Suspend;
    });
}

/// They would count as none, and the run would begin anew.
TEST_F(CheckpointTest, AFolderThatCannotBeReadIsAnError) {
    const fs::path loop = fs::path(checkpoints.folder) / "loop";
    fs::create_directories(checkpoints.folder);
    fs::create_symlink("loop", loop);
    EXPECT_THROW(load_checkpoint(loop), OutputError);
    EXPECT_TRUE(checkpoints_in(fs::path(checkpoints.folder) / "missing").empty());
}

/// A state that somebody saved there, and a copy of a checkpoint.
TEST_F(CheckpointTest, FilesOfOtherNamesAreLeftAlone) {
    Options options;
    options.estimator = MonteCarlo{1, 1}, options.evaluation_samples = 2;
    checkpoints.seconds = 3600;  // at the end of a run alone
    const fs::path own = checkpoints.folder, copy = own / "a copy of 2.burnish";
    fs::create_directories(own);
    std::ofstream(own / "zz.burnish") << "mine";
    EXPECT_TRUE(checkpoints_in(own).empty());
    EXPECT_NE(test::error_of([&] { load_checkpoint(own); }).find("holds no checkpoint"),
              std::string::npos);
    const auto run = [&](std::uint32_t iterations) {
        options.stop.iterations = iterations;
        if (checkpoints_in(own).empty())
            solve(test::state_problem(), options, checkpoints);
        else
            solve(test::state_problem(), options, load_checkpoint(own), checkpoints);
    };
    run(2);
    fs::copy_file(own / "0000000002.burnish", copy);
    const std::string bytes = test::bytes_of(copy);
    run(6);
    EXPECT_EQ(load_checkpoint(own).run.iterations.size(), 6u);
    run(7), run(8);
    EXPECT_EQ(checkpoints_in(own).size(), 2u);
    EXPECT_EQ(load_checkpoint(own).run.iterations.size(), 8u);
    EXPECT_EQ(test::bytes_of(own / "zz.burnish"), "mine");
    EXPECT_EQ(test::bytes_of(copy), bytes);
    options.seed = 5;  // another run, to which what lies there is of no use
    solve(test::state_problem(), options, checkpoints, test::stop_after(1));
    EXPECT_EQ(files().size(), 3u) << "its own and the two";
    EXPECT_EQ(test::bytes_of(own / "zz.burnish"), "mine");
    EXPECT_EQ(test::bytes_of(copy), bytes);
}

TEST_F(CheckpointTest, WhatHasChangedIsNamed) {
    Options options;
    options.stop.iterations = 3, options.evaluation_samples = 2;
    solve(test::state_problem(), options, checkpoints, test::stop_after(1));
    const auto complaint = [&](const Problem& problem, const Options& other) {
        return test::error_of([&] {
            solve(problem, other, load_checkpoint(checkpoints.folder), checkpoints,
                  test::stop_after(1));
        });
    };
    const auto expect_named = [](const std::string& text, const std::string& what) {
        const std::string all = "the run cannot go on as it was: changed since it began: " + what;
        EXPECT_EQ(text, all);
    };
    Options other = options;
    other.seed = 5;
    expect_named(complaint(test::state_problem(), other), "the option seed");
    other = options;
    std::get<PathCache>(other.estimator).window = 7;
    expect_named(complaint(test::state_problem(), other), "the option path_cache.window");
    Problem problem = test::state_problem();
    problem.views[0].image.values[5] += 1;
    expect_named(complaint(problem, options), "the image of view 0");
    problem = test::state_problem();
    problem.views[0].mask = make_image(24, 24, 1, 1);
    expect_named(complaint(problem, options), "the mask of view 0");
    problem = test::state_problem();
    problem.unknowns[1].start = 0.25f;
    expect_named(complaint(problem, options), "the start of " + problem.unknowns[1].name);
    problem = test::state_problem();
    std::get<Image>(problem.unknowns[1].start).values[3] = 0.25f;
    expect_named(complaint(problem, options), "the start of " + problem.unknowns[1].name);
    other = options;
    other.stop.iterations = 2, other.evaluation_samples = 4;
    EXPECT_EQ(complaint(test::state_problem(), other), "");
}

TEST_F(CheckpointTest, TheOrderOfViewsMayNotChange) {
    Options options;
    options.evaluation_samples = 2;
    const Problem problem = test::problem_with_views();
    solve(problem, options, checkpoints, test::stop_after(1));
    Problem exchanged = problem;
    std::swap(exchanged.views[1], exchanged.views[2]);
    const std::string error = test::error_of(
        [&] { solve(exchanged, options, load_checkpoint(checkpoints.folder), checkpoints); });
    EXPECT_NE(error.find("changed since it began: the order of views"), std::string::npos) << error;
}

TEST_F(CheckpointTest, TimeIsThatOfAllProcesses) {
    Options options;
    options.evaluation_samples = 2, options.stop.seconds = 0.3;
    solve(test::state_problem(), options, checkpoints, test::stop_after(1));
    Checkpoint from = load_checkpoint(checkpoints.folder);
    from.run.seconds = 100;
    const Summary summary = solve(test::state_problem(), options, from, checkpoints);
    EXPECT_EQ(summary.ending, Ending::kTime);
    EXPECT_EQ(summary.iterations.size(), 1u) << "its time was over";
}

/// Before anything was written, a large state is taken to need longer than 2 % of the time so far.
TEST_F(CheckpointTest, TheFirstOneWaitsWhereWritingItTakesLong) {
    State::Values small, large;
    large.theta.textures.push_back({TextureId{0}, make_image(2048, 1024, 3)});  // 24 MiB
    EXPECT_NEAR(expected_writing_seconds(large), 0.1, 0.01);
    EXPECT_LT(expected_writing_seconds(small), 1e-5);
    const Ranks alone;
    CheckpointWriter writer(checkpoints, {}, alone, {});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    writer.offer({}, large, false);
    EXPECT_TRUE(files().empty());
    writer.offer({}, small, false);
    EXPECT_EQ(files().size(), 1u);
}

/// One that lies there already says nothing of how long the next one takes.
TEST_F(CheckpointTest, TheNextOneWaitsAsLongAsTheLastThatWasWrittenAsksFor) {
    test::on_ranks(2, [&](const Ranks& ranks) {
        std::chrono::milliseconds each{30};  // of an exchange, three of which writing needs
        Ranks slow = ranks;
        slow.exchange = [&](std::vector<std::string> messages) {
            std::this_thread::sleep_for(each);
            return ranks.exchange(std::move(messages));
        };
        State::Values state;
        CheckpointWriter writer(checkpoints, {}, slow, {});
        writer.offer({}, state, true);
        each = std::chrono::milliseconds(0);
        writer.offer({}, state, true);
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        state.iteration = 1;
        writer.offer({}, state, false);
    });
    EXPECT_EQ(files().size(), 1u);
}

/// A folder that is a file cannot hold checkpoints.
TEST_F(CheckpointTest, OnesThatCannotBeWrittenAreHeardOf) {
    Options options;
    options.stop.iterations = 2, options.evaluation_samples = 2;
    std::ofstream(checkpoints.folder) << "in the way";
    const auto expect_refused = [&](const Ranks& ranks) {
        const Problem own = test::of_rank(test::state_problem(), ranks);
        const auto fail = [](const Iteration&) {
            ADD_FAILURE() << "it runs";
            return Cancel;
        };
        try {
            solve(own, options, checkpoints, fail);
            ADD_FAILURE() << "it is not refused";
        } catch (const OutputError& e) {
            EXPECT_NE(std::string(e.what()).find("the folder cannot be made"), std::string::npos);
        }
    };
    for (const int count : {1, 2}) test::on_ranks(count, expect_refused);
    std::string error;
    checkpoints.note = [&](const CheckpointNote& note) { error = note.error; };
    EXPECT_EQ(solve(test::state_problem(), options, checkpoints).iterations.size(), 2u);
    EXPECT_NE(error.find("cannot be written"), std::string::npos) << error;
}

/// There is nothing else left of it: once there is an iteration, it is evaluated.
TEST_F(CheckpointTest, AStoppedRunThatCannotBeWrittenHasResults) {
    Options options;
    options.stop.iterations = 5, options.evaluation_samples = 2;
    std::ofstream(checkpoints.folder) << "in the way";
    const auto ends_after = [&](std::uint32_t iterations, Control control, bool stops) {
        Summary summary;
        test::on_ranks(2, [&](const Ranks& ranks) {
            std::atomic<bool> asked = iterations == 0;
            Checkpoints own = checkpoints;
            own.note = [](const CheckpointNote& note) { EXPECT_NE(note.error, ""); };
            if (stops) own.stop = [&] { return asked.load(); };
            const auto count = [&](const Iteration& i) {
                asked = i.number + 1 == iterations;
                return asked ? control : Continue;
            };
            Summary found = solve(test::of_rank(test::state_problem(), ranks), options, own, count);
            EXPECT_EQ(found.counts.iterations, iterations);
            if (ranks.rank == 0) summary = std::move(found);
        });
        EXPECT_EQ(summary.result.views.empty(), summary.ending == Ending::kSuspended);
        return summary.ending;
    };
    EXPECT_EQ(ends_after(2, Continue, true), Ending::kCancelled);
    EXPECT_EQ(ends_after(2, Cancel, true), Ending::kCancelled);
    EXPECT_EQ(ends_after(2, Suspend, true), Ending::kSuspended) << "as the callback asks";
    EXPECT_EQ(ends_after(2, Suspend, false), Ending::kSuspended);
    EXPECT_EQ(ends_after(5, Continue, true), Ending::kIterations);
    EXPECT_EQ(ends_after(0, Continue, true), Ending::kSuspended) << "there is nothing to evaluate";
}

}  // namespace
}  // namespace burnish
