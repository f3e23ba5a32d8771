// Photographs: encodings, alpha, orientation, clipped pixels, and other sizes.
#include "burnish/photograph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "burnish/error.h"
#include "core/random.h"
#include "error_of.h"
#include "image/folder_of_files.h"
#include "image/image.h"
#include "image/test_files.h"

namespace burnish {
namespace {

using namespace test_files;

struct Photographs : FolderOfFiles {
    static std::string message(const std::string& file, const Encoding& encoding = {}) {
        return test::error_of([&] { read_photograph(file, encoding); });
    }
};

void expect_near(const Image& a, const Image& b, double tolerance) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    ASSERT_EQ(a.channels, b.channels);
    for (std::size_t i = 0; i < a.values.size(); ++i)
        ASSERT_NEAR(a.values[i], b.values[i], tolerance) << i;
}

std::string segment_of_jpeg(char marker, const std::string& body) {
    const std::size_t size = body.size() + 2;
    return std::string("\xff") + marker + static_cast<char>(size >> 8) +
           static_cast<char>(size & 255) + body;
}

/// The parts of an APP1 segment, in one of the two byte orders.
struct ExifWriter {
    bool little_endian = false;

    std::string number(unsigned value, int bytes) const {
        std::string text;
        for (int i = 0; i < bytes; ++i) {
            const int k = little_endian ? i : bytes - 1 - i;
            text += static_cast<char>(value >> (8 * k) & 255);
        }
        return text;
    }
    std::string entry(unsigned tag, int type, unsigned value) const {
        return number(tag, 2) + number(static_cast<unsigned>(type), 2) + number(1, 4) +
               (type == 3 ? number(value, 2) + std::string(2, '\0') : number(value, 4));
    }
    /// directories: each with its entries, the first one at byte 8.
    std::string segment(const std::vector<std::vector<std::string>>& directories) const {
        std::string body = std::string("Exif\0\0", 6) + (little_endian ? "II" : "MM") +
                           number(42, 2) + number(8, 4);
        for (const std::vector<std::string>& entries : directories) {
            body += number(static_cast<unsigned>(entries.size()), 2);
            for (const std::string& e : entries) body += e;
            body += number(0, 4);
        }
        return segment_of_jpeg('\xe1', body);
    }
};

/// An APP1 segment with this orientation.
std::string exif(int orientation, bool little_endian, int type = 3) {
    const ExifWriter w{little_endian};
    return w.segment(
        {{w.entry(0x0100, 4, 77), w.entry(0x0112, type, static_cast<unsigned>(orientation))}});
}

/// An APP1 segment with this colour space.
std::string exif_of_colors(unsigned space, bool little_endian, int type = 3) {
    const ExifWriter w{little_endian};
    constexpr unsigned kSecond = 8 + 2 + 2 * 12 + 4;
    return w.segment({{w.entry(0x0100, 4, 77), w.entry(0x8769, 4, kSecond)},
                      {w.entry(0x9000, 4, 1), w.entry(0xa001, type, space)}});
}

std::string with_segment(const std::string& jpeg, const std::string& segment) {
    return jpeg.substr(0, 2) + segment + jpeg.substr(2);
}

TEST_F(Photographs, AreDecodedAsTheyAreAskedTo) {
    const std::string png = write("a.png", make_png({13, 9, 2, 8, false}));
    const Image codes = read_image_file(png).image;
    const auto decoded = [&](const Encoding& encoding) { return read_photograph(png, encoding); };
    const auto expect = [&](const Encoding& encoding, const auto& linear_of) {
        Image expected = codes;
        for (float& v : expected.values) v = linear_of(v);
        expect_near(decoded(encoding).image, expected, 1e-6);
    };
    expect(ByFileType{}, srgb_to_linear);
    expect(SrgbEncoding{}, srgb_to_linear);
    expect(LinearEncoding{}, [](float v) { return v; });
    expect(GammaEncoding{2.2}, [](float v) { return std::pow(v, 2.2f); });
    EXPECT_EQ(decoded({}).encoding, Encoding{SrgbEncoding{}});
    EXPECT_EQ(decoded({}).type, "PNG");
    EXPECT_EQ(decoded({}).bits, 8);
    EXPECT_THROW(decoded(GammaEncoding{0}), InputError);

    const Photograph deep = read_photograph(write("b.png", make_png({13, 9, 2, 16, false})));
    EXPECT_EQ(deep.bits, 16);
    EXPECT_EQ(deep.encoding, Encoding{SrgbEncoding{}});
    Image bright = smooth_image(6, 5, 3);
    for (float& v : bright.values) v = 5 * v - 1;
    make_exr(folder / "c.exr", bright, {.half = true});
    const Photograph exr = read_photograph((folder / "c.exr").string());
    EXPECT_EQ(exr.encoding, Encoding{LinearEncoding{}});
    EXPECT_EQ(exr.bits, 16);
    EXPECT_EQ(exr.type, "EXR");
    EXPECT_GT(exr.negative_pixels, 0u);
    EXPECT_EQ(exr.clipped.width, 0) << "floats are not clipped";
    expect_near(exr.image, bright, 5e-3);
}

TEST_F(Photographs, AreWholePicturesWithoutOverscan) {
    const Image image = smooth_image(12, 9, 3);
    make_exr(folder / "a.exr", image, {.x0 = -7, .y0 = 3});
    EXPECT_EQ(read_photograph((folder / "a.exr").string()).image, image);
    for (const int overscan : {2, -3}) {
        make_exr(folder / "a.exr", image, {.overscan = overscan});
        const std::string found = message((folder / "a.exr").string());
        EXPECT_NE(found.find("a.exr: the EXR's data window is not its display window: expected a "
                             "whole picture"),
                  std::string::npos)
            << found;
        EXPECT_EQ(read_image((folder / "a.exr").string()), image) << "as of a texture";
    }
}

TEST_F(Photographs, AlphaIsTheMask) {
    for (const int type : {4, 6})
        for (const int bits : {8, 16}) {
            const PngLayout layout{13, 9, type, bits, false};
            const Photograph p = read_photograph(write("a.png", make_png(layout)));
            EXPECT_TRUE(p.has_alpha);
            EXPECT_EQ(p.image.channels, 3);
            EXPECT_EQ(p.is_gray, type == 4);
            ASSERT_EQ(p.mask.width, 13);
            for (int y = 0; y < 9; ++y)
                for (int x = 0; x < 13; ++x)
                    ASSERT_NEAR(p.mask.at(x, y, 0),
                                png_sample(layout, x, y, type == 4 ? 1 : 3) / ((1 << bits) - 1.0),
                                1e-6);
        }
    make_exr(folder / "a.exr", smooth_image(6, 5, 3), {.channels = {"R", "G", "B", "A"}});
    expect_near(read_image_file(folder / "a.exr").image, smooth_image(6, 5, 3), 1e-6);
    const Photograph exr = read_photograph((folder / "a.exr").string());
    expect_near(exr.mask,
                Image{6, 5, 1,
                      [] {
                          std::vector<float> alpha;
                          const Image image = smooth_image(6, 5, 3);
                          for (std::size_t i = 0; i < 30; ++i) alpha.push_back(image.values[3 * i]);
                          return alpha;
                      }()},
                1e-6);
    EXPECT_FALSE(read_photograph(write("b.png", make_png({}))).has_alpha);
}

TEST_F(Photographs, NumbersBeyondTheRangeAreKeptOrClamped) {
    const std::string file = (folder / "a.exr").string();
    Image image = make_image(3, 1, 3, 0.5f);
    image.at(1, 0, 2) = -2;
    write_image(file, image);
    EXPECT_FALSE(read_photograph(file).is_gray) << "by its last channel alone";
    image.at(0, 0, 1) = -0.5f;
    write_image(file, image);
    const Photograph p = read_photograph(file, GammaEncoding{2});
    EXPECT_EQ(p.negative_pixels, 2u);
    EXPECT_FLOAT_EQ(p.image.at(0, 0, 1), -0.25f);
    EXPECT_FLOAT_EQ(p.image.at(1, 0, 2), -4);
    EXPECT_FLOAT_EQ(p.image.at(2, 0, 0), 0.25f);

    const Image alpha{3, 1, 1, {-1, 0.25f, 3}};
    make_exr(folder / "b.exr", alpha, {.channels = {"R", "G", "B", "A"}});
    EXPECT_EQ(read_photograph((folder / "b.exr").string()).mask.values,
              (std::vector<float>{0, 0.25f, 1}));
}

TEST_F(Photographs, AreUpright) {
    // A red corner at the upper left of what is seen, a green one to the right of it.
    Image seen = make_image(40, 24, 3, 0.1f);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) seen.at(x, y, 0) = seen.at(39 - x, y, 1) = 0.9f;
    for (int orientation = 1; orientation <= 8; ++orientation) {
        // The stored picture that the orientation turns into the seen one: its inverse.
        const int inverse = orientation == 6 ? 8 : orientation == 8 ? 6 : orientation;
        const Image stored = oriented(seen, inverse);
        const std::string jpeg = make_jpeg(stored, 3, false);
        for (const bool little : {false, true}) {
            const std::string file = write("a.jpg", with_segment(jpeg, exif(orientation, little)));
            const Photograph p = read_photograph(file, LinearEncoding{});
            EXPECT_EQ(p.orientation, orientation);
            expect_near(p.image, seen, 0.15);
            EXPECT_EQ(read_image(file).width, 40);
            EXPECT_EQ(read_image_file(file).image.width, stored.width) << "as stored";
            const Photograph as_stored = read_photograph(file, {}, Turning::kAsStored);
            EXPECT_EQ(as_stored.image.width, stored.width);
            EXPECT_EQ(as_stored.orientation, orientation);
        }
    }
    // By the standard: 6 is a camera on its side, whose row 0 is the right side of what is seen.
    Image stored = make_image(24, 40, 3);
    stored.at(0, 0, 0) = 1;
    EXPECT_EQ(oriented(stored, 6).at(39, 0, 0), 1);
    EXPECT_EQ(oriented(stored, 8).at(0, 23, 0), 1);
    EXPECT_EQ(oriented(stored, 3).at(23, 39, 0), 1);
}

