#include "cli/folder_removal.h"

#include <system_error>
#include <vector>

namespace burnish {

namespace fs = std::filesystem;

namespace {

constexpr int kTries = 1000;  // one may end early

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

/// Returns whether there was anything to go.
bool try_to_remove(const fs::path& folder, const std::string& kept) {
    const std::vector<fs::path> entries = removable(folder, kept);
    std::error_code ignored;
    for (const fs::path& entry : entries) fs::remove_all(entry, ignored);
    return !entries.empty();
}

}  // namespace

void remove_content(const fs::path& folder, const std::string& kept) {
    for (int i = 0; i < kTries && try_to_remove(folder, kept); ++i) {
    }
}

void remove_wholly(const fs::path& folder) {
    std::error_code ignored;
    for (int i = 0; i < kTries; ++i) {
        try_to_remove(folder, "");
        if (fs::remove(folder, ignored) || removable(folder, "").empty()) return;
    }
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
