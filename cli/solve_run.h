// A run that solves: its progress on the terminal, its checkpoints, and what signals do to it.
#pragma once

#include <optional>

#include "cli/live_view.h"
#include "cli/run_checkpoints.h"

namespace burnish {

/// Throws Suspended where the system wants the program to end. from: where the run goes on.
EvaluatedRun solve_with_progress(Problem problem, const Options& options,
                                 RunCheckpoints& checkpoints, std::optional<Checkpoint> from,
                                 LiveView live);

}  // namespace burnish
