// transforms.json: what it means, against a render of Blender's, and what is said where it is
// wrong.
#include "captures/views_transforms.h"

#include <gtest/gtest.h>

#include "burnish/error.h"
#include "burnish/renderer.h"
#include "captures/pictures.h"
#include "captures/views.h"
#include "cli/program.h"
#include "core/random.h"
#include "error_of.h"

namespace burnish {
namespace {

using namespace testing;

const fs::path kBlender = fs::path(BURNISH_TEST_DATA) / "cameras" / "blender";

struct Transforms : Program {
    fs::path file = folder / "transforms.json";

    std::vector<CapturedView> read(const std::string& text, const std::string& images = "") const {
        write_text(file, text);
        return read_transforms(file.string(), images);
    }
    std::string complaint(const std::string& text) const {
        return test::error_of([&] { EXPECT_FALSE(read(text).empty()); });
    }
};

const Camera& frame_camera(const CapturedView& view) { return std::get<Camera>(view.view.camera); }

const std::string kMatrix = R"("transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]])";
/// A file of one frame with these keys beside its path and matrix.
std::string one_frame(const std::string& keys, const std::string& of_file = "") {
    return "{" + of_file + R"("frames": [{"file_path": "a.exr", )" + kMatrix + keys + "}]}";
}

TEST_F(Transforms, SayWhatTheirViewsAre) {
    write_image(folder / "a.exr", make_image(30, 20, 3));
    fs::create_directories(folder / "train");
    write_image(folder / "train/r_0.png", make_image(30, 20, 3));
    const auto views = read(R"({"camera_angle_x": 0.8, "aabb_scale": 16, "frames": [
        {"file_path": "./train/r_0", "rotation": 0.1, )" +
                            kMatrix + R"(},
        {"file_path": "a.exr", "mask_path": "m.png", "w": 60, "h": 50, "fl_x": 70, "fl_y": 71,
         "cx": 31, "cy": 24, "k1": 0.1, "k2": -0.2, "p1": 0.01, "p2": 0.02, "k3": 0.03, )" +
                            kMatrix +
                            R"(},
        {"file_path": "b.exr", "camera_model": "OPENCV_FISHEYE", "w": 60, "h": 50, "k1": 0.1,
         "camera_angle_y": 0.5, "k4": -0.2, "is_fisheye": false, )" +
                            kMatrix + R"(}],
        "test_filenames": ["./a.exr"], "train_filenames": ["./train/r_0", "b.exr"]})");
    ASSERT_EQ(views.size(), 3u);
    EXPECT_EQ(views[0].view.name, "train/r_0");
    EXPECT_EQ(views[0].image, (folder / "train/r_0.png").string());
    const double focal = 15 / std::tan(0.4);
    EXPECT_EQ(
        frame_camera(views[0]),
        (Camera{30, 20, focal, focal, 15, 10, {1, 0, 0, 1, 0, -1, 0, 2, 0, 0, -1, 3, 0, 0, 0, 1}}));
    const Lens lens{LensKind::kBrownConrady, {0.1, -0.2, 0.01, 0.02, 0.03}};
    EXPECT_EQ(
        frame_camera(views[1]),
        (Camera{60, 50, 70, 71, 31, 24, {1, 0, 0, 1, 0, -1, 0, 2, 0, 0, -1, 3, 0, 0, 0, 1}, lens}));
    EXPECT_EQ(views[1].mask, (folder / "m.png").string());
    EXPECT_TRUE(views[1].view.held_out);
    EXPECT_FALSE(views[0].view.held_out);
    EXPECT_EQ(frame_camera(views[2]).lens, (Lens{LensKind::kFisheye, {0.1, 0, 0, -0.2}}));
    EXPECT_NEAR(frame_camera(views[2]).focal_x, 30 / std::tan(0.4), 1e-12);
    EXPECT_NEAR(frame_camera(views[2]).focal_y, 25 / std::tan(0.25), 1e-12);
    EXPECT_EQ(views[2].image, (folder / "b.exr").string());
    const auto elsewhere = read(one_frame(R"(, "w": 6, "h": 5, "fl_y": 7)"), "pictures");
    EXPECT_EQ(elsewhere[0].image, (fs::path("pictures") / "a.exr").string());
    EXPECT_EQ(frame_camera(elsewhere[0]).focal_x, 7);
}

TEST_F(Transforms, TheirNameMayEndInCapitals) {
    const fs::path capitals = folder / "TRANSFORMS.JSON";
    write_text(capitals, one_frame(R"(, "w": 6, "h": 5, "fl_y": 7)"));
    EXPECT_EQ(read_views(capitals.string(), "").size(), 1u);
}

