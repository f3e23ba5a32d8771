// Runs whose states are stored: every estimator with both parameterisations, on a small scene.
#pragma once

#include <string>

#include "error_of.h"
#include "optimize/estimators.h"
#include "optimize/small_problem.h"

namespace burnish::test {

/// A run goes on from its state after kStored iterations, up to kAll.
inline constexpr std::uint32_t kStored = 3, kAll = 6;

struct StateCase {
    std::string name;
    Options options;
};

inline std::vector<StateCase> state_cases() {
    std::vector<StateCase> cases;
    for (const auto& [name, estimator] : all_estimators(2, 1))
        for (const auto parameterization :
             {Parameterization::kPyramid, Parameterization::kTexels}) {
            Options options;
            options.estimator = estimator;
            options.parameterization = parameterization;
            options.background_samples = 4;  // some iterations gather, some do not
            options.seed = 9;
            const bool texels = parameterization == Parameterization::kTexels;
            cases.push_back({name + (texels ? ", texels" : ", pyramid"), options});
        }
    return cases;
}

inline Problem state_problem() { return problem_of(small_scene_of(24)); }

inline void step_to(std::uint32_t iterations, Solver& solver) {
    while (solver.iterations() < iterations) solver.step();
}

}  // namespace burnish::test
