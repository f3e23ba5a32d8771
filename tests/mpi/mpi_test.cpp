// burnish-mpi under mpirun: the bytes of one process, what it says, and what becomes of the others
// when one fails.
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class Mpi : public Program {
  protected:
    Mpi() {
        // What lets OpenMPI start more processes than there are cores, as root in a container, too.
        for (const char* name : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM",
                                 "OMPI_MCA_rmaps_base_oversubscribe", "PRTE_ALLOW_RUN_AS_ROOT",
                                 "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM"})
            setenv(name, "1", 1);
        setenv("ASAN_OPTIONS", "detect_leaks=0", 0);  // MPI keeps what it has until the end
        setenv("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe", 1);
        write_scene();
        write_capture("capture.json", 8, 1);
    }

    /// Views of different cameras, the sixth of them held out. scale: of 20 x 16 pixels.
    void write_capture(const std::string& name, int count, int scale) const {
        nlohmann::json views = nlohmann::json::array();
        for (int i = 0; i < count; ++i) {
            const double x = 0.1 * (i - 4);
            const nlohmann::json pose = {{1, 0, 0, x}, {0, -1, 0, 0}, {0, 0, -1, 3}, {0, 0, 0, 1}};
            views.push_back({{"name", fmt::format("v{}", i)},
                             {"split", i == 5 ? "test" : "train"},
                             {"camera",
                              {{"model", "PINHOLE"},
                               {"width", 20 * scale},
                               {"height", 16 * scale},
                               {"params", {28 * scale, 28 * scale, 10 * scale, 8 * scale}},
                               {"camera_to_world", pose}}}});
        }
        const nlohmann::json capture = {{"version", 1}, {"scene", "scene.xml"}, {"views", views}};
        write_text(folder / name, capture.dump());
    }

    static std::string quick(const std::string& options, int iterations = 6) {
        return fmt::format(
            "optimize capture.json --parameter roughness --parameter base_color --set batch=7 "
            "--spp 2 --target-spp 8 --evaluation-spp 4 --threads 1 --iterations {} {} ",
            iterations, options);
    }
    /// Of one view or two, of many tiles each.
    std::string few_views(int count, const std::string& options, int iterations = 3) const {
        const std::string capture = fmt::format("few{}.json", count);
        write_capture(capture, count, 5);
        return fmt::format(
            "optimize {} --parameter roughness --parameter base_color --set batch={} --spp 2 "
            "--target-spp 8 --evaluation-spp 4 --threads 1 --iterations {} {} ",
            capture, count, iterations, options);
    }
    static std::string mpirun(int count) {
        return fmt::format("'" BURNISH_MPIEXEC "' -n {} '" BURNISH_MPI_BINARY "' ", count);
    }
    Outcome shell(const std::string& line) const {
        const std::string command =
            "cd '" + folder.string() + "' && " + line + " >.out 2>.err </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(folder / ".out"),
                read_text(folder / ".err")};
    }
    Outcome run_on(int count, const std::string& arguments) const {
        return shell(mpirun(count) + arguments);
    }
    /// In the background; standard error goes to `.err`.
    pid_t start_on(int count, const std::string& arguments) const {
        const std::string command = "cd '" + folder.string() + "' && exec " + mpirun(count) +
                                    arguments + " >.out 2>.err </dev/null";
        const pid_t pid = fork();
        if (pid == 0) {
            execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            _exit(127);
        }
        return pid;
    }
    /// All files that depend on no time hold the same bytes.
    void expect_same(const std::string& a, const std::string& b, std::size_t files = 16) const {
        EXPECT_GE(expect_same_files(folder / a, folder / b), files);
        const auto summary = [&](const std::string& out) {
            auto json = nlohmann::json::parse(read_text(folder / out / "summary.json"));
            for (const char* key : {"seconds", "peak_memory_bytes", "processes"}) json.erase(key);
            for (const char* run : {"result", "compared"})
                if (json.contains(run)) json[run].erase("seconds"), json[run].erase("search");
            return json;
        };
        EXPECT_TRUE(summary(a) == summary(b)) << nlohmann::json::diff(summary(a), summary(b));
    }
    static std::size_t count_of(const std::string& part, const std::string& text) {
        std::size_t count = 0;
        for (std::size_t at = text.find(part); at != std::string::npos;
             at = text.find(part, at + 1))
            ++count;
        return count;
    }
    /// The processes of the program, by rank.
    static std::vector<pid_t> processes_of(pid_t launcher, std::size_t count) {
        std::vector<pid_t> found(count);
        for (const auto& entry : fs::directory_iterator("/proc")) {
            const std::string status = read_text(entry.path() / "status");
            if (!contains(status, "PPid:\t" + std::to_string(launcher) + "\n")) continue;
            const std::string environment = read_text(entry.path() / "environ");
            for (std::size_t r = 0; r < count; ++r)
                if (contains(environment, fmt::format("OMPI_COMM_WORLD_RANK={}", r) + '\0'))
                    found[r] = std::stoi(entry.path().filename().string());
        }
        return found;
    }
    bool has_checkpoint(const std::string& out) const {
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(folder / out / "checkpoints", error))
            if (entry.path().extension() == ".burnish") return true;
        return false;
    }
    static bool wait_for(const std::function<bool()>& holds) {
        for (int i = 0; i < 6000 && !holds(); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        return holds();
    }
};

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

