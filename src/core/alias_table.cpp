#include "core/alias_table.h"

#include <numeric>

namespace burnish {

AliasTable make_alias_table(std::span<const double> weights) {
    const std::size_t n = weights.size();
    AliasTable table;
    table.columns.resize(n);
    table.probability.resize(n);
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);

    std::vector<double> scaled(n);
    std::vector<std::uint32_t> small, large;
    for (std::size_t i = 0; i < n; ++i) {
        const double p = total > 0 ? weights[i] / total : 1.0 / static_cast<double>(n);
        table.probability[i] = static_cast<float>(p);
        scaled[i] = p * static_cast<double>(n);
        (scaled[i] < 1 ? small : large).push_back(static_cast<std::uint32_t>(i));
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        table.columns[poor] = {static_cast<float>(scaled[poor]), rich};
        scaled[rich] -= 1 - scaled[poor];
        if (scaled[rich] < 1) {
            large.pop_back();
            small.push_back(rich);
        }
    }
    for (const auto& rest : {small, large})
        for (const std::uint32_t i : rest) table.columns[i] = {1.0f, i};
    return table;
}

}  // namespace burnish