TEST_F(Photographs, WhatIsClippedIsTurnedWithThePicture) {
    Image seen = make_image(40, 24, 3, 0.1f);  // white at the upper left, in whole blocks of JPEG
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c) seen.at(x, y, c) = 1;
    for (int orientation = 1; orientation <= 8; ++orientation) {
        const int inverse = orientation == 6 ? 8 : orientation == 8 ? 6 : orientation;
        const std::string jpeg = make_jpeg(oriented(seen, inverse), 3, false);
        const Photograph p =
            read_photograph(write("a.jpg", with_segment(jpeg, exif(orientation, true))));
        ASSERT_EQ(p.clipped.width, 40) << orientation;
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 40; ++x)
                ASSERT_EQ(p.clipped.at(x, y, 0), x < 16 && y < 8 ? 1 : 0) << orientation;
    }
}

TEST_F(Photographs, OtherExifDataIsLeftAlone) {
    const std::string jpeg = make_jpeg(smooth_image(20, 14, 3), 3, false);
    const auto orientation = [&](const std::string& segment) {
        return read_photograph(write("a.jpg", with_segment(jpeg, segment))).orientation;
    };
    EXPECT_EQ(orientation(exif(9, true)), 1);
    EXPECT_EQ(orientation(exif(0, false)), 1);
    EXPECT_EQ(orientation(exif(6, true, 4)), 1) << "a LONG";
    const std::string sound = exif(6, true);
    for (std::size_t size = 4; size < sound.size(); ++size) {
        std::string cut = sound.substr(0, size);
        cut[2] = 0, cut[3] = static_cast<char>(size - 2);
        EXPECT_TRUE(orientation(cut) == 1 || orientation(cut) == 6);
    }
    for (std::uint32_t trial = 0; trial < 300; ++trial) {
        std::string bytes = sound;
        const auto random =
            philox4x32({trial, 1, 0, 0}, {7, static_cast<std::uint32_t>(Stream::kTest)});
        for (std::size_t k = 0; k < 3; ++k)
            bytes[4 + random[k] % (bytes.size() - 4)] = static_cast<char>(random[3] >> (8 * k));
        const int found = orientation(bytes);
        EXPECT_TRUE(found >= 1 && found <= 8) << found;
    }
}

