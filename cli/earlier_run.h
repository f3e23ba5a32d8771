// What earlier processes have left of a run of `burnish optimize`.
#pragma once

#include <string>

#include "cli/settings.h"

namespace burnish {

/// The first setting in which a run, whose settings are recorded as JSON, differs from what is
/// asked for: "seed: 1, now 3". Empty: it is the same run. run.max_memory does not count, which may
/// be given anew; settings that the record lacks have their defaults. Of a record that cannot be
/// read: why.
std::string changed_setting(const std::string& recorded, const Settings& asked);
/// The same of the results in the output folder of settings; empty, too, where there are none.
std::string changed_since_results(const Settings& asked);

/// What the output folder of settings holds.
enum class EarlierRun {
    kNone,     ///< nothing of these settings
    kDone,     ///< the results of these settings, whole
    kStopped,  ///< a run that can go on, of these or of other settings
};
EarlierRun earlier_run(const Settings& asked);

/// Whether a folder holds the results of a run, and of a second one where there was one, that has
/// met one of its rules.
bool holds_ended_run(const std::string& folder);

/// "loss 0.14 -> 0.02, 200 iterations", of the results in a folder; empty where there are none.
std::string result_text(const std::string& folder);

}  // namespace burnish
