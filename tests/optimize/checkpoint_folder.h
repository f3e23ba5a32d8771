// Folders that go with a test, and one for its checkpoints.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "burnish/checkpoint.h"

namespace burnish::test {

struct TemporaryFolder {
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "burnish-XXXXXX").string();
        folder = mkdtemp(name.data());
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() { std::filesystem::remove_all(folder); }

    std::filesystem::path folder;
};

/// Checkpoints after each iteration.
struct CheckpointFolder : ::testing::Test, TemporaryFolder {
    CheckpointFolder() { checkpoints.folder = (folder / "c").string(), checkpoints.seconds = 0; }

    Checkpoints checkpoints;
};

}  // namespace burnish::test
