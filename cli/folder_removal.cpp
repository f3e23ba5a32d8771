#include "cli/folder_removal.h"

#include <system_error>
#include <vector>

namespace burnish {

namespace fs = std::filesystem;

namespace {

/// What is to go of a folder's content: not the entry `kept`, nor files that are open, under the
/// names that NFS gives them until they are closed.
std::vector<fs::path> removable(const fs::path& folder, const std::string& kept) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (name != kept && !name.starts_with(".nfs")) entries.push_back(at->path());
    }
    return entries;
}

}  // namespace

void remove_content(const fs::path& folder, const std::string& kept) {
    constexpr int kTries = 1000;  // one may end early
    std::error_code ignored;
    for (int i = 0; i < kTries; ++i) {
        const std::vector<fs::path> entries = removable(folder, kept);
        if (entries.empty()) return;
        for (const fs::path& entry : entries) fs::remove_all(entry, ignored);
    }
}

void remove_wholly(const fs::path& folder) {
    std::error_code error;
    do {
        remove_content(folder, "");
        fs::remove(folder, error);
    } while (error == std::errc::directory_not_empty && !removable(folder, "").empty());
}

fs::path topmost_missing(const fs::path& folder) {
    fs::path missing;
    std::error_code ignored;
    const auto is_missing = [&](const fs::path& path) {
        return fs::symlink_status(path, ignored).type() == fs::file_type::not_found;
    };
    for (fs::path at = folder; !at.empty() && is_missing(at); at = at.parent_path()) missing = at;
    return missing;
}

void remove_empty(fs::path folder, const fs::path& topmost) {
    if (topmost.empty()) return;
    std::error_code ignored;
    fs::remove(folder, ignored);
    while (folder != topmost) {
        folder = folder.parent_path();
        fs::remove(folder, ignored);
    }
}

}  // namespace burnish
