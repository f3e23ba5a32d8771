// Disks that are full, broken or too small: what fails says so, and nothing that was there is lost.
#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "cli/program.h"
#include "image/files.h"

namespace burnish {
namespace {

using namespace testing;

constexpr const char* kShortRun =
    "optimize scene.xml --parameter base_color --spp 2 --target-spp 4 --evaluation-spp 4 "
    "--iterations 3 --checkpoint-every 0.001 ";

class Faults : public Program {
  protected:
    Faults() { write_scene(); }

    /// The bytes of all results.
    std::map<std::string, std::string> results() const {
        if (!fs::exists(folder / "out")) return {};
        return test::contents(folder / "out");
    }
};

TEST_F(Faults, ALimitOfFileSizesIsSaidBeforeTheRun) {
    write_image(folder / "color.exr", make_image(256, 256, 3, 0.5f));
    const Outcome outcome =
        shell("ulimit -f 64; '" BURNISH_BINARY "' " + std::string(kShortRun) + "-o out");
    EXPECT_EQ(outcome.code, 73) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "out: there is no room for the results, 832.0 KiB"))
        << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "File too large")) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
}

/// Any checkpoint of this run is larger than the limit, any result smaller.
TEST_F(Faults, WhereNoCheckpointHasRoomTheSystemsSignalsKeepTheResults) {
    for (const int signal : {SIGTERM, SIGHUP}) {
        const pid_t pid = start_shell(
            "sh -c \"ulimit -f 280; exec '" BURNISH_BINARY
            "' optimize scene.xml --parameter base_color --init 0.5 --spp 2 --size 64 64 "
            "--target-spp 4 --evaluation-spp 4 --time 3600 --compare mc -o out\"");
        EXPECT_TRUE(wait_for([&] { return iterations_told("out") > 0; }));
        kill(pid, signal);
        const int status = end_of(pid);
        const std::string text = read_text(folder / ".err");
        ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << text;
        EXPECT_TRUE(contains(text, "File too large; the run ends without this checkpoint")) << text;
        EXPECT_TRUE(contains(text, "the second run was not begun\n")) << text;
        EXPECT_FALSE(contains(text, "--resume")) << text;
        EXPECT_EQ(summary_of("out")["result"]["ended_by"], "signal");
        EXPECT_TRUE(fs::exists(folder / "out/textures/mat-panel.brdf_0.base_color.data.exr"));
        EXPECT_FALSE(fs::exists(folder / "out/checkpoints"));
        fs::remove_all(folder / "out");
    }
}

TEST_F(Faults, AFolderThatCannotBeMadeIsSaid) {
    for (const char* out : {"/proc/burnish", "/dev/null/out"}) {
        expect_refused(std::string(kShortRun) + "-o " + out, 73, "cannot be made");
        expect_refused(std::string("scene goblet --texture-size 16 -o ") + out, 73,
                       "cannot be made");
    }
}

TEST_F(Faults, FoldersThatMayNotBeWrittenAreNamed) {
    fs::create_directory(folder / "out");
    fs::permissions(folder / "out", fs::perms::owner_read | fs::perms::owner_exec);
    if (!drop_root()) GTEST_SKIP() << "root may write everywhere, and no other user is at hand";
    expect_refused(std::string(kShortRun) + "-o out", 73, "Permission denied");
}

TEST_F(Faults, ASceneThatCannotBeWrittenLeavesNothing) {
    const Outcome outcome =
        shell("ulimit -f 64; '" BURNISH_BINARY "' scene goblet --texture-size 16 -o new/t");
    EXPECT_EQ(outcome.code, 73) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "File too large")) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "new"));
}

TEST_F(Faults, ASceneLeavesResultsInItsFolder) {
    ASSERT_EQ(run(std::string(kShortRun) + "-o out").code, 0);
    const auto before = results();
    ASSERT_EQ(run("scene goblet --texture-size 16 -o out").code, 0);
    const auto after = results();
    EXPECT_TRUE(after.contains("scene.xml"));
    for (const auto& [name, bytes] : before)
        EXPECT_TRUE(after.contains(name) && after.at(name) == bytes) << name;
}

