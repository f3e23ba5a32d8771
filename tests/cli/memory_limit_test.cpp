// --max-memory against what the process really takes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "cli/picture_memory.h"
#include "cli/program.h"
#include "core/parallel.h"
#include "optimize/checkpoint.h"

namespace burnish {
namespace {

using namespace testing;

class MemoryLimit : public Program {
  protected:
    nlohmann::json summary(const std::string& options) const {
        const Outcome outcome =
            run("optimize scene/scene.xml --parameter mat-goblet.roughness --size 256 256 "
                "--target-spp 4 --iterations 24 --spp 8 --evaluation-spp 2 --threads 2 "
                "--set path_cache.window=96 -o out " +
                options);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return summary_of("out");
    }
};

TEST_F(MemoryLimit, ThePeakStaysBelowTheLimitAndTheEstimate) {
    ASSERT_EQ(run("scene goblet -o scene --texture-size 256").code, 0);
    const auto free = summary("--max-memory 8");
    const double free_peak = free["peak_memory_bytes"].get<double>();
    const double limit = 0.6 * free_peak / 0x1p30;
    const auto cut = summary("--max-memory " + std::to_string(limit));
    const double peak = cut["peak_memory_bytes"].get<double>();
    EXPECT_LT(peak, limit * 0x1p30);
    EXPECT_LT(cut["settings"]["path_cache"]["max_bytes"],
              free["settings"]["path_cache"]["max_bytes"]);
    for (const auto& run : {free, cut}) {
        EXPECT_LE(run["peak_memory_bytes"], run["memory_estimate_bytes"]["maximum"]);
        // The estimate serves: it is not many times what is taken.
        EXPECT_LE(run["memory_estimate_bytes"]["expected"].get<double>(),
                  1.5 * run["peak_memory_bytes"].get<double>());
    }
}

/// Skies of single views, and views that are held out, are memory, too.
TEST_F(MemoryLimit, TheEstimateCountsWhatViewsHaveOfTheirOwn) {
    write_scene();
    write_image(folder / "sky.exr", make_image(2048, 1024, 3, 0.5f));
    std::string views;
    for (const char* scale : {"1", "1.5", "2"})
        views += fmt::format(
            R"({}{{"name": "{}", "camera": {{"sensor": 0}},
                "environment": {{"file": "sky.exr", "scale": {}}}}})",
            views.empty() ? "" : ", ", scale, scale);
    const std::string start = R"({"version": 1, "scene": "scene.xml", "views": [)";
    write_text(folder / "skies.json", start + views + "]}");
    write_text(folder / "held_out.json", start + R"({"name": "a", "camera": {"sensor": 0}},
        {"name": "b", "split": "test", "camera": {"model": "SIMPLE_PINHOLE", "width": 1200,
         "height": 1200, "params": [1200, 600, 600],
         "camera_to_world": [[1,0,0,0],[0,-1,0,0],[0,0,-1,3],[0,0,0,1]]}}]})");
    for (const char* capture : {"skies.json", "held_out.json"}) {
        const Outcome outcome =
            run(std::string("optimize ") + capture +
                " --parameter base_color --init 0.5 --iterations 2 --target-spp 1 "
                "--evaluation-spp 2 --threads 2 --force -o out");
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const auto summary = summary_of("out");
        EXPECT_LE(summary["peak_memory_bytes"], summary["memory_estimate_bytes"]["maximum"])
            << capture;
        EXPECT_LE(summary["memory_estimate_bytes"]["expected"].get<double>(),
                  1.6 * summary["peak_memory_bytes"].get<double>())
            << capture;
    }
}

