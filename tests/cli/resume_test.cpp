// Runs that are stopped, by whatever, and go on: to the bytes of a run that was not.
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <random>
#include <sstream>
#include <thread>

#include "burnish/checkpoint.h"
#include "cli/output_folder.h"
#include "cli/program.h"
#include "optimize/same_run.h"
#include "optimize/state_cases.h"

namespace burnish {
namespace {

using namespace testing;

constexpr const char* kLongRun =
    "optimize scene.xml --parameter base_color --parameter roughness --spp 2 --target-spp 16 "
    "--evaluation-spp 8 --iterations 300 --checkpoint-every 0.001 ";

class Resume : public Program {
  protected:
    Resume() { write_scene(); }

    static void sleep(double seconds) {
        std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    }
    /// Of the newest checkpoint; 0: there is none.
    int iterations_of(const std::string& out) const {
        int newest = 0;
        for (const fs::path& file : checkpoints_in(folder / out / "checkpoints"))
            newest = std::max(newest, std::stoi(file.filename().string()));
        return newest;
    }
    /// Ends a run by a signal once it has so many checkpoints: the first comes after an iteration
    /// or two, the next when the disk has rested.
    int stop(const std::string& arguments, const std::string& out, int signal,
             const std::string& checkpoints = "checkpoints", std::size_t count = 1) const {
        return stop_once([&] { return checkpoints_in(folder / out / checkpoints).size() >= count; },
                         arguments, out, signal);
    }
    /// All files that depend on no time hold the same bytes.
    void expect_same(const std::string& a, const std::string& b) const {
        EXPECT_GE(expect_same_files(folder / a, folder / b), 6u);
        EXPECT_EQ(losses_of(a), losses_of(b));
        EXPECT_FALSE(fs::exists(folder / b / "checkpoints"));
        EXPECT_FALSE(fs::exists(folder / b / ".burnish-unfinished"));
    }
    /// The history without its times.
    std::vector<std::string> losses_of(const std::string& out) const {
        std::vector<std::string> losses;
        std::istringstream lines(read_text(folder / out / "history.csv"));
        for (std::string line; std::getline(lines, line);) {
            std::istringstream fields(line);
            std::string field, kept;
            for (int i = 0; std::getline(fields, field, ','); ++i)
                if (i == 0 || i > 4) kept += field + ",";
            losses.push_back(kept);
        }
        return losses;
    }
};

/// BURNISH_KILLS=2000 for as many.
TEST_F(Resume, KilledAtAnyTimeItLosesNoCheckpoint) {
    const char* asked = std::getenv("BURNISH_KILLS");
    const int kills = asked ? std::atoi(asked) : 8;
    ASSERT_EQ(run(std::string(kLongRun) + "-o whole").code, 0) << read_text(folder / ".err");
    std::mt19937 random(7);
    std::uniform_real_distribution<double> moment(0, 1.5);
    int killed = 0, finished = 0;
    while (killed < kills || finished == 0) {
        const int known = iterations_of("out");
        const pid_t pid = start(known > 0 ? "optimize --resume out --checkpoint-every 0.001"
                                          : std::string(kLongRun) + "-o out");
        if (killed < kills) {
            sleep(moment(random));
            kill(pid, SIGKILL);
        }
        const int status = end_of(pid);
        const std::string text = read_text(folder / ".err");
        if (known > 0 && contains(text, "going on")) {
            const char* plural = known == 1 ? "" : "s";
            EXPECT_TRUE(
                contains(text, fmt::format("going on after {} iteration{},", known, plural)))
                << text;
        }
        EXPECT_FALSE(contains(text, "damaged")) << text;
        EXPECT_GE(iterations_of("out") + 1000 * fs::exists(folder / "out/summary.json"), known);
        if (WIFSIGNALED(status)) {
            ++killed;
            continue;
        }
        ASSERT_EQ(WEXITSTATUS(status), 0) << text;
        ++finished;
        expect_same("whole", "out");
        fs::remove_all(folder / "out");
    }
}

TEST_F(Resume, ARunKilledBeforeItsFirstCheckpointBeginsAnew) {
    ASSERT_EQ(run(std::string(kLongRun) + "-o whole").code, 0) << read_text(folder / ".err");
    fs::create_directories(folder / "out/.burnish-unfinished");
    fs::create_directories(folder / "out/checkpoints");
    write_text(folder / "out/.burnish-unfinished/lock", "");
    write_text(folder / "out/checkpoints/history.csv", "iteration,seconds,loss\n1,0.1,0.5\n");
    write_text(folder / "out/checkpoints/.0000000001.burnish.77-0.tmp", "BURNISHC");
    ASSERT_EQ(run(std::string(kLongRun) + "-o out").code, 0) << read_text(folder / ".err");
    expect_same("whole", "out");
    // What is not a run's stays.
    fs::create_directories(folder / "other/checkpoints");
    write_text(folder / "other/checkpoints/epoch.pt", "");
    EXPECT_EQ(run(std::string(kLongRun) + "-o other").code, 73);
    EXPECT_TRUE(fs::exists(folder / "other/checkpoints/epoch.pt"));
    write_text(folder / "epochs.csv", "mine");
    fs::create_symlink("../../epochs.csv", folder / "other/checkpoints/history.csv");
    EXPECT_EQ(run(std::string(kLongRun) + "--force -o other").code, 0);
    EXPECT_EQ(read_text(folder / "epochs.csv"), "mine") << "written through a link";
}

/// The library writes checkpoints with settings of its caller.
TEST_F(Resume, CheckpointsOfOtherProgramsAreRefused) {
    const std::pair<std::string, const char*> cases[] = {
        {"", ", byte 1: found no JSON, expected the settings of a run of `burnish optimize`"},
        {std::string(100000, '['),
         ": found values 65 deep, expected the settings of a run of `burnish optimize`"},
        {"{\"settings\": {}, \"folder\": \"\"}", ": expected the key \"asked\""},
    };
    for (const auto& [settings, message] : cases) {
        Options options;
        options.stop.iterations = 2;
        Checkpoints checkpoints;
        checkpoints.folder = folder / "out/checkpoints", checkpoints.settings = settings;
        solve(test::state_problem(), options, checkpoints, test::stop_after(1));
        expect_refused("optimize --resume out", 65, "0000000001.burnish" + std::string(message));
    }
}

TEST_F(Resume, TheSystemsSignalsEndItWithACheckpoint) {
    ASSERT_EQ(run(std::string(kLongRun) + "-o whole").code, 0);
    for (const int signal : {SIGTERM, SIGHUP}) {
        const std::string out = "out" + std::to_string(signal);
        const int status = stop(std::string(kLongRun) + "-o " + out, out, signal);
        ASSERT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 75) << read_text(folder / ".err");
        EXPECT_TRUE(
            contains(read_text(folder / ".err"), "`burnish optimize --resume " + out + "`"));
        EXPECT_FALSE(fs::exists(folder / out / "summary.json"));
        EXPECT_TRUE(fs::exists(folder / out / "checkpoints/history.csv"));
        // What was stopped is not thrown away.
        expect_refused(std::string(kLongRun) + "-o " + out, 73,
                       "holds a run that was stopped: expected `burnish optimize --resume " + out +
                           "`, which goes on with it");
        // A limit of the memory that leaves all records room decides on nothing.
        const Outcome resumed = run("optimize --threads 1 --max-memory 1 --resume " + out);
        ASSERT_EQ(resumed.code, 0) << resumed.err;
        expect_same("whole", out);
        EXPECT_EQ(summary_of(out)["result"]["ended_by"], "iterations");
        const auto seconds = summary_of(out)["seconds"];
        for (const auto& phase : seconds) EXPECT_GE(phase.get<double>(), 0) << seconds;
    }
}

/// The path cache keeps the bytes of records that the run began with.
TEST_F(Resume, ALimitThatLeavesFewerRecordsIsRefusedAndOneThatIsEnoughNamed) {
    ASSERT_EQ(run(std::string(kLongRun) + "-o whole").code, 0);
    stop(std::string(kLongRun) + "-o out", "out", SIGTERM);
    const auto whole = summary_of("whole");
    const double all = whole["memory_estimate_bytes"]["maximum"],
                 records = whole["settings"]["path_cache"]["max_bytes"];
    const Outcome refused = expect_refused(
        fmt::format("optimize --resume out --max-memory {}", (all - records / 2) / 0x1p30), 77,
        "the run keeps up to ");
    EXPECT_FALSE(contains(refused.err, "recovering")) << "no target is rendered: " << refused.err;
    ASSERT_NE(named_limit(refused.err), "") << refused.err;
    const Outcome resumed = run("optimize --resume out " + named_limit(refused.err));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    expect_same("whole", "out");
}

TEST_F(Resume, CtrlCKeepsResultsAndTheRunGoesOn) {
    ASSERT_EQ(run(std::string(kLongRun) + "-o whole").code, 0);
    const int status = stop(std::string(kLongRun) + "-o out", "out", SIGINT);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << read_text(folder / ".err");
    EXPECT_EQ(summary_of("out")["result"]["ended_by"], "signal");
    ASSERT_GT(iterations_of("out"), 0);
    const auto summary = summary_of("out");
    for (const auto& file : summary["files"])
        EXPECT_TRUE(fs::exists(folder / "out" / file.get<std::string>())) << file;
    ASSERT_EQ(run("optimize --resume out").code, 0) << read_text(folder / ".err");
    expect_same("whole", "out");
    expect_refused("optimize --resume out", 65,
                   "out: its run is done, expected the folder of a run");
    // Results may be replaced, with the checkpoints beside them.
    stop(std::string(kLongRun) + "-o again", "again", SIGINT);
    ASSERT_EQ(run(std::string(kLongRun) + "-o again").code, 0) << read_text(folder / ".err");
    expect_same("whole", "again");
}

/// A search that would last for longer.
TEST_F(Resume, ANewRunThatIsStoppedBeforeItsFirstCheckpointLeavesTheOldOne) {
    ASSERT_EQ(run(std::string(kLongRun) + "-o whole").code, 0);
    stop(std::string(kLongRun) + "-o out", "out", SIGINT);
    const int before = iterations_of("out");
    ASSERT_GT(before, 0);
    const pid_t pid = start(
        "optimize scene.xml --parameter base_color --size 768 768 --target-spp 1 --threads 1 "
        "--time 3600 -o out");
    EXPECT_TRUE(wait_for_error_text("optimising"));
    sleep(0.1);
    kill(pid, SIGINT);
    end_of(pid);
    EXPECT_TRUE(contains(read_text(folder / ".err"), "nothing of this run is kept"))
        << read_text(folder / ".err");
    EXPECT_EQ(iterations_of("out"), before);
    ASSERT_EQ(run("optimize --resume out").code, 0) << read_text(folder / ".err");
    expect_same("whole", "out");
}

TEST_F(Resume, ARunThatCtrlCHasEndedIsNotDone) {
    fs::create_directory(folder / "out");
    for (const auto& [ending, said] :
         {std::pair("signal", "found no checkpoint"), std::pair("iterations", "its run is done")}) {
        write_text(folder / "out/summary.json",
                   fmt::format(R"({{"asked": {{}}, "result": {{"ended_by": "{}"}}}})", ending));
        expect_refused("optimize --resume out", 65, said);
    }
}

TEST_F(Resume, ANewRunThatFailsDoesNotTakeTheOldOneForItself) {
    stop(std::string(kLongRun) + "-o out", "out", SIGTERM);
    const int before = iterations_of("out");
    const Outcome failed = run("optimize missing.xml --parameter a --force -o out");
    EXPECT_EQ(failed.code, 65) << failed.err;
    EXPECT_FALSE(contains(failed.err, "the run is kept")) << failed.err;
    EXPECT_EQ(iterations_of("out"), before) << "the old one can go on";
}

TEST_F(Resume, AChangedFileIsNamed) {
    stop(std::string(kLongRun) + "-o out", "out", SIGTERM);
    const std::string color = read_text(folder / "color.exr");
    write_image(folder / "color.exr", make_image(8, 8, 3, 0.25f));
    const Outcome changed =
        expect_refused("optimize --resume out", 65, "cannot go on: color.exr is another file");
    EXPECT_FALSE(contains(changed.err, "roughness.exr")) << changed.err;
    fs::remove(folder / "color.exr");
    EXPECT_TRUE(contains(run("optimize --resume out").err, "color.exr: no such file"));
    EXPECT_GT(iterations_of("out"), 0) << "nothing is lost by it";
    write_text(folder / "color.exr", color);
    EXPECT_EQ(run("optimize --resume out").code, 0);
}

/// A run that would last for hours has two of them, however long the disk rests.
TEST_F(Resume, ADamagedCheckpointIsSaidAndTheOneBeforeTaken) {
    stop(
        "optimize scene.xml --parameter base_color --init 0.5 --spp 2 --target-spp 16 "
        "--evaluation-spp 8 --iterations 10000000 --checkpoint-every 0.001 -o out",
        "out", SIGTERM, "checkpoints", 2);
    const int newest = iterations_of("out");
    const fs::path file = folder / "out/checkpoints" / fmt::format("{:010}.burnish", newest);
    fs::resize_file(file, fs::file_size(file) / 2);
    const int more = newest + 10;
    const Outcome resumed = run(fmt::format("optimize --resume out --iterations {}", more));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_TRUE(contains(resumed.err, fmt::format("{:010}.burnish: holds", newest))) << resumed.err;
    EXPECT_TRUE(contains(resumed.err, "the one before it is taken")) << resumed.err;
    EXPECT_EQ(summary_of("out")["result"]["iterations"], more);
}

TEST_F(Resume, OnlyWhatDecidesOnNoByteMayChange) {
    stop(std::string(kLongRun) + "-o out", "out", SIGTERM);
    for (const char* other : {"--spp 4", "--seed 3", "scene.xml", "-o other", "--set loss=l2",
                              "--options whole.json", "--force"}) {
        const Outcome refused =
            expect_refused(std::string("optimize --resume out ") + other, 2, "--resume");
        EXPECT_FALSE(contains(refused.err, "going on")) << other << refused.err;
    }
    EXPECT_EQ(run("optimize --resume nothing").code, 65);
    EXPECT_FALSE(fs::exists(folder / "nothing"));
    const Outcome longer =
        run("optimize --resume out --iterations 310 --evaluation-spp 4 --patience 60");
    EXPECT_EQ(longer.code, 0) << longer.err;
    const auto summary = summary_of("out");
    EXPECT_EQ(summary["result"]["iterations"], 310);
    // Patience that the run had from a later iteration on would end its repetition elsewhere.
    EXPECT_EQ(summary["settings"]["stop"]["patience"], "none");
    EXPECT_EQ(summary["settings"]["stop"]["iterations"], 310);
    EXPECT_EQ(summary["asked"]["stop"]["patience"], 60);
}

TEST_F(Resume, ASecondRunGoesOn) {
    const std::string command = std::string(kLongRun) + "--compare mc ";
    ASSERT_EQ(run(command + "-o whole").code, 0) << read_text(folder / ".err");
    const int status = stop(command + "-o out", "out", SIGTERM, "checkpoints/compared");
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 75) << read_text(folder / ".err");
    ASSERT_EQ(run("optimize --resume out").code, 0) << read_text(folder / ".err");
    expect_same("whole", "out");
    EXPECT_EQ(summary_of("out")["compared"]["iterations"], 300);
}

