#include "image/test_files.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <half.h>
#include <png.h>

#include <cstdio>

#include <jpeglib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace burnish::test_files {

Image smooth_image(int width, int height, int channels) {
    Image image = make_image(width, height, channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c)
                image.at(x, y, c) =
                    0.5f + 0.45f * std::sin(0.2f * static_cast<float>(x * (c + 1)) +
                                            0.15f * static_cast<float>(y) + static_cast<float>(c));
    return image;
}

namespace {

int code(float v) { return static_cast<int>(std::lround(v * 255.0f)); }

void append(png_structp png, png_bytep data, std::size_t size) {
    static_cast<std::string*>(png_get_io_ptr(png))
        ->append(reinterpret_cast<const char*>(data), size);
}
void flush(png_structp) {}

int channels_of(int color_type) {
    return color_type == 2 ? 3 : color_type == 4 ? 2 : color_type == 6 ? 4 : 1;
}

std::vector<std::uint8_t> png_row(const PngLayout& layout, int y) {
    const int channels = channels_of(layout.color_type);
    std::vector<std::uint8_t> row(
        static_cast<std::size_t>(layout.width * channels * layout.bits + 7) / 8);
    std::size_t bit = 0;
    for (int x = 0; x < layout.width; ++x)
        for (int c = 0; c < channels; ++c)
            for (int b = layout.bits - 1; b >= 0; --b, ++bit)
                if ((png_sample(layout, x, y, c) >> b) & 1)
                    row[bit / 8] = static_cast<std::uint8_t>(row[bit / 8] | (0x80 >> (bit % 8)));
    return row;
}

void put16(std::string& bytes, int v) {
    bytes += static_cast<char>(v & 255);
    bytes += static_cast<char>((v >> 8) & 255);
}
}  // namespace

void put32(std::string& bytes, std::uint32_t v) {
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>((v >> (8 * i)) & 255);
}

int png_sample(const PngLayout& layout, int x, int y, int channel) {
    const int mask = (1 << layout.bits) - 1;
    return (x * 37 + y * 101 + channel * 59 + (layout.bits == 16 ? x * 5003 : 0)) & mask;
}

int png_palette(int index, int channel) { return (index * 5 + channel * 80 + 7) & 255; }

std::string make_profile(const std::string& name, int version) {
    const auto big = [](std::size_t v) {
        std::string bytes;
        for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(v >> shift & 255);
        return bytes;
    };
    std::string tag = "desc" + big(0) + big(name.size() + 1) + name + '\0';
    if (version == 4) {
        tag = "mluc" + big(0) + big(1) + big(12) + "enUS" + big(2 * name.size()) + big(28);
        for (const char c : name) tag += {'\0', c};
    }
    tag.resize((tag.size() + 3) / 4 * 4);
    const std::size_t first = 128 + 4 + 12;
    const std::string illuminant = big(0xf6d6) + big(0x10000) + big(0xd32d);
    std::string profile = big(first + tag.size()) + "test" + big(std::size_t(version) << 24) +
                          "mntrRGB XYZ " + std::string(12, '\0') + "acsp" + std::string(28, '\0') +
                          illuminant;
    profile.resize(128);
    return profile + big(1) + "desc" + big(first) + big(tag.size()) + tag;
}

std::string make_png(const PngLayout& layout) {
    std::string bytes;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &bytes, append, flush);
    png_set_IHDR(png, info, static_cast<png_uint_32>(layout.width),
                 static_cast<png_uint_32>(layout.height), layout.bits, layout.color_type,
                 layout.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (layout.color_type == 3) {
        std::vector<png_color> palette(std::size_t{1} << layout.bits);
        for (std::size_t i = 0; i < palette.size(); ++i)
            palette[i] = {static_cast<png_byte>(png_palette(static_cast<int>(i), 0)),
                          static_cast<png_byte>(png_palette(static_cast<int>(i), 1)),
                          static_cast<png_byte>(png_palette(static_cast<int>(i), 2))};
        png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    }
    std::string key = "Comment", text = layout.text;
    png_text chunk{};
    chunk.compression = PNG_TEXT_COMPRESSION_zTXt;
    chunk.key = key.data(), chunk.text = text.data(), chunk.text_length = text.size();
    if (!text.empty()) png_set_text(png, info, &chunk, 1);
    if (!layout.profile.empty())
        png_set_iCCP(png, info, "ICC profile", PNG_COMPRESSION_TYPE_BASE,
                     reinterpret_cast<png_const_bytep>(layout.profile.data()),
                     static_cast<png_uint_32>(layout.profile.size()));
    if (layout.gamma > 0) png_set_gAMA(png, info, layout.gamma);
    if (const std::vector<double>& c = layout.chromaticities; !c.empty())
        png_set_cHRM(png, info, c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]);
    png_write_info(png, info);
    std::vector<std::vector<std::uint8_t>> rows;
    std::vector<png_bytep> pointers;
    for (int y = 0; y < layout.height; ++y) rows.push_back(png_row(layout, y));
    for (auto& row : rows) pointers.push_back(row.data());
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

