// Whole files in and out of memory. Outputs go to a temporary name beside the target and are
// renamed, so that a file appears whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace burnish {

/// ".png" of "a.PNG".
std::string lower_extension(const std::filesystem::path& file);

/// The content of a regular file. Throws InputError: missing, not a file, unreadable.
std::string read_bytes(const std::filesystem::path& file);

/// Calls write(temporary name) and renames the result to `file`. Where `write` throws, nothing is
/// left behind.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

/// Writes the bytes atomically. Throws InputError.
void write_bytes(const std::filesystem::path& file, std::string_view bytes);

}  // namespace burnish
