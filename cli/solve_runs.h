// What `burnish optimize` solves once all is read: its run, and the second one of --compare.
#pragma once

#include <exception>
#include <optional>

#include "burnish/checkpoint.h"
#include "burnish/renderer.h"
#include "cli/output_folder.h"
#include "cli/phases.h"

namespace burnish {

/// The descent of the first run and what its result is worth. from: where it goes on. Throws
/// Suspended, see solve_with_progress.
void solve_first(const Renderer& renderer, OutputFolder& output, std::optional<Checkpoint> from,
                 Phases& phases, RunResult& run);

/// The same of the second run, which goes on where it has a checkpoint. Where it fails the first
/// run's results stay: returns what it has thrown; null: it is done, or is left out, which it says.
std::exception_ptr solve_second(const Renderer& renderer, OutputFolder& output, Phases& phases,
                                RunResult& run);

}  // namespace burnish
