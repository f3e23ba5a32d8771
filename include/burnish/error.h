// What is thrown. Every message is one sentence for the person who reads it.
#pragma once

#include <stdexcept>

namespace burnish {

/// The family of all exceptions that Burnish throws on purpose; itself where Ranks::exchange
/// returns something else than was sent. Besides, std::bad_alloc comes where memory ends, and what
/// functions of the caller's own throw.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Input that cannot be used. what() names the place (file:line:column, or file and byte offset),
/// what was found and what was expected.
struct InputError : Error {
    using Error::Error;
};

/// A resource that is not there: memory, or memory below a limit. what() says what was needed and
/// what there is.
struct ResourceError : Error {
    using Error::Error;
};

/// A file or folder that cannot be written, or a folder of checkpoints that cannot be read. what()
/// names it and says why.
struct OutputError : Error {
    using Error::Error;
};

}  // namespace burnish
