#include "burnish/photograph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burnish/error.h"
#include "core/count_of.h"
#include "core/variant.h"
#include "image/image.h"
#include "image/quality.h"
#include "image/whole.h"

namespace burnish {

namespace {

Encoding resolved(const Encoding& encoding, PixelEncoding stored) {
    if (!std::holds_alternative<ByFileType>(encoding)) return encoding;
    return stored == PixelEncoding::kFloat ? Encoding{LinearEncoding{}} : Encoding{SrgbEncoding{}};
}

void decode(const Encoding& encoding, const std::string& file, Image& image) {
    const auto each = [&](const auto& linear_of) {
        for (float& v : image.values) v = linear_of(v);
    };
    match(
        encoding, [](const ByFileType&) {}, [](const LinearEncoding&) {},
        [&](const SrgbEncoding&) { each(srgb_to_linear); },
        [&](const GammaEncoding& g) {
            if (!(g.gamma > 0 && g.gamma <= 10))
                throw InputError(fmt::format(
                    "{}: the gamma is {}, expected one above 0, at most 10", file, g.gamma));
            each([&](float v) {
                return static_cast<float>(std::copysign(std::pow(std::abs(double{v}), g.gamma), v));
            });
        });
}

/// Where a channel is at its maximum; width 0: nowhere.
Image find_clipped(const Image& codes) {
    Image clipped = make_image(codes.width, codes.height, 1);
    bool any = false;
    for (std::size_t i = 0; i < codes.values.size(); ++i)
        if (codes.values[i] >= 1)
            clipped.values[i / static_cast<std::size_t>(codes.channels)] = 1, any = true;
    return any ? clipped : Image{};
}

bool is_gray(const Image& image) {
    for (std::size_t i = 0; image.channels == 3 && i < image.values.size(); i += 3)
        if (image.values[i] != image.values[i + 1] || image.values[i] != image.values[i + 2])
            return false;
    return true;
}

std::size_t count_negative(const Image& image) {
    const auto channels = static_cast<std::ptrdiff_t>(image.channels);
    std::size_t count = 0;
    for (auto at = image.values.begin(); at != image.values.end(); at += channels)
        count += std::any_of(at, at + channels, [](float v) { return v < 0; });
    return count;
}

std::size_t count_clipped(const Photograph& p) {
    const std::vector<char> counted = counted_pixels(p.mask);
    std::size_t count = 0;
    for (std::size_t i = 0; i < p.clipped.values.size(); ++i)
        count += p.clipped.values[i] > 0 && (counted.empty() || counted[i]);
    return count;
}

}  // namespace

Photograph read_photograph(const std::string& file, const Encoding& encoding, Turning turning) {
    ImageFile read = read_image_file(file);
    require_no_overscan(read, file);
    require_finite(read.image, file);
    require_finite(read.alpha, file + ", alpha");
    Photograph p;
    p.type = read.type, p.bits = read.bits;
    p.profile = read.profile, p.says_linear = read.says_linear;
    p.orientation = read.orientation, p.turning = turning;
    if (turning == Turning::kAsStored) read.orientation = 1;
    p.is_gray = is_gray(read.image), p.has_alpha = read.alpha.width > 0;
    p.encoding = resolved(encoding, read.encoding);
    if (read.encoding != PixelEncoding::kFloat)
        p.clipped = oriented(find_clipped(read.image), read.orientation);
    p.negative_pixels = count_negative(read.image);
    decode(p.encoding, file, read.image);
    require_finite(read.image, file + ", decoded");
    p.image = with_channels(oriented(std::move(read.image), read.orientation), 3);
    p.file_width = p.image.width, p.file_height = p.image.height;
    p.mask = oriented(std::move(read.alpha), read.orientation);
    for (float& weight : p.mask.values) weight = std::clamp(weight, 0.0f, 1.0f);
    p.clipped_pixels = count_clipped(p);
    return p;
}

namespace {

/// Throws InputError where a part of a photograph is not of its picture's size.
void require_size_of(const Image& picture, const char* what, const Image& part, int channels) {
    if (part.width != picture.width || part.height != picture.height ||
        (part.channels != 1 && part.channels != channels))
        throw InputError(
            fmt::format("{} has {} x {} pixels and {}: expected {} of the picture's size, {} x {}",
                        what, part.width, part.height, count_of(part.channels, "channel"),
                        channels == 1 ? "one" : "one or three", picture.width, picture.height));
}

}  // namespace

void require_whole(const Photograph& p) {
    const auto check = [&](const char* what, const Image& part, int channels) {
        require_whole(part, what);
        if (part.width != 0) require_size_of(p.image, what, part, channels);
    };
    check("the picture", p.image, 3);
    check("the mask", p.mask, 3);
    check("the image of what is clipped", p.clipped, 1);
}

void add_mask(const Image& mask, Photograph& p) {
    require_whole(p);
    require_size_of(p.image, "the mask", mask, 3);
    require_whole(mask, "the mask");
    require_weights(mask, "the mask");
    const int channels = std::max(mask.channels, p.mask.channels);
    const Image earlier = with_channels(std::move(p.mask), channels);
    p.mask = with_channels(mask, channels);
    for (std::size_t i = 0; earlier.width > 0 && i < p.mask.values.size(); ++i)
        p.mask.values[i] *= earlier.values[i];
    p.clipped_pixels = count_clipped(p);
}

Image weights_of(const Photograph& p) {
    require_whole(p);
    if (p.clipped.width == 0) return p.mask;
    Image weights = p.mask.width > 0 ? p.mask : make_image(p.image.width, p.image.height, 1, 1.0f);
    for (std::size_t i = 0; i < weights.values.size(); ++i)
        if (p.clipped.values[i / static_cast<std::size_t>(weights.channels)] > 0)
            weights.values[i] = 0;
    return weights;
}

}  // namespace burnish
