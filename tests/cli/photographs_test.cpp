// Photographs on the command line: encodings, exposures, sizes, and what is said of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/html.h"
#include "cli/program.h"
#include "cli/view_pictures.h"
#include "optimize/view_loss.h"

namespace burnish {
namespace {

using namespace testing;

struct PhotographsTest : Program {
    using json = nlohmann::json;

    // At twice the rate the scale that texture and exposures share wanders by 1 to 7 %, under
    // relMSE and under reweighted pixels alike.
    const std::string optimize =
        "optimize capture.json --parameter base_color --iterations 800 --learning-rate 0.01 "
        "--init 0.5 --evaluation-spp 64 ";

    PhotographsTest() { write_scene(); }

    static std::string camera(double x) {
        return R"({"model": "SIMPLE_PINHOLE", "width": 40, "height": 32, "params": [40, 20, 16],)"
               R"( "camera_to_world": [[1,0,0,)" +
               std::to_string(x) + R"(],[0,-1,0,0],[0,0,-1,2.5],[0,0,0,1]]})";
    }
    /// A capture of three views from several places, with these keys besides.
    void write_capture(const std::vector<std::string>& keys) const {
        std::string views;
        for (std::size_t i = 0; i < keys.size(); ++i)
            views += (i ? ",\n" : "") + std::string(R"({"name": "v)") + std::to_string(i) +
                     R"(", "camera": )" + camera(0.3 * static_cast<double>(i) - 0.3) + keys[i] +
                     "}";
        write_text(folder / "capture.json",
                   R"({"version": 1, "scene": "scene.xml", "views": [)" + views + "]}");
    }
    /// Linear pictures of the three views: 512 samples.
    std::vector<Image> true_pictures() const {
        write_capture({"", "", ""});
        const Outcome outcome =
            run("optimize capture.json --parameter base_color --iterations 1 --init 0.5 "
                "--evaluation-spp 2 --target-spp 512 -o rendered");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        std::vector<Image> pictures;
        for (const char* name : {"v0", "v1", "v2"})
            pictures.push_back(
                read_image((folder / "rendered/views" / name / "target.exr").string()));
        return pictures;
    }
    /// Root mean square error of a recovered base colour.
    double error_of(const std::string& run) const {
        const Image truth = read_image((folder / "color.exr").string());
        const Image found =
            read_image((folder / run / "textures/mat-panel.brdf_0.base_color.data.exr").string());
        double sum = 0;
        for (std::size_t i = 0; i < truth.values.size(); ++i)
            sum += std::pow(double{found.values[i]} - double{truth.values[i]}, 2);
        return std::sqrt(sum / static_cast<double>(truth.values.size()));
    }
};

/// Exposures are as in the photographs to a per cent, and the texture is nearly as good as where
/// they are known.
TEST_F(PhotographsTest, ExposuresAreRecovered) {
    const std::vector<Image> pictures = true_pictures();
    float brightest = 0;
    for (const Image& p : pictures)
        for (const float v : p.values) brightest = std::max(brightest, v);
    const float exposures[] = {1, 0.6f, 1.7f};
    std::vector<std::string> known, fitted;
    for (std::size_t i = 0; i < 3; ++i) {
        const float e = 0.5f * exposures[i] / brightest;  // nothing is clipped
        write_image((folder / ("p" + std::to_string(i) + ".png")).string(),
                    exposed(ExposureFactors{e, e, e}, pictures[i]));
        const std::string image = R"(, "image": "p)" + std::to_string(i) + R"(.png", "exposure": )";
        known.push_back(image + std::to_string(e));
        fitted.push_back(image + (i == 0 ? std::to_string(e) : i == 1 ? "\"fit\"" : "\"fit_rgb\""));
    }
    write_capture(known);
    ASSERT_EQ(run(optimize + "-o known").code, 0);
    write_capture(fitted);
    const Outcome outcome = run(optimize + "-o fitted");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_FALSE(contains(outcome.err, "every exposure is fitted")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "3 pictures: PNG, 8 bits, sRGB\n")) << outcome.err;
    EXPECT_FALSE(contains(outcome.err, "p1.png: PNG")) << "one line of all";
    const json views = summary_of("fitted")["views"];
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(views[i]["exposure_fitted"], i > 0);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(views[i]["exposure"][c], double{0.5f * exposures[i] / brightest},
                        0.01 * double{0.5f * exposures[i] / brightest})
                << i;
    }
    EXPECT_LT(error_of("fitted"), 1.1 * error_of("known") + 0.002);
    EXPECT_LT(error_of("fitted"), 0.1);
    const HtmlReader report(read_text(folder / "fitted/report.html"));
    EXPECT_TRUE(report.errors.empty()) << report.errors[0];
    EXPECT_TRUE(contains(report.text, "(fitted)"));
    EXPECT_TRUE(contains(report.text, "3 pictures: PNG, 8 bits, sRGB")) << report.text;
    EXPECT_FALSE(contains(report.text, "p1.png: PNG")) << "one note of all";

    ASSERT_EQ(run(optimize + "-o again --threads 3").code, 0);
    EXPECT_EQ(error_of("again"), error_of("fitted"));
    ASSERT_EQ(run("optimize --options fitted/summary.json -o repeated").code, 0);
    EXPECT_EQ(error_of("repeated"), error_of("fitted"));
}

