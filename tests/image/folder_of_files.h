// What tests that read image files share: a folder of their own.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace burnish::test_files {

/// The folder is there for the time of a test.
struct FolderOfFiles : testing::Test {
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("burnish.image." + std::to_string(getpid()));
    FolderOfFiles() { std::filesystem::create_directories(folder); }
    ~FolderOfFiles() override { std::filesystem::remove_all(folder); }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        return folder / name;
    }
};

}  // namespace burnish::test_files