/// A disk of 1 MiB that this script alone sees, of which nothing is free when the commands begin.
constexpr const char* kFullDisk = R"sh(set -e
mount -t tmpfs -o size=1m disk disk
"$1" render scene.xml --spp 1 -o disk/image.exr
"$1" $2 -o disk/out
cp -r disk before
cat /dev/zero >disk/rest 2>rest.err || true
for command in 'render scene.xml --spp 1 --seed 1 -o disk/image.exr' "$2 --seed 1 -o disk/out" \
    'scene goblet --texture-size 16 -o disk/scene'; do
    code=0
    "$1" $command 2>said || code=$?
    echo "$code $(grep -c 'No space left on device' said)"
done
rm disk/rest
diff -r before disk
)sh";

TEST_F(Faults, AFullDiskKeepsWhatItHolds) {
    fs::create_directory(folder / "disk");
    if (shell("unshare -rm mount -t tmpfs disk disk").code != 0)
        GTEST_SKIP() << "the system lets this user mount no disk: " << read_text(folder / ".err");
    write_text(folder / "full.sh", kFullDisk);
    const Outcome outcome =
        shell(fmt::format("unshare -rm sh full.sh '" BURNISH_BINARY "' '{}'", kShortRun));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "73 1\n73 1\n73 1\n");
}

#ifdef BURNISH_FAULT_SHIM

/// Files that depend on times are whole.
bool is_whole(const std::string& name, const std::string& text) {
    if (name == "summary.json") return nlohmann::json::accept(text);
    return text.ends_with(name == "report.html" ? "</html>\n" : "\n");
}

constexpr int kKill = -1;

/// The call that fails, and how.
struct Fault {
    int number = 1, error = ENOSPC;
    bool always = false;  ///< and all after it
};

class Injected : public Faults {
  protected:
    bool has_checkpoint() const { return !checkpoints_in(folder / "out/checkpoints").empty(); }
    /// Runs with a fault; says in `fired` whether a call failed.
    Outcome run_with(const Fault& fault, const std::string& arguments, bool& fired) const {
        fs::remove(folder / "fired");
        const Outcome outcome = shell(fmt::format(
            "BURNISH_FAULT_FOLDER={0}/out BURNISH_FAULT_NUMBER={1} BURNISH_FAULT_ERROR={2} {3} "
            "BURNISH_FAULT_LOG=fired LD_PRELOAD=" BURNISH_FAULT_SHIM " '" BURNISH_BINARY "' {4}",
            folder.string(), fault.number, fault.error,
            fault.always ? "BURNISH_FAULT_ALWAYS=1" : "", arguments));
        fired = fs::exists(folder / "fired");
        return outcome;
    }
    /// Memory ends once, after so many checkpoints, which says how the run goes on.
    void expect_memory_to_end(const std::string& arguments, int checkpoints) const {
        const Outcome failed =
            shell(fmt::format("BURNISH_FAULT_MEMORY_AFTER={} LD_PRELOAD=" BURNISH_FAULT_SHIM
                              " '" BURNISH_BINARY "' {}",
                              checkpoints, arguments));
        EXPECT_EQ(failed.code, 77) << failed.err;
        EXPECT_TRUE(contains(failed.err, "there is not enough memory")) << failed.err;
        EXPECT_TRUE(contains(failed.err, "optimize --resume ")) << failed.err;
    }
};

using Results = std::map<std::string, std::string>;

/// Each file of the earlier run is there, as it was or as the new run has it.
void expect_old_or_new(const Results& found, const Results& earlier, const Results& newer,
                       const std::string& what) {
    for (const auto& [name, bytes] : found) {
        if (name.starts_with("checkpoints") || name.starts_with(".burnish-unfinished") ||
            is_temporary(name))
            continue;
        const bool is_old = earlier.contains(name) && earlier.at(name) == bytes;
        const bool is_new = newer.contains(name) && newer.at(name) == bytes;
        EXPECT_TRUE(is_timed(name) ? is_whole(name, bytes) : is_old || is_new)
            << name << ", " << what;
    }
    for (const auto& [name, bytes] : earlier)
        EXPECT_TRUE(found.contains(name)) << name << ", " << what;
}

