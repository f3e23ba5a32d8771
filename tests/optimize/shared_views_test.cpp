// Several processes share out the bands of a view, where there are fewer views than processes.
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "burnish/checkpoint.h"
#include "core/parallel.h"
#include "optimize/checkpoint_folder.h"
#include "optimize/memory.h"
#include "optimize/owners.h"
#include "optimize/ranks.h"
#include "optimize/same_run.h"
#include "optimize/state_cases.h"
#include "optimize/thread_ranks.h"
#include "optimize/view_problem.h"

namespace burnish {
namespace {

/// Views of several tiles each: so many that are fitted, and one that is held out. The second one
/// has an exposure to fit.
Problem problem_to_share(std::size_t fitted) {
    Problem problem = test::problem_with_views(test::scene_with_textures(90, 80));
    const std::vector<View> views = problem.views;
    problem.views = {views[0], views[3]};
    if (fitted > 1) {
        problem.views.push_back(views[1]);
        problem.views.back().exposure = FitExposure{};
    }
    return problem;
}

Options options_to_share(std::size_t fitted) {
    Options options = test::options_for_ranks(PathCache{.samples = 2, .window = 3},
                                              static_cast<std::uint32_t>(fitted));
    options.stop.iterations = 5;
    return options;
}

TEST(SharedViews, EachBandHasOneOwner) {
    for (const int count : {2, 3, 4, 7, 40})
        for (std::size_t views = 1; views < static_cast<std::size_t>(count); ++views) {
            std::size_t min = views * kViewBands, max = 0;
            std::vector<int> owners;
            for (int r = 0; r < count; ++r) {
                std::size_t own = 0;
                for (std::size_t v = 0; v < views; ++v) {
                    const IndexRange bands = bands_of({0, count}, r, v, views, true);
                    own += bands.size();
                    EXPECT_LE(bands.end, kViewBands);
                }
                owners.insert(owners.end(), own, r);
                min = std::min(min, own), max = std::max(max, own);
            }
            EXPECT_EQ(owners.size(), views * kViewBands);
            EXPECT_LE(max - min, 1u);
            // The first owner of a view is the one that would have all of it.
            for (std::size_t v = 0; v < views; ++v)
                EXPECT_EQ(owners[v * kViewBands], owner_of({0, count}, v, views));
        }
    EXPECT_EQ(bands_of({0, 3}, 1, 0, 2, true), (IndexRange{22, 32}));
    EXPECT_EQ(bands_of({0, 3}, 1, 1, 2, true), (IndexRange{0, 11}));
    EXPECT_EQ(bands_of({0, 3}, 1, 1, 2, false), kAllBands);
    EXPECT_EQ(bands_of({0, 3}, 1, 4, 9, true), kAllBands);
    EXPECT_TRUE(bands_of({0, 3}, 1, 0, 9, true).empty());
}

/// Of the records and of the background's rows a process has those of its bands, and no others.
void expect_own_bands(const State::Values& found, const State::Values& whole, const Ranks& ranks) {
    const std::size_t views = whole.views.size();
    for (std::size_t v = 0; v < views; ++v) {
        const IndexRange bands = bands_of(ranks, ranks.rank, v, views, true);
        if (bands.empty()) {
            EXPECT_EQ(found.views[v].visits, 0u);
            continue;
        }
        ViewState own = whole.views[v];
        for (CacheHalf& half : std::get<PathCacheState>(own.estimator).halves)
            for (CachedPass& pass : half.passes) {
                const IndexRange tiles = tiles_of(bands, pass.tiles.size());
                for (std::size_t i = 0; i < pass.tiles.size(); ++i)
                    if (i < tiles.begin || i >= tiles.end) pass.tiles[i] = {};
            }
        for (Background& b : own.backgrounds) b = rows_of(b, items_of(bands, 90));
        EXPECT_TRUE(found.views[v] == own) << ranks.rank << " of " << ranks.count;
    }
}

TEST(SharedViews, AnyNumberMakesTheSameBytes) {
    for (const std::size_t fitted : {1u, 2u}) {
        const Problem problem = problem_to_share(fitted);
        const Options options = options_to_share(fitted);
        const Summary whole = solve(problem, options);
        for (const int count : {2, 3, 4, 7}) {
            if (static_cast<std::size_t>(count) <= fitted) continue;
            test::on_ranks(count, [&](const Ranks& ranks) {
                const Problem own = test::of_rank(problem, ranks);
                const Summary found = solve(own, options);
                test::expect_same_run(found, whole, ranks);
                expect_own_bands(found.state.values(), whole.state.values(), ranks);
            });
        }
    }
}

TEST(SharedViews, ThreadsDecideOnNoByte) {
    const Problem problem = problem_to_share(1);
    Options options = options_to_share(1);
    options.stop.iterations = 3;
    const Summary whole = solve(problem, options);
    for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        test::on_ranks(3, [&](const Ranks& ranks) {
            const Problem own = test::of_rank(problem, ranks);
            test::expect_same_run(solve(own, options), whole, ranks);
        });
    }
}

/// They share out whole views, so that some have none.
TEST(SharedViews, OtherEstimatorsMakeTheSameBytes) {
    const Problem problem = problem_to_share(1);
    for (const Estimator& estimator :
         {Estimator{MonteCarlo{2, 1}}, Estimator{Reservoirs{.image_samples = 2, .samples = 1}}}) {
        Options options = options_to_share(1);
        options.estimator = estimator;
        const Summary whole = solve(problem, options);
        test::on_ranks(3, [&](const Ranks& ranks) {
            const Problem own = test::of_rank(problem, ranks);
            const Summary found = solve(own, options);
            test::expect_same_run(found, whole, ranks);
            EXPECT_EQ(found.state.values().views[0].visits, ranks.rank == 0 ? 5u : 0u);
        });
    }
}

/// All processes render each picture of a check together.
TEST(SharedViews, ChecksOfPatienceMakeTheSameBytes) {
    const Problem problem = problem_to_share(1);
    Options options = options_to_share(1);
    options.stop = {.iterations = 21, .patience = 1};
    const Summary whole = solve(problem, options);
    EXPECT_TRUE(whole.iterations[19].held_out_loss);
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        test::expect_same_run(solve(own, options), whole, ranks);
    });
}

