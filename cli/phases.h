// How long the phases of a run take.
#pragma once

#include <string>

#include "cli/run_result.h"
#include "core/stopwatch.h"

namespace burnish {

/// Seconds of each phase, by the name of the phase.
class Phases {
  public:
    explicit Phases(RunResult& run) : run_(run) {}
    void end(const std::string& name) { run_.phases.emplace_back(name, watch_.lap()); }
    /// A phase of which so many seconds are `first`, the others `second`. `earlier` of the former
    /// passed in processes before this one; `named` of the phase have a name of their own.
    void end(const std::string& first, const std::string& second, double seconds, double earlier,
             double named) {
        run_.phases.emplace_back(first, seconds);
        run_.phases.emplace_back(second, watch_.lap() - (seconds - earlier) - named);
    }

  private:
    RunResult& run_;
    Stopwatch watch_;
};

}  // namespace burnish
