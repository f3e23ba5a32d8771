// What a run says of itself while it solves: a line on the terminal. A signal ends the iterations.
#pragma once

#include <memory>
#include <string>

#include "burnish/solve.h"
#include "cli/progress.h"

namespace burnish {

class SolveProgress {
  public:
    /// done: iterations of processes before.
    explicit SolveProgress(const Options& options, std::uint32_t done = 0);

    /// For solve(), which must end before this does.
    Callback callback();
    StageProgress stages();

  private:
    /// Does nothing where the title is that of the line that is shown.
    void begin_line(const std::string& title);
    void show_iteration(const Iteration& iteration);
    void show_stage(const char* stage, double share);

    Stop stop_;
    std::uint32_t done_ = 0;
    std::string title_;                     ///< of the line that is shown
    std::unique_ptr<TickingLine> ticking_;  ///< until the work says how far it is
    std::unique_ptr<ProgressLine> line_;
};

}  // namespace burnish