/// Where no memory holds a pass of each view, records are dropped after each visit.
TEST(SharedViews, WithoutKeptRecordsToo) {
    const Problem problem = problem_to_share(2);
    Options options = options_to_share(2);
    PathCache& cache = std::get<PathCache>(options.estimator);
    std::vector<TracedScene> views;
    const auto setup = make_setup(problem, options);
    for (const std::size_t v : setup.fitted) views.push_back(scene_of(setup, v));
    const Theta theta = initial_theta(setup);
    const auto plans = plan_caches(cache, views, reaching_pixels(views, theta), theta);
    cache.max_bytes = 3 * max_bytes_per_pass(plans);
    ASSERT_FALSE(share_memory(cache, plans).keeps_records);
    const Summary whole = solve(problem, options);
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        test::expect_same_run(solve(own, options), whole, ranks);
    });
}

/// Of a loss that all owners of a view compute.
TEST(SharedViews, CountWhatIsLeftOutOnce) {
    Problem problem = problem_to_share(1);
    problem.loss = [](const Image& image, std::size_t) {
        LossValue loss{1, image};
        for (std::size_t i = 0; i < loss.adjoint.values.size(); ++i)
            if (i % 7 == 0) loss.adjoint.values[i] = std::numeric_limits<float>::infinity();
        return loss;
    };
    const Options options = options_to_share(1);
    Solver whole(problem, options);
    const Iteration expected = whole.step();
    EXPECT_GT(expected.rejected_image, 100u);
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        Solver solver(own, options);
        const Iteration found = solver.step();
        EXPECT_EQ(found.rejected_image, expected.rejected_image);
        EXPECT_EQ(found.rejected_derivatives, expected.rejected_derivatives);
        EXPECT_EQ(found.paths, expected.paths);
    });
}

