// BMP and TGA by stb_image. stb invents zeros where a file ends too early, so the
// bytes are served by a source that notices.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 32768
#if __has_include(<stb/stb_image.h>)
#include <stb/stb_image.h>
#else
#include <stb_image.h>
#endif

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "image/formats.h"

namespace burnish {

namespace {

struct Source {
    std::string_view bytes;
    std::size_t offset = 0;
    bool overrun = false;         ///< a byte after the end was needed
    const char* ahead = nullptr;  ///< stb's own buffer
};

/// stb refills its own buffer, which it fills first of all, ahead of need: a short answer there is
/// an overrun only where nothing was left.
int on_read(void* user, char* out, int size) {
    auto& source = *static_cast<Source*>(user);
    if (!source.ahead) source.ahead = out;
    const std::size_t count =
        std::min(static_cast<std::size_t>(size), source.bytes.size() - source.offset);
    std::memcpy(out, source.bytes.data() + source.offset, count);
    source.offset += count;
    if (count == 0 || (count < static_cast<std::size_t>(size) && out != source.ahead))
        source.overrun = true;
    return static_cast<int>(count);
}

void on_skip(void* user, int count) {
    auto& source = *static_cast<Source*>(user);
    const auto target = static_cast<std::int64_t>(source.offset) + count;
    const auto end = static_cast<std::int64_t>(source.bytes.size());
    if (target > end) source.overrun = true;
    source.offset = static_cast<std::size_t>(std::clamp<std::int64_t>(target, 0, end));
}

int on_end(void* user) {
    const auto& source = *static_cast<Source*>(user);
    return source.offset >= source.bytes.size();
}

constexpr stbi_io_callbacks kCallbacks{on_read, on_skip, on_end};

/// Of the header of a TGA, which has 18 bytes.
int byte_of(std::string_view header, std::size_t at) {
    return static_cast<unsigned char>(header[at]);
}

/// stb does not subtract where a palette begins from the indices into it.
void require_whole_palette(const std::string& name, std::string_view header) {
    const int first = byte_of(header, 3) + 256 * byte_of(header, 4);
    if (byte_of(header, 1) == 1 && first > 0)
        formats::refuse(
            name, "TGA",
            fmt::format("found a palette that begins with colour {}, expected 0", first));
}

/// stb's pixels, freed with their owner.
using Pixels = std::unique_ptr<stbi_uc, decltype(&stbi_image_free)>;

}  // namespace

bool formats::looks_like_tga(std::string_view bytes) {
    Source source{bytes};
    int width = 0, height = 0, channels = 0;
    return bytes.size() > 18 &&
           stbi_info_from_callbacks(&kCallbacks, &source, &width, &height, &channels) != 0;
}

ImageFile formats::decode_stb(const std::string& name, std::string_view bytes, Content content) {
    const bool is_bmp = bytes.substr(0, 2) == "BM";
    const char* format = is_bmp ? "BMP" : "TGA";
    const std::string plain = is_bmp ? plain_bmp(name, bytes) : "";
    if (is_bmp)
        bytes = plain;
    else
        require_whole_palette(name, bytes);
    const auto stop = [&](const Source& source) {
        if (source.overrun) fail(name, format, "the file ends too early");
        refuse_unknown(name, format, stbi_failure_reason());
    };
    Source source{bytes};
    Image image;
    int stored = 0;
    if (!stbi_info_from_callbacks(&kCallbacks, &source, &image.width, &image.height, &stored))
        stop(source);
    if (is_bmp && has_gray_palette(bytes)) stored = 1;
    image.channels = stored;  // gray or RGB, and alpha
    // Of a BMP whose first row is on top, the height is negative; its rows come from top to bottom.
    check_size(name, format, image.width, std::abs(static_cast<long long>(image.height)), stored);
    image.height = std::abs(image.height);
    // A run of a TGA has at most 128 pixels, a byte of a BMP at most 8.
    if (image.index(0, image.height) / 128 / static_cast<std::size_t>(image.channels) >
        bytes.size())
        fail(name, format, "the file ends too early");
    if (content == Content::kHeader) return {std::move(image), PixelEncoding::kUnorm8, format, 8};

    source = {bytes};
    int width = 0, height = 0;
    const Pixels pixels(
        stbi_load_from_callbacks(&kCallbacks, &source, &width, &height, &stored, image.channels),
        stbi_image_free);
    if (source.overrun || !pixels) stop(source);
    image.values.resize(image.index(0, image.height));
    std::transform(pixels.get(), pixels.get() + image.values.size(), image.values.begin(),
                   [](stbi_uc v) { return static_cast<float>(v) / 255.0f; });
    const bool from_right_to_left = !is_bmp && (byte_of(bytes, 17) & 0x10) != 0;
    if (from_right_to_left) image = oriented(std::move(image), 2);
    ImageFile file{std::move(image), PixelEncoding::kUnorm8, format, 8};
    take_alpha(file);
    const std::vector<float>& alpha = file.alpha.values;
    if (std::all_of(alpha.begin(), alpha.end(), [](float a) { return a == 0; }))
        file.alpha = {};  // written by programs that do not fill it
    return file;
}

}  // namespace burnish
