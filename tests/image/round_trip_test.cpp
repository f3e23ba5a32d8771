// Every format comes back as it was written, by this library or by another writer.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "burnish/error.h"
#include "image/files.h"
#include "image/folder_of_files.h"
#include "image/image.h"
#include "image/numbers.h"
#include "image/test_files.h"
#include "worst.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;
using namespace test_files;

struct ImageFiles : FolderOfFiles {};

void expect_equal(const Image& a, const Image& b, float tolerance) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    ASSERT_EQ(a.channels, b.channels);
    ASSERT_EQ(a.values.size(), b.values.size());
    float worst = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        worst = test::worse(worst, std::fabs(a.values[i] - b.values[i]));
    EXPECT_LE(worst, tolerance);
}

TEST_F(ImageFiles, OwnExrAndPfmAreExact) {
    for (const int channels : {1, 3}) {
        Image image = smooth_image(37, 21, channels);
        image.values[5] = -3.25e-20f, image.values[7] = 6.5e30f;
        for (const char* name : {"a.exr", "a.pfm", "B.EXR"}) {
            write_image(folder / name, image);
            const ImageFile read = read_image_file(folder / name);
            EXPECT_EQ(read.encoding, PixelEncoding::kFloat);
            expect_equal(read.image, image, 0);
        }
    }
}

/// A temporary name can be guessed.
TEST_F(ImageFiles, NothingIsWrittenThroughALinkOfATemporaryName) {
    const fs::path victim = write("victim", "old");
    std::string taken;
    {
        const FileWriter writer(folder / "a");
        for (const auto& entry : fs::directory_iterator(folder))
            if (is_temporary(entry.path())) taken = entry.path().filename().string();
    }
    const std::size_t number = taken.rfind('-') + 1;
    ASSERT_NE(number, 0u) << taken;
    const unsigned long last = std::stoul(taken.substr(number));
    for (unsigned long i = last + 1; i <= last + 3; ++i)
        fs::create_symlink(victim, folder / (taken.substr(0, number) + std::to_string(i) + ".tmp"));
    write_bytes(folder / "a", "new");
    EXPECT_EQ(read_bytes(victim), "old");
    EXPECT_EQ(read_bytes(folder / "a"), "new");
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(folder / "a")));
}

TEST_F(ImageFiles, RealPathsFollowLinksAndNeverThrow) {
    const fs::path own = fs::canonical(folder);
    fs::create_directory(own / "real");
    fs::create_directory_symlink("real", own / "link");
    fs::create_symlink("loop", own / "loop");
    EXPECT_EQ(real_path(own / "link/../link/a"), own / "real/a");
    EXPECT_EQ(real_path(own / "loop/./a"), own / "loop/a");
    EXPECT_EQ(real_path(own / std::string(300, 'a')), own / std::string(300, 'a'));
    EXPECT_EQ(real_path(""), "");
}

TEST_F(ImageFiles, OwnPngHoldsCodes) {
    for (const int channels : {1, 3})
        for (const bool srgb : {false, true}) {
            const Image image = smooth_image(37, 21, channels);
            write_image(folder / "a.png", image, srgb);
            const ImageFile read = read_image_file(folder / "a.png");
            EXPECT_EQ(read.encoding, PixelEncoding::kUnorm8);
            Image expected = image;
            for (float& v : expected.values)
                v = std::round((srgb ? linear_to_srgb(v) : v) * 255) / 255;
            expect_equal(read.image, expected, 1e-6f);
            if (srgb) expect_equal(read_image(folder / "a.png"), image, 0.005f);
            EXPECT_EQ(encode_png(image, srgb), read_bytes(folder / "a.png"));
        }
}

TEST_F(ImageFiles, PngClampsWhatItCannotHold) {
    const Image image{3, 1, 1, {-1, 2, NAN}};
    write_image(folder / "a.png", image);
    expect_equal(read_image_file(folder / "a.png").image, {3, 1, 1, {0, 1, 0}}, 0);
}