TEST_F(Mpi, AnyNumberOfProcessesMakesTheBytesOfTheProgram) {
    ASSERT_EQ(run(quick("-o alone")).code, 0) << read_text(folder / ".err");
    for (const int count : {1, 2, 3, 7}) {
        const std::string out = "ranks" + std::to_string(count);
        const Outcome outcome = run_on(count, quick("-o " + out));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(count_of("the report is", outcome.err), 1u) << outcome.err;
        expect_same("alone", out);
        if (count == 1) continue;
        const auto said =
            nlohmann::json::parse(read_text(folder / out / "summary.json"))["processes"];
        EXPECT_EQ(said["count"], count);
        EXPECT_GT(said["sent_bytes"], 0);
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
    ASSERT_EQ(run(few_views(1, "-o whole", 40)).code, 0) << read_text(folder / ".err");
    const pid_t launcher = start_on(4, few_views(1, "--checkpoint-every 0.001 -o out", 40));
    ASSERT_TRUE(wait_for([&] { return has_checkpoint("out"); })) << read_text(folder / ".err");
    kill(launcher, SIGTERM);
    waitpid(launcher, nullptr, 0);
    const Outcome resumed = run_on(3, "optimize --threads 1 --resume out");
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
                       "least one for each process",
                       few.err),
              1u)
        << few.err;
}

TEST_F(Mpi, AProcessThatFailsAloneEndsTheJobAndIsNamed) {
    std::string other = quick("-o out");
    other.replace(other.find("capture.json"), 12, "missing.json");
    const Outcome outcome = shell(mpirun(1) + quick("-o out") + ": -n 1 '" BURNISH_MPI_BINARY "' " +
                                  other + ": -n 1 '" BURNISH_MPI_BINARY "' " + quick("-o out"));
    EXPECT_NE(outcome.code, 0);
    EXPECT_TRUE(contains(outcome.err, "burnish: process 1 of 3, on ")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "ends the job: missing.json")) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out/summary.json"));
}

TEST_F(Mpi, ADeadProcessEndsTheJobWithinSecondsAndTheRunGoesOn) {
    const std::string checkpoints = "--checkpoint-every 0.001 ";
    ASSERT_EQ(run(quick("-o whole", 500)).code, 0) << read_text(folder / ".err");
    const pid_t launcher = start_on(3, quick(checkpoints + "-o out", 500));
    ASSERT_TRUE(wait_for([&] { return has_checkpoint("out"); })) << read_text(folder / ".err");
    const std::vector<pid_t> processes = processes_of(launcher, 3);
    if (processes[1] == 0) {
        kill(launcher, SIGKILL);
        waitpid(launcher, nullptr, 0);
        GTEST_SKIP() << "the launcher's processes are not its children";
    }
    const auto killed = std::chrono::steady_clock::now();
    kill(processes[1], SIGKILL);
    int status = 0;
    waitpid(launcher, &status, 0);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - killed;
    EXPECT_LT(took.count(), 10);
    EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    const std::string text = read_text(folder / ".err");
    EXPECT_TRUE(contains(text, "rank 1")) << text;
    EXPECT_FALSE(fs::exists(folder / "out/summary.json"));

    // The killed ones may hold the lock for a moment.
    wait_for([&] { return kill(processes[0], 0) != 0 && kill(processes[2], 0) != 0; });
    const Outcome resumed = run_on(2, "optimize --threads 1 --resume out");
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(count_of("going on after", resumed.err), 1u) << resumed.err;
    expect_same("whole", "out");
}

TEST_F(Mpi, ARunOfSeveralGoesOnAloneAndTheOtherWayRound) {
    ASSERT_EQ(run(quick("-o whole", 500)).code, 0) << read_text(folder / ".err");
    const pid_t alone = start(quick("--checkpoint-every 0.001 -o out", 500));
    ASSERT_TRUE(wait_for([&] { return has_checkpoint("out"); }));
    kill(alone, SIGTERM);
    waitpid(alone, nullptr, 0);
    const Outcome resumed = run_on(3, "optimize --threads 1 --resume out");
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
    fs::create_directory(folder / "other");
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().filename() != "other")
            fs::create_symlink(entry.path(), folder / "other" / entry.path().filename());
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

TEST_F(Mpi, TheProgramDoesNotLoadMpi) {
    const auto libraries = [&](const char* program) {
        return shell(std::string("ldd '") + program + "'").out;
    };
    EXPECT_FALSE(contains(libraries(BURNISH_BINARY), "mpi")) << libraries(BURNISH_BINARY);
    EXPECT_TRUE(contains(libraries(BURNISH_MPI_BINARY), "mpi"));
}

}  // namespace
}  // namespace burnish
