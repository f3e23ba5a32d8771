// burnish-mpi under mpirun: the bytes of one process, what it says, and what becomes of the others
// when one fails.
#include <fmt/format.h>

#include <chrono>
#include <csignal>

#include "mpi/mpi_program.h"

namespace burnish {
namespace {

using namespace testing;

TEST_F(Mpi, CoresThatTheLauncherLeavesIdleAreSaid) {
    const std::string bind = "'" BURNISH_MPIEXEC "' --bind-to core -n 1 ",
                      rest = "'" BURNISH_MPI_BINARY "' info scene.xml";
    if (shell(bind + "nproc").out == shell("nproc").out) GTEST_SKIP() << "needs two cores";
    const Outcome bound = shell(bind + rest);
    ASSERT_EQ(bound.code, 0) << bound.err;
    EXPECT_EQ(count_of("each process is bound to ", bound.err), 1u) << bound.err;
    EXPECT_EQ(count_of("`mpirun --bind-to none`", bound.err), 1u) << bound.err;
    const Outcome unbound = shell("'" BURNISH_MPIEXEC "' --bind-to none -n 1 " + rest);
    ASSERT_EQ(unbound.code, 0) << unbound.err;
    EXPECT_FALSE(contains(unbound.err, "is bound to")) << unbound.err;
}

TEST_F(Mpi, ProcessesThatDoNotKnowOfEachOtherAreSaid) {
    const std::string version = " '" BURNISH_MPI_BINARY "' --version",
                      warning = "2 processes (PMI_SIZE) that do not know of each other";
    const Outcome strange = shell("env PMI_SIZE=2" + version);
    EXPECT_EQ(strange.code, 0) << strange.err;
    EXPECT_EQ(count_of(warning, strange.err), 1u) << strange.err;
    EXPECT_EQ(shell("env PMI_SIZE=2 PMI_RANK=1" + version).err, "") << "process 0 says it";
    EXPECT_EQ(shell("env PMI_SIZE=1" + version).err, "");
    for (const int count : {1, 2}) {  // of OpenMPI's own launcher, which another one has started
        const Outcome known =
            shell(fmt::format("'" BURNISH_MPIEXEC "' -n {} env PMI_SIZE=2", count) + version);
        EXPECT_EQ(known.code, 0) << known.err;
        EXPECT_FALSE(contains(known.err, "know of each other")) << known.err;
    }
}

TEST_F(Mpi, HelpIsPrintedOnce) {
    for (const std::string command : {"optimize", "batch"}) {
        const Outcome outcome = run_on(2, command + " --help");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(count_of("Usage: burnish " + command, outcome.out), 1u) << outcome.out;
    }
}

TEST_F(Mpi, AnyNumberOfProcessesMakesTheBytesOfTheProgram) {
    ASSERT_EQ(run(quick("-o alone")).code, 0) << read_text(folder / ".err");
    for (const int count : {1, 2, 3, 7}) {
        const std::string out = "ranks" + std::to_string(count);
        const Outcome outcome = run_on(count, quick("-o " + out));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(count_of("the report is", outcome.err), 1u) << outcome.err;
        expect_same("alone", out);
        if (count == 1) continue;
        const auto said = summary_of(out)["processes"];
        EXPECT_EQ(said["count"], count);
        EXPECT_GT(said["sent_bytes"], 0);
        EXPECT_GT(said["exchange_seconds"], 0.0);
    }
}

TEST_F(Mpi, FewerViewsThanProcessesAreSharedOutInBands) {
    for (const int views : {1, 2}) {
        const std::string alone = fmt::format("alone{}", views);
        ASSERT_EQ(run(few_views(views, "-o " + alone)).code, 0) << read_text(folder / ".err");
        for (const int count : {2, 3, 4, 7}) {
            const std::string out = fmt::format("views{}ranks{}", views, count);
            const Outcome outcome = run_on(count, few_views(views, "-o " + out));
            ASSERT_EQ(outcome.code, 0) << outcome.err;
            expect_same(alone, out, 12);
        }
    }
}

TEST_F(Mpi, ASharedViewGoesOnOnAnotherNumber) {
    const pid_t launcher = start_on(4, few_views(1, "--checkpoint-every 0.001 -o out", kEndless));
    EXPECT_TRUE(wait_for([&] { return has_checkpoint("out"); })) << read_text(folder / ".err");
    const std::vector<pid_t> processes = processes_of(launcher, 4);
    kill(launcher, SIGTERM);
    waitpid(launcher, nullptr, 0);
    wait_for_end(processes);
    const int iterations = iterations_beyond("out");
    ASSERT_EQ(run(few_views(1, "-o whole", iterations)).code, 0) << read_text(folder / ".err");
    const Outcome resumed =
        run_on(3, fmt::format("optimize --threads 1 --resume out --iterations {}", iterations));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(count_of("going on after", resumed.err), 1u) << resumed.err;
    expect_same("whole", "out", 12);
}

TEST_F(Mpi, AnEstimatorThatSharesOutViewsAloneSaysSo) {
    ASSERT_EQ(run(few_views(1, "--estimator mc -o alone")).code, 0) << read_text(folder / ".err");
    const Outcome outcome = run_on(3, few_views(1, "--estimator mc -o ranks"));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(count_of("mc shares out whole views: 2 of 3 processes have none", outcome.err), 1u)
        << outcome.err;
    expect_same("alone", "ranks", 12);
    EXPECT_EQ(count_of("shares out whole views", run_on(3, few_views(1, "-o cache")).err), 0u);
}

TEST_F(Mpi, OtherEstimatorsAndASecondRunMakeTheSameBytes) {
    const std::string plain = "--estimator pgris --compare mc --set batch=3 ";
    ASSERT_EQ(run(quick(plain + "-o alone", 4)).code, 0) << read_text(folder / ".err");
    const Outcome outcome = run_on(3, quick(plain + "-o ranks", 4));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    expect_same("alone", "ranks");
}

TEST_F(Mpi, OneProcessSpeaksAndDoesWhatIsNotSharedOut) {
    EXPECT_EQ(count_of("burnish ", run_on(3, "--version").out), 1u);
    ASSERT_EQ(run_on(3, "render scene.xml -o a.exr").code, 0) << read_text(folder / ".err");
    ASSERT_EQ(run("render scene.xml -o b.exr").code, 0);
    EXPECT_TRUE(read_text(folder / "a.exr") == read_text(folder / "b.exr"));
    const Outcome missing = run_on(3, "optimize missing.xml --parameter roughness -o out");
    EXPECT_EQ(missing.code, 65) << missing.err;
    EXPECT_EQ(count_of("burnish: missing.xml", missing.err), 1u) << missing.err;
    const Outcome usage = run_on(2, quick("--sede 3 -o out"));
    EXPECT_EQ(usage.code, 2);
    EXPECT_EQ(count_of("did you mean --seed?", usage.err), 1u) << usage.err;
    EXPECT_FALSE(fs::exists(folder / "out/summary.json"));
}

TEST_F(Mpi, MoreProcessesThanViewsAreRefused) {
    const Outcome few = run_on(3, quick("--set batch=2 -o out"));
    EXPECT_EQ(few.code, 65) << few.err;
    EXPECT_EQ(count_of("3 processes share out the views of an iteration: found 2 of 7, expected at "
                       "least one for each process, or at most 2 processes; the option batch",
                       few.err),
              1u)
        << few.err;
}

TEST_F(Mpi, AProcessThatFailsAloneEndsTheJobAndIsNamed) {
    fs::create_directory(folder / "other");  // of process 1: without the capture
    const std::string line = " '" BURNISH_MPI_BINARY "' " + quick("-o out");
    const Outcome outcome =
        shell(mpirun(1) + quick("-o out") + ": -n 1 -wdir other" + line + ": -n 1" + line);
    EXPECT_NE(outcome.code, 0);
    EXPECT_TRUE(contains(outcome.err, "burnish: process 1 of 3, on ")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "ends the job: capture.json")) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out/summary.json"));
}

TEST_F(Mpi, ADeadProcessEndsTheJobWithinSecondsAndTheRunGoesOn) {
    const pid_t launcher = start_on(3, quick("--checkpoint-every 0.001 -o out", kEndless));
    EXPECT_TRUE(wait_for([&] { return has_checkpoint("out"); })) << read_text(folder / ".err");
    const std::vector<pid_t> processes = processes_of(launcher, 3);
    if (processes[1] == 0) {
        kill(launcher, SIGTERM);
        waitpid(launcher, nullptr, 0);
        GTEST_SKIP() << "the launcher's processes are not its children";
    }
    const auto killed = std::chrono::steady_clock::now();
    kill(processes[1], SIGKILL);
    int status = 0;
    bool has_ended = false;
    const auto ends = [&] {
        return has_ended = has_ended || waitpid(launcher, &status, WNOHANG) == launcher;
    };
    EXPECT_TRUE(wait_for(ends));
    if (!has_ended) {
        kill(launcher, SIGTERM);
        status = end_of(launcher);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - killed;
    EXPECT_LT(took.count(), 10);
    EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    const std::string text = read_text(folder / ".err");
    EXPECT_TRUE(contains(text, "rank 1")) << text;
    EXPECT_FALSE(fs::exists(folder / "out/summary.json"));

    wait_for_end(processes);
    const int iterations = iterations_beyond("out");
    ASSERT_EQ(run(quick("-o whole", iterations)).code, 0) << read_text(folder / ".err");
    const Outcome resumed =
        run_on(2, fmt::format("optimize --threads 1 --resume out --iterations {}", iterations));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(count_of("going on after", resumed.err), 1u) << resumed.err;
    expect_same("whole", "out");
}

TEST_F(Mpi, AnInterruptCountsAtTheFirstProcessAlone) {
    const pid_t launcher = start_on(2, few_views(1, "-o out", kEndless));
    const auto tells_more_than = [&](std::ptrdiff_t count) {
        return wait_for([&] { return iterations_told("out") > count; });
    };
    EXPECT_TRUE(tells_more_than(0)) << read_text(folder / ".err");
    const std::vector<pid_t> processes = processes_of(launcher, 2);
    if (processes[1] == 0) {
        kill(launcher, SIGTERM);
        waitpid(launcher, nullptr, 0);
        GTEST_SKIP() << "the launcher's processes are not its children";
    }
    kill(processes[1], SIGINT);
    EXPECT_TRUE(tells_more_than(iterations_told("out") + 1)) << "it goes on";
    kill(processes[1], SIGTERM);  // the first signal that counts
    const int status = end_of(launcher);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75)
        << status << read_text(folder / ".err");
    wait_for_end(processes);
    ASSERT_TRUE(has_checkpoint("out"));
    EXPECT_FALSE(fs::exists(lock_of("out").parent_path()));
    const Outcome resumed = run_on(
        2,
        fmt::format("optimize --threads 1 --resume out --iterations {}", iterations_beyond("out")));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
}

TEST_F(Mpi, ARunOfSeveralGoesOnAloneAndTheOtherWayRound) {
    const pid_t alone = start(quick("--checkpoint-every 0.001 -o out", kEndless));
    EXPECT_TRUE(wait_for([&] { return has_checkpoint("out"); }));
    kill(alone, SIGTERM);
    waitpid(alone, nullptr, 0);
    const int iterations = iterations_beyond("out");
    ASSERT_EQ(run(quick("-o whole", iterations)).code, 0) << read_text(folder / ".err");
    const Outcome resumed =
        run_on(3, fmt::format("optimize --threads 1 --resume out --iterations {}", iterations));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    expect_same("whole", "out");
}

TEST_F(Mpi, ABatchRunsOnSeveral) {
    write_text(folder / "jobs.json", R"({"jobs": [
        {"output": "a", "arguments": ["capture.json", "--parameter", "roughness", "--set",
         "batch=3", "--iterations", "3", "--target-spp", "4", "--evaluation-spp", "4"]},
        {"output": "b", "arguments": ["missing.json", "--parameter", "roughness"]},
        {"output": "c", "arguments": ["capture.json", "--parameter", "base_color", "--set",
         "batch=2", "--iterations", "3", "--target-spp", "4", "--evaluation-spp", "4"]}]})");
    const Outcome first = run_on(2, "batch jobs.json");
    EXPECT_EQ(first.code, 65) << first.err;
    for (const char* line : {"job 1 of 3: a: done in", "job 2 of 3: b: failed with status 65",
                             "job 3 of 3: c: done in"})
        EXPECT_EQ(count_of(line, first.out), 1u) << first.out << first.err;
    EXPECT_EQ(count_of("was done before", run_on(2, "batch jobs.json").out), 2u);
}

TEST_F(Mpi, TheProgramDoesNotLoadMpi) {
    const auto libraries = [&](const char* program) {
        return shell(std::string("ldd '") + program + "'").out;
    };
    EXPECT_FALSE(contains(libraries(BURNISH_BINARY), "mpi")) << libraries(BURNISH_BINARY);
    EXPECT_TRUE(contains(libraries(BURNISH_MPI_BINARY), "mpi"));
}

}  // namespace
}  // namespace burnish