TEST_F(Photographs, ProfilesAreNamed) {
    const std::string jpeg = make_jpeg(smooth_image(20, 14, 3), 3, false);
    const auto of_jpeg = [&](const std::string& profile) {
        const std::string segment =
            segment_of_jpeg('\xe2', std::string("ICC_PROFILE\0\1\1", 14) + profile);
        return read_photograph(write("a.jpg", with_segment(jpeg, segment))).profile;
    };
    for (const int version : {2, 4})
        for (const char* name : {"Display P3", "sRGB IEC61966-2.1"}) {
            const std::string profile = make_profile(name, version);
            EXPECT_EQ(of_jpeg(profile), name);
            PngLayout png;
            png.profile = profile;
            EXPECT_EQ(read_photograph(write("a.png", make_png(png))).profile, name);
            for (std::size_t size = 0; size < profile.size(); ++size) {
                const std::string found = of_jpeg(profile.substr(0, size));
                EXPECT_TRUE(std::string(name).starts_with(found)) << found;
            }
        }
    EXPECT_EQ(of_jpeg(make_profile("Caf\xe9\x1b", 2)), "Caf??");
    EXPECT_EQ(read_photograph(write("a.jpg", jpeg)).profile, "");
    EXPECT_EQ(read_photograph(write("a.png", make_png({}))).profile, "");
}

