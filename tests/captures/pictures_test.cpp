// Masks: which numbers of a file are the weights.
#include "captures/pictures.h"

#include <gtest/gtest.h>

#include "burnish/error.h"
#include "error_of.h"
#include "image/files.h"
#include "image/image.h"
#include "temporary_folder.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

struct Masks : testing::Test {
    test::TemporaryFolder temporary;
    fs::path folder = temporary.path;

    Image read(const char* name, const Image& written) const {
        write_image(folder / name, written, false);
        return read_mask(folder / name, Turning::kUpright).weights;
    }
};

/// Colours of 0.2, before an alpha with which they are multiplied.
Image with_weights(const Image& alpha, int channels) {
    Image image = make_image(alpha.width, alpha.height, channels + 1);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < channels; ++c) image.at(x, y, c) = 0.2f * alpha.at(x, y, 0);
            image.at(x, y, channels) = alpha.at(x, y, 0);
        }
    return image;
}

TEST_F(Masks, OfACutOutAreItsAlpha) {
    Image alpha = make_image(4, 3, 1);
    alpha.at(1, 1, 0) = 1, alpha.at(2, 1, 0) = 0.6f;
    for (const char* name : {"mask.png", "mask.exr"})
        for (const int channels : {1, 3}) {
            const Image mask = read(name, with_weights(alpha, channels));
            ASSERT_EQ(mask.channels, 1) << name;
            for (std::size_t i = 0; i < alpha.values.size(); ++i)
                EXPECT_FLOAT_EQ(mask.values[i], alpha.values[i]) << name;
        }
    EXPECT_THROW(read("mask.png", with_weights(make_image(4, 3, 1), 3)), InputError);
    alpha.at(0, 0, 0) = NAN;
    EXPECT_THROW(read("mask.exr", with_weights(alpha, 3)), InputError);
}

TEST_F(Masks, OfOpaqueFilesAreTheirColours) {
    for (const float opaque : {1.0f, 0.9995f})
        for (const int channels : {1, 3}) {
            const Image mask =
                read("mask.exr", with_weights(make_image(4, 3, 1, opaque), channels));
            ASSERT_EQ(mask.channels, channels);
            for (const float weight : mask.values) EXPECT_FLOAT_EQ(weight, 0.2f * opaque);
        }
}

TEST_F(Masks, SayWhatOfTheFileTheyAre) {
    const auto read_whole = [&](const char* name, const Image& written) {
        write_image(folder / name, written, false);
        return read_mask(folder / name, Turning::kUpright);
    };
    Image alpha = make_image(4, 3, 1, 0.5f);
    EXPECT_EQ(read_whole("mask.png", with_weights(alpha, 3)).source, MaskSource::kAlpha);
    EXPECT_EQ(read_whole("mask.png", make_image(4, 3, 1, 1.0f)).source, MaskSource::kGray);
    Image colors = make_image(4, 3, 3, 0.2f);
    EXPECT_EQ(read_whole("mask.exr", colors).source, MaskSource::kGray);
    for (int y = 0; y < 3; ++y) colors.at(1, y, 0) = 1, colors.at(1, y, 1) = 0.6f;
    const MaskFile segments = read_whole("mask.exr", colors);
    EXPECT_EQ(segments.source, MaskSource::kColors);
    EXPECT_EQ(segments.max_weight, 0.2f) << "of no pixel all three are above";
    for (int c = 0; c < 3; ++c) colors.at(2, 1, c) = 1;
    EXPECT_EQ(read_whole("mask.exr", colors).max_weight, 1);
}

TEST_F(Masks, AreWholePicturesWithoutOverscan) {
    write_image(folder / "mask.exr", make_image(4, 3, 1, 1.0f), false);
    std::string bytes = read_bytes(folder / "mask.exr");
    const std::string display("displayWindow\0box2i\0", 20);
    const std::size_t at = bytes.find(display);
    ASSERT_NE(at, std::string::npos);
    char& last_column = bytes[at + display.size() + 4 + 8];
    ASSERT_EQ(last_column, 3);
    last_column = 2;
    write_bytes(folder / "mask.exr", bytes);
    EXPECT_EQ(read_image_file(folder / "mask.exr").image.width, 4);
    EXPECT_THROW(read_mask(folder / "mask.exr", Turning::kUpright), InputError);
}

