// What the pictures of a run say of its textures.
#pragma once

#include "cli/run_result.h"

namespace burnish {

/// Warns of textures that no picture shows, and of those whose start is 0.5 because pictures show
/// them only mixed with others that are searched. The report has these warnings, too.
void warn_of_unseen(RunResult& run);

/// Of textures whose truth is known: the texels that light reaches where they are as in truth, on
/// which errors are measured, and how much they move the fitted pictures; and the errors of the
/// start.
void find_evidence(RunResult& run);

}  // namespace burnish
