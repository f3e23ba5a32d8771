// The program `burnish-mpi`: the command line of `burnish`, run by all processes of an MPI job.

#include <sched.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "burnish/mpi.h"
#include "cli/command_line.h"

namespace {

/// Whether all processes have come here, within so many seconds; 0: however long that takes.
bool all_have_ended(MPI_Comm leaving, double seconds) {
    const auto start = std::chrono::steady_clock::now();
    MPI_Request request;
    MPI_Ibarrier(leaving, &request);
    while (true) {
        int done = 0;
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done) return true;
        const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
        if (seconds > 0 && waited.count() > seconds) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

/// Ends the job where this process has failed and others have not: they would wait for it. leaving:
/// a communicator on which nothing else is said, since others may be in the middle of an exchange.
int leave(MPI_Comm leaving, int status, const std::string& error) {
    // Seconds: what all fail of, they fail of at about the same time.
    constexpr double kPatience = 2;
    if (!all_have_ended(leaving, status == 0 ? 0 : kPatience)) {
        int rank = 0, count = 0, length = 0;
        char host[MPI_MAX_PROCESSOR_NAME] = {};
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        MPI_Comm_size(MPI_COMM_WORLD, &count);
        MPI_Get_processor_name(host, &length);
        std::fprintf(stderr, "burnish: process %d of %d, on %s, ends the job%s%s\n", rank, count,
                     host, error.empty() ? "" : ": ", error.c_str());
        MPI_Abort(MPI_COMM_WORLD, status);
    }
    MPI_Finalize();
    return status;
}

/// The hardware threads that a process may run on, 0: not known.
int processors_of(pid_t process) {
    cpu_set_t set;
    CPU_ZERO(&set);
    return sched_getaffinity(process, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 0;
}

/// OpenMPI's launcher binds each of one or two processes to a core, which may be several hardware
/// threads, where it is not told not to. It, their parent, may run on all that there are.
void warn_of_idle_cores() {
    if (!std::getenv("OMPI_COMM_WORLD_RANK")) return;  // another launcher
    MPI_Comm here = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
    int rank = 0, processes = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(here, &processes);
    MPI_Comm_free(&here);
    const int all = processors_of(getppid()), own = processors_of(0), used = processes * own;
    if (rank == 0 && own > 0 && used < all)
        std::fprintf(stderr,
                     "burnish: warning: %d of %d processors %s in use, each process is bound to "
                     "%d: `mpirun --bind-to none` lets its threads run on all\n",
                     used, all, used == 1 ? "is" : "are", own);
}

/// A number in the environment, 0 where there is none.
int number_in(const char* variable) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : 0;
}

/// A launcher that speaks another protocol than this MPI library starts processes of which each is
/// the only one of its job. The first of these launchers that has left its number of processes has
/// started this one: OpenMPI's stands first, since one of the others may have started it.
void warn_of_strangers() {
    constexpr const char* kLaunchers[][2] = {{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"},
                                             {"PMI_SIZE", "PMI_RANK"},
                                             {"SLURM_STEP_NUM_TASKS", "SLURM_PROCID"}};
    int processes = 0;
    MPI_Comm_size(MPI_COMM_WORLD, &processes);
    for (const auto& [size, rank] : kLaunchers) {
        const int started = number_in(size);
        if (started < 1) continue;
        if (processes == 1 && started > 1 && number_in(rank) == 0)
            std::fprintf(stderr,
                         "burnish: warning: the launcher has started %d processes (%s) that do not "
                         "know of each other: expected that of the MPI library which burnish-mpi "
                         "is built with, as its mpirun, or `srun --mpi=pmix`\n",
                         started, size);
        return;
    }
}

}  // namespace

int main(int argc, char** argv) {
    MPI_Comm leaving = MPI_COMM_NULL;
    burnish::JoinedProcess process;
    process.join = [&] {
        int provided = 0;
        MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
        MPI_Comm_dup(MPI_COMM_WORLD, &leaving);
        warn_of_strangers();
        warn_of_idle_cores();
        return burnish::ranks_of(MPI_COMM_WORLD);
    };
    const int status = burnish::run_command_line(argc, argv, &process);
    if (leaving == MPI_COMM_NULL) return status;  // it has failed before it joined the others
    return leave(leaving, status, process.error);
}