/// PSNR and SSIM do not depend on what a channel without weight holds.
TEST_F(PhotographsTest, AChannelThatDoesNotCountIsNotCompared) {
    std::string scene = read_text(folder / "scene.xml");
    const std::string fov = "<float name=\"fov\" value=\"40\"/>";
    ASSERT_TRUE(contains(scene, fov));
    // The panel in the middle of the picture: windows of SSIM reach beyond it.
    write_text(folder / "scene.xml",
               scene.replace(scene.find(fov), fov.size(), "<float name=\"fov\" value=\"60\"/>"));
    ASSERT_EQ(run("render scene.xml --spp 64 -o whole.exr").code, 0);
    Image picture = read_image((folder / "whole.exr").string());
    Image mask = make_image(picture.width, picture.height, 3, 1);
    for (std::size_t i = 0; i < mask.values.size(); i += 3) mask.values[i] = 0;
    write_image((folder / "mask.exr").string(), mask);
    std::vector<json> views;
    for (const float red : {0.1f, 7.0f}) {
        for (std::size_t i = 0; i < picture.values.size(); i += 3) picture.values[i] = red;
        write_image((folder / "picture.exr").string(), picture);
        const Outcome outcome =
            run("optimize scene.xml --parameter base_color --iterations 2 --target picture.exr "
                "--mask mask.exr --evaluation-spp 4 -o out");
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        views.push_back(summary_of("out")["views"][0]);
    }
    for (const char* number : {"psnr", "ssim"}) {
        ASSERT_TRUE(views[0][number].is_number()) << number;
        EXPECT_EQ(views[0][number], views[1][number]) << number;
    }
    EXPECT_GT(views[0]["ssim"], 0.3);
}

TEST_F(PhotographsTest, HowFilesWereReadIsSaid) {
    std::vector<Image> pictures = true_pictures();
    for (Image& p : pictures)
        for (float& v : p.values) v *= 0.05f;
    pictures[0].at(3, 4, 1) = pictures[0].at(9, 9, 0) = 1;
    write_image((folder / "p0.png").string(), pictures[0]);
    pictures[1].at(1, 1, 2) = -1;
    write_image((folder / "p1.exr").string(), pictures[1]);
    write_image((folder / "p2.png").string(), with_channels(pictures[2], 1));
    const std::string fit = R"(, "exposure": "fit")";
    write_capture({R"(, "image": "p0.png", "encoding": {"gamma": 2.2})" + fit,
                   R"(, "image": "p1.exr")" + fit, R"(, "image": "p2.png", "split": "test")"});
    const Outcome outcome =
        run("optimize capture.json --parameter base_color --iterations 2 --init 0.5 "
            "--evaluation-spp 2 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* text :
         {"p0.png: PNG, 8 bits, gamma 2.2, 2 pixels clipped and left out",
          "p1.exr: EXR, 32 bits, linear", "v1 (p1.exr): 1 pixel has values below 0",
          "v2 (p2.png) is grey", "every exposure is fitted and a colour is unknown"})
        EXPECT_TRUE(contains(outcome.err, text)) << text << "\n" << outcome.err;
    const json found = summary_of("out");
    EXPECT_EQ(found["views"][0]["picture"]["clipped_pixels"], 2);
    EXPECT_EQ(found["views"][0]["picture"]["encoding"], "gamma 2.2");
    EXPECT_EQ(found["views"][1]["picture"]["negative_pixels"], 1);
    EXPECT_EQ(found["views"][2]["picture"]["gray"], true);
    EXPECT_EQ(found["picture_warnings"].size(), 3u);
}