/// They are made smaller once they are read.
TEST_F(MemoryLimit, PicturesThatAreReadAtOnceFitTheLimitAtTheirFullSize) {
    write_scene();
    Image opaque = make_image(2400, 2400, 4, 0.5f);
    for (std::size_t i = 3; i < opaque.values.size(); i += 4) opaque.values[i] = 1;
    for (const char* name : {"a.png", "b.png"}) write_image(folder / name, opaque);
    write_text(folder / "capture.json", R"({"version": 1, "scene": "scene.xml", "views": [
        {"name": "a", "image": "a.png", "camera": {"sensor": 0}},
        {"name": "b", "image": "b.png", "camera": {"sensor": 0}}]})");
    const std::string base =
        "optimize capture.json --parameter base_color --init 0.5 --iterations 1 "
        "--evaluation-spp 2 --threads 2 -o out ";
    const std::string command = base + "--scale 0.01 ";
    const Outcome whole = run(base + "--max-memory 0.2");
    EXPECT_EQ(whole.code, 77);
    EXPECT_TRUE(contains(whole.err, "a.png: reading it takes up to 2")) << whole.err;
    const Outcome refused = run(command + "--max-memory 0.2");
    EXPECT_EQ(refused.code, 77);
    EXPECT_TRUE(contains(refused.err, "a.png: reading it takes up to 2")) << refused.err;
    const Outcome enough = run(command + named_limit(refused.err));
    EXPECT_EQ(enough.code, 0) << enough.err;

    for (const double limit : {0.32, 1.0}) {
        const Outcome outcome = run(fmt::format("{} --force --max-memory {}", command, limit));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const auto summary = summary_of("out");
        EXPECT_LT(summary["peak_memory_bytes"].get<double>(), limit * 0x1p30);
        EXPECT_LE(summary["peak_memory_bytes"], summary["memory_estimate_bytes"]["maximum"]);
        EXPECT_LE(summary["memory_estimate_bytes"]["maximum"].get<double>(), limit * 0x1p30);
    }
}

/// Of pictures that are read and forgotten, as `info` does.
TEST_F(MemoryLimit, AsManyPicturesAreReadAtOnceAsFitWhicheverTheyAre) {
    write_image(folder / "small.png", make_image(20, 10, 3, 0.5f));
    write_image(folder / "large.png", make_image(40, 20, 3, 0.5f));
    CapturedView small, large;
    small.image = (folder / "small.png").string(), large.image = (folder / "large.png").string();
    const std::vector<CapturedView> views{small, large, small, large};
    const double bytes = picture_bytes(large, 1).reading;
    const std::size_t threads = threads_of(0);
    EXPECT_GT(bytes, picture_bytes(small, 1).reading);
    EXPECT_EQ(pictures_at_once(views, 0), 1u);
    EXPECT_EQ(pictures_at_once(views, 1.9 * bytes), 1u);
    EXPECT_EQ(pictures_at_once(views, 2 * bytes), std::min<std::size_t>(2, threads));
    EXPECT_EQ(pictures_at_once(views, 1e12), std::min<std::size_t>(4, threads));
}

/// The state that a run goes on from is there before its pictures are.
TEST_F(MemoryLimit, PicturesAreReadBesideTheStateOfARunThatGoesOn) {
    write_scene();
    write_image(folder / "a.png", make_image(1200, 1200, 3, 0.5f));
    write_text(folder / "capture.json", R"({"version": 1, "scene": "scene.xml", "views": [
        {"name": "a", "image": "a.png", "camera": {"sensor": 0}}]})");
    const std::string command =
        "optimize capture.json --parameter base_color --init 0.5 --scale 0.08 --spp 32 "
        "--iterations 10000000 --checkpoint-every 0.001 --threads 2 ";
    const auto enough = [&](const std::string& begin) {
        const Outcome refused =
            expect_refused(begin + " --max-memory 0.06", 77, "a.png: reading it takes up to ");
        return std::stod(named_limit(refused.err).substr(std::strlen("--max-memory ")));
    };
    const double fresh = enough(command + "-o other");
    const fs::path kept = folder / "out/checkpoints";
    stop_once([&] { return !checkpoints_in(kept).empty(); }, command + "-o out", "out", SIGTERM);
    const auto state = static_cast<double>(fs::file_size(checkpoints_in(kept).back()));
    ASSERT_GT(state, 0.004 * 0x1p30);
    EXPECT_NEAR(enough("optimize --resume out"), fresh + state / 0x1p30, 0.002);
}