/// Of one view, which all processes render together, and of several, which one of them does each.
TEST(SharedViews, EvaluationsCountWhatIsLeftOutOnce) {
    for (const std::size_t fitted : {1u, 3u}) {
        Scene scene = test::scene_with_textures(20, 8);
        std::get<AreaEmitter>(scene.emitters[0]).radiance.y =
            std::numeric_limits<float>::quiet_NaN();
        Problem problem = test::problem_with_views(scene);
        if (fitted == 1) problem.views.resize(1);
        const Options options = options_to_share(fitted);
        const Evaluation whole = Solver(problem, options).evaluate(4);
        EXPECT_GT(whole.rejected, 100u);
        test::on_ranks(2, [&](const Ranks& ranks) {
            EXPECT_EQ(Solver(test::of_rank(problem, ranks), options).evaluate(4).rejected,
                      whole.rejected);
        });
    }
}

struct SharedViewsAndCheckpoints : test::CheckpointFolder {};

TEST_F(SharedViewsAndCheckpoints, ARunGoesOnWithAnotherNumber) {
    for (const std::size_t fitted : {1u, 2u})
        test::expect_to_go_on_with_others(problem_to_share(fitted), options_to_share(fitted),
                                          checkpoints, {{3, 1}, {7, 2}, {1, 3}, {4, 4}}, 3);
}

TEST_F(SharedViewsAndCheckpoints, BandsAreSentInSlices) {
    const Problem problem = problem_to_share(2);
    Options options = options_to_share(2);
    options.stop.iterations = 3;
    const std::string expected = test::archive_of(solve(problem, options).state.values());
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        const State part = solve(own, options).state;
        test::expect_whole_in_slices(part.values(), ranks, expected, 50000);
        test::expect_few_exchanges(part.values(), ranks);
    });
}

/// What a process reads of a whole state, and keeps of one that it is given, is what it had.
TEST_F(SharedViewsAndCheckpoints, AProcessKeepsItsBandsOfAState) {
    const Problem problem = problem_to_share(2);
    Options options = options_to_share(2);
    options.stop.iterations = 3;
    const State whole = solve(problem, options, checkpoints).state;
    test::on_ranks(3, [&](const Ranks& ranks) {
        const Problem own = test::of_rank(problem, ranks);
        const std::vector<ViewState> expected = solve(own, options).state.values().views;
        const auto setup = make_setup(own, options);
        State::Values read = load_checkpoint(checkpoints.folder, ranks).run.state.values();
        State::Values given = whole.values();
        drop_views_of_others(setup, read), drop_views_of_others(setup, given);
        EXPECT_TRUE(read.views == expected);
        EXPECT_TRUE(given.views == expected);
        Solver solver(own, options, whole);
        EXPECT_TRUE(solver.state().values().views == expected);
    });
}

TEST(SharedViews, ABackgroundThatIsNotWholeIsRefused) {
    const auto error_with = [](const Background& background) {
        State::Values state, read;
        state.views.resize(1);
        state.views[0].estimator = PathCacheState{};
        state.views[0].backgrounds = {background};
        const std::string bytes = test::archive_of(state);
        const Ranks ranks{1, 2, {}};
        OwnState own{read, ranks};
        return test::error_of<Error>([&] { reader_of(bytes)(own); });
    };
    const Background whole{make_image(4, 8, 3, 0.5f), std::vector<std::uint32_t>(32, 1), 1};
    EXPECT_EQ(error_with(whole), "");
    EXPECT_EQ(error_with({}), "");
    Background few_counts = whole, few_values = whole, gray = whole, high = whole, below = whole,
               counts_alone;
    few_counts.counts.resize(3);
    few_values.mean.values.resize(3), few_values.counts.resize(1);
    gray.mean = make_image(4, 8, 1, 0.5f);
    high.mean.height = 1 << 30;
    below.mean.width = below.mean.height = -4;
    counts_alone.counts.resize(3);
    for (const Background& background : {few_counts, few_values, gray, high, below, counts_alone})
        EXPECT_NE(error_with(background).find("expected a count for each pixel of three values"),
                  std::string::npos)
            << error_with(background);
}

}  // namespace
}  // namespace burnish
