// Lists of optimisations as files: docs/guide/many-runs.md.
#pragma once

#include <string>
#include <vector>

#include "cli/optimize_options.h"

namespace burnish {

/// A run of `burnish optimize`.
struct BatchJob {
    std::size_t number = 0;       ///< in the list, from 1
    OptimizeArguments arguments;  ///< of which the settings are made
    Settings settings;            ///< their output folder is that of no other job, nor within one
};

/// All jobs of a list. Throws InputError that names the file, the key, what was found and what was
/// expected: before any of them has begun.
std::vector<BatchJob> read_jobs(const std::string& file);

/// One of `count` parts of a list: the jobs whose place, counted from 0, leaves `index` when
/// divided by count.
struct Slice {
    std::size_t index = 0, count = 1;
};
/// Of "I/N", 0 <= I < N. Throws UsageError.
Slice parse_slice(const std::string& text);
std::vector<BatchJob> slice_of(std::vector<BatchJob> jobs, const Slice& slice);

}  // namespace burnish
