// Runs the program as people do, on tiny scenes that the test writes.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>

#include "file_bytes.h"
#include "image/image.h"
#include "optimize/checkpoint.h"
#include "temporary_folder.h"

namespace burnish::testing {

namespace fs = std::filesystem;

struct Outcome {
    int code = -1;
    std::string out, err;
};

inline std::string read_text(const fs::path& file) { return test::bytes_of(file); }

/// Seconds of processor time.
inline double processor_seconds(const rusage& usage) {
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

inline void write_text(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

/// What is in a folder that another process may make and remove meanwhile; empty: it is not there.
inline std::set<fs::path> entries_of(const fs::path& folder) {
    std::set<fs::path> entries;
    std::error_code error;
    fs::directory_iterator entry(folder, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error))
        entries.insert(entry->path());
    return entries;
}

/// What a run has written about itself into its folder.
inline nlohmann::json summary_in(const fs::path& folder) {
    return nlohmann::json::parse(read_text(folder / "summary.json"));
}

/// Waits until it holds, for a minute at most.
inline bool wait_for(const std::function<bool()>& holds) {
    for (int i = 0; i < 6000 && !holds(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return holds();
}

/// The status that a process has ended with.
inline int end_of(pid_t pid) {
    int status = -1;
    EXPECT_EQ(waitpid(pid, &status, 0), pid);
    return status;
}

/// A pipe that is full: who writes into it waits until this is drained.
class FullPipe {
  public:
    explicit FullPipe(const fs::path& file) {
        EXPECT_EQ(mkfifo(file.c_str(), 0600), 0);
        end_ = open(file.c_str(), O_RDWR | O_NONBLOCK);
        EXPECT_GE(end_, 0);
        std::string bytes(4096, ' ');
        for (const std::size_t size : {bytes.size(), std::size_t{1}})
            while (write(end_, bytes.data(), size) > 0) {
            }
    }
    ~FullPipe() { close(end_); }
    FullPipe(const FullPipe&) = delete;
    FullPipe& operator=(const FullPipe&) = delete;

    /// The status of a process that writes into it until it ends, within a minute.
    int drain_until_end_of(pid_t process) const {
        int status = -1;
        bool ended = false;
        std::string bytes(4096, ' ');
        EXPECT_TRUE(wait_for([&] {
            while (read(end_, bytes.data(), bytes.size()) > 0) {
            }
            ended = ended || waitpid(process, &status, WNOHANG) == process;
            return ended;
        }));
        return status;
    }

  private:
    int end_ = -1;
};

/// Whether that file of a run holds times.
inline bool is_timed(const std::string& name) {
    return name == "summary.json" || name == "report.html" || name == "history.csv" ||
           name == "history_compared.csv";
}

/// Two runs have files of the same names, and those that hold no time have the same bytes. Returns
/// the number of the latter.
inline std::size_t expect_same_files(const fs::path& a, const fs::path& b) {
    const auto of_a = test::contents(a), of_b = test::contents(b);
    for (const auto& [name, bytes] : of_b)
        EXPECT_TRUE(of_a.contains(name)) << name << " is in " << b << " alone";
    std::size_t compared = 0;
    for (const auto& [name, bytes] : of_a) {
        const auto other = of_b.find(name);
        if (other == of_b.end()) {
            ADD_FAILURE() << name << " is in " << a << " alone";
        } else if (!is_timed(name)) {
            ++compared;
            EXPECT_TRUE(bytes == other->second) << name;
        }
    }
    return compared;
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// "--max-memory 0.062", where a message names a limit that is enough; otherwise empty.
inline std::string named_limit(const std::string& text) {
    const std::string option = "--max-memory ";
    for (std::size_t at = text.find(option); at != std::string::npos;
         at = text.find(option, at + 1))
        if (const std::size_t number = at + option.size();
            std::isdigit(static_cast<unsigned char>(text[number])))
            return text.substr(at, text.find(' ', number) - at);
    return {};
}

/// A folder that lasts as long as the test.
class Program : public ::testing::Test {
    test::TemporaryFolder temporary_;

  protected:
    /// A line of the shell, in the folder. What its last command writes goes to the files `.out`
    /// and `.err`; several are one in brackets.
    Outcome shell(const std::string& line) const {
        const int status = std::system(in_folder(line).c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(folder / ".out"),
                read_text(folder / ".err")};
    }
    /// The program, with arguments that pass through the shell.
    Outcome run(const std::string& arguments) const { return shell(program_ + arguments); }
    /// Permissions do not bind root: where root runs the test, another user runs the program from
    /// here on, to whom the folder and all in it then belong. False: that user cannot run it.
    bool drop_root() {
        if (geteuid() != 0) return true;
        program_ = "setpriv --reuid=65534 --regid=65534 --clear-groups " + program_;
        const std::string scene = "'" + (folder / "scene.xml").string() + "'";
        return shell("chown -R 65534:65534 . && " + program_ + "info " + scene).code == 0;
    }

    /// Runs the program, which ends with that status and a message that holds that text.
    Outcome expect_refused(const std::string& arguments, int code, const std::string& text) const {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, code) << arguments << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, text))
            << arguments << ": expected " << text << ", found " << outcome.err;
        return outcome;
    }

    /// The most bytes of memory that the program takes, which ends with that status. What ran the
    /// program counts, too: compare it with that of another run.
    double peak_of(const std::string& arguments, int code) const {
        rusage usage{};
        int status = -1;
        const pid_t pid = start(arguments);
        EXPECT_EQ(wait4(pid, &status, 0, &usage), pid);
        EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, code) << read_text(folder / ".err");
        return 1024.0 * static_cast<double>(usage.ru_maxrss);
    }

    /// One command in the background; the file `.err` is there once it has begun.
    pid_t start_shell(const std::string& line) const {
        const std::string command = in_folder("exec " + line);
        fs::remove(folder / ".err");
        const pid_t pid = fork();
        if (pid == 0) {
            std::signal(SIGHUP, SIG_DFL);  // also under nohup
            execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            _exit(127);
        }
        return pid;
    }
    pid_t start(const std::string& arguments) const { return start_shell(program_ + arguments); }
    bool wait_for_error_text(const char* text) const {
        return wait_for([&] { return contains(read_text(folder / ".err"), text); });
    }
    /// Runs the program, sends it a signal once that holds, and returns the status that it ended
    /// with. Where the run in the folder `out` was done before the signal came, which a busy
    /// machine can bring about, what it wrote is undone and it begins again.
    int stop_once(const std::function<bool()>& holds, const std::string& arguments,
                  const std::string& out, int signal) const {
        const fs::path results = folder / *fs::path(out).begin(), before = folder / ".before",
                       summary = folder / out / "summary.json";
        const auto replace = [](const fs::path& from, const fs::path& to) {
            fs::remove_all(to);
            if (fs::exists(from)) fs::copy(from, to, fs::copy_options::recursive);
        };
        replace(results, before);
        for (int attempt = 0;; ++attempt) {
            const pid_t pid = start(arguments);
            EXPECT_TRUE(wait_for([&] { return holds() || fs::exists(summary); }))
                << read_text(folder / ".err");
            kill(pid, signal);
            const int status = end_of(pid);
            const bool done =
                fs::exists(summary) && summary_of(out)["result"]["ended_by"] == "iterations";
            if (!done || attempt == 20) return status;
            replace(before, results);
        }
    }
    nlohmann::json summary_of(const std::string& out) const { return summary_in(folder / out); }
    /// The file that a run keeps locked until its results are there.
    fs::path lock_of(const std::string& out) const {
        return folder / out / ".burnish-unfinished" / "lock";
    }
    /// The iteration that a run has written down last; 0: none yet, -1: it has not begun to. Of a
    /// long run not all rows stay.
    int iterations_told(const std::string& out,
                        const std::string& checkpoints = "checkpoints") const {
        std::ifstream file(folder / out / checkpoints / "history.csv",
                           std::ios::binary | std::ios::ate);
        if (!file) return -1;
        constexpr std::streamoff kEnd = 4096;  // bytes, more than two rows have
        file.seekg(std::max<std::streamoff>(0, file.tellg() - kEnd));
        const std::string text(std::istreambuf_iterator<char>(file), {});
        const std::size_t end = text.rfind('\n');
        if (end == std::string::npos) return -1;
        const std::size_t before = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
        return before == std::string::npos ? 0 : std::atoi(text.c_str() + before + 1);
    }

    /// A square with two textures, seen from the front under an area light; 24 x 24 pixels, box
    /// filter.
    void write_scene() const {
        Image roughness = make_image(8, 8, 1), color = make_image(8, 8, 3);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                roughness.at(x, y, 0) = 0.3f + 0.05f * static_cast<float>(x);
                for (int c = 0; c < 3; ++c)
                    color.at(x, y, c) = (x / 4 + y / 4 + c) % 2 == 0 ? 0.2f : 0.7f;
            }
        write_image(folder / "roughness.exr", roughness);
        write_image(folder / "color.exr", color);
        write_text(folder / "scene.xml", R"(<scene version="3.0.0">
  <default name="light" value="6"/>
  <integrator type="direct"/>
  <sensor type="perspective">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0,0,3" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/>
      <rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="8"/></sampler>
  </sensor>
  <bsdf type="twosided" id="mat-panel">
    <bsdf type="principled">
      <texture type="bitmap" name="base_color"><string name="filename" value="color.exr"/>
        <string name="filter_type" value="nearest"/></texture>
      <texture type="bitmap" name="roughness"><string name="filename" value="roughness.exr"/>
        <boolean name="raw" value="true"/><string name="filter_type" value="nearest"/></texture>
    </bsdf>
  </bsdf>
  <shape type="rectangle" id="panel"><ref id="mat-panel"/></shape>
  <shape type="rectangle" id="lamp">
    <transform name="to_world"><scale value="0.8"/><rotate x="1" angle="140"/>
      <translate x="0.3" y="1.6" z="2"/></transform>
    <emitter type="area"><rgb name="radiance" value="$light"/></emitter>
  </shape>
</scene>
)");
    }

    fs::path folder = temporary_.path;

  private:
    std::string program_ = "'" BURNISH_BINARY "' ";
    std::string in_folder(const std::string& line) const {
        return "cd '" + folder.string() + "' && " + line + " >.out 2>.err </dev/null";
    }
};

}  // namespace burnish::testing
