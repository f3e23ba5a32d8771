// Folders that are removed while other threads or other processes may be at work in them.
#pragma once

#include <filesystem>
#include <string>

namespace burnish {

/// Removes all that a folder holds but the entry `kept`, and files that are open where they are
/// left alone until they are closed, as on NFS. Where other threads still make or remove files
/// there it tries again.
void remove_content(const std::filesystem::path& folder, const std::string& kept);

/// Removes a folder with all that it holds, in the same way.
void remove_wholly(const std::filesystem::path& folder);

/// The topmost of a folder and those above it that are not there; empty: it is there.
std::filesystem::path topmost_missing(const std::filesystem::path& folder);

/// Removes a folder and those above it, up to `topmost`, where nothing is in them. Empty: none.
void remove_empty(std::filesystem::path folder, const std::filesystem::path& topmost);

}  // namespace burnish
