// What becomes of an exception: an exit status and one sentence.
#pragma once

#include <stdexcept>
#include <string>
#include <system_error>

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

/// What was printed on standard output did not arrive. Of a reader that left, with EPIPE, it is no
/// failure.
struct UnprintedLine : std::system_error {
    using std::system_error::system_error;
};

/// Prints on standard output, before all that is said later. Throws UnprintedLine.
void print(const std::string& text);

/// Of the exception that is being handled.
Failure current_failure();

}  // namespace burnish
