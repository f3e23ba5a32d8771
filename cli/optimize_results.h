// What a run of `burnish optimize` leaves: a line of text, and its files.
#pragma once

#include "cli/output_folder.h"
#include "cli/run_result.h"

namespace burnish {

/// Before the run: what the targets and the evaluation will take, where that is long.
void log_long_phases(const RunResult& run);
/// Before the run: throws OutputError where its results have no room, or one would replace a file
/// among those that were read.
void require_place(const OutputFolder& output, const Renderer& renderer, const RunResult& run,
                   const std::vector<Input>& read);

void log_result(const RunResult& run, const EvaluatedRun& evaluated);

/// Writes all results and puts them in place. Checkpoints go, but those of a run that a signal
/// ended early: it can go on. Throws OutputError.
void write_results(const Renderer& renderer, RunResult& run, OutputFolder& output);

}  // namespace burnish
