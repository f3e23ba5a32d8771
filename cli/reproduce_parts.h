// The parts of `burnish reproduce`, each one experiment with one scene: made, kept, and put
// together.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "cli/kept_results.h"
#include "cli/reproduce_machine.h"
#include "cli/reproduce_report.h"
#include "experiments/experiments.h"

namespace burnish {

struct KnownTarget {
    TargetSource source;        ///< of an own scene without its file
    bool own = false;           ///< a built-in scene, which the program makes
    nlohmann::json files = {};  ///< all that the scene may read, see files_of; none of an own one
};

/// The files below a folder, with hashes of their bytes: they tell whether a scene has changed. Not
/// those below a folder within it that is left out. Throws InputError: one cannot be read.
nlohmann::json files_of(const std::filesystem::path& folder,
                        const std::vector<std::filesystem::path>& left_out = {});

struct Part {
    const Experiment* experiment;
    const KnownTarget* target;  ///< none where the experiment needs no scene
    std::optional<ExperimentResult> result = {};
};

/// Finds the results of all parts, scene by scene: those that are kept, then the others, which are
/// kept as soon as they are made; what holds times is kept for the machine. A signal leaves out
/// what has not begun. Own scenes are made below `own_folder` and removed. Throws InputError: a
/// scene cannot be read; OutputError: a result cannot be kept.
void run_parts(const ReproduceOptions& options, const Machine& machine, const KeptResults& kept,
               const std::filesystem::path& own_folder, std::vector<Part>& parts);

/// What a signal says: of this run something is kept.
void set_kept(const KeptResults& kept);

std::size_t count_done(const std::vector<Part>& parts);

/// Of the parts that are not done: each takes as long as the same experiment did with other scenes,
/// or else as all parts with a scene do on average. None: nothing of that kind is done.
std::optional<double> seconds_left(const std::vector<Part>& parts);

/// The results of parts that are done, experiment by experiment.
Reproduction reproduction_of(const std::vector<Part>& parts);

}  // namespace burnish
