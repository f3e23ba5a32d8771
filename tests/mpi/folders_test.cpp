// Processes of burnish-mpi that run in folders of their own, as on machines without a common one.
#include <algorithm>
#include <csignal>

#include "mpi/mpi_program.h"

namespace burnish {
namespace {

using namespace testing;

/// All but the first write into folders of their own.
TEST_F(Mpi, ASignalLeavesNoTemporaryFolder) {
    fs::create_directory(folder / "tmp");
    const auto is_there = [&](const char* name) {
        return std::ranges::any_of(entries_of(folder / "tmp"), [&](const fs::path& entry) {
            return entry.filename().string().starts_with("burnish-") && fs::exists(entry / name);
        });
    };
    const std::string line =
        fmt::format("'" BURNISH_MPIEXEC "' -n 2 env TMPDIR='{}' '" BURNISH_MPI_BINARY
                    "' optimize --target-spp 1048576 --threads 1 -o out",
                    (folder / "tmp").string());
    const pid_t launcher = start_shell(line);
    EXPECT_TRUE(wait_for([&] { return is_there("built-in/LICENSE"); }))  // the last file
        << read_text(folder / ".err");
    // Of the launcher a process would have a second to end, however busy the disk is.
    const pid_t second = processes_of(launcher, 2)[1];
    kill(second > 0 ? second : launcher, SIGTERM);
    waitpid(launcher, nullptr, 0);
    EXPECT_TRUE(wait_for([&] { return !is_there(""); }));
}

/// Only the built-in demo is written there.
TEST_F(Mpi, AMissingTemporaryFolderIsNotNeededForAScene) {
    const std::string start =
        fmt::format("'" BURNISH_MPIEXEC "' -n 2 env TMPDIR='{}' '" BURNISH_MPI_BINARY "' ",
                    (folder / "missing").string());
    const Outcome scene = shell(start + quick("-o out", 1));
    EXPECT_EQ(scene.code, 0) << scene.err;
    const Outcome demo = shell(start + "optimize --target-spp 1 --iterations 1 -o demo");
    EXPECT_NE(demo.code, 0);
    EXPECT_TRUE(contains(demo.err, (folder / "missing/burnish-").string()) &&
                contains(demo.err, "TMPDIR"))
        << demo.err;
}

/// Process 1 runs in a folder of its own, where the newest checkpoint is missing.
TEST_F(Mpi, ProcessesThatReadDifferentCheckpointsAreRefused) {
    const auto checkpoints = [&] { return checkpoints_in(folder / "out/checkpoints"); };
    const pid_t alone = start(quick("--checkpoint-every 0.001 -o out", 100000));
    EXPECT_TRUE(wait_for([&] { return checkpoints().size() > 1; })) << read_text(folder / ".err");
    kill(alone, SIGTERM);
    waitpid(alone, nullptr, 0);
    ASSERT_GT(checkpoints().size(), 1u) << read_text(folder / ".err");
    link_into_other({"out"});
    fs::copy(folder / "out", folder / "other/out", fs::copy_options::recursive);
    fs::remove(folder / "other/out/checkpoints" / checkpoints().back().filename());
    const std::string resume = "optimize --threads 1 --iterations 1 --resume out ";
    const Outcome outcome =
        shell(mpirun(1) + resume + ": -n 1 -wdir other '" BURNISH_MPI_BINARY "' " + resume);
    EXPECT_NE(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "expected the same: the state after ")) << outcome.err;
    const Outcome longer =
        shell(mpirun(1) + resume +
              ": -n 1 '" BURNISH_MPI_BINARY "' optimize --threads 1 --iterations 2 --resume out");
    EXPECT_EQ(longer.code, 65) << longer.err;
    EXPECT_TRUE(contains(longer.err, "expected the same: stop.iterations: 2, on process 0 1"))
        << longer.err;
    EXPECT_FALSE(fs::exists(folder / "out/summary.json"));
}

/// Process 1 runs in a folder of its own, where the file of the options is another.
TEST_F(Mpi, ProcessesThatReadDifferentSettingsAreRefused) {
    const std::string shared = R"({"stop.iterations": 2)";
    write_text(folder / "options.json", shared + "}");
    link_into_other({"options.json"});
    const std::string line = quick("--options options.json -o out", 2),
                      together =
                          mpirun(1) + line + ": -n 1 -wdir other '" BURNISH_MPI_BINARY "' " + line;
    for (const auto& [own, said] :
         {std::pair(R"("run.compare": "mc")", "run.compare: mc, on process 0 none"),
          std::pair(R"("run.max_memory": 4)", "run.max_memory: 4, on process 0 auto"),
          std::pair(R"("seed": 3)", "seed: 3, on process 0 0")}) {
        write_text(folder / "other/options.json", shared + ", " + own + "}");
        const Outcome outcome = shell(together);
        EXPECT_EQ(outcome.code, 65) << outcome.err;
        EXPECT_TRUE(contains(
            outcome.err,
            std::string("process 1 has other settings than process 0, expected the same: ") + said))
            << outcome.err;
        EXPECT_FALSE(fs::exists(folder / "out"));
    }
    write_text(folder / "other/options.json", shared + R"(, "run.checkpoint_seconds": 5})");
    EXPECT_EQ(shell(together).code, 0) << read_text(folder / ".err");
}

/// Process 1 runs in a folder of its own, where the list is another.
TEST_F(Mpi, ProcessesThatReadDifferentJobsAreRefused) {
    const auto list = [](const std::string& jobs) {
        return R"({"options": {"problem.parameters": ["roughness"], "batch": 2,
            "stop.iterations": 1}, "jobs": [)" +
               jobs + "]}";
    };
    const auto job = [](const char* output, int seed) {
        return fmt::format(
            R"({{"output": "{}", "options": {{"scene.file": "capture.json", "seed": {}}}}})",
            output, seed);
    };
    write_text(folder / "jobs.json", list(job("a", 1) + "," + job("b", 1)));
    link_into_other({"jobs.json"});
    for (const auto& [own, said] :
         {std::pair(job("a", 1), "the number of jobs: 1, on process 0 2"),
          std::pair(job("a", 1) + "," + job("b", 2), "jobs[1]: seed: 2, on process 0 1"),
          std::pair(job("a", 1) + "," + job("c", 1), "jobs[1].output: c, on process 0 b")}) {
        write_text(folder / "other/jobs.json", list(own));
        const Outcome outcome = shell(mpirun(1) + "batch jobs.json : -n 1 -wdir other '" +
                                      BURNISH_MPI_BINARY + "' batch jobs.json");
        EXPECT_EQ(outcome.code, 65) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, said)) << outcome.err;
        EXPECT_FALSE(fs::exists(folder / "a"));
    }
}

