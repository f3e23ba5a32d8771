// What the system gives the process: standard streams that are closed, threads that are refused.
#include <cerrno>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "cli/failures.h"
#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class Process : public Program {};

TEST_F(Process, FilesOfARunAreNotTakenForClosedStreams) {
    write_scene();
    const std::string command =
        "cd '" + folder.string() +
        "' && exec '" BURNISH_BINARY
        "' optimize scene.xml --parameter base_color --target-spp 1048576 -o out <&- >&- 2>&-";
    const pid_t pid = fork();
    if (pid == 0) {
        execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        _exit(127);
    }
    const fs::path lock = folder / "out/.burnish-unfinished/lock";
    for (int i = 0; i < 6000 && !fs::exists(lock); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_TRUE(fs::exists(lock));
    const fs::path streams = fs::path("/proc") / std::to_string(pid) / "fd";
    for (const char* stream : {"0", "1", "2"}) {
        std::error_code error;
        EXPECT_EQ(fs::read_symlink(streams / stream, error).string(), "/dev/null") << stream;
    }
    kill(pid, SIGTERM);
    waitpid(pid, nullptr, 0);
}

TEST_F(Process, ClosedStandardOutputIsSaid) {
    const int status = std::system(
        ("cd '" + folder.string() + "' && '" BURNISH_BINARY "' --version >&- 2>.err").c_str());
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 74) << status;
    EXPECT_TRUE(contains(read_text(folder / ".err"), "standard output cannot be written"));
}

template <class Error>
Failure failure_of(const Error& error) {
    try {
        throw error;
    } catch (...) {
        return current_failure();
    }
}

TEST(Failures, AThreadThatIsRefusedIsALimit) {
    for (const Failure& failure :
         {failure_of(std::system_error(EAGAIN, std::generic_category())),
          failure_of(std::runtime_error("pthread_create has failed: try again"))}) {
        EXPECT_EQ(failure.code, kRefused) << failure.text;
        EXPECT_TRUE(failure.text.starts_with("the system refuses a thread: ")) << failure.text;
    }
    EXPECT_EQ(failure_of(std::system_error(EDEADLK, std::generic_category())).code, kDefect);
    EXPECT_EQ(
        failure_of(fs::filesystem_error("x", std::error_code(EAGAIN, std::generic_category())))
            .code,
        kCannotWrite);
}

#ifdef BURNISH_FAULT_SHIM
TEST_F(Process, WithoutAThreadItIsRefused) {
    const int status = std::system(("cd '" + folder.string() +
                                    "' && BURNISH_FAULT_THREADS=1 LD_PRELOAD=" BURNISH_FAULT_SHIM
                                    " '" BURNISH_BINARY "' info missing.xml >.out 2>.err")
                                       .c_str());
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 77) << status;
    EXPECT_TRUE(contains(read_text(folder / ".err"), "burnish: the system refuses a thread: "))
        << read_text(folder / ".err");
}
#endif

}  // namespace
}  // namespace burnish
