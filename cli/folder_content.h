// What lies in a folder that results are to go to: an earlier run, one that was stopped, what one
// that was killed has left, or what is somebody else's.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace burnish {

/// The folder within it that everything is written into first.
inline constexpr const char* kUnfinished = ".burnish-unfinished";
/// That of the checkpoints.
inline constexpr const char* kCheckpoints = "checkpoints";
/// The folder of a second run's checkpoints, within that of the first.
inline constexpr const char* kCompared = "compared";
/// Lists the files of a run.
inline constexpr const char* kSummary = "summary.json";
inline constexpr std::size_t kMaxSummarySize = std::size_t{64} << 20;  ///< bytes

/// Without the slash that shells put behind a folder: its last part is its name.
std::filesystem::path without_slash(const std::filesystem::path& folder);

/// That of a folder; no object where there is none that can be read, and where it is larger or
/// nested deeper than any that a run writes: values are copied and written by recursion.
nlohmann::json read_summary(const std::filesystem::path& folder);

/// The files that the summary of an earlier run lists, relative; nothing where there is no such
/// summary.
std::optional<std::vector<std::string>> files_of_earlier_run(const std::filesystem::path& folder);

/// Whether the folder holds more than a run that was killed before its first checkpoint leaves.
bool holds_anything(const std::filesystem::path& folder);

/// The checkpoints of both runs.
std::vector<std::filesystem::path> all_checkpoints(const std::filesystem::path& folder);

/// Whether the folder holds a run that can go on and whose results are not there. results: files
/// that the summary lists, checkpoints among them where Ctrl-C has ended the run. Throws
/// OutputError: see checkpoints_in.
bool holds_stopped_run(const std::filesystem::path& folder,
                       const std::vector<std::string>& results);

}  // namespace burnish
