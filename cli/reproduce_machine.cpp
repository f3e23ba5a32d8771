#include "cli/reproduce_machine.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/parallel.h"
#include "core/version.h"

namespace burnish {

std::string processor_name(const std::string& cpuinfo) {
    std::istringstream lines(cpuinfo);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("model name")) continue;
        const std::size_t begin = line.find_first_not_of(" \t", line.find(':') + 1);
        return begin == std::string::npos ? "" : line.substr(begin);
    }
    return "";
}

Machine machine_of(int threads) {
    std::ostringstream cpuinfo;
    cpuinfo << std::ifstream("/proc/cpuinfo").rdbuf();
    std::string processor = processor_name(cpuinfo.str());
    if (processor.empty()) processor = instruction_set();
    return {threads_of(threads), std::move(processor)};
}

void to_json(nlohmann::json& json, const Machine& machine) {
    json = {{"threads", machine.threads}, {"processor", machine.processor}};
}

}  // namespace burnish
