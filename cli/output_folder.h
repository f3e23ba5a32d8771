// The folder of a run's results. Everything is written into a folder within it first and moved into
// place at the end, file by file, each by one rename: a run that fails, or that a signal ends,
// leaves the earlier results as they were.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burnish/solve.h"

namespace burnish {

struct OutputFolder {
    std::filesystem::path folder;
    std::filesystem::path unfinished;        ///< write here
    std::vector<std::string> earlier_files;  ///< of the run that is replaced, relative
    bool replaces = false;                   ///< the folder holds an earlier run
    int lock = -1;                           ///< held while the run lives

    OutputFolder() = default;
    OutputFolder(OutputFolder&& other) noexcept;
    OutputFolder& operator=(OutputFolder&&) = delete;
    /// Removes what is unfinished.
    ~OutputFolder();
};

/// Makes the folder where it is missing. Throws InputError: it is a file, holds other things than
/// an earlier run (`force` allows them), cannot be written, or another run is writing into it.
OutputFolder open_output_folder(const std::filesystem::path& folder, bool force);

/// The files below `unfinished`, relative, sorted; summary.json last.
std::vector<std::string> unfinished_files(const OutputFolder& output);

/// Moves every unfinished file into place, summary.json last, and removes files that only the
/// earlier run had. Throws InputError.
void move_into_place(OutputFolder& output);

/// A name of its own for the folder of each view.
std::vector<std::string> folder_names(const std::vector<View>& views);

}  // namespace burnish
