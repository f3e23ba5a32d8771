// Options of which only the scene and its pictures tell that they have no effect.
#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

struct WithoutEffect : Program {};

TEST_F(WithoutEffect, IsWarnedOf) {
    write_scene();
    ASSERT_EQ(run("render scene.xml --spp 16 -o target.exr").code, 0);
    write_text(folder / "capture.json", R"({"version": 1, "scene": "scene.xml",
        "views": [{"camera": {"sensor": 0}, "image": "target.exr"}]})");
    const std::string command =
        "optimize capture.json --iterations 3 --spp 1 --evaluation-spp 2 --set search_again=8 "
        "--parameter roughness ";
    const Outcome all =
        run(command + "--parameter base_color --target-spp 16 --set batch=3 -o all");
    ASSERT_EQ(all.code, 0) << all.err;
    EXPECT_TRUE(contains(all.err, "search_again has no effect")) << all.err;
    EXPECT_TRUE(contains(all.err, "--target-spp (problem.target_samples) has no effect"))
        << all.err;
    EXPECT_TRUE(contains(all.err, "batch has no effect above 1")) << all.err;

    const std::string samples =
        "optimize capture.json --iterations 1 --spp 5 --evaluation-spp 2 --parameter roughness ";
    const Outcome passes = run(samples + "--set path_cache.window=1 -o passes");
    EXPECT_TRUE(contains(passes.err,
                         "path_cache.samples has no effect above 2, twice path_cache.window: "
                         "found 5"))
        << passes.err;
    const Outcome image = run(samples + "--estimator mc --set monte_carlo.image_window=2 -o image");
    EXPECT_TRUE(contains(image.err,
                         "monte_carlo.image_samples has no effect above 4, twice "
                         "monte_carlo.image_window: found 5"))
        << image.err;

    const Outcome compared =
        run(samples + "--set batch=3 --compare mc --set monte_carlo.image_window=2 -o compared");
    EXPECT_TRUE(contains(compared.err, "monte_carlo.image_samples has no effect above 4"))
        << compared.err;
    const std::size_t once = compared.err.find("batch has no effect");
    EXPECT_NE(once, std::string::npos) << compared.err;
    EXPECT_EQ(once, compared.err.rfind("batch has no effect")) << "of both runs";

    const Outcome never = run(samples + "--set search_again=8 --set pyramid.levels=30 -o never");
    EXPECT_TRUE(contains(never.err,
                         "search_again has no effect in 1 iteration: the first search "
                         "comes after 2, a quarter of 8"))
        << never.err;
    EXPECT_TRUE(contains(never.err, "pyramid.levels has no effect above 4, ")) << never.err;

    const Outcome none = run(command + "-o none");
    ASSERT_EQ(none.code, 0) << none.err;
    EXPECT_FALSE(contains(none.err, "no effect")) << none.err;
}

}  // namespace
}  // namespace burnish