TEST_F(PhotographsTest, HowMasksWereReadIsSaid) {
    Image segments = make_image(40, 32, 3, 0.25f);
    for (int y = 0; y < 32; ++y) segments.at(20, y, 0) = 1;
    write_image((folder / "m0.exr").string(), segments);
    for (int c = 0; c < 3; ++c) segments.at(9, 9, c) = 1;
    write_image((folder / "m1.exr").string(), segments);
    write_image((folder / "m2.png").string(), make_image(40, 32, 1, 1.0f));
    write_capture({R"(, "mask": "m0.exr")", R"(, "mask": "m1.exr")", R"(, "mask": "m2.png")", ""});
    const Outcome outcome =
        run("optimize capture.json --parameter base_color --iterations 1 --init 0.5 "
            "--target-spp 2 --evaluation-spp 2 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::vector<std::string> texts{
        "m0.exr and 1 other: masks from their colours, each channel for its own",
        "m2.png: mask from its grey levels",
        "v0 (m0.exr): its weights are colours, at most 0.25 in all three channels of a pixel: "
        "expected white where the picture counts"};
    const HtmlReader report(read_text(folder / "out/report.html"));
    for (const std::string& text : texts) {
        EXPECT_TRUE(contains(outcome.err, text)) << text << "\n" << outcome.err;
        EXPECT_TRUE(contains(report.text, text)) << text;
    }
    const json found = summary_of("out");
    EXPECT_EQ(found["picture_warnings"].size(), 1u) << "of m0 alone";
    EXPECT_EQ(found["views"][0]["mask"], json({{"file", "m0.exr"}, {"from", "colors"}}));
    EXPECT_EQ(found["views"][2]["mask"], json({{"file", "m2.png"}, {"from", "gray"}}));
    EXPECT_FALSE(found["views"][3].contains("mask"));
}

/// v0 sees the panel; v1 and, held out, v2 look past it.
TEST_F(PhotographsTest, ViewsThatShowNothingOfAnUnknownAreSaid) {
    const auto view = [](const std::string& name, int x, const std::string& keys) {
        return R"({"name": ")" + name + R"(", "camera": )" + camera(x) + keys + "}";
    };
    const std::string past = view("v1", 90, "") + ", " + view("v2", 90, R"(, "split": "test")");
    const auto write = [&](const std::string& views) {
        write_text(folder / "capture.json",
                   R"({"version": 1, "scene": "scene.xml", "views": [)" + views + "]}");
    };
    const std::string command =
        "optimize capture.json --parameter roughness --iterations 1 --init 0.5 --target-spp 2 "
        "--evaluation-spp 2 --force -o out";
    const std::string warning =
        "no pixel of v1, v2 can show mat-panel.brdf_0.roughness.data: expected cameras in the "
        "units and axes of the scene";
    const std::string direct = read_text(folder / "scene.xml"), integrator = R"(type="direct")";
    std::string bouncing = direct;
    bouncing.replace(bouncing.find(integrator), integrator.size(), R"(type="path")");
    for (const std::string& scene : {direct, bouncing}) {
        write_text(folder / "scene.xml", scene);
        write(view("v0", 0, "") + ", " + past);
        const Outcome outcome = run(command);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, warning)) << outcome.err;
        const json found = summary_of("out");
        EXPECT_EQ(found["picture_warnings"][0], warning);
        EXPECT_TRUE(found["views"][0].contains("ssim"));
        for (const int i : {1, 2})
            for (const char* key : {"psnr", "ssim"}) EXPECT_FALSE(found["views"][i].contains(key));
        EXPECT_TRUE(contains(HtmlReader(read_text(folder / "out/report.html")).text, warning));
        const Outcome facts = run("info capture.json");
        EXPECT_TRUE(contains(facts.out, "coarse pictures of v1, v2 show no shape at all"))
            << facts.out;
        write(past);
        expect_refused(command, 65, "no view that is fitted sees mat-panel.brdf_0.roughness.data");
    }
    write(view("v0", 0, "") + ", " + view("v1", 90, ""));
    EXPECT_TRUE(contains(run("info capture.json").out, "a coarse picture of v1 shows no shape"));
}

