// Checkpoints as files: docs/reference/checkpoint.md. A header with the size and the hash of each
// section, then the sections: what the run is made of, what it has found, its state.
#pragma once

#include <filesystem>
#include <optional>

#include "burnish/checkpoint.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "optimize/whole_state.h"

namespace burnish {

/// The regular files of a folder whose name is that of a checkpoint, ten digits and ".burnish",
/// oldest first; none where there is no folder. What has another name is somebody else's.
/// Throws OutputError where the folder cannot be read: they would count as none.
std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& folder);

/// Sentences on newer checkpoints that are damaged, and on a checkpoint that another program wrote.
/// run: the subject of the sentence, "the run".
std::vector<std::string> warnings_of(const Checkpoint& checkpoint, const std::string& run);

/// What writing a state is taken to last until one was written: as long as on a slow disk.
double expected_writing_seconds(const State::Values& state);

/// Writes the checkpoints of one run when they are due.
class CheckpointWriter {
  public:
    /// first: the iterations of the checkpoint that the run goes on from; none: it is new. Files
    /// that a writer which was killed has left in the folder go. Of several processes the first one
    /// writes. Throws InputError: a folder without a name; OutputError: one that cannot be made,
    /// where nobody hears of it.
    CheckpointWriter(const Checkpoints& options, std::vector<Input> problem, const Ranks& ranks,
                     std::optional<std::uint32_t> first);

    /// After an iteration. run: its state is `state`. is_last: no iteration follows. Returns
    /// whether the state lies on the disk, the same to all processes.
    bool offer(const Summary& run, const State::Values& state, bool is_last);
    const StopQuestion& stop() const { return options_.stop; }

  private:
    bool is_due(const State::Values& state) const;
    void write(const Summary& run, const WholeState& state, const std::filesystem::path& file);
    /// Without what goes as soon as there is one of this run.
    std::vector<std::filesystem::path> own_checkpoints() const;
    void make_room() const;
    void remove_stale();

    static constexpr double kRest = 50;  ///< at most 2 % of the time goes into writing
    const Checkpoints& options_;
    std::vector<Input> problem_;
    const Ranks& ranks_;
    /// What an earlier run, or one that is given up, has left. Goes once one of this run lies on
    /// the disk, before that has its name: the newest by its name is never of another run.
    std::vector<std::filesystem::path> stale_;
    std::vector<std::filesystem::path> replaced_;  ///< the same elsewhere
    Stopwatch since_;                              ///< the last one
    std::optional<double> took_;            ///< seconds that the last one which was written took
    std::optional<std::uint32_t> written_;  ///< iterations of the last one that was written
};

}  // namespace burnish
