// The folder of a run's results, where another thread is at work in it when the run ends.
#include "cli/output_folder.h"

#include <functional>
#include <thread>

#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class OutputFolderTest : public Program {
  protected:
    /// Runs of twenty files and a thread that works on them while they are removed. Nothing stays.
    void expect_nothing_stays(const std::function<void(const fs::path&, int)>& work) const {
        for (int run = 0; run < 100; ++run) {
            std::jthread worker;
            {
                const OutputFolder output = open_output_folder(folder / "out", Found::kRefused);
                const fs::path into = output.unfinished / "scenes" / "textures";
                fs::create_directories(into);
                for (int i = 0; i < 20; ++i) write_text(into / std::to_string(i), "texels");
                worker = std::jthread([&work, into] {
                    for (int i = 0; i < 20; ++i) work(into, i);
                });
            }
            EXPECT_FALSE(fs::exists(folder / "out")) << "run " << run;
        }
    }
};

TEST_F(OutputFolderTest, WhatIsBeingWrittenGoesToo) {
    expect_nothing_stays(
        [](const fs::path& into, int i) { write_text(into / std::to_string(20 + i), "texels"); });
}

TEST_F(OutputFolderTest, WhatIsBeingRemovedGoesToo) {
    expect_nothing_stays([](const fs::path& into, int) {
        std::error_code ignored;
        fs::remove_all(into.parent_path(), ignored);
    });
}

TEST_F(OutputFolderTest, AFolderThatWasThereStays) {
    fs::create_directory(folder / "out");
    fs::create_directory_symlink("out", folder / "link");
    for (const char* name : {"out", "link"}) {
        {
            const OutputFolder output = open_output_folder(folder / name, Found::kRefused);
            write_text(output.unfinished / "scene.xml", "");
        }
        EXPECT_TRUE(fs::is_empty(folder / name)) << name;
    }
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
}

TEST(FolderNames, AreShortAndDifferFromEachOther) {
    const std::string path(300, 'a');
    std::vector<View> views(4);
    views[0].name = path + "/1.png", views[1].name = path + "/2.png";
    views[2].name = "cam/1", views[3].name = "cam_1";
    const std::vector<std::string> names = folder_names(views);
    EXPECT_EQ(names[0], std::string(200, 'a'));
    EXPECT_EQ(names[1], std::string(200, 'a') + "_2");
    EXPECT_EQ(names[2], "cam_1");
    EXPECT_EQ(names[3], "cam_1_2");
}

}  // namespace
}  // namespace burnish
