#include "burnish/inverse/extremes.h"

#include <tuple>

namespace burnish {

void keep_largest(std::vector<ExtremeContribution>& list) {
    const auto name = [](const ExtremeContribution& e) {
        return std::tuple(e.slot, e.texel, e.pixel, e.technique);
    };
    const std::size_t kept = std::min(list.size(), kExtremes);
    std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(kept), list.end(),
                      [&](const ExtremeContribution& a, const ExtremeContribution& b) {
                          return a.value != b.value ? a.value > b.value : name(a) < name(b);
                      });
    list.resize(kept);
}

}  // namespace burnish
