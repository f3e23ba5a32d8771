// Sampling from a discrete distribution in constant time: Vose's alias method.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace burnish {

/// Column i keeps index i with probability `keep`, else gives `alias`. probability[i] is that of
/// index i overall.
struct AliasTable {
    struct Column {
        float keep = 1;
        std::uint32_t alias = 0;
    };
    std::vector<Column> columns;
    std::vector<float> probability;
};

/// Weights must be finite and not negative. All zero: every index equally often. Deterministic.
AliasTable make_alias_table(std::span<const double> weights);

struct AliasSample {
    std::uint32_t index;
    float remainder;  ///< what is left of u: uniform in [0, 1), independent of the index
};

inline AliasSample sample_alias_table(const AliasTable& table, float u) {
    const auto n = static_cast<float>(table.columns.size());
    const float scaled = u * n;
    auto i = static_cast<std::uint32_t>(scaled);
    if (i >= table.columns.size()) i = static_cast<std::uint32_t>(table.columns.size()) - 1;
    const float within = scaled - static_cast<float>(i);
    const AliasTable::Column& c = table.columns[i];
    constexpr float kBelowOne = 0x1.fffffep-1f;
    const float remainder = within < c.keep ? within / c.keep : (within - c.keep) / (1.0f - c.keep);
    return {within < c.keep ? i : c.alias, remainder < kBelowOne ? remainder : kBelowOne};
}

}  // namespace burnish
