// The runs of `inverse`: each goes on until it has passed its budgets, and is evaluated as it does.
#include "experiments/inverse_runs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/small_target_scene.h"

namespace burnish {
namespace {

double value_of(const ExperimentResult& result, const std::string& variant,
                const std::string& metric) {
    for (const Measurement& m : result.measurements)
        if (m.variant == variant && m.metric == metric) return m.value;
    ADD_FAILURE() << variant << ": " << metric;
    return 0;
}

TEST(Inverse, RunsPassEachOfTheirBudgets) {
    ReproduceOptions options = test::small_options();
    options.runs = 2;
    options.budget = {
        .iterations = 6, .long_iterations = 40, .derivative_seconds = 1e-3, .seconds = 2e-3};
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    const WorkNote silent{[](const std::string&) {}, {}};
    const ExperimentResult result = run_inverse(scenes, options, silent);

    for (const Method& m : planned_runs(scenes[0], options).methods)
        for (const std::string run : {"run 0", "run 1"}) {
            const auto at = [&](const char* budget, const char* metric) {
                return value_of(result, m.name + ", " + run + ", budget of " + budget, metric);
            };
            EXPECT_EQ(at("iterations", "iterations"), 6) << m.name;
            EXPECT_EQ(at("long_iterations", "iterations"), m.is_long ? 40 : 6) << m.name;
            EXPECT_GE(at("derivative_seconds", "derivative_seconds"), 1e-3) << m.name;
            EXPECT_GE(at("seconds", "seconds"), 2e-3) << m.name;
        }
    EXPECT_NE(value_of(result, "mc, run 0, budget of long_iterations", "loss"),
              value_of(result, "mc, run 0, budget of iterations", "loss"));

    const Table& table = result.figures.at(0).tables.at(0);
    const auto head = std::find(table.head.begin(), table.head.end(), "loss after 40 iterations");
    ASSERT_NE(head, table.head.end());
    const auto column = static_cast<std::size_t>(head - table.head.begin());
    for (const auto& row : table.rows) {
        const bool is_long = row[0] == "mc" || row[0] == "pgris, replay";
        ASSERT_EQ(row.size(), table.head.size()) << row[0];
        EXPECT_EQ(row[column].empty(), !is_long) << row[0];
    }
}

}  // namespace
}  // namespace burnish