/// Where light bounces, another surface may show the light of an unknown.
TEST_F(PhotographsTest, AViewMayShowAnUnknownByAnotherSurface) {
    std::string scene = read_text(folder / "scene.xml");
    scene.insert(scene.find("</scene>"), R"(<shape type="rectangle" id="screen">
        <transform name="to_world"><translate x="90"/></transform><bsdf type="diffuse"/></shape>)");
    const std::string integrator = R"(type="direct")";
    const auto warns = [&] {
        const Outcome outcome =
            run("optimize capture.json --parameter roughness --iterations 1 --init 0.5 "
                "--target-spp 2 --evaluation-spp 2 --force -o out");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return contains(outcome.err, "no pixel of v1 can show");
    };
    write_text(folder / "capture.json",
               R"({"version": 1, "scene": "scene.xml", "views": [{"name": "v0", "camera": )" +
                   camera(0) + R"(}, {"name": "v1", "camera": )" + camera(90) + "}]}");
    write_text(folder / "scene.xml", scene);
    EXPECT_TRUE(warns()) << "the screen alone";
    EXPECT_FALSE(contains(run("info capture.json").out, "no shape at all"));
    scene.replace(scene.find(integrator), integrator.size(), R"(type="path")");
    write_text(folder / "scene.xml", scene);
    EXPECT_FALSE(warns());
}

TEST(DecodingTexts, PicturesThatWereReadAlikeShareOne) {
    std::vector<CapturedView> views(4);
    for (std::size_t i = 0; i < 4; ++i) views[i].image = fmt::format("p{}.png", i);
    std::vector<Photograph> photographs(4);
    for (std::size_t i = 0; i < 3; ++i) {
        Photograph& p = photographs[i];
        p.type = "PNG", p.bits = 8, p.encoding = SrgbEncoding{};
        p.clipped = make_image(1, 1, 1, 1), p.clipped_pixels = 10 * (i + 1);
    }
    const auto texts = [&] { return decoding_texts(views, photographs); };
    using Texts = std::vector<std::string>;
    EXPECT_EQ(texts(), Texts{"3 pictures: PNG, 8 bits, sRGB, 60 pixels clipped and left out"})
        << "the last one is rendered";
    photographs[1].encoding = LinearEncoding{};
    EXPECT_EQ(texts(),
              (Texts{"p0.png and 1 other: PNG, 8 bits, sRGB, 40 pixels clipped and left out",
                     "p1.png: PNG, 8 bits, linear, 20 pixels clipped and left out"}));
}

TEST_F(PhotographsTest, WhatIsNotReadOfAFileIsSaid) {
    fs::copy(BURNISH_TEST_DATA "/../fuzz/corpus/jpeg/profile.jpg", folder / "p0.jpg");
    fs::copy(BURNISH_TEST_DATA "/../fuzz/corpus/jpeg/uncalibrated.jpg", folder / "p1.jpg");
    const std::string matrix = R"("transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]})";
    write_text(folder / "transforms.json",
               R"({"camera_angle_x": 0.8, "frames": [{"file_path": "p0.jpg", )" + matrix +
                   R"(, {"file_path": "p1.jpg", )" + matrix + "]}");
    const Outcome outcome =
        run("optimize scene.xml --views transforms.json --parameter base_color --iterations 1 "
            "--init 0.5 --evaluation-spp 2 -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* text :
         {"2 pictures: JPEG, 8 bits, sRGB, EXIF orientation 6 left out",
          "p0.jpg (p0.jpg) has the colour profile \"Display P3\", which is not read: convert it to "
          "sRGB",
          "p1.jpg (p1.jpg) has the colour profile \"uncalibrated by EXIF, as of Adobe RGB\", which "
          "is not read: convert it to sRGB"})
        EXPECT_TRUE(contains(outcome.err, text)) << text << "\n" << outcome.err;
    const json picture = summary_of("out")["views"][0]["picture"];
    EXPECT_EQ(picture["orientation"], 6);
    EXPECT_EQ(picture["turned"], false);
    EXPECT_EQ(picture["profile"], "Display P3");
}