TEST_F(ImageFiles, PngOfEveryLayout) {
    const std::vector<std::pair<int, std::vector<int>>> kLayouts{
        {0, {1, 2, 4, 8, 16}}, {2, {8, 16}}, {3, {1, 2, 4, 8}}, {4, {8, 16}}, {6, {8, 16}}};
    for (const auto& [type, depths] : kLayouts)
        for (const int bits : depths)
            for (const bool interlaced : {false, true}) {
                const PngLayout layout{13, 9, type, bits, interlaced};
                const ImageFile read = read_image_file(write("a.dat", make_png(layout)));
                const bool gray = type == 0 || type == 4;
                EXPECT_EQ(read.encoding,
                          bits == 16 ? PixelEncoding::kUnorm16 : PixelEncoding::kUnorm8);
                Image expected = make_image(13, 9, gray ? 1 : 3);
                for (int y = 0; y < 9; ++y)
                    for (int x = 0; x < 13; ++x)
                        for (int c = 0; c < expected.channels; ++c)
                            expected.at(x, y, c) =
                                type == 3 ? static_cast<float>(
                                                png_palette(png_sample(layout, x, y, 0), c)) /
                                                255.0f
                                          : static_cast<float>(png_sample(layout, x, y, c)) /
                                                static_cast<float>((1 << bits) - 1);
                SCOPED_TRACE("type " + std::to_string(type) + " bits " + std::to_string(bits));
                expect_equal(read.image, expected, 1e-6f);
            }
}

TEST_F(ImageFiles, JpegIsNear) {
    for (const int channels : {1, 3})
        for (const bool progressive : {false, true}) {
            const Image image = smooth_image(40, 30, channels);
            const ImageFile read =
                read_image_file(write("a.png", make_jpeg(image, channels, progressive)));
            EXPECT_EQ(read.encoding, PixelEncoding::kUnorm8);
            expect_equal(read.image, image, 0.02f);
        }
}

TEST_F(ImageFiles, BmpTgaAndHdr) {
    const Image image = smooth_image(22, 11, 3);
    Image codes = image;
    for (float& v : codes.values) v = std::round(v * 255) / 255;
    expect_equal(read_image_file(write("a", make_bmp(image))).image, codes, 1e-6f);
    expect_equal(read_image_file(write("a", make_tga(image, false))).image, codes, 1e-6f);
    expect_equal(read_image_file(write("a", make_tga(image, true))).image, codes, 1e-6f);
    Image bright = image;
    for (float& v : bright.values) v *= 40;
    for (const bool run_length : {false, true}) {
        const ImageFile read = read_image_file(write("a", make_hdr(bright, run_length)));
        EXPECT_EQ(read.encoding, PixelEncoding::kFloat);
        expect_equal(read.image, bright, 64 / 256.0f);  // one step of the shared exponent
    }
}

TEST_F(ImageFiles, BmpFromTopToBottom) {
    const Image image = smooth_image(22, 11, 3);
    const std::string upright = make_bmp(image);
    std::string bytes = make_bmp(oriented(image, 4));
    bytes.replace(22, 4, std::string("\xf5\xff\xff\xff", 4));  // a height of -11
    EXPECT_EQ(read_image_file(write("a", bytes)).image, read_image_file(write("b", upright)).image);
    bytes.replace(22, 4, std::string("\0\0\0\x80", 4));  // -2^31
    EXPECT_THROW(read_image_file(write("a", bytes)), InputError);
}

TEST_F(ImageFiles, HdrWithCarriageReturns) {
    const Image image = smooth_image(22, 11, 3);
    for (const bool run_length : {false, true}) {
        const std::string bytes = make_hdr(image, run_length);
        const Image expected = read_image_file(write("a", bytes)).image;
        std::string lines = bytes;
        std::size_t at = 0;
        for (int line = 0; line < 4; ++line) {  // those of the header
            at = lines.find('\n', at);
            lines.insert(at, "\r");
            at += 2;
        }
        EXPECT_EQ(read_image_file(write("a", lines)).image, expected);
    }
}

TEST_F(ImageFiles, HdrOfXyzIsConverted) {
    const Image xyz = smooth_image(22, 11, 3);
    for (const bool run_length : {false, true}) {
        std::string bytes = make_hdr(xyz, run_length);
        const Image stored = read_image_file(write("a", bytes)).image;
        bytes.replace(bytes.find("rgbe"), 4, "xyze");
        EXPECT_EQ(read_numbers_file(write("a", bytes)).image, stored);
        Image expected = stored;
        for (int y = 0; y < 11; ++y)
            for (int x = 0; x < 22; ++x) {
                const float a = stored.at(x, y, 0), b = stored.at(x, y, 1), c = stored.at(x, y, 2);
                float* rgb = &expected.values[expected.index(x, y)];
                rgb[0] = 3.240479f * a - 1.537150f * b - 0.498535f * c;
                rgb[1] = -0.969256f * a + 1.875991f * b + 0.041556f * c;
                rgb[2] = 0.055648f * a - 0.204043f * b + 1.057311f * c;
            }
        expect_equal(read_image_file(write("a", bytes)).image, expected, 1e-5f);
    }
}

