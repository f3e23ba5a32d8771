// The history of a run: its iterations as CSV, one line each, behind a line with the columns'
// names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/solve.h"

namespace burnish {

/// Beside the checkpoints: the iterations so far.
inline constexpr const char* kHistory = "history.csv";
/// How it begins: a file of that name which does not is somebody else's.
inline constexpr std::string_view kHistoryStart = "iteration,seconds,";

std::string history_csv(const std::vector<Iteration>& iterations);
std::string history_row(const Iteration& iteration);

/// Whether a file is the history of a run, which may have been killed as it began to write it.
bool is_history(const std::filesystem::path& file);

}  // namespace burnish