TEST_F(PhotographsTest, LinearPicturesThatAreDecodedAsSrgbAreSaid) {
    const std::string corpus = BURNISH_TEST_DATA "/../fuzz/corpus/";
    const auto utf16 = [](const std::string& text) {
        std::string units;
        for (const char c : text) units += {'\0', c};
        return units;
    };
    std::string jpeg = read_text(corpus + "jpeg/profile.jpg");
    const std::string display = utf16("Display P3");
    ASSERT_TRUE(contains(jpeg, display));
    write_text(folder / "p0.jpg",
               jpeg.replace(jpeg.find(display), display.size(), utf16("sRGB-a-g10")));
    std::string png = read_text(corpus + "png/rgb.png");
    constexpr std::size_t kFirst = 33;  // bytes before the chunks that follow IHDR
    write_text(folder / "p1.png",
               png.insert(kFirst, "\0\0\0\4gAMA\0\1\x86\xa0\x31\xe8\x96\x5f", 16));
    const auto warnings = [&](const std::string& keys) {
        const auto view = [&](const char* file, int width, int height) {
            return fmt::format(
                R"({{"name": "{0}", "image": "{0}", "orientation": "stored", "exposure": 1{1},)"
                R"("camera": {{"model": "SIMPLE_PINHOLE", "width": {2}, "height": {3},)"
                R"("params": [{2}, {4}, {5}],)"
                R"("camera_to_world": [[1,0,0,0],[0,-1,0,0],[0,0,-1,2.5],[0,0,0,1]]}}}})",
                file, keys, width, height, 0.5 * width, 0.5 * height);
        };
        write_text(folder / "capture.json", R"({"version": 1, "scene": "scene.xml", "views": [)" +
                                                view("p0.jpg", 28, 20) + ", " +
                                                view("p1.png", 7, 5) + "]}");
        const Outcome outcome =
            run("optimize capture.json --parameter base_color --iterations 1 --init 0.5 "
                "--evaluation-spp 2 --force -o out");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return summary_of("out")["picture_warnings"];
    };
    const std::string is_not_read =
        ", which is not read: give \"encoding\": \"linear\" in a capture";
    EXPECT_EQ(warnings(""),
              json({"p0.jpg (p0.jpg) has the linear profile \"sRGB-a-g10\"" + is_not_read,
                    "p1.png (p1.png) has the gamma 1 of linear numbers" + is_not_read}));
    EXPECT_EQ(warnings(R"(, "encoding": "linear")"), json::array());
}

/// They leave out what is white.
TEST_F(PhotographsTest, MasksOfInstantNgpAreSaidOnce) {
    for (const char* name : {"p0.png", "p1.png", "dynamic_mask_p0.png", "dynamic_mask_p1.png"})
        write_image(folder / name, make_image(24, 24, 3, 0.25f));
    const auto warnings = [&](const std::string& keys) {
        const std::string matrix =
            R"("transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]})";
        write_text(folder / "transforms.json",
                   R"({"camera_angle_x": 0.8, )" + keys + R"("frames": [{"file_path": "p0.png", )" +
                       matrix + R"(, {"file_path": "p1.png", )" + matrix + "]}");
        const Outcome outcome =
            run("optimize scene.xml --views transforms.json --parameter base_color --iterations 1 "
                "--init 0.5 --evaluation-spp 2 --force -o out");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        std::vector<std::string> found;
        const json all = summary_of("out")["picture_warnings"];
        for (const std::string text : all)
            if (contains(text, "instant-ngp")) found.push_back(text);
        return found;
    };
    EXPECT_EQ(warnings(""),
              std::vector<std::string>{
                  "masks of instant-ngp, as dynamic_mask_p0.png, are not read: invert them, since "
                  "what is white counts, and name each as the mask of its view"});
    write_image(folder / "mask.png", make_image(24, 24, 1, 1.0f));
    EXPECT_TRUE(warnings(R"("mask_path": "mask.png", )").empty());
}

