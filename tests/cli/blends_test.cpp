// The weight of a blend and the opacity of a mask as unknowns on the command line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

struct BlendsTest : Program {
    using json = nlohmann::json;

    /// Puts something around the panel's BSDF, and inside of its two sides.
    void wrap(const std::string& outside, const std::string& inside) const {
        write_scene();
        std::string scene = read_text(folder / "scene.xml");
        const auto replace = [&](const std::string& from, const std::string& to) {
            const std::size_t at = scene.find(from);
            ASSERT_NE(at, std::string::npos) << from;
            scene.replace(at, from.size(), to);
        };
        const std::string two_sides = "<bsdf type=\"twosided\" id=\"mat-panel\">";
        if (!outside.empty()) {
            replace(two_sides, outside + "<bsdf type=\"twosided\">");
            replace("</bsdf>\n  </bsdf>", "</bsdf>\n  </bsdf></bsdf>");
        } else {
            replace(two_sides, two_sides + inside);
            replace("</bsdf>\n  </bsdf>", "</bsdf></bsdf>\n  </bsdf>");
        }
        write_text(folder / "scene.xml", scene);
    }
    /// The loss that is left of a run, as a share of that at its start.
    double loss_left(const std::string& run) const {
        const json result = summary_of(run)["result"];
        return double{result["final_loss"]} / double{result["initial_loss"]};
    }
};

constexpr const char* kBlue =
    "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.1, 0.3, 0.6\"/></bsdf>";

TEST_F(BlendsTest, AWeightIsRecovered) {
    wrap("",
         std::string("<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.3\"/>") + kBlue);
    const Outcome outcome =
        run("optimize scene.xml --parameter mat-panel.weight --init 0.8 --learning-rate 0.02 "
            "--iterations 80 --evaluation-spp 64 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json parameter = summary_of("out")["parameters"][0];
    EXPECT_EQ(parameter["name"], "mat-panel.brdf_0.weight.value");
    EXPECT_NEAR(parameter["value"][0], 0.3, 0.03);
    EXPECT_LT(loss_left("out"), 0.1);
    const std::string written = read_text(folder / "out/scene/scene.xml");
    EXPECT_TRUE(contains(written, "<float name=\"weight\" value=\"0.3") ||
                contains(written, "<float name=\"weight\" value=\"0.2"))
        << written;
    EXPECT_EQ(run("render out/scene/scene.xml --spp 4 -o a.exr").code, 0);
}

TEST_F(BlendsTest, ATextureOfWeightsIsRecoveredByEveryEstimator) {
    wrap("",
         std::string("<bsdf type=\"blendbsdf\"><texture type=\"bitmap\" name=\"weight\"><string "
                     "name=\"filename\" value=\"roughness.exr\"/><boolean name=\"raw\" "
                     "value=\"true\"/></texture>") +
             kBlue);
    for (const std::string estimator : {"path_cache", "pgris", "mc"}) {
        const Outcome outcome =
            run("optimize scene.xml --parameter mat-panel.weight --init 1 --learning-rate 0.02 "
                "--iterations 80 --evaluation-spp 64 --estimator " +
                estimator + " -o " + estimator);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_LT(loss_left(estimator), 0.1) << estimator;
    }
}

TEST_F(BlendsTest, ATextureOfOpacityIsRecovered) {
    wrap(
        "<bsdf type=\"mask\" id=\"mat-panel\"><texture type=\"bitmap\" name=\"opacity\"><string "
        "name=\"filename\" value=\"roughness.exr\"/><boolean name=\"raw\" value=\"true\"/>"
        "</texture>",
        "");
    const Outcome outcome =
        run("optimize scene.xml --parameter mat-panel.opacity --init 1 --learning-rate 0.02 "
            "--iterations 80 --evaluation-spp 64 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_LT(loss_left("out"), 0.1);
    EXPECT_TRUE(fs::exists(folder / "out/scene/textures/mat-panel.opacity.data.exr"));
    EXPECT_EQ(run("render out/scene/scene.xml --spp 4 -o a.exr").code, 0);
    const Outcome check = run("check-gradient scene.xml --parameter mat-panel.opacity --spp 1024");
    EXPECT_EQ(check.code, 0) << check.out << check.err;
    ASSERT_EQ(run("gradient scene.xml --parameter mat-panel.opacity --adjoint a.exr --spp 8 -o "
                  "g.exr")
                  .code,
              0);
    EXPECT_EQ(read_image((folder / "g.exr").string()).width, 8);
}

/// A difference is rounding unless a sample of the pixel takes the other part within the steps.
TEST_F(BlendsTest, FewSamplesOfABlendTellNothingOfItsDerivative) {
    write_text(folder / "drawn.xml", R"(<scene version="3.0.0">
  <integrator type="direct"/>
  <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="1"/>
      <integer name="height" value="1"/></film>
    <transform name="to_world"><lookat origin="0,0,3" target="0,0,0" up="0,1,0"/></transform></sensor>
  <emitter type="constant"/>
  <shape type="rectangle"><transform name="to_world"><scale value="9"/></transform>
    <bsdf type="blendbsdf" id="mix"><float name="weight" value="0.5"/>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.9"/></bsdf>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.1"/></bsdf></bsdf></shape></scene>)");
    for (const int samples : {32, 128})
        for (int seed = 1; seed <= 12; ++seed) {
            const Outcome outcome = run(
                fmt::format("check-gradient drawn.xml --parameter mix.weight --spp {} --seed {}",
                            samples, seed));
            EXPECT_EQ(outcome.code, 0) << outcome.out;
            EXPECT_TRUE(contains(outcome.out, "too noisy to tell")) << outcome.out;
            EXPECT_FALSE(contains(outcome.out, "agree")) << outcome.out;
        }
}

TEST_F(BlendsTest, TooManyBlendsAreRefused) {
    std::string blends = "<bsdf type=\"diffuse\"/>";
    for (int k = 0; k < 5; ++k)
        blends =
            "<bsdf type=\"blendbsdf\"><texture type=\"bitmap\" name=\"weight\"><string "
            "name=\"filename\" value=\"roughness.exr\"/></texture>" +
            blends + "<bsdf type=\"diffuse\"/></bsdf>";
    write_scene();
    std::string scene = read_text(folder / "scene.xml");
    const std::size_t begin = scene.find("<bsdf type=\"principled\">");
    const std::size_t end = scene.find("</bsdf>", begin) + 7;
    scene.replace(begin, end - begin, blends);
    write_text(folder / "scene.xml", scene);
    const Outcome outcome =
        run("optimize scene.xml --parameter bsdf_0.bsdf_0.bsdf_0.bsdf_0.weight -o out");
    EXPECT_EQ(outcome.code, 65) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "inside of 5 blends: expected at most 4")) << outcome.err;
    const json parameters = json::parse(run("info scene.xml --json").out)["parameters"];
    EXPECT_FALSE(contains(parameters.dump(), ".weight")) << parameters;
}

}  // namespace
}  // namespace burnish