void expect_new(Results found, const Results& newer, const std::string& what) {
    for (const auto& [name, bytes] : newer) {
        EXPECT_TRUE(is_timed(name) || found[name] == bytes) << name << ", " << what;
    }
}

/// A command that writes into the folder "out" what an earlier one has written otherwise.
struct Replacement {
    std::string command, earlier;  ///< arguments; no earlier one: the folder is empty
    std::string goes_on = {};      ///< what follows where a checkpoint is kept
    int calls = 0;                 ///< that write, at least
    int stride = 1;                ///< one of so many fails, roughly; BURNISH_FAULTS=1: each
};

/// Where no process was killed: no file that is not whole, no empty folder.
void expect_no_remains(const fs::path& out, const std::string& what) {
    for (const auto& entry : fs::recursive_directory_iterator(out)) {
        EXPECT_FALSE(is_temporary(entry.path())) << entry.path() << ", " << what;
        EXPECT_FALSE(entry.is_directory() && fs::is_empty(entry.path()))
            << entry.path() << ", " << what;
    }
    EXPECT_FALSE(fs::exists(out / ".burnish-unfinished")) << what;
}

/// The call that fails after another one.
int next_call(const Fault& fault, int stride) {
    const bool all = stride == 1 || std::getenv("BURNISH_FAULTS") != nullptr;
    return fault.number + (all ? 1 : stride + std::abs(fault.error) % 7);
}

/// A fault in each place in turn: each file that was there is whole, as it was or as the command
/// makes it; what was not there comes as a whole. Once there is room again, it goes on or begins
/// anew.
class EveryWrite : public Injected {
  protected:
    void put(const Results& files) const {
        fs::remove_all(folder / "out");
        fs::create_directory(folder / "out");
        for (const auto& [name, bytes] : files) {
            fs::create_directories((folder / "out" / name).parent_path());
            write_text(folder / "out" / name, bytes);
        }
    }
    Results results_of(const std::string& arguments) const {
        put({});
        if (arguments.empty()) return {};
        EXPECT_EQ(run(arguments).code, 0) << arguments << ": " << read_text(folder / ".err");
        return results();
    }
    void expect_failed(const Replacement& r, const Outcome& outcome, bool killed,
                       const Results& earlier, const std::string& what) const {
        EXPECT_TRUE(killed || contains(outcome.err, "burnish: ")) << what;
        const bool kept = has_checkpoint();
        EXPECT_EQ(killed ? kept : contains(outcome.err, "--resume"), kept) << what;
        const bool is_new = earlier.empty();
        EXPECT_TRUE(!is_new || killed || results().empty()) << what;
        if (is_new && killed) return put({});  // whose user removes what it left
        EXPECT_EQ(run(kept ? r.goes_on : r.command).code, 0) << read_text(folder / ".err") << what;
    }
    void may_fail(const Replacement& r) const {
        const Results newer = results_of(r.command), earlier = results_of(r.earlier);
        for (const Fault& kind : {Fault{1, ENOSPC, true}, Fault{1, ENOSPC, false},
                                  Fault{1, EIO, true}, Fault{1, EIO, false}, Fault{1, kKill, false},
                                  Fault{1, EDQUOT, false}, Fault{1, 0, false}}) {
            bool fired = true;
            Fault fault = kind;
            int last = 0;  // that was tried
            for (; fired; fault.number = next_call(fault, r.stride)) {
                last = fault.number;
                put(earlier);
                const Outcome outcome = run_with(fault, r.command, fired);
                const std::string what =
                    fmt::format("{}: call {}, error {}{}: {}", r.command, fault.number, fault.error,
                                fault.always ? " from there on" : "", outcome.err);
                const bool killed = fired && fault.error == kKill;
                ASSERT_TRUE(killed ? outcome.code == -1 || outcome.code == 128 + SIGKILL
                                   : outcome.code == 0 || outcome.code == 73)
                    << outcome.code << what;
                EXPECT_TRUE(fired || outcome.code == 0) << what;
                expect_old_or_new(results(), earlier, newer, what);
                if (!killed) expect_no_remains(folder / "out", what);
                if (outcome.code != 0) expect_failed(r, outcome, killed, earlier, what);
                if (!killed || !earlier.empty()) expect_new(results(), newer, what);
            }
            EXPECT_GT(last, r.calls) << "it counts the calls";
        }
    }
    std::string into_out(const std::string& arguments) const {
        return fmt::format("{} -o {}/out", arguments, folder.string());
    }
    /// Of a run that replaces the results of another seed.
    Replacement short_run_of(const std::string& arguments, int stride) const {
        return {.command = into_out(arguments) + " --seed 1",
                .earlier = into_out(arguments),
                .goes_on = fmt::format("optimize --resume {}/out", folder.string()),
                .calls = 60,
                .stride = stride};
    }
};

