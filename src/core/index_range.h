// Neighbouring items of an array.
#pragma once

#include <algorithm>
#include <cstddef>

namespace burnish {

/// Items [begin, end).
struct IndexRange {
    std::size_t begin = 0, end = 0;

    std::size_t size() const { return end - begin; }
    bool empty() const { return begin == end; }
    friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

/// What lies in both; empty where nothing does.
inline IndexRange overlap(const IndexRange& a, const IndexRange& b) {
    const std::size_t begin = std::max(a.begin, b.begin);
    return {begin, std::max(begin, std::min(a.end, b.end))};
}

}  // namespace burnish
