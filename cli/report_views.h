// The pictures of a run's report: each view's picture, render and difference.
#pragma once

#include <string>

#include "cli/run_result.h"

namespace burnish {

std::string views_section(const RunResult& run);

}  // namespace burnish
