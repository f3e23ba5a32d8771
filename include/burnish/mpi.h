// The processes of an MPI communicator, for Problem::ranks and load_checkpoint(): link
// Burnish::mpi.
#pragma once

#include <mpi.h>

#include "burnish/ranks.h"

namespace burnish {

/// The communicator must outlive what is returned, and nothing else may be sent on it while a call
/// lasts. All calls come from the thread that solves: MPI_THREAD_FUNNELED is enough.
///
///     problem.ranks = burnish::ranks_of(MPI_COMM_WORLD);
///     const burnish::Summary summary = burnish::solve(problem, options);
Ranks ranks_of(MPI_Comm communicator);

}  // namespace burnish
