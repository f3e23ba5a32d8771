// report.html: a run for people, in one file that needs nothing else.
#pragma once

#include <string>

#include "cli/run_result.h"

namespace burnish {

std::string report_html(const RunResult& run);

}  // namespace burnish
