// Lists of optimisations: what runs, what is skipped, what goes on, and what the list may say.
#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class Batch : public Program {
  protected:
    Batch() { write_scene(); }

    static constexpr const char* kShared =
        R"("options": {"scene.file": "scene.xml", "problem.parameters": ["base_color"],
             "path_cache.samples": 1, "problem.target_samples": 4, "evaluation_samples": 4,
             "problem.initial_values": ["0.5"]})";

    void write_jobs(const std::string& jobs) const {
        write_text(folder / "jobs.json",
                   std::string("{") + kShared + ", \"jobs\": [" + jobs + "]}");
    }
    /// Three jobs of few iterations; the second has another estimator.
    void write_three_jobs() const {
        write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 3}},
                      {"output": "out/b", "arguments": ["--estimator", "mc", "--iterations", "2"]},
                      {"output": "out/c", "options": {"stop": {"iterations": 4}, "seed": 7}})");
    }
    std::string error_of(const std::string& document) const {
        write_text(folder / "bad.json", document);
        const Outcome outcome = run("batch bad.json");
        EXPECT_EQ(outcome.code, 65) << document << outcome.err;
        EXPECT_FALSE(fs::exists(folder / "out")) << "no job runs";
        return outcome.err;
    }
    /// Of the job out/stopped, by name.
    std::vector<fs::path> checkpoints() const {
        return checkpoints_in(folder / "out/stopped/checkpoints");
    }
    /// Runs the jobs until that one has written a checkpoint.
    void stop_at_a_checkpoint() const;
    /// Ends a batch by a signal; what it says.
    std::string stop(pid_t batch) const;
};

std::string Batch::stop(pid_t batch) const {
    kill(batch, SIGTERM);
    const int status = end_of(batch);
    const std::string error = read_text(folder / ".err");
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status << error;
    EXPECT_TRUE(contains(error, "the batch was stopped: the same command goes on with it"))
        << error;
    return error;
}

void Batch::stop_at_a_checkpoint() const {
    const std::vector<fs::path> before = checkpoints();
    const auto has_new = [&] { return !std::ranges::includes(before, checkpoints()); };
    const int status = stop_once(has_new, "batch jobs.json", "out/stopped", SIGTERM);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << read_text(folder / ".err");
}

TEST_F(Batch, RunsEachJobAndSkipsWhatIsDone) {
    write_three_jobs();
    const Outcome first = run("batch jobs.json");
    ASSERT_EQ(first.code, 0) << first.err;
    for (const char* line : {"job 1 of 3: out/a: done in ", "job 2 of 3: out/b: done in ",
                             "job 3 of 3: out/c: done in "})
        EXPECT_TRUE(contains(first.out, line)) << first.out;
    EXPECT_EQ(summary_of("out/a")["result"]["iterations"], 3);
    EXPECT_EQ(summary_of("out/b")["result"]["estimator"], "mc");
    EXPECT_EQ(summary_of("out/c")["settings"]["seed"], 7);

    const auto written = fs::last_write_time(folder / "out/a/summary.json");
    const Outcome again = run("batch jobs.json");
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_TRUE(contains(again.out, "job 3 of 3: out/c: was done before, loss ")) << again.out;
    EXPECT_EQ(fs::last_write_time(folder / "out/a/summary.json"), written);
}

TEST_F(Batch, MakesTheBytesOfOptimize) {
    write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 3}})");
    ASSERT_EQ(run("batch jobs.json").code, 0) << read_text(folder / ".err");
    ASSERT_EQ(run("optimize scene.xml --parameter base_color --spp 1 --target-spp 4 --init 0.5 "
                  "--evaluation-spp 4 --iterations 3 -o alone")
                  .code,
              0);
    for (const char* file : {"textures/mat-panel.brdf_0.base_color.data.exr", "render.exr"}) {
        const std::string expected = read_text(folder / "alone" / file);
        EXPECT_FALSE(expected.empty()) << file;
        EXPECT_TRUE(read_text(folder / "out/a" / file) == expected) << file;
    }
    EXPECT_EQ(summary_of("out/a")["asked"], summary_of("alone")["asked"]);
}

