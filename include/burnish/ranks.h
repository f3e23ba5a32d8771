// Processes that solve one problem together, on one machine or on many.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace burnish {

/// The processes that share out the views and texels of a problem, and of a path cache the bands of
/// a view where there are fewer views than processes. Each has the same problem and options, and
/// makes the same calls; the result does not depend on how many they are. Those of MPI:
/// burnish/mpi.h.
struct Ranks {
    int rank = 0;   ///< this process, from 0
    int count = 1;  ///< at most the views of an iteration, but where this visits all fitted ones
    /// Sends a message of bytes to each rank, itself included, and returns those that came: both
    /// are parallel to the ranks. Returns once all ranks have called it. Not needed by one alone.
    /// What it throws is thrown by the call that needs it; where it returns something else, Error.
    std::function<std::vector<std::string>(std::vector<std::string> messages)> exchange = {};
};

}  // namespace burnish
