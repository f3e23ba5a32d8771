#include "optimize/view_sum.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "burnish/error.h"
#include "core/contract.h"
#include "optimize/block_message.h"
#include "optimize/ranks.h"

namespace burnish {

namespace {

void add_nodes(const ViewSumNode& from, ViewSumNode& to) {
    for (std::size_t i = 0; i < to.gradient.size(); ++i) add(from.gradient[i], to.gradient[i]);
}

/// Sums up the node [begin, begin + size) from nodes that fill it, of which nodes[at] is the first,
/// in the place of that one. Returns the place behind the last.
std::size_t fold(std::vector<ViewSumNode>& nodes, std::size_t at, std::size_t begin,
                 std::size_t size) {
    if (nodes[at].size == size) return at + 1;
    BURNISH_REQUIRE(size, >, nodes[at].size);
    const std::size_t half = size / 2;
    const std::size_t second = fold(nodes, at, begin, half);
    if (second == nodes.size() || nodes[second].begin >= begin + size) return second;
    const std::size_t end = fold(nodes, second, begin + half, half);
    add_nodes(nodes[second], nodes[at]);
    return end;
}

/// The root, in the place of the first.
void fold_all(std::vector<ViewSumNode>& nodes) {
    fold(nodes, 0, 0, std::bit_ceil(nodes.back().begin + nodes.back().size));
}

const KeptBlocks& part_of(const GradientParts& gradient, int rank) {
    return gradient.parts[static_cast<std::size_t>(rank)];
}

/// The halves of a gradient that there are.
template <class Gradient>
auto halves_of(Gradient& g) {
    std::vector<decltype(g.first.values.data())> halves{g.first.values.data()};
    if (g.second.width > 0) halves.push_back(g.second.values.data());
    return halves;
}

/// Sends each process its part of our nodes.
std::vector<std::string> exchange_nodes(const Ranks& ranks, const std::vector<GradientParts>& parts,
                                        const ViewSum& views) {
    std::vector<std::string> messages = to_each(ranks);
    for (int r = 0; r < ranks.count; ++r)
        for (const ViewSumNode& node : views.nodes) {
            ArchiveWriter message(sink_into(messages[static_cast<std::size_t>(r)]));
            message(node.begin, node.size);
            for (std::size_t i = 0; i < parts.size(); ++i)
                for (const IndexRange& range : part_of(parts[i], r).ranges)
                    put_blocks(halves_of(node.gradient[i]), node.gradient[i].dirty, range, message);
        }
    return ranks.exchange(std::move(messages));
}

/// The next node, of which the message has this process's part.
void get_node(const Ranks& ranks, const std::vector<GradientParts>& parts, ArchiveReader& message,
              ViewSumNode& node) {
    message(node.begin, node.size);
    node.gradient.resize(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const KeptBlocks& part = part_of(parts[i], ranks.rank);
        SplitGradient& g = node.gradient[i];
        clear(g, static_cast<int>(part.size()), 1, 1, parts[i].split);
        for (const IndexRange& range : part.ranges) {
            const std::size_t at = part.place_of(range.begin);
            get_blocks(halves_of(g), {at, at + range.size()}, g.dirty, message);
        }
    }
}

/// Throws Error where the nodes overlap, are out of order or do not fit into one tree, or where
/// there is none. That no band is missing is not checked.
void require_nodes(const std::vector<ViewSumNode>& nodes) {
    constexpr std::size_t kMaxBands = std::size_t{1} << 48;  // more than any batch has
    std::size_t end = 0;
    for (const ViewSumNode& n : nodes) {
        if (n.begin < end || n.begin > kMaxBands || n.size > kMaxBands ||
            !std::has_single_bit(n.size) || n.begin % n.size != 0)
            throw Error(fmt::format(
                "an exchange gave a sum over {} bands from {} on, expected each band once", n.size,
                n.begin));
        end = n.begin + n.size;
    }
    if (end == 0) throw Error("an exchange gave no sums over bands, expected those of all views");
}

/// All nodes on this process's part, in order.
void take_nodes(const Ranks& ranks, const std::vector<GradientParts>& parts,
                const std::vector<std::string>& messages, ViewSum& views) {
    std::size_t count = 0;
    for (const std::string& bytes : messages)
        for (ArchiveReader message = reader_of(bytes); message.left() > 0; ++count) {
            if (count == views.parts.size()) views.parts.emplace_back();
            get_node(ranks, parts, message, views.parts[count]);
        }
    views.parts.resize(count);
    std::sort(views.parts.begin(), views.parts.end(),
              [](const ViewSumNode& a, const ViewSumNode& b) { return a.begin < b.begin; });
    require_nodes(views.parts);
}

void release_nodes(ViewSum& views) {
    for (ViewSumNode& node : views.nodes) views.spare.push_back(std::move(node.gradient));
    views.nodes.clear();
}

}  // namespace

void add_node(std::size_t begin, std::size_t size, const std::vector<SplitGradient>& gradient,
              ViewSum& views) {
    ViewSumNode node{begin, size, {}};
    if (!views.spare.empty()) {
        node.gradient = std::move(views.spare.back());
        views.spare.pop_back();
    }
    node.gradient.resize(gradient.size());
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        const Image& g = gradient[i].first;
        clear(node.gradient[i], g.width, g.height, g.channels, gradient[i].second.width > 0);
        add(gradient[i], node.gradient[i]);
    }
    std::vector<ViewSumNode>& nodes = views.nodes;
    nodes.push_back(std::move(node));
    while (nodes.size() > 1) {
        ViewSumNode &a = nodes[nodes.size() - 2], &b = nodes.back();
        if (a.size != b.size || a.begin % (2 * a.size) != 0 || b.begin != a.begin + a.size) break;
        add_nodes(b, a);
        a.size *= 2;
        views.spare.push_back(std::move(b.gradient));
        nodes.pop_back();
    }
}

const std::vector<SplitGradient>& sum_of_views(const Ranks& ranks,
                                               const std::vector<GradientParts>& parts,
                                               ViewSum& views) {
    if (ranks.count == 1) {
        fold_all(views.nodes);
        std::swap(views.sum, views.nodes.front().gradient);
    } else {
        take_nodes(ranks, parts, exchange_nodes(ranks, parts, views), views);
        fold_all(views.parts);
        std::swap(views.sum, views.parts.front().gradient);
    }
    release_nodes(views);
    return views.sum;
}

}  // namespace burnish