/// Within a minute it writes none but the last.
TEST_F(Resume, ASignalInASecondRunWaitsForItsFirstCheckpoint) {
    std::string command = kLongRun;
    command.erase(command.find("--checkpoint-every"));
    const int status = stop_once([&] { return iterations_told("out", "checkpoints/compared") > 1; },
                                 command + "--compare mc -o out", "out", SIGTERM);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 75) << read_text(folder / ".err");
    const auto kept = checkpoints_in(folder / "out/checkpoints/compared");
    ASSERT_EQ(kept.size(), 1u) << read_text(folder / ".err");
    EXPECT_GT(std::stoi(kept.front().filename().string()), 1);
}

TEST_F(Resume, ASecondRunWithADamagedCheckpointGoesOnOrBeginsAnew) {
    const std::string command = std::string(kLongRun) + "--compare mc ";
    ASSERT_EQ(run(command + "-o whole").code, 0) << read_text(folder / ".err");
    stop(command + "-o out", "out", SIGTERM, "checkpoints/compared");
    const std::vector<fs::path> kept = checkpoints_in(folder / "out/checkpoints/compared");
    ASSERT_FALSE(kept.empty()) << read_text(folder / ".err");
    fs::copy(folder / "out", folder / "anew", fs::copy_options::recursive);
    for (const fs::path& file : kept)
        fs::resize_file(folder / "anew/checkpoints/compared" / file.filename(), 100);
    write_text(folder / "out/checkpoints/compared/0000009999.burnish", "BURNISHC");
    for (const auto& [out, said] :
         {std::pair("out", "0000009999.burnish: is cut off: the one before it is taken"),
          std::pair("anew", "the second run begins anew")}) {
        const Outcome resumed = run(std::string("optimize --resume ") + out);
        ASSERT_EQ(resumed.code, 0) << resumed.err;
        EXPECT_TRUE(contains(resumed.err, said)) << resumed.err;
        expect_same("whole", out);
        EXPECT_EQ(summary_of(out)["compared"]["iterations"], 300);
    }
}

