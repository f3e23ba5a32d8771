// A folder for the checkpoints of a test.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "burnish/checkpoint.h"
#include "temporary_folder.h"

namespace burnish::test {

/// Checkpoints after each iteration.
struct CheckpointFolder : ::testing::Test {
    CheckpointFolder() { checkpoints.folder = (folder / "c").string(), checkpoints.seconds = 0; }

    TemporaryFolder temporary;
    std::filesystem::path folder = temporary.path;
    Checkpoints checkpoints;
};

}  // namespace burnish::test
