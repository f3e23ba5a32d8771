// Sampling from a discrete distribution in constant time: Vose's alias method.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
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
    double remainder;  ///< what is left of u: uniform in [0, 1), independent of the index
};

/// The column that u falls into.
inline std::uint32_t alias_column(const AliasTable& table, double u) {
    const auto i = static_cast<std::uint32_t>(u * static_cast<double>(table.columns.size()));
    return std::min(i, static_cast<std::uint32_t>(table.columns.size()) - 1);
}

/// u: uniform in [0, 1); of many columns with more random bits than a float has: fine_uniform.
inline AliasSample sample_alias_table(const AliasTable& table, double u) {
    const std::uint32_t i = alias_column(table, u);
    const double within = u * static_cast<double>(table.columns.size()) - i;
    const AliasTable::Column& c = table.columns[i];
    constexpr double kBelowOne = 1 - std::numeric_limits<double>::epsilon() / 2;
    const auto keep = static_cast<double>(c.keep);
    const bool keeps = within < keep;
    const double remainder = keeps ? within / keep : (within - keep) / (1 - keep);
    // Without a branch, which would be guessed wrong as often as not.
    const std::uint32_t index = i ^ ((i ^ c.alias) & -static_cast<std::uint32_t>(!keeps));
    return {index, remainder < kBelowOne ? remainder : kBelowOne};
}

}  // namespace burnish