/// A run that replaced another one, and was killed, may have left that one's.
TEST_F(Resume, ASecondRunDoesNotGoOnFromTheCheckpointOfAnotherOne) {
    const std::string command = std::string(kLongRun) + "--compare mc ";
    ASSERT_EQ(run(command + "-o whole").code, 0) << read_text(folder / ".err");
    const std::string second = "checkpoints/compared";
    stop(command + "-o out", "out", SIGTERM, second);
    stop(command + "--seed 5 -o other", "other", SIGTERM, second);
    fs::remove_all(folder / "out" / second);
    fs::copy(folder / "other" / second, folder / "out" / second);
    ASSERT_FALSE(checkpoints_in(folder / "out" / second).empty());
    const Outcome resumed = run("optimize --resume out");
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_TRUE(contains(resumed.err,
                         ".burnish: the run cannot go on as it was: changed since it began: the "
                         "option seed"))
        << resumed.err;
    EXPECT_TRUE(contains(resumed.err, ": the second run begins anew")) << resumed.err;
    expect_same("whole", "out");
}

/// The pipe that it speaks into is full: it waits where it says what it goes on from.
TEST_F(Resume, ASignalAsACheckpointIsReadKeepsTheRun) {
    stop(std::string(kLongRun) + "-o out", "out", SIGTERM);
    const FullPipe pipe(folder / "pipe");
    const pid_t pid =
        start_shell("sh -c \"exec '" BURNISH_BINARY "' optimize --resume out 2>pipe\"");
    EXPECT_TRUE(wait_for([&] { return fs::exists(lock_of("out")); }));
    sleep(0.5);
    kill(pid, SIGTERM);
    const int status = pipe.drain_until_end_of(pid);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
}

