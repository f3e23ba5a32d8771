// What processes that run a command together are asked for is the same on all of them: they decide
// by it which messages they exchange.
#pragma once

#include <string>
#include <vector>

#include "burnish/ranks.h"
#include "cli/batch_jobs.h"

namespace burnish {

/// Throws InputError on all processes where one has other settings than the first: it names both,
/// the setting and its values. What repeats no run, as the threads, may differ.
void require_same_settings(const Settings& settings, const Ranks& ranks);

/// The same of a list of jobs, their folders, and the part of it that is asked for.
void require_same_jobs(const std::vector<BatchJob>& jobs, const std::string& slice,
                       const Ranks& ranks);

}  // namespace burnish