TEST_F(Photographs, ColorsThatExifSaysAreNotThoseOfSrgbAreNamed) {
    const std::string jpeg = make_jpeg(smooth_image(20, 14, 3), 3, false),
                      named = "uncalibrated by EXIF, as of Adobe RGB";
    const auto profile = [&](const std::string& segments) {
        return read_photograph(write("a.jpg", with_segment(jpeg, segments))).profile;
    };
    for (const bool little : {false, true}) {
        EXPECT_EQ(profile(exif_of_colors(65535, little)), named);
        EXPECT_EQ(profile(exif_of_colors(1, little)), "") << "sRGB";
        EXPECT_EQ(profile(exif_of_colors(65535, little, 4)), "") << "a LONG";
    }
    const std::string icc =
        segment_of_jpeg('\xe2', std::string("ICC_PROFILE\0\1\1", 14) + make_profile("sRGB", 2));
    EXPECT_EQ(profile(exif_of_colors(65535, true) + icc), "sRGB") << "a profile says more";
    EXPECT_EQ(profile(exif(6, true) + exif_of_colors(65535, true)), named);
    const ExifWriter w;
    EXPECT_EQ(profile(w.segment({{w.entry(0x8769, 4, 8), w.entry(0xa001, 3, 65535)}})), named)
        << "a directory that is its own";
    for (const unsigned at : {0u, 7u, 60u, 0xfffffff0u, 0xffffffffu})
        EXPECT_EQ(profile(w.segment({{w.entry(0x8769, 4, at)}})), "") << at;
    const std::string sound = exif_of_colors(65535, true);
    for (std::size_t size = 4; size < sound.size(); ++size) {
        std::string cut = sound.substr(0, size);
        cut[2] = 0, cut[3] = static_cast<char>(size - 2);
        const std::string found = profile(cut);
        EXPECT_TRUE(found.empty() || found == named) << found;
    }
}