/// Of a frame before those of the file, whatever they are; lengths before angles beside them.
TEST_F(Transforms, FocalLengthsAreGivenAsLengthsOrAsAngles) {
    const std::string angle = R"("camera_angle_x": 0.8)", tall = R"("camera_angle_y": 0.5)",
                      length = R"("fl_x": 70)", other = R"("fl_y": 71)";
    const double wide = 30 / std::tan(0.4), high = 25 / std::tan(0.25);
    const struct {
        std::string of_frame, of_file;
        double x, y;
    } kCases[] = {
        {", " + angle, length + ", ", wide, wide},
        {", " + angle, length + ", " + other + ", ", wide, wide},  // of another zoom
        {", " + tall, angle + ", ", wide, high},
        {", " + tall, angle + ", " + length + ", ", wide, high},
        {", " + length, angle + ", " + tall + ", ", 70, 70},
        {", " + length, other + ", ", 70, 71},
        {", " + length + ", " + tall, "", 70, 70},
        {"", other + ", " + angle + ", ", 71, 71},
    };
    for (const auto& c : kCases) {
        const Camera camera = frame_camera(
            read(one_frame(R"(, "w": 60, "h": 50)" + c.of_frame, c.of_file), "pictures")[0]);
        EXPECT_NEAR(camera.focal_x, c.x, 1e-12) << c.of_file << c.of_frame;
        EXPECT_NEAR(camera.focal_y, c.y, 1e-12) << c.of_file << c.of_frame;
    }
}

TEST_F(Transforms, AMaskOfTheFileIsThatOfFramesWithoutOne) {
    const auto views =
        read(R"({"w": 6, "h": 5, "fl_x": 4, "mask_path": "all.png", "frames": [)"
             R"({"file_path": "a.exr", )" +
                 kMatrix + R"(}, {"file_path": "b.exr", "mask_path": "b.png", )" + kMatrix + "}]}",
             "pictures");
    ASSERT_EQ(views.size(), 2u);
    EXPECT_EQ(views[0].mask, (fs::path("pictures") / "all.png").string());
    EXPECT_EQ(views[1].mask, (fs::path("pictures") / "b.png").string());
}

TEST_F(Transforms, CoefficientsInOneArrayAreTheSameLens) {
    const auto camera = [&](const std::string& keys, const std::string& of_file = "") {
        return frame_camera(read(one_frame(R"(, "w": 6, "h": 5, "fl_x": 4)" + keys, of_file))[0]);
    };
    const std::string array = R"("distortion_params": [0.1, -0.2, 0.03, 0, 0.01, 0.02])",
                      keys =
                          R"("k1": 0.1, "k2": -0.2, "k3": 0.03, "k4": 0, "p1": 0.01, "p2": 0.02)";
    const Camera plain = camera(", " + keys);
    EXPECT_EQ(plain.lens, (Lens{LensKind::kBrownConrady, {0.1, -0.2, 0.01, 0.02, 0.03}}));
    EXPECT_EQ(camera(", " + array), plain);
    EXPECT_EQ(camera("", array + ", "), plain);
    EXPECT_EQ(camera(R"(, "k1": 7, )" + array), plain) << "the array counts before keys beside it";
    EXPECT_EQ(camera(", " + keys, R"("distortion_params": [9, 9, 9, 9, 9, 9], )"), plain);
    EXPECT_EQ(camera(", " + array, R"("k1": 7, )"), plain);
    const std::string fisheye = R"(, "camera_model": "OPENCV_FISHEYE", )",
                      round = R"("distortion_params": [0.1, -0.2, 0.03, 0.004, 0, 0])",
                      round_keys = R"("k1": 0.1, "k2": -0.2, "k3": 0.03, "k4": 0.004)";
    EXPECT_EQ(camera(fisheye + round).lens, (Lens{LensKind::kFisheye, {0.1, -0.2, 0.03, 0.004}}));
    EXPECT_EQ(camera(fisheye + round), camera(fisheye + round_keys));
}

TEST_F(Transforms, APictureOfAnotherSizeIsSaidWithThatOfTheFirst) {
    write_image(folder / "a.exr", make_image(6, 5, 3));
    write_image(folder / "b.exr", make_image(5, 6, 3));
    const auto views = read(R"({"fl_x": 4, "frames": [{"file_path": "a.exr", )" + kMatrix +
                            R"(}, {"file_path": "b.exr", )" + kMatrix + "}]}");
    EXPECT_EQ(read_picture(views[0], {}, 1, "the target").image.width, 6);
    std::string found;
    try {
        read_picture(views[1], {}, 1, "the target");
    } catch (const InputError& e) {
        found = e.what();
    }
    EXPECT_TRUE(found.starts_with((folder / "transforms.json").string() +
                                  ": frames[1].file_path: the target ("))
        << found;
    EXPECT_TRUE(
        contains(found, "is 5 x 6 pixels, expected \"w\" and \"h\" in its frame, or the size of " +
                            views[0].image + ", 6 x 5"))
        << found;
}