TEST_F(EveryWrite, OfARunMayFail) { may_fail(short_run_of(kShortRun, 31)); }

TEST_F(EveryWrite, OfTwoRunsMayFail) {
    may_fail(short_run_of(std::string(kShortRun) + " --compare mc", 41));
}

TEST_F(EveryWrite, OfABatchMayFail) {
    for (const int seed : {0, 1})
        write_text(folder / fmt::format("seed{}.json", seed),
                   fmt::format(R"({{"jobs": [{{"output": "{}/out", "arguments": ["scene.xml",
                       "--parameter", "base_color", "--spp", "2", "--target-spp", "4",
                       "--evaluation-spp", "4", "--iterations", "3", "--seed", "{}",
                       "--checkpoint-every", "0.001"]}}]}})",
                               folder.string(), seed));
    may_fail({.command = "batch seed1.json",
              .earlier = "batch seed0.json",
              .goes_on = "batch seed1.json",
              .calls = 60,
              .stride = 41});
}

TEST_F(EveryWrite, OfAnImageMayFail) {
    ASSERT_EQ(run("render scene.xml --spp 1 -o adjoint.exr").code, 0);
    for (const std::string command :
         {"render scene.xml --spp 1",
          "gradient scene.xml --spp 1 --parameter base_color --adjoint adjoint.exr"}) {
        const std::string earlier = into_out(command) + "/image.exr";
        may_fail({.command = earlier + " --seed 1", .earlier = earlier, .calls = 5});
        may_fail({.command = earlier, .earlier = {}, .calls = 5});
    }
}

TEST_F(EveryWrite, OfASceneMayFail) {
    const std::string earlier = into_out("scene goblet --texture-size 16");
    may_fail({.command = earlier + " --seed 1", .earlier = earlier, .calls = 50, .stride = 41});
    may_fail({.command = earlier, .earlier = {}, .calls = 50, .stride = 41});
}

