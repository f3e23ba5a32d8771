// Parts of a pyramid, each stepped by a process of its own, and the pyramid that one process steps.
#include "optimize/shared_pyramid.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "burnish/error.h"
#include "core/archive.h"
#include "error_of.h"
#include "optimize/iterate.h"
#include "optimize/thread_ranks.h"
#include "optimize/view_problem.h"
#include "texture/pyramid_run.h"

namespace burnish {
namespace {

struct PyramidCase {
    int width, height, channels, levels;
    bool repeats, has_charts, starts_alike;
};

/// Wide and high ones, with rows that are no whole blocks; some too small for every process.
const std::vector<PyramidCase> kPyramidCases = {{96, 80, 3, 5, false, false, false},
                                                {37, 61, 1, 4, true, false, true},
                                                {53, 40, 3, 3, true, true, false},
                                                {128, 64, 1, 1, false, false, true},
                                                {8, 8, 1, 5, false, true, true}};

/// Random in some blocks, and nothing elsewhere.
SplitGradient sparse_gradient_of(const PyramidCase& c, std::uint32_t seed) {
    SplitGradient gradient;
    clear(gradient, c.width, c.height, c.channels);
    test::RandomSource random{seed};
    const std::size_t floats = gradient.first.values.size();
    for (std::size_t begin = 0; begin < floats; begin += kDirtyBlock) {
        if (random.next() > 0.2f) continue;
        const std::size_t end = std::min(floats, begin + kDirtyBlock);
        for (std::size_t k = begin; k < end; ++k)
            gradient.first.values[k] = random.next(-1, 1),
            gradient.second.values[k] = gradient.first.values[k] + random.next(-0.5f, 0.5f);
        mark_dirty(gradient.dirty, begin, end);
    }
    return gradient;
}

test::PyramidRun pyramid_run_of(const PyramidCase& c) {
    AdamOptions adam = test::default_adam();
    adam.gate = true, adam.learning_rate = 0.05f;
    const Image initial = c.starts_alike
                              ? make_image(c.width, c.height, c.channels, 0.4f)
                              : test::random_image(c.width, c.height, c.channels, 0.1f, 0.9f, 3);
    return test::make_run(c.levels, initial,
                          c.has_charts ? test::random_charts(c.width, c.height, 4) : ChartMap{},
                          c.repeats, adam);
}

GradientParts gradient_parts_of(const PyramidCase& c, const PyramidMaps& maps, int count) {
    GradientParts gradient{true, {}};
    for (int r = 0; r < count; ++r)
        gradient.parts.push_back(part_of(maps, c.channels, r, count).front().read);
    return gradient;
}

/// Where another search lets some texels start anew.
Image moved_start(const Image& start) {
    Image moved = start;
    for (std::size_t k = 0; k < moved.values.size(); k += 7) moved.values[k] = 0.75f;
    return moved;
}

void expect_same_steps(const PyramidCase& c, const Ranks& ranks) {
    test::PyramidRun whole = pyramid_run_of(c), own = pyramid_run_of(c);
    const Image start = whole.state.levels.front().values, moved = moved_start(start);
    keep_part(own.state, ranks.rank, ranks.count);
    const PyramidPart part = part_of(own.maps, c.channels, ranks.rank, ranks.count);
    const PartExchange exchange = exchange_of(ranks);
    Image expected = start, texture = start;
    const std::vector<GradientParts> all{gradient_parts_of(c, own.maps, 1)},
        parts{gradient_parts_of(c, own.maps, ranks.count)};
    ViewSum alone, shared;
    for (std::uint32_t i = 0; i < 6; ++i) {
        for (int r = 0; r < ranks.count; ++r) {
            const std::vector<SplitGradient> view{
                sparse_gradient_of(c, 100 * i + static_cast<std::uint32_t>(r))};
            add_node(static_cast<std::size_t>(r), 1, view, alone);
            if (r == ranks.rank) add_node(static_cast<std::size_t>(r), 1, view, shared);
        }
        test::descend(sum_of_views({}, all, alone).front(), whole, expected);
        descend({own.adam, own.maps, part, exchange}, sum_of_views(ranks, parts, shared).front(),
                own.state, own.workspace, texture);
        if (i == 3) {
            restart(whole.maps, start, moved, whole.state, expected);
            restart(own.maps, start, moved, own.state, texture, part.front().own.begin);
        }
        ASSERT_EQ(texture, expected) << ranks.rank << " of " << ranks.count << ", step " << i;
    }
    std::vector<PyramidState> gathered{own.state};
    gather_parts(ranks, gathered);
    EXPECT_TRUE(gathered.front() == whole.state) << ranks.rank << " of " << ranks.count;
}

TEST(SharedPyramid, AnyNumberOfPartsMakesTheBytesOfTheWhole) {
    for (std::size_t i = 0; i < kPyramidCases.size(); ++i) {
        SCOPED_TRACE(i);
        for (const int count : {1, 2, 3, 4, 7})
            test::on_ranks(count,
                           [&](const Ranks& ranks) { expect_same_steps(kPyramidCases[i], ranks); });
    }
}

/// The first of two processes, to which a message comes without its last byte.
Ranks with_a_byte_less(std::size_t message) {
    return {0, 2, [message](std::vector<std::string> messages) {
                messages[message].pop_back();
                return messages;
            }};
}

/// Of arrays in parts, and of one that is the first process's alone.
TEST(SharedPyramid, MessagesThatWereNotSentAreRefused) {
    const auto gather = [](const PyramidCase& c, std::size_t message) {
        std::vector<PyramidState> pyramids{pyramid_run_of(c).state};
        keep_part(pyramids.front(), 0, 2);
        gather_parts(with_a_byte_less(message), pyramids);
    };
    for (const std::size_t message : {0u, 1u}) {
        const Ranks ranks = with_a_byte_less(message);
        std::vector<double> sums(3);
        EXPECT_THROW(exchange_of(ranks).add_up(sums), Error) << message;
        EXPECT_THROW(gather(kPyramidCases.front(), message), Error) << message;
    }
    EXPECT_THROW(gather(kPyramidCases.back(), 0), Error);
}

/// Blocks that are cut off, and those that lie outside of the range of who sends them.
TEST(SharedPyramid, BlocksThatWereNotSentAreRefused) {
    const auto error = [](const std::function<void(std::string&)>& change) -> std::string {
        std::vector<float> values(200);
        DirtyBlocks dirty(dirty_blocks_in(values.size()), 1);
        const Ranks ranks{0, 2, [&](std::vector<std::string> messages) {
                              change(messages[1]);
                              return messages;
                          }};
        return test::error_of<Error>([&] { exchange_of(ranks).share_moved({{values, dirty}}); });
    };
    const auto blocks = [](std::uint64_t from, std::uint64_t to) {
        return [=](std::string& message) {
            message.clear();
            ArchiveWriter(sink_into(message))(from, to, std::array<float, 16>{}, ~std::uint64_t{0});
        };
    };
    const std::string kMessage = "a message of another process, ";
    EXPECT_EQ(error(blocks(0, 16)), "");
    EXPECT_EQ(error([](std::string& m) { m.pop_back(); }),
              kMessage + "byte 400: found 7 bytes more, expected at least 8");
    EXPECT_EQ(error([](std::string& m) { m += 'x'; }),
              kMessage + "byte 408: found 1 bytes more, expected the end");
    EXPECT_EQ(error(blocks(96, 112)),
              kMessage + "byte 16: found values 96 to 112, expected some of 104");
    EXPECT_EQ(error(blocks(16, 0)),
              kMessage + "byte 16: found values 16 to 0, expected some of 104");
    EXPECT_EQ(error(blocks(~std::uint64_t{0} - 15, 0)),
              kMessage + "byte 16: found values 18446744073709551600 to 0, expected some of 104");
}

TEST(SharedPyramid, PartsAreWholeBlocksThatMakeUpTheWhole) {
    for (const std::size_t floats : {1u, 47u, 48u, 500u, 4096u, 100003u})
        for (const int count : {1, 2, 3, 4, 7}) {
            std::size_t at = 0;
            for (int r = 0; r < count; ++r) {
                const IndexRange own = own_range(floats, r, count);
                if (own.size() == 0) continue;
                EXPECT_EQ(own.begin, at);
                EXPECT_TRUE(own.end % kDirtyBlock == 0 || own.end == floats);
                EXPECT_TRUE(own.size() > kDirtyBlock || own.size() == floats);
                at = own.end;
            }
            EXPECT_EQ(at, floats);
        }
}

/// Bytes of a run after two iterations that are the optimiser's.
struct OptimizerBytes {
    std::size_t state = 0;     ///< of its arrays in parts
    std::size_t gradient = 0;  ///< the sum over the views, and by the coarser levels
};

template <class T>
std::size_t bytes_held(const std::vector<T>& array) {
    return array.capacity() * sizeof(T);
}

std::size_t bytes_held(const SplitGradient& g) {
    return bytes_held(g.first.values) + bytes_held(g.second.values);
}

OptimizerBytes optimizer_bytes(const Problem& problem, const Options& options, const Ranks& ranks) {
    const Problem own = test::of_rank(problem, ranks);
    const Setup setup = make_setup(own, options);
    State::Values state = make_state(setup);
    for (PyramidState& p : state.pyramids) keep_part(p, ranks.rank, ranks.count);
    Workspace workspace = make_workspace(setup, state);
    for (int i = 0; i < 2; ++i) iterate(setup, state, workspace);
    OptimizerBytes bytes;
    for (const PyramidState& p : state.pyramids)
        for_parted_arrays(p, [&](const auto& array, std::size_t, std::size_t) {
            bytes.state += bytes_held(array);
        });
    for (const SplitGradient& g : workspace.sum.sum) bytes.gradient += bytes_held(g);
    for (const PyramidWorkspace& p : workspace.pyramids)
        for (const LevelWorkspace& level : p.levels) bytes.gradient += bytes_held(level.gradient);
    return bytes;
}

TEST(SharedPyramid, MemoryFallsWithTheNumberOfProcesses) {
    Problem problem = test::problem_of(test::scene_with_textures(8, 512));
    problem.views.resize(8, problem.views.front());
    Options options;
    options.estimator = PathCache{.samples = 1, .window = 1};
    options.batch = 8;
    const OptimizerBytes whole = optimizer_bytes(problem, options, {});
    for (const int count : {2, 4, 7})
        test::on_ranks(count, [&](const Ranks& ranks) {
            const OptimizerBytes own = optimizer_bytes(problem, options, ranks);
            const auto share = [&](std::size_t part, std::size_t all) {
                return static_cast<double>(part) / static_cast<double>(all) * count;
            };
            EXPECT_LT(share(own.state, whole.state), 1.02) << ranks.rank << " of " << count;
            // And the rows around a part that its coarser texels read, some 50 of 512.
            EXPECT_LT(share(own.gradient, whole.gradient), 1 + 0.13 * count)
                << ranks.rank << " of " << count;
        });
}

}  // namespace
}  // namespace burnish
