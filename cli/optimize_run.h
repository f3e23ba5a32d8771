// A run of `burnish optimize`, from what is asked for to its results.
#pragma once

#include "burnish/ranks.h"
#include "cli/optimize_options.h"

namespace burnish {

/// From the beginning. Throws what ends it early: see command_line.h. ranks: processes that do it
/// together, of which the first one speaks and writes.
void begin_run(const Settings& settings, const Ranks& ranks);

/// Goes on with the run in the folder OptimizeArguments::resume.
void resume_run(const OptimizeArguments& arguments, const Ranks& ranks);

/// From the beginning, or on from a stopped run of these settings. Throws InputError, too, where
/// the stopped run has other settings.
void finish_run(const Settings& asked, const Ranks& ranks);

}  // namespace burnish
