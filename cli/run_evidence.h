// What the pictures of a run say of textures whose truth is known.
#pragma once

#include "cli/run_result.h"

namespace burnish {

/// The texels that light reaches where they are as in truth, on which errors are measured, and how
/// much they move the fitted pictures; and the errors of the start.
void find_evidence(RunResult& run);

}  // namespace burnish
