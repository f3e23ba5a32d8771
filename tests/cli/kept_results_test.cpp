// Results kept in files: what comes back is what was kept, and only where it was made of the same.
#include "cli/kept_results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <vector>

#include "burnish/error.h"
#include "cli/program.h"
#include "cli/reproduce_parts.h"

namespace burnish {
namespace {

using namespace testing;

struct KeptResultsTest : testing::Program {
    KeptResults kept = keep_results(folder / "kept");
};

Image image_with(float value) {
    Image image = make_image(3, 2, 3, 0.25f);
    image.at(2, 1, 1) = value;
    return image;
}

TEST_F(KeptResultsTest, AFolderThatCannotBeWrittenIsSaidAtTheStart) {
    EXPECT_FALSE(std::filesystem::exists(folder / "kept")) << "nothing is kept yet";
    std::ofstream(folder / "file") << "mine";
    for (const std::filesystem::path& place : {folder / "file", folder / "file/kept"})
        EXPECT_THROW(keep_results(place), OutputError) << place;
    std::filesystem::create_directory(folder / "earlier");
    std::ofstream(folder / "earlier/result") << "kept";
    keep_results(folder / "earlier");
    EXPECT_TRUE(std::filesystem::exists(folder / "earlier/result"));
    std::filesystem::create_directory_symlink("earlier", folder / "link");
    keep_results(folder / "link");
    EXPECT_TRUE(std::filesystem::exists(folder / "link/result"));
}

TEST(KeptFolder, LiesBesideThatOfTheReport) {
    EXPECT_EQ(kept_folder("r").string(), "r.kept");
    EXPECT_EQ(kept_folder("a/./r/").string(), "a/r.kept");
    const std::filesystem::path here = std::filesystem::current_path();
    EXPECT_EQ(kept_folder(".").string(), here.string() + ".kept");
    EXPECT_EQ(kept_folder("./").string(), here.string() + ".kept");
    EXPECT_EQ(kept_folder("..").string(), here.parent_path().string() + ".kept");
}

TEST_F(KeptResultsTest, MayBeMadeOfFilesOfAnyName) {
    const nlohmann::json made_of{{"files", {"caf\xe9.exr"}}}, other{{"files", {"caf\xe8.exr"}}};
    EXPECT_FALSE(find_kept(kept, "x", made_of));
    keep(kept, "x", made_of, 1);
    EXPECT_EQ(find_kept(kept, "x", made_of), 1);
    EXPECT_FALSE(find_kept(kept, "x", other));
}

TEST_F(KeptResultsTest, ComeBackToTheByte) {
    ExperimentResult result{"inverse", "Title", {}, {}, 1.0 / 3};
    result.measurements = {{"inverse", "tire", "mc", "loss", 0.1},
                           {"inverse", "tire", "mc", "noise", INFINITY}};
    Figure figure{"title", "claim", "measured", "why", Verdict::kUndecided, {}, {}, {}};
    figure.tables = {{{"a", "b"}, {{"1", "2"}}}};
    figure.plots = {{"x", "y", {{"curve", {{1e-300, 2}, {3, 4}}}}, true}};
    figure.pictures = {{{"p", "c", image_with(1e-30f), PictureKind::kDerivative, 0.1f}}};
    result.figures = {figure};
    keep(kept, "a", {{"size", 1}}, result);
    const auto found = find_kept(kept, "a", {{"size", 1}});
    ASSERT_TRUE(found);
    const auto back = found->get<ExperimentResult>();
    EXPECT_EQ(back.name, "inverse");
    EXPECT_EQ(back.title, "Title");
    EXPECT_EQ(back.seconds, 1.0 / 3);
    ASSERT_EQ(back.measurements.size(), 2u);
    EXPECT_EQ(back.measurements[0].value, 0.1);
    EXPECT_EQ(back.measurements[1].value, INFINITY);
    ASSERT_EQ(back.figures.size(), 1u);
    const Figure& f = back.figures[0];
    EXPECT_EQ(f.why, "why");
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    EXPECT_EQ(f.tables[0].rows, figure.tables[0].rows);
    EXPECT_TRUE(f.plots[0].log_x);
    EXPECT_EQ(f.plots[0].curves[0].points[0].x, 1e-300);
    EXPECT_EQ(f.pictures[0][0].image, figure.pictures[0][0].image);
    EXPECT_EQ(f.pictures[0][0].kind, PictureKind::kDerivative);
    EXPECT_EQ(f.pictures[0][0].white, 0.1f);
}

TEST_F(KeptResultsTest, OfReferencesComeBackToTheByte) {
    keep(kept, "r", 1, DerivativeReference{image_with(-2), 1e-9, INFINITY});
    const auto back = find_kept(kept, "r", 1)->get<DerivativeReference>();
    EXPECT_EQ(back.gradient, image_with(-2));
    EXPECT_EQ(back.squared_error, 1e-9);
    EXPECT_EQ(back.nmse, INFINITY);
}

TEST_F(KeptResultsTest, OfRunsComeBackToTheByte) {
    burnish::Run made;
    made.at[kDerivative] = {7,   1.0 / 3, 0.1,           1e-9,         INFINITY,
                            0.5, 0.25,    image_with(2), image_with(3)};
    made.losses = {"mc", {{1e-300, 2}, {3, 4}}};
    made.seconds = 1.0 / 7;
    keep(kept, "r", 1, made);
    const auto back = find_kept(kept, "r", 1)->get<burnish::Run>();
    const Moment& m = back.at[kDerivative];
    EXPECT_EQ(m.iteration, 7u);
    EXPECT_EQ(m.seconds, 1.0 / 3);
    EXPECT_EQ(m.derivative_seconds, 0.1);
    EXPECT_EQ(m.loss, 1e-9);
    EXPECT_EQ(m.noise_floor, INFINITY);
    EXPECT_EQ(m.texture_error, 0.5);
    EXPECT_EQ(m.step_length, 0.25);
    EXPECT_EQ(m.image, image_with(2));
    EXPECT_EQ(m.texture, image_with(3));
    EXPECT_EQ(back.at[kClock].image, Image{});
    EXPECT_EQ(back.losses.name, "mc");
    ASSERT_EQ(back.losses.points.size(), 2u);
    EXPECT_EQ(back.losses.points[0].x, 1e-300);
    EXPECT_EQ(back.seconds, 1.0 / 7);
}

TEST_F(KeptResultsTest, MadeOfOtherThingsAreNotTaken) {
    EXPECT_FALSE(find_kept(kept, "a", 1)) << "nothing yet";
    keep(kept, "a", 1, "one");
    keep(kept, "a", 2, "two");
    EXPECT_EQ(find_kept(kept, "a", 1), "one");
    EXPECT_EQ(find_kept(kept, "a", 2), "two");
    EXPECT_FALSE(find_kept(kept, "a", 3));
    EXPECT_FALSE(find_kept(kept, "b", 1));
    EXPECT_FALSE(find_kept({kept.folder, "another program"}, "a", 1));
}

TEST_F(KeptResultsTest, EveryOptionMakesOtherThings) {
    using O = ReproduceOptions;
    const std::vector<void (*)(O&)> changes{
        [](O& o) { o.width += 1; },
        [](O& o) { o.height += 1; },
        [](O& o) { o.texture_side += 1; },
        [](O& o) { o.image_samples += 1; },
        [](O& o) { o.image_window += 1; },
        [](O& o) { o.target_samples += 1; },
        [](O& o) { o.reference_samples += 1; },
        [](O& o) { o.evaluation_samples += 1; },
        [](O& o) { o.iterations += 1; },
        [](O& o) { o.budget.iterations += 1; },
        [](O& o) { o.budget.long_iterations += 1; },
        [](O& o) { o.budget.derivative_seconds += 1; },
        [](O& o) { o.budget.seconds += 1; },
        [](O& o) { o.sweep_seconds += 1; },
        [](O& o) { o.max_samples += 1; },
        [](O& o) { o.seed += 1; },
        [](O& o) { o.runs += 1; },
    };
    std::set<std::string> keys{nlohmann::json(O{}).dump()};
    for (std::size_t i = 0; i < changes.size(); ++i) {
        O other;
        changes[i](other);
        EXPECT_TRUE(keys.insert(nlohmann::json(other).dump()).second) << "change " << i;
    }
    EXPECT_EQ(changes.size(), nlohmann::json(O{}).size()) << "an option is not tested";
}

TEST_F(KeptResultsTest, FilesOfASceneCountByTheirBytes) {
    std::filesystem::create_directories(folder / "scene/meshes");
    write_text(folder / "scene/scene.xml", "<scene/>");
    write_text(folder / "scene/meshes/a.ply", "ply");
    const nlohmann::json files = files_of(folder / "scene");
    EXPECT_EQ(files.size(), 2u);
    std::filesystem::copy(folder / "scene", folder / "elsewhere",
                          std::filesystem::copy_options::recursive);
    std::filesystem::last_write_time(folder / "elsewhere/scene.xml", {});
    EXPECT_EQ(files_of(folder / "elsewhere"), files);
    write_text(folder / "elsewhere/meshes/a.ply", "plz");
    EXPECT_NE(files_of(folder / "elsewhere"), files);
}

TEST_F(KeptResultsTest, FoldersThatAreLeftOutDoNotCount) {
    std::filesystem::create_directories(folder / "scene/report/textures");
    std::filesystem::create_directories(folder / "scene/reports");
    for (const char* name :
         {"scene.xml", "report/index.html", "report/textures/a.exr", "reports/b"})
        write_text(folder / "scene" / name, "text");
    const nlohmann::json files =
        files_of(folder / "scene", {folder / "scene/./report/", folder / "missing"});
    ASSERT_EQ(files.size(), 2u) << files;
    EXPECT_EQ(files[0][0], "reports/b");
    EXPECT_EQ(files[1][0], "scene.xml");
    EXPECT_EQ(files_of(folder / "scene", {folder / "scene"}).size(), 4u) << "it is the scene's own";
}

TEST_F(KeptResultsTest, DamagedFilesAreMadeAgain) {
    keep(kept, "a", 1, image_with(1));
    const auto file = std::filesystem::directory_iterator(kept.folder)->path();
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    EXPECT_FALSE(find_kept(kept, "a", 1));
    std::ofstream(file) << "nothing of the kind";
    EXPECT_FALSE(find_kept(kept, "a", 1));
    keep(kept, "a", 1, image_with(2));
    EXPECT_EQ(find_kept(kept, "a", 1)->get<Image>(), image_with(2));
}

}  // namespace
}  // namespace burnish
