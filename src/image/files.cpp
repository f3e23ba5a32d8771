#include "image/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "burnish/error.h"

namespace burnish {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

std::string read_bytes(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status))
        throw InputError(fmt::format("{}: no such file, expected a readable file", file.string()));
    if (!fs::is_regular_file(status))
        throw InputError(
            fmt::format("{}: not a regular file, expected a readable file", file.string()));
    const std::uintmax_t size = fs::file_size(file, error);
    std::ifstream stream(file, std::ios::binary);
    if (error || !stream)
        throw InputError(
            fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno)));
    std::string bytes(static_cast<std::size_t>(size), '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (stream.gcount() != static_cast<std::streamsize>(bytes.size()))
        throw InputError(fmt::format("{}: byte offset {}: cannot be read, expected {} bytes",
                                     file.string(), stream.gcount(), bytes.size()));
    return bytes;
}

void write_atomically(const fs::path& file, const std::function<void(const fs::path&)>& write) {
    static std::atomic<unsigned> counter{0};  // two threads may write into one folder
    fs::path temporary = file;
    temporary.replace_filename(
        fmt::format(".{}.{}-{}.tmp", file.filename().string(), getpid(), counter.fetch_add(1)));
    std::error_code error;
    try {
        write(temporary);
        fs::rename(temporary, file, error);
    } catch (...) {
        fs::remove(temporary, error);
        throw;
    }
    if (!error) return;
    const std::string reason = error.message();
    fs::remove(temporary, error);
    throw InputError(fmt::format("{}: cannot be written: {}", file.string(), reason));
}

void write_bytes(const fs::path& file, std::string_view bytes) {
    write_atomically(file, [&](const fs::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary);
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        stream.close();
        if (!stream)
            throw InputError(
                fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
    });
}

}  // namespace burnish
