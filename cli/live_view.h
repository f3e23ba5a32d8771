// `--live`: what a run shows in a viewer beside it.
#pragma once

#include <optional>
#include <string>

#include "burnish/live.h"
#include "cli/output_folder.h"
#include "cli/run_result.h"
#include "core/note.h"

namespace burnish {

/// Shows nothing where there is no address. Warns once where no viewer takes the images.
class LiveView {
  public:
    /// Of the first process of a run, which outlives this. Images are named after the folder. part:
    /// of a second run.
    LiveView(const RunResult& run, const OutputFolder& output, const std::string& part = {});

    /// After an iteration.
    void update(const Solver& solver);
    /// The result, beside the pictures that the run has read.
    void finish(const Summary& summary);

  private:
    void warn();

    const RunResult& run_;
    Note note_;
    std::optional<Live> live_;
};

}  // namespace burnish
