// Whole files in and out of memory. Outputs go to a temporary name beside the target, are waited
// for, and are renamed: a file appears whole or not at all, also where the machine stops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/input.h"

namespace burnish {

/// ".png" of "a.PNG".
std::string lower_extension(const std::filesystem::path& file);

/// What lies there, behind links. Throws InputError where that cannot be told: a link to itself, a
/// folder that may not be entered.
std::filesystem::file_status status_of(const std::filesystem::path& file);

/// The file or folder behind links, by its absolute name; where that cannot be told, as in a loop
/// of links, the absolute name without them followed. Of what is not there, too. Throws nothing.
std::filesystem::path real_path(const std::filesystem::path& file);

/// The content of a regular file. Throws InputError: missing, not a file, unreadable.
std::string read_bytes(const std::filesystem::path& file);
/// A text without the byte order mark that some editors put before UTF-8.
std::string without_mark(std::string text);
/// without_mark of read_bytes.
std::string read_text_bytes(const std::filesystem::path& file);
/// The most bytes of a scene file and of a JSON file.
inline constexpr std::size_t kMaxTextFile = std::size_t{256} << 20;
/// Throws InputError where a text has more bytes than max, whole MiB. expected: what the file is.
void require_short_text(const std::filesystem::path& file, std::uintmax_t bytes, std::size_t max,
                        const std::string& expected);
/// The same of a file that is to be read, which may have kMaxTextFile.
void require_short_text(const std::filesystem::path& file, const std::string& expected);
/// At most so many of the first bytes of such a file, which no ReadLog remembers.
std::string read_start(const std::filesystem::path& file, std::size_t max);
constexpr std::size_t kWholeFile = std::numeric_limits<std::size_t>::max();

/// While it lives, remembers the files that read_bytes reads. At most one at a time.
class ReadLog {
  public:
    ReadLog();
    ~ReadLog();
    ReadLog(const ReadLog&) = delete;
    ReadLog& operator=(const ReadLog&) = delete;
    /// By name, each once: as it was read last.
    std::vector<Input> files() const;
};
/// A file as it is now; takes little memory, however large it is. Throws InputError.
Input input_of(const std::filesystem::path& file);

/// A file that is written in parts, beside its name until it is whole. Throws OutputError.
class FileWriter {
  public:
    explicit FileWriter(const std::filesystem::path& file);
    /// Removes what is not finished.
    ~FileWriter();
    FileWriter(const FileWriter&) = delete;
    FileWriter& operator=(const FileWriter&) = delete;

    void write(const void* bytes, std::size_t size);
    /// In the place of the first bytes, which must have been written.
    void replace_start(const void* bytes, std::size_t size);
    /// The last call. Waits until the content lies on the disk, and gives it its name. before: what
    /// is done in between.
    void finish(const std::function<void()>& before = {});

  private:
    void flush();
    /// At the end of what is written.
    void append(const char* bytes, std::size_t size);
    void write_all(const char* bytes, std::size_t size, std::uint64_t at);
    [[noreturn]] void fail() const;

    std::filesystem::path file_, temporary_;
    int descriptor_ = -1;
    std::uint64_t written_ = 0;
    std::uint64_t started_ = 0;  ///< the bytes whose way to the disk has begun
    std::vector<char> buffer_;
};

/// Writes a file whole or not at all. Throws OutputError.
void write_bytes(const std::filesystem::path& file, std::string_view bytes);

/// For what is asked before long work: throws OutputError where a file of this name cannot be
/// written. Leaves nothing behind, and what is there as it is.
void require_writable(const std::filesystem::path& file);

/// Makes a folder and those above it, where they are missing. Throws OutputError.
void make_folder(const std::filesystem::path& folder);

/// Waits until the names in a folder lie on the disk, where its file system can wait for that.
/// Throws OutputError.
void sync_folder(const std::filesystem::path& folder);

/// Whether a name is one that FileWriter gives to a file that is not whole.
bool is_temporary(const std::filesystem::path& file);

}  // namespace burnish
