#include "cli/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/texture_files.h"
#include "image/files.h"
#include "optimize/checkpoint.h"
#include "optimize/views.h"

namespace burnish {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSummary = "summary.json";
constexpr const char* kScene = "scene.xml";  // of `burnish new`
constexpr const char* kCheckpoints = "checkpoints";
/// Those that results lie in.
constexpr std::string_view kFolders[] = {kUnfinished, kCheckpoints, "textures", "views", "scene"};

[[noreturn]] void fail(const fs::path& path, const std::string& text) {
    throw OutputError(fmt::format("{}: {}", path.string(), text));
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

/// Whether a folder of checkpoints holds nothing but what a run that was killed before its first
/// one leaves there.
bool holds_only_beginnings(const fs::path& checkpoints) {
    for (const auto& entry : fs::recursive_directory_iterator(checkpoints))
        if (!entry.is_directory() && entry.path().filename() != kHistory &&
            !is_temporary(entry.path()))
            return false;
    return true;
}

/// Whether the folder holds more than a run that was killed before its first checkpoint leaves.
bool holds_anything(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
        const fs::path name = entry.path().filename();
        const bool is_left = name == kUnfinished || (name == kCheckpoints && entry.is_directory() &&
                                                     holds_only_beginnings(entry.path()));
        if (!is_left) return true;
    }
    return false;
}

/// Those of both runs.
std::vector<fs::path> all_checkpoints(const fs::path& folder) {
    std::vector<fs::path> files = checkpoints_in(folder / kCheckpoints);
    for (const fs::path& file : checkpoints_in(folder / kCheckpoints / kCompared))
        files.push_back(file);
    return files;
}

/// Removes what runs write beside their checkpoints, and the folders where nothing else is in them.
void remove_histories(const fs::path& folder) {
    std::error_code ignored;
    for (const fs::path& part : {folder / kCheckpoints / kCompared, folder / kCheckpoints}) {
        fs::remove(part / kHistory, ignored);
        fs::remove(part, ignored);
    }
}

/// Whether the folder holds a run that can go on and whose results are not there.
bool holds_stopped_run(const fs::path& folder) {
    std::error_code no_summary;
    const auto results = fs::last_write_time(folder / kSummary, no_summary);
    for (const fs::path& file : all_checkpoints(folder)) {
        std::error_code error;
        if (no_summary || fs::last_write_time(file, error) > results) return true;
    }
    return false;
}

void refuse_links(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder))
        if (const std::string name = entry.path().filename().string();
            entry.is_symlink() &&
            std::find(std::begin(kFolders), std::end(kFolders), name) != std::end(kFolders))
            fail(entry.path(), "a link, which may lead elsewhere: expected a folder, or nothing");
}

void refuse_content(const fs::path& folder, const OutputFolder& output, Found found) {
    if (found != Found::kRefused) return;
    if (holds_stopped_run(folder))
        fail(folder, fmt::format("holds a run that was stopped: expected --resume {}, which goes "
                                 "on with it, or --force, which begins anew",
                                 shell_word(folder.string())));
    if (!output.replaces && holds_anything(folder))
        fail(folder,
             "the folder is not empty and holds no earlier run: expected a new or empty one, or "
             "--force");
}

/// Another run holds the lock for as long as it lives, however it ends.
int take_lock(const fs::path& file, const fs::path& folder) {
    const int lock = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (lock < 0)
        fail(folder, fmt::format("the folder cannot be written: {}", std::strerror(errno)));
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

/// Removes what is unfinished, and a folder that was made where nothing else is in it. Where
/// another thread still makes or removes files there, one attempt may end early.
void discard(const fs::path& folder, bool is_made) {
    constexpr int kTries = 1000;
    std::error_code ignored;
    if (all_checkpoints(folder).empty()) remove_histories(folder);
    for (int i = 0; i < kTries && fs::exists(folder / kUnfinished, ignored); ++i)
        fs::remove_all(folder / kUnfinished, ignored);
    if (is_made) fs::remove(folder, ignored);  // succeeds only where it is empty
}

void remove_earlier(const OutputFolder& output, const std::vector<std::string>& kept) {
    std::error_code ignored;
    for (const std::string& file : output.earlier_files)
        if (std::find(kept.begin(), kept.end(), file) == kept.end() &&
            *fs::path(file).begin() != kCheckpoints) {
            fs::remove(output.folder / file, ignored);
            for (fs::path folder = fs::path(file).parent_path(); !folder.empty();
                 folder = folder.parent_path())
                fs::remove(output.folder / folder, ignored);  // where nothing is left in it
        }
}

}  // namespace

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder(std::move(other.folder)),
      unfinished(std::move(other.unfinished)),
      checkpoints(std::move(other.checkpoints)),
      earlier_files(std::move(other.earlier_files)),
      replaces(other.replaces),
      lock(std::exchange(other.lock, -1)),
      helps(std::exchange(other.helps, false)),
      is_made(other.is_made) {}

