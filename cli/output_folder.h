// The folder of a run's results. Everything is written into a folder within it first and moved into
// place at the end, file by file, each by one rename: a run that fails, or that a signal ends,
// leaves the earlier results as they were. `burnish new` and `burnish scene` write scenes in the
// same way.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burnish/input.h"
#include "cli/interrupt.h"

namespace burnish {

struct OutputFolder {
    std::filesystem::path folder;
    std::filesystem::path unfinished;        ///< write here; empty: nowhere
    std::filesystem::path checkpoints;       ///< they outlive the process
    std::vector<std::string> earlier_files;  ///< of the run that is replaced, relative
    bool replaces = false;                   ///< the folder holds an earlier run
    bool owns_checkpoints = false;           ///< any are those of the run that writes here
    /// Removes what is unfinished, and the folders that were made and are empty.
    CleanUp clean_up;
};

/// What is found in a folder that results are to go to.
enum class Found {
    kEmpty,    ///< anything is left alone, results too
    kRefused,  ///< a run that was stopped, or other things than results, are left alone
    kAllowed,  ///< they are allowed
    kResumed,  ///< a run that was stopped goes on
};

/// Makes the folder where it is missing. Throws OutputError: it is a file, holds what is refused or
/// a link to a folder where results go, cannot be written, or another run is writing into it. All
/// is then as it was before.
OutputFolder open_output_folder(const std::filesystem::path& folder, Found found);

/// That of a process which helps the one that has opened the folder: it has no place to write.
OutputFolder helping_folder(const std::filesystem::path& folder);
/// Gives such a process a temporary folder as its `unfinished`, which goes with it. Throws
/// OutputError.
void make_temporary(OutputFolder& output);

/// Throws OutputError where the disk, a quota or a limit has no room for so many bytes.
void require_room(const OutputFolder& output, double bytes);

/// Throws OutputError where a result, by its name in the folder, would replace a file of those that
/// the run reads. A link is replaced itself, and results of an earlier run in the folder are to be.
void require_no_inputs(const OutputFolder& output, const std::vector<std::string>& results,
                       const std::vector<Input>& inputs);

/// The first of the run that writes here lies on the disk: those of an older one go.
void take_checkpoints(OutputFolder& output, const std::filesystem::path& first);
/// All go.
void clear_checkpoints(const OutputFolder& output);
/// They stay: relative to the folder.
std::vector<std::string> checkpoint_files(const OutputFolder& output);
/// Whether the run that writes here has left a checkpoint, of this process or of one before it.
bool keeps_run(const OutputFolder& output);

/// The files below `unfinished`, relative, sorted; summary.json or scene.xml last.
std::vector<std::string> unfinished_files(const OutputFolder& output);

/// Moves every unfinished file into place, in the order of unfinished_files, and removes files that
/// only the earlier run had, none of them through a link. They lie on the disk then. Throws
/// OutputError.
void move_into_place(OutputFolder& output);
/// The same of a scene: where one of its files cannot be moved, those that were not there before
/// are removed.
void move_scene_into_place(OutputFolder& output);

}  // namespace burnish
