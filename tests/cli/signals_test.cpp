// SIGINT, SIGTERM, SIGHUP and SIGXCPU in every phase of a run: no lock and no unfinished file stays
// behind.
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "cli/interrupt.h"
#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class Signals : public Program {
  protected:
    static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

    /// Seconds of processor time of a program that runs.
    static double seconds_so_far(pid_t pid) {
        const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
        std::istringstream fields(stat.substr(stat.rfind(')') + 1));  // proc(5): from the third on
        std::string skipped;
        for (int i = 3; i < 14; ++i) fields >> skipped;
        double user = 0, system = 0;
        fields >> user >> system;
        return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
    }
    /// Waits until it has taken so many more.
    static bool works_for(double seconds, pid_t pid) {
        const double before = seconds_so_far(pid);
        return wait_for([&] { return seconds_so_far(pid) - before >= seconds; });
    }
    /// Its status, where a signal must end it within so many seconds: of processor time, which
    /// nothing else takes from it.
    static int end_within(double max, pid_t pid, int signal) {
        const double before = seconds_so_far(pid);
        kill(pid, signal);
        int status = -1;
        rusage usage{};
        EXPECT_EQ(wait4(pid, &status, 0, &usage), pid);
        EXPECT_LT(processor_seconds(usage) - before, max);
        return status;
    }
    /// The same of a run that goes on, by a signal that comes while its target renders. One whose
    /// target was rendered before, which a busy machine can bring about, says nothing: it is killed
    /// and begun again.
    int end_at_the_target(double max, int signal) const {
        const auto is_late = [&] { return contains(read_text(folder / ".err"), "recovering"); };
        for (int attempt = 0;; ++attempt) {
            const pid_t pid = start("optimize --resume out --threads 1");
            EXPECT_TRUE(wait_for_error_text("going on after"));
            pause();  // the target renders
            const double before = seconds_so_far(pid);
            kill(pid, signal);
            int status = -1;
            rusage usage{};
            bool ended = false;
            wait_for([&] {
                ended = ended || wait4(pid, &status, WNOHANG, &usage) == pid;
                return ended || is_late();
            });
            if (!ended) {
                kill(pid, SIGKILL);
                status = end_of(pid);
            }
            if (is_late() && attempt < 20) continue;
            EXPECT_TRUE(ended);
            EXPECT_LT(processor_seconds(usage) - before, max);
            return status;
        }
    }
};

constexpr const char* kRun = "optimize scene.xml --parameter base_color --spp 4 ";

TEST_F(Signals, BeforeTheIterationsNothingIsLeft) {
    write_scene();
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const pid_t pid = start(std::string(kRun) + "--target-spp 1048576 -o out");
        EXPECT_TRUE(wait_for([&] { return fs::exists(lock_of("out")); }));
        for (int i = 0; i < 10; ++i) pause();  // the target renders
        kill(pid, signal);
        const int status = end_of(pid);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
        EXPECT_FALSE(fs::exists(folder / "out"));
    }
}

TEST_F(Signals, BeforeTheIterationsARunThatGoesOnKeepsItsCheckpoint) {
    write_scene();
    const fs::path checkpoint = folder / "out/checkpoints/0000000001.burnish";
    const auto expect_suspended = [&](int status) {
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
        EXPECT_TRUE(contains(read_text(folder / ".err"), "--resume out"))
            << read_text(folder / ".err");
    };
    const pid_t first = start(std::string(kRun) +
                              "--target-spp 8192 --iterations 1 --evaluation-spp 1048576 -o out");
    EXPECT_TRUE(wait_for([&] { return fs::exists(checkpoint); }));
    for (int i = 0; i < 10; ++i) pause();
    expect_suspended(end_within(10, first, SIGTERM));
    const std::string before = read_text(checkpoint);
    for (const int signal : {SIGINT, SIGTERM}) {
        expect_suspended(end_at_the_target(10, signal));
        EXPECT_TRUE(read_text(checkpoint) == before);
        EXPECT_FALSE(fs::exists(lock_of("out").parent_path()));
    }
}

