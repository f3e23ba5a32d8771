// Scenes in a folder of a test: files are written into it, scenes are loaded from it.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "error_of.h"
#include "mitsuba/load.h"
#include "temporary_folder.h"

namespace burnish {

using test::TemporaryFolder;

inline std::filesystem::path write_text(const TemporaryFolder& folder, const std::string& name,
                                        const std::string& text) {
    const std::filesystem::path file = folder.path / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
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
