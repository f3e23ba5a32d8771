// Runs that outlive their process: files from which solve() goes on, to the bytes of a run that was
// never stopped.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "burnish/input.h"
#include "burnish/solve.h"

namespace burnish {

/// A run between two iterations.
struct Checkpoint {
    /// So far, without `textures`, `start`, `result` and `ending`.
    Summary run = {};
    std::string program = {};         ///< the Burnish that wrote it
    std::vector<Input> problem = {};  ///< options, scene, pictures, starts: solve() compares them
    std::string settings = {};        ///< Checkpoints::settings
    std::vector<Input> files = {};    ///< Checkpoints::files
    std::string file = {};            ///< where it lies
    std::vector<std::string> damaged = {};  ///< what is wrong with newer ones, a sentence each
};

/// What became of a checkpoint.
struct CheckpointNote {
    std::string file = {};
    std::uint32_t iterations = 0;  ///< done
    bool is_last = false;          ///< no iteration follows
    std::string error = {};        ///< why it could not be written; empty: it lies on the disk
};

/// When and where solve() writes checkpoints; the last two are kept. It writes one after the last
/// iteration, too, before it evaluates, and, as a single process, where memory ends within an
/// iteration, before it throws. Of several processes the first one writes one file for all.
struct Checkpoints {
    /// Made where it is missing; never empty. A checkpoint's name is the number of iterations with
    /// ten digits and ".burnish"; files of other names are left alone, but for what a writing that
    /// was cut off has left.
    std::string folder = {};
    /// Between two; longer where writing takes more than 2 % of the time.
    double seconds = 60;
    std::string settings = {};      ///< of the caller's own, kept with the run
    std::vector<Input> files = {};  ///< that the caller has read, kept with the run
    /// Files elsewhere that belong to an earlier run in the folder: they go with its checkpoints,
    /// once the first of this run lies on the disk, before that has its name.
    std::vector<std::string> replaced = {};
    /// Hears of each one. Empty: an OutputError ends the run where the folder cannot be made, or
    /// one cannot be written.
    std::function<void(const CheckpointNote&)> note = {};
    /// Asked from time to time within an iteration, by any thread, and before the evaluation: where
    /// it says so the iteration ends unfinished, as if it had not begun, the run is written, and
    /// solve() returns with Ending::kSuspended. Of several processes each asks its own, and where
    /// one stops all do. A run that cannot be written, and has an iteration, is evaluated instead:
    /// Ending::kCancelled, or what ended it before.
    std::function<bool()> stop = {};
};

/// The newest checkpoint of a folder that is whole. ranks: each process keeps its part of the
/// state. How many have written it does not matter. Throws InputError: there is none, or none is
/// whole, and why; or a process that is not one of the ranks' number. OutputError: the folder
/// cannot be read.
Checkpoint load_checkpoint(const std::string& folder, const Ranks& ranks = {});

/// As solve() of burnish/solve.h, with checkpoints. Throws InputError, too, where their folder has
/// no name, and OutputError: the folder cannot be read; where nobody hears of it
/// (Checkpoints::note), it cannot be made, before the first iteration, or a checkpoint cannot be
/// written.
Summary solve(Problem problem, const Options& options, const Checkpoints& checkpoints,
              const Callback& callback = {}, const StageProgress& progress = {});
/// Goes on from a checkpoint. Stop, the iterations and the seconds of the summary count from the
/// start of the run. Throws InputError: the problem or an option that decides on bytes is another
/// one; says which.
Summary solve(Problem problem, const Options& options, Checkpoint from,
              const Checkpoints& checkpoints, const Callback& callback = {},
              const StageProgress& progress = {});

}  // namespace burnish
