// A folder for one test: files are written into it, scenes are loaded from it, and it goes away
// with the test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "error_of.h"
#include "mitsuba/load.h"

namespace burnish {

struct TemporaryFolder {
    std::filesystem::path path;

    TemporaryFolder() {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string(test->test_suite_name()) + "." + test->name();
        for (char& c : name)
            if (c == '/') c = '_';
        path = std::filesystem::temp_directory_path() /
               ("burnish." + name + "." + std::to_string(getpid()));
        std::filesystem::remove_all(path);
        std::filesystem::create_directories(path);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
};

inline std::filesystem::path write_text(const TemporaryFolder& folder, const std::string& name,
                                        const std::string& text) {
    const std::filesystem::path file = folder.path / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
}

inline std::string read_file_text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The scene that the children of <scene> describe, with an emitter, so that nothing needs a word.
inline LoadedScene load_text(const TemporaryFolder& folder, const std::string& children,
                             const LoadOptions& options = {}) {
    return load_scene(
        write_text(folder, "scene.xml", "<scene version=\"3.0.0\">\n" + children + "\n</scene>\n"),
        options);
}

/// Whether one of the lines holds the text.
inline bool mentions(const std::vector<std::string>& lines, const std::string& text) {
    return std::ranges::any_of(
        lines, [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

/// What load_scene says about a broken scene; empty where it loads.
inline std::string error_of(const std::filesystem::path& file, const LoadOptions& options = {}) {
    return test::error_of([&] { load_scene(file, options); });
}

}  // namespace burnish