TEST_F(Transforms, KeysOfOtherCamerasMayBeFalse) {
    EXPECT_EQ(complaint(one_frame(R"(, "w": 6, "h": 5, "fl_x": 5, "latlong": false)",
                                  R"("latlong": true, "fisheye_crop_radius": null, )")),
              "");
}

TEST_F(Transforms, PathsWithoutAnExtensionAreOfAnyFormat) {
    for (const char* name : {"x.JPEG", "y.tga", "z.jpg"}) write_text(folder / name, "");
    fs::create_hard_link(folder / "z.jpg", folder / "z.JPG");  // as if case did not matter
    std::string frames;
    for (const char* name : {"x", "y", "z"})
        frames += (frames.empty() ? "" : ", ") + std::string(R"({"file_path": ")") + name +
                  R"(", )" + kMatrix + "}";
    const auto views = read(R"({"w": 6, "h": 5, "fl_x": 4, "frames": [)" + frames + "]}");
    ASSERT_EQ(views.size(), 3u);
    EXPECT_EQ(views[0].image, (folder / "x.JPEG").string());
    EXPECT_EQ(views[1].image, (folder / "y.tga").string());
    EXPECT_EQ(views[2].image, (folder / "z.jpg").string());
}

TEST_F(Transforms, FramesInNoListAreLeftOutWhereSomeAreForTraining) {
    const auto read_with = [&](const std::string& lists) {
        std::string frames;
        for (const char* name : {"a", "b", "c", "d"})
            frames += (frames.empty() ? "" : ", ") + std::string(R"({"file_path": ")") + name +
                      R"(.exr", )" + kMatrix + "}";
        std::string found;
        for (const CapturedView& v :
             read(R"({"w": 6, "h": 5, "fl_x": 4, )" + lists + R"("frames": [)" + frames + "]}"))
            found += v.view.name.substr(0, 1) + (v.view.held_out ? "-" : "+");
        return found;
    };
    EXPECT_EQ(read_with(""), "a+b+c+d+");
    EXPECT_EQ(read_with(R"("test_filenames": ["b.exr"], )"), "a+b-c+d+");
    EXPECT_EQ(read_with(R"("train_filenames": ["d.exr", "./a.exr"], )"), "a+d+");
    EXPECT_EQ(read_with(R"("train_filenames": ["a.exr"], "test_filenames": ["d.exr"],
                           "val_filenames": ["d.exr", "c.exr"], )"),
              "a+c-d-");
}

