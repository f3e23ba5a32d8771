// Damaged files load or throw InputError; a file that is cut off never loads.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>

#include "burnish/error.h"
#include "core/hash.h"
#include "core/random.h"
#include "error_of.h"
#include "image/files.h"
#include "image/folder_of_files.h"
#include "image/image.h"
#include "image/test_files.h"

namespace burnish {
namespace {

using namespace test_files;

struct Sample {
    std::string name, bytes;
};

struct DamagedImages : FolderOfFiles {
    /// The message; empty where it loads.
    std::string error_of(const std::string& bytes) const {
        return test::error_of([&] {
            const ImageFile file = read_image_file(write("image", bytes));
            EXPECT_EQ(file.image.values.size(), file.image.index(0, file.image.height));
        });
    }
    std::vector<Sample> samples() const {
        const Image image = smooth_image(20, 14, 3);
        std::vector<Sample> all{{"png", make_png({20, 14, 2, 8, false})},
                                {"png16i", make_png({20, 14, 6, 16, true})},
                                {"palette", make_png({20, 14, 3, 4, false})},
                                {"jpeg", make_jpeg(image, 3, false)},
                                {"progressive", make_jpeg(image, 1, true)},
                                {"bmp", make_bmp(image)},
                                {"tga", make_tga(image, false)},
                                {"tga rle", make_tga(image, true)},
                                {"tga, rows of 128 bytes", make_tga(smooth_image(32, 4, 4), false)},
                                {"hdr", make_hdr(image, false)},
                                {"hdr rle", make_hdr(image, true)},
                                {"pfm", make_big_endian_pfm(image)}};
        for (const int compression : {0, 1, 3, 4, 5, 6, 8}) {
            make_exr(folder / "sample.exr", image,
                     {compression, compression == 6, 0, 0, compression == 4});
            all.push_back(
                {"exr " + std::to_string(compression), read_bytes(folder / "sample.exr")});
        }
        return all;
    }
};

TEST_F(DamagedImages, SamplesAreSound) {
    for (const Sample& sample : samples()) EXPECT_EQ(error_of(sample.bytes), "") << sample.name;
}

TEST_F(DamagedImages, HeadersOfSoundFilesSayWhatIsInThem) {
    for (const Sample& sample : samples()) {
        const std::filesystem::path file = write("image", sample.bytes);
        const ImageFile header = read_image_header(file), whole = read_image_file(file);
        EXPECT_EQ(header.type, std::string(whole.type)) << sample.name;
        EXPECT_EQ(header.encoding, whole.encoding) << sample.name;
        EXPECT_TRUE(header.image.values.empty()) << sample.name;
        EXPECT_EQ(header.image.width, whole.image.width) << sample.name;
        EXPECT_EQ(header.image.height, whole.image.height) << sample.name;
        const int alpha = whole.alpha.width > 0;
        EXPECT_EQ(header.image.channels, whole.image.channels + alpha) << sample.name;
    }
}

TEST_F(DamagedImages, CutOffFilesThrow) {
    for (const Sample& sample : samples()) {
        const std::size_t step = std::max<std::size_t>(1, sample.bytes.size() / 97);
        for (std::size_t size = 0; size < sample.bytes.size(); size += step)
            EXPECT_NE(error_of(sample.bytes.substr(0, size)), "")
                << sample.name << " cut to " << size;
        EXPECT_NE(error_of(sample.bytes.substr(0, sample.bytes.size() - 1)), "") << sample.name;
    }
}

TEST_F(DamagedImages, FlippedBytesLoadOrThrow) {
    for (const Sample& sample : samples()) {
        int refused = 0;
        for (std::uint32_t trial = 0; trial < 150; ++trial) {
            std::string bytes = sample.bytes;
            const auto random =
                philox4x32({trial, 0, 0, 0}, {7, static_cast<std::uint32_t>(Stream::kTest)});
            // Half of the trials hit the header, where most decisions are made.
            const std::size_t range =
                trial % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 64);
            bytes[random[0] % range] = static_cast<char>(random[1]);
            if (trial % 4 > 1) bytes[random[2] % range] = static_cast<char>(random[3]);
            refused += !error_of(bytes).empty();
        }
        EXPECT_GT(refused, 0) << sample.name;
    }
}

TEST_F(DamagedImages, MessagesNameTheFileAndTheFault) {
    const std::string name = (folder / "image").string();
    const auto expect = [&](const std::string& bytes, const std::string& fragment) {
        const std::string error = error_of(bytes);
        EXPECT_EQ(error.rfind(name + ": ", 0), 0u) << error;
        EXPECT_NE(error.find(fragment), std::string::npos) << error;
    };
    const std::string png = make_png({20, 14, 2, 8, false});
    expect(png.substr(0, png.size() / 2), "damaged PNG file: the file ends too early");
    expect(make_jpeg(smooth_image(20, 14, 3), 4, false),
           "this JPEG file is not supported: found 4 components, expected 1 (gray) or 3 (RGB)");
    expect("hello", "not an image that can be read (5 bytes that start with [68 65 6c 6c 6f])");
    using namespace std::string_literals;
    expect(
        "\0\0\0\x18"
        "ftypheic"s,
        "a HEIC file, which is not read");
    expect("II*\0 and more"s, "a TIFF or raw file, which is not read");
    expect("RIFF1234WEBP", "a WebP file, which is not read");
    expect("P5\n2 1\n255\nab", "a PGM file, which is not read");
    expect("P6 2 1 255\nabcdef", "a PPM file, which is not read");
    expect("PF\n20 x\n-1\n", "found \"x\", expected the height");
    expect("PF\n40000 2\n-1\n",
           "40000 x 2 pixels with 3 channels, expected at most 32768 pixels a side");
    expect("PF\n30000 30000\n-1\n", "expected at most 32768 pixels a side and 536870912 values");
    expect("PF\n16384 8192\n-1\n", "the file ends too early, expected 1610612753 bytes");
    expect("PF\n300 300\n-1\n", "the file ends too early, expected 1080014 bytes");
    expect("Pf\n2 2\n0\n", "found the scale 0");
    expect("Pf\n2 2\ninf\n", "found the scale inf, expected a finite number other than 0");
    expect("Pf\n2 2\nnan\n", "found the scale nan");
    make_exr(folder / "sample.exr", smooth_image(4, 4, 3),
             {3, false, 0, 0, false, 1, {"U", "V", "W"}});
    expect(
        read_bytes(folder / "sample.exr"),
        "this EXR file is not supported: found the channels U, V, W, expected R, G, B or X, Y, Z "
        "or Y of one layer or a single channel");
    make_exr(folder / "sample.exr", smooth_image(4, 4, 3),
             {3, false, 0, 0, false, 1, {"L.R", "L.G", "L.B", "M.R", "M.G", "M.B"}});
    expect(read_bytes(folder / "sample.exr"),
           "not supported: found the channels L.B, L.G, L.R, M.B, M.G, M.R, expected one layer, or "
           "R, G, B without a layer's name (in Blender: OpenEXR, not OpenEXR MultiLayer)");
    EXPECT_THROW(read_image_file(folder / "absent.png"), InputError);
    EXPECT_THROW(read_image_file(folder), InputError);
}

TEST_F(DamagedImages, WhatIsNotKnownIsNotCalledDamaged) {
    const Image image = smooth_image(20, 14, 3);
    const std::string bmp = make_bmp(image), tga = make_tga(image, false),
                      hdr = make_hdr(image, false), jpeg = make_jpeg(image, 3, false);
    const auto expect = [&](const std::string& format, const std::string& bytes,
                            const std::string& what) {
        const std::string error = error_of(bytes);
        EXPECT_NE(error.find("this " + format + " file is not supported: "), std::string::npos)
            << error;
        EXPECT_NE(error.find(what), std::string::npos) << error;
    };
    expect("BMP", std::string(bmp).replace(30, 1, "\1"),
           "found the compression 1, expected none or bit fields, 0 or 3");
    expect("BMP", std::string(bmp).replace(14, 1, "@"), "found a header of 64 bytes, expected 12,");
    expect("BMP", std::string(bmp).replace(26, 1, "\2"), "found what is damaged or not known (");
    std::string palette = tga;
    palette[1] = palette[2] = 1, palette[3] = 2, palette[5] = 9, palette[7] = 24, palette[16] = 8;
    expect("TGA", palette, "found a palette that begins with colour 2, expected 0");
    for (const char* size : {"+Y 14 +X 20", "-Y 14 -X 20", "+X 20 -Y 14", "-X 20 +Y 14"})
        expect("HDR", std::string(hdr).replace(hdr.find("-Y"), 11, size), size);
    expect("HDR", std::string(hdr).replace(hdr.find("rle_rgbe"), 8, "rle_luve"),
           "found \"FORMAT=32-bit_rle_luve\", expected FORMAT=32-bit_rle_rgbe or "
           "FORMAT=32-bit_rle_xyze");
    const std::size_t pixels = hdr.find("+X 20\n") + 6;
    expect("HDR", std::string(hdr).replace(pixels + 4, 4, "\1\1\1\3"),
           "found a run of whole pixels");
    const std::size_t precision = jpeg.find("\xff\xc0") + 4;
    expect("JPEG", std::string(jpeg).replace(precision, 1, "\x0c"), "data precision 12");
    make_exr(folder / "sample.exr", image, {});
    std::string exr = read_bytes(folder / "sample.exr");
    exr[exr.find(std::string("compression\0compression\0", 24)) + 24 + 4] = 99;
    expect("EXR", exr, "found what is damaged or not known (");
}

/// The library would make room for as much.
TEST_F(DamagedImages, HeadersThatClaimMoreThanAFileHoldsAreRefused) {
    const auto put = [](std::string& bytes, std::size_t at, std::uint32_t number) {
        std::memcpy(&bytes[at], &number, sizeof number);
    };
    const auto behind = [](const std::string& bytes, const std::string& attribute) {
        return bytes.find(attribute) + attribute.size();
    };
    using namespace std::string_literals;
    const std::string tiled = read_bytes(BURNISH_TEST_DATA "/../fuzz/corpus/exr/tiled.exr");
    ASSERT_EQ(error_of(tiled), "");
    std::string claims = tiled;
    const std::size_t type = behind(claims, "type\0string\0"s);
    put(claims, type, 0x70000000);
    EXPECT_NE(error_of(claims).find(fmt::format(
                  "byte offset {}: found an attribute of 1879048192 bytes, expected at most {}",
                  type, claims.size() - type - 4)),
              std::string::npos)
        << error_of(claims);
    claims = tiled;
    const std::size_t window = behind(claims, "dataWindow\0box2i\0"s) + 4,
                      tiles = behind(claims, "tiles\0tiledesc\0"s) + 4;
    put(claims, window + 8, 32767), put(claims, window + 12, 32767);
    put(claims, tiles, 1), put(claims, tiles + 4, 1);
    EXPECT_NE(error_of(claims).find(fmt::format(
                  "found 1073741824 chunks in its header, expected at most {}", claims.size() / 8)),
              std::string::npos)
        << error_of(claims);
}

/// By the header alone: the samples that its pixels claim are never counted.
TEST_F(DamagedImages, DeepExrIsRefusedByName) {
    using namespace std::string_literals;
    make_exr(folder / "parts.exr", smooth_image(4, 4, 3), {3, false, 0, 0, false, 2});
    const std::string files[] = {read_bytes(BURNISH_TEST_DATA "/../fuzz/corpus/exr/tiled.exr"),
                                 read_bytes(folder / "parts.exr")};
    for (const std::string& file : files)
        for (const std::string type : {"deepscanline", "deeptile"}) {
            const std::string attribute = "type\0string\0"s;
            const std::size_t at = file.find(attribute) + attribute.size();
            const auto length = static_cast<unsigned char>(file.at(at));
            std::string deep = file, value;
            put32(value, static_cast<std::uint32_t>(type.size()));
            deep.replace(at, 4u + length, value + type);
            deep[5] = static_cast<char>(deep[5] | 8);
            const std::string expected =
                "this EXR file is not supported: found a deep image, expected one sample of each "
                "channel in a pixel";
            EXPECT_NE(error_of(deep).find(expected), std::string::npos) << error_of(deep);
            EXPECT_NE(
                test::error_of([&] { read_image_header(write("image", deep)); }).find(expected),
                std::string::npos);
        }
}

TEST_F(DamagedImages, OffsetsPointAtWhatWasFound) {
    const Image image = smooth_image(20, 14, 3);
    const auto expect = [&](const std::string& bytes, std::size_t at, const std::string& what) {
        const std::string error = error_of(bytes),
                          place = fmt::format("byte offset {}: {}", at, what);
        EXPECT_NE(error.find(place), std::string::npos) << error;
    };
    expect("PF\n20  x14 1.0\n", 7, "found \"x14\", expected the height");
    expect("PF\n20", 5, "found \"\", expected the height");
    const std::string flat = make_hdr(image, false), runs = make_hdr(image, true);
    const std::size_t size = flat.find("-Y 14"), rows = runs.find("+X 20\n") + 6;
    expect(std::string(flat).replace(size, 5, "-Y xx"), size, "found \"-Y xx +X 20\"");
    expect(std::string(runs).replace(rows + 3, 1, "\x15"), rows, "found a row of 21 pixels");
    expect(std::string(runs).replace(rows + 4, 1, "\x15"), rows + 4, "found a run of 21 pixels");
    expect(runs.substr(0, rows + 90), rows + 90, "the file ends too early");
}

TEST(ImageSide, IsAWholeNumberOfPixels) {
    for (const double side : {1.0, 2.0, 32768.0}) EXPECT_TRUE(is_side(side)) << side;
    for (const double none : {0.0, -1.0, 1.5, 32769.0, 1e300, std::nan("")})
        EXPECT_FALSE(is_side(none)) << none;
}

/// Sizes in the header that the file cannot hold are refused before anything of that size is
/// allocated.
TEST_F(DamagedImages, HugeSizesAreRefused) {
    std::string png = make_png({20, 14, 2, 8, false});
    const std::string bmp = make_bmp(smooth_image(8, 8, 3)),
                      tga = make_tga(smooth_image(8, 8, 3), false);
    png.replace(16, 4, std::string("\x7f\xff\xff\xff", 4));
    EXPECT_NE(error_of(png), "");
    EXPECT_NE(error_of(std::string(bmp).replace(18, 4, std::string("\xff\xff\xff\x7f", 4))), "");
    EXPECT_NE(error_of(std::string(tga).replace(12, 4, std::string("\xff\xff\xff\xff", 4))), "");
    EXPECT_NE(error_of("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 200000 +X 200000\n"), "");
    // The data window of an EXR file: the attribute "dataWindow" of type "box2i" and 16 bytes.
    make_exr(folder / "sample.exr", smooth_image(8, 8, 3), {});
    std::string exr = read_bytes(folder / "sample.exr");
    const std::size_t at = exr.find(std::string("dataWindow\0box2i\0", 17)) + 17 + 4 + 8;
    exr.replace(at, 8, std::string("\xff\xff\xff\x3f\xff\xff\xff\x3f", 8));
    EXPECT_NE(error_of(exr), "");
    // 1.2 GB, within the limits: more than so few bytes can hold.
    exr.replace(at, 8, std::string("\xff\x27\0\0\xff\x27\0\0", 8));
    const std::string error = error_of(exr + std::string(100000, '\0'));
    EXPECT_NE(error.find(" or more for 10240 x 10240 pixels"), std::string::npos) << error;
}

/// A chunk has all channels, also those that are not read, and as many rows where the image is low.
TEST_F(DamagedImages, TheHeaderOfAnExrTellsWhatAChunkTakes) {
    const auto chunk_of = [&](const ExrLayout& layout) {
        make_exr(folder / "a.exr", smooth_image(20, 14, 3), layout);
        return read_image_header(folder / "a.exr").chunk_bytes;
    };
    const std::vector<std::string> channels{"R", "G", "B", "L.a", "L.b"};
    constexpr int kRows[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    for (int compression = 0; compression < 10; ++compression)
        for (const bool half : {false, true})
            EXPECT_EQ(chunk_of({compression, half, 3, 4, false, 1, channels}),
                      kRows[compression] * 20 * 5 * (half ? 2 : 4))
                << compression;
    EXPECT_EQ(chunk_of({9, false, 0, 0, true, 1, channels}), 16 * 8 * 5 * 4 + 20 * 8 * 3 * 4);
    EXPECT_EQ(chunk_of({9, false, 0, 0, false, 2, channels}), 256 * 20 * 5 * 4);
}

/// The limit is that of colours and of alpha alone, which are read apart.
TEST_F(DamagedImages, TheHeaderOfALargeExrMayHaveAlpha) {
    make_exr(folder / "sample.exr", smooth_image(8, 8, 4),
             {3, false, 0, 0, false, 1, {"R", "G", "B", "A"}});
    std::string exr = read_bytes(folder / "sample.exr");
    const std::size_t at = exr.find(std::string("dataWindow\0box2i\0", 17)) + 17 + 4 + 8;
    exr.replace(at, 8, std::string("\xc7\x32\0\0\xdf\x2e\0\0", 8));
    const Image header =
        read_image_header(write("a.exr", exr + std::string(2'000'000, '\0'))).image;
    EXPECT_EQ(header.width, 13000);
    EXPECT_EQ(header.height, 12000);
    EXPECT_EQ(header.channels, 4);
}

std::uint32_t crc_of(const std::string& bytes) {
    std::uint32_t crc = 0xffffffff;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc;
}

/// The same where only the most that a compression can do is known.
TEST_F(DamagedImages, SizesBeyondWhatACompressionCanDoAreRefused) {
    std::string png = make_png({20, 14, 2, 8, false});
    png.replace(16, 8, std::string("\0\0\x40\0\0\0\x20\0", 8));
    const std::uint32_t crc = crc_of(png.substr(12, 17));
    for (int i = 0; i < 4; ++i)
        png[static_cast<std::size_t>(29 + i)] = static_cast<char>(crc >> (24 - 8 * i));
    EXPECT_NE(error_of(png).find("expected 390167 or more for 16384 x 8192 pixels"),
              std::string::npos)
        << error_of(png);
    for (const int compression : {4, 6, 7, 8, 9}) {
        make_exr(folder / "sample.exr", smooth_image(8, 8, 3), {compression});
        std::string exr = read_bytes(folder / "sample.exr");
        const std::size_t at = exr.find(std::string("dataWindow\0box2i\0", 17)) + 17 + 4 + 8;
        exr.replace(at, 8, std::string("\xff\x27\0\0\xff\x27\0\0", 8));
        const std::string error = error_of(exr + std::string(4000, '\0'));
        EXPECT_NE(error.find(" or more for 10240 x 10240 pixels"), std::string::npos)
            << compression << ": " << error;
    }
}

/// The maximum of the memory that the process has held so far, KiB. It never falls: what a test
/// measures tells most where the test runs alone, as under ctest.
long peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

TEST_F(DamagedImages, TextsOfAPngAreNotInflated) {
    const PngLayout plain{20, 14, 2, 8, false};
    PngLayout with_text = plain;
    with_text.text.assign(7'900'000, 'A');
    std::string png = make_png(with_text);
    const std::size_t begin = png.find("zTXt") - 4, end = png.find("IDAT") - 4;
    ASSERT_LT(begin, end);
    const std::string text = png.substr(begin, end - begin);
    for (int i = 0; i < 50; ++i) png.insert(begin, text);
    const auto file = write("a.png", png);
    const long before = peak_memory();
    const Image read = read_image(file);
    EXPECT_LT(peak_memory() - before, 100'000);
    EXPECT_EQ(read, read_image(write("b.png", make_png(plain))));
}

/// A run reads the headers of its pictures before them.
TEST_F(DamagedImages, HeadersAreReadWithoutTheRestOfTheFile) {
    for (const Sample& sample : samples()) {
        const auto file = write("image", sample.bytes);
        const ImageFile header = read_image_header(file);
        std::filesystem::resize_file(file, 400'000'000);
        const long before = peak_memory();
        const ReadLog log;
        EXPECT_EQ(read_image_header(file).image, header.image) << sample.name;
        EXPECT_LT(peak_memory() - before, 100'000) << sample.name;
        EXPECT_TRUE(log.files().empty()) << sample.name;
    }
}

/// A run that goes on compares its files, which may be large, beside its state.
TEST_F(DamagedImages, WhetherAFileIsAnotherOneTakesLittleMemory) {
    const std::string bytes = std::string(2'500'000, 'a') + "b";
    const auto file = write("file", bytes);
    const Input expected{file.string(), bytes.size(), hash_of(bytes)};
    EXPECT_EQ(input_of(file), expected);
    EXPECT_EQ(input_of(write("empty", "")).hash, hash_of(""));
    std::filesystem::resize_file(file, 400'000'000);
    const long before = peak_memory();
    EXPECT_FALSE(input_of(file) == expected);
    EXPECT_LT(peak_memory() - before, 100'000);
    EXPECT_THROW(input_of(folder / "missing"), InputError);
}

TEST_F(DamagedImages, AHeaderMayFollowMuchElse) {
    std::string jpeg = make_jpeg(smooth_image(20, 14, 3), 3, false);
    const std::string comment = "\xff\xfe\xff\xff" + std::string(65533, ' ');
    for (int i = 0; i < 17; ++i) jpeg.insert(2, comment);
    EXPECT_EQ(read_image_header(write("image", jpeg)).image.width, 20);
}

/// Each block of 8 x 8 pixels has a bit or more.
TEST_F(DamagedImages, SizesBeyondWhatAJpegCanHoldAreRefused) {
    for (const bool progressive : {false, true}) {
        std::string jpeg = make_jpeg(make_image(16, 16, 1, 0.5f), 1, progressive);
        const std::size_t at = jpeg.find(progressive ? "\xff\xc2" : "\xff\xc0") + 5;
        jpeg.replace(at, 4, std::string("\x20\0\x40\0", 4));
        EXPECT_NE(error_of(jpeg).find("expected 262144 or more for 16384 x 8192 pixels"),
                  std::string::npos)
            << error_of(jpeg);
    }
}

/// A progressive JPEG whose second scan, of one component, comes so often.
std::string with_scans(const std::string& jpeg, int count) {
    const std::string mark = "\xff\xda";
    const std::size_t first = jpeg.find(mark), begin = jpeg.find(mark, first + 2),
                      end = jpeg.find(mark, begin + 2);
    EXPECT_NE(end, std::string::npos);
    std::string scan = jpeg.substr(begin, end - begin);
    scan[9] = 0;  // of whole coefficients: as often as one likes
    std::string scans;
    for (int i = 0; i < count; ++i) scans += scan;
    return jpeg.substr(0, begin) + scans + "\xff\xd9";
}

/// Each scan goes over all pixels, whatever its bytes are.
TEST_F(DamagedImages, AProgressiveJpegOfThousandsOfScansIsRefused) {
    const std::string text =
        error_of(with_scans(make_jpeg(smooth_image(16, 16, 1), 1, true), 2000));
    EXPECT_NE(text.find("found more than 500 scans of 16 x 16 pixels"), std::string::npos) << text;
}

/// As many blocks in all as any picture has with some ten scans.
TEST_F(DamagedImages, ALargeJpegMayHaveFewerScans) {
    const std::string jpeg = make_jpeg(make_image(4096, 8192, 1, 0.5f), 1, true);
    const std::string text = error_of(with_scans(jpeg, 400));
    EXPECT_NE(text.find("found more than 256 scans of 4096 x 8192 pixels"), std::string::npos)
        << text;
    EXPECT_EQ(error_of(with_scans(jpeg, 15)), "");
}

/// Of one grey, in as few bytes as there can be.
TEST_F(DamagedImages, FlatJpegsAreRead) {
    for (const int channels : {1, 3})
        for (const bool progressive : {false, true})
            EXPECT_EQ(error_of(make_jpeg(make_image(2048, 1024, 3, 0.5f), channels, progressive)),
                      "");
}

}  // namespace
}  // namespace burnish