TEST_F(EveryWrite, OfAMeshsSceneMayFail) {
    write_text(folder / "mesh.obj",
               "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
               "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    write_image(folder / "sky.exr", make_image(8, 4, 3, 1));
    may_fail({.command = into_out("new --mesh mesh.obj --environment sky.exr --texture-size 4"),
              .earlier = {},
              .calls = 30,
              .stride = 5});
}

TEST_F(Injected, ALinkInTheFolderOfASceneStays) {
    fs::create_directory(folder / "elsewhere");
    bool fired = true;
    for (Fault fault{1, EIO, true}; fired; fault.number += 7) {
        fs::remove_all(folder / "out");
        fs::create_directory(folder / "out");
        fs::create_directory_symlink(folder / "elsewhere", folder / "out/meshes");
        run_with(fault, "scene bowl --texture-size 16 -o " + folder.string() + "/out", fired);
        EXPECT_TRUE(fs::is_symlink(folder / "out/meshes")) << fault.number;
    }
}

std::string short_run(int iterations) {
    const std::string three = "--iterations 3";
    std::string arguments = kShortRun;
    return arguments.replace(arguments.find(three), three.size(),
                             fmt::format("--iterations {}", iterations));
}

TEST_F(Injected, CheckpointsThatCannotBeWrittenAreSaidOnce) {
    const Outcome outcome = shell(fmt::format(
        "BURNISH_FAULT_FOLDER=00000 BURNISH_FAULT_NUMBER=1 BURNISH_FAULT_ERROR={} "
        "BURNISH_FAULT_ALWAYS=1 LD_PRELOAD=" BURNISH_FAULT_SHIM " '" BURNISH_BINARY "' {} -o out",
        ENOSPC, short_run(300)));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    // The last one, and where it was due, as on a slow machine, the first one before.
    for (const std::string said : {"the run goes on without", "the run ends without"})
        EXPECT_EQ(outcome.err.find(said), outcome.err.rfind(said)) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "the run ends without this checkpoint")) << outcome.err;
}

/// FUSE and some network file systems have none.
TEST_F(Injected, AFileSystemWithoutLocksIsSaid) {
    const auto run_without = [&](int error) {
        return shell(fmt::format("BURNISH_FAULT_LOCK={} LD_PRELOAD=" BURNISH_FAULT_SHIM
                                 " '" BURNISH_BINARY "' scene goblet --texture-size 16 -o s{}",
                                 error, error));
    };
    for (const int error : {ENOSYS, ENOLCK, EOPNOTSUPP}) {
        const Outcome outcome = run_without(error);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "its file system has no locks")) << outcome.err;
        EXPECT_TRUE(fs::exists(folder / fmt::format("s{}", error) / "scene.xml"));
    }
    const Outcome held = run_without(EWOULDBLOCK), broken = run_without(EIO);
    EXPECT_EQ(held.code, 73);
    EXPECT_TRUE(contains(held.err, "another run is writing into this folder")) << held.err;
    EXPECT_EQ(broken.code, 73);
    EXPECT_TRUE(contains(broken.err, "the folder cannot be locked: ")) << broken.err;
}

TEST_F(Injected, NothingIsLeftWhereOpenFilesStayUntilTheyAreClosed) {
    const Outcome outcome = shell("BURNISH_FAULT_NFS=1 LD_PRELOAD=" BURNISH_FAULT_SHIM
                                  " '" BURNISH_BINARY "' scene goblet --texture-size 16 -o out");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(fs::exists(folder / "out/scene.xml"));
    EXPECT_FALSE(fs::exists(folder / "out/.burnish-unfinished"));
}

TEST_F(Injected, AFolderThatCannotBeSyncedDoesNotFillUp) {
    const auto run_without = [&](int error) {
        return shell(fmt::format("BURNISH_FAULT_FOLDER_SYNC={} LD_PRELOAD=" BURNISH_FAULT_SHIM
                                 " '" BURNISH_BINARY "' {} -o out",
                                 error, short_run(300)));
    };
    const Outcome without = run_without(EINVAL);
    EXPECT_EQ(without.code, 0) << without.err;
    EXPECT_FALSE(contains(without.err, "cannot be written")) << without.err;
    EXPECT_FALSE(fs::exists(folder / "out/checkpoints"));
    fs::remove_all(folder / "out");
    const Outcome broken = run_without(EIO);
    EXPECT_EQ(broken.code, 73) << broken.err;
    const std::size_t checkpoints = checkpoints_in(folder / "out/checkpoints").size();
    EXPECT_GT(checkpoints, 0u);
    EXPECT_LE(checkpoints, 3u);
}