/// Light that is finite, and too bright for what becomes of it.
TEST_F(Resume, NumbersThatAreNotFiniteEndItWithACheckpoint) {
    run("render scene.xml -o target.exr --spp 4");
    const std::string scene = read_text(folder / "scene.xml");
    write_text(folder / "scene.xml",
               std::string(scene).replace(scene.find("value=\"6\""), 9, "value=\"3e38\""));
    const Outcome outcome = expect_refused(
        "optimize scene.xml --parameter base_color --target target.exr --spp 2 --evaluation-spp 8 "
        "--iterations 300 --loss relmse -o out",
        65, "samples were not finite, expected at most one in 1000");
    EXPECT_TRUE(contains(outcome.err, "--resume out")) << outcome.err;
    EXPECT_EQ(iterations_of("out"), 1);
    EXPECT_FALSE(fs::exists(folder / "out/textures"));
}

TEST_F(Resume, TwoRunsDoNotShareAFolder) {
    const pid_t pid = start(
        "optimize scene.xml --parameter base_color --spp 2 --target-spp 16 --time 3600 "
        "--checkpoint-every 0.001 -o out");
    EXPECT_TRUE(wait_for([&] { return iterations_of("out") > 0; }));
    const std::string mine = read_text(folder / ".err");
    for (const std::string& other :
         {std::string("optimize --resume out"), std::string(kLongRun) + "--force -o out"}) {
        const std::string command = "cd '" + folder.string() + "' && '" BURNISH_BINARY "' " +
                                    other + " 2>other.err </dev/null";
        EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 73);
        EXPECT_TRUE(contains(read_text(folder / "other.err"), "another run is writing"))
            << read_text(folder / "other.err");
    }
    kill(pid, SIGTERM);
    EXPECT_EQ(WEXITSTATUS(end_of(pid)), 75);
    EXPECT_GT(iterations_of("out"), 0);
}