/// A search that would last for longer.
TEST_F(Signals, InTheSearchForTheStartNothingIsLeft) {
    write_scene();
    for (const int signal : {SIGINT, SIGTERM}) {
        const pid_t pid = start(std::string(kRun) +
                                "--size 768 768 --target-spp 1 --threads 1 --time 3600 -o out");
        EXPECT_TRUE(wait_for_error_text("optimising"));
        for (int i = 0; i < 5; ++i) pause();
        const int status = end_within(1, pid, signal);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
        EXPECT_FALSE(fs::exists(folder / "out"));
        const std::string text = read_text(folder / ".err");
        EXPECT_TRUE(contains(text, "keeps the results, once the start is found")) << text;
        EXPECT_TRUE(contains(text, "searched: nothing of this run is kept")) << text;
        fs::remove(folder / ".err");
    }
}

TEST_F(Signals, TheDemoSceneIsNotLeftEither) {
    const pid_t pid = start("optimize --target-spp 1048576 -o out");
    EXPECT_TRUE(wait_for([&] { return fs::exists(lock_of("out").parent_path() / "built-in"); }));
    kill(pid, SIGTERM);
    const int status = end_of(pid);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
    EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST_F(Signals, OneEndsTheIterationsAndKeepsTheResults) {
    write_scene();
    {
        const std::string out = "out";
        const pid_t pid = start(std::string(kRun) + "--init 0.5 --target-spp 16 " +
                                "--evaluation-spp 8 --time 3600 -o " + out);
        EXPECT_TRUE(wait_for([&] { return iterations_told(out) > 0; }));
        kill(pid, SIGINT);
        const int status = end_of(pid);
        ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << read_text(folder / ".err");
        EXPECT_FALSE(contains(read_text(folder / ".err"), "once the start is found"));
        const auto json = summary_of(out);
        EXPECT_EQ(json["result"]["ended_by"], "signal");
        const auto iterations = json["result"]["iterations"].get<std::ptrdiff_t>();
        EXPECT_GE(iterations, 1);
        const std::string history = read_text(folder / out / "history.csv");
        EXPECT_EQ(std::count(history.begin(), history.end(), '\n'), iterations + 1);
        for (const char* file : {"report.html", "render.exr", "target.exr",
                                 "textures/mat-panel.brdf_0.base_color.data.png"})
            EXPECT_TRUE(fs::exists(folder / out / file)) << file;
        EXPECT_TRUE(
            contains(read_text(folder / out / "report.html"), "s each, ended early by a signal<"));
        EXPECT_FALSE(fs::exists(lock_of(out)));
    }
}

/// The evaluation would last for hours: the first signal only asks to end.
TEST_F(Signals, TwoEndTheEvaluationAndKeepTheEarlierResults) {
    write_scene();
    const std::string quick = std::string(kRun) + "--target-spp 8 --iterations 1 -o out ";
    ASSERT_EQ(run(quick + "--evaluation-spp 8").code, 0);
    const std::string before = read_text(folder / "out/summary.json");
    const auto expect_kept = [&](pid_t pid) {
        const int status = end_of(pid);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
        EXPECT_TRUE(contains(read_text(folder / ".err"), "--resume out"))
            << read_text(folder / ".err");
        EXPECT_FALSE(fs::exists(lock_of("out").parent_path()));
        EXPECT_EQ(read_text(folder / "out/summary.json"), before);
    };
    const pid_t asked = start(quick + "--evaluation-spp 1048576");
    ASSERT_TRUE(
        wait_for([&] { return fs::exists(folder / "out/checkpoints/0000000001.burnish"); }));
    for (int i = 0; i < 10; ++i) pause();
    kill(asked, SIGINT);
    for (int i = 0; i < 25; ++i) pause();
    EXPECT_EQ(waitpid(asked, nullptr, WNOHANG), 0) << "one signal asks only";
    EXPECT_TRUE(fs::exists(lock_of("out")));
    kill(asked, SIGINT);
    expect_kept(asked);
    // The system does not wait, and nothing is lost.
    const pid_t told = start("optimize --resume out --evaluation-spp 1048576");
    EXPECT_TRUE(wait_for_error_text("optimising"));
    kill(told, SIGTERM);
    expect_kept(told);
    EXPECT_EQ(run("optimize --resume out --evaluation-spp 8").code, 0);
}

/// One that comes in the evaluation of the first of two runs. Where the second had begun before it
/// was sent, which a busy machine can bring about, both are begun again.
TEST_F(Signals, ASecondRunThatWasNotBegunIsMadeLater) {
    write_scene();
    const std::string arguments =
        std::string(kRun) + "--target-spp 8 --iterations 2 --compare mc --evaluation-spp 4096 ";
    const fs::path first = folder / "out/checkpoints/0000000002.burnish",
                   second = folder / "out/checkpoints/compared",
                   summary = folder / "out/summary.json";
    int status = -1;
    bool is_late = true;
    for (int attempt = 0; attempt < 20 && is_late; ++attempt) {
        fs::remove_all(folder / "out");
        const pid_t pid = start(arguments + "-o out");
        EXPECT_TRUE(wait_for([&] { return fs::exists(first) || fs::exists(summary); }));
        pause();
        kill(pid, SIGINT);
        is_late = fs::exists(second) || fs::exists(summary);
        status = end_of(pid);
    }
    ASSERT_FALSE(is_late);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << read_text(folder / ".err");
    EXPECT_TRUE(contains(read_text(folder / ".err"), "the second run was not begun"))
        << read_text(folder / ".err");
    const auto has_compared = [&] { return summary_of("out").contains("compared"); };
    EXPECT_FALSE(has_compared());
    EXPECT_EQ(summary_of("out")["settings"]["run"]["compare"], "none") << "what repeats it";
    EXPECT_EQ(run("optimize --resume out").code, 0);
    EXPECT_TRUE(has_compared());
    EXPECT_FALSE(fs::exists(folder / "out/checkpoints"));
}

/// Results are written within a fraction of a second: a run that ends unseen is begun once more.
TEST_F(Signals, OneThatComesAsResultsAreWrittenChangesNothing) {
    write_scene();
    const auto writes = [&] { return fs::exists(lock_of("out").parent_path() / "textures"); };
    int status = 0;
    bool was_asked = false;
    for (int attempt = 0; attempt < 20 && !was_asked; ++attempt) {
        fs::remove_all(folder / "out");
        const pid_t pid = start(std::string(kRun) +
                                "--size 128 128 --target-spp 1 --iterations 2 "
                                "--evaluation-spp 1 -o out");
        bool has_ended = false;
        while (!has_ended && !was_asked) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            if (writes()) was_asked = kill(pid, SIGTERM) == 0;
            if (!was_asked) has_ended = waitpid(pid, &status, WNOHANG) != 0;
        }
        if (was_asked) status = end_of(pid);
    }
    ASSERT_TRUE(was_asked);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    EXPECT_TRUE(fs::exists(folder / "out/report.html"));
    EXPECT_FALSE(contains(read_text(folder / ".err"), "--resume")) << read_text(folder / ".err");
}

