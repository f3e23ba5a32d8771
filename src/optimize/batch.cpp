#include "optimize/batch.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "core/random.h"

namespace burnish {

std::size_t batch_size(const Setup& setup) {
    return std::min<std::size_t>(setup.options.batch, setup.fitted.size());
}

std::vector<std::size_t> batch_of(const Setup& setup, std::uint32_t iteration) {
    const std::size_t count = setup.fitted.size(), size = batch_size(setup);
    std::vector<std::size_t> batch(size), order(count);
    std::vector<std::uint32_t> rank(count);
    std::size_t epoch = std::numeric_limits<std::size_t>::max();
    for (std::size_t k = 0; k < size; ++k) {
        const std::size_t visit = iteration * size + k;
        if (visit / count != epoch) {
            epoch = visit / count;
            const std::array<std::uint32_t, 2> key{setup.options.seed,
                                                   static_cast<std::uint32_t>(Stream::kViews)};
            for (std::uint32_t v = 0; v < count; ++v)
                rank[v] = philox4x32({v, static_cast<std::uint32_t>(epoch), 0, 0}, key)[0];
            std::iota(order.begin(), order.end(), std::size_t{0});
            std::stable_sort(order.begin(), order.end(),
                             [&](std::size_t a, std::size_t b) { return rank[a] < rank[b]; });
        }
        batch[k] = order[visit % count];
    }
    std::sort(batch.begin(), batch.end());
    return batch;
}

}  // namespace burnish