/// Where a texture repeats, each band of the film adds up all of its texels.
TEST_F(MemoryLimit, TheEstimateCountsWhatBandsAddUpOfATextureThatRepeats) {
    write_image(folder / "rough.exr", make_image(2048, 2048, 1, 0.5f));
    write_text(folder / "scene.xml", R"(<scene version="3.0.0">
<integrator type="direct"/>
<sensor type="perspective"><transform name="to_world">
    <lookat origin="0,0,3" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="192"/><integer name="height" value="192"/>
    </film></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="2"/></transform>
    <bsdf type="principled" id="floor"><texture type="bitmap" name="roughness">
        <string name="filename" value="rough.exr"/><boolean name="raw" value="true"/>
        <transform name="to_uv"><scale x="32" y="32"/></transform></texture></bsdf></shape>
<emitter type="point"><point name="position" x="0.5" y="0.3" z="1.5"/></emitter>
</scene>)");
    const Outcome outcome =
        run("optimize scene.xml --parameter floor.roughness --init 0.4 --iterations 2 "
            "--target-spp 1 --evaluation-spp 2 --set pyramid.levels=1 --threads 2 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto summary = summary_of("out");
    EXPECT_LE(summary["peak_memory_bytes"], summary["memory_estimate_bytes"]["maximum"]);
    EXPECT_LE(summary["memory_estimate_bytes"]["expected"].get<double>(),
              1.6 * summary["peak_memory_bytes"].get<double>());
}

/// A summary names the bytes of the records that its run could have.
TEST_F(MemoryLimit, ARunThatIsRepeatedWithFewerRecordsIsWarnedOf) {
    write_scene();
    ASSERT_EQ(run("optimize scene.xml --parameter base_color --init 0.5 --iterations 40 --spp 1 "
                  "--target-spp 4 --evaluation-spp 2 -o first")
                  .code,
              0);
    const auto first = summary_of("first");
    const double all = first["memory_estimate_bytes"]["maximum"],
                 records = first["settings"]["path_cache"]["max_bytes"];
    const std::string repeat = "optimize --options first/summary.json --max-memory ";
    const Outcome fewer =
        run(fmt::format("{} {} -o fewer", repeat, (all - 0.9 * records) / 0x1p30));
    ASSERT_EQ(fewer.code, 0) << fewer.err;
    EXPECT_TRUE(contains(fewer.err, "warning: path_cache.max_bytes is ")) << fewer.err;
    const std::string texture = "textures/mat-panel.brdf_0.base_color.data.exr";
    EXPECT_FALSE(read_text(folder / "first" / texture) == read_text(folder / "fewer" / texture));
    ASSERT_NE(named_limit(fewer.err), "") << fewer.err;

    const Outcome again =
        run("optimize --options first/summary.json -o again " + named_limit(fewer.err));
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_FALSE(contains(again.err, "path_cache.max_bytes is")) << again.err;
    expect_same_files(folder / "first", folder / "again");
    // A number above what the windows take decides nothing.
    const Outcome much = run(
        "optimize --options first/summary.json --set path_cache.max_bytes=1000000000000 -o much "
        "--max-memory 1");
    EXPECT_EQ(much.code, 0) << much.err;
    EXPECT_FALSE(contains(much.err, "path_cache.max_bytes is")) << much.err;
}

/// The run that is expected to take more is not the one that may take most.
TEST_F(MemoryLimit, TheEstimateOfTwoRunsIsTheMostThatEitherTakes) {
    write_scene();
    const auto estimate = [&](const std::string& options) {
        const Outcome outcome =
            run("optimize scene.xml --parameter base_color --init 0.5 --iterations 1 "
                "--target-spp 1 --evaluation-spp 2 --force -o out " +
                options);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        const auto bytes = summary_of("out")["memory_estimate_bytes"];
        return std::array<double, 2>{bytes["expected"], bytes["maximum"]};
    };
    const std::string cache = "--set path_cache.window=128 ",
                      image =
                          "--set monte_carlo.image_window=64 --set monte_carlo.image_samples=128 ";
    const auto first = estimate(cache), second = estimate("--estimator mc " + image);
    ASSERT_LT(first[0], second[0]);
    ASSERT_GT(first[1], second[1]);
    const auto both = estimate("--compare mc " + cache + image);
    // The second one goes beside the results of the first: two images of 24 x 24 pixels, and more.
    constexpr double kImages = 2 * 24 * 24 * sizeof(Rgbf);
    EXPECT_GT(both[0], second[0] + kImages);
    EXPECT_LT(both[0], second[0] + 2 * kImages);
    EXPECT_NEAR(both[1], first[1], 1);
}

TEST_F(MemoryLimit, FilesOfTheSceneBeyondItAreRefusedBeforeTheyAreRead) {
    write_scene();
    constexpr double kBytes = 3 * 4.0 * 2400 * 2400;  // of the numbers of the picture
    constexpr double kChunk = 3 * 4.0 * 2400 * 16;    // of the rows that are read at a time
    // Before anything is measured: what this process has had counts for those that it starts.
    write_image(folder / "large.exr", make_image(2400, 2400, 3, 0.5f));
    const double small =
        peak_of("optimize scene.xml --parameter none --max-memory 0.02 -o out", 65);
    fs::rename(folder / "large.exr", folder / "color.exr");
    const double file = static_cast<double>(fs::file_size(folder / "color.exr"));
    const std::string command =
        "optimize scene.xml --parameter roughness --init 0.5 --iterations 1 --target-spp 1 "
        "--evaluation-spp 2 -o out ";
    EXPECT_LT(peak_of(command + "--max-memory 0.02", 77), small + 0.3 * kBytes);
    const std::string refusal = read_text(folder / ".err");
    EXPECT_TRUE(contains(refusal, "color.exr: reading it takes at least 6")) << refusal;
    EXPECT_TRUE(contains(refusal, " B read before it: expected --max-memory 0.1")) << refusal;
    EXPECT_TRUE(contains(refusal, "found 20.5 MiB")) << refusal;
    EXPECT_FALSE(fs::exists(folder / "out"));
    // Just above what the files take: the whole is still too much, and what is named is enough.
    const Outcome loaded =
        run(fmt::format("{} --max-memory {}", command, 1.001 * (kBytes + kChunk + file) / 0x1p30));
    EXPECT_EQ(loaded.code, 77);
    EXPECT_FALSE(contains(loaded.err, "reading it takes")) << loaded.err;
    const Outcome enough = run(command + named_limit(loaded.err));
    EXPECT_EQ(enough.code, 0) << named_limit(loaded.err) << ": " << enough.err;
}

/// A triangle takes more in the structure of rays than in its file.
TEST_F(MemoryLimit, TheSceneIsRefusedBeforeItsStructureOfRaysIsBuilt) {
    write_scene();
    constexpr int kSide = 256;
    std::string points, faces;
    for (int i = 0; i < kSide * kSide; ++i)
        points += fmt::format("{} {} 0\n", i % kSide, i / kSide);
    for (int i = 0; i + kSide < kSide * kSide; ++i)
        if (i % kSide + 1 < kSide)
            faces += fmt::format("4 {} {} {} {}\n", i, i + 1, i + 1 + kSide, i + kSide);
    write_text(folder / "grid.ply",
               fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\n"
                           "property float y\nproperty float z\nelement face {}\n"
                           "property list uchar int vertex_indices\nend_header\n{}{}",
                           kSide * kSide, (kSide - 1) * (kSide - 1), points, faces));
    std::string scene = read_text(folder / "scene.xml");
    scene.insert(scene.find("</scene>"),
                 "<shape type=\"ply\"><string name=\"filename\" value=\"grid.ply\"/></shape>");
    write_text(folder / "scene.xml", scene);
    expect_refused("optimize scene.xml --parameter roughness --max-memory 0.01 -o out", 77,
                   "the scene and what rays need of it take about ");
}

TEST_F(MemoryLimit, ALimitThatIsTooLowIsAnErrorThatNamesOneThatIsEnough) {
    write_scene();
    for (const char* estimator : {"path_cache", "mc", "pgris"}) {
        const std::string command =
            std::string(
                "optimize scene.xml --parameter base_color --init 0.5 --iterations 1 "
                "--target-spp 1 --evaluation-spp 2 --force -o out --estimator ") +
            estimator + " ";
        const Outcome outcome = run(command + "--max-memory 0.01");
        EXPECT_EQ(outcome.code, 77);
        EXPECT_TRUE(contains(outcome.err, "expected --max-memory 0.0")) << outcome.err;
        EXPECT_FALSE(fs::exists(folder / "out"));
        const Outcome enough = run(command + named_limit(outcome.err));
        EXPECT_EQ(enough.code, 0) << named_limit(outcome.err) << ": " << enough.err;
        fs::remove_all(folder / "out");
    }
}

}  // namespace
}  // namespace burnish