/// An iteration that would last for minutes.
TEST_F(Signals, TheSystemEndsAnIterationInItsMidst) {
    write_scene();
    const std::string options = "--estimator mc --target-spp 8 --evaluation-spp 2 --spp ";
    for (const bool twice : {false, true}) {
        const pid_t pid = start("optimize scene.xml --parameter base_color --init 0.5 " +
                                std::string("--iterations 1 -o out ") + options + "1048576");
        EXPECT_TRUE(wait_for_error_text("optimising"));
        for (int i = 0; i < 25; ++i) pause();
        if (twice) {  // as `timeout` does
            kill(pid, SIGTERM);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        const int status = end_within(10, pid, SIGTERM);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
        EXPECT_TRUE(contains(read_text(folder / ".err"), "--resume out"))
            << read_text(folder / ".err");
        EXPECT_TRUE(fs::exists(folder / "out/checkpoints/0000000000.burnish"));
        fs::remove_all(folder / "out");
    }
}

/// The soft limit of processor time, a second of which is long over once the iteration has begun.
TEST_F(Signals, TheLimitOfProcessorTimeKeepsTheRun) {
    write_scene();
    const pid_t pid = start(
        "optimize scene.xml --parameter base_color --init 0.5 --estimator mc --target-spp 8 "
        "--evaluation-spp 2 --spp 1048576 --iterations 1 -o out");
    EXPECT_TRUE(wait_for_error_text("optimising"));
    for (int i = 0; i < 75; ++i) pause();
    rlimit limit{};
    EXPECT_EQ(prlimit(pid, RLIMIT_CPU, nullptr, &limit), 0);
    limit.rlim_cur = 1;
    EXPECT_EQ(prlimit(pid, RLIMIT_CPU, &limit, nullptr), 0);
    const int status = end_of(pid);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
    EXPECT_TRUE(contains(read_text(folder / ".err"), "--resume out")) << read_text(folder / ".err");
    EXPECT_TRUE(fs::exists(folder / "out/checkpoints/0000000000.burnish"));
}

/// The kernel sends SIGXCPU each second until the program has ended.
TEST_F(Signals, OneThatTheKernelRepeatsIsNotImpatient) {
    const pid_t pid = fork();
    if (pid == 0) {
        watch_signals();
        const InterruptGuard guard;
        for (const int signal : {SIGINT, SIGXCPU, SIGXCPU}) {
            kill(getpid(), signal);
            for (int i = 0; i < 15; ++i) pause();
        }
        _exit(interrupted_by_system() ? 0 : 1);
    }
    const int status = end_of(pid);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

/// The files that a reproduction keeps under a name.
std::set<fs::path> kept_files(const fs::path& folder, const std::string& name) {
    std::set<fs::path> files = entries_of(folder);
    std::erase_if(files, [&](const fs::path& file) {
        return !file.filename().string().starts_with(name + "-");
    });
    return files;
}

TEST_F(Signals, AStoppedReproductionGoesOn) {
    const std::string command =
        "reproduce derivatives equal-error -o r --scene goblet --size 32 32 --time-scale 0.05";
    const auto is_kept = [&](const char* part) {
        return !kept_files(folder / "r.kept", part).empty();
    };
    const pid_t pid = start(command);
    EXPECT_TRUE(wait_for([&] { return is_kept("goblet-derivative"); }));
    EXPECT_TRUE(works_for(0.05, pid)) << "the first part has begun";
    kill(pid, SIGINT);
    const int status = end_of(pid);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
    EXPECT_TRUE(is_kept("goblet-derivatives"));
    EXPECT_FALSE(is_kept("goblet-equal-error"));
    EXPECT_FALSE(contains(read_text(folder / "r/results.csv"), "equal-error"));
    const char* stopped = "stopped with 1 of 2 parts done: the same command goes on";
    for (const char* file : {".err", "r/index.html", "r/results.json"})
        EXPECT_TRUE(contains(read_text(folder / file), stopped)) << file;
    EXPECT_EQ(end_of(start(command)), 0);
    for (const char* file : {".err", "r/index.html", "r/results.json"})
        EXPECT_FALSE(contains(read_text(folder / file), stopped)) << file;
    EXPECT_TRUE(is_kept("goblet-equal-error"));
    EXPECT_TRUE(contains(read_text(folder / "r/results.csv"), "equal-error"));
    EXPECT_TRUE(contains(read_text(folder / "r/results.csv"), "derivatives"));
}

/// A signal waits for the target or the converged derivative that is under way, and no longer.
/// Where that was done before it was heard, which a busy machine can bring about, all is begun
/// again.
TEST_F(Signals, AReproductionBeginsNoPartAfterOne) {
    const auto is_kept = [&](const char* what) {
        return !kept_files(folder / "r.kept", what).empty();
    };
    const auto stop = [&](const std::function<bool(pid_t)>& has_begun, const char* what,
                          const char* next) {
        int status = -1, begun = 0;
        bool is_late = true;
        for (int attempt = 0; attempt < 20 && is_late; ++attempt) {
            for (const char* made : {"r", "r.kept"}) fs::remove_all(folder / made);
            const pid_t pid =
                start("reproduce derivatives -o r --scene goblet --size 96 96 --time-scale 0.05");
            EXPECT_TRUE(has_begun(pid));
            kill(pid, SIGINT);
            is_late = is_kept(what);
            status = end_of(pid);
            begun += !is_late && is_kept(next);
            is_late = is_late || is_kept(next);
        }
        EXPECT_LE(begun, 3) << next;
        ASSERT_FALSE(is_late) << what;
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
        EXPECT_TRUE(is_kept(what)) << what;
    };
    const fs::path scene = lock_of("r").parent_path() / "scenes";
    const auto has_target = [&] { return is_kept("goblet-target"); };
    stop([&](pid_t) { return wait_for([&] { return fs::exists(scene) || has_target(); }); },
         "goblet-target", "goblet-derivative");
    stop([&](pid_t pid) { return wait_for(has_target) && works_for(0.05, pid); },
         "goblet-derivative", "goblet-derivatives");
    EXPECT_FALSE(fs::exists(folder / "r"));
}

TEST_F(Signals, AReproductionGoesOnWithinAScene) {
    const std::string command =
        "reproduce inverse -o r --scene goblet --size 32 32 --time-scale 0.2";
    const auto runs = [&] { return kept_files(folder / "r.kept", "goblet-run"); };
    const pid_t pid = start(command);
    EXPECT_TRUE(wait_for([&] { return runs().size() >= 2; }));
    const int status = end_within(10, pid, SIGTERM);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
    EXPECT_TRUE(contains(read_text(folder / ".err"), "the same command goes on"));
    EXPECT_FALSE(fs::exists(folder / "r"));

    const std::set<fs::path> before = runs();
    ASSERT_LT(before.size(), 25u) << "five methods, five runs each";
    std::map<fs::path, std::string> bytes;
    for (const fs::path& file : before) bytes[file] = read_text(file);
    EXPECT_EQ(end_of(start(command)), 0);
    EXPECT_EQ(runs().size(), 25u);
    for (const fs::path& file : before)
        EXPECT_TRUE(bytes[file] == read_text(file)) << file << " was made again";
    EXPECT_TRUE(contains(read_text(folder / "r/results.csv"), "path cache, run 4"));
}

TEST_F(Signals, AReproductionGoesOnBetweenEstimates) {
    const std::string command =
        "reproduce ablation -o r --scene goblet --size 32 32 --time-scale 0.01";
    const auto estimates = [&](const char* kind) {
        std::set<fs::path> files;
        for (const fs::path& part : kept_files(folder / "r.kept", "goblet-ablation-unfinished"))
            for (const fs::path& file : kept_files(part, kind)) files.insert(file);
        return files;
    };
    const auto stop = [&](int signal, const char* kind, std::size_t count) {
        const pid_t pid = start(command);
        EXPECT_TRUE(wait_for([&] { return estimates(kind).size() >= count; }));
        const int status = end_within(10, pid, signal);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
        EXPECT_TRUE(contains(read_text(folder / ".err"), "goes on with what is kept in r.kept"));
        EXPECT_FALSE(fs::exists(folder / "r"));
    };
    stop(SIGINT, "estimate", 2);
    const std::set<fs::path> first = estimates("estimate");
    std::map<fs::path, std::string> bytes;
    for (const fs::path& file : first) bytes[file] = read_text(file);
    stop(SIGTERM, "estimate", first.size() + 2);
    stop(SIGTERM, "derivative", 1);
    for (const fs::path& file : estimates("derivative")) bytes[file] = read_text(file);
    stop(SIGTERM, "estimate", estimates("estimate").size() + 1);
    for (const auto& [file, text] : bytes)
        EXPECT_TRUE(text == read_text(file)) << file << " was made again";
    EXPECT_EQ(end_of(start(command)), 0);
    EXPECT_TRUE(estimates("estimate").empty());
    EXPECT_EQ(kept_files(folder / "r.kept", "goblet-ablation").size(), 1u);
    EXPECT_TRUE(contains(read_text(folder / "r/results.csv"), "M_cap 4"));
}

TEST_F(Signals, AReproductionGoesOnWithinARun) {
    const std::string command =
        "reproduce inverse -o r --scene goblet --size 32 32 --time-scale 100 --force";
    fs::create_directory(folder / "r");
    write_text(folder / "r/index.html", "earlier");
    const auto checkpoints = [&] {
        std::set<std::string> names;
        for (const fs::path& run : kept_files(folder / "r.kept", "goblet-unfinished"))
            for (const fs::path& file : checkpoints_in(run)) names.insert(file.filename());
        return names;
    };
    const auto stop_within_a_run = [&] {
        const pid_t pid = start(command);
        EXPECT_TRUE(wait_for([&] { return contains(read_text(folder / ".err"), "run 1 of 5"); }));
        EXPECT_TRUE(works_for(1, pid)) << "for several iterations";
        const int status = end_within(10, pid, SIGINT);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
        EXPECT_TRUE(contains(read_text(folder / ".err"), "goes on with what is kept in r.kept"));
        EXPECT_EQ(read_text(folder / "r/index.html"), "earlier");
        EXPECT_FALSE(fs::exists(lock_of("r").parent_path()));
        EXPECT_EQ(kept_files(folder / "r.kept", "goblet-run").size(), 0u) << "none is complete";
    };
    stop_within_a_run();
    const std::set<std::string> first = checkpoints();
    ASSERT_EQ(first.size(), 1u);
    stop_within_a_run();
    const std::set<std::string> second = checkpoints();
    ASSERT_EQ(second.size(), 2u);
    EXPECT_EQ(*second.begin(), *first.begin()) << "it began again";
}

TEST_F(Signals, AReproductionOfWhichNothingIsKeptSaysSo) {
    // Its target takes minutes.
    const pid_t pid = start("reproduce derivatives -o r --scene goblet --full");
    EXPECT_TRUE(wait_for([&] { return fs::exists(lock_of("r")); }));
    EXPECT_TRUE(works_for(1, pid));
    const int status = end_within(10, pid, SIGTERM);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 75) << status;
    const std::string text = read_text(folder / ".err");
    EXPECT_TRUE(contains(text, "before anything was kept: the same command begins again")) << text;
    EXPECT_FALSE(contains(text, "goes on with what is kept")) << text;
    EXPECT_FALSE(fs::exists(folder / "r.kept"));
}

TEST_F(Signals, ReproduceLeavesNothing) {
    const pid_t pid = start("reproduce derivatives -o r --scene goblet --size 64 64");
    EXPECT_TRUE(wait_for([&] { return fs::exists(lock_of("r")); }));
    for (int i = 0; i < 10; ++i) pause();
    kill(pid, SIGTERM);
    for (int i = 0; i < 15; ++i) pause();
    kill(pid, SIGTERM);
    const int status = end_of(pid);
    EXPECT_TRUE((WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) ||
                (WIFEXITED(status) && WEXITSTATUS(status) == 75))
        << status;
    EXPECT_FALSE(fs::exists(lock_of("r").parent_path()));
}

}  // namespace
}  // namespace burnish
