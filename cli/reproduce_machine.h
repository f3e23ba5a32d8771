// The machine that times are of: results that hold times count for it alone.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace burnish {

struct Machine {
    std::size_t threads = 1;  ///< in use
    std::string processor;
};

/// This one, where so many threads are asked for; 0: all cores.
Machine machine_of(int threads);
/// The name of the processor in the text of /proc/cpuinfo; empty: it has none.
std::string processor_name(const std::string& cpuinfo);

void to_json(nlohmann::json& json, const Machine& machine);

}  // namespace burnish
