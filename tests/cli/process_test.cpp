// What the system gives the process: standard streams that are closed, threads that are refused.
#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <system_error>

#include "cli/failures.h"
#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class Process : public Program {};

TEST_F(Process, FilesOfARunAreNotTakenForClosedStreams) {
    write_scene();
    const pid_t pid = start_shell(
        "sh -c \"exec '" BURNISH_BINARY
        "' optimize scene.xml --parameter base_color --target-spp 1048576 -o out <&- >&- 2>&-\"");
    EXPECT_TRUE(wait_for([&] { return fs::exists(lock_of("out")); }));
    const fs::path streams = fs::path("/proc") / std::to_string(pid) / "fd";
    for (const char* stream : {"0", "1", "2"}) {
        std::error_code error;
        EXPECT_EQ(fs::read_symlink(streams / stream, error).string(), "/dev/null") << stream;
    }
    kill(pid, SIGTERM);
    end_of(pid);
}

TEST_F(Process, ClosedStandardOutputIsSaid) {
    const Outcome outcome = shell("('" BURNISH_BINARY "' --version >&-)");
    EXPECT_EQ(outcome.code, 74);
    EXPECT_TRUE(contains(outcome.err, "standard output cannot be written")) << outcome.err;
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
}

/// Not what the standard library calls it.
TEST(Failures, OfFilesHaveTheFileAndTheReason) {
    const std::error_code full(ENOSPC, std::generic_category());
    for (const auto& [error, text] :
         {std::pair(fs::filesystem_error("cannot copy", full), "No space left on device"),
          std::pair(fs::filesystem_error("cannot copy", "a", full), "a: No space left on device"),
          std::pair(fs::filesystem_error("cannot copy", "a", "b", full),
                    "a: No space left on device")}) {
        const Failure failure = failure_of(error);
        EXPECT_EQ(failure.code, kCannotWrite);
        EXPECT_EQ(failure.text, text);
    }
    const std::error_code again(EAGAIN, std::generic_category());
    EXPECT_EQ(failure_of(fs::filesystem_error("x", again)).code, kCannotWrite) << "of no thread";
}

#ifdef BURNISH_FAULT_SHIM
TEST_F(Process, WithoutAThreadItIsRefused) {
    const Outcome outcome = shell("BURNISH_FAULT_THREADS=1 LD_PRELOAD=" BURNISH_FAULT_SHIM
                                  " '" BURNISH_BINARY "' info missing.xml");
    EXPECT_EQ(outcome.code, 77);
    EXPECT_TRUE(contains(outcome.err, "burnish: the system refuses a thread: ")) << outcome.err;
}
#endif

}  // namespace
}  // namespace burnish
