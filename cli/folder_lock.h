// The lock of a folder that results are written into: a file that another run holds locked for as
// long as it lives, however it ends.
#pragma once

#include <filesystem>
#include <optional>

namespace burnish {

/// Its name within the folder of what is unfinished, which must be there.
inline constexpr const char* kLock = "lock";

/// What is said of a folder that another run has.
inline constexpr const char* kInUse = "another run is writing into this folder";

/// Takes the lock of a folder. Returns the open file, which holds it until it is closed; where the
/// file system has no locks, without one, and warns. None: a run that ended meanwhile has removed
/// the file, or its folder; make the folder and ask again. Throws OutputError: another run has it,
/// or it cannot be written.
std::optional<int> take_lock(const std::filesystem::path& folder);

/// Whether a run that lives holds the lock of a folder, which need not be there.
bool is_locked(const std::filesystem::path& folder);

}  // namespace burnish
