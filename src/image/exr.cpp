// OpenEXR by the library's C++ interface, which hides tiles, parts and compressions behind
// scanlines.
#include <ImathMatrix.h>
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "burnish/error.h"
#include "core/lower_case.h"
#include "image/formats.h"
#include "image/xyz.h"

namespace burnish {

namespace {

/// The channels of a layer, by the last parts of their names in lower case: "r" is "Left.R".
using Layer = std::map<std::string, std::string>;

/// By the first parts of the names, which are empty where there is no dot.
std::map<std::string, Layer> layers_of(const Imf::ChannelList& channels) {
    std::map<std::string, Layer> layers;
    for (auto i = channels.begin(); i != channels.end(); ++i) {
        const std::string name = i.name();
        const std::size_t dot = name.rfind('.');
        const std::string part = lower_case(dot == std::string::npos ? name : name.substr(dot + 1));
        layers[dot == std::string::npos ? "" : name.substr(0, dot)].emplace(part, name);
    }
    return layers;
}

/// Names of channels that make a picture.
struct Picture {
    std::vector<std::string> colors;  ///< of one layer
    std::string alpha;                ///< of the same layer; empty: none
    bool is_xyz = false;
};

/// Without colours where the layer has none: R, G, B, or X, Y, Z, or Y.
Picture picture_of(const Layer& layer) {
    const auto has = [&](const char* part) { return layer.contains(part); };
    Picture picture;
    if (has("r") && has("g") && has("b"))
        picture.colors = {layer.at("r"), layer.at("g"), layer.at("b")};
    else if (has("x") && has("y") && has("z"))
        picture.colors = {layer.at("x"), layer.at("y"), layer.at("z")}, picture.is_xyz = true;
    else if (has("y") && !has("ry") && !has("by"))
        picture.colors = {layer.at("y")};
    if (has("a")) picture.alpha = layer.at("a");
    return picture;
}

/// The picture without a layer's name, or of the only layer, or the only channel (alpha aside).
Picture pick_channels(const std::string& name, const Imf::ChannelList& channels) {
    const std::map<std::string, Layer> layers = layers_of(channels);
    Picture only;
    std::size_t count = 0;
    bool any_colors = false;
    std::string all;
    for (const auto& [layer_name, layer] : layers) {
        Picture picture = picture_of(layer);
        if (!picture.colors.empty() && (layer_name.empty() || layers.size() == 1)) return picture;
        any_colors |= !picture.colors.empty();
        for (const auto& [part, channel] : layer) {
            all += (all.empty() ? "" : ", ") + channel;
            if (part != "a") only = {{channel}, picture.alpha, false}, ++count;
        }
    }
    if (count == 0 && layers.size() == 1 && layers.begin()->second.size() == 1)  // alpha alone
        only = {{layers.begin()->second.at("a")}, "", false}, count = 1;
    if (count != 1)
        formats::refuse(
            name, "EXR",
            "found the channels " + all + ", expected " +
                (any_colors ? "one layer, or R, G, B without a layer's name (in Blender: OpenEXR, "
                              "not OpenEXR MultiLayer)"
                            : "R, G, B or X, Y, Z or Y of one layer or a single channel"));
    return only;
}

/// A colour is a row that is multiplied with it from the left.
using ColorMatrix = Imath::M44f;

/// XYZ to linear Rec. 709.
ColorMatrix matrix_of_xyz() {
    ColorMatrix matrix;
    for (int from = 0; from < 3; ++from)
        for (int to = 0; to < 3; ++to)
            matrix[from][to] = static_cast<float>(kRec709OfXyz[to][from]);
    return matrix;
}

bool is_near(const Imf::Chromaticities& a, const Imf::Chromaticities& b) {
    constexpr float kNear = 1e-6f;  // Mitsuba's
    return (a.red - b.red).length2() + (a.green - b.green).length2() + (a.blue - b.blue).length2() +
               (a.white - b.white).length2() <
           kNear;
}

/// To linear Rec. 709, as Mitsuba does it: by XYZ, whatever the white is. Null: as it is.
std::optional<ColorMatrix> matrix_of(const std::string& name, const Imf::Header& header,
                                     const Picture& picture) {
    if (picture.is_xyz) return matrix_of_xyz();
    if (picture.colors.size() != 3 || !Imf::hasChromaticities(header)) return {};
    const Imf::Chromaticities& found = Imf::chromaticities(header);
    const Imf::Chromaticities rec709, xyz({1, 0}, {0, 1}, {0, 0}, {1.0f / 3, 1.0f / 3});
    if (is_near(found, rec709)) return {};
    if (is_near(found, xyz)) return matrix_of_xyz();
    const ColorMatrix matrix = Imf::RGBtoXYZ(found, 1) * Imf::XYZtoRGB(rec709, 1);
    const float* values = matrix.getValue();
    if (!std::all_of(values, values + 16, [](float v) { return std::isfinite(v); }))
        formats::fail(
            name, "EXR",
            fmt::format("found the chromaticities ({}, {}), ({}, {}), ({}, {}) and ({}, {}), "
                        "expected three primaries that span colours and a white",
                        found.red.x, found.red.y, found.green.x, found.green.y, found.blue.x,
                        found.blue.y, found.white.x, found.white.y));
    return matrix;
}

void convert(const ColorMatrix& matrix, Image& image) {
    for (std::size_t i = 0; i < image.values.size(); i += 3) {
        float* color = image.values.data() + i;
        Imath::V3f converted;
        matrix.multDirMatrix(Imath::V3f(color[0], color[1], color[2]), converted);
        color[0] = converted.x, color[1] = converted.y, color[2] = converted.z;
    }
}

/// How many bytes of pixels one byte of a file can stand for; 0: without a bound.
std::uint64_t max_ratio(Imf::Compression compression) {
    switch (compression) {
        case Imf::NO_COMPRESSION:
            return 1;
        case Imf::RLE_COMPRESSION:
            return 64;  // two bytes for a run of 128
        case Imf::ZIP_COMPRESSION:
        case Imf::ZIPS_COMPRESSION:
        case Imf::PXR24_COMPRESSION:  // of four bytes it keeps three
            return 1400;              // deflate: 1032
        case Imf::PIZ_COMPRESSION:
            return 512;  // ten bits for a run of 256 numbers of 16 bits
        case Imf::B44_COMPRESSION:
            return 3;  // 14 bytes for 16 halves
        case Imf::B44A_COMPRESSION:
            return 11;  // three bytes for 16 halves
        case Imf::DWAA_COMPRESSION:
        case Imf::DWAB_COMPRESSION:
            return 140'000;  // deflate's 1032 of two bytes for 64 floats
        default:
            return 0;
    }
}

/// Of a file without tiles, at least.
int rows_of_chunk(Imf::Compression compression) {
    switch (compression) {
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION:
            return 16;
        case Imf::PIZ_COMPRESSION:
        case Imf::B44_COMPRESSION:
        case Imf::B44A_COMPRESSION:
        case Imf::DWAA_COMPRESSION:
            return 32;
        case Imf::DWAB_COMPRESSION:
            return 256;
        default:
            return 1;
    }
}

/// What the library makes room for beside the picture: a chunk with all channels; where it has
/// tiles, a row of them, too, with the `read` channels that are read.
double chunk_bytes(const Imf::Header& header, std::size_t read) {
    const auto window = header.dataWindow();
    const double width = static_cast<double>(window.max.x) - window.min.x + 1;
    double pixels = width * rows_of_chunk(header.compression()), bytes = 0;
    if (header.hasTileDescription()) {
        const Imf::TileDescription& tile = header.tileDescription();
        pixels = double{1} * tile.xSize * tile.ySize;
        bytes = width * tile.ySize * static_cast<double>(sizeof(float) * read);
    }
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        bytes += pixels * (c.channel().type == Imf::HALF ? 2 : 4) / c.channel().xSampling;
    return bytes;
}

/// Before anything is allocated for the pixels that a header claims.
void require_bytes(const std::string& name, const Imf::Header& header) {
    const auto window = header.dataWindow();
    const auto width = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
    const auto height = static_cast<std::uint64_t>(std::int64_t{window.max.y} - window.min.y + 1);
    std::uint64_t pixels = 0;  // bytes
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        pixels += width * height * (c.channel().type == Imf::HALF ? 2u : 4u) /
                  static_cast<std::uint64_t>(c.channel().xSampling * c.channel().ySampling);
    const std::uint64_t ratio = max_ratio(header.compression());
    const std::uint64_t found = std::filesystem::file_size(name);
    if (ratio > 0 && pixels / ratio > found)
        formats::fail(name, "EXR",
                      fmt::format("found {} bytes, expected {} or more for {} x {} pixels", found,
                                  pixels / ratio, width, height));
}

/// Slices address pixel (0, 0) of the image plane, which lies outside the data window in general.
char* plane_origin(const float* first, std::int64_t offset_bytes) {
    return reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(first) -
                                   static_cast<std::uintptr_t>(offset_bytes));
}

/// Without values.
Image shape_of(const std::string& name, const Imf::Header& header, std::size_t channels) {
    const auto window = header.dataWindow();
    const long long width = static_cast<long long>(window.max.x) - window.min.x + 1;
    const long long height = static_cast<long long>(window.max.y) - window.min.y + 1;
    formats::check_size(name, "EXR", width, height, static_cast<int>(channels));
    return {static_cast<int>(width), static_cast<int>(height), static_cast<int>(channels), {}};
}

/// The image that the channels are read into once the file has the buffer; it may be moved.
Image make_image_of(const std::string& name, const Imf::Header& header,
                    const std::vector<std::string>& channels, Imf::FrameBuffer& buffer) {
    const auto window = header.dataWindow();
    Image image = shape_of(name, header, channels.size());
    image.values.resize(image.index(0, image.height));

    const std::size_t x_stride = sizeof(float) * channels.size();
    const std::size_t y_stride = x_stride * static_cast<std::size_t>(image.width);
    const std::int64_t offset = window.min.x * static_cast<std::int64_t>(x_stride) +
                                window.min.y * static_cast<std::int64_t>(y_stride);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const Imf::Channel& channel = header.channels()[channels[c].c_str()];
        if (channel.xSampling != 1 || channel.ySampling != 1)
            formats::refuse(
                name, "EXR",
                "channel " + channels[c] + " is subsampled, expected one sample per pixel");
        buffer.insert(channels[c].c_str(),
                      Imf::Slice(Imf::FLOAT, plane_origin(image.values.data() + c, offset),
                                 x_stride, y_stride));
    }
    return image;
}

