#include "cli/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/folder_content.h"

namespace burnish {

namespace {

std::filesystem::path lock_of(const std::filesystem::path& folder) {
    return folder / kUnfinished / kLock;
}

/// Whether the open file still has its name: a run that ends removes it while it holds the lock.
bool is_there(int lock, const std::filesystem::path& file) {
    struct stat own = {}, named = {};
    return fstat(lock, &own) == 0 && lstat(file.c_str(), &named) == 0 &&
           own.st_dev == named.st_dev && own.st_ino == named.st_ino;
}

}  // namespace

/// Who may go on with a run that was killed is left to the umask, as with all other files.
std::optional<int> take_lock(const std::filesystem::path& folder) {
    const std::filesystem::path file = lock_of(folder);
    const int lock = open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (lock < 0 && errno == ENOENT) return {};
    if (lock < 0)
        throw OutputError(
            fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
    const int error = flock(lock, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    if (error == 0 && is_there(lock, file)) return lock;
    if (error == ENOSYS || error == ENOLCK || error == EOPNOTSUPP) {
        log_warning(
            fmt::format("{}: its file system has no locks ({}): nothing keeps another run "
                        "out of this folder",
                        folder.string(), std::strerror(error)));
        return lock;
    }
    close(lock);
    if (error == 0) return {};
    if (error == EWOULDBLOCK) throw OutputError(folder.string() + ": " + kInUse);
    throw OutputError(
        fmt::format("{}: the folder cannot be locked: {}", folder.string(), std::strerror(error)));
}

bool is_locked(const std::filesystem::path& folder) {
    // It may be a pipe, for whose other end nobody waits.
    const int lock = open(lock_of(folder).c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (lock < 0) return false;
    // Shared: of two that ask at the same time none sees the other.
    const bool is_held = flock(lock, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    close(lock);
    return is_held;
}

}  // namespace burnish
