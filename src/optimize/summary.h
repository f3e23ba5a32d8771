// What a run says of itself while it goes on.
#pragma once

#include "burnish/solve.h"

namespace burnish {

/// Counts an iteration and keeps it, or, in a long run, only some: memory does not grow with the
/// iterations.
void add_iteration(const Iteration& iteration, Summary& summary);

}  // namespace burnish