TEST_F(Batch, AJobOfOtherSettingsIsMadeAnew) {
    write_three_jobs();
    ASSERT_EQ(run("batch jobs.json").code, 0);
    std::string jobs = read_text(folder / "jobs.json");
    jobs.replace(jobs.find("\"stop.iterations\": 3"), 20, "\"stop.iterations\": 5");
    write_text(folder / "jobs.json", jobs);
    const Outcome again = run("batch jobs.json");
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_TRUE(contains(again.out, "out/a: done in")) << again.out;
    EXPECT_TRUE(contains(again.out, "out/b: was done before")) << again.out;
    EXPECT_TRUE(contains(again.err,
                         "out/a holds the results of other settings (stop.iterations: 3, now 5): "
                         "the job is made anew"))
        << again.err;
    EXPECT_EQ(summary_of("out/a")["result"]["iterations"], 5);
}

/// The limit of the memory may change, and a later version has more options.
TEST_F(Batch, ADoneJobStaysDoneUnderAnotherLimitOfMemoryAndWithNewOptions) {
    write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 1}})");
    ASSERT_EQ(run("batch jobs.json").code, 0) << read_text(folder / ".err");
    write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 1, "run.max_memory": 8}})");
    const auto said = [&] { return run("batch jobs.json").out; };
    const std::string done = said();
    EXPECT_TRUE(contains(done, "out/a: was done before") && contains(done, ", 1 iteration\n"))
        << done;
    nlohmann::json summary = summary_of("out/a");
    ASSERT_EQ(summary["asked"].erase("seed"), 1u);
    write_text(folder / "out/a/summary.json", summary.dump());
    EXPECT_TRUE(contains(said(), "out/a: was done before"));
    summary["asked"]["sede"] = 1;
    write_text(folder / "out/a/summary.json", summary.dump());
    EXPECT_TRUE(contains(said(), "out/a: done in"));
    EXPECT_TRUE(contains(read_text(folder / ".err"), "its record: there is no option 'sede'"))
        << read_text(folder / ".err");
}

TEST_F(Batch, WhatIsSaidOfAJobFollowsItsName) {
    write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 1}},
                  {"output": "out/b", "arguments": ["--iterations", "1", "--loss", "l1"]},
                  {"output": "out/c", "arguments": ["--iterations", "1", "--loss", "l1"]})");
    const std::string warning = "the derivative of the loss l1 is not affine";
    const std::string first = run("batch jobs.json --slice 0/3").err;
    EXPECT_TRUE(contains(first, "job 1 of 3: out/a\n")) << first;
    EXPECT_FALSE(contains(first, warning)) << first;
    const std::string all = run("batch jobs.json").err;
    EXPECT_FALSE(contains(all, "job 1 of 3")) << "it was done before: " << all;
    const std::size_t b = all.find("job 2 of 3: out/b\n"), c = all.find("job 3 of 3: out/c\n");
    ASSERT_TRUE(b < c && c != std::string::npos) << all;
    for (const auto& [from, to] : {std::pair(b, c), std::pair(c, all.size())})
        EXPECT_TRUE(contains(all.substr(from, to - from), warning)) << all;
    EXPECT_FALSE(contains(all.substr(0, b), warning)) << all;
}

TEST_F(Batch, ADeeplyNestedSummaryFailsItsJobAlone) {
    write_jobs(R"({"output": "out/a"}, {"output": "out/b", "options": {"stop.iterations": 1}})");
    fs::create_directories(folder / "out/a");
    write_text(folder / "out/a/summary.json",
               R"({"burnish": "x", "files": [], "result": {"ended_by": "iterations"}, "asked": )" +
                   std::string(400'000, '[') + std::string(400'000, ']') + "}");
    const Outcome outcome = run("batch jobs.json");
    EXPECT_EQ(outcome.code, 73) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "out/a: failed with status 73")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "out/b: done in")) << outcome.out;
}