TEST_F(Photographs, OtherPrimariesOfPngAreNamed) {
    const auto profile = [&](const std::vector<double>& chromaticities, const std::string& icc) {
        PngLayout png;
        png.gamma = 1 / 2.2, png.chromaticities = chromaticities, png.profile = icc;
        return read_photograph(write("a.png", make_png(png))).profile;
    };
    const std::vector<double> adobe{0.3127, 0.329, 0.64, 0.33, 0.21, 0.71, 0.15, 0.06},
        srgb{0.3127, 0.329, 0.6401, 0.33, 0.2998, 0.6, 0.15, 0.06};
    EXPECT_EQ(profile(adobe, ""), "other primaries by cHRM");
    EXPECT_EQ(profile(srgb, ""), "");
    EXPECT_EQ(profile({}, ""), "");
    EXPECT_EQ(profile(adobe, make_profile("Display P3", 2)), "Display P3");
    PngLayout png;
    png.gamma = 1, png.chromaticities = adobe;
    const Photograph linear = read_photograph(write("linear.png", make_png(png)));
    EXPECT_EQ(linear.profile, "") << "the larger error comes first";
    EXPECT_TRUE(linear.says_linear);
    png.gamma = 1 / 2.2, png.color_type = 0;
    EXPECT_EQ(read_photograph(write("gray.png", make_png(png))).profile, "");
}

TEST_F(Photographs, AGammaOfOneSaysThatNumbersAreLinear) {
    const auto says_linear = [&](double gamma, const std::string& profile = "") {
        PngLayout png;
        png.gamma = gamma, png.profile = profile;
        const Photograph read = read_photograph(write("a.png", make_png(png)));
        EXPECT_EQ(read.encoding, Encoding{SrgbEncoding{}});
        return read.says_linear;
    };
    EXPECT_TRUE(says_linear(1));
    EXPECT_TRUE(says_linear(0.97));
    EXPECT_FALSE(says_linear(0));
    EXPECT_FALSE(says_linear(1 / 2.2));
    EXPECT_FALSE(says_linear(1, make_profile("Display P3", 4)));
    write_image(folder / "b.png", make_image(3, 2, 3, 0.5f));
    EXPECT_FALSE(read_photograph((folder / "b.png").string()).says_linear) << "it says sRGB";
}

TEST_F(Photographs, ClippedPixelsDoNotCount) {
    Image image = smooth_image(12, 8, 3);
    for (float& v : image.values) v *= 0.8f;
    image.at(3, 2, 1) = image.at(5, 5, 0) = image.at(5, 5, 2) = 1;
    write_image((folder / "a.png").string(), image);
    Photograph p = read_photograph((folder / "a.png").string());
    EXPECT_EQ(p.clipped_pixels, 2u);
    const Image weights = weights_of(p);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 12; ++x)
            EXPECT_EQ(weights.at(x, y, 0), (x == 3 && y == 2) || (x == 5 && y == 5) ? 0 : 1);
    Image mask = make_image(12, 8, 1, 0.5f);
    mask.at(3, 2, 0) = 0;
    add_mask(mask, p);
    EXPECT_EQ(p.clipped_pixels, 1u) << "the other one does not count anyway";
    EXPECT_EQ(weights_of(p).at(0, 0, 0), 0.5f);
    EXPECT_EQ(weights_of(p).at(5, 5, 0), 0);
    for (const Image& wrong : {make_image(8, 12, 1), make_image(12, 8, 2), make_image(12, 8, 0),
                               Image{12, 8, 1, {1, 2, 3}}})
        EXPECT_THROW(add_mask(wrong, p), InputError) << wrong.channels;
    const Photograph half = scaled(p, 0.5);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 6; ++x)
            EXPECT_EQ(weights_of(half).at(x, y, 0) == 0, x == 2 && y == 2) << x << " " << y;
    EXPECT_FLOAT_EQ(weights_of(half).at(1, 1, 0), 0.375f) << "what is clipped there is masked out";
}

