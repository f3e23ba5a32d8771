#include "image/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "burnish/error.h"
#include "core/hash.h"
#include "core/lower_case.h"

namespace burnish {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_to_write(const fs::path& file, const std::string& reason) {
    throw OutputError(fmt::format("{}: cannot be written: {}", file.string(), reason));
}

constexpr const char* kTemporary = ".tmp";

struct Reads {
    std::mutex mutex;  ///< guards the rest
    bool is_logged = false;
    std::map<std::string, Input> files;
};
Reads& reads() {
    static Reads only;
    return only;
}

}  // namespace

std::string lower_extension(const fs::path& file) { return lower_case(file.extension().string()); }

fs::file_status status_of(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (status.type() == fs::file_type::none)
        throw InputError(fmt::format("{}: cannot be opened: {}", file.string(), error.message()));
    return status;
}

fs::path real_path(const fs::path& file) {
    std::error_code error;
    const fs::path absolute = fs::absolute(file, error);
    if (error) return file.lexically_normal();
    const fs::path real = fs::weakly_canonical(absolute, error);
    return error ? absolute.lexically_normal() : real;
}

namespace {

/// A file that is read from its start.
struct Opened {
    std::ifstream stream;
    std::uintmax_t size = 0;  ///< bytes
};

/// Throws InputError.
Opened open_to_read(const fs::path& file) {
    const fs::file_status status = status_of(file);
    if (!fs::exists(status))
        throw InputError(fmt::format("{}: no such file, expected a readable file", file.string()));
    if (!fs::is_regular_file(status))
        throw InputError(
            fmt::format("{}: not a regular file, expected a readable file", file.string()));
    std::error_code error;
    Opened opened{std::ifstream(file, std::ios::binary), fs::file_size(file, error)};
    if (error || !opened.stream)
        throw InputError(
            fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno)));
    return opened;
}

/// Reads the next bytes. before: how many were read before them. Throws InputError.
void read_next(const fs::path& file, std::uintmax_t before, std::string& bytes,
               std::ifstream& stream) {
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    const auto count = static_cast<std::uintmax_t>(stream.gcount());
    if (count != bytes.size())
        throw InputError(fmt::format("{}: byte offset {}: cannot be read, expected {} bytes",
                                     file.string(), before + count, before + bytes.size()));
}

}  // namespace

std::string read_start(const fs::path& file, std::size_t max) {
    Opened opened = open_to_read(file);
    std::string bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(opened.size, max)), '\0');
    read_next(file, 0, bytes, opened.stream);
    return bytes;
}

std::string read_bytes(const fs::path& file) {
    std::string bytes = read_start(file, kWholeFile);
    const std::lock_guard lock(reads().mutex);
    if (reads().is_logged)
        reads().files[file.string()] = {file.string(), bytes.size(), hash_of(bytes)};
    return bytes;
}

std::string without_mark(std::string text) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (text.starts_with(kMark)) text.erase(0, kMark.size());
    return text;
}

std::string read_text_bytes(const fs::path& file) { return without_mark(read_bytes(file)); }

void require_short_text(const fs::path& file, std::uintmax_t bytes, std::size_t max,
                        const std::string& expected) {
    if (bytes > max)
        throw InputError(fmt::format("{}: found more than {} MiB, expected {}", file.string(),
                                     max >> 20, expected));
}

void require_short_text(const fs::path& file, const std::string& expected) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (!error) require_short_text(file, size, kMaxTextFile, expected);  // reading it says why not
}

Input input_of(const fs::path& file) {
    Opened opened = open_to_read(file);
    Hasher hasher;
    std::string part;
    for (std::uintmax_t done = 0; done < opened.size; done += part.size()) {
        part.resize(std::min<std::uintmax_t>(std::size_t{1} << 20, opened.size - done));
        read_next(file, done, part, opened.stream);
        hasher.add(part.data(), part.size());
    }
    return {file.string(), opened.size, hasher.hash()};
}

ReadLog::ReadLog() {
    const std::lock_guard lock(reads().mutex);
    reads().is_logged = true;
}

