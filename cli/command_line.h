// The command line: commands, their options, and what becomes of an error.
//
// Exit codes: 0 done (also where a descent was ended by a signal and wrote what it had), 1 bad
// input or too little memory, 2 bad usage. Every error is one sentence on standard error, `burnish:
// ...`.
#pragma once

namespace burnish {

/// Visible where the library is a shared one, which hides all else.
[[gnu::visibility("default")]] int run_command_line(int argc, char** argv);

}  // namespace burnish