std::string make_jpeg(const Image& image, int channels, bool progressive) {
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &memory, &size);
    jpeg.image_width = static_cast<JDIMENSION>(image.width);
    jpeg.image_height = static_cast<JDIMENSION>(image.height);
    jpeg.input_components = channels;
    jpeg.in_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 3 ? JCS_RGB : JCS_CMYK;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 100, TRUE);
    for (int c = 0; c < jpeg.num_components; ++c)  // chroma at full resolution
        jpeg.comp_info[c].h_samp_factor = jpeg.comp_info[c].v_samp_factor = 1;
    if (progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    std::vector<JSAMPLE> row(static_cast<std::size_t>(image.width * channels));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < channels; ++c)
                row[static_cast<std::size_t>(x * channels + c)] =
                    static_cast<JSAMPLE>(code(image.at(x, y, std::min(c, image.channels - 1))));
        JSAMPROW pointer = row.data();
        jpeg_write_scanlines(&jpeg, &pointer, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    std::string bytes(reinterpret_cast<char*>(memory), size);
    std::free(memory);
    return bytes;
}

std::string make_bmp(const Image& image) {
    const int row = (image.width * 3 + 3) / 4 * 4;
    std::string bytes = "BM";
    put32(bytes, static_cast<std::uint32_t>(54 + row * image.height));
    put32(bytes, 0);
    put32(bytes, 54);
    put32(bytes, 40);
    put32(bytes, static_cast<std::uint32_t>(image.width));
    put32(bytes, static_cast<std::uint32_t>(image.height));
    put16(bytes, 1);
    put16(bytes, 24);
    for (int i = 0; i < 6; ++i) put32(bytes, 0);
    for (int y = image.height - 1; y >= 0; --y) {
        for (int x = 0; x < image.width; ++x)
            for (int c = 2; c >= 0; --c) bytes += static_cast<char>(code(image.at(x, y, c)));
        bytes.append(static_cast<std::size_t>(row - image.width * 3), '\0');
    }
    return bytes;
}

std::string make_tga(const Image& image, bool run_length) {
    std::string bytes{'\0', '\0', static_cast<char>(run_length ? 10 : 2)};
    bytes.append(9, '\0');
    put16(bytes, image.width);
    put16(bytes, image.height);
    bytes += static_cast<char>(8 * image.channels);
    bytes += static_cast<char>(0x20 | (image.channels == 4 ? 8 : 0));  // first row on top; alpha
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            if (run_length) bytes += static_cast<char>(0x80);  // runs of one
            for (int c = 2; c >= 0; --c) bytes += static_cast<char>(code(image.at(x, y, c)));
            if (image.channels == 4) bytes += static_cast<char>(code(image.at(x, y, 3)));
        }
    return bytes;
}

