// BMP and TGA files of kinds that few programs write.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "burnish/error.h"
#include "image/folder_of_files.h"
#include "image/image.h"
#include "image/test_files.h"

namespace burnish {
namespace {

using namespace test_files;

struct BmpAndTga : FolderOfFiles {};

std::string number(std::size_t v) {
    std::string bytes;
    put32(bytes, static_cast<std::uint32_t>(v));
    return bytes;
}

TEST_F(BmpAndTga, BmpWithOtherHeaders) {
    const Image image = smooth_image(22, 11, 3);
    const std::string bmp = make_bmp(image), pixels = bmp.substr(54);
    const Image expected = read_image_file(write("a", bmp)).image;
    const auto read = [&](std::string bytes, std::size_t offset) {
        return read_image_file(write("b", bytes.replace(10, 4, number(offset)))).image;
    };
    EXPECT_EQ(read(bmp.substr(0, 54) + std::string(8, 'x') + pixels, 62), expected);
    const std::string two("\x16\0\x0b\0\1\0\x18\0", 8);  // width, height, planes, bits
    EXPECT_EQ(read(bmp.substr(0, 14) + number(12) + two + pixels, 26), expected);
    // Bit fields of 32 bits in headers that hold the masks.
    std::string words;
    for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 22; ++x)
            words += pixels.substr(static_cast<std::size_t>(y * 68 + 3 * x), 3) + '\x80';
    for (const std::size_t header : {40, 52, 56}) {
        std::string bytes = bmp.substr(0, 54) + number(0xff0000) + number(0xff00) + number(0xff);
        if (header == 56) bytes += number(0xff000000);
        bytes.replace(14, 4, number(header)).replace(28, 6, std::string("\x20\0\3\0\0\0", 6));
        const std::size_t offset = bytes.size();
        EXPECT_EQ(read(bytes + words, offset), expected) << header;
        EXPECT_EQ(read_image_file(folder / "b").alpha.width, header == 56 ? 22 : 0);
    }
    EXPECT_THROW(read(bmp, 53), InputError);
}

TEST_F(BmpAndTga, BmpWithPalettes) {
    for (const bool is_os2 : {false, true})
        for (const int bits : {1, 4, 8}) {
            SCOPED_TRACE(std::to_string(bits) + (is_os2 ? " bits, OS/2" : " bits"));
            const int count = bits == 1 ? 1 : bits == 4 ? 5 : 200;  // fewer than indices
            std::string palette, pixels;
            for (int i = 0; i < count; ++i) {
                for (const int c : {3 * i, 2 * i, i + 9}) palette += static_cast<char>(c % 256);
                if (!is_os2) palette += '\0';
            }
            const std::size_t header = is_os2 ? 12 : 40, offset = 14 + header + palette.size();
            std::string bytes = "BM" + number(0) + number(0) + number(offset) + number(header);
            bytes += is_os2 ? std::string("\x04\0\x01\0", 4) : number(4) + number(1);
            bytes += number(1 + 65536 * static_cast<std::size_t>(bits));
            if (!is_os2) bytes += std::string(24, '\0');
            const int last = bits == 1 ? 1 : bits == 4 ? 15 : 255;
            const std::array<int, 4> indices{0, count - 1, last, 0};
            pixels = bits == 1   ? std::string("\x20\0\0\0", 4)
                     : bits == 4 ? std::string("\x04\xf0\0\0", 4)
                                 : std::string("\0\xc7\xff\0", 4);
            const Image read = read_image_file(write("a", bytes + palette + pixels)).image;
            ASSERT_EQ(read.width, 4);
            for (int x = 0; x < 4; ++x) {
                const int i = indices[static_cast<std::size_t>(x)];
                const std::array<int, 3> color{i + 9, 2 * i, 3 * i};
                for (int c = 0; c < 3; ++c)
                    EXPECT_EQ(
                        read.at(x, 0, c),
                        i < count
                            ? static_cast<float>(color[static_cast<std::size_t>(c)] % 256) / 255.0f
                            : 0.0f)
                        << x;
            }
        }
}

/// Of 8 bits, four pixels wide.
std::string bmp_with_palette(const std::string& palette) {
    const std::size_t offset = 54 + palette.size();
    return "BM" + number(0) + number(0) + number(offset) + number(40) + number(4) + number(1) +
           number(1 + 65536 * 8) + std::string(24, '\0') + palette +
           std::string("\0\x64\xc8\xff", 4);
}

TEST_F(BmpAndTga, AGreyPaletteGivesOneChannel) {
    std::string rising, falling;
    for (int i = 0; i < 256; ++i) {
        rising += std::string(3, static_cast<char>(i)) + '\0';
        falling += std::string(3, static_cast<char>(255 - i)) + '\0';
    }
    const std::array<int, 4> indices{0, 100, 200, 255};
    for (const bool falls : {false, true}) {
        const auto file = write("a", bmp_with_palette(falls ? falling : rising));
        EXPECT_EQ(read_image_header(file).image.channels, 1);
        const Image read = read_image_file(file).image;
        ASSERT_EQ(read.channels, 1);
        for (int x = 0; x < 4; ++x) {
            const int index = indices[static_cast<std::size_t>(x)];
            EXPECT_EQ(read.at(x, 0, 0), static_cast<float>(falls ? 255 - index : index) / 255.0f);
        }
    }
    rising[4 * 77] = 0;  // no pixel has the colour
    EXPECT_EQ(read_image_file(write("a", bmp_with_palette(rising))).image.channels, 3);
}

TEST_F(BmpAndTga, TgaFromRightToLeft) {
    for (const int channels : {3, 4}) {
        const Image image = smooth_image(22, 11, channels);
        std::string bytes = make_tga(image, false);
        const ImageFile upright = read_image_file(write("a", bytes));
        bytes[17] = static_cast<char>(bytes[17] | 0x10);
        const ImageFile mirrored = read_image_file(write("a", bytes));
        EXPECT_EQ(mirrored.image, oriented(upright.image, 2));
        EXPECT_EQ(mirrored.alpha, oriented(upright.alpha, 2));
    }
}

}  // namespace
}  // namespace burnish
