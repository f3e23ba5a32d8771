#include "cli/process_memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "cli/console.h"

namespace burnish {

namespace fs = std::filesystem;

namespace {

/// The number that a file of the system begins with; infinity where there is none ("max").
double number_in(const fs::path& file) {
    double number = 0;
    std::ifstream stream(file);
    return stream >> number ? number : std::numeric_limits<double>::infinity();
}

/// Of the group "/a/b" and those above it: of all, the number in such a file.
double lowest_number(const fs::path& root, std::string group, const char* file) {
    double lowest = std::numeric_limits<double>::infinity();
    while (true) {
        lowest = std::min(lowest, number_in(fs::path(root.string() + group) / file));
        const std::size_t above = group.rfind('/');
        if (above == std::string::npos) return lowest;
        group.resize(above);
    }
}

}  // namespace

double control_group_limit(const fs::path& root, const std::string& groups) {
    double limit = std::numeric_limits<double>::infinity();
    std::istringstream lines(groups);
    for (std::string line; std::getline(lines, line);) {  // NUMBER:CONTROLLERS:GROUP
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const std::string group = line.substr(second + 1);
        if (line.starts_with("0::"))
            limit = std::min(limit, lowest_number(root, group, "memory.max"));
        else if (controllers.find(",memory,") != std::string::npos)
            limit = std::min(limit, lowest_number(root / "memory", group, "memory.limit_in_bytes"));
    }
    return limit;
}

double physical_memory() {
    std::ostringstream groups;
    groups << std::ifstream("/proc/self/cgroup").rdbuf();
    return std::min(
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)),
        control_group_limit("/sys/fs/cgroup", groups.str()));
}

double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

std::string memory_text(const MemoryEstimate& memory) {
    if (memory.max_records == 0)
        return fmt::format("at most about {}, of which samples and reservoirs {}",
                           bytes_text(maximum(memory)), bytes_text(memory.samples));
    return fmt::format("about {}, of which records {}; at most {}", bytes_text(expected(memory)),
                       bytes_text(memory.records), bytes_text(maximum(memory)));
}

}  // namespace burnish
