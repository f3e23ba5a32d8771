// Views in which nothing that is recovered can be seen: their cameras look elsewhere, as those in
// other units or axes than the scene do.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/run_result.h"

namespace burnish {

/// The views in which no light from an unknown can reach a pixel, into run.unseeing_views.
/// reaching: reaching_pixels of those that are fitted. Throws InputError where no view that
/// is fitted is left.
void find_unseeing_views(const Theta& theta, std::span<const std::vector<char>> reaching,
                         RunResult& run);

/// What is said of run.unseeing_views, a sentence; empty: there are none.
std::string unseeing_text(const RunResult& run);

/// "a, b, c and 4 other views": the first few names.
std::string views_text(std::vector<std::string> names);

}  // namespace burnish