TEST_F(Batch, SlicesShareOutTheJobs) {
    write_three_jobs();
    ASSERT_EQ(run("batch jobs.json --slice 0/2").code, 0) << read_text(folder / ".err");
    EXPECT_TRUE(fs::exists(folder / "out/a/summary.json"));
    EXPECT_FALSE(fs::exists(folder / "out/b"));
    EXPECT_TRUE(fs::exists(folder / "out/c/summary.json"));
    const Outcome second = run("batch jobs.json --slice 1/2");
    EXPECT_EQ(second.code, 0);
    EXPECT_TRUE(contains(second.out, "job 2 of 3: out/b: done in")) << second.out;
    EXPECT_FALSE(contains(second.out, "out/a")) << second.out;
    const Outcome none = run("batch jobs.json --slice 7/9");
    EXPECT_EQ(none.code, 0) << "a part without jobs is done";
    EXPECT_TRUE(contains(none.err, "3 jobs, none in the part 7/9\n")) << none.err;
    for (const char* bad : {"2/2", "1", "/2", "1/", "-1/2", "1/2x", "0/0"})
        expect_refused(std::string("batch jobs.json --slice=") + bad, 2,
                       "expected I/N with I from 0 to N - 1");
}

TEST_F(Batch, AFailedJobDoesNotEndTheOthersButTheStatusSaysSo) {
    write_jobs(R"({"output": "out/a", "options": {"scene.file": "missing.xml"}},
                  {"output": "out/b", "options": {"problem.parameters": ["no_such"]}},
                  {"output": "out/c", "options": {"stop.iterations": 2}})");
    const Outcome outcome = run("batch jobs.json");
    EXPECT_EQ(outcome.code, 65);
    EXPECT_TRUE(contains(outcome.out, "job 1 of 3: out/a: failed with status 65: missing.xml"))
        << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "job 2 of 3: out/b: failed")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "job 3 of 3: out/c: done in")) << outcome.out;
    EXPECT_TRUE(contains(outcome.err, "2 of 3 jobs failed")) << outcome.err;
    const Outcome part = run("batch jobs.json --slice 1/2");
    EXPECT_TRUE(contains(part.err, "1 of 1 job failed")) << part.err;
}

TEST_F(Batch, GoesOnWithWhatWasStoppedToTheSameBytes) {
    const std::string job =
        R"("options": {"stop.iterations": 600, "path_cache.samples": 2,
                       "run.checkpoint_seconds": 0.001}})";
    write_jobs(R"({"output": "out/whole", )" + job);
    ASSERT_EQ(run("batch jobs.json").code, 0) << read_text(folder / ".err");
    write_jobs(R"({"output": "out/stopped", )" + job + R"(, {"output": "out/next", )" + job);
    stop_at_a_checkpoint();
    EXPECT_FALSE(fs::exists(folder / "out/stopped/summary.json"));
    EXPECT_FALSE(fs::exists(folder / "out/next")) << "the signal ends the batch";

    // Other settings would make other bytes of the same name.
    const std::string jobs = read_text(folder / "jobs.json");
    write_jobs(R"({"output": "out/stopped", "options": {"stop.iterations": 600, "seed": 3}})");
    const Outcome other = run("batch jobs.json");
    EXPECT_EQ(other.code, 65);
    EXPECT_TRUE(contains(other.out,
                         "out/stopped: holds a run of other settings (path_cache.samples: 2, now "
                         "1) that was stopped"))
        << other.out;
    write_text(folder / "jobs.json", jobs);

    // The job's seconds between checkpoints hold for what is left, too.
    stop_at_a_checkpoint();

    // So does its limit of the memory, which may be another one.
    std::string roomy = jobs;
    const std::string window = "\"run.checkpoint_seconds\": 0.001";
    roomy.replace(roomy.find(window), window.size(), window + ", \"run.max_memory\": 8");
    write_text(folder / "jobs.json", roomy);

    const Outcome resumed = run("batch jobs.json");
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(summary_of("out/stopped")["asked"]["run"]["max_memory"], 8);
    EXPECT_TRUE(contains(resumed.out, "out/stopped: went on and is done in")) << resumed.out;
    EXPECT_TRUE(contains(resumed.err, "going on after")) << resumed.err;
    const char* texture = "textures/mat-panel.brdf_0.base_color.data.exr";
    const std::string expected = read_text(folder / "out/whole" / texture);
    ASSERT_FALSE(expected.empty());
    EXPECT_TRUE(read_text(folder / "out/stopped" / texture) == expected);
    EXPECT_TRUE(read_text(folder / "out/next" / texture) == expected);
    EXPECT_TRUE(contains(run("batch jobs.json").out, "out/stopped: was done before"));
}

