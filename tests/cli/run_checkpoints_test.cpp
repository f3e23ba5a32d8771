// What a run keeps on the disk while it goes, where writing fails.
#include "cli/run_checkpoints.h"

#include "burnish/error.h"
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

}  // namespace
}  // namespace burnish