TEST_F(ImageFiles, HdrExposureAndColorCorrectionDoNotCount) {
    const std::string bytes = make_hdr(smooth_image(2, 2, 3), false);
    const Image expected = read_image_file(write("a", bytes)).image;
    std::string corrected = bytes;
    corrected.insert(corrected.find("FORMAT="), "EXPOSURE=2.5\nCOLORCORR=0.5 2 4\n");
    EXPECT_EQ(read_image_file(write("a", corrected)).image, expected);
}

TEST_F(ImageFiles, HdrOfOtherProgramsThanRadiance) {
    const std::string bytes = make_hdr(smooth_image(22, 11, 3), true);
    const Image expected = read_image_file(write("a", bytes)).image;
    for (const char* program : {"RGBE", "AUTOPANO11"}) {
        std::string other = bytes;
        other.replace(2, other.find('\n') - 2, program);
        EXPECT_EQ(read_image_file(write("a", other)).image, expected) << program;
    }
    EXPECT_THROW(read_image_file(write("a", "#?/bin/sh\necho\n")), InputError);
}

TEST_F(ImageFiles, PfmWithCarriageReturns) {
    Image image = smooth_image(7, 5, 3);
    image.values[image.index(0, 4)] = std::bit_cast<float>(0x0a123456);  // begins as a line ends
    const std::string bytes = make_big_endian_pfm(image);
    std::string lines = bytes;
    std::size_t at = 0;
    for (int line = 0; line < 3; ++line) {
        at = lines.find('\n', at);
        lines.insert(at, "\r");
        at += 2;
    }
    EXPECT_EQ(read_image_file(write("a", lines)).image, image);
    EXPECT_EQ(read_image_file(write("a", lines + "more")).image, image);
    EXPECT_THROW(read_image_file(write("a", lines.substr(0, lines.size() - 1))), InputError);
    lines = bytes;
    std::replace(lines.begin(), lines.begin() + 11, '\n', '\r');  // the header
    EXPECT_EQ(read_image_file(write("a", lines)).image, image);
}

TEST_F(ImageFiles, PfmOfEitherByteOrderAndScale) {
    for (const int channels : {1, 3}) {
        const Image image = smooth_image(7, 5, channels);
        std::string bytes = make_big_endian_pfm(image);
        expect_equal(read_image_file(write("a", bytes)).image, image, 0);
        bytes.replace(bytes.find("1.0"), 3, "2.0");
        Image doubled = image;
        for (float& v : doubled.values) v *= 2;
        expect_equal(read_image_file(write("a", bytes)).image, doubled, 0);
        bytes.insert(bytes.find("2.0"), "+");
        expect_equal(read_image_file(write("a", bytes)).image, doubled, 0);
        bytes[2] = bytes[bytes.find("+") - 1] = ' ';  // on one line
        expect_equal(read_image_file(write("a", bytes)).image, doubled, 0);
    }
}

TEST_F(ImageFiles, ExrOfEveryCompression) {
    struct Case {
        int compression;
        float half_tolerance, float_tolerance;
    };
    // none, RLE, ZIPS, ZIP, PIZ are lossless; PXR24 rounds floats to 24 bits; B44 and DWA are lossy
    // in half.
    constexpr float kHalf = 2.5e-4f;  // rounding to half below 1
    const Case kCases[] = {{0, kHalf, 0},     {1, kHalf, 0},     {2, kHalf, 0}, {3, kHalf, 0},
                           {4, kHalf, 0},     {5, kHalf, 2e-5f}, {6, 0.02f, 0}, {7, 0.02f, 0},
                           {8, 0.02f, 0.02f}, {9, 0.02f, 0.02f}};
    const Image image = smooth_image(53, 70, 3);
    for (const Case& c : kCases)
        for (const bool half : {false, true})
            for (const bool tiled : {false, true}) {
                SCOPED_TRACE("compression " + std::to_string(c.compression) +
                             (half ? " half" : " float") + (tiled ? " tiled" : ""));
                make_exr(folder / "a.exr", image, {c.compression, half, 0, 0, tiled});
                expect_equal(read_image_file(folder / "a.exr").image, image,
                             half ? c.half_tolerance : c.float_tolerance);
            }
}

