// Items that are grouped by texel, worked on in parallel: in ranges of fixed size that never split
// a texel, so that results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <vector>

#include "core/parallel.h"

namespace burnish {

/// The beginnings of ranges of about 4096 items each, and the end of the last one. items: sorted by
/// key(item).
template <class Item, class KeyOf>
std::vector<std::size_t> texel_ranges(const std::vector<Item>& items, KeyOf key) {
    constexpr std::size_t kRange = 4096;
    std::vector<std::size_t> starts{0};
    while (starts.back() + kRange < items.size()) {
        std::size_t i = starts.back() + kRange;
        while (i < items.size() && key(items[i]) == key(items[i - 1])) ++i;
        starts.push_back(i);
    }
    if (starts.back() != items.size()) starts.push_back(items.size());
    return starts;
}

/// Calls body(range, begin, end) for each range, in parallel.
template <class Body>
void for_ranges(const std::vector<std::size_t>& starts, Body&& body) {
    parallel_for(starts.size() - 1, [&](std::size_t r) { body(r, starts[r], starts[r + 1]); });
}

/// The end of the items that have the key of items[i].
template <class Item, class KeyOf>
std::size_t end_of_texel(const std::vector<Item>& items, std::size_t i, std::size_t end,
                         KeyOf key) {
    const auto first = key(items[i]);
    while (i < end && key(items[i]) == first) ++i;
    return i;
}

template <class T>
std::vector<T> concatenate(const std::vector<std::vector<T>>& parts) {
    std::vector<T> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace burnish