TEST_F(Photographs, WhatIsWrongIsSaid) {
    Image image = make_image(5, 4, 3, 0.5f);
    image.at(2, 1, 1) = NAN, image.at(4, 3, 2) = INFINITY;
    write_image((folder / "a.exr").string(), image);
    const std::string file = (folder / "a.exr").string();
    EXPECT_EQ(message(file), file +
                                 ": 2 of 60 values are not finite, the first one (nan) at pixel "
                                 "(2, 1): expected finite ones");
    write_image(file, make_image(5, 4, 3, 1e5f));
    EXPECT_TRUE(message(file, GammaEncoding{10}).starts_with(file + ", decoded: 60 of 60 values"));
    EXPECT_TRUE(read_photograph(write("g.png", make_png({13, 9, 0, 8, false}))).is_gray);
    EXPECT_FALSE(read_photograph(write("c.png", make_png({13, 9, 2, 8, false}))).is_gray);
}

/// The mean over the area that an output pixel covers, by overlaps alone.
double mean_over(const Image& image, const ScaledSize& size, int x, int y, int c) {
    const double x0 =
        (x + 0.5 - 0.5 * size.width) * size.step + 0.5 * image.width - 0.5 * size.step;
    const double y0 =
        (y + 0.5 - 0.5 * size.height) * size.step + 0.5 * image.height - 0.5 * size.step;
    const auto overlap = [&](double begin, int pixel) {
        return std::max(
            0.0, std::min(begin + size.step, pixel + 1.0) - std::max(begin, double{1} * pixel));
    };
    double sum = 0, area = 0;
    for (int py = 0; py < image.height; ++py)
        for (int px = 0; px < image.width; ++px) {
            const double a = overlap(x0, px) * overlap(y0, py);
            sum += a * double{image.at(px, py, c)}, area += a;
        }
    return sum / area;
}

TEST(ScaledPictures, AreMeansOverExactAreas) {
    const Image image = smooth_image(23, 17, 3);
    for (const double factor : {1.0, 0.9, 0.5, 1.0 / 3, 0.2, 0.01}) {
        const ScaledSize size = scaled_size(23, 17, factor);
        const Image small = scaled(image, factor);
        EXPECT_EQ(small.width, std::max(1l, std::lround(23 * factor)));
        EXPECT_LE(size.height * size.step, std::max(17 + 1e-6, size.step)) << "no part of a row";
        ASSERT_EQ(small.height, size.height);
        for (int y = 0; y < small.height; ++y)
            for (int x = 0; x < small.width; ++x)
                for (int c = 0; c < 3; ++c)
                    ASSERT_NEAR(small.at(x, y, c), mean_over(image, size, x, y, c), 1e-6) << factor;
        const Image gray = scaled(make_image(23, 17, 1, 0.7f), factor);
        for (const float v : gray.values) ASSERT_NEAR(v, 0.7f, 1e-6);
    }
    EXPECT_EQ(scaled(image, 1), image);
    for (const double bad : {0.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(scaled(image, bad), InputError);
    EXPECT_EQ(scaled(Image{}, 0.5), Image{});
    EXPECT_EQ(scaled(Photograph{}, 0.5).image, Image{});
    EXPECT_THROW(scaled(Image{}, 0), InputError);
    EXPECT_THROW(scaled(Image{8, 8, 1, {1, 2, 3}}, 0.5), InputError);
}

TEST_F(Photographs, MaskedPixelsDoNotClipTheirNeighbours) {
    // A square before white that is masked out. At half size its border runs within pixels.
    for (const int channels : {1, 3}) {
        Photograph p;
        p.image = make_image(16, 16, 3, 1.0f), p.clipped = make_image(16, 16, 1, 1.0f);
        Image mask = make_image(16, 16, channels);
        for (int y = 1; y < 15; ++y)
            for (int x = 1; x < 15; ++x) {
                p.clipped.at(x, y, 0) = 0;
                for (int c = 0; c < 3; ++c) p.image.at(x, y, c) = 0.25f;
                mask.at(x, y, channels - 1) = 1;
            }
        add_mask(mask, p);
        const Photograph half = scaled(p, 0.5);
        const Image weights = weights_of(half);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                const float across = x % 7 == 0 ? 0.5f : 1, down = y % 7 == 0 ? 0.5f : 1;
                EXPECT_FLOAT_EQ(weights.at(x, y, channels - 1), across * down) << x << " " << y;
                EXPECT_FLOAT_EQ(half.image.at(x, y, 2), 0.25f) << x << " " << y;
            }
    }
}

TEST(ScaledPictures, MaskedPixelsDoNotShow) {
    Photograph p;
    p.image = make_image(8, 6, 3, 0.25f), p.mask = make_image(8, 6, 1, 1.0f);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 3; ++x) {
            p.mask.at(x, y, 0) = 0;
            for (int c = 0; c < 3; ++c) p.image.at(x, y, c) = 100;
        }
    const Photograph half = scaled(p, 0.5);
    for (int y = 0; y < 3; ++y) {
        EXPECT_EQ(half.mask.at(0, y, 0), 0);
        EXPECT_FLOAT_EQ(half.mask.at(1, y, 0), 0.5f);
        EXPECT_FLOAT_EQ(half.mask.at(2, y, 0), 1);
        for (int x = 1; x < 4; ++x) EXPECT_FLOAT_EQ(half.image.at(x, y, 1), 0.25f) << x;
    }
}

