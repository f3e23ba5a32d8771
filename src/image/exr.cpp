// OpenEXR by the library's C++ interface, which hides tiles, parts and compressions behind
// scanlines.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <mutex>
#include <new>
#include <span>
#include <vector>

#include "burnish/error.h"
#include "image/formats.h"

namespace burnish {

namespace {

/// The names of the channels to read: R, G, B, or Y, or the only one (alpha aside).
std::vector<std::string> pick_channels(const std::string& name, const Imf::ChannelList& channels) {
    const auto has = [&](const char* channel) { return channels.findChannel(channel) != nullptr; };
    if (has("R") && has("G") && has("B")) return {"R", "G", "B"};
    if (has("Y") && !has("RY") && !has("BY")) return {"Y"};
    std::vector<std::string> colours;
    std::string all;
    for (auto i = channels.begin(); i != channels.end(); ++i) {
        if (std::string(i.name()) != "A") colours.emplace_back(i.name());
        all += (all.empty() ? "" : ", ") + std::string(i.name());
    }
    if (colours.size() != 1)
        formats::fail(name, "EXR",
                      "found the channels " + all + ", expected R, G, B or Y or a single channel");
    return colours;
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
        default:
            return 0;
    }
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

/// The image that the channels are read into once the file has the buffer; it may be moved.
Image make_image_of(const std::string& name, const Imf::Header& header,
                    const std::vector<std::string>& channels, Imf::FrameBuffer& buffer) {
    const auto window = header.dataWindow();
    const long long width = static_cast<long long>(window.max.x) - window.min.x + 1;
    const long long height = static_cast<long long>(window.max.y) - window.min.y + 1;
    formats::check_size(name, "EXR", width, height, static_cast<int>(channels.size()));
    Image image = make_image(static_cast<int>(width), static_cast<int>(height),
                             static_cast<int>(channels.size()));

    const std::size_t x_stride = sizeof(float) * channels.size();
    const std::size_t y_stride = x_stride * static_cast<std::size_t>(width);
    const std::int64_t offset = window.min.x * static_cast<std::int64_t>(x_stride) +
                                window.min.y * static_cast<std::int64_t>(y_stride);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const Imf::Channel& channel = header.channels()[channels[c].c_str()];
        if (channel.xSampling != 1 || channel.ySampling != 1)
            formats::fail(
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

ImageFile formats::read_exr(const std::filesystem::path& file) {
    const std::string name = file.string();
    limit_sizes();
    try {
        Imf::InputFile input(name.c_str());
        const Imf::Header& header = input.header();
        require_bytes(name, header);
        const Imf::ChannelList& stored = header.channels();
        const std::vector<std::string> channels = pick_channels(name, stored);
        Imf::FrameBuffer buffer;
        ImageFile read{make_image_of(name, header, channels, buffer), PixelEncoding::kFloat, "EXR"};
        read.bits = stored[channels[0].c_str()].type == Imf::HALF ? 16 : 32;
        if (stored.findChannel("A") && channels[0] != "A")
            read.alpha = make_image_of(name, header, {"A"}, buffer);
        input.setFrameBuffer(buffer);
        input.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
        return read;
    } catch (const InputError&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        fail(name, "EXR", error.what());
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