TEST_F(Transforms, WhatIsWrongIsSaidWithItsKey) {
    for (const char* twin : {"t.png", "t.exr"}) write_image(folder / twin, make_image(4, 4, 3));
    const std::string size = R"(, "w": 6, "h": 5)", camera = size + R"(, "fl_x": 5)";
    const std::pair<std::string, std::string> kBad[] = {
        {"{", "byte 2: found no JSON, expected a transforms.json"},
        {R"({"camera_angle_x": 1e999})", "found a number that is too large to be stored"},
        {std::string(5000, '['), "found values 65 deep"},
        {"[]", "transforms.json: found [], expected an object"},
        {"{}", "expected the key \"frames\""},
        {R"({"frames": []})", "frames: found [], expected an array of frames"},
        {R"({"frames": [1]})", "frames[0]: found 1, expected an object"},
        {R"({"frames": [{}]})", "frames[0]: expected the key \"file_path\""},
        {R"({"frames": [{"file_path": "../a.png"}]})",
         "frames[0].file_path: found \"../a.png\", expected a path within the folder"},
        {R"({"frames": [{"file_path": "t"}]})", "expected one picture; there are"},
        {R"({"frames": [{"file_path": "./u"}]})",
         "frames[0].file_path: found \"./u\", expected a picture; there is no "},
        {R"({"frames": [{"file_path": "./u"}]})", "u, nor one with .png, .jpg or another"},
        {one_frame(R"(, "fl_x": 5)"), "a.exr"},
        {one_frame(R"(, "w": 6)"), "frames[0]: expected both \"w\" and \"h\""},
        {one_frame(R"(, "w": 6, "h": 0)"), "frames[0].h: found 0, expected pixels, 1 to 32768"},
        {one_frame(size), "frames[0]: expected the key \"fl_x\" or \"camera_angle_x\""},
        {one_frame(size + R"(, "fl_x": -80)"),
         "frames[0].fl_x: found -80, expected a focal length above 0, in pixels"},
        {one_frame(size, R"("fl_x": 5, "fl_y": 0, )"), "fl_y: found 0, expected a focal length"},
        {one_frame(size, R"("camera_angle_x": 4, )"), "camera_angle_x: found 4, expected radians"},
        {one_frame(camera + R"(, "camera_model": "EQUIRECTANGULAR")"),
         "frames[0].camera_model: found \"EQUIRECTANGULAR\", expected PINHOLE"},
        {one_frame(camera, R"("k4": 0.5, )"), "k4: found 0.5, expected 0 of a lens that is not"},
        {one_frame(camera + R"(, "k5": 0.3)"), "frames[0].k5: found 0.3, expected 0 of any lens"},
        {one_frame(camera, R"("k6": 0.1, )"), "k6: found 0.1, expected 0 of any lens"},
        {one_frame(camera + R"(, "is_fisheye": true, "p2": 0.1)"),
         "frames[0].p2: found 0.1, expected 0 of OPENCV_FISHEYE"},
        {one_frame(camera + R"(, "distortion_params": [1, 2, 3, 4])"),
         "frames[0].distortion_params: found [1,2,3,4], expected an array of k1, k2, k3, k4, p1"},
        {one_frame(camera, R"("distortion_params": [0, 0, 0, 0.5, 0, 0], )"),
         "distortion_params[3]: found 0.5, expected 0 of a lens that is not OPENCV_FISHEYE"},
        {one_frame(camera + R"(, "latlong": true)"),
         "frames[0].latlong: found true, expected pictures of pinhole or fisheye cameras"},
        {one_frame(camera, R"("equirectangular": true, )"), "equirectangular: found true"},
        {one_frame(camera, R"("orthographic": true, )"), "orthographic: found true"},
        {one_frame(camera, R"("ftheta_p0": 0.0, )"),
         "ftheta_p0: found 0.0, expected k1 to k4 of OPENCV_FISHEYE in the place"},
        {one_frame(camera, R"("fisheye_crop_radius": 30, )"),
         "fisheye_crop_radius: found 30, expected a mask_path in the place of this key"},
        {one_frame(camera + R"(, "k1": "x")"), "frames[0].k1: found \"x\", expected a number"},
        {one_frame(camera + R"(, "mask_path": "/m.png")"), "frames[0].mask_path: found"},
        {one_frame(camera, R"("test_filenames": 1, )"),
         "test_filenames: found 1, expected an array"},
        {one_frame(camera, R"("test_filenames": ["a.exr", "frames/a"], )"),
         "test_filenames[1]: found \"frames/a\", expected the file_path of a frame, as \"a.exr\""},
        {one_frame(camera, R"("val_filenames": ["b.exr"], )"), "val_filenames[0]: found \"b.exr\""},
        {one_frame(camera, R"("train_filenames": ["b.exr"], )"),
         "train_filenames[0]: found \"b.exr\", expected the file_path of a frame, as \"a.exr\""},
        {one_frame(camera, R"("train_filenames": [], )"),
         "train_filenames: found [], expected a path or more"},
        {one_frame(camera, R"("train_filenames": ["a.exr"], "test_filenames": ["./a.exr"], )"),
         "test_filenames[0]: found \"./a.exr\", expected a frame that is not in train_filenames"},
        {R"({"w": 4, "h": 4, "fl_x": 4, "frames": [{"file_path": "a.exr"}]})",
         "frames[0]: expected the key \"transform_matrix\""},
        {R"({"w": 4, "h": 4, "fl_x": 4, "frames": [{"file_path": "a.exr", )"
         R"("transform_matrix": [[1, 0]]}]})",
         "frames[0].transform_matrix: found [[1,0]], expected four rows"},
        {R"({"w": 4, "h": 4, "fl_x": 4, "frames": [{"file_path": "a.exr", )"
         R"("transform_matrix": [[2,0,0,1],[0,2,0,2],[0,0,2,3],[0,0,0,1]]}]})",
         "frames[0].transform_matrix: found [[2,0,0,1],[0,2,0,2],[0,0,2,3],[0,0,0,1]], expected a "
         "rotation and a translation"},
        {R"({"w": 4, "h": 4, "fl_x": 4, "frames": [{"file_path": "a.exr", )"
         R"("transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[1,2,3,1]]}]})",
         "frames[0].transform_matrix[3]: found [1,2,3,1], expected 0 0 0 1 as the last row"},
        {R"({"w": 4, "h": 4, "fl_x": 4, "frames": [{"file_path": "a.exr", )" + kMatrix +
             R"(}, {"file_path": "./a.exr", )" + kMatrix + "}]}",
         "frames[1]: there is another frame \"a.exr\""},
        {one_frame(camera + R"(, "is_fisheye": 1)"),
         "frames[0].is_fisheye: found 1, expected true or false"},
        {one_frame(camera, R"("is_fisheye": "true", )"),
         "is_fisheye: found \"true\", expected true or false"},
    };
    for (const auto& [text, expected] : kBad)
        EXPECT_TRUE(contains(complaint(text), expected)) << text << "\n" << complaint(text);
}

