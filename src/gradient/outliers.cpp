#include "gradient/outliers.h"

#include <tuple>

namespace burnish {

void keep_largest(std::vector<Outlier>& list) {
    const auto name = [](const Outlier& e) {
        return std::tuple(e.slot, e.texel, e.pixel, e.technique);
    };
    const std::size_t kept = std::min(list.size(), kMaxOutliers);
    std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(kept), list.end(),
                      [&](const Outlier& a, const Outlier& b) {
                          return a.value != b.value ? a.value > b.value : name(a) < name(b);
                      });
    list.resize(kept);
}

}  // namespace burnish
