#include "optimize/batch.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/random.h"

namespace burnish {

std::size_t batch_size(const Setup& setup) {
    return std::min<std::size_t>(setup.options.batch, setup.fitted.size());
}

double pixels_of_iteration(const Setup& setup) {
    double pixels = 0;
    for (const std::size_t view : setup.fitted) pixels += pixels_of(setup.views[view]);
    return pixels * static_cast<double>(batch_size(setup)) /
           static_cast<double>(setup.fitted.size());
}

namespace {

/// Visit `visit` of `count` views [begin, begin + count): the next one of an order that is shuffled
/// anew in each epoch.
std::size_t visited(std::uint32_t seed, std::size_t begin, std::size_t count, std::size_t visit) {
    const auto epoch = static_cast<std::uint32_t>(visit / count);
    const std::array<std::uint32_t, 2> key{seed, static_cast<std::uint32_t>(Stream::kViews)};
    std::vector<std::uint32_t> rank(count);
    for (std::size_t v = 0; v < count; ++v)
        rank[v] = philox4x32({static_cast<std::uint32_t>(begin + v), epoch, 0, 0}, key)[0];
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rank[a] < rank[b]; });
    return begin + order[visit % count];
}

}  // namespace

std::vector<std::size_t> batch_of(const Setup& setup, std::uint32_t iteration) {
    const std::size_t count = setup.fitted.size(), size = batch_size(setup);
    const std::uint32_t seed = setup.options.seed;
    std::vector<std::size_t> batch(size);
    for (std::size_t k = 0; k < size; ++k)
        batch[k] = count % size == 0 ? visited(seed, k * (count / size), count / size, iteration)
                                     : visited(seed, 0, count, std::size_t{iteration} * size + k);
    std::sort(batch.begin(), batch.end());
    return batch;
}

}  // namespace burnish
