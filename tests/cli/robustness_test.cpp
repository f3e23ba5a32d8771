// What people mistype, what files can hold that nobody means, and outputs that fail.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "cli/console.h"
#include "cli/program.h"
#include "scene/parameter_names.h"

namespace burnish {
namespace {

using namespace testing;

TEST(Suggestion, IsTheNearestNameWhereOneIsNear) {
    const std::vector<std::string> names{"--iterations", "--size", "--seed", "--spp"};
    const auto nearest = [&](const std::string& written) { return nearest_name(written, names); };
    EXPECT_EQ(nearest("--iteration"), "--iterations");
    EXPECT_EQ(nearest("--iterationss"), "--iterations");
    EXPECT_EQ(nearest("--sied"), "--seed");
    EXPECT_EQ(nearest("--szie"), "--size");
    EXPECT_EQ(nearest("--texture"), "");
    EXPECT_EQ(nearest(""), "");
}

TEST(Printable, LeavesNothingToATerminalButText) {
    EXPECT_EQ(printable("a\x1b[31mb\x07"), "a\\x1b[31mb\\x07");
    EXPECT_EQ(printable("two\n\tlines"), "two\n\tlines");
    EXPECT_EQ(printable("\x7f"), "\\x7f");
    EXPECT_EQ(printable("\xc2\x9b"
                        "2J \xc3\xa9"),
              "\\x9b2J \xc3\xa9");
}

struct Robustness : Program {
    Robustness() { write_scene(); }

    /// The scene with a text replaced.
    void replace(const std::string& text, const std::string& by) const {
        std::string scene = read_text(folder / "scene.xml");
        ASSERT_TRUE(contains(scene, text));
        scene.replace(scene.find(text), text.size(), by);
        write_text(folder / "scene.xml", scene);
    }
};

TEST_F(Robustness, WhatIsMistypedIsGuessed) {
    const std::pair<const char*, const char*> cases[] = {
        {"render scene.xml --size 64", "--size: expected 2 values, W H"},
        {"render scene.xml --spp", "--spp: expected 1 value, N"},
        {"optimise scene.xml", "'optimise' is no command of burnish: did you mean optimize?"},
        {"optimize scene.xml --iteration 5 -o out",
         "'--iteration' is no option of burnish optimize: did you mean --iterations?"},
        {"render scene.xml --tread=2 -o a.exr", "did you mean --threads?"},
        {"render scene.xml --xyzzy -o a.exr", "'--xyzzy' is no option of burnish render (see"},
        {"render scene.xml other.xml -o a.exr", "'other.xml' is no argument of burnish render"}};
    for (const auto& [arguments, text] : cases) expect_refused(arguments, 2, text);
}

TEST_F(Robustness, OutputThatDoesNotArriveIsAnErrorUnlessNobodyReadsIt) {
    const Outcome full = shell("('" BURNISH_BINARY "' info scene.xml >/dev/full)");
    EXPECT_EQ(full.code, 74);
    EXPECT_TRUE(contains(full.err, "standard output cannot be written: No space left"));
    for (const char* help : {"--help", "--version", "optimize --help", "optimize --help-all"})
        EXPECT_EQ(shell(std::string("('" BURNISH_BINARY "' ") + help + " >/dev/full)").code, 74)
            << help;
    const Outcome left =
        shell("('" BURNISH_BINARY "' info scene.xml; echo $? >code) | true; exit $(cat code)");
    EXPECT_EQ(left.code, 0) << left.err;
    // Errors that nobody reads do not end a run.
    const Outcome silent =
        shell("('" BURNISH_BINARY
              "' render scene.xml --spp 4 -o a.exr; echo $? >code) 2>&1 | true; exit $(cat code)");
    EXPECT_EQ(silent.code, 0);
    EXPECT_TRUE(fs::exists(folder / "a.exr"));
}

/// Of more than a pipe holds: a reader that leaves late leaves before all is written.
TEST_F(Robustness, LongOutputThatDoesNotArriveIsNoDefect) {
    std::string shapes;
    for (int i = 0; i < 1000; ++i)
        shapes += "<shape type=\"rectangle\"><bsdf type=\"diffuse\" id=\"bsdf-" +
                  std::to_string(i) +
                  "\"><rgb name=\"reflectance\" value=\"0.5\"/></bsdf></shape>\n";
    replace("</scene>", shapes + "</scene>");
    ASSERT_GT(run("info scene.xml --json").out.size(), 65536u);
    for (const char* command : {"info scene.xml --json", "info scene.xml", "options --markdown"}) {
        const std::string program = std::string("('" BURNISH_BINARY "' ") + command;
        const Outcome full = shell(program + " >/dev/full)");
        EXPECT_EQ(full.code, 74) << command;
        EXPECT_TRUE(contains(full.err, "standard output cannot be written: No space left"))
            << full.err;
        const Outcome left = shell(program + "; echo $? >code) | true; exit $(cat code)");
        EXPECT_EQ(left.code, 0) << command << ": " << left.err;
    }
}

TEST_F(Robustness, LinesOfABatchThatDoNotArriveAreAnErrorAfterItsJobs) {
    write_text(folder / "jobs.json", R"({"options": {"scene.file": "scene.xml",
        "problem.parameters": ["base_color"], "path_cache.samples": 1, "stop.iterations": 1,
        "problem.target_samples": 4, "evaluation_samples": 4, "problem.initial_values": ["0.5"]},
        "jobs": [{"output": "out/a"}, {"output": "out/b"}]})");
    const Outcome full = shell("('" BURNISH_BINARY "' batch jobs.json >/dev/full)");
    EXPECT_EQ(full.code, 74) << full.err;
    EXPECT_TRUE(contains(full.err, "standard output cannot be written: No space left"));
    for (const char* job : {"out/a", "out/b"})
        EXPECT_TRUE(fs::exists(folder / job / "summary.json")) << job;
    const Outcome left =
        shell("('" BURNISH_BINARY "' batch jobs.json; echo $? >code) | true; exit $(cat code)");
    EXPECT_EQ(left.code, 0) << left.err;
}