TEST_F(Batch, ASignalBeforeAJobsIterationsEndsTheBatchAsOthersDo) {
    write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 1}},
                  {"output": "out/b", "options": {"problem.target_samples": 1048576}})");
    const pid_t pid = start("batch jobs.json");
    EXPECT_TRUE(wait_for([&] { return fs::exists(lock_of("out/b")); }));
    stop(pid);
    EXPECT_TRUE(fs::exists(folder / "out/a/summary.json"));
    EXPECT_FALSE(fs::exists(folder / "out/b"));
}

/// It waits where it says that the first job is done: the pipe is full.
TEST_F(Batch, ASignalBetweenTwoJobsEndsTheBatchBeforeTheNext) {
    write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 1}},
                  {"output": "out/b", "options": {"stop.iterations": 1}})");
    const FullPipe pipe(folder / "pipe");
    const pid_t pid = start_shell("sh -c \"exec '" BURNISH_BINARY "' batch jobs.json >pipe\"");
    EXPECT_TRUE(wait_for([&] {
        return fs::exists(folder / "out/a/summary.json") &&
               !fs::exists(lock_of("out/a").parent_path());
    }));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    kill(pid, SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const int status = pipe.drain_until_end_of(pid);
    const std::string error = read_text(folder / ".err");
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status << error;
    EXPECT_TRUE(contains(error, "the batch was stopped: the same command goes on with it"))
        << error;
    EXPECT_FALSE(contains(error, "job 2 of 2")) << error;
    EXPECT_FALSE(fs::exists(folder / "out/b"));
}

/// Its target renders for a while, its evaluation for longer than the test.
TEST_F(Batch, ASignalBeforeTheIterationsOfAJobThatGoesOnEndsTheBatchAsOthersDo) {
    write_jobs(R"({"output": "out/stopped", "options": {"stop.iterations": 1,
                   "problem.target_samples": 16384, "evaluation_samples": 1048576}})");
    stop_at_a_checkpoint();
    const pid_t pid = start("batch jobs.json");
    EXPECT_TRUE(wait_for_error_text("going on after"));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::string error = stop(pid);
    EXPECT_FALSE(contains(error, "--resume")) << error;
}

/// A file takes the place of the folder that the checkpoint goes to, and a folder that of a result.
TEST_F(Batch, ASignalEndsTheBatchWhereTheJobFails) {
    const std::string job =
        R"("options": {"stop.iterations": 1000000, "run.checkpoint_seconds": 100000}})";
    write_jobs(R"({"output": "out/a", )" + job + R"(, {"output": "out/b", )" + job);
    const pid_t pid = start("batch jobs.json");
    EXPECT_TRUE(wait_for([&] { return iterations_told("out/a") > 1; }));
    const fs::path of_job = folder / "out/a/checkpoints";
    fs::remove_all(of_job);
    write_text(of_job, "");
    fs::create_directory(folder / "out/a/report.html");
    kill(pid, SIGTERM);
    const int status = end_of(pid);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
    const std::string said = read_text(folder / ".out");
    EXPECT_TRUE(contains(said, "job 1 of 2: out/a: failed with status 73")) << said;
    EXPECT_FALSE(contains(said, "job 2 of 2")) << said;
    EXPECT_FALSE(fs::exists(folder / "out/b"));
}

