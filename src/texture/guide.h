// What known textures say of an unknown one that the same materials read: where they are alike, it
// is likely alike, too. A regression tree over their values [Breiman et al. 1984] sorts regions
// into leaves; a texel's leaf follows from its own values, so it may be finer than the regions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace burnish {

/// Values of known textures, or of unknown ones: one row for each region.
struct Rows {
    std::vector<float> values;  ///< [rows, width]
    std::size_t width = 0;

    std::size_t count() const { return width > 0 ? values.size() / width : 0; }
    std::span<const float> operator[](std::size_t row) const {
        return {values.data() + row * width, width};
    }

    friend bool operator==(const Rows&, const Rows&) = default;
};

struct GuideNode {
    std::uint32_t column = 0;    ///< of the known values
    float threshold = 0;         ///< below it lies the first child, elsewhere the second
    std::uint32_t children = 0;  ///< index of the first, the other follows; 0: this is a leaf
    std::uint32_t leaf = 0;      ///< its number
};

struct GuideTree {
    std::vector<GuideNode> nodes{GuideNode{}};
    std::uint32_t leaves = 1;
};

/// Splits as long as that explains more of the variance of `unknown` than chance would: at most 64
/// leaves of at least 32 rows each. present: non-zero where a row takes part. Parallel rows.
GuideTree grow_guide_tree(const Rows& known, const Rows& unknown, const std::vector<char>& present);

std::uint32_t leaf_of(const GuideTree& tree, std::span<const float> known);

}  // namespace burnish