TEST_F(Robustness, NumbersThatNobodyMeansAreRefusedBeforeWork) {
    const std::tuple<const char*, const char*, const char*> cases[] = {
        {"origin=\"0,0,3\"", "origin=\"0,0,1e19\"",
         "the camera is at (0, 0, 1e+19), expected it within 1e+12"},
        {"<rfilter type=\"box\"/>",
         "<rfilter type=\"mitchell\"><float name=\"B\" value=\"1e30\"/></rfilter>",
         "\"B\" is 1e+30, expected a value in [-10, 10]"},
        {"<float name=\"fov\" value=\"40\"/>",
         "<float name=\"fov\" value=\"40\"/><float name=\"principal_point_offset_x\" "
         "value=\"1e20\"/>",
         "\"principal_point_offset_x\" is 1e+20"},
        {"value=\"8\"/></sampler>", "value=\"2147483647\"/></sampler>",
         "1.2e+12 samples: expected at most 1e+12"}};
    const std::string scene = read_text(folder / "scene.xml");
    for (const auto& [text, by, complaint] : cases) {
        replace(text, by);
        expect_refused("render scene.xml -o a.exr", 65, complaint);
        EXPECT_FALSE(fs::exists(folder / "a.exr"));
        write_text(folder / "scene.xml", scene);
    }
    for (const char* value : {"2", "-1"})
        expect_refused(
            std::string("render scene.xml -o a.exr --texture mat-panel.roughness=") + value, 65,
            "outside of [0, 1]");
}

TEST_F(Robustness, PicturesTooBrightForTheirNumbersAreNotWritten) {
    write_text(
        folder / "bright.xml",
        "<scene version='3.0.0'><integrator type='direct'/><shape type='rectangle'><boolean "
        "name='flip_normals' value='true'/></shape><emitter type='constant'><rgb name='radiance' "
        "value='1e38'/></emitter></scene>");
    expect_refused("render bright.xml -o a.exr --spp 16 --size 8 8", 65,
                   " at pixel (0, 0): lights of the scene are too");
    EXPECT_FALSE(fs::exists(folder / "a.exr"));
}

/// Seconds of processor time of the programs that it runs to their ends.
double seconds_of(const std::function<void()>& work) {
    const auto of_children = [] {
        rusage usage{};
        getrusage(RUSAGE_CHILDREN, &usage);
        return processor_seconds(usage);
    };
    const double before = of_children();
    work();
    return of_children() - before;
}

TEST_F(Robustness, NamesThatNoRecordCanHoldAreRefusedBeforeWork) {
    const fs::path home = folder / "caf\xe9";
    fs::create_directories(home);
    for (const char* file : {"scene.xml", "color.exr", "roughness.exr"})
        fs::copy_file(folder / file, home / file);
    const std::string options =
        " --parameter base_color --spp 2 --target-spp 2 --iterations 1 --evaluation-spp 2 ";
    expect_refused("optimize 'caf\xe9/scene.xml' -o out" + options, 65,
                   "scene.file: found \"caf\\xe9/scene.xml\", expected a text "
                   "in UTF-8");
    EXPECT_FALSE(fs::exists(folder / "out"));
    // A relative name, results in such a folder, and a name that is UTF-8.
    EXPECT_EQ(
        shell("cd 'caf\xe9' && '" BURNISH_BINARY "' optimize scene.xml -o out" + options).code, 0);
    fs::rename(home, folder / "caf\xc3\xa9");
    EXPECT_EQ(run("optimize 'caf\xc3\xa9/scene.xml' -o 'out\xe9'" + options).code, 0);
}