TEST_F(ImageFiles, ExrWindowsPartsAndChannels) {
    const Image image = smooth_image(23, 12, 3), gray = smooth_image(23, 12, 1);
    make_exr(folder / "a", image, {3, false, -7, 1000});
    expect_equal(read_image_file(folder / "a").image, image, 0);
    make_exr(folder / "a", image, {3, false, 5, -3, true});
    expect_equal(read_image_file(folder / "a").image, image, 0);
    make_exr(folder / "a", image, {3, false, 0, 0, false, 2});
    expect_equal(read_image_file(folder / "a").image, image, 0);
    make_exr(folder / "a", image, {3, false, 0, 0, false, 1, {"R", "G", "B", "A", "depth.Z"}});
    expect_equal(read_image_file(folder / "a").image, image, 0);
    for (const char* name : {"Y", "Z", "A", "left.depth"}) {
        make_exr(folder / "a", gray, {3, false, 0, 0, false, 1, {name}});
        expect_equal(read_image_file(folder / "a").image, gray, 0);
    }
    make_exr(folder / "a", gray, {3, false, 0, 0, false, 1, {"Y", "A"}});
    expect_equal(read_image_file(folder / "a").image, gray, 0);
}

TEST_F(ImageFiles, ExrChannelsOfALayerOrInLowerCase) {
    const Image image = smooth_image(23, 12, 3), gray = smooth_image(23, 12, 1);
    const std::vector<std::string> kNames[] = {
        {"r", "g", "b"}, {"L.R", "L.G", "L.B"}, {"a.b.r", "a.b.g", "a.b.B"}};
    for (const auto& names : kNames) {
        make_exr(folder / "a", image, {.channels = names});
        expect_equal(read_image_file(folder / "a").image, image, 0);
        EXPECT_EQ(read_image_file(folder / "a").alpha.width, 0);
    }
    make_exr(folder / "a", image, {.channels = {"L.R", "L.G", "L.B", "L.A"}});
    expect_equal(read_image_file(folder / "a").image, image, 0);
    expect_equal(read_image_file(folder / "a").alpha, gray, 0);
    make_exr(folder / "a", image, {.channels = {"R", "G", "B", "L.G", "L.B", "L.R"}});
    expect_equal(read_image_file(folder / "a").image, image, 0);
    make_exr(folder / "a", gray, {.channels = {"L.y"}});
    expect_equal(read_image_file(folder / "a").image, gray, 0);
}

/// The colours of an image times a matrix [to][from].
Image converted(Image image, const std::array<std::array<float, 3>, 3>& matrix) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const std::array<float, 3> from{image.at(x, y, 0), image.at(x, y, 1),
                                            image.at(x, y, 2)};
            for (std::size_t c = 0; c < 3; ++c)
                image.at(x, y, static_cast<int>(c)) =
                    matrix[c][0] * from[0] + matrix[c][1] * from[1] + matrix[c][2] * from[2];
        }
    return image;
}

// What Mitsuba 3.9.1 makes of such a file.
constexpr std::array<std::array<float, 3>, 3> kXyz{{{3.240479f, -1.537150f, -0.498535f},
                                                    {-0.969256f, 1.875991f, 0.041556f},
                                                    {0.055648f, -0.204043f, 1.057311f}}};

TEST_F(ImageFiles, ExrOfXyz) {
    const Image image = smooth_image(23, 12, 3);
    for (const bool alpha : {false, true}) {
        std::vector<std::string> names{"X", "Y", "Z"};
        if (alpha) names.emplace_back("A");
        make_exr(folder / "a", image, {.channels = names});
        expect_equal(read_image_file(folder / "a").image, converted(image, kXyz), 1e-5f);
        EXPECT_EQ(read_image_file(folder / "a").alpha.width, alpha ? 23 : 0);
    }
    make_exr(folder / "a", image, {.channels = {"R", "G", "B", "X", "Y", "Z"}});
    expect_equal(read_image_file(folder / "a").image, image, 0);
}

const std::vector<float> kAcesCg{0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f};

