// A folder for the checkpoints of a test.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "burnish/checkpoint.h"

namespace burnish::test {

/// Checkpoints after each iteration, in a folder of its own, which goes with the test.
struct CheckpointFolder : ::testing::Test {
    CheckpointFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "burnish-XXXXXX").string();
        folder = mkdtemp(name.data());
        checkpoints.folder = (folder / "c").string(), checkpoints.seconds = 0;
    }
    ~CheckpointFolder() override { std::filesystem::remove_all(folder); }

    std::filesystem::path folder;
    Checkpoints checkpoints;
};

}  // namespace burnish::test