/// Behind a link lies the folder of another job.
TEST_F(Batch, AFolderBehindALinkIsOneJobsAlone) {
    fs::create_directory(folder / "real");
    fs::create_directory_symlink("real", folder / "link");
    const std::string shared(kShared);
    for (const auto& [first, second] :
         {std::pair("real/x", "link/x"), std::pair("link/", "real")}) {
        const std::string error = error_of("{" + shared + R"(, "jobs": [{"output": ")" + first +
                                           R"("}, {"output": ")" + second + "\"}]}");
        EXPECT_TRUE(contains(error, std::string("bad.json: jobs[1].output: found ") + second +
                                        ", the folder of jobs[0], expected one of its own"))
            << error;
    }
    EXPECT_TRUE(fs::is_empty(folder / "real"));
}

/// One run would write among the results of the other, whichever comes first.
TEST_F(Batch, AFolderWithinThatOfAnotherJobIsRefused) {
    const auto error = [&](const char* first, const char* second) {
        return error_of(std::string("{") + kShared + R"(, "jobs": [{"output": ")" + first +
                        R"("}, {"output": ")" + second + "\"}]}");
    };
    fs::create_directory(folder / "real");
    fs::create_directory_symlink("real", folder / "link");
    for (const auto& [outer, inner] :
         {std::pair("out", "out/textures"), std::pair("out/a", "./out/a/b/c"),
          std::pair("real", "link/x"), std::pair(".", "out")}) {
        const std::string found = std::string("found ") + inner + ", within the folder of jobs[";
        EXPECT_TRUE(contains(error(outer, inner), "jobs[1].output: " + found + "0]")) << inner;
        EXPECT_TRUE(contains(error(inner, outer), "jobs[0].output: " + found + "1]")) << inner;
    }
}

/// Its second reading finds nothing.
TEST_F(Batch, AnOptionsFileMayBeReadOnce) {
    write_text(folder / "o.json", R"({"stop": {"iterations": 2}})");
    write_jobs(R"({"output": "out/a", "options": {"stop.iterations": 3, "seed": 4},
                   "arguments": ["--options", "/dev/stdin", "--set", "seed=5"]})");
    const Outcome outcome = shell("(cat o.json | '" BURNISH_BINARY "' batch jobs.json)");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(summary_of("out/a")["result"]["iterations"], 2);
    EXPECT_EQ(summary_of("out/a")["settings"]["seed"], 5);
}

