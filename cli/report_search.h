// What the search for the start tried and chose, in a run's report.
#pragma once

#include <string>

#include "cli/run_result.h"

namespace burnish {

/// Empty where nothing was searched. Of many values that were tried it shows those that start most
/// regions, and of those that start as many the ones that lose least.
std::string search_section(const RunResult& run);

}  // namespace burnish