TEST_F(Photographs, MasksMultiplyInAnyOrder) {
    const Image rgb{2, 1, 3, {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f}}, gray{2, 1, 1, {0.5f, 1.0f}};
    const auto mask_of = [](const std::vector<Image>& masks) {
        Photograph p;
        p.image = make_image(2, 1, 3);
        for (const Image& mask : masks) add_mask(mask, p);
        return p.mask;
    };
    const Image expected{2, 1, 3, {0.05f, 0.1f, 0.15f, 0.4f, 0.5f, 0.6f}};
    EXPECT_EQ(mask_of({rgb, gray}), expected);
    EXPECT_EQ(mask_of({gray, rgb}), expected);
    EXPECT_EQ(mask_of({rgb, make_image(2, 1, 3, 1.0f)}), rgb);
    EXPECT_EQ(mask_of({gray, gray}), (Image{2, 1, 1, {0.25f, 1.0f}}));
}

/// Their means would weigh colours with both signs.
TEST_F(Photographs, MasksOfWhatIsNoWeightAreRefused) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Photograph p;
    p.image = make_image(16, 8, 3, 0.5f);
    for (const int channels : {1, 3})
        for (const float wrong : {-0.1f, NAN, kInfinity, -kInfinity}) {
            Image mask = make_image(16, 8, channels, 1.0f);
            mask.values[37] = wrong;
            EXPECT_THROW(add_mask(mask, p), InputError) << wrong;
            EXPECT_EQ(p.mask.width, 0) << wrong;
        }
    add_mask(make_image(16, 8, 1, 0.0f), p);
    EXPECT_EQ(p.mask, make_image(16, 8, 1, 0.0f));
}

TEST_F(Photographs, OfImagesThatDoNotFitAreRefused) {
    Photograph p;
    p.image = make_image(16, 8, 3);
    p.clipped = make_image(16, 7, 1);
    EXPECT_THROW(weights_of(p), InputError);
    EXPECT_THROW(add_mask(make_image(16, 8, 1, 1.0f), p), InputError);
    p.clipped = {};
    p.mask = make_image(1, 1, 1, 1.0f);
    EXPECT_THROW(scaled(p, 0.5), InputError);
    p.mask = make_image(16, 8, 2, 1.0f);
    EXPECT_THROW(scaled(p, 0.5), InputError);
    EXPECT_THROW(scaled_size(0, 50, 0.5), InputError);
    EXPECT_THROW(scaled_size(50, -1, 0.5), InputError);
}

}  // namespace
}  // namespace burnish