std::string make_hdr(const Image& image, bool run_length) {
    std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height) +
                        " +X " + std::to_string(image.width) + "\n";
    for (int y = 0; y < image.height; ++y) {
        std::string planes[4];
        for (int x = 0; x < image.width; ++x) {
            const float brightest =
                std::max({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
            int exponent = 0;
            const float scale = std::frexp(brightest, &exponent) * 256.0f / brightest;
            for (int c = 0; c < 3; ++c)
                planes[c] += static_cast<char>(static_cast<int>(image.at(x, y, c) * scale));
            planes[3] += static_cast<char>(exponent + 128);
        }
        if (run_length) {
            bytes += "\x02\x02";
            bytes += static_cast<char>(image.width >> 8);
            bytes += static_cast<char>(image.width & 255);
            for (const std::string& plane : planes) bytes += static_cast<char>(image.width) + plane;
        } else {
            for (std::size_t x = 0; x < planes[0].size(); ++x)
                for (const std::string& plane : planes) bytes += plane[x];
        }
    }
    return bytes;
}

std::string make_big_endian_pfm(const Image& image) {
    std::string bytes = (image.channels == 3 ? "PF\n" : "Pf\n") + std::to_string(image.width) +
                        " " + std::to_string(image.height) + "\n1.0\n";
    for (int y = image.height - 1; y >= 0; --y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < image.channels; ++c) {
                const auto bits = std::bit_cast<std::uint32_t>(image.at(x, y, c));
                for (int shift = 24; shift >= 0; shift -= 8)
                    bytes += static_cast<char>((bits >> shift) & 255);
            }
    return bytes;
}

namespace {

/// One plane per channel, as half or float.
struct Planes {
    std::vector<std::vector<float>> floats;
    std::vector<std::vector<half>> halves;
};

Planes make_planes(const Image& image, std::size_t count) {
    Planes planes;
    for (std::size_t c = 0; c < count; ++c) {
        planes.floats.emplace_back();
        planes.halves.emplace_back();
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                planes.floats.back().push_back(
                    image.at(x, y, static_cast<int>(c) % image.channels));
                planes.halves.back().push_back(half(planes.floats.back().back()));
            }
    }
    return planes;
}

template <class T>
char* origin_of(std::vector<T>& plane, const ExrLayout& layout, int width) {
    return reinterpret_cast<char*>(plane.data()) -
           (static_cast<std::ptrdiff_t>(layout.y0) * width + layout.x0) *
               static_cast<std::ptrdiff_t>(sizeof(T));
}

}  // namespace

void make_exr(const std::filesystem::path& file, const Image& image, const ExrLayout& layout) {
    const Imath::Box2i window({layout.x0, layout.y0},
                              {layout.x0 + image.width - 1, layout.y0 + image.height - 1});
    const Imath::V2i border(layout.overscan, layout.overscan);
    const Imath::Box2i display(window.min + border, window.max - border);
    Imf::Header header(display, window);
    header.compression() = static_cast<Imf::Compression>(layout.compression);
    if (const std::vector<float>& c = layout.chromaticities; !c.empty())
        Imf::addChromaticities(header, {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}});
    Planes planes = make_planes(image, layout.channels.size());
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < layout.channels.size(); ++c) {
        const char* name = layout.channels[c].c_str();
        const std::size_t size = layout.half ? 2 : 4;
        header.channels().insert(name, Imf::Channel(layout.half ? Imf::HALF : Imf::FLOAT));
        buffer.insert(name,
                      Imf::Slice(layout.half ? Imf::HALF : Imf::FLOAT,
                                 layout.half ? origin_of(planes.halves[c], layout, image.width)
                                             : origin_of(planes.floats[c], layout, image.width),
                                 size, size * static_cast<std::size_t>(image.width)));
    }
    if (layout.tiled) {
        header.setTileDescription(Imf::TileDescription(16, 8, Imf::ONE_LEVEL));
        Imf::TiledOutputFile output(file.string().c_str(), header);
        output.setFrameBuffer(buffer);
        output.writeTiles(0, output.numXTiles() - 1, 0, output.numYTiles() - 1);
    } else if (layout.parts > 1) {
        std::vector<Imf::Header> headers(static_cast<std::size_t>(layout.parts), header);
        for (std::size_t i = 0; i < headers.size(); ++i) {
            headers[i].setName("part" + std::to_string(i));
            headers[i].setType(Imf::SCANLINEIMAGE);
        }
        Imf::MultiPartOutputFile output(file.string().c_str(), headers.data(), layout.parts);
        for (int i = 0; i < layout.parts; ++i) {
            Imf::OutputPart part(output, i);
            part.setFrameBuffer(buffer);
            part.writePixels(image.height);
        }
    } else {
        Imf::OutputFile output(file.string().c_str(), header);
        output.setFrameBuffer(buffer);
        output.writePixels(image.height);
    }
}

}  // namespace burnish::test_files