TEST_F(Batch, BadListsAreNamedBeforeAnythingRuns) {
    const std::string good = R"({"output": "out/a", "arguments": ["scene.xml",
        "--parameter", "base_color", "--iterations", "1"]})";
    const auto jobs = [&](const std::string& second) {
        return "{\"jobs\": [" + good + ", " + second + "]}";
    };
    write_text(folder / "o.json", R"({"run": {"output": "out/c"}})");
    const std::pair<std::string, const char*> cases[] = {
        {"[1", "bad.json, byte 3: found no JSON, expected a list of jobs"},
        {"[]", "bad.json: found [], expected an object with the key \"jobs\""},
        {"{}", "bad.json: expected the key \"jobs\""},
        {R"({"jobs": []})", "bad.json: jobs: found [], expected an array of at least one job"},
        {R"({"jobs": [], "slices": 2})", "bad.json: slices: unknown key, expected one of"},
        {R"({"jobs": [{}], "options": 3})", "bad.json: options: found 3, expected an object"},
        {jobs("7"), "bad.json: jobs[1]: found 7, expected an object"},
        {jobs("{}"), "bad.json: jobs[1]: expected the key \"output\""},
        {jobs(R"({"output": 3})"), "bad.json: jobs[1].output: found 3, expected a text"},
        {jobs(R"({"output": "out/b", "folder": 1})"), "bad.json: jobs[1].folder: unknown key"},
        {jobs(R"({"output": "./out/a/", "options": {"scene.file": "scene.xml",
                  "problem.parameters": ["base_color"]}})"),
         "bad.json: jobs[1].output: found ./out/a/, the folder of jobs[0], expected one of its "
         "own"},
        {jobs(R"({"output": "out/b", "options": {"sede": 1}})"),
         "bad.json: jobs[1].options: there is no option 'sede', did you mean seed?"},
        {jobs(R"({"output": "out/b", "options": {"seed": "x"}})"),
         "bad.json: jobs[1].options: seed: expected"},
        {jobs(R"({"output": "out/b", "options": {"run": {"output": "out/c"}}})"),
         "bad.json: jobs[1].options: found run.output, expected the folder as the key \"output\""},
        {R"({"options": {"run.output": "out/c"}, "jobs": [)" + good + "]}",
         "bad.json: options: found run.output, expected the folder as the key \"output\""},
        {R"({"jobs": [], "jobs": [)" + good + "]}",
         "bad.json: the key \"jobs\" stands twice in one object, expected it once"},
        {jobs(R"({"output": "out/b", "arguments": "scene.xml"})"),
         "bad.json: jobs[1].arguments: found \"scene.xml\", expected an array of texts"},
        {jobs(R"({"output": "out/b", "arguments": ["scene.xml", "--sede", "1"]})"),
         "bad.json: jobs[1].arguments: '--sede' is no option of burnish optimize: did you mean "
         "--seed?"},
        {jobs(R"({"output": "out/b", "arguments": ["--seed", "1", "--seed", "2"]})"),
         "bad.json: jobs[1].arguments: --seed: found 2 values, expected 1, N"},
        {jobs(R"({"output": "out/b", "arguments": ["--help-all"]})"),
         "bad.json: jobs[1].arguments: found [\"--help-all\"], expected arguments of a run"},
        {jobs(R"({"output": "out/b", "arguments": ["scene.xml", "--seed", "x"]})"),
         "bad.json: jobs[1].arguments: --seed: expected"},
        {jobs(R"({"output": "out/b", "arguments": ["--resume", "out/b"]})"),
         "expected no --resume"},
        {jobs(R"({"output": "out/b", "arguments": ["scene.xml", "-o", "out/c"]})"),
         "expected no -o: the key \"output\" names the folder"},
        {jobs(R"({"output": "out/b", "arguments": ["scene.xml", "--set", "run.output=out/a"]})"),
         "expected no --set run.output: the key \"output\" names the folder"},
        {jobs(R"({"output": "out/b", "arguments": ["scene.xml", "--options", "o.json"]})"),
         "expected o.json without run.output: the key \"output\" names the folder"},
        {jobs(R"({"output": "out/b", "arguments": ["scene.xml"]})"),
         "bad.json: jobs[1]: --parameter: expected the name of a texture"},
        {jobs(R"({"output": "out/b"})"), "bad.json: jobs[1]: found no scene"},
        {R"({"options": {"path_cache.window": 8}, "jobs": [)" + good +
             R"(, {"output": "out/b", "options": {"scene.file": "scene.xml", "estimator": "mc",
                   "problem.parameters": ["base_color"]}}]})",
         "bad.json: jobs[1]: bad.json: options: path_cache.window has no effect"},
        {jobs(R"({"output": "out/b", "options": {"scene.file": "scene.xml", "estimator": "mc",
                  "problem.parameters": ["base_color"], "path_cache.window": 8}})"),
         "burnish: bad.json: jobs[1].options: path_cache.window has no effect"},
    };
    for (const auto& [document, expected] : cases) {
        const std::string error = error_of(document);
        EXPECT_TRUE(contains(error, expected)) << document << "\n" << error;
    }
    EXPECT_EQ(run("batch missing.json").code, 65);
    EXPECT_EQ(run("batch").code, 2);
}

}  // namespace
}  // namespace burnish