TEST_F(PhotographsTest, ASingleTargetHasAnExposureToo) {
    ASSERT_EQ(run("render scene.xml --spp 256 -o linear.exr").code, 0);
    Image photo = read_image((folder / "linear.exr").string());
    for (float& v : photo.values) v *= 0.3f;
    write_image((folder / "photo.exr").string(), photo);
    const std::string command =
        "optimize scene.xml --parameter roughness --iterations 40 --evaluation-spp 64 "
        "--target photo.exr ";
    for (const char* how : {"fit", "fit_rgb"}) {
        const Outcome outcome = run(command + "--exposure " + how + " -o " + how);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_FALSE(contains(outcome.err, "every exposure is fitted")) << "no colour is unknown";
        EXPECT_NEAR(summary_of(how)["views"][0]["exposure"][1], 0.3, 0.006) << how;
        EXPECT_TRUE(contains(read_text(folder / how / "report.html"), "Exposure, fitted: "));
    }
    ASSERT_EQ(run(command + "--exposure 0.3 -o number").code, 0);
    EXPECT_NEAR(summary_of("number")["result"]["final_loss"].get<double>(),
                summary_of("fit")["result"]["final_loss"].get<double>(), 0.002);
    ASSERT_EQ(run("optimize --options fit/summary.json -o again").code, 0);
    EXPECT_EQ(summary_of("again")["views"][0]["exposure"],
              summary_of("fit")["views"][0]["exposure"]);
    write_capture({""});
    expect_refused("optimize capture.json --parameter roughness --exposure fit -o no", 2,
                   "--exposure has no effect: it needs views that no capture");
}

TEST_F(PhotographsTest, TheFilmTakesThePicturesSize) {
    ASSERT_EQ(run("render scene.xml --size 48 48 --spp 64 -o large.exr").code, 0);
    const std::string command =
        "optimize scene.xml --parameter roughness --iterations 3 --evaluation-spp 16 --init scene ";
    ASSERT_EQ(run(command + "--target large.exr -o large").code, 0);
    EXPECT_EQ(summary_of("large")["views"][0]["size"], json({48, 48}));
    EXPECT_GT(summary_of("large")["views"][0]["psnr"], 25);
    ASSERT_EQ(run(command + "--sensor 0 --target large.exr --scale 0.5 -o half").code, 0);
    EXPECT_EQ(summary_of("half")["views"][0]["size"], json({24, 24}));
    EXPECT_GT(summary_of("half")["views"][0]["psnr"], 25);
    ASSERT_EQ(run(command + "--scale 0.75 -o rendered").code, 0);
    EXPECT_EQ(summary_of("rendered")["views"][0]["size"], json({18, 18}));
}

/// A picture's last row may be there in part, and scaling leaves out another one.
TEST_F(PhotographsTest, APictureThatFitsTheFilmDoesSoAtAnyScale) {
    const std::string side = R"(<integer name="width" value="24"/>)";
    std::string scene = read_text(folder / "scene.xml");
    scene.replace(scene.find(side), side.size(), R"(<integer name="width" value="36"/>)");
    write_text(folder / "wide.xml", scene);
    write_image(folder / "fits.exr", make_image(100, 66, 3, 0.5f));
    write_image(folder / "flat.exr", make_image(100, 65, 3, 0.5f));
    const std::string command =
        "optimize wide.xml --parameter base_color --iterations 1 --init 0.5 --evaluation-spp 1 "
        "--target ";
    for (const auto& [scale, size] : {std::pair{"0.15", json({15, 9})}, {"0.6", json({60, 39})}}) {
        const std::string options = std::string(" --scale ") + scale + " -o s" + scale;
        const Outcome outcome = run(command + "fits.exr" + options);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(summary_of(std::string("s") + scale)["views"][0]["size"], size);
        expect_refused(command + "flat.exr" + options + "-no", 65,
                       "flat.exr: the picture has 100 x 65 pixels: expected the aspect ratio "
                       "of the sensor's film, 36 x 24");
    }
    fs::copy(BURNISH_TEST_DATA "/../fuzz/corpus/jpeg/turned.jpg", folder / "turned.jpg");
    for (const char* options : {"", " --size 28 20"}) {
        const Outcome turned = run(command + "turned.jpg -o no" + options);
        EXPECT_EQ(turned.code, 65);
        EXPECT_TRUE(contains(turned.err, "turned.jpg, turned by EXIF orientation 6")) << turned.err;
    }
}

