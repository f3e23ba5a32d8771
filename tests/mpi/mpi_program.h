// burnish-mpi under mpirun, as people run it.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cli/program.h"

namespace burnish::testing {

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

    /// More than any run makes before its test stops it, however busy the machine is.
    static constexpr int kEndless = 10000000;

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
    Outcome run_on(int count, const std::string& arguments) const {
        return shell(mpirun(count) + arguments);
    }
    /// In the background; standard error goes to `.err`.
    pid_t start_on(int count, const std::string& arguments) const {
        return start_shell(mpirun(count) + arguments);
    }
    /// All files that depend on no time hold the same bytes.
    void expect_same(const std::string& a, const std::string& b, std::size_t files = 16) const {
        EXPECT_GE(expect_same_files(folder / a, folder / b), files);
        const auto summary = [&](const std::string& out) {
            auto json = summary_of(out);
            for (const char* key : {"seconds", "peak_memory_bytes", "processes"}) json.erase(key);
            for (const char* run : {"result", "compared"}) {
                if (!json.contains(run)) continue;
                json[run].erase("seconds");
                if (json[run].contains("search")) json[run]["search"].erase("seconds");
            }
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
    /// Waits until processes that were killed have ended: they may hold a lock for a moment.
    static void wait_for_end(const std::vector<pid_t>& processes) {
        EXPECT_TRUE(wait_for([&] {
            return std::none_of(processes.begin(), processes.end(), [](pid_t pid) {
                if (pid == 0) return false;  // it was not found
                const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
                return !stat.empty() && stat[stat.rfind(')') + 2] != 'Z';
            });
        }));
    }
    /// Makes the folder "other", in which all that is there is found but what is named.
    void link_into_other(std::set<fs::path> left_out) const {
        fs::create_directory(folder / "other");
        left_out.insert("other");
        for (const auto& entry : fs::directory_iterator(folder))
            if (const fs::path name = entry.path().filename(); !left_out.contains(name))
                fs::create_symlink(entry.path(), folder / "other" / name);
    }
    /// Some more than its newest checkpoint has made.
    int iterations_beyond(const std::string& out) const {
        const std::vector<fs::path> files = checkpoints_in(folder / out / "checkpoints");
        EXPECT_FALSE(files.empty()) << read_text(folder / ".err");
        return 20 + (files.empty() ? 0 : std::stoi(files.back().filename().string()));
    }
    bool has_checkpoint(const std::string& out) const {
        return !checkpoints_in(folder / out / "checkpoints").empty();
    }
};

}  // namespace burnish::testing
