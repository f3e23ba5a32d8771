// The exit statuses of the program: docs/reference/command-line.md. The numbers are those of BSD's
// sysexits.h, where it has one.
#pragma once

namespace burnish {

enum ExitCode {
    kDone = 0,
    kBadUsage = 2,      ///< the command line
    kBadInput = 65,     ///< a file, or what it says
    kDefect = 70,       ///< of the program
    kCannotWrite = 73,  ///< an output
    kInputOutput = 74,  ///< standard output
    kInterrupted = 75,  ///< by a signal, with a checkpoint: the run can go on
    kRefused = 77,      ///< by a limit: memory, threads
};

}  // namespace burnish
