// Goes on from stored states in a process of its own. go_on FOLDER: reads FOLDER/<case>.state,
// writes FOLDER/<case>.after.
#include <fstream>
#include <iostream>

#include "burnish/error.h"
#include "file_bytes.h"
#include "optimize/state_cases.h"

int main(int argc, char** argv) try {
    using namespace burnish;
    if (argc != 2) return 2;
    const Problem problem = test::state_problem();
    const auto cases = test::state_cases();
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const std::string file = std::string(argv[1]) + "/" + std::to_string(i);
        Solver solver(problem, cases[i].options, load_state(test::bytes_of(file + ".state")));
        test::step_to(test::kAll, solver);
        std::ofstream(file + ".after", std::ios::binary) << save_state(solver.state());
    }
} catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 1;
}
