// Neighbouring items of an array.
#pragma once

#include <cstddef>

namespace burnish {

/// Items [begin, end).
struct IndexRange {
    std::size_t begin = 0, end = 0;

    std::size_t size() const { return end - begin; }
    bool empty() const { return begin == end; }
    friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

}  // namespace burnish
