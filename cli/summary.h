// summary.json: a run in numbers, for machines.
#pragma once

#include <string>
#include <vector>

#include "cli/run_result.h"

namespace burnish {

/// files: all results of the run, relative to its folder.
std::string summary_json(const RunResult& run, const std::vector<std::string>& files);
/// Of a reproduction, and of results of which not all could be written: the files alone.
std::string list_json(const std::vector<std::string>& files);

}  // namespace burnish
