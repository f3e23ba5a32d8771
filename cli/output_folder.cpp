#include "cli/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>
#include <set>
#include <utility>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/folder_content.h"
#include "cli/folder_lock.h"
#include "cli/folder_removal.h"
#include "cli/history.h"
#include "cli/interrupt.h"
#include "image/files.h"

namespace burnish {

namespace fs = std::filesystem;

namespace {

constexpr const char* kScene = "scene.xml";  // of `burnish new` and `burnish scene`
/// Those that results lie in.
constexpr const char* kFolders[] = {kCheckpoints, "textures", "views", "scene"};

[[noreturn]] void fail(const fs::path& path, const std::string& text) {
    throw OutputError(fmt::format("{}: {}", path.string(), text));
}

/// Removes what runs write beside their checkpoints, and the folders where nothing else is in them.
void remove_histories(const fs::path& folder) {
    std::error_code ignored;
    for (const fs::path& part : {folder / kCheckpoints / kCompared, folder / kCheckpoints}) {
        if (is_history(part / kHistory)) fs::remove(part / kHistory, ignored);
        fs::remove(part, ignored);
    }
}

void refuse_link(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_symlink(path, ignored))
        fail(path, "a link, which may lead elsewhere: expected a folder, or nothing");
}

/// A link to a file is replaced.
void refuse_links(const fs::path& folder) {
    std::error_code ignored;
    for (const char* name : kFolders) {
        refuse_link(folder / name);
        for (const auto& entry : fs::recursive_directory_iterator(folder / name, ignored))
            if (entry.is_directory(ignored)) refuse_link(entry.path());
    }
}

void refuse_content(const OutputFolder& output, Found found) {
    const fs::path& folder = output.folder;
    if (found == Found::kEmpty && holds_anything(folder))
        fail(folder, "expected a folder that does not exist yet, or an empty one");
    if (found != Found::kRefused) return;
    if (holds_stopped_run(folder, output.earlier_files))
        fail(folder, fmt::format("holds a run that was stopped: expected `burnish optimize "
                                 "--resume {}`, which goes on with it, or --force, which begins "
                                 "anew",
                                 shell_word(folder.string())));
    if (!output.replaces && holds_anything(folder))
        fail(folder,
             "the folder is not empty and holds no earlier run: expected a new or empty one, or "
             "--force");
}

/// What a run that was killed left behind goes.
void clear_unfinished(const fs::path& unfinished) {
    for (const auto& entry : fs::directory_iterator(unfinished))
        if (entry.path().filename() != kLock) fs::remove_all(entry.path());
}

/// Where they cannot be listed there may be some.
bool may_hold_checkpoints(const fs::path& folder) {
    try {
        return !all_checkpoints(folder).empty();
    } catch (const std::exception&) {
        return true;
    }
}

/// Removes what is unfinished, and folders that were made where nothing else is in them. The lock
/// goes while it is held, after all else: from there on another run may make its own, and folders
/// go only where they are empty, so nothing of such a run.
void discard(const fs::path& folder, const fs::path& made, int lock) {
    const fs::path unfinished = folder / kUnfinished;
    if (!may_hold_checkpoints(folder)) remove_histories(folder);
    remove_content(unfinished, kLock);
    std::error_code ignored;
    fs::remove(unfinished / kLock, ignored);
    close(lock);
    fs::remove(unfinished, ignored);
    remove_empty(unfinished, made);
}

/// Once more where another run, which ends, has removed a folder above while it was empty.
void make_folders(const OutputFolder& output) {
    constexpr int kTries = 1000;
    std::error_code error;
    for (int i = 0; i < kTries; ++i) {
        fs::create_directories(output.unfinished, error);
        if (error != std::errc::no_such_file_or_directory && error != std::errc::file_exists) break;
    }
    if (!error) return;
    make_folder(output.folder);  // says so where it is this one
    fail(output.folder, fmt::format("the folder cannot be written: {}", error.message()));
}

/// Makes the folders and takes the lock. A run that ends at the same time, in this folder or beside
/// it, may remove what is empty in between: then once more.
int make_and_lock(const OutputFolder& output) {
    constexpr int kTries = 1000;
    for (int i = 0; i < kTries; ++i) {
        make_folders(output);
        if (const std::optional<int> lock = take_lock(output.folder)) return *lock;
    }
    fail(output.folder, "the folder cannot be locked: its lock is removed again and again");
}

/// Looks at what is there.
void find_content(OutputFolder& output, Found found) {
    if (auto files = files_of_earlier_run(output.folder)) {
        output.replaces = true;
        output.earlier_files = std::move(*files);
    }
    refuse_links(output.folder);
    output.owns_checkpoints = all_checkpoints(output.folder).empty() || found == Found::kResumed;
    refuse_content(output, found);
}

/// Leaves a folder that is refused as it was. lock: -1: not taken yet.
void leave(const fs::path& unfinished, const fs::path& made, int lock) {
    std::error_code ignored;
    if (lock >= 0) {
        if (!made.empty()) fs::remove(unfinished / kLock, ignored);
        close(lock);
    }
    remove_empty(unfinished, made);
}

/// Whether a folder above the file is a link.
bool is_behind_link(const fs::path& folder, const fs::path& file) {
    std::error_code ignored;
    for (fs::path above = file.parent_path(); !above.empty(); above = above.parent_path())
        if (fs::is_symlink(folder / above, ignored)) return true;
    return false;
}

/// Removes a file of a folder, and the folders above it where nothing is left in them.
void remove_file(const fs::path& folder, const fs::path& file) {
    std::error_code ignored;
    for (fs::path path = file; !path.empty(); path = path.parent_path())
        fs::remove(folder / path, ignored);
}

void remove_earlier(const OutputFolder& output, const std::vector<std::string>& kept) {
    for (const std::string& file : output.earlier_files)
        if (std::find(kept.begin(), kept.end(), file) == kept.end() &&
            *fs::path(file).begin() != kCheckpoints && !is_behind_link(output.folder, file))
            remove_file(output.folder, file);
}

}  // namespace

