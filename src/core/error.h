// Failures of the first kind: bad input. One clear sentence; the command line prints it and exits
// non-zero.
#pragma once

#include <stdexcept>
#include <string>

namespace burnish {

/// Input that cannot be used. what() is one sentence that names the place (file:line:column or file
/// and byte offset), what was found and what was expected.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace burnish