ReadLog::~ReadLog() {
    const std::lock_guard lock(reads().mutex);
    reads().is_logged = false;
    reads().files.clear();
}

std::vector<Input> ReadLog::files() const {
    const std::lock_guard lock(reads().mutex);
    std::vector<Input> files;
    for (const auto& [name, input] : reads().files) files.push_back(input);
    return files;
}

namespace {

/// What a file may take the place of: nothing, or another file. As root, a device would go, too.
void require_replaceable(const fs::path& file) {
    std::error_code ignored;
    switch (fs::status(file, ignored).type()) {
        case fs::file_type::directory:
            fail_to_write(file, std::strerror(EISDIR));
        case fs::file_type::block:
        case fs::file_type::character:
        case fs::file_type::fifo:
        case fs::file_type::socket:
            fail_to_write(file, "not a regular file");
        default:
            return;
    }
}

}  // namespace

FileWriter::FileWriter(const fs::path& file) : file_(file), temporary_(file) {
    require_replaceable(file);
    static std::atomic<unsigned> counter{0};  // two threads may write into one folder
    buffer_.reserve(std::size_t{1} << 20);    // may throw: there is nothing to remove yet
    do {
        // What has the name already is left alone: a link, or a file of a process elsewhere.
        temporary_.replace_filename(fmt::format(".{}.{}-{}{}", file.filename().string(), getpid(),
                                                counter.fetch_add(1), kTemporary));
        descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) fail();
}

FileWriter::~FileWriter() {
    if (descriptor_ < 0) return;
    close(descriptor_);
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void FileWriter::fail() const { fail_to_write(file_, std::strerror(errno)); }

void FileWriter::write_all(const char* bytes, std::size_t size, std::uint64_t at) {
    while (size > 0) {
        const ssize_t count = pwrite(descriptor_, bytes, size, static_cast<off_t>(at));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) fail();
        const auto done = static_cast<std::size_t>(count);
        bytes += done, size -= done, at += done;
    }
}

void FileWriter::append(const char* bytes, std::size_t size) {
    write_all(bytes, size, written_);
    written_ += size;
#ifdef __linux__
    // The disk works while the rest is written; fsync would else begin with all of it.
    if (written_ - started_ < (std::uint64_t{32} << 20)) return;
    sync_file_range(descriptor_, static_cast<off64_t>(started_),
                    static_cast<off64_t>(written_ - started_), SYNC_FILE_RANGE_WRITE);
    started_ = written_;
#endif
}

void FileWriter::flush() {
    append(buffer_.data(), buffer_.size());
    buffer_.clear();
}

void FileWriter::write(const void* bytes, std::size_t size) {
    const char* from = static_cast<const char*>(bytes);
    if (buffer_.size() + size > buffer_.capacity()) flush();
    if (size <= buffer_.capacity()) {
        buffer_.insert(buffer_.end(), from, from + size);
        return;
    }
    append(from, size);
}

void FileWriter::replace_start(const void* bytes, std::size_t size) {
    flush();
    write_all(static_cast<const char*>(bytes), size, 0);
}

void FileWriter::finish(const std::function<void()>& before) {
    flush();
    if (fsync(descriptor_) != 0) fail();
    if (before) before();
    if (rename(temporary_.c_str(), file_.c_str()) != 0) fail();
    close(std::exchange(descriptor_, -1));
}

void write_bytes(const fs::path& file, std::string_view bytes) {
    FileWriter writer(file);
    writer.write(bytes.data(), bytes.size());
    writer.finish();
}

void require_writable(const fs::path& file) { const FileWriter trial(file); }

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw OutputError(
            fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
}

void sync_folder(const fs::path& folder) {
    const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) fail_to_write(folder, std::strerror(errno));
    const int error = fsync(descriptor) == 0 ? 0 : errno;
    close(descriptor);
    const bool cannot_wait = error == EINVAL || error == ENOSYS || error == EOPNOTSUPP;
    if (error != 0 && !cannot_wait) fail_to_write(folder, std::strerror(error));
}

bool is_temporary(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.starts_with('.') && name.ends_with(kTemporary);
}

}  // namespace burnish
