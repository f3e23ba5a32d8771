// What becomes of an exception: an exit status and one sentence.
#pragma once

#include <stdexcept>
#include <string>

#include "cli/exit_codes.h"

namespace burnish {

struct Failure {
    ExitCode code = kDefect;
    std::string text;
};

/// Jobs of a batch have failed, as they have said.
struct BatchFailed : std::runtime_error {
    BatchFailed(ExitCode status, const std::string& text)
        : std::runtime_error(text), code(status) {}
    ExitCode code;  ///< of the first
};

/// Of the exception that is being handled.
Failure current_failure();

}  // namespace burnish