/// Process 1 runs in a folder of its own, which lacks a file.
TEST_F(Mpi, AJobOfABatchThatOneProcessFailsAtDoesNotDisturbTheNext) {
    const auto job = [](const char* output, const char* capture) {
        return fmt::format(R"({{"output": "{}", "arguments": ["{}", "--parameter", "roughness",
            "--set", "batch=2", "--iterations", "3", "--target-spp", "4",
            "--evaluation-spp", "4"]}})",
                           output, capture);
    };
    write_text(folder / "jobs.json",
               fmt::format(R"({{"jobs": [{}, {}, {}]}})", job("a", "capture.json"),
                           job("b", "own.json"), job("c", "capture.json")));
    link_into_other({});
    fs::copy_file(folder / "capture.json", folder / "own.json");
    const Outcome outcome = shell(mpirun(1) + "batch jobs.json : -n 1 -wdir other '" +
                                  BURNISH_MPI_BINARY + "' batch jobs.json");
    EXPECT_EQ(outcome.code, 65) << outcome.err;
    for (const char* line : {"job 1 of 3: a: done in", "job 2 of 3: b: failed with status 65",
                             "job 3 of 3: c: done in"})
        EXPECT_EQ(count_of(line, outcome.out), 1u) << outcome.out << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "own.json") && contains(outcome.out, "(process 1)"))
        << outcome.out;
}

}  // namespace
}  // namespace burnish
