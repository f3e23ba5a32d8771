// The sum over views: its tree against one that is written down plainly, for any number of
// processes and any part of the views that each has.
#include "optimize/view_sum.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "burnish/error.h"
#include "error_of.h"
#include "optimize/ranks.h"
#include "optimize/thread_ranks.h"

namespace burnish {
namespace {

struct TextureShape {
    int width, height, channels;
};
constexpr TextureShape kShapes[] = {{37, 5, 3}, {1, 1, 1}, {64, 64, 1}};

/// Each process gets all of each gradient.
std::vector<GradientParts> all_to_each(int count, bool split) {
    std::vector<GradientParts> gradients;
    for (const TextureShape& s : kShapes) {
        const auto floats = static_cast<std::size_t>(s.width * s.height * s.channels);
        gradients.push_back({split, std::vector<KeptBlocks>(static_cast<std::size_t>(count),
                                                            KeptBlocks{{{0, floats}}})});
    }
    return gradients;
}

/// Gradients of views, most of whose blocks are clean.
std::vector<std::vector<SplitGradient>> gradients_of(std::size_t views, bool split = true) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> value(-1, 1);
    std::vector<std::vector<SplitGradient>> all(views);
    for (auto& gradient : all)
        for (const TextureShape& s : kShapes) {
            SplitGradient& g = gradient.emplace_back();
            clear(g, s.width, s.height, s.channels, split);
            const std::size_t floats = g.first.values.size();
            for (std::size_t b = 0; b < dirty_blocks_in(floats); ++b) {
                if (random() % 3 > 0) continue;
                const std::size_t begin = b * kDirtyBlock;
                const std::size_t end = std::min(floats, begin + kDirtyBlock);
                for (std::size_t i = begin; i < end; ++i) {
                    g.first.values[i] = value(random);
                    if (split) g.second.values[i] = value(random);
                }
                mark_dirty(g.dirty, begin, end);
            }
        }
    return all;
}

/// The definition: a node is the sum of its two halves.
std::vector<float> tree_sum(const std::vector<std::vector<float>>& leaves, std::size_t begin,
                            std::size_t size) {
    if (size == 1) return leaves[begin];
    std::vector<float> sum = tree_sum(leaves, begin, size / 2);
    if (begin + size / 2 >= leaves.size()) return sum;
    const std::vector<float> right = tree_sum(leaves, begin + size / 2, size / 2);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += right[i];
    return sum;
}

void expect_tree_sum(const std::vector<std::vector<SplitGradient>>& gradients,
                     const std::vector<SplitGradient>& sum) {
    for (std::size_t u = 0; u < sum.size(); ++u)
        for (const bool second : {false, true}) {
            std::vector<std::vector<float>> leaves;
            for (const auto& g : gradients)
                leaves.push_back(second ? g[u].second.values : g[u].first.values);
            const auto& found = second ? sum[u].second.values : sum[u].first.values;
            EXPECT_EQ(found, tree_sum(leaves, 0, std::bit_ceil(leaves.size()))) << u;
            for (std::size_t i = 0; i < found.size(); ++i)
                EXPECT_TRUE(found[i] == 0 || sum[u].dirty[i / kDirtyBlock]) << u << " " << i;
        }
}

TEST(ViewSumTest, IsATreeForAnyNumberOfViews) {
    ViewSum work;
    for (std::size_t views = 1; views <= 19; ++views) {
        const auto gradients = gradients_of(views);
        for (std::size_t k = 0; k < views; ++k) add_node(k, 1, gradients[k], work);
        expect_tree_sum(gradients, sum_of_views({}, all_to_each(1, true), work));
        EXPECT_LE(work.spare.size(), 7u) << "memory grows with the logarithm";
    }
}

TEST(ViewSumTest, IsTheSameForAnyProcessesAndViews) {
    for (const int count : {2, 3, 5, 8})
        for (const bool split : {true, false}) {
            const std::vector<GradientParts> parts = all_to_each(count, split);
            test::on_ranks(count, [&](const Ranks& ranks) {
                ViewSum work;
                std::mt19937 random(static_cast<unsigned>(count));  // the same on all of them
                for (const std::size_t views : {8u, 8u, 13u, 1u, 6u}) {
                    const auto gradients = gradients_of(views, split);
                    int owner = 0;  // in ascending order; some have no view
                    for (std::size_t k = 0; k < views; ++k) {
                        if (owner + 1 < count) owner += static_cast<int>(random() % 2);
                        if (owner == ranks.rank) add_node(k, 1, gradients[k], work);
                    }
                    const std::vector<SplitGradient>& sum = sum_of_views(ranks, parts, work);
                    ViewSum alone;
                    for (std::size_t k = 0; k < views; ++k) add_node(k, 1, gradients[k], alone);
                    const std::vector<SplitGradient>& expected = sum_of_views({}, parts, alone);
                    for (std::size_t u = 0; u < parts.size(); ++u) {
                        EXPECT_EQ(sum[u].first.values, expected[u].first.values) << views;
                        EXPECT_EQ(sum[u].second.values, expected[u].second.values) << views;
                        EXPECT_EQ(sum[u].dirty, expected[u].dirty) << views;
                    }
                }
            });
        }
}

TEST(ViewSumTest, MessagesThatWereNotSentAreRefused) {
    using Messages = std::vector<std::string>;
    const auto gradient = gradients_of(1).front();
    const auto error = [&](const std::function<void(Messages&)>& change) -> std::string {
        const Ranks ranks{0, 2, [&](Messages messages) {
                              change(messages);
                              return messages;
                          }};
        ViewSum work;
        add_node(0, 1, gradient, work);
        return test::error_of<Error>([&] { sum_of_views(ranks, all_to_each(2, true), work); });
    };
    EXPECT_EQ(error([](Messages& m) { m[1].clear(); }), "");
    EXPECT_EQ(error([](Messages& m) {
                  m = {"", ""};
              }),
              "an exchange gave no sums over bands, expected those of all views");
    EXPECT_EQ(error([](Messages&) {}),
              "an exchange gave a sum over 1 bands from 0 on, expected each band once");
    const std::string cut = error([](Messages& m) { m[1].pop_back(); });
    EXPECT_NE(cut.find("found 7 bytes more, expected at least 8"), std::string::npos) << cut;
}

TEST(RanksTest, ValuesOfOthersArrive) {
    test::on_ranks(3, [](const Ranks& ranks) {
        EXPECT_EQ(agree(ranks, 10 + ranks.rank), 10);
        EXPECT_EQ(all_values(ranks, 2.5 * ranks.rank), (std::vector<double>{0, 2.5, 5}));
        const std::vector<int> owners = shared_out(ranks, 7);
        EXPECT_EQ(owners, (std::vector<int>{0, 0, 0, 1, 1, 2, 2}));
        for (const Recipient recipient : {Recipient::kAll, Recipient::kFirst}) {
            std::vector<std::string> items(7);
            for (std::size_t i = 0; i < items.size(); ++i)
                if (owners[i] == ranks.rank) items[i] = std::string(i * 1000, 'x');
            share(ranks, owners, recipient, items);
            for (std::size_t i = 0; i < items.size(); ++i) {
                const bool known =
                    recipient == Recipient::kAll || ranks.rank == 0 || owners[i] == ranks.rank;
                EXPECT_EQ(items[i].size(), known ? i * 1000 : 0);
            }
        }
    });
}

}  // namespace
}  // namespace burnish
