// What a run of `burnish optimize` keeps on the disk while it goes: DIR/checkpoints holds the last
// two checkpoints and the history so far, DIR/checkpoints/compared those of a second run.
#pragma once

#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "burnish/checkpoint.h"
#include "cli/output_folder.h"
#include "cli/run_result.h"

namespace burnish {

/// A signal has ended what the same command, or --resume, goes on with. what(): how.
struct Suspended : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// How a run goes on that has a checkpoint.
std::string resume_hint(const OutputFolder& output);

/// Throws where a folder, which need not be there, holds no checkpoint of a first run: InputError;
/// OutputError where a run is at work in it that has none yet.
void require_checkpoint(const std::string& folder);

/// The newest checkpoint of the first run in a folder; says what is wrong with newer ones. Throws
/// InputError: there is none, or a file that the run has read is another one now.
Checkpoint load_run(const OutputFolder& output, const Ranks& ranks);

/// The newest checkpoint of a second run in the folder of its checkpoints; says what is wrong with
/// newer ones. None: there is none, or none is whole, and it says so.
std::optional<Checkpoint> load_second_run(const std::string& folder, const Ranks& ranks);

/// The settings of the run, as JSON; and as they were given.
std::string settings_of(const Checkpoint& checkpoint);
std::string asked_of(const Checkpoint& checkpoint);

/// Checkpoints and history of one run.
class RunCheckpoints {
  public:
    /// part: of a second run, "compared". The folder outlives this; it becomes the run's own with
    /// its first checkpoint.
    RunCheckpoints(const RunResult& run, OutputFolder& output, const std::string& part = {});
    RunCheckpoints(const RunCheckpoints&) = delete;
    RunCheckpoints& operator=(const RunCheckpoints&) = delete;

    /// For solve().
    const Checkpoints& options() const { return options_; }
    /// Before the first iteration of this process. earlier: those of processes before.
    void begin(const std::vector<Iteration>& earlier);
    void add(const Iteration& iteration);
    /// Throws, the same in all processes, Suspended where everything lies on the disk, otherwise
    /// OutputError: there is nothing to keep.
    [[noreturn]] void suspend() const;

  private:
    void tell(const CheckpointNote& note);
    void write(const std::string& rows);  ///< on the history

    OutputFolder& output_;
    Ranks ranks_;  ///< of which the first one writes
    Checkpoints options_;
    std::string hint_;
    std::string error_;  ///< of the last checkpoint; empty: it was written
    std::ofstream history_;
    std::uintmax_t history_bytes_ = 0;  ///< that are whole rows
};

}  // namespace burnish