TEST_F(Transforms, DamagedFilesAreReadOrRefused) {
    write_image(folder / "a.exr", make_image(4, 4, 3));
    const std::string sound = one_frame(R"(, "w": 60, "h": 50, "k1": 0.1)",
                                        R"("camera_angle_x": 0.8, "camera_model": "OPENCV", )");
    EXPECT_EQ(complaint(sound), "");
    for (std::size_t size = 0; size < sound.size(); ++size)
        EXPECT_NE(complaint(sound.substr(0, size)), "") << size;
    int refused = 0;
    for (std::uint32_t trial = 0; trial < 600; ++trial) {
        const auto random =
            philox4x32({trial, 0, 0, 0}, {9, static_cast<std::uint32_t>(Stream::kTest)});
        std::string bytes = sound;
        bytes[random[0] % bytes.size()] = static_cast<char>(random[1]);
        if (trial % 2) bytes[random[2] % bytes.size()] = static_cast<char>(random[3] % 128);
        refused += !complaint(bytes).empty();
    }
    EXPECT_GT(refused, 100);
    EXPECT_LT(refused, 600);
}

/// The share of each pixel that the house covers, times 1.
Image coverage(const Renderer& renderer, const Camera& camera) {
    Image image = renderer.with_camera(camera).render(64);
    for (float& v : image.values) v = 1 - v;  // a black house before a white sky
    return image;
}

/// Pixels that are more than half covered in one image, but in the other one neither they nor any
/// neighbour.
std::size_t far_apart(const Image& a, const Image& b) {
    std::size_t count = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            bool near = a.at(x, y, 0) <= 0.5f;
            for (int j = std::max(0, y - 1); j <= std::min(a.height - 1, y + 1); ++j)
                for (int i = std::max(0, x - 1); i <= std::min(a.width - 1, x + 1); ++i)
                    near |= b.at(i, j, 0) > 0.5f;
            count += !near;
        }
    return count;
}

double mean_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x)
            sum += std::abs(double{a.at(x, y, 0)} - double{b.at(x, y, 0)});
    return sum / (a.width * a.height);
}

TEST_F(Transforms, OfBlenderMeetItsRenders) {
    write_text(folder / "scene.xml", R"(<scene version="3.0.0"><integrator type="direct"/>
      <sensor type="perspective"><film type="hdrfilm"><rfilter type="box"/></film></sensor>
      <emitter type="constant"><rgb name="radiance" value="1"/></emitter>
      <shape type="obj"><string name="filename" value="house.obj"/>
        <boolean name="face_normals" value="true"/>
        <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></bsdf>
      </shape></scene>)");
    fs::copy(kBlender / "house.obj", folder);
    const Renderer renderer = Renderer::load((folder / "scene.xml").string());
    const auto views = read_transforms((kBlender / "transforms.json").string(), "");
    ASSERT_EQ(views.size(), 2u);
    for (const CapturedView& view : views) {
        const std::string stem = fs::path(view.image).stem().string();
        const Image blender = read_image_file(kBlender / (stem + "_alpha.png")).image;
        const Image ours = coverage(renderer, frame_camera(view));
        ASSERT_EQ(ours.width, blender.width);
        ASSERT_EQ(ours.height, blender.height);
        EXPECT_EQ(far_apart(ours, blender), 0u) << stem;
        EXPECT_EQ(far_apart(blender, ours), 0u) << stem;
        EXPECT_LT(mean_difference(ours, blender), 0.001) << stem;
        Camera aside = frame_camera(view);
        aside.center_x += 2;
        EXPECT_GT(far_apart(coverage(renderer, aside), blender), 20u) << "a shift is noticed";
        aside.center_x -= 1.5;
        EXPECT_GT(mean_difference(coverage(renderer, aside), blender), 0.004)
            << "a shift by half a pixel is noticed";
    }
}

}  // namespace
}  // namespace burnish
