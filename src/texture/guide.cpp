#include "texture/guide.h"

#include <algorithm>
#include <array>

namespace burnish {

namespace {

constexpr std::uint32_t kMaxLeaves = 64;
constexpr double kMinRows = 32;
/// What a split must explain, in units of the leaf's variance: the best of thousands that explain
/// nothing stays below.
constexpr double kSignificant = 20;
constexpr std::size_t kBins = 64;

/// Thresholds of each column between bins of about as many rows.
std::vector<std::vector<float>> make_thresholds(const Rows& known,
                                                const std::vector<std::uint32_t>& rows) {
    std::vector<std::vector<float>> thresholds(known.width);
    for (std::size_t c = 0; c < known.width; ++c) {
        std::vector<float> sorted;
        for (const std::uint32_t r : rows) sorted.push_back(known[r][c]);
        std::sort(sorted.begin(), sorted.end());
        for (std::size_t b = 1; b < kBins && !sorted.empty(); ++b)
            thresholds[c].push_back(sorted[b * sorted.size() / kBins]);
        thresholds[c].erase(std::unique(thresholds[c].begin(), thresholds[c].end()),
                            thresholds[c].end());
        if (!sorted.empty() && !thresholds[c].empty() && thresholds[c].front() == sorted.front())
            thresholds[c].erase(thresholds[c].begin());  // nothing lies below
    }
    return thresholds;
}

/// Of some rows: how many, and the sums of their unknown values and squares.
struct Moments {
    double count = 0, squares = 0;
    std::vector<double> sums;

    void add(std::span<const float> row) {
        sums.resize(row.size());
        ++count;
        for (std::size_t m = 0; m < row.size(); ++m)
            sums[m] += double{row[m]}, squares += double{row[m]} * double{row[m]};
    }
    void add(const Moments& other, double sign) {
        sums.resize(std::max(sums.size(), other.sums.size()));
        count += sign * other.count, squares += sign * other.squares;
        for (std::size_t m = 0; m < other.sums.size(); ++m) sums[m] += sign * other.sums[m];
    }
    /// The sum of squared differences to the mean.
    double spread() const {
        double s = squares;
        for (const double sum : sums) s -= count > 0 ? sum * sum / count : 0;
        return std::max(0.0, s);
    }
};

struct Split {
    double gain = 0;  ///< of the sum of squares; 0: none
    std::uint32_t column = 0;
    float threshold = 0;
};

struct Growth {
    const Rows &known, &unknown;
    std::vector<std::vector<float>> thresholds;  ///< of each column
};

Split best_split(const Growth& g, const std::vector<std::uint32_t>& rows) {
    constexpr double kRounding = 1e-9;  // what is left of the spread of rows that are alike
    Moments all;
    for (const std::uint32_t r : rows) all.add(g.unknown[r]);
    const double spread = all.spread();
    if (spread <= kRounding * all.squares) return {};
    Split best{kSignificant * spread / std::max(1.0, all.count), 0, 0};
    bool found = false;
    for (std::uint32_t c = 0; c < g.known.width; ++c) {
        const std::vector<float>& t = g.thresholds[c];
        std::vector<Moments> bins(t.size() + 1);
        for (const std::uint32_t r : rows) {
            const auto at = std::upper_bound(t.begin(), t.end(), g.known[r][c]) - t.begin();
            bins[static_cast<std::size_t>(at)].add(g.unknown[r]);
        }
        Moments below, above = all;
        for (std::size_t b = 0; b < t.size(); ++b) {
            below.add(bins[b], 1), above.add(bins[b], -1);
            if (below.count < kMinRows || above.count < kMinRows) continue;
            const double gain = spread - below.spread() - above.spread();
            if (gain > best.gain) best = {gain, c, t[b]}, found = true;
        }
    }
    return found ? best : Split{};
}

struct Leaf {
    std::uint32_t node = 0;
    std::vector<std::uint32_t> rows;
    Split split;
};

}  // namespace

GuideTree grow_guide_tree(const Rows& known, const Rows& unknown,
                          const std::vector<char>& present) {
    Leaf root;
    for (std::uint32_t r = 0; r < present.size(); ++r)
        if (present[r]) root.rows.push_back(r);
    const Growth growth{known, unknown, make_thresholds(known, root.rows)};
    root.split = best_split(growth, root.rows);
    GuideTree tree;
    std::vector<Leaf> leaves{std::move(root)};
    while (leaves.size() < kMaxLeaves) {
        const auto best = std::max_element(
            leaves.begin(), leaves.end(),
            [](const Leaf& a, const Leaf& b) { return a.split.gain < b.split.gain; });
        if (best->split.gain <= 0) break;
        const Leaf parent = std::move(*best);
        leaves.erase(best);
        const auto first = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[parent.node] = {parent.split.column, parent.split.threshold, first, 0};
        std::array<Leaf, 2> children;
        for (std::uint32_t k = 0; k < 2; ++k) {
            children[k].node = first + k;
            tree.nodes.emplace_back();
        }
        for (const std::uint32_t r : parent.rows)
            children[known[r][parent.split.column] < parent.split.threshold ? 0 : 1].rows.push_back(
                r);
        for (Leaf& child : children) {
            child.split = best_split(growth, child.rows);
            leaves.push_back(std::move(child));
        }
    }
    tree.leaves = 0;
    for (GuideNode& node : tree.nodes)
        if (node.children == 0) node.leaf = tree.leaves++;
    return tree;
}

std::uint32_t leaf_of(const GuideTree& tree, std::span<const float> known) {
    const GuideNode* node = &tree.nodes.front();
    while (node->children > 0)
        node = &tree.nodes[node->children + (known[node->column] < node->threshold ? 0u : 1u)];
    return node->leaf;
}

}  // namespace burnish