/// In the midst of a checkpoint: before a file is opened, in a write, before a sync, before the
/// rename. BURNISH_KILLS=2000: a quarter as many.
TEST_F(Injected, KilledInTheWriterItLosesNoCheckpoint) {
    const char* asked = std::getenv("BURNISH_KILLS");
    const int kills = asked ? std::atoi(asked) / 4 : 6;
    const std::string command = fmt::format("{} -o {}/", short_run(100), folder.string());
    ASSERT_EQ(run(command + "whole").code, 0) << read_text(folder / ".err");
    const auto newest = [&] {
        const std::vector<fs::path> files = checkpoints_in(folder / "out/checkpoints");
        return files.empty() ? 0 : std::stoi(files.back().filename().string());
    };
    std::mt19937 random(11);
    std::uniform_int_distribution<int> call(1, 40);  // some four of a checkpoint
    int killed = 0, finished = 0;
    while (killed < kills || finished == 0) {
        const int known = newest();
        const Outcome outcome = shell(fmt::format(
            "BURNISH_FAULT_FOLDER=00000 BURNISH_FAULT_NUMBER={} BURNISH_FAULT_ERROR=-1 "
            "LD_PRELOAD=" BURNISH_FAULT_SHIM " '" BURNISH_BINARY "' {}",
            killed < kills ? call(random) : 1000000,
            known > 0 ? "optimize --resume out --checkpoint-every 0.001" : command + "out"));
        EXPECT_FALSE(contains(outcome.err, "damaged")) << outcome.err;
        EXPECT_TRUE(known == 0 || contains(outcome.err, fmt::format("going on after {} ", known)))
            << outcome.err;
        if (outcome.code == -1 || outcome.code == 128 + SIGKILL) {
            ++killed;
            EXPECT_GE(newest(), known);
            continue;
        }
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        ++finished;
        EXPECT_GE(expect_same_files(folder / "whole", folder / "out"), 6u);
        fs::remove_all(folder / "out");
    }
}

/// The calls are: as a trial before the work, and to write the image, to open a file; a write of
/// its content, a sync, a rename.
TEST_F(Injected, ASignalLeavesNoUnfinishedImage) {
    ASSERT_EQ(run("render scene.xml --spp 1 -o adjoint.exr").code, 0);
    for (const std::string command :
         {"render scene.xml --spp 1",
          "gradient scene.xml --spp 1 --parameter base_color --adjoint adjoint.exr"})
        for (const int call : {3, 5}) {
            fs::remove(folder / "image.exr"), fs::remove(folder / "fired");
            shell(fmt::format(
                "BURNISH_FAULT_FOLDER=image.exr BURNISH_FAULT_NUMBER={} BURNISH_FAULT_SIGNAL={} "
                "BURNISH_FAULT_LOG=fired LD_PRELOAD=" BURNISH_FAULT_SHIM " '" BURNISH_BINARY
                "' {} -o image.exr",
                call, SIGINT, command));
            EXPECT_TRUE(fs::exists(folder / "fired"));
            EXPECT_TRUE(fs::exists(folder / "image.exr")) << command;
            for (const fs::path& file : entries_of(folder))
                EXPECT_FALSE(is_temporary(file)) << command << ": " << file;
        }
}

TEST_F(Injected, WhereMemoryEndsTheRunGoesOn) {
    const std::string command = fmt::format("{} --size 128 128 -o {}/", kShortRun, folder.string());
    ASSERT_EQ(run(command + "whole").code, 0);
    expect_memory_to_end(command + "out", 1);
    EXPECT_FALSE(fs::exists(folder / "out/summary.json"));
    EXPECT_EQ(run("optimize --resume out").code, 0) << read_text(folder / ".err");
    EXPECT_GE(expect_same_files(folder / "whole", folder / "out"), 6u);
}

/// Its evaluation is the first that takes memory after its checkpoint.
TEST_F(Injected, WhereTheSecondRunFailsTheFirstHasItsResults) {
    std::string once = kShortRun;
    once.replace(once.find("0.001"), 5, "3600");  // a checkpoint at the end of each run
    const std::string command =
        fmt::format("{} --size 128 128 --compare mc -o {}/", once, folder.string());
    ASSERT_EQ(run(command + "whole").code, 0);
    expect_memory_to_end(command + "out", 2);
    const auto summary = summary_of("out");
    EXPECT_FALSE(summary.contains("compared"));
    for (const auto& [name, bytes] : test::contents(folder / "whole"))
        if (name.starts_with("textures/")) {
            EXPECT_TRUE(read_text(folder / "out" / name) == bytes) << name;
        }
    EXPECT_TRUE(has_checkpoint());
    EXPECT_EQ(run("optimize --resume out").code, 0) << read_text(folder / ".err");
    EXPECT_GE(expect_same_files(folder / "whole", folder / "out"), 6u);
    EXPECT_TRUE(summary_of("out").contains("compared"));
}

