// COLMAP's reconstructions: what they mean, and what is said where one is wrong.
#include "captures/views_colmap.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "cli/program.h"
#include "core/random.h"
#include "csv.h"
#include "error_of.h"

namespace burnish {
namespace {

using namespace testing;

const fs::path kData = fs::path(BURNISH_TEST_DATA) / "cameras" / "colmap";

struct Colmap : Program {
    fs::path model = folder / "sparse";

    /// A copy of the reconstruction in a format.
    void copy(const std::string& form) const {
        fs::remove_all(model);
        fs::copy(kData / form, model);
    }
    std::string complaint() const {
        return test::error_of([&] { EXPECT_FALSE(read_colmap(model.string(), "photos").empty()); });
    }
};

const Camera& colmap_camera(const CapturedView& view) { return std::get<Camera>(view.view.camera); }

TEST_F(Colmap, IsReadFromTextAndBinaryAlike) {
    const auto text = read_colmap((kData / "text").string(), "photos");
    const auto binary = read_colmap((kData / "binary").string(), "photos");
    ASSERT_EQ(text.size(), 4u);
    ASSERT_EQ(binary.size(), 4u);
    for (std::size_t i = 0; i < text.size(); ++i) {
        EXPECT_EQ(text[i].view.name, binary[i].view.name);
        EXPECT_EQ(text[i].image, binary[i].image);
        EXPECT_EQ(colmap_camera(text[i]), colmap_camera(binary[i]));
    }
    EXPECT_EQ(text[0].view.name, "back.jpg");
    EXPECT_EQ(text[3].view.name, "wide/side one.png");
    EXPECT_EQ(text[3].image, (fs::path("photos") / "wide/side one.png").string());
    const Camera& front = colmap_camera(text[1]);
    EXPECT_EQ(front.width, 640);
    EXPECT_EQ(front.focal_y, 500);
    EXPECT_EQ(front.lens, (Lens{LensKind::kBrownConrady, {-0.1}}));
    EXPECT_EQ(colmap_camera(text[2]).lens, (Lens{LensKind::kFisheye, {0.02, -0.01, 0.002, 0}}));
    EXPECT_EQ(colmap_camera(text[2]).focal_y, 212);
}

TEST_F(Colmap, CamerasStandWhereColmapHasThem) {
    const auto views = read_colmap((kData / "text").string(), "photos");
    const auto poses = test::read_csv(kData / "poses.csv");
    ASSERT_EQ(poses.size(), views.size());
    for (std::size_t i = 0; i < views.size(); ++i)
        for (std::size_t row = 0; row < 3; ++row)
            for (std::size_t column = 0; column < 4; ++column)
                EXPECT_NEAR(colmap_camera(views[i]).camera_to_world[4 * row + column],
                            (poses[i]["m" + std::to_string(row) + std::to_string(column)]), 1e-12);
}

TEST_F(Colmap, ABinaryOneCountsBeforeText) {
    copy("binary");
    fs::copy(kData / "text" / "cameras.txt", model);
    write_text(model / "images.txt", "nothing");
    EXPECT_EQ(complaint(), "");
    fs::remove(model / "images.bin");
    EXPECT_TRUE(
        contains(complaint(), "images.txt:1: found \"nothing\", expected the id of an image"))
        << complaint();
    fs::remove(model / "cameras.txt");
    EXPECT_TRUE(
        contains(complaint(), "sparse: expected cameras.bin and images.bin, or cameras.txt"));
}

TEST_F(Colmap, AFolderWithoutOneIsSaidWithWhatItHolds) {
    write_scene();
    copy("text");
    const auto expect = [&](const std::string& views, const std::string& message) {
        for (const char* images : {"", " --images photos"})
            expect_refused("info scene.xml --views " + views + images, 65, message);
    };
    expect(".", ".: found a COLMAP reconstruction in sparse, expected ./sparse");
    fs::create_directories(folder / "project/sparse");
    fs::rename(model, folder / "project/sparse/0");
    expect("project/sparse",
           "project/sparse: found a COLMAP reconstruction in 0, expected project/sparse/0");
    expect("project",
           "project: found a COLMAP reconstruction in sparse/0, expected project/sparse/0");
    write_text(folder / "project/transforms.json", "{}");
    expect("project",
           "project: found the folder of a transforms.json, expected the file: "
           "project/transforms.json");
    fs::create_directory(folder / "empty");
    expect("empty", "empty: expected cameras.bin and images.bin, or cameras.txt and images.txt");
}

TEST_F(Colmap, TextMayBeginWithAByteOrderMark) {
    const std::string mark = "\xEF\xBB\xBF";
    fs::create_directories(model);
    write_text(model / "cameras.txt", mark + "1 PINHOLE 640 480 500 500 320 240\n");
    write_text(model / "images.txt", mark + "1 1 0 0 0 0 0 0 1 a.png\n\n");
    EXPECT_EQ(complaint(), "");
}

struct BadText {
    std::string cameras, images, message;
};

TEST_F(Colmap, WhatIsWrongInTextIsSaidWithItsLine) {
    const std::string camera = "# comment\n\n1 PINHOLE 640 480 500 500 320 240\n";
    const std::string image = "1 1 0 0 0 0 0 0 1 a.png\n";
    const BadText kBad[] = {
        {camera, "", "sparse: found no image, expected at least one"},
        {"x", image, "cameras.txt:1: found \"x\", expected the id of a camera"},
        {"1 FOV 4 4 1 2 3 4 5", image, "found \"FOV\", expected one of SIMPLE_PINHOLE, PINHOLE"},
        {"1 PINHOLE 4 40000 1 2 3 4", image, "found a side of 40000 pixels, expected 1 to 32768"},
        {"1 PINHOLE 4 4.5 1 2 3 4", image, "found a side of 4.5 pixels"},
        {"1 PINHOLE 4 4 1 2 3", image, "cameras.txt:1: found \"1 PINHOLE 4 4 1 2 3\", expected 4"},
        {"1 PINHOLE 4 4 1 2 3 4 5", image, "found \"5\", expected no more than the 4 parameters"},
        {"1 PINHOLE 4 4 0 2 3 4", image,
         "cameras.txt:1: found the parameter 0 of PINHOLE, expected a focal length above 0"},
        {"1 PINHOLE 4 4 1 inf 3 4", image, "found the parameter inf of PINHOLE, expected a focal"},
        {"1 RADIAL 4 4 1 2 3 nan 0", image,
         "cameras.txt:1: found the parameter nan of RADIAL, expected a finite number"},
        {camera + camera, image, "there are two cameras 1"},
        {camera, "1 1 0 0 0 0 0 0 2 a.png",
         "images.txt:1: found the camera 2, expected one of the 1"},
        {camera, "1 1 0 0 0 0 0 0 1", "expected the name of an image"},
        {camera, "1 1 0 0 z 0 0 0 1 a.png", "found \"z\", expected a quaternion"},
        {camera, "1 2 0 0 0 0 0 0 1 a.png", "found a quaternion of length 2, expected 1"},
        {camera, "1 nan 0 0 0 0 0 0 1 a.png", "found a quaternion of length nan, expected 1"},
        {camera, "1 1 0 0 0 inf 0 0 1 a.png", "found the translation (inf, 0, 0)"},
        {camera, "1 1 0 0 0 0 0 0 1 ../a.png",
         "found the name \"../a.png\", expected a path within"},
        {camera, "1 1 0 0 0 0 0 0 1 /a.png", "expected a path within the folder of the images"},
        {camera, image + "\n" + image, "images.txt:3: there is another image \"a.png\""},
        {camera, "#\n" + image + image,
         "images.txt:3: found \"1 1 0 0 0 0 0 0 1 a.png\", expected "
         "the points of the image before"},
    };
    for (const BadText& bad : kBad) {
        fs::create_directories(model);
        write_text(model / "cameras.txt", bad.cameras);
        write_text(model / "images.txt", bad.images);
        EXPECT_TRUE(contains(complaint(), bad.message)) << bad.message << "\n" << complaint();
    }
}

TEST_F(Colmap, WhatIsWrongInBinaryIsSaidWithItsByte) {
    const auto changed = [&](const char* file, std::size_t at, const std::string& bytes) {
        copy("binary");
        std::string content = read_text(model / file);
        content.replace(at, bytes.size(), bytes);
        write_text(model / file, content);
        return complaint();
    };
    const std::string many(8, '\x7f');
    EXPECT_TRUE(contains(changed("cameras.bin", 0, many),
                         "cameras.bin, byte 0: found the number of cameras 9187201950435737471, "
                         "expected at most 3 in the 144 bytes that follow"));
    EXPECT_TRUE(contains(changed("cameras.bin", 12, "\x07"),
                         "cameras.bin, byte 8: found the camera model FOV, expected one of"));
    EXPECT_TRUE(contains(changed("cameras.bin", 12, "\x63"), "found the camera model 99"));
    EXPECT_TRUE(contains(changed("cameras.bin", 16, many), "pixels, expected 1 to 32768"));
    EXPECT_TRUE(contains(changed("cameras.bin", 32, std::string(8, '\0')),
                         "cameras.bin, byte 8: found the parameter 0 of "));
    EXPECT_TRUE(
        contains(changed("images.bin", 0, many), "images.bin, byte 0: found the number of"));
    EXPECT_TRUE(contains(changed("images.bin", 8 + 64 + 10, many), "found the number of points"));
    EXPECT_TRUE(
        contains(changed("images.bin", 8 + 60, "\x09"), "images.bin, byte 8: found the camera 9"));
    copy("binary");
    write_text(model / "images.bin", read_text(model / "images.bin") + "x");
    EXPECT_TRUE(contains(complaint(), "found 1 more bytes, expected the end")) << complaint();
}

/// Files that are cut or changed anywhere give views or an InputError.
TEST_F(Colmap, DamagedFilesAreReadOrRefused) {
    for (const std::string form : {"text", "binary"})
        for (const std::string stem : {"cameras", "images"}) {
            copy(form);
            const fs::path file = model / (stem + (form == "text" ? ".txt" : ".bin"));
            const std::string sound = read_text(file);
            int refused = 0;
            for (std::size_t size = 0; size < sound.size(); size += 3) {
                write_text(file, sound.substr(0, size));
                const bool is_refused = !complaint().empty();
                EXPECT_TRUE(is_refused || form == "text") << file << " cut to " << size;
            }
            for (std::uint32_t trial = 0; trial < 400; ++trial) {
                const auto random =
                    philox4x32({trial, 0, 0, 0}, {8, static_cast<std::uint32_t>(Stream::kTest)});
                std::string bytes = sound;
                bytes[random[0] % bytes.size()] = static_cast<char>(random[1]);
                if (trial % 2) bytes[random[2] % bytes.size()] = static_cast<char>(random[3]);
                write_text(file, bytes);
                refused += !complaint().empty();
            }
            EXPECT_GT(refused, 20) << file;
            EXPECT_LT(refused, 400) << file;
        }
}

/// Two pictures of the scene's square, by cameras in COLMAP's files.
TEST_F(Colmap, ARunFitsItsViews) {
    write_scene();
    fs::create_directories(model);
    write_text(model / "cameras.txt",
               "1 OPENCV 24 20 26 27 12 10 -0.2 0.05 0.01 0.02\n"
               "2 SIMPLE_PINHOLE 16 16 18 8 8\n");
    // The camera looks along -z, x right, y down: a turn around x by 180 degrees.
    write_text(model / "images.txt", "1 0 1 0 0 0 0 3 1 a.exr\n\n2 0 1 0 0 0.1 0 2.8 2 b.exr\n\n");
    const Outcome listed = run("info scene.xml --views sparse --images photos");
    EXPECT_EQ(listed.code, 0) << listed.err;
    EXPECT_TRUE(contains(listed.out, "a.exr            train    24 x 20    distorted"))
        << listed.out;
    EXPECT_TRUE(contains(listed.out, "b.exr            train    16 x 16    pinhole")) << listed.out;
    const auto views = read_colmap(model.string(), "photos");
    const Renderer renderer = Renderer::load((folder / "scene.xml").string());
    fs::create_directories(folder / "photos");
    for (const CapturedView& v : views)
        write_image(folder / v.image, renderer.with_camera(v.view.camera).render(64));
    const std::string command =
        "optimize scene.xml --views sparse --parameter base_color --iterations 40 --init 0.5 "
        "--learning-rate 0.05 --evaluation-spp 32 ";
    const Outcome outcome = run(command + "--images photos -o out");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto summary = summary_of("out");
    ASSERT_EQ(summary["views"].size(), 2u);
    EXPECT_EQ(summary["views"][0]["name"], "a.exr");
    EXPECT_LT(summary["result"]["final_loss"],
              0.3 * summary["result"]["initial_loss"].get<double>());
    const Outcome repeated = run("optimize --options out/summary.json -o repeated");
    ASSERT_EQ(repeated.code, 0) << repeated.err;
    EXPECT_EQ(read_text(folder / "out/textures/mat-panel.brdf_0.base_color.data.exr"),
              read_text(folder / "repeated/textures/mat-panel.brdf_0.base_color.data.exr"));
    const std::pair<const char*, const char*> kBad[] = {
        {"", "burnish: --images: expected the folder of the pictures that sparse names"},
        {"--images photos --target photos/a.exr", "--target: --views names the pictures"},
        {"--images photos --size 8 8", "--size: --views says how large"},
        {"--images photos --sensor 0", "--sensor: --views names"},
        {"--images photos --mask a.png", "burnish: --mask: one for all of --views"},
        {"--images absent", "absent/a.exr"},
        {"--images photos --hold-out c.exr",
         "--hold-out: no view is named \"c.exr\": expected one of a.exr, b.exr"},
        {"--images photos --hold-out a.exr --hold-out b.exr",
         "burnish: the problem has no view to fit"},
    };
    for (const auto& [options, message] : kBad) {
        const Outcome bad = run(command + options + " -o bad");
        EXPECT_EQ(bad.code, contains(message, ": --") ? 2 : 65) << options;
        EXPECT_TRUE(contains(bad.err, message)) << bad.err;
        EXPECT_FALSE(fs::exists(folder / "bad"));
    }
    const Outcome held = run(command + "--images photos --hold-out b.exr -o held");
    ASSERT_EQ(held.code, 0) << held.err;
    const auto of_held = summary_of("held");
    EXPECT_EQ(of_held["views"][0]["split"], "train");
    EXPECT_EQ(of_held["views"][1]["split"], "test");
    expect_refused("info scene.xml --views scene.xml", 65,
                   "scene.xml: expected the folder of a COLMAP reconstruction");
    expect_refused("info scene.xml --views absent --images photos", 65,
                   "absent: no such file or folder, expected the folder of a ");
    const Outcome alone = run("optimize scene.xml --parameter base_color --images photos -o bad");
    EXPECT_TRUE(contains(alone.err, "--images has no effect: it needs --views")) << alone.err;
}

/// A capture may say more of each view than a reconstruction.
TEST_F(Colmap, BecomesACapture) {
    write_scene();
    copy("binary");
    const Outcome outcome = run("info scene.xml --views sparse --images photos -D light=5 --json");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    write_text(folder / "capture.json", nlohmann::json::parse(outcome.out).at("capture").dump());
    const Capture capture = read_capture((folder / "capture.json").string());
    EXPECT_EQ(capture.scene, (folder / "scene.xml").string());
    EXPECT_EQ(capture.definitions, (std::map<std::string, std::string>{{"light", "5"}}));
    const auto views = read_colmap(model.string(), (folder / "photos").string());
    ASSERT_EQ(capture.views.size(), views.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
        EXPECT_EQ(capture.views[i].view.name, views[i].view.name);
        EXPECT_EQ(capture.views[i].image, views[i].image);
        EXPECT_EQ(capture.views[i].turning, Turning::kAsStored);
        EXPECT_EQ(colmap_camera(capture.views[i]), colmap_camera(views[i])) << "to the bit";
    }
}

/// Whatever a picture shows where the scene has nothing, the textures are the same to the byte.
TEST_F(Colmap, PixelsWithoutASurfaceMayBeLeftOut) {
    write_scene();
    fs::create_directories(model);
    fs::create_directories(folder / "photos");
    write_text(model / "cameras.txt", "1 SIMPLE_PINHOLE 24 20 8 12 10\n");
    write_text(model / "images.txt", "1 0 1 0 0 0 0 3 1 a.exr\n\n");
    const std::string command =
        "optimize scene.xml --views sparse --images photos --parameter base_color --iterations 8 "
        "--init 0.5 --evaluation-spp 8 --exposure fit ";
    std::string textures[2];
    for (const int k : {0, 1}) {
        Image picture = make_image(24, 20, 3, 0.3f);
        for (int x = 0; x < 24; ++x) picture.at(x, 0, 1) = k == 0 ? 0.1f : 50;
        write_image(folder / "photos/a.exr", picture);
        const std::string out = "out" + std::to_string(k);
        const Outcome outcome = run(command + "--ignore-background -o " + out);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "% of a picture, which show no surface")) << outcome.err;
        textures[k] = read_text(folder / out / "textures/mat-panel.brdf_0.base_color.data.exr");
    }
    EXPECT_EQ(textures[0], textures[1]);
    ASSERT_EQ(run(command + "-o counted").code, 0);
    EXPECT_NE(read_text(folder / "counted/textures/mat-panel.brdf_0.base_color.data.exr"),
              textures[0]);
    write_image(folder / "photos/b.exr", make_image(24, 20, 3, 0.3f));
    write_text(model / "images.txt", "1 0 1 0 0 50 0 3 1 a.exr\n\n2 0 1 0 0 0 0 3 1 b.exr\n\n");
    expect_refused(command + "--ignore-background -o away", 65,
                   "a.exr: no pixel shows a surface of the scene");
    // The panel is 1.3 pixels wide.
    write_image(folder / "photos/a.exr", make_image(4, 4, 3, 0.3f));
    write_text(model / "cameras.txt", "1 SIMPLE_PINHOLE 4 4 2 2 2\n");
    write_text(model / "images.txt", "1 0 1 0 0 0 0 3 1 a.exr\n\n");
    expect_refused(command + "--ignore-background -o tiny", 65,
                   "a.exr: every pixel that shows a surface lies at most ");
    Image clipped = make_image(24, 20, 3, 0.3f);
    for (int y = 5; y < 15; ++y)
        for (int x = 7; x < 17; ++x)
            for (int c = 0; c < 3; ++c) clipped.at(x, y, c) = 1;
    write_image(folder / "photos/a.png", clipped);
    write_text(model / "cameras.txt", "1 SIMPLE_PINHOLE 24 20 8 12 10\n");
    write_text(model / "images.txt", "1 0 1 0 0 0 0 3 1 a.png\n\n");
    expect_refused(command + "--ignore-background -o white", 65,
                   "a.png: no pixel counts: each that shows a surface ");
    std::string scene = read_text(folder / "scene.xml");
    const std::string pinhole = "type=\"perspective\">";
    scene.replace(scene.find(pinhole), pinhole.size(),
                  "type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.1\"/>"
                  "<float name=\"focus_distance\" value=\"3\"/>");
    write_text(folder / "scene.xml", scene);
    write_image(folder / "t.exr", make_image(24, 24, 3, 0.3f));
    expect_refused(
        "optimize scene.xml --target t.exr --parameter base_color --iterations 1 "
        "--init 0.5 --ignore-background -o unsharp",
        65, "the camera has an aperture, through which the background has no sharp edge");
}

}  // namespace
}  // namespace burnish
