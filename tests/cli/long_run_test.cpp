// Runs of very many iterations, and of large scenes: their memory, the bytes of their parts, and
// how soon a signal ends them. BURNISH_FAULTS=1 for 100,000 iterations and 1400 x 1400 pixels.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class LongRun : public Program {
  protected:
    LongRun() { write_scene(); }

    /// Waits until a run has written down that iteration. False: it has ended before.
    bool wait_for_iteration(int iteration, const std::string& out, pid_t pid) const {
        while (iterations_told(out) < iteration) {
            siginfo_t ended{};
            if (waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
                ended.si_pid == pid)
                return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(is_large ? 500 : 5));
        }
        return true;
    }

    const bool is_large = std::getenv("BURNISH_FAULTS") != nullptr;
};

/// Resident bytes of a program that runs.
double resident_bytes(pid_t pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// 1 MiB an hour at most; in a second, of which an hour's share is nothing, 1 MiB.
TEST_F(LongRun, ItsMemoryStaysAndItsPartsMakeTheSameBytes) {
    const int iterations = is_large ? 100000 : 1200, parts = 10;
    const std::string arguments =
        "optimize scene.xml --parameter roughness --init 0.5 --threads 1 "
        "--target-spp 16 --evaluation-spp 4 --iterations " +
        std::to_string(iterations) + " -o ";
    const pid_t whole = start(arguments + "whole");
    ASSERT_TRUE(wait_for_iteration(iterations * 2 / 5, "whole", whole));
    const Clock::time_point begin = Clock::now();
    const double before = resident_bytes(whole);
    ASSERT_TRUE(wait_for_iteration(iterations * 19 / 20, "whole", whole));
    const double hours = seconds_since(begin) / 3600, growth = resident_bytes(whole) - before;
    EXPECT_LE(growth, 0x1p20 * (is_large ? hours : 1));
    ASSERT_EQ(end_of(whole), 0) << read_text(folder / ".err");

    int stops = 0;
    for (int code = 75; code == 75;) {
        const int next =
            std::max(iterations / (parts + 2) * (stops + 1), iterations_told("parts") + 10);
        const pid_t pid =
            start(stops == 0 ? arguments + "parts" : "optimize --resume parts --threads 1");
        const bool is_last = stops == parts - 1;
        if (!is_last && wait_for_iteration(next, "parts", pid)) kill(pid, SIGTERM), ++stops;
        const int status = end_of(pid);
        ASSERT_TRUE(WIFEXITED(status)) << status;
        code = WEXITSTATUS(status);
        ASSERT_TRUE(code == 0 || (code == 75 && !is_last)) << read_text(folder / ".err");
    }
    EXPECT_GE(stops, parts / 2);  // a busy machine may let it end before a signal
    EXPECT_GE(expect_same_files(folder / "whole", folder / "parts"), 5u);
}

TEST_F(LongRun, ASignalEndsALargeOneSoon) {
    std::string scene = "scene.xml --parameter roughness --parameter base_color ";
    if (is_large) {
        ASSERT_EQ(run("scene goblet -o goblet --texture-size 2048").code, 0);
        scene =
            "goblet/scene.xml --parameter mat-goblet.roughness --parameter "
            "mat-goblet.base_color --size 1400 1400 ";
    }
    const pid_t stopped =
        start("optimize " + scene + "--target-spp 1 --evaluation-spp 2 --time 100000 -o out");
    ASSERT_TRUE(wait_for_iteration(8, "out", stopped)) << read_text(folder / ".err");
    Clock::time_point sent = Clock::now();
    kill(stopped, SIGTERM);
    const int with_checkpoint = end_of(stopped);
    EXPECT_LE(seconds_since(sent), 10);
    EXPECT_TRUE(WIFEXITED(with_checkpoint) && WEXITSTATUS(with_checkpoint) == 75)
        << read_text(folder / ".err");

    const int told = iterations_told("out");
    const pid_t impatient = start("optimize --resume out");
    ASSERT_TRUE(wait_for_iteration(told + 2, "out", impatient)) << read_text(folder / ".err");
    kill(impatient, SIGINT);
    std::this_thread::sleep_for(std::chrono::seconds(is_large ? 3 : 0));
    sent = Clock::now();
    kill(impatient, SIGINT);
    end_of(impatient);
    EXPECT_LE(seconds_since(sent), 1);
    EXPECT_FALSE(fs::exists(lock_of("out")));
}

}  // namespace
}  // namespace burnish
