// Unknown constants on the command line: one value, or a texture of a size.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/html.h"
#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

struct ConstantsTest : Program {
    using json = nlohmann::json;

    ConstantsTest() {
        write_scene();
        std::string scene = read_text(folder / "scene.xml");
        const std::size_t begin = scene.find("<texture type=\"bitmap\" name=\"roughness\">");
        const std::size_t end = scene.find("</texture>", begin) + 10;
        scene.replace(begin, end - begin,
                      "<float name=\"roughness\" value=\"0.4\"/>"
                      "<float name=\"metallic\" value=\"0.9\"/>");
        write_text(folder / "scene.xml", scene);
    }
};

TEST_F(ConstantsTest, OneValueIsRecovered) {
    const Outcome outcome =
        run("optimize scene.xml --parameter mat-panel.metallic --parameter mat-panel.roughness "
            "--iterations 200 --evaluation-spp 16 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "mat-panel.brdf_0.metallic.value = 0.")) << outcome.err;
    const json parameters = summary_of("out")["parameters"];
    EXPECT_EQ(parameters[0]["name"], "mat-panel.brdf_0.metallic.value");
    EXPECT_EQ(parameters[0]["size"], json({1, 1, 1}));
    EXPECT_NEAR(parameters[0]["value"][0], 0.9, 0.03);
    EXPECT_NEAR(parameters[1]["value"][0], 0.4, 0.02);
    const Image texel =
        read_image((folder / "out/textures/mat-panel.brdf_0.metallic.value.exr").string());
    EXPECT_EQ(texel.width, 1);
    EXPECT_FLOAT_EQ(texel.values[0], parameters[0]["value"][0]);
    const HtmlReader report(read_text(folder / "out/report.html"));
    EXPECT_TRUE(report.errors.empty()) << report.errors[0];
    EXPECT_TRUE(contains(report.text, "one value"));
    ASSERT_EQ(run("optimize --options out/summary.json -o again").code, 0);
    EXPECT_EQ(summary_of("again")["parameters"][0]["value"], parameters[0]["value"]);
}

TEST_F(ConstantsTest, AConstantBecomesATextureOfASize) {
    const Outcome outcome =
        run("optimize scene.xml --parameter mat-panel.metallic:32@0.02 --init scene --iterations 5 "
            "--evaluation-spp 16 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json parameter = summary_of("out")["parameters"][0];
    EXPECT_EQ(parameter["name"], "mat-panel.brdf_0.metallic.data");
    EXPECT_EQ(parameter["size"], json({32, 32, 1}));
    EXPECT_FALSE(parameter.contains("value"));
    expect_refused("optimize scene.xml --parameter base_color:16 -o no", 65,
                   "is a bitmap of 8 x 8 texels");
    for (const char* size : {"0", "100000", "abc", "8x"})
        expect_refused(
            std::string("optimize scene.xml --parameter mat-panel.metallic:") + size + " -o no", 65,
            std::string("mat-panel.metallic:") + size + ": found the size '" + size +
                "', expected texels");
    for (const char* index : {"eta", "specular"})
        expect_refused(std::string("optimize scene.xml --parameter mat-panel.") + index + " -o no",
                       65,
                       std::string("burnish: mat-panel.brdf_0.") + index +
                           " says an index of refraction, which cannot be recovered");
    expect_refused("optimize scene.xml --parameter mat-panel.spec_trans -o no", 65,
                   "burnish: mat-panel.brdf_0.spec_trans is missing or 0 in the scene file, ");
    const Outcome unknown = run("optimize scene.xml --parameter mat-panel.metallc -o no");
    EXPECT_TRUE(contains(unknown.err, "did you mean: mat-panel.brdf_0.metallic.value"))
        << unknown.err;
}

/// The material is built for each of them.
TEST_F(ConstantsTest, ANumberBesideMeshAttributesOfTwoShapesIsOne) {
    const auto write_square = [&](const char* name, float x, const char* color) {
        std::string ply =
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
            "property float z\nproperty float r\nproperty float g\nproperty float b\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
        for (const char* y_z : {"-1 0 ", "1 0 "})
            for (const float side : {y_z[0] == '1' ? 1.8f : 0.0f, y_z[0] == '1' ? 0.0f : 1.8f})
                ply += std::to_string(x + side) + " " + y_z + color + "\n";
        write_text(folder / name, ply + "4 0 1 2 3\n");
    };
    write_square("left.ply", -1.9f, "0.8 0.2 0.2");
    write_square("right.ply", 0.1f, "0.2 0.8 0.2");
    write_text(folder / "two.xml", R"(<scene version="3.0.0"><default name="r" value="0.5"/>
  <integrator type="direct"/>
  <sensor type="perspective"><float name="fov" value="50"/>
    <transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/></film>
  </sensor>
  <bsdf type="principled" id="mat">
    <texture type="mesh_attribute" name="base_color"><string name="name" value="vertex_color"/>
    </texture>
    <float name="roughness" value="$r"/><float name="metallic" value="1"/></bsdf>
  <emitter type="point"><point name="position" x="0" y="0" z="3"/>
    <rgb name="intensity" value="20"/></emitter>
  <shape type="ply"><string name="filename" value="left.ply"/><ref id="mat"/></shape>
  <shape type="ply"><string name="filename" value="right.ply"/><ref id="mat"/></shape>
</scene>)");
    ASSERT_EQ(run("render two.xml -D r=0.25 --spp 64 -o target.exr").code, 0);
    const Outcome outcome = run(
        "optimize two.xml --target target.exr --parameter mat.roughness --init 0.5 --iterations 80 "
        "--evaluation-spp 16 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json result = summary_of("out");
    EXPECT_LT(result["result"]["final_loss"], 0.05 * double{result["result"]["initial_loss"]});
    const json value = result["parameters"][0]["value"][0];
    EXPECT_NEAR(value, 0.25, 0.02);
    const std::string written = read_text(folder / "out/scene/scene.xml");
    EXPECT_FALSE(contains(written, "<float name=\"roughness\" value=\"0.5\"")) << written;
    const std::string info = run("info two.xml").out;
    const std::size_t first = info.find("mat.roughness.value");
    ASSERT_NE(first, std::string::npos) << info;
    EXPECT_EQ(info.find("mat.roughness.value", first + 1), std::string::npos) << info;
}

TEST_F(ConstantsTest, OtherCommandsKnowThem) {
    const Outcome info = run("info scene.xml");
    EXPECT_TRUE(contains(info.out, "mat-panel.brdf_0.metallic.value  0.9")) << info.out;
    EXPECT_FALSE(contains(info.out, "clearcoat")) << "which the scene does not give";
    const json facts = json::parse(run("info --json scene.xml").out);
    EXPECT_EQ(facts["constants"][0]["name"], "mat-panel.brdf_0.roughness.value");
    ASSERT_EQ(run("render scene.xml --spp 16 -o a.exr").code, 0);
    ASSERT_EQ(run("render scene.xml --spp 16 --texture metallic=0.9 -o b.exr").code, 0);
    EXPECT_EQ(read_text(folder / "a.exr"), read_text(folder / "b.exr"));
    ASSERT_EQ(run("render scene.xml --spp 16 --texture metallic=0.2 -o c.exr").code, 0);
    EXPECT_NE(read_text(folder / "a.exr"), read_text(folder / "c.exr"));
    for (const auto& [name, size] : {std::pair{"metallic", 1}, {"metallic:16", 16}}) {
        const Outcome gradient = run(std::string("gradient scene.xml --parameter ") + name +
                                     " --adjoint a.exr --spp 8 -o g.exr");
        ASSERT_EQ(gradient.code, 0) << gradient.err;
        EXPECT_EQ(read_image((folder / "g.exr").string()).width, size);
    }
}

/// Blender calls the second material beside "mat-panel" "mat-panel.001".
TEST_F(ConstantsTest, AreMeantBeforeBitmapsOfOtherMaterials) {
    std::string scene = read_text(folder / "scene.xml");
    const std::string second = R"(<bsdf type="twosided" id="mat-panel.001"><bsdf type="principled">
      <texture type="bitmap" name="metallic"><string name="filename" value="roughness.exr"/>
        <boolean name="raw" value="true"/></texture></bsdf></bsdf>)";
    scene.insert(scene.find("<shape"), second);
    write_text(folder / "scene.xml", scene);
    const std::string one = "--init 0.5 --iterations 1 --spp 1 --target-spp 1 --evaluation-spp 1 ";
    for (const auto& [name, full] :
         {std::pair{"mat-panel.metallic", "value"}, {"mat-panel.metallic:16", "data"}}) {
        const Outcome outcome = run(std::string("optimize scene.xml --parameter ") + name + " " +
                                    one + "--force -o out");
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(summary_of("out")["parameters"][0]["name"],
                  std::string("mat-panel.brdf_0.metallic.") + full);
    }
    expect_refused("optimize scene.xml --parameter metallic " + one + "-o no", 65,
                   "'metallic' is ambiguous, it matches: mat-panel.001.brdf_0.metallic.data, "
                   "mat-panel.brdf_0.metallic.value");
    ASSERT_EQ(run("render scene.xml --spp 4 --texture mat-panel.metallic=0.9 -o a.exr").code, 0);
    ASSERT_EQ(run("render scene.xml --spp 4 --texture mat-panel.metallic=0.2 -o b.exr").code, 0);
    EXPECT_NE(read_text(folder / "a.exr"), read_text(folder / "b.exr"));
}

TEST_F(ConstantsTest, NamesMayHoldTheSignsOfRatesAndValues) {
    std::string scene = read_text(folder / "scene.xml");
    for (std::size_t at; (at = scene.find("\"mat-panel\"")) != std::string::npos;)
        scene.replace(at, 11, "\"mat@2=x\"");
    write_text(folder / "scene.xml", scene);
    ASSERT_EQ(run("render scene.xml --spp 4 --texture mat@2=x.metallic=0.9 -o a.exr").code, 0);
    ASSERT_EQ(run("render scene.xml --spp 4 --texture mat@2=x.metallic:8=0.2 -o b.exr").code, 0);
    EXPECT_NE(read_text(folder / "a.exr"), read_text(folder / "b.exr"));
    fs::rename(folder / "roughness.exr", folder / "a=b.exr");
    ASSERT_EQ(run("render scene.xml --spp 4 --texture metallic=a=b.exr -o b.exr").code, 65)
        << "8 x 8 texels for one";
    ASSERT_EQ(run("render scene.xml --spp 4 --texture metallic:8=a=b.exr -o b.exr").code, 0);
    const Outcome outcome =
        run("optimize scene.xml --parameter mat@2=x.metallic --parameter "
            "mat@2=x.roughness:8@0.02 --init 0.5 --iterations 1 --spp 1 --target-spp 1 "
            "--evaluation-spp 1 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(summary_of("out")["parameters"][1]["size"], json({8, 8, 1}));
}

TEST_F(ConstantsTest, DiffTransGoesToTwoAndUnknownsToOne) {
    std::string scene = read_text(folder / "scene.xml");
    const std::size_t begin = scene.find("<bsdf type=\"twosided\""), end = scene.find("<shape");
    scene.replace(begin, end - begin,
                  "<bsdf type=\"principledthin\" id=\"mat-panel\"><float name=\"diff_trans\" "
                  "value=\"1.6\"/></bsdf>");
    write_text(folder / "scene.xml", scene);
    ASSERT_EQ(run("render scene.xml --spp 4 -o a.exr").code, 0);
    ASSERT_EQ(run("render scene.xml --spp 4 --texture diff_trans=1.6 -o b.exr").code, 0);
    EXPECT_EQ(read_text(folder / "a.exr"), read_text(folder / "b.exr"));
    expect_refused("render scene.xml --texture diff_trans=2.1 -o b.exr", 65, "outside of [0, 2]");
    const Outcome outcome =
        run("optimize scene.xml --parameter diff_trans --init 0.5 --iterations 1 --spp 1 "
            "--target-spp 1 --evaluation-spp 1 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string warning =
        "the truth of mat-panel.diff_trans.value holds 1 value outside of [0, 1], which no unknown "
        "takes";
    EXPECT_TRUE(contains(outcome.err, warning)) << outcome.err;
    EXPECT_EQ(summary_of("out")["scene_warnings"], json({warning}));
}

}  // namespace
}  // namespace burnish