/// The library checks these before it allocates anything that grows with the image. They are its
/// own for all threads.
void limit_sizes() {
    static std::once_flag once;
    std::call_once(once, [] {
        Imf::Header::setMaxImageSize(kMaxImageSide, kMaxImageSide);
        Imf::Header::setMaxTileSize(kMaxImageSide, kMaxImageSide);
    });
}

}  // namespace

ImageFile formats::read_exr(const std::filesystem::path& file, FileColors colors, Content content) {
    const std::string name = file.string();
    limit_sizes();
    require_exr_header(file);
    bool is_known = false;  // what the header says
    try {
        Imf::MultiPartInputFile parts(name.c_str());  // reads headers alone
        const Imf::Header& header = parts.header(0);
        require_bytes(name, header);
        const Imf::ChannelList& stored = header.channels();
        const Picture picture = pick_channels(name, stored);
        if (content == Content::kHeader) {
            Image shape = shape_of(name, header, picture.colors.size());
            shape.channels += !picture.alpha.empty();
            const auto read = static_cast<std::size_t>(shape.channels);
            ImageFile found{std::move(shape), PixelEncoding::kFloat, "EXR"};
            found.chunk_bytes = chunk_bytes(header, read);
            return found;
        }
        const auto matrix = colors == FileColors::kRec709 ? matrix_of(name, header, picture)
                                                          : std::optional<ColorMatrix>{};
        Imf::FrameBuffer buffer;
        ImageFile read{make_image_of(name, header, picture.colors, buffer), PixelEncoding::kFloat,
                       "EXR"};
        read.bits = stored[picture.colors[0].c_str()].type == Imf::HALF ? 16 : 32;
        read.overscan = header.dataWindow() != header.displayWindow();
        if (!picture.alpha.empty())
            read.alpha = make_image_of(name, header, {picture.alpha}, buffer);
        Imf::InputPart input(parts, 0);
        is_known = true;
        input.setFrameBuffer(buffer);
        input.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
        if (matrix) convert(*matrix, read.image);
        return read;
    } catch (const InputError&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        if (is_known) fail(name, "EXR", error.what());
        refuse_unknown(name, "EXR", error.what());
    }
}

std::string formats::encode_exr(const Image& image) {
    constexpr std::array<const char*, 4> kColor{"R", "G", "B", "A"}, kGray{"Y", "A"};
    const auto channels = static_cast<std::size_t>(image.channels);
    const std::span<const char* const> names((channels > 2 ? kColor : kGray).data(), channels);
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    const std::size_t x_stride = sizeof(float) * names.size();
    for (std::size_t c = 0; c < names.size(); ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
        buffer.insert(names[c],
                      Imf::Slice(Imf::FLOAT, plane_origin(image.values.data() + c, 0), x_stride,
                                 x_stride * static_cast<std::size_t>(image.width)));
    }
    // Not into the file: the library says nothing of what fails when it closes one.
    Imf::StdOSStream stream;
    {
        Imf::OutputFile output(stream, header);
        output.setFrameBuffer(buffer);
        output.writePixels(image.height);
    }
    return stream.str();
}

}  // namespace burnish
