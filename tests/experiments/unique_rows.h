// Rows of results.csv have no number but their place: their other cells must tell them apart.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <tuple>

#include "experiments/figure.h"

namespace burnish::test {

inline void expect_unique_rows(const ExperimentResult& result) {
    std::set<std::tuple<std::string, std::string, std::string>> rows;
    for (const Measurement& m : result.measurements)
        EXPECT_TRUE(rows.emplace(m.scene, m.variant, m.metric).second)
            << m.scene << ": " << m.variant << ": " << m.metric;
    EXPECT_FALSE(rows.empty());
}

}  // namespace burnish::test
