#include "gradient/split_gradient.h"

#include <algorithm>

#include "core/parallel.h"

namespace burnish {

void clear(SplitGradient& gradient, int width, int height, int channels, bool split) {
    const auto shape = [&](Image& image) { reshape(image, width, height, channels); };
    const std::size_t floats = gradient.first.values.size();
    shape(gradient.first);
    if (split)
        shape(gradient.second);
    else
        gradient.second = {};
    const std::size_t count = gradient.first.values.size();
    const bool known = floats == count && !gradient.dirty.empty();
    if (!known) gradient.dirty.assign(dirty_blocks_in(count), 1);
    const auto zero = [&](std::size_t from, std::size_t to) {
        std::fill_n(&gradient.first.values[from], to - from, 0.0f);
        if (split) std::fill_n(&gradient.second.values[from], to - from, 0.0f);
    };
    parallel_chunks(count, kParallelFloats, [&](std::size_t begin, std::size_t end) {
        for_dirty_intervals(gradient.dirty, begin, end, zero);
        std::fill_n(&gradient.dirty[begin / kDirtyBlock], dirty_blocks_in(end - begin), 0);
    });
}

void add(const SplitGradient& gradient, SplitGradient& to) {
    const auto add_part = [](const Image& from, Image& sum, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !from.values.empty(); ++i)
            sum.values[i] += from.values[i];
    };
    const std::size_t count = to.first.values.size();
    parallel_chunks(count, kParallelFloats, [&](std::size_t begin, std::size_t end) {
        for_dirty_intervals(gradient.dirty, begin, end, [&](std::size_t from, std::size_t past) {
            add_part(gradient.first, to.first, from, past);
            add_part(gradient.second, to.second, from, past);
            if (!to.dirty.empty()) mark_dirty(to.dirty, from, past);
        });
    });
}

Image sum_of(const SplitGradient& gradient) {
    Image sum = gradient.first;
    for (std::size_t i = 0; i < gradient.second.values.size(); ++i)
        sum.values[i] += gradient.second.values[i];
    return sum;
}

}  // namespace burnish
