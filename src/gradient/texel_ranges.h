// Items that are grouped by texel, worked on in parallel: in ranges of fixed size that never split
// a texel, so that results do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "core/index_range.h"
#include "core/parallel.h"
#include "gradient/candidate.h"

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

/// Splits two lists, each sorted by their items' `key`, in ranges of the same texels; the longer
/// one sets them.
template <class A, class B>
std::vector<std::pair<IndexRange, IndexRange>> common_ranges(const std::vector<A>& a,
                                                             const std::vector<B>& b) {
    std::vector<std::pair<IndexRange, IndexRange>> ranges;
    if (b.size() > a.size()) {
        for (const auto& [of_b, of_a] : common_ranges(b, a)) ranges.push_back({of_a, of_b});
        return ranges;
    }
    const auto starts = texel_ranges(a, [](const A& item) { return item.key; });
    std::size_t begin = 0;
    for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
        const std::size_t next = starts[r + 1];
        const std::size_t end =
            next == a.size()
                ? b.size()
                : static_cast<std::size_t>(
                      std::lower_bound(b.begin(), b.end(), a[next].key,
                                       [](const B& item, auto key) { return item.key < key; }) -
                      b.begin());
        ranges.push_back({{starts[r], next}, {begin, end}});
        begin = end;
    }
    return ranges;
}

/// The lists of all parts one after another, copied in parallel. list_of: a member of a part, or a
/// function of it.
template <class Part, class ListOf, class T>
void concatenate(const std::vector<Part>& parts, ListOf list_of, std::vector<T>& all) {
    std::vector<std::size_t> starts{0};
    for (const Part& part : parts)
        starts.push_back(starts.back() + std::invoke(list_of, part).size());
    all.resize(starts.back());
    parallel_for(parts.size(), [&](std::size_t p) {
        const std::vector<T>& list = std::invoke(list_of, parts[p]);
        std::copy(list.begin(), list.end(), all.begin() + static_cast<std::ptrdiff_t>(starts[p]));
    });
}

/// The lists that body(begin, end, list) makes of each texel's candidates, one after another.
/// items: sorted by texel.
template <class Out, class Body>
std::vector<Out> by_texel(const std::vector<Candidate>& items, const Body& body) {
    const auto starts = texel_ranges(items, [](const Candidate& c) { return c.d.key; });
    std::vector<std::vector<Out>> parts(starts.size() - 1);
    parallel_for(parts.size(), [&](std::size_t r) {
        for (std::size_t begin = starts[r], end = begin; begin < starts[r + 1]; begin = end) {
            while (end < starts[r + 1] && items[end].d.key == items[begin].d.key) ++end;
            body(begin, end, parts[r]);
        }
    });
    std::vector<Out> all;
    concatenate(parts, std::identity{}, all);
    return all;
}

}  // namespace burnish
