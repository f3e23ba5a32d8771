// The command line: commands, their options, and what becomes of an error: one sentence on standard
// error, `burnish: ...`, and an exit status of cli/exit_codes.h.
#pragma once

#include <functional>
#include <string>

#include "burnish/ranks.h"

namespace burnish {

/// A process that runs a command together with others: the first one speaks and writes.
struct JoinedProcess {
    /// The processes. Called once, when signals are watched and there is no other thread; not
    /// called where they cannot be watched.
    std::function<Ranks()> join;
    std::string error = {};  ///< becomes what ended the command, where it is not the first
};

/// Visible where the library is a shared one, which hides all else. process: null, or one of
/// several.
[[gnu::visibility("default")]] int run_command_line(int argc, char** argv,
                                                    JoinedProcess* process = nullptr);

}  // namespace burnish