TEST_F(PhotographsTest, CropWindowsScaleWithTheirPictures) {
    const std::string film = R"(<integer name="height" value="24"/>)";
    std::string scene = read_text(folder / "scene.xml");
    scene.replace(scene.find(film), film.size(), R"(<integer name="height" value="36"/>
      <integer name="crop_offset_x" value="1"/><integer name="crop_offset_y" value="12"/>
      <integer name="crop_width" value="20"/><integer name="crop_height" value="22"/>)");
    write_text(folder / "cropped.xml", scene);
    ASSERT_EQ(run("render cropped.xml --spp 256 -o window.exr").code, 0);
    const std::string command =
        "optimize cropped.xml --parameter roughness --iterations 3 --evaluation-spp 64 "
        "--init scene ";
    for (const auto& [scale, size] : {std::pair{"0.5", json({10, 11})}, {"0.6", json({12, 13})}}) {
        const Outcome outcome =
            run(command + "--target window.exr --scale " + scale + " -o s" + scale);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const json view = summary_of(std::string("s") + scale)["views"][0];
        EXPECT_EQ(view["size"], size);
        EXPECT_GT(view["ssim"], 0.95) << scale;
        EXPECT_LT(view["loss"], 0.003) << scale;
        EXPECT_EQ(run(command + "--scale " + scale + " -o r" + scale).code, 0) << scale;
    }
    write_image(folder / "square.exr", make_image(20, 20, 3, 0.5f));
    EXPECT_TRUE(contains(run(command + "--target square.exr -o no").err,
                         "square.exr: the picture has 20 x 20 pixels: expected the aspect ratio of "
                         "the sensor's crop window, 20 x 22"));
}

TEST_F(PhotographsTest, CamerasScaleWithTheirPictures) {
    const std::vector<Image> pictures = true_pictures();
    Image mask = make_image(40, 32, 1, 1.0f);
    for (int y = 0; y < 32; ++y) mask.at(0, y, 0) = 0;
    write_image((folder / "mask.png").string(), mask);
    for (std::size_t i = 0; i < 3; ++i)
        write_image((folder / ("p" + std::to_string(i) + ".exr")).string(), pictures[i]);
    write_capture({R"(, "image": "p0.exr", "mask": "mask.png")", R"(, "image": "p1.exr")",
                   R"(, "image": "p2.exr")"});
    const std::string command =
        "optimize capture.json --parameter base_color --iterations 2 --evaluation-spp 64 "
        "--init scene ";
    for (const auto& [scale, size] : {std::pair{"0.5", json({20, 16})}, {"0.4", json({16, 12})}}) {
        const Outcome outcome = run(command + "--scale " + scale + " -o s" + scale);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const json written = summary_of(std::string("s") + scale);
        for (const json& view : written["views"]) {
            EXPECT_EQ(view["size"], size);
            EXPECT_GT(view["psnr"], 30) << scale;
        }
    }
    write_image((folder / "p1.exr").string(), make_image(20, 16, 3, 0.5f));
    expect_refused(command + "-o no", 65,
                   "the target of v1 (p1.exr) is 20 x 16 pixels, expected the size of its "
                   "camera, 40 x 32");
    write_image((folder / "p1.exr").string(), make_image(41, 33, 3, 0.5f));
    const Outcome larger = run(command + "--scale 0.25 -o no");  // to 10 x 8 pixels, as the camera
    EXPECT_EQ(larger.code, 65);
    EXPECT_TRUE(contains(larger.err, "the target of v1 (p1.exr) is 41 x 33 pixels")) << larger.err;
    fs::copy(BURNISH_TEST_DATA "/../fuzz/corpus/jpeg/turned.jpg", folder / "turned.jpg");
    write_capture({R"(, "image": "turned.jpg")"});
    const Outcome turned = run(command + "-o no");
    EXPECT_TRUE(contains(turned.err,
                         "the target (turned.jpg, turned by EXIF orientation 6) is 20 x 28 "
                         "pixels, expected the size of its camera, 40 x 32"))
        << turned.err;
    write_image((folder / "p1.png").string(), make_image(40, 32, 3, 1.0f));
    write_capture({R"(, "image": "p1.png")"});
    EXPECT_TRUE(contains(run(command + "-o no").err, "no pixel counts"));
}

}  // namespace
}  // namespace burnish
