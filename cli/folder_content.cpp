#include "cli/folder_content.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "burnish/error.h"
#include "captures/json_value.h"
#include "cli/history.h"
#include "image/files.h"
#include "optimize/checkpoint.h"

namespace burnish {

namespace fs = std::filesystem;

fs::path without_slash(const fs::path& folder) {
    return folder.has_filename() ? folder : folder.parent_path();
}

nlohmann::json read_summary(const fs::path& folder) {
    const fs::path file = folder / kSummary;
    std::error_code error;
    if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kMaxSummarySize)
        return {};
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    try {
        return parse_json(text, file.string(), 0, "the summary of a run");
    } catch (const InputError&) {
        return {};
    }
}

std::optional<std::vector<std::string>> files_of_earlier_run(const fs::path& folder) {
    const nlohmann::json json = read_summary(folder);
    if (!json.is_object() || !json.contains("burnish") || !json.contains("files")) return {};
    std::vector<std::string> files;
    for (const auto& name : json["files"]) {
        const fs::path path = name.is_string() ? fs::path(name.get<std::string>()) : fs::path("..");
        const bool inside = !path.empty() && path.is_relative() &&
                            std::find(path.begin(), path.end(), fs::path("..")) == path.end();
        if (inside) files.push_back(path.string());
    }
    return files;
}

namespace {

/// Whether a folder of checkpoints holds nothing but what a run that was killed before its first
/// one leaves there.
bool holds_only_beginnings(const fs::path& checkpoints) {
    for (const auto& entry : fs::recursive_directory_iterator(checkpoints))
        if (!entry.is_directory() && !is_history(entry.path()) && !is_temporary(entry.path()))
            return false;
    return true;
}

}  // namespace

bool holds_anything(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
        const fs::path name = entry.path().filename();
        const bool is_left = name == kUnfinished || (name == kCheckpoints && entry.is_directory() &&
                                                     holds_only_beginnings(entry.path()));
        if (!is_left) return true;
    }
    return false;
}

std::vector<fs::path> all_checkpoints(const fs::path& folder) {
    std::vector<fs::path> files = checkpoints_in(folder / kCheckpoints);
    for (const fs::path& file : checkpoints_in(folder / kCheckpoints / kCompared))
        files.push_back(file);
    return files;
}

bool holds_stopped_run(const fs::path& folder, const std::vector<std::string>& results) {
    std::error_code ignored;
    const auto written = fs::last_write_time(folder / kSummary, ignored);
    // A run that was stopped later may have written files of the same names.
    const auto is_result = [&](const fs::path& file) {
        const std::string name = file.lexically_relative(folder).string();
        return std::find(results.begin(), results.end(), name) != results.end() &&
               fs::last_write_time(file, ignored) <= written;
    };
    const std::vector<fs::path> files = all_checkpoints(folder);
    return !checkpoints_in(folder / kCheckpoints).empty() &&
           !std::all_of(files.begin(), files.end(), is_result);
}

}  // namespace burnish