/// As segmentation programs write them: 1/255, where 1 is meant.
TEST_F(Masks, OfZerosAndOnesInCodesAreRefused) {
    Image mask = make_image(4, 3, 1);
    mask.at(1, 1, 0) = 1.0f / 255;
    EXPECT_THROW(read("mask.png", mask), InputError);
    EXPECT_NO_THROW(read("mask.exr", mask));
    mask.at(1, 1, 0) = 2.0f / 255;
    EXPECT_NO_THROW(read("mask.png", mask));
}

TEST_F(Masks, OfXyzAreTheirNumbers) {
    write_image(folder / "mask.exr", make_image(4, 3, 3, 1.0f), false);
    std::string bytes = read_bytes(folder / "mask.exr");
    const std::string channels("channels\0chlist\0", 16);
    const std::size_t first = bytes.find(channels) + channels.size() + 4;
    constexpr std::size_t kEntry = 18;  // a name of a letter, and 16 bytes
    for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(bytes[first + c * kEntry], "BGR"[c]);
        bytes[first + c * kEntry] = "XYZ"[c];
    }
    write_bytes(folder / "mask.exr", bytes);
    EXPECT_GT(read_image_file(folder / "mask.exr").image.values[0], 1.2f) << "as a colour";
    EXPECT_EQ(read_mask(folder / "mask.exr", Turning::kUpright).weights, make_image(4, 3, 3, 1.0f));
}

/// As a program has made them that does not turn JPEGs.
TEST_F(Masks, OfAStoredPictureThatIsTurnedAreRefusedWithItsOrientation) {
    CapturedView view;
    view.image = BURNISH_TEST_DATA "/../fuzz/corpus/jpeg/turned.jpg";
    view.mask = "m.png";
    const Image stored = make_image(28, 20, 1, 1.0f);
    EXPECT_EQ(
        test::error_of([&] { read_picture(view, stored, 1, "the target"); }),
        "the mask (m.png) is 28 x 20 pixels, expected the size of the picture, turned by EXIF "
        "orientation 6, 20 x 28");
    EXPECT_EQ(read_picture(view, oriented(stored, 6), 1, "the target").image.width, 20);
    view.turning = Turning::kAsStored;
    EXPECT_EQ(read_picture(view, stored, 1, "the target").image.width, 28);
}

TEST_F(Masks, AndPicturesAreRefusedWithTheirPlaces) {
    CapturedView view;
    view.image = folder / "a.png", view.mask = folder / "m.png";
    view.places = {"c.json: views[0]", "c.json: views[0].image", "c.json: views[0].mask", "", ""};
    const auto starts = [](const std::string& message, const std::string& place) {
        return message.starts_with(place) ? "" : message;
    };
    const auto complaint = [&] {
        return test::error_of([&] { read_picture(view, read_mask(view).weights, 1, "it"); });
    };
    EXPECT_EQ(starts(complaint(), view.places.mask + ": " + view.mask + ": no such file"), "");
    write_image(folder / "m.png", make_image(2, 2, 1, 1.0f));
    EXPECT_EQ(starts(complaint(), view.places.image + ": " + view.image + ": no such file"), "");
    write_image(folder / "a.png", make_image(3, 2, 3, 0.5f));
    EXPECT_EQ(starts(complaint(), view.places.mask + ": the mask (" + view.mask + ") is 2 x 2"),
              "");
    view.mask.clear();
    view.view.camera = Camera{.width = 4, .height = 4};
    EXPECT_EQ(starts(complaint(), view.places.image + ": it (" + view.image + ") is 3 x 2"), "");
    write_image(folder / "a.png", make_image(4, 4, 3, 1.0f));  // clipped
    EXPECT_EQ(starts(complaint(), view.places.image + ": it (" + view.image + "): no pixel"), "");
}

}  // namespace
}  // namespace burnish
