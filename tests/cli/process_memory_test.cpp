// Limits of control groups, in folders as the system has them.
#include "cli/process_memory.h"

#include <limits>

#include "cli/program.h"

namespace burnish {
namespace {

struct ControlGroups : testing::Program {
    void put(const std::string& file, const std::string& text) const {
        std::filesystem::create_directories((folder / file).parent_path());
        testing::write_text(folder / file, text);
    }
};

TEST_F(ControlGroups, OfVersion2TheLowestOfTheGroupAndThoseAboveItLimits) {
    const std::string groups = "0::/job/step\n";
    EXPECT_EQ(control_group_limit(folder, groups), std::numeric_limits<double>::infinity());
    put("job/step/memory.max", "max\n");
    put("other/memory.max", "1000\n");
    EXPECT_EQ(control_group_limit(folder, groups), std::numeric_limits<double>::infinity());
    put("memory.max", "9000\n");
    EXPECT_EQ(control_group_limit(folder, groups), 9000);
    put("job/memory.max", "7000\n");
    EXPECT_EQ(control_group_limit(folder, groups), 7000);
    put("job/step/memory.max", "5000\n");
    EXPECT_EQ(control_group_limit(folder, groups), 5000);
    EXPECT_EQ(control_group_limit(folder, "0::/\n"), 9000);
}

TEST_F(ControlGroups, OfVersion1TheFolderOfItsMemoryLimits) {
    const std::string groups =
        "12:cpu,cpuacct:/slurm/job_1\n5:hugetlb,memory:/slurm/job_1/step_0\n0::/slurm\n";
    put("memory/memory.limit_in_bytes", "9223372036854771712\n");
    put("memory/slurm/memory.limit_in_bytes", "8000\n");
    EXPECT_EQ(control_group_limit(folder, groups), 8000);
    put("memory/slurm/job_1/memory.limit_in_bytes", "6000\n");
    EXPECT_EQ(control_group_limit(folder, groups), 6000);
    put("memory/slurm/job_1/step_0/memory.limit_in_bytes", "4000\n");
    EXPECT_EQ(control_group_limit(folder, groups), 4000);
    EXPECT_GT(control_group_limit(folder, "5:memory:/\n"), 9e18);
    EXPECT_EQ(control_group_limit(folder, "7:memory_other:/slurm\nno group\n"),
              std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace burnish