TEST_F(Resume, ARunThatHasNoCheckpointYetIsSaidToGoOn) {
    {
        const OutputFolder output = open_output_folder(folder / "out", Found::kRefused);
        expect_refused("optimize --resume out", 73, "out: another run is writing into this folder");
        EXPECT_TRUE(fs::exists(lock_of("out")));
    }
    fs::create_directories(lock_of("out").parent_path());
    write_text(lock_of("out"), "");  // of one that was killed
    expect_refused("optimize --resume out", 65, "out: found no checkpoint");
}

TEST_F(Resume, ALinkInTheFolderIsRefused) {
    fs::create_directories(folder / "elsewhere");
    fs::create_directories(folder / "out");
    fs::create_directory_symlink("../elsewhere", folder / "out/textures");
    expect_refused(std::string(kLongRun) + "--force -o out", 73, "out/textures: a link");
    EXPECT_TRUE(fs::is_empty(folder / "elsewhere"));
}

/// Root may read everywhere, but does not come to the end of a link to itself.
TEST_F(Resume, CheckpointsThatCannotBeReadAreNotNone) {
    fs::create_directory(folder / "out");
    const auto expect_said = [&](const std::string& why) {
        expect_refused("optimize --resume out", 73, "out/checkpoints: cannot be read: " + why);
        write_text(folder / "jobs.json",
                   R"({"jobs": [{"output": "out", "arguments": ["scene.xml", "--parameter",
                       "base_color"]}]})");
        const Outcome batch = run("batch jobs.json");
        EXPECT_EQ(batch.code, 73) << batch.err;
        EXPECT_TRUE(contains(batch.out, "out/checkpoints: cannot be read: " + why)) << batch.out;
    };
    fs::create_directory_symlink("checkpoints", folder / "out/checkpoints");
    expect_said("Too many levels of symbolic links");
    fs::remove(folder / "out/checkpoints");
    fs::create_directory(folder / "out/checkpoints");
    fs::create_directory_symlink("compared", folder / "out/checkpoints/compared");
    expect_refused(std::string(kLongRun) + "--force -o out", 73,
                   "out/checkpoints/compared: cannot be read: ");
    fs::remove(folder / "out/checkpoints/compared");
    fs::permissions(folder / "out/checkpoints", fs::perms::none);
    if (!drop_root()) GTEST_SKIP() << "root may read everywhere, and no other user is at hand";
    expect_said("Permission denied");
    fs::permissions(folder / "out/checkpoints", fs::perms::owner_all);
}

}  // namespace
}  // namespace burnish
