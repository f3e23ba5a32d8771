// The search for the start, as `burnish optimize` begins, repeats and compares it.
#include <nlohmann/json.hpp>

#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class SearchedStart : public Program {
  protected:
    SearchedStart() { write_scene(); }

    nlohmann::json summary(const std::string& out) const {
        return nlohmann::json::parse(read_text(folder / out / "summary.json"));
    }
};

/// What a scene file has in the place of an unknown with a start of its own is not known.
TEST_F(SearchedStart, KnowsOtherUnknownsAsTheyStart) {
    ASSERT_EQ(run("render scene.xml --spp 64 -o target.exr").code, 0);
    const auto found = [&](float in_file) {
        write_image(folder / "color.exr", make_image(8, 8, 3, in_file));
        const Outcome outcome =
            run("optimize scene.xml --target target.exr --parameter base_color --parameter "
                "roughness --init 0.4 --init search --iterations 1 --evaluation-spp 8 --force -o "
                "out");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return summary("out")["result"]["search"]["groups"];
    };
    const auto first = found(0.9f);
    ASSERT_FALSE(first.empty());
    EXPECT_EQ(first, found(0.1f));
}

/// A long run searches with more samples, which its number of iterations does not tell.
TEST_F(SearchedStart, OfALongRunIsRepeatedAndComparedWith) {
    const std::string command =
        "optimize scene.xml --parameter roughness --spp 2 --target-spp 16 --evaluation-spp 8 "
        "--iterations 2 ";
    ASSERT_EQ(run(command + "--time 240 --compare mc -o long").code, 0);
    ASSERT_EQ(run(command + "-o short").code, 0);
    ASSERT_EQ(run("optimize --options long/summary.json -o again").code, 0);
    EXPECT_EQ(summary("long")["settings"]["search_effort"], 4);
    const auto groups = [&](const char* out, const char* of) {
        return summary(out)[of]["search"]["groups"];
    };
    ASSERT_FALSE(groups("long", "result").empty());
    EXPECT_NE(groups("short", "result"), groups("long", "result"));
    EXPECT_EQ(groups("long", "compared"), groups("long", "result"));
    EXPECT_EQ(groups("again", "result"), groups("long", "result"));
    expect_same_files(folder / "long", folder / "again");
}

}  // namespace
}  // namespace burnish