/// A run that goes on takes the newest one by its name.
TEST_F(EveryWrite, WhereItKillsANewRunCheckpointsAreOfOneRunAlone) {
    const std::string command = into_out(
        "optimize scene.xml --parameter base_color --spp 2 --target-spp 4 --evaluation-spp 4 "
        "--iterations 300 --checkpoint-every 0.001 --compare mc");
    stop_once([&] { return checkpoints_in(folder / "out/checkpoints/compared").size() > 0; },
              command, "out", SIGTERM);
    const Results earlier = results();
    bool fired = true;
    int with_new = 0;
    for (Fault fault{1, kKill}; fired && with_new < 6; ++fault.number) {
        put(earlier);
        run_with(fault, command + " --seed 1 --force", fired);
        int older = 0, newer = 0;
        for (const auto& [name, bytes] : results()) {
            if (!name.starts_with("checkpoints/") || !name.ends_with(".burnish") ||
                is_temporary(name))
                continue;
            const bool is_older = earlier.contains(name) && earlier.at(name) == bytes;
            ++(is_older ? older : newer);
        }
        EXPECT_TRUE(older == 0 || newer == 0) << older << ", " << newer << ", " << fault.number;
        with_new += newer > 0;
    }
    EXPECT_EQ(with_new, 6);
}

TEST_F(Injected, WhatFitsIsKeptWhereNothingWasBefore) {
    const std::string command = fmt::format("{} -o {}/out", kShortRun, folder.string());
    bool fired = true;
    int with_textures = 0;
    for (int n = 1; fired; n += 9) {
        fs::remove_all(folder / "out");
        const Outcome outcome = run_with({n, EIO, false}, command, fired);
        const auto kept = results();
        for (const auto& [name, bytes] : kept)
            if (name.starts_with("textures/") && outcome.code != 0) ++with_textures;
        if (outcome.code != 0 && contains(outcome.err, "--resume")) {
            EXPECT_EQ(run(fmt::format("optimize --resume {}/out", folder.string())).code, 0)
                << read_text(folder / ".err");
        }
    }
    EXPECT_GT(with_textures, 0);
}

TEST_F(Injected, ABatchMakesAJobAnewWhoseResultsHadNoRoom) {
    const std::string arguments = R"(["scene.xml", "--parameter", "base_color", "--init", "0.5",
        "--spp", "2", "--target-spp", "4", "--evaluation-spp", "4", "--iterations", "3"])";
    write_text(folder / "jobs.json",
               fmt::format(R"({{"jobs": [{{"output": "{}/out", "arguments": {}}}]}})",
                           folder.string(), arguments));
    bool fired = true;
    int made_anew = 0;
    for (int n = 1; fired; n += 9) {
        fs::remove_all(folder / "out");
        const Outcome outcome = run_with({n, ENOSPC, false}, "batch jobs.json", fired);
        if (outcome.code == 0 || !fs::exists(folder / "out/textures")) continue;
        fs::remove_all(folder / "out/checkpoints");  // as where there is no room for them, either
        const bool all_fit = contains(read_text(folder / "out/summary.json"), "\"asked\"");
        const Outcome again = run("batch jobs.json");
        EXPECT_EQ(again.code, 0) << again.out << again.err;
        EXPECT_EQ(contains(again.out, "out: was done before"), all_fit) << again.out << n;
        made_anew += all_fit ? 0 : 1;
    }
    EXPECT_GT(made_anew, 0);
}

#endif

}  // namespace
}  // namespace burnish
