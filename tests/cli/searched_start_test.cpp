// The search for the start, as `burnish optimize` begins, repeats and compares it.
#include <nlohmann/json.hpp>

#include "cli/program.h"

namespace burnish {
namespace {

using namespace testing;

class SearchedStart : public Program {
  protected:
    SearchedStart() { write_scene(); }
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
        return summary_of("out")["result"]["search"]["groups"];
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
    EXPECT_EQ(summary_of("long")["settings"]["search_effort"], 4);
    const auto groups = [&](const char* out, const char* of) {
        return summary_of(out)[of]["search"]["groups"];
    };
    ASSERT_FALSE(groups("long", "result").empty());
    EXPECT_NE(groups("short", "result"), groups("long", "result"));
    EXPECT_EQ(groups("long", "compared"), groups("long", "result"));
    EXPECT_EQ(groups("again", "result"), groups("long", "result"));
    expect_same_files(folder / "long", folder / "again");
    EXPECT_EQ(summary_of("long")["seconds"]["second search for the start"],
              summary_of("long")["compared"]["search"]["seconds"]);
}

/// A texture of 8 x 8 texels in the place of a reflectance.
std::string texture(const std::string& name, const std::string& file) {
    return "<texture type=\"bitmap\" name=\"" + name + "\"><string name=\"filename\" value=\"" +
           file + "\"/><boolean name=\"raw\" value=\"true\"/></texture>";
}

class SearchedMaterial : public SearchedStart {
  protected:
    /// The panel has this material.
    void set_material(const std::string& material) const {
        std::string scene = read_text(folder / "scene.xml");
        const std::size_t begin = scene.find("<bsdf type=\"twosided\"");
        const std::string end = "</bsdf>\n  </bsdf>";
        scene.replace(begin, scene.find(end, begin) + end.size() - begin, material);
        write_text(folder / "scene.xml", scene);
    }
};

/// Light that bounces to and fro in a bright room multiplies what colours found one by one reflect.
TEST_F(SearchedMaterial, ColorsOfABrightRoomDoNotBlowUp) {
    write_image(folder / "bright.exr", make_image(8, 8, 3, 0.85f));
    write_text(folder / "room.xml", R"(<scene version="3.0.0"><integrator type="path"/>
  <sensor type="perspective"><float name="fov" value="60"/>
    <transform name="to_world"><lookat origin="0,0,2.5" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
      <rfilter type="box"/></film></sensor>
  <bsdf type="diffuse" id="mat">)" + texture("reflectance", "bright.exr") +
                                        R"(</bsdf>
  <shape type="cube"><boolean name="flip_normals" value="true"/>
    <transform name="to_world"><scale value="3"/></transform><ref id="mat"/></shape>
  <shape type="rectangle"><transform name="to_world">
      <lookat origin="0,2.9,0" target="0,0,0" up="0,0,1"/></transform>
    <emitter type="area"><rgb name="radiance" value="8"/></emitter></shape></scene>)");
    const auto loss_from = [&](const std::string& start) {
        const Outcome outcome =
            run("optimize room.xml --parameter reflectance --target-spp 64 "
                "--iterations 1 --evaluation-spp 32 --force -o out --init " +
                start);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return summary_of("out")["result"]["initial_loss"].get<double>();
    };
    EXPECT_LT(loss_from("search"), loss_from("0.5"));
}

/// One picture tells one colour of a material, and not two by the same ratio.
TEST_F(SearchedMaterial, OneOfTwoColorsIsSearched) {
    write_image(folder / "dark.exr", make_image(8, 8, 3, 0.2f));
    write_image(folder / "bright.exr", make_image(8, 8, 3, 0.8f));
    set_material("<bsdf type=\"twosided\" id=\"mat-panel\"><bsdf type=\"roughplastic\">" +
                 texture("diffuse_reflectance", "dark.exr") +
                 texture("specular_reflectance", "bright.exr") + "</bsdf></bsdf>");
    const Outcome outcome =
        run("optimize scene.xml --parameter diffuse_reflectance --parameter specular_reflectance "
            "--target-spp 64 --iterations 1 --learning-rate 1e-9 --set adam.initial_rate=0 "
            "--evaluation-spp 2 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_FALSE(contains(outcome.err, "no part of a picture shows")) << outcome.err;
    const auto start = [&](const std::string& name) {
        for (const auto& entry : fs::directory_iterator(folder / "out/textures"))
            if (contains(entry.path().string(), name) && entry.path().extension() == ".exr")
                return read_image(entry.path().string()).at(4, 4, 0);
        return -1.0f;
    };
    EXPECT_NEAR(start("specular_reflectance.data.exr"), 0.5f, 1e-3f);
    EXPECT_NEAR(start("diffuse_reflectance.data.exr"), 0.2f, 0.1f);
}

/// Where both parts of a blend are unknown no square shows one alone.
TEST_F(SearchedMaterial, WhatPicturesOnlyShowMixedIsSaid) {
    write_image(folder / "dark.exr", make_image(8, 8, 3, 0.2f));
    write_image(folder / "bright.exr", make_image(8, 8, 3, 0.8f));
    set_material(
        "<bsdf type=\"twosided\" id=\"mat-panel\"><bsdf type=\"blendbsdf\"><float name=\"weight\" "
        "value=\"0.5\"/><bsdf type=\"diffuse\">" +
        texture("reflectance", "dark.exr") + "</bsdf><bsdf type=\"diffuse\">" +
        texture("reflectance", "bright.exr") + "</bsdf></bsdf></bsdf>");
    const Outcome outcome =
        run("optimize scene.xml --parameter bsdf_0.reflectance --parameter bsdf_1.reflectance "
            "--target-spp 16 --iterations 2 --evaluation-spp 2 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err,
                         "bsdf_1.reflectance.data without other textures that are "
                         "searched: the start is 0.5"))
        << outcome.err;
    EXPECT_TRUE(contains(read_text(folder / "out/report.html"), "without other textures"));
}

}  // namespace
}  // namespace burnish