OutputFolder open_output_folder(const fs::path& folder, Found found) {
    const WholeStep whole;
    OutputFolder output;
    output.folder = folder;
    output.unfinished = folder / kUnfinished;
    output.checkpoints = folder / kCheckpoints;
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (fs::exists(status) && !fs::is_directory(status))
        fail(folder, "expected a folder for the results, found a file");
    refuse_link(output.unfinished);
    // `unfinished`, or the topmost folder above it that was not there before; empty: all were
    const fs::path made = topmost_missing(output.unfinished);
    int lock = -1;  // held while the run lives
    try {
        lock = make_and_lock(output);
        find_content(output, found);
        output.clean_up = CleanUp([folder, made, lock] { discard(folder, made, lock); });
    } catch (...) {
        leave(output.unfinished, made, lock);
        throw;
    }
    clear_unfinished(output.unfinished);
    return output;
}

OutputFolder helping_folder(const fs::path& folder) {
    OutputFolder output;
    output.folder = folder;
    output.checkpoints = folder / kCheckpoints;
    return output;
}

void make_temporary(OutputFolder& output) {
    const WholeStep whole;
    const char* const above = std::getenv("TMPDIR");
    std::string name = (fs::path(above && *above ? above : "/tmp") / "burnish-XXXXXX").string();
    if (!mkdtemp(name.data()))
        fail(name, fmt::format("the folder cannot be made, TMPDIR names the one above it: {}",
                               std::strerror(errno)));
    output.unfinished = name;
    output.clean_up = CleanUp([unfinished = output.unfinished] { remove_wholly(unfinished); });
}

std::vector<std::string> unfinished_files(const OutputFolder& output) {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(output.unfinished)) {
        const std::string name = entry.path().lexically_relative(output.unfinished).string();
        if (entry.is_regular_file() && name != kLock) files.push_back(name);
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
    const int file = open(trial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
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

void require_no_inputs(const OutputFolder& output, const std::vector<std::string>& results,
                       const std::vector<Input>& inputs) {
    const std::set<std::string> earlier(output.earlier_files.begin(), output.earlier_files.end());
    std::error_code ignored;
    for (const std::string& name : results) {
        const fs::path file = output.folder / name;
        if (earlier.contains(name) || !fs::is_regular_file(fs::symlink_status(file, ignored)))
            continue;
        for (const Input& input : inputs)
            if (fs::equivalent(file, input.name, ignored))
                fail(file, "is a file that this run reads: expected another folder");
    }
}

void take_checkpoints(OutputFolder& output, const fs::path& first) {
    if (output.owns_checkpoints) return;
    std::error_code ignored;
    for (const fs::path& file : all_checkpoints(output.folder))
        if (file != first) fs::remove(file, ignored);
    output.owns_checkpoints = true;
}

void clear_checkpoints(const OutputFolder& output) {
    std::error_code ignored;
    for (const fs::path& file : all_checkpoints(output.folder)) fs::remove(file, ignored);
    remove_histories(output.folder);
}

bool keeps_run(const OutputFolder& output) {
    return output.owns_checkpoints && may_hold_checkpoints(output.folder);
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

void move_scene_into_place(OutputFolder& output) {
    const WholeStep whole;
    std::vector<std::string> added = unfinished_files(output);
    std::erase_if(added, [&](const std::string& file) {
        return fs::exists(fs::symlink_status(output.folder / file)) ||
               is_behind_link(output.folder, file);
    });
    try {
        move_into_place(output);
    } catch (...) {
        for (const std::string& file : added) remove_file(output.folder, file);
        throw;
    }
}

}  // namespace burnish
