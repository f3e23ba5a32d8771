// The alias table draws indices in proportion to their weights, and what is left of the random
// number is uniform again.
#include "core/alias_table.h"

#include <gtest/gtest.h>

#include "ledger_entries.h"
#include "random_source.h"
#include "statistics.h"

namespace burnish {
namespace {

using test::accepted;
using test::rejected;
using test::ledger::kAliasTable;

int direct_samples() { return test::scaled(kAliasTable, 1000000); }

const std::vector<double> kWeights{3.0, 0.0, 1e-3, 0.5, 7.0, 0.0, 2.0, 1.0, 0.25};

struct Counts {
    std::vector<double> indices, remainders = std::vector<double>(32);
};

Counts direct_sample(const AliasTable& table) {
    Counts counts;
    counts.indices.resize(table.columns.size());
    test::RandomSource random{test::seed_of(kAliasTable)};
    for (int i = 0; i < direct_samples(); ++i) {
        const AliasSample s = sample_alias_table(table, random.next());
        ++counts.indices[s.index];
        ++counts.remainders[static_cast<std::size_t>(s.remainder * 32)];
    }
    return counts;
}

double index_p_value(const AliasTable& table, const std::vector<double>& weights) {
    double total = 0;
    for (const double w : weights) total += w;
    std::vector<double> expected;
    for (const double w : weights) expected.push_back(direct_samples() * w / total);
    return test::goodness_of_fit_p_value(direct_sample(table).indices, expected);
}

TEST(AliasTable, DrawsInProportionToTheWeights) {
    const AliasTable table = make_alias_table(kWeights);
    EXPECT_TRUE(accepted(kAliasTable, "indices", index_p_value(table, kWeights)));
    AliasTable defect = table;  // one column forgets its alias
    for (auto& column : defect.columns)
        if (column.keep < 0.9f) {
            column.keep = 1;
            break;
        }
    EXPECT_TRUE(
        rejected(kAliasTable, "a column without its alias", index_p_value(defect, kWeights)));
    EXPECT_TRUE(accepted(
        kAliasTable, "all zero: uniform",
        index_p_value(make_alias_table(std::vector<double>(5)), std::vector<double>(5, 1.0))));
}

TEST(AliasTable, StatesItsProbabilities) {
    const AliasTable table = make_alias_table(kWeights);
    for (std::size_t i = 0; i < kWeights.size(); ++i)
        EXPECT_FLOAT_EQ(table.probability[i], static_cast<float>(kWeights[i] / 13.751));
}

TEST(AliasTable, RemainderIsUniform) {
    const Counts counts = direct_sample(make_alias_table(kWeights));
    EXPECT_TRUE(accepted(kAliasTable, "remainders",
                         test::goodness_of_fit_p_value(
                             counts.remainders, std::vector<double>(32, direct_samples() / 32.0))));
}

}  // namespace
}  // namespace burnish