OutputFolder::~OutputFolder() {
    if (helps) {
        std::error_code ignored;
        fs::remove_all(unfinished, ignored);
    }
    if (lock < 0) return;
    const WholeStep whole;
    set_clean_up({});
    discard(folder, is_made);
    close(lock);
}

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) fail(folder, fmt::format("the folder cannot be made: {}", error.message()));
}

OutputFolder open_output_folder(const fs::path& folder, Found found) {
    const WholeStep whole;
    OutputFolder output;
    output.folder = folder;
    output.unfinished = folder / kUnfinished;
    output.checkpoints = folder / kCheckpoints;
    std::error_code error;
    if (fs::exists(folder, error) && !fs::is_directory(folder, error))
        fail(folder, "expected a folder for the results, found a file");
    output.is_made = !fs::exists(folder, error);
    make_folder(folder);
    if (auto files = files_of_earlier_run(folder)) {
        output.replaces = true;
        output.earlier_files = std::move(*files);
    }
    refuse_links(folder);
    fs::create_directories(output.unfinished, error);
    output.lock = take_lock(output.unfinished / "lock", folder);
    refuse_content(folder, output, found);
    clear_unfinished(output.unfinished);
    set_clean_up([folder, is_made = output.is_made] { discard(folder, is_made); });
    return output;
}

OutputFolder helping_folder(const fs::path& folder) {
    std::string name = (fs::temp_directory_path() / "burnish-XXXXXX").string();
    if (!mkdtemp(name.data()))
        fail(name, fmt::format("the folder cannot be made: {}", std::strerror(errno)));
    OutputFolder output;
    output.folder = folder;
    output.unfinished = name;
    output.checkpoints = folder / kCheckpoints;
    output.helps = true;
    return output;
}

std::vector<std::string> unfinished_files(const OutputFolder& output) {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(output.unfinished)) {
        const std::string name = entry.path().lexically_relative(output.unfinished).string();
        if (entry.is_regular_file() && name != "lock") files.push_back(name);
    }
    const auto rank = [](const std::string& name) {
        return std::pair(name == kSummary || name == kScene, name);
    };
    std::sort(files.begin(), files.end(),
              [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
    return files;
}

void require_room(const OutputFolder& output, double bytes) {
    const fs::path trial = output.unfinished / "room";
    const int file = open(trial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    int error = file < 0 ? errno : 0;
    if (file >= 0 && fallocate(file, 0, 0, static_cast<off_t>(bytes)) != 0) error = errno;
    if (error == EOPNOTSUPP || error == ENOSYS)
        error = write(file, "x", 1) == 1 ? 0 : errno;  // all that can be tried
    if (file >= 0) close(file);
    std::error_code ignored;
    fs::remove(trial, ignored);
    if (error != 0)
        fail(output.folder,
             fmt::format("there is no room for the results, {} of textures alone: {}",
                         bytes_text(bytes), std::strerror(error)));
}

void clear_checkpoints(const OutputFolder& output) {
    std::error_code ignored;
    for (const fs::path& file : all_checkpoints(output.folder)) fs::remove(file, ignored);
    remove_histories(output.folder);
}

std::vector<std::string> checkpoint_files(const OutputFolder& output) {
    std::vector<std::string> files;
    for (const fs::path& file : all_checkpoints(output.folder))
        files.push_back(file.lexically_relative(output.folder).string());
    return files;
}

void move_into_place(OutputFolder& output) {
    const WholeStep whole;
    const std::vector<std::string> files = unfinished_files(output);
    std::set<fs::path> folders{output.folder};
    for (const std::string& file : files) {
        const fs::path to = output.folder / file;
        std::error_code error;
        fs::create_directories(to.parent_path(), error);
        if (!error) fs::rename(output.unfinished / file, to, error);
        if (error) fail(to, fmt::format("the file cannot be put in place: {}", error.message()));
        folders.insert(to.parent_path());
    }
    for (const fs::path& folder : folders) sync_folder(folder);
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
