// What tests that read image files share: a folder of their own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "temporary_folder.h"

namespace burnish::test_files {

/// The folder is there for the time of a test.
struct FolderOfFiles : testing::Test {
    test::TemporaryFolder temporary;
    std::filesystem::path folder = temporary.path;

    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        return folder / name;
    }
};

}  // namespace burnish::test_files
