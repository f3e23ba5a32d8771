// What a run keeps on the disk while it goes, where writing fails.
#include "cli/run_checkpoints.h"

#include <csignal>

#include "burnish/error.h"
#include "cli/history.h"
#include "cli/program.h"
#include "optimize/thread_ranks.h"

namespace burnish {
namespace {

using namespace testing;

/// The first of several processes alone hears what became of a checkpoint.
TEST(RunCheckpointsTest, AllProcessesEndAlike) {
    const test::TemporaryFolder folder;
    for (const bool is_written : {true, false})
        test::on_ranks(2, [&](const Ranks& ranks) {
            RunResult run;
            run.ranks = ranks;
            OutputFolder output = helping_folder(folder.path);
            const RunCheckpoints checkpoints(run, output);
            if (ranks.rank == 0 && !is_written)
                checkpoints.options().note({.is_last = true, .error = "no room"});
            if (is_written) {
                EXPECT_THROW(checkpoints.suspend(), Suspended) << ranks.rank;
            } else {
                EXPECT_THROW(checkpoints.suspend(), OutputError) << ranks.rank;
            }
        });
}

TEST(RunCheckpointsTest, AFolderThatIsGoneHasNoName) {
    const test::TemporaryFolder folder;
    const RunResult run;
    OutputFolder output = helping_folder(folder.path / "out");
    const fs::path here = fs::current_path(), gone = folder.path / "gone";
    fs::create_directory(gone);
    fs::current_path(gone);
    fs::remove(gone);
    const RunCheckpoints checkpoints(run, output);
    fs::current_path(here);
    const auto about = nlohmann::json::parse(checkpoints.options().settings);
    EXPECT_EQ(about["folder"], "");
}

TEST(RunCheckpointsTest, TheHistoryGoesOnOnceThereIsRoomAgain) {
    const test::TemporaryFolder folder;
    const RunResult run;
    OutputFolder output = helping_folder(folder.path);
    RunCheckpoints checkpoints(run, output);
    checkpoints.begin({{.number = 0}});
    const fs::path file = output.checkpoints / kHistory;
    rlimit room{}, full{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &room), 0);
    full = room, full.rlim_cur = fs::file_size(file) + 6;  // a part of a row
    std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
    checkpoints.add({.number = 1});
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &room), 0);
    EXPECT_EQ(fs::file_size(file), full.rlim_cur) << "there was room";
    checkpoints.add({.number = 2});
    EXPECT_EQ(read_text(file), history_csv({{.number = 0}, {.number = 2}}));
}

}  // namespace
}  // namespace burnish
