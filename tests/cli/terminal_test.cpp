// A run in a terminal that closes.
#include <fcntl.h>

#include "program.h"

namespace burnish {
namespace {

using namespace testing;

class Terminal : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        const int master = posix_openpt(O_RDWR | O_NOCTTY);
        if (master < 0) GTEST_SKIP() << "there are no pseudoterminals";
        close(master);
    }
    /// Runs the program in a terminal, which closes once its iterations begin.
    /// Returns the status that it ended with. ignores_hangup: as under `nohup`.
    int close_in_the_iterations(const std::string& arguments, bool ignores_hangup) const {
        const std::string command =
            "cd '" + folder.string() + "' && exec '" BURNISH_BINARY "' " + arguments;
        const int master = posix_openpt(O_RDWR | O_NOCTTY);
        EXPECT_EQ(grantpt(master), 0);
        EXPECT_EQ(unlockpt(master), 0);
        const std::string name = ptsname(master);
        const pid_t pid = fork();
        if (pid == 0) {
            close(master);
            setsid();
            const int terminal = open(name.c_str(), O_RDWR);  // it controls the session
            for (const int stream : {0, 1, 2}) dup2(terminal, stream);
            setenv("TERM", "xterm", 1);
            std::signal(SIGHUP, ignores_hangup ? SIG_IGN : SIG_DFL);
            execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            _exit(127);
        }
        std::string shown;
        for (char byte = 0; !contains(shown, "\riteration ") && read(master, &byte, 1) == 1;)
            shown += byte;
        EXPECT_TRUE(contains(shown, "\riteration ")) << shown;
        close(master);
        return end_of(pid);
    }
};

constexpr const char* kInATerminal =
    "optimize scene.xml --parameter base_color --init 0.5 --spp 4 --target-spp 16 "
    "--evaluation-spp 8 -o out ";

TEST_F(Terminal, OneThatClosesSuspendsTheRun) {
    write_scene();
    const int status = close_in_the_iterations(std::string(kInATerminal) + "--time 3600", false);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
    EXPECT_FALSE(checkpoints_in(folder / "out/checkpoints").empty());
    EXPECT_FALSE(fs::exists(lock_of("out").parent_path()));
}

TEST_F(Terminal, OneThatClosesUnderNohupChangesNothing) {
    write_scene();
    const int status = close_in_the_iterations(std::string(kInATerminal) + "--iterations 50", true);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    EXPECT_EQ(summary_of("out")["result"]["iterations"], 50);
    EXPECT_TRUE(fs::exists(folder / "out/report.html"));
}

}  // namespace
}  // namespace burnish
