// The memory of the process, and of the machine that it runs on.
#pragma once

#include <filesystem>
#include <string>

#include "optimize/memory.h"

namespace burnish {

/// The machine's memory, or less where the control group of the process has a limit; bytes.
double physical_memory();
/// The lowest limit of a process's control groups and of those above them, of version 1 and 2,
/// bytes; infinity where there is none. groups: the text of /proc/PID/cgroup. root: where the
/// groups are folders, as /sys/fs/cgroup.
double control_group_limit(const std::filesystem::path& root, const std::string& groups);
/// The maximum of the memory that the process has held so far, bytes.
double peak_memory();
/// "about 1.2 GiB, of which records 0.5 GiB; at most 2.1 GiB"
std::string memory_text(const MemoryEstimate& memory);

}  // namespace burnish