TEST_F(Robustness, ParametersThatMultiplyEachOtherEndSoon) {
    std::string defaults = "<scene version=\"3.0.0\"><default name=\"a0\" value=\"0123456789\"/>";
    for (int i = 1; i < 20; ++i) {
        std::string ten;
        for (int k = 0; k < 10; ++k) ten += fmt::format("$a{}", i - 1);
        defaults += fmt::format("<default name=\"a{}\" value=\"{}\"/>", i, ten);
    }
    write_text(folder / "bomb.xml", defaults + "</scene>");
    Outcome outcome;
    EXPECT_LT(seconds_of([&] { outcome = run("info bomb.xml"); }), 5);
    EXPECT_EQ(outcome.code, 65);
    EXPECT_TRUE(contains(outcome.err, "an attribute is longer than 1048576 bytes")) << outcome.err;

    // Many that are long enough, one by one.
    std::string many = "<scene version=\"3.0.0\"><default name=\"a\" value=\"" +
                       std::string(1 << 19, 'x') + "\"/>";
    for (int i = 0; i < 1000; ++i) many += "<default name=\"b\" value=\"$a\"/>";
    write_text(folder / "many.xml", many + "</scene>");
    outcome = run("info many.xml");
    EXPECT_EQ(outcome.code, 65);
    EXPECT_TRUE(contains(outcome.err, "the attributes of the scene hold more than")) << outcome.err;
}

TEST_F(Robustness, FilesThatIncludeEachOtherManyTimesEndSoon) {
    for (int i = 0; i < 10; ++i) {
        std::string text = "<scene version=\"3.0.0\">";
        for (int k = 0; k < 10 && i < 9; ++k)
            text += fmt::format("<include filename=\"{}.xml\"/>", i + 1);
        write_text(folder / fmt::format("{}.xml", i), text + "</scene>");
    }
    Outcome outcome;
    EXPECT_LT(seconds_of([&] { outcome = run("info 0.xml"); }), 5);
    EXPECT_EQ(outcome.code, 65);
    EXPECT_TRUE(contains(outcome.err, "the scene includes more than 4095 files")) << outcome.err;
}

TEST_F(Robustness, TextsThatAreFarTooLongAreRefusedBeforeTheyAreRead) {
    const double small = peak_of("info scene.xml", 0);
    const std::pair<const char*, const char*> cases[] = {
        {"info long.xml", "long.xml: found more than 256 MiB, expected a Mitsuba scene"},
        {"info long.json", "long.json: found more than 256 MiB, expected a capture"},
        {"info scene.xml --views long.json",
         "long.json: found more than 256 MiB, expected a transforms.json"},
        {"batch long.json", "long.json: found more than 256 MiB, expected a list of jobs"},
        {"info spectrum.xml",
         "long.spd: found more than 256 MiB, expected wavelengths and values"}};
    for (const char* name : {"long.xml", "long.json", "long.spd"}) {
        write_text(folder / name, "");
        fs::resize_file(folder / name, std::uintmax_t{1} << 30);  // takes no place on a disk
    }
    write_text(folder / "spectrum.xml",
               "<scene version='3.0.0'><emitter type='constant'><spectrum name='radiance' "
               "filename='long.spd'/></emitter></scene>");
    for (const auto& [arguments, expected] : cases) {
        EXPECT_LT(peak_of(arguments, 65), small + 1e8) << arguments;
        const std::string found = read_text(folder / ".err");
        EXPECT_TRUE(contains(found, expected)) << arguments << ": " << found;
    }
}

TEST_F(Robustness, FilesThatCannotBeLookedAtAreBadInput) {
    write_scene();
    fs::create_symlink("loop", folder / "loop");
    const std::string long_name(300, 'a');
    write_text(folder / "transforms.json",
               R"({"w": 24, "h": 24, "fl_x": 30, "frames": [{"file_path": ")" + long_name +
                   R"(", "transform_matrix":
                   [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}]})");
    const std::pair<std::string, const char*> cases[] = {
        {"render loop -o a.exr", "loop: cannot be opened: "},
        {"render loop/scene.xml -o a.exr", "loop/scene.xml: cannot be opened: "},
        {"render " + long_name + " -o a.exr", "a: cannot be opened: File name too long"},
        {"info scene.xml --views loop", "loop: cannot be opened: "},
        {"info scene.xml --views loop --images .", "loop: cannot be opened: "},
        {"optimize loop --parameter base_color -o out", "loop: cannot be opened: "},
        {"optimize scene.xml --views transforms.json --parameter base_color -o out",
         "a: cannot be opened: File name too long"},
        {"reproduce derivatives --scene tire --scenes loop -o r",
         "--scenes: found loop, expected the folder that holds tire/scene.xml"},
    };
    for (const auto& [arguments, expected] : cases) {
        const Outcome outcome = expect_refused(arguments, 65, expected);
        EXPECT_FALSE(contains(outcome.err, "filesystem error")) << arguments << outcome.err;
    }
}

TEST_F(Robustness, NamesOfASceneCannotSteerTheTerminal) {
    replace("id=\"mat-panel\"",
            "id=\"mat\xc2\x9b"
            "2J\"");
    replace("<ref id=\"mat-panel\"/>",
            "<ref id=\"mat\xc2\x9b"
            "2J\"/>");
    const Outcome outcome = run("info scene.xml");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "mat\\x9b2J")) << outcome.out;
    EXPECT_FALSE(contains(outcome.out, "\xc2\x9b"));
}

}  // namespace
}  // namespace burnish
