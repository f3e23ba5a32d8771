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

/// U: float, or double where a float's 24 random bits are too few.
template <class U>
struct AliasSample {
    std::uint32_t index;
    U remainder;  ///< what is left of u: uniform in [0, 1), independent of the index
};

/// The column that u falls into.
template <class U>
std::uint32_t alias_column(const AliasTable& table, U u) {
    const auto i = static_cast<std::uint32_t>(u * static_cast<U>(table.columns.size()));
    return std::min(i, static_cast<std::uint32_t>(table.columns.size()) - 1);
}

template <class U>
AliasSample<U> sample_alias_table(const AliasTable& table, U u) {
    const std::uint32_t i = alias_column(table, u);
    const U within = u * static_cast<U>(table.columns.size()) - static_cast<U>(i);
    const AliasTable::Column& c = table.columns[i];
    constexpr U kBelowOne = 1 - std::numeric_limits<U>::epsilon() / 2;
    const auto keep = static_cast<U>(c.keep);
    const bool keeps = within < keep;
    const U remainder = keeps ? within / keep : (within - keep) / (1 - keep);
    // Without a branch, which would be guessed wrong as often as not.
    const std::uint32_t index = i ^ ((i ^ c.alias) & -static_cast<std::uint32_t>(!keeps));
    return {index, remainder < kBelowOne ? remainder : kBelowOne};
}

}  // namespace burnish
