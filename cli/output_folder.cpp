#include "cli/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "burnish/error.h"
#include "cli/interrupt.h"
#include "cli/texture_files.h"
#include "optimize/views.h"

namespace burnish {

namespace fs = std::filesystem;

namespace {

constexpr const char* kUnfinished = ".burnish-unfinished";
constexpr const char* kSummary = "summary.json";

[[noreturn]] void fail(const fs::path& path, const std::string& text) {
    throw InputError(fmt::format("{}: {}", path.string(), text));
}

/// The files that the summary of an earlier run lists; nothing where there is no such summary.
std::optional<std::vector<std::string>> files_of_earlier_run(const fs::path& folder) {
    std::ifstream stream(folder / kSummary);
    const auto json = nlohmann::json::parse(stream, nullptr, false);
    if (!json.is_object() || !json.contains("burnish") || !json.contains("files")) return {};
    std::vector<std::string> files;
    for (const auto& name : json["files"]) {
        const fs::path path = name.is_string() ? fs::path(name.get<std::string>()) : fs::path("..");
        const bool inside =
            path.is_relative() && std::find(path.begin(), path.end(), fs::path("..")) == path.end();
        if (inside) files.push_back(path.string());
    }
    return files;
}

bool holds_anything(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().filename() != kUnfinished) return true;
    return false;
}

/// Another run holds the lock for as long as it lives, however it ends.
int take_lock(const fs::path& file, const fs::path& folder) {
    const int lock = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (lock < 0) fail(folder, "the folder cannot be written");
    if (flock(lock, LOCK_EX | LOCK_NB) != 0) {
        close(lock);
        fail(folder, "another run is writing into this folder");
    }
    return lock;
}

/// What a run that was killed left behind goes.
void clear_unfinished(const fs::path& unfinished) {
    for (const auto& entry : fs::directory_iterator(unfinished))
        if (entry.path().filename() != "lock") fs::remove_all(entry.path());
}

/// Removes what is unfinished, and the folder where nothing else is in it.
void discard(const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder / kUnfinished, ignored);
    fs::remove(folder, ignored);  // succeeds only where it is empty
}

void remove_earlier(const OutputFolder& output, const std::vector<std::string>& kept) {
    std::error_code ignored;
    for (const std::string& file : output.earlier_files)
        if (std::find(kept.begin(), kept.end(), file) == kept.end())
            fs::remove(output.folder / file, ignored);
}

}  // namespace

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder(std::move(other.folder)),
      unfinished(std::move(other.unfinished)),
      earlier_files(std::move(other.earlier_files)),
      replaces(other.replaces),
      lock(std::exchange(other.lock, -1)) {}

OutputFolder::~OutputFolder() {
    if (lock < 0) return;
    const WholeStep whole;
    set_clean_up({});
    discard(folder);
    close(lock);
}

OutputFolder open_output_folder(const fs::path& folder, bool force) {
    const WholeStep whole;
    OutputFolder output;
    output.folder = folder;
    output.unfinished = folder / kUnfinished;
    std::error_code error;
    if (fs::exists(folder, error) && !fs::is_directory(folder, error))
        fail(folder, "expected a folder for the results, found a file");
    fs::create_directories(folder, error);
    if (error) fail(folder, fmt::format("the folder cannot be made: {}", error.message()));
    if (auto files = files_of_earlier_run(folder)) {
        output.replaces = true;
        output.earlier_files = std::move(*files);
    } else if (holds_anything(folder) && !force) {
        fail(folder,
             "the folder is not empty and holds no earlier run: expected a new or empty one, or "
             "--force");
    }
    fs::create_directories(output.unfinished, error);
    output.lock = take_lock(output.unfinished / "lock", folder);
    clear_unfinished(output.unfinished);
    set_clean_up([folder] { discard(folder); });
    return output;
}

std::vector<std::string> unfinished_files(const OutputFolder& output) {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(output.unfinished)) {
        const std::string name = entry.path().lexically_relative(output.unfinished).string();
        if (entry.is_regular_file() && name != "lock") files.push_back(name);
    }
    const auto rank = [](const std::string& name) { return std::pair(name == kSummary, name); };
    std::sort(files.begin(), files.end(),
              [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
    return files;
}

void move_into_place(OutputFolder& output) {
    const WholeStep whole;
    const std::vector<std::string> files = unfinished_files(output);
    for (const std::string& file : files) {
        const fs::path to = output.folder / file;
        std::error_code error;
        fs::create_directories(to.parent_path(), error);
        if (!error) fs::rename(output.unfinished / file, to, error);
        if (error) fail(to, fmt::format("the file cannot be put in place: {}", error.message()));
    }
    remove_earlier(output, files);
}

std::vector<std::string> folder_names(const std::vector<View>& views) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const std::string plain = file_name_of(name_of(views[i], i));
        std::string name = plain;
        for (int n = 2; std::find(names.begin(), names.end(), name) != names.end(); ++n)
            name = fmt::format("{}_{}", plain, n);
        names.push_back(name);
    }
    return names;
}

}  // namespace burnish
