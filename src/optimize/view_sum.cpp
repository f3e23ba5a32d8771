#include "optimize/view_sum.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "core/contract.h"
#include "optimize/ranks.h"

namespace burnish {

namespace {

std::size_t floats_of(const GradientShape& s) {
    return static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height) *
           static_cast<std::size_t>(s.channels);
}

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

// Messages.

/// Floats of a gradient that a process completes: whole blocks.
struct FloatRange {
    std::size_t begin = 0, end = 0;
};

FloatRange range_of(const Ranks& ranks, int rank, const GradientShape& shape) {
    const std::size_t floats = floats_of(shape), blocks = dirty_blocks_in(floats);
    const auto at = [&](int r) {
        const std::size_t block =
            blocks * static_cast<std::size_t>(r) / static_cast<std::size_t>(ranks.count);
        return std::min(floats, block * kDirtyBlock);
    };
    return {at(rank), at(rank + 1)};
}

template <class T>
void put(std::string& message, const T& value) {
    message.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Runs of dirty blocks of a range: begin and end, counted from that of the range, and the floats.
void put_blocks(const SplitGradient& g, const FloatRange& range, std::string& message) {
    for_dirty_intervals(g.dirty, range.begin, range.end, [&](std::size_t from, std::size_t to) {
        put(message, std::uint64_t{from - range.begin});
        put(message, std::uint64_t{to - range.begin});
        for (const Image* half : {&g.first, &g.second})
            if (half->width > 0)
                message.append(reinterpret_cast<const char*>(&half->values[from]),
                               (to - from) * sizeof(float));
    });
    put(message, ~std::uint64_t{0});
}

/// Reads what put_* wrote.
class Message {
  public:
    explicit Message(const std::string& bytes) : bytes_(bytes) {}
    bool at_end() const { return at_ == bytes_.size(); }
    template <class T>
    T get() {
        T value;
        copy(&value, sizeof value);
        return value;
    }
    /// Into a gradient that is zero there.
    void get_blocks(std::size_t base, SplitGradient& g) {
        for (auto from = get<std::uint64_t>(); from != ~std::uint64_t{0};
             from = get<std::uint64_t>()) {
            const std::size_t begin = base + from, end = base + get<std::uint64_t>();
            BURNISH_REQUIRE(end, <=, g.first.values.size());
            for (Image* half : {&g.first, &g.second})
                if (half->width > 0) copy(&half->values[begin], (end - begin) * sizeof(float));
            mark_dirty(g.dirty, begin, end);
        }
    }

  private:
    void copy(void* to, std::size_t size) {
        BURNISH_REQUIRE(at_ + size, <=, bytes_.size());
        std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
    }
    const std::string& bytes_;
    std::size_t at_ = 0;
};

using GradientShapes = std::vector<GradientShape>;

/// Sends each process its range of our nodes.
std::vector<std::string> exchange_nodes(const Ranks& ranks, const GradientShapes& shapes,
                                        const ViewSum& views) {
    std::vector<std::string> messages(static_cast<std::size_t>(ranks.count));
    for (int r = 0; r < ranks.count; ++r)
        for (const ViewSumNode& node : views.nodes) {
            std::string& message = messages[static_cast<std::size_t>(r)];
            put(message, std::uint64_t{node.begin}), put(message, std::uint64_t{node.size});
            for (std::size_t i = 0; i < shapes.size(); ++i)
                put_blocks(node.gradient[i], range_of(ranks, r, shapes[i]), message);
        }
    return ranks.exchange(std::move(messages));
}

/// The next node, with this process's ranges in the place of whole textures.
void get_node(const Ranks& ranks, const GradientShapes& shapes, Message& message,
              ViewSumNode& node) {
    node.begin = message.get<std::uint64_t>(), node.size = message.get<std::uint64_t>();
    node.gradient.resize(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const FloatRange range = range_of(ranks, ranks.rank, shapes[i]);
        clear(node.gradient[i], static_cast<int>(range.end - range.begin), 1, 1, shapes[i].split);
        message.get_blocks(0, node.gradient[i]);
    }
}

/// All nodes on this process's range, in order.
void take_nodes(const Ranks& ranks, const GradientShapes& shapes,
                const std::vector<std::string>& messages, ViewSum& views) {
    std::size_t count = 0;
    for (const std::string& bytes : messages)
        for (Message message(bytes); !message.at_end(); ++count) {
            if (count == views.ranges.size()) views.ranges.emplace_back();
            get_node(ranks, shapes, message, views.ranges[count]);
        }
    views.ranges.resize(count);
    std::sort(views.ranges.begin(), views.ranges.end(),
              [](const ViewSumNode& a, const ViewSumNode& b) { return a.begin < b.begin; });
}

/// The ranges of the root, which lie in the first nodes of `ranges`, become its sum.
void gather_sum(const Ranks& ranks, const GradientShapes& shapes, ViewSum& views) {
    std::string mine;
    for (const SplitGradient& g : views.ranges.front().gradient)
        put_blocks(g, {0, g.first.values.size()}, mine);
    const std::vector<std::string> messages = all_gather(ranks, mine);
    views.sum.resize(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i)
        clear(views.sum[i], shapes[i].width, shapes[i].height, shapes[i].channels, shapes[i].split);
    for (int r = 0; r < ranks.count; ++r) {
        Message message(messages[static_cast<std::size_t>(r)]);
        for (std::size_t i = 0; i < shapes.size(); ++i)
            message.get_blocks(range_of(ranks, r, shapes[i]).begin, views.sum[i]);
    }
}

void release_nodes(ViewSum& views) {
    for (ViewSumNode& node : views.nodes) views.spare.push_back(std::move(node.gradient));
    views.nodes.clear();
}

}  // namespace

void add_view(std::size_t place, const std::vector<SplitGradient>& gradient, ViewSum& views) {
    ViewSumNode leaf{place, 1, {}};
    if (!views.spare.empty()) {
        leaf.gradient = std::move(views.spare.back());
        views.spare.pop_back();
    }
    leaf.gradient.resize(gradient.size());
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        const Image& g = gradient[i].first;
        clear(leaf.gradient[i], g.width, g.height, g.channels, gradient[i].second.width > 0);
        add(gradient[i], leaf.gradient[i]);
    }
    std::vector<ViewSumNode>& nodes = views.nodes;
    nodes.push_back(std::move(leaf));
    while (nodes.size() > 1) {
        ViewSumNode &a = nodes[nodes.size() - 2], &b = nodes.back();
        if (a.size != b.size || a.begin % (2 * a.size) != 0 || b.begin != a.begin + a.size) break;
        add_nodes(b, a);
        a.size *= 2;
        views.spare.push_back(std::move(b.gradient));
        nodes.pop_back();
    }
}

const std::vector<SplitGradient>& sum_of_views(const Ranks& ranks, const GradientShapes& shapes,
                                               ViewSum& views) {
    if (ranks.count == 1) {
        fold_all(views.nodes);
        std::swap(views.sum, views.nodes.front().gradient);
    } else {
        take_nodes(ranks, shapes, exchange_nodes(ranks, shapes, views), views);
        fold_all(views.ranges);
        gather_sum(ranks, shapes, views);
    }
    release_nodes(views);
    return views.sum;
}

}  // namespace burnish
