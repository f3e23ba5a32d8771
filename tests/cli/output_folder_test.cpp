// The folder of a run's results: where another thread is at work in it when the run ends, where it
// holds what is somebody else's, and links.
#include "cli/output_folder.h"

#include <sys/mman.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <new>
#include <random>
#include <thread>
#include <utility>

#include "burnish/error.h"
#include "cli/folder_content.h"
#include "cli/folder_lock.h"
#include "cli/history.h"
#include "cli/program.h"
#include "cli/texture_files.h"

namespace burnish {
namespace {

using namespace testing;

class OutputFolderTest : public Program {
  protected:
    /// Runs of twenty files and a thread that works on them while they are removed. Nothing stays.
    void expect_nothing_stays(const std::function<void(const fs::path&, int)>& work) const {
        for (int run = 0; run < 100; ++run) {
            std::jthread worker;
            {
                const OutputFolder output = open_output_folder(folder / "out", Found::kRefused);
                const fs::path into = output.unfinished / "scenes" / "textures";
                fs::create_directories(into);
                for (int i = 0; i < 20; ++i) write_text(into / std::to_string(i), "texels");
                worker = std::jthread([&work, into] {
                    for (int i = 0; i < 20; ++i) work(into, i);
                });
            }
            EXPECT_FALSE(fs::exists(folder / "out")) << "run " << run;
        }
    }
    void put(const std::string& name, const std::string& text) const {
        fs::create_directories((folder / name).parent_path());
        write_text(folder / name, text);
    }
    /// All that is in it, with the text of files and where links lead.
    std::map<std::string, std::string> content(const std::string& name) const {
        std::map<std::string, std::string> all;
        for (const auto& entry : fs::recursive_directory_iterator(folder / name)) {
            std::string& text = all[entry.path().string()];
            if (entry.is_symlink())
                text = fs::read_symlink(entry.path()).string();
            else if (entry.is_regular_file())
                text = read_text(entry.path());
        }
        return all;
    }
    void expect_refused(const std::string& name, Found found) const {
        const auto before = content(name);
        EXPECT_THROW(open_output_folder(folder / name, found), OutputError) << name;
        EXPECT_EQ(content(name), before) << name;
    }
    /// The exit status of a command that must not wait for anything.
    int code_within_seconds(const std::string& arguments) const {
        const std::string command = "cd '" + folder.string() + "' && timeout -s KILL 20 '" +
                                    BURNISH_BINARY "' " + arguments + " >.out 2>.err </dev/null";
        const int status = std::system(command.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
};

constexpr const char* kForeignHistory = "epoch,loss\n1,0.5\n";

/// What processes that open folders at the same time have seen, in memory that they share.
struct Seen {
    bool is_held = true;            ///< each folder is, for a moment
    std::atomic<int> holders{0};    ///< at this moment
    std::atomic<int> opened{0};     ///< folders
    std::atomic<int> together{0};   ///< opened while another process held the folder
    std::atomic<int> lockless{0};   ///< times that a holder's lock was not there
    std::atomic<int> in_use{0};     ///< times that another run was at work
    std::atomic<int> otherwise{0};  ///< times that opening failed for another reason
    char reason[256] = "";          ///< the last of these
};

/// Opens a folder and leaves it, again and again. The folder above goes where it is empty, as where
/// the run has made it.
void open_for_seconds(double seconds, const fs::path& out, unsigned seed, Seen& seen) {
    std::minstd_rand random(seed);
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) try {
            OutputFolder output = open_output_folder(out, Found::kAllowed);
            ++seen.opened;
            if (seen.holders.fetch_add(1) > 0) ++seen.together;
            if (seen.is_held)
                std::this_thread::sleep_for(std::chrono::microseconds(random() % 300));
            if (!fs::exists(output.unfinished / kLock)) ++seen.lockless;
            --seen.holders;
            output = {};
            std::error_code ignored;
            fs::remove(out.parent_path(), ignored);
        } catch (const std::exception& error) {
            const bool is_in_use = contains(error.what(), kInUse);
            ++(is_in_use ? seen.in_use : seen.otherwise);
            if (!is_in_use) std::snprintf(seen.reason, sizeof seen.reason, "%s", error.what());
        }
}

/// Processes that do so at the same time. out: the folder of each.
void open_at_once(const std::vector<fs::path>& out, bool is_held,
                  const std::function<void(const Seen&)>& check) {
    void* const shared =
        mmap(nullptr, sizeof(Seen), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(shared, MAP_FAILED);
    Seen& seen = *new (shared) Seen;
    seen.is_held = is_held;
    std::vector<pid_t> processes;
    for (unsigned i = 0; i < out.size(); ++i) {
        processes.push_back(fork());
        if (processes.back() != 0) continue;
        open_for_seconds(1.5, out[i], i + 1, seen);
        _exit(0);
    }
    for (const pid_t process : processes) EXPECT_EQ(end_of(process), 0);
    check(seen);
    munmap(shared, sizeof(Seen));
}

/// Also where the folder was there before, and stays.
TEST_F(OutputFolderTest, OneRunAtATimeHasAFolder) {
    put("there/notes.txt", "mine");
    for (const char* out : {"out", "there"})
        open_at_once({3, folder / out}, true, [&](const Seen& seen) {
            EXPECT_GT(seen.opened, 10) << out;
            EXPECT_GT(seen.in_use, 0) << out;
            EXPECT_EQ(seen.together, 0) << out;
            EXPECT_EQ(seen.lockless, 0) << out;
            EXPECT_EQ(seen.otherwise, 0) << seen.reason;
        });
    EXPECT_EQ(entries_of(folder / "there").size(), 1u);
}

/// Each removes the folder above them where it is empty.
TEST_F(OutputFolderTest, RunsInOneNewFolderDoNotDisturbEachOther) {
    open_at_once({folder / "out/a", folder / "out/b", folder / "out/c"}, false,
                 [](const Seen& seen) {
                     EXPECT_GT(seen.opened, 10);
                     EXPECT_EQ(seen.lockless + seen.in_use + seen.otherwise, 0) << seen.reason;
                 });
}

TEST_F(OutputFolderTest, WhatIsBeingWrittenGoesToo) {
    expect_nothing_stays(
        [](const fs::path& into, int i) { write_text(into / std::to_string(20 + i), "texels"); });
}

TEST_F(OutputFolderTest, WhatIsBeingRemovedGoesToo) {
    expect_nothing_stays([](const fs::path& into, int) {
        std::error_code ignored;
        fs::remove_all(into.parent_path(), ignored);
    });
}

TEST_F(OutputFolderTest, AFolderThatWasThereStays) {
    fs::create_directory(folder / "out");
    fs::create_directory_symlink("out", folder / "link");
    for (const char* name : {"out", "link"}) {
        {
            const OutputFolder output = open_output_folder(folder / name, Found::kRefused);
            write_text(output.unfinished / "scene.xml", "");
        }
        EXPECT_TRUE(fs::is_empty(folder / name)) << name;
    }
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
}

TEST_F(OutputFolderTest, WhatIsRefusedStaysAsItWas) {
    put("foreign/checkpoints/history.csv", kForeignHistory);
    put("foreign/checkpoints/compared/history.csv", kForeignHistory);
    put("full/checkpoints/history.csv", std::string(kHistoryStart));
    put("full/notes.txt", "mine");
    put("killed/.burnish-unfinished/lock", "");
    put("killed/.burnish-unfinished/render.exr", "half");
    put("killed/notes.txt", "mine");
    for (const char* name : {"foreign", "full", "killed"}) {
        expect_refused(name, Found::kEmpty);
        expect_refused(name, Found::kRefused);
        const auto before = content(name);
        EXPECT_EQ(run(std::string("optimize --resume ") + name).code, 65);
        EXPECT_EQ(run(std::string("reproduce derivatives -o ") + name).code, 73);
        EXPECT_EQ(content(name), before);
    }
    const auto before = content("foreign");
    { const OutputFolder output = open_output_folder(folder / "foreign", Found::kAllowed); }
    EXPECT_EQ(content("foreign"), before);
}

TEST_F(OutputFolderTest, WhatARunLeftThatWasKilledAtItsBeginningGoes) {
    for (const std::string text : {"", "iter", "iteration,seconds,loss\n1,0.1,0.5\n"}) {
        put("out/checkpoints/history.csv", text);
        { const OutputFolder output = open_output_folder(folder / "out", Found::kRefused); }
        EXPECT_TRUE(fs::is_empty(folder / "out")) << text;
    }
}

TEST_F(OutputFolderTest, AnEmptyOneHoldsNoResultsEither) {
    put("out/summary.json", R"({"burnish": "x", "files": []})");
    expect_refused("out", Found::kEmpty);
    EXPECT_NO_THROW(open_output_folder(folder / "out", Found::kRefused));
    put("killed/.burnish-unfinished/lock", "");
    EXPECT_NO_THROW(open_output_folder(folder / "killed", Found::kEmpty));
}

/// Another member of a group goes on with a run that was killed: the lock is opened for writing.
TEST_F(OutputFolderTest, TheUmaskDecidesWhoMayTakeTheLock) {
    for (const auto& [mask, expected] : {std::pair<mode_t, mode_t>{002, 0664}, {077, 0600}}) {
        const mode_t before = umask(mask);
        const OutputFolder output = open_output_folder(folder / "out", Found::kRefused);
        umask(before);
        struct stat status {};
        ASSERT_EQ(stat(lock_of("out").c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 0777, expected);
    }
}

TEST_F(OutputFolderTest, ALockThatCannotBeOpenedIsNamed) {
    fs::create_directories(lock_of("out"));
    try {
        open_output_folder(folder / "out", Found::kRefused);
        ADD_FAILURE() << "it was opened";
    } catch (const OutputError& error) {
        EXPECT_TRUE(contains(error.what(), "/lock: cannot be written: Is a directory"))
            << error.what();
    }
}

TEST_F(OutputFolderTest, FoldersThatWereMadeGo) {
    { const OutputFolder output = open_output_folder(folder / "a/b/c", Found::kRefused); }
    EXPECT_FALSE(fs::exists(folder / "a"));
    fs::create_directory(folder / "a");
    { const OutputFolder output = open_output_folder(folder / "a/b/c/", Found::kRefused); }
    EXPECT_TRUE(fs::is_empty(folder / "a"));
    EXPECT_NE(run("optimize missing.xml --parameter p -o made/b/c").code, 0);
    EXPECT_FALSE(fs::exists(folder / "made"));
    const Outcome outcome = run("optimize --resume no/such/folder");
    EXPECT_EQ(outcome.code, 65);
    EXPECT_TRUE(contains(outcome.err, "no/such/folder: found no checkpoint")) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "no"));
}

TEST_F(OutputFolderTest, LinksToFoldersAreRefused) {
    fs::create_directory(folder / "elsewhere");
    for (const std::string name : {".burnish-unfinished", "textures", "scene/textures",
                                   "scene/assets/a", "views/one", "checkpoints/compared"}) {
        const fs::path path = folder / "out" / name;
        fs::create_directories(path.parent_path());
        fs::create_directory_symlink(folder / "elsewhere", path);
        expect_refused("out", Found::kAllowed);
        fs::remove_all(folder / "out");
    }
    EXPECT_TRUE(fs::is_empty(folder / "elsewhere"));
}

TEST_F(OutputFolderTest, NothingIsWrittenOrRemovedThroughALink) {
    put("elsewhere/keep.txt", "mine");
    put("elsewhere/image.png", "mine");
    put("out/old/gone.txt", "");
    put("out/summary.json", R"({"burnish": "x", "files": ["data/keep.txt", "old/gone.txt"]})");
    fs::create_directory_symlink("../elsewhere", folder / "out/data");
    fs::create_directory(folder / "out/textures");
    fs::create_symlink("../../elsewhere/image.png", folder / "out/textures/image.png");
    {
        OutputFolder output = open_output_folder(folder / "out", Found::kRefused);
        fs::create_directory(output.unfinished / "textures");
        write_text(output.unfinished / "textures/image.png", "new");
        move_into_place(output);
    }
    EXPECT_EQ(read_text(folder / "elsewhere/keep.txt"), "mine");
    EXPECT_EQ(read_text(folder / "elsewhere/image.png"), "mine");
    EXPECT_EQ(read_text(folder / "out/textures/image.png"), "new");
    EXPECT_TRUE(fs::is_symlink(folder / "out/data"));
    EXPECT_FALSE(fs::exists(folder / "out/old"));
}

constexpr const char* kOntoItsInputs =
    "--parameter base_color --parameter roughness --spp 2 --evaluation-spp 4 --iterations 2 ";

/// Of all that a run writes: another name of a file that it reads lies there.
TEST_F(OutputFolderTest, NoResultReplacesAFileThatTheRunReads) {
    write_scene();
    std::string scene = read_text(folder / "scene.xml");
    const std::size_t begin = scene.find("  <sensor"), end = scene.find("  <bsdf");
    scene.insert(end, scene.substr(begin, end - begin));
    write_text(folder / "scene.xml", scene);
    write_text(folder / "LICENSE", "mine");
    const std::string command = std::string("optimize scene.xml --sensor 0 --sensor 1 ") +
                                "--compare mc --target-spp 4 " + kOntoItsInputs;
    ASSERT_EQ(run(command + "-o out").code, 0) << read_text(folder / ".err");
    std::size_t refused = 0;
    const auto summary = summary_of("out");
    for (const auto& name : summary["files"]) {
        const std::string file = "own/" + name.get<std::string>();
        fs::create_directories((folder / file).parent_path());
        fs::create_hard_link(folder / "color.exr", folder / file);
        const Outcome outcome = Program::expect_refused(
            command + "--force -o own", 73,
            file + ": is a file that this run reads: expected another folder");
        EXPECT_FALSE(contains(outcome.err, "recovering")) << "before anything is traced";
        fs::remove_all(folder / "own");
        ++refused;
    }
    EXPECT_GE(refused, 20u);
}

TEST_F(OutputFolderTest, PhotographsAndScenesAreNotReplacedByResults) {
    write_scene();
    ASSERT_EQ(run("render scene.xml -o render.exr --spp 4").code, 0);
    const std::string picture = read_text(folder / "render.exr");
    const auto command = [](const std::string& scene) {
        return "optimize " + scene + " " + kOntoItsInputs;
    };
    const std::string said = "is a file that this run reads: expected another folder";
    const std::string fit = command("scene.xml") + "--target render.exr --force -o ";
    Program::expect_refused(fit + ".", 73, "./render.exr: " + said);
    EXPECT_EQ(read_text(folder / "render.exr"), picture);
    fs::create_directory(folder / "linked");
    fs::create_symlink("../render.exr", folder / "linked/render.exr");
    EXPECT_EQ(run(fit + "linked").code, 0) << "the link is replaced";
    EXPECT_EQ(read_text(folder / "render.exr"), picture);
    ASSERT_EQ(run(command("scene.xml") + "-o out").code, 0);
    const auto before = content("out");
    Program::expect_refused(command("out/scene/scene.xml") + "--force -o out/scene", 73, said);
    EXPECT_EQ(content("out"), before);
    EXPECT_EQ(run(command("out/scene/scene.xml") + "-o out").code, 0)
        << "results of a run are replaced by those of the next";
}

/// Times of files say little: copies have others.
TEST_F(OutputFolderTest, ACheckpointThatResultsDoNotListIsOfAStoppedRun) {
    const fs::path checkpoint = folder / "out/checkpoints/0000000005.burnish";
    put("out/checkpoints/0000000005.burnish", "x");
    const auto put_summary = [&](const std::string& file, int seconds_later) {
        put("out/summary.json", R"({"burnish": "x", "files": [")" + file + R"("]})");
        fs::last_write_time(folder / "out/summary.json",
                            fs::last_write_time(checkpoint) + std::chrono::seconds(seconds_later));
    };
    put_summary("render.exr", 60);
    expect_refused("out", Found::kRefused);
    put_summary("checkpoints/0000000005.burnish", -60);
    expect_refused("out", Found::kRefused);
    put_summary("checkpoints/0000000005.burnish", 60);
    EXPECT_NO_THROW(open_output_folder(folder / "out", Found::kRefused));
}

TEST_F(OutputFolderTest, WhatIsNoCheckpointStaysBesideThem) {
    put("out/checkpoints/best.burnish", "mine");
    put("out/checkpoints/compared/0000000005 copy.burnish", "mine");
    const auto before = content("out");
    EXPECT_FALSE(holds_stopped_run(folder / "out", {}));
    expect_refused("out", Found::kRefused);
    put("out/checkpoints/0000000005.burnish", "x");
    EXPECT_TRUE(holds_stopped_run(folder / "out", {}));
    {
        OutputFolder output = open_output_folder(folder / "out", Found::kAllowed);
        clear_checkpoints(output);
    }
    EXPECT_EQ(content("out"), before);
}

TEST_F(OutputFolderTest, CheckpointsOfAnOlderRunGoWithTheFirstOfTheNewOne) {
    EXPECT_TRUE(open_output_folder(folder / "new", Found::kRefused).owns_checkpoints);
    const char* older[] = {"out/checkpoints/0000000000.burnish",
                           "out/checkpoints/0000000005.burnish",
                           "out/checkpoints/compared/0000000005.burnish"};
    for (const char* file : older) put(file, "x");
    OutputFolder output = open_output_folder(folder / "out", Found::kAllowed);
    EXPECT_FALSE(keeps_run(output)) << "they are of another run";
    for (const char* name : {"0000000001.burnish", "0000000002.burnish"}) {
        put(std::string("out/checkpoints/") + name, "y");
        take_checkpoints(output, output.checkpoints / name);
        EXPECT_TRUE(keeps_run(output));
        for (const char* file : older) EXPECT_FALSE(fs::exists(folder / file)) << file;
        EXPECT_TRUE(fs::exists(folder / "out/checkpoints/0000000001.burnish"));
    }
}

TEST_F(OutputFolderTest, ASummaryThatNoRunHasWrittenIsNone) {
    const auto is_one = [&](std::size_t arrays, std::size_t spaces) {
        put("out/summary.json", R"({"burnish": "\"[", "files": [], "asked": )" +
                                    std::string(arrays, '[') + std::string(arrays, ']') + "}" +
                                    std::string(spaces, ' '));
        return files_of_earlier_run(folder / "out").has_value();
    };
    EXPECT_TRUE(is_one(64, 1000));
    EXPECT_FALSE(is_one(65, 0));
    EXPECT_FALSE(is_one(400'000, 0));
    EXPECT_FALSE(is_one(1, std::size_t{64} << 20));
}

TEST_F(OutputFolderTest, NobodyWaitsForAPipe) {
    fs::create_directories(folder / "out/checkpoints");
    for (const char* name : {"summary.json", "checkpoints/0000000009.burnish"})
        ASSERT_EQ(mkfifo((folder / "out" / name).c_str(), 0600), 0);
    EXPECT_EQ(code_within_seconds("optimize -o out"), 73);
    EXPECT_EQ(code_within_seconds("optimize --resume out"), 65);
}

TEST(FolderNames, AreShortAndDifferFromEachOther) {
    const std::string path(300, 'a');
    std::vector<View> views(4);
    views[0].name = path + "/1.png", views[1].name = path + "/2.png";
    views[2].name = "cam/1", views[3].name = "cam_1";
    const std::vector<std::string> names = folder_names(views);
    EXPECT_EQ(names[0], std::string(200, 'a'));
    EXPECT_EQ(names[1], std::string(200, 'a') + "_2");
    EXPECT_EQ(names[2], "cam_1");
    EXPECT_EQ(names[3], "cam_1_2");
}

/// Where an earlier one has the ending's name by itself, too.
TEST(UniqueNames, DifferFromAllBefore) {
    const std::vector<std::string> given{"x_2", "x", "x", "y", "x_2"};
    EXPECT_EQ(unique_names(given), (std::vector<std::string>{"x_2", "x", "x_3", "y", "x_2_2"}));
}

}  // namespace
}  // namespace burnish