TEST_F(ImageFiles, ExrOfOtherPrimaries) {
    const Image image = smooth_image(23, 12, 3);
    const auto read = [&](const ExrLayout& layout) {
        make_exr(folder / "a", image, layout);
        return read_image_file(folder / "a");
    };
    // What Mitsuba 3.9.1 makes of it: white stays that of the file.
    const std::array<std::array<float, 3>, 3> kExpected{{{1.7312537f, -0.6040428f, -0.0801076f},
                                                         {-0.1316190f, 1.1348411f, -0.0086795f},
                                                         {-0.0245683f, -0.1257504f, 1.0656371f}}};
    expect_equal(read({.chromaticities = kAcesCg}).image, converted(image, kExpected), 1e-5f);
    EXPECT_EQ(read_numbers_file(folder / "a").image, image);
    const ImageFile alpha = read({.channels = {"R", "G", "B", "A"}, .chromaticities = kAcesCg});
    expect_equal(alpha.image, converted(image, kExpected), 1e-5f);
    expect_equal(alpha.alpha, smooth_image(23, 12, 1), 0);
    const std::vector<float> kOfXyz{1, 0, 0, 1, 0, 0, 1.0f / 3, 1.0f / 3};
    expect_equal(read({.chromaticities = kOfXyz}).image, converted(image, kXyz), 1e-5f);
    expect_equal(read({.channels = {"X", "Y", "Z"}, .chromaticities = kAcesCg}).image,
                 converted(image, kXyz), 1e-5f);
    const std::vector<float> kRec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    EXPECT_EQ(read({.chromaticities = kRec709}).image, image);
    EXPECT_EQ(read({.channels = {"Y"}, .chromaticities = kAcesCg}).image, smooth_image(23, 12, 1));
    for (const float same : {0.0f, 0.3f})
        EXPECT_THROW(read({.chromaticities = std::vector<float>(8, same)}), InputError);
}

TEST_F(ImageFiles, WritingIsAllOrNothing) {
    const Image image = smooth_image(4, 4, 3);
    write_image(folder / "a.exr", image);
    const std::string before = read_bytes(folder / "a.exr");
    EXPECT_THROW(write_image(folder / "a.exr", {4, 4, 5, std::vector<float>(80)}), InputError);
    EXPECT_THROW(write_image(folder / "a.pfm", {4, 4, 2, std::vector<float>(32)}), InputError);
    EXPECT_THROW(write_image(folder / "a.jpg", image), InputError);
    EXPECT_THROW(write_image(folder / "missing/a.exr", image), OutputError);
    EXPECT_THROW(write_image(folder / "missing/a.png", image), OutputError);
    fs::create_directories(folder / "taken.png/inside");
    EXPECT_THROW(write_image(folder / "taken.png", image), OutputError);  // a folder is in the way
    ASSERT_EQ(mkfifo((folder / "pipe.png").c_str(), 0600), 0);
    EXPECT_THROW(write_image(folder / "pipe.png", image), OutputError);
    EXPECT_TRUE(fs::is_fifo(folder / "pipe.png"));
    EXPECT_EQ(read_bytes(folder / "a.exr"), before);
    {
        FileWriter unfinished(folder / "a.exr");
        unfinished.write("half", 4);
    }
    EXPECT_THROW(require_writable(folder / "missing/a.exr"), OutputError);
    EXPECT_THROW(require_writable(folder / "taken.png"), OutputError);
    require_writable(folder / "a.exr");
    require_writable(folder / "b.exr");
    EXPECT_EQ(read_bytes(folder / "a.exr"), before);
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder)) files += entry.is_regular_file();
    EXPECT_EQ(files, 1u);
}

TEST_F(ImageFiles, WhatIsTooLargeToBeReadIsNotWritten) {
    constexpr int kMax = kMaxImageSide;
    for (const char* name : {"a.exr", "a.png", "a.pfm"}) {
        const fs::path file = folder / name;
        for (const auto& [width, height] : {std::pair{kMax + 1, 1}, std::pair{1, kMax + 1}}) {
            try {
                write_image(file, make_image(width, height, 1, 1.0f));
                ADD_FAILURE() << name << " is written";
            } catch (const InputError& e) {
                EXPECT_NE(std::string(e.what()).find(file.string() + ": cannot write"),
                          std::string::npos)
                    << e.what();
            }
            EXPECT_TRUE(fs::is_empty(folder)) << name;
        }
        for (const Image& image : {make_image(kMax, 1, 1, 1.0f), make_image(1, kMax, 3, 1.0f)}) {
            write_image(file, image);
            expect_equal(read_image(file), image, 0);
        }
        fs::remove(file);
    }
}

TEST_F(ImageFiles, SameImageSameBytes) {
    const Image image = smooth_image(30, 20, 3);
    for (const char* name : {"a.exr", "a.png", "a.pfm"}) {
        write_image(folder / name, image);
        const std::string first = read_bytes(folder / name);
        write_image(folder / name, image);
        EXPECT_EQ(first, read_bytes(folder / name));
    }
}

}  // namespace
}  // namespace burnish
