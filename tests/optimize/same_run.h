// Runs of several processes, and that of one that they have to be.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <vector>

#include "burnish/checkpoint.h"
#include "optimize/state.h"
#include "optimize/thread_ranks.h"
#include "optimize/whole_state.h"

namespace burnish::test {

inline Options options_for_ranks(const Estimator& estimator, std::uint32_t batch) {
    Options options;
    options.estimator = estimator;
    options.batch = batch;
    options.background_samples = 4;
    options.evaluation_samples = 4;
    options.stop.iterations = 9;
    return options;
}

/// All but images that lie with other processes.
inline void expect_same_evaluation(const Evaluation& found, const Evaluation& whole,
                                   const Ranks& ranks) {
    EXPECT_EQ(found.loss, whole.loss);
    EXPECT_EQ(found.rejected, whole.rejected);
    const bool is_unknown = std::isnan(found.noise_floor) && std::isnan(whole.noise_floor);
    EXPECT_TRUE(found.noise_floor == whole.noise_floor || is_unknown);
    ASSERT_EQ(found.views.size(), whole.views.size());
    for (std::size_t v = 0; v < whole.views.size(); ++v) {
        const ViewEvaluation &x = found.views[v], &y = whole.views[v];
        EXPECT_TRUE(x.loss == y.loss && x.psnr == y.psnr && x.exposure == y.exposure) << v;
        if (ranks.rank > 0 && x.image.width == 0) continue;
        EXPECT_EQ(x.image, y.image) << v;
    }
}

/// What the searches for the start have tried.
inline void expect_same_search(const std::vector<SearchedGroup>& found,
                               const std::vector<SearchedGroup>& whole) {
    ASSERT_EQ(found.size(), whole.size());
    for (std::size_t g = 0; g < whole.size(); ++g) {
        EXPECT_EQ(found[g].unknowns, whole[g].unknowns) << g;
        EXPECT_EQ(found[g].guides, whole[g].guides) << g;
        ASSERT_EQ(found[g].tried.size(), whole[g].tried.size()) << g;
        for (std::size_t t = 0; t < whole[g].tried.size(); ++t) {
            const SearchedValues &x = found[g].tried[t], &y = whole[g].tried[t];
            EXPECT_TRUE(x.values == y.values && x.loss == y.loss && x.regions == y.regions)
                << g << ", " << t;
        }
    }
}

/// All but times, and what lies with other processes.
inline void expect_same_run(const Summary& found, const Summary& whole, const Ranks& ranks) {
    const State::Values &a = found.state.values(), &b = whole.state.values();
    EXPECT_TRUE(a.theta == b.theta && a.pyramids == b.pyramids) << ranks.rank;
    EXPECT_TRUE(a.patience == b.patience && a.searched == b.searched &&
                a.search_costs == b.search_costs && a.searched_again == b.searched_again);
    expect_same_search(found.searched, whole.searched);
    expect_same_evaluation(found.start, whole.start, ranks);
    expect_same_evaluation(found.result, whole.result, ranks);
    EXPECT_EQ(found.counts.iterations, whole.counts.iterations);
    EXPECT_EQ(found.counts.paths, whole.counts.paths);
    EXPECT_EQ(found.counts.derivatives, whole.counts.derivatives);
    ASSERT_EQ(found.iterations.size(), whole.iterations.size());
    for (std::size_t i = 0; i < whole.iterations.size(); ++i) {
        const Iteration &x = found.iterations[i], &y = whole.iterations[i];
        EXPECT_EQ(x.number, y.number);
        EXPECT_EQ(x.loss, y.loss) << i;
        EXPECT_EQ(x.held_out_loss, y.held_out_loss) << i;
        EXPECT_TRUE(x.paths == y.paths && x.derivatives == y.derivatives && x.texels == y.texels &&
                    x.reservoirs == y.reservoirs && x.rejected_image == y.rejected_image &&
                    x.rejected_derivatives == y.rejected_derivatives)
            << i;
    }
    ASSERT_EQ(found.textures.size(), whole.textures.size());
    for (std::size_t u = 0; u < whole.textures.size(); ++u) {
        EXPECT_EQ(found.textures[u].values, whole.textures[u].values);
        EXPECT_EQ(found.textures[u].start, whole.textures[u].start);
        EXPECT_EQ(found.textures[u].coverage, whole.textures[u].coverage);
        EXPECT_EQ(found.textures[u].confidence, whole.textures[u].confidence);
    }
}

inline Callback stop_after(std::uint32_t iterations) {
    return [=](const Iteration& i) { return i.number + 1 >= iterations ? Suspend : Continue; };
}

inline std::string archive_of(const State::Values& values) {
    std::string bytes;
    ArchiveWriter{sink_into(bytes)}(values);
    return bytes;
}

/// What the first process writes, whatever the size of the slices that it asks for, `min` or
/// more; the others write nothing.
inline void expect_whole_in_slices(const State::Values& part, const Ranks& ranks,
                                   const std::string& expected, std::size_t min = 1000) {
    for (const std::size_t slice : {min, 4 * min, expected.size()}) {
        std::string bytes;
        const WholeState state{part, ranks, slice};
        write_whole(state, [&] { ArchiveWriter{sink_into(bytes)}(state); });
        EXPECT_TRUE(bytes == (ranks.rank == 0 ? expected : "")) << slice;
    }
}

/// Of what fits into one slice, however many arrays and passes that is: which arrays lie in parts,
/// what is asked for, what comes, the end, and whether the file was written.
inline void expect_few_exchanges(const State::Values& part, const Ranks& ranks) {
    int exchanges = 0;
    Ranks counted = ranks;
    counted.exchange = [&](std::vector<std::string> messages) {
        ++exchanges;
        return ranks.exchange(std::move(messages));
    };
    const WholeState state{part, counted};
    write_whole(state, [&] { ArchiveWriter{[](const void*, std::size_t) {}}(state); });
    EXPECT_EQ(exchanges, 5);
}

/// A run of so many processes, up to the number of iterations where it is stopped.
struct Leg {
    int processes = 1;
    std::uint32_t iterations = 0;
};

/// A run goes on with another number of processes on each leg, and ends with `last` of them.
inline void expect_to_go_on_with_others(const Problem& problem, const Options& options,
                                        const Checkpoints& checkpoints,
                                        const std::vector<Leg>& legs, int last) {
    const Summary whole = solve(problem, options);
    std::filesystem::remove_all(checkpoints.folder);
    for (const Leg& leg : legs) {
        const Callback stop = stop_after(leg.iterations);
        const bool is_first = &leg == &legs.front();
        on_ranks(leg.processes, [&](const Ranks& ranks) {
            const Problem own = of_rank(problem, ranks);
            if (is_first)
                solve(own, options, checkpoints, stop);
            else
                solve(own, options, load_checkpoint(checkpoints.folder, ranks), checkpoints, stop);
        });
        ASSERT_EQ(load_checkpoint(checkpoints.folder).run.state,
                  solve(problem, options, stop).state)
            << "the file of one process, written by " << leg.processes;
    }
    on_ranks(last, [&](const Ranks& ranks) {
        const Problem own = of_rank(problem, ranks);
        expect_same_run(
            solve(own, options, load_checkpoint(checkpoints.folder, ranks), checkpoints), whole,
            ranks);
    });
}

}  // namespace burnish::test
