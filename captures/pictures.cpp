#include "captures/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <variant>

#include "burnish/error.h"
#include "core/at_place.h"
#include "image/image.h"
#include "image/numbers.h"
#include "image/whole.h"

namespace burnish {

void require_size(const Image& image, int width, int height, const std::string& what,
                  const std::string& expected) {
    if (image.width != width || image.height != height)
        throw InputError(fmt::format("{} is {} x {} pixels, expected {}, {} x {}", what,
                                     image.width, image.height, expected, width, height));
}

void require_file_size(const Photograph& p, int width, int height, const std::string& what,
                       const std::string& expected) {
    require_size(Image{p.file_width, p.file_height}, width, height, what, expected);
}

std::string turning_text(const Photograph& p) {
    if (p.orientation == 1) return {};
    if (p.turning == Turning::kUpright)
        return fmt::format(", turned by EXIF orientation {}", p.orientation);
    return fmt::format(", EXIF orientation {} left out", p.orientation);
}

namespace {

/// Its alpha, where that cuts something out; else its colours.
MaskFile weights_of_file(ImageFile read) {
    constexpr float kOpaque = 0.999f;  // 1, as a half float may round it down
    const std::vector<float>& alpha = read.alpha.values;
    const bool cuts_out = std::any_of(alpha.begin(), alpha.end(), [](float a) {
        return !(a >= kOpaque);  // also where it is not a number
    });
    MaskFile mask;
    mask.weights = oriented(std::move(cuts_out ? read.alpha : read.image), read.orientation);
    if (cuts_out) mask.source = MaskSource::kAlpha;
    return mask;
}

/// Finds the source and the largest weight, of weights that are finite.
void describe_channels(MaskFile& mask) {
    const auto channels = static_cast<std::ptrdiff_t>(mask.weights.channels);
    const std::vector<float>& weights = mask.weights.values;
    for (auto pixel = weights.begin(); pixel != weights.end(); pixel += channels) {
        const auto [min, max] = std::minmax_element(pixel, pixel + channels);
        if (*min < *max) mask.source = MaskSource::kColors;
        mask.max_weight = std::max(mask.max_weight, *min);
    }
}

/// The weight of code 1, the largest of masks of 0 and 1, as segmentation programs write them; 0
/// where it is white, or the file has no codes. Of a palette the codes are those of its colours.
float code_one_of(const ImageFile& read) {
    if (read.encoding == PixelEncoding::kFloat) return 0;
    const int bits = read.image.channels == 1 ? read.bits : std::max(read.bits, 8);
    return bits == 1 ? 0 : 1 / static_cast<float>((1 << bits) - 1);
}

}  // namespace

MaskFile read_mask(const std::filesystem::path& file, Turning turning) {
    ImageFile read = read_numbers_file(file);
    require_no_overscan(read, file.string());
    if (turning == Turning::kAsStored) read.orientation = 1;
    const float one_code = code_one_of(read);
    MaskFile mask = weights_of_file(std::move(read));
    const std::string named = fmt::format("the mask ({})", file.string());
    require_finite(mask.weights, named);
    constexpr float kMax = 1.001f;  // 1, as half a float may round it up
    float largest = 0;
    for (const float weight : mask.weights.values) {
        if (weight < 0 || weight > kMax)
            throw InputError(
                fmt::format("{} holds {}, expected weights from 0 to 1", named, weight));
        largest = std::max(largest, weight);
    }
    if (largest == 0) throw InputError(named + " is zero everywhere: no pixel would count");
    if (largest <= one_code)
        throw InputError(
            fmt::format("{} holds no code above 1, a weight of {:.2g}: expected weights from 0 to "
                        "1, whose code is {}",
                        named, one_code, std::lround(1 / one_code)));
    describe_channels(mask);
    return mask;
}

MaskFile read_mask(const CapturedView& view) {
    if (view.mask.empty()) return {};
    return at_place(view.places.mask, [&] { return read_mask(view.mask, view.turning); });
}

namespace {

/// Of the size of the view's camera, unless that is a sensor.
Photograph sized_photograph(const CapturedView& view, const std::string& what) {
    Photograph p = read_photograph(view.image, view.encoding, view.turning);
    if (const auto* camera = std::get_if<Camera>(&view.view.camera)) {
        require_size(p.image, camera->width, camera->height,
                     fmt::format("{} ({}{})", what, view.image, turning_text(p)),
                     view.size_of.empty()
                         ? "the size of its camera"
                         : "\"w\" and \"h\" in its frame, or the size of " + view.size_of);
    }
    return p;
}

}  // namespace

Photograph read_picture(const CapturedView& view, const Image& mask, double scale,
                        const std::string& what) {
    Photograph p = at_place(view.places.image, [&] { return sized_photograph(view, what); });
    if (mask.width > 0) {
        at_place(view.places.mask, [&] {
            require_size(mask, p.image.width, p.image.height, "the mask (" + view.mask + ")",
                         "the size of the picture" + turning_text(p));
        });
        add_mask(mask, p);
    }
    p = scaled(std::move(p), scale);
    const Image weights = weights_of(p);
    if (weights.width > 0 &&
        std::none_of(weights.values.begin(), weights.values.end(), [](float w) { return w > 0; }))
        at_place(view.places.image, [&] {
            throw InputError(fmt::format(
                "{} ({}): no pixel counts: each has a mask or an alpha of 0, or is clipped", what,
                view.image));
        });
    return p;
}

namespace {

double pixels_of(const Image& image) { return double{1} * image.width * image.height; }

/// While a file becomes an image: its bytes, the chunk that an EXR is read by, and of each pixel
/// the codes, and the numbers of the picture twice, while alpha is taken out of them or they are
/// turned, with planes beside them.
double decoding_bytes(const std::string& file, const ImageFile& header) {
    const double of_pixel = header.image.channels % 2 == 0 ? 44 : 32;
    std::error_code gone;
    const auto size = std::filesystem::file_size(file, gone);
    return (gone ? 0 : static_cast<double>(size)) + header.chunk_bytes +
           of_pixel * pixels_of(header.image);
}

}  // namespace

PictureBytes picture_bytes(const CapturedView& view, double scale) {
    constexpr double kScaling = 36;  // means of the picture, with and without weights, and of these
    constexpr double kKept = 28;     // the picture, its mask, what is clipped
    double reading = 0, weights = 0;
    ImageFile header;
    try {
        if (!view.mask.empty()) {
            header = read_image_header(view.mask);
            reading = decoding_bytes(view.mask, header);
            weights = (header.image.channels < 3 ? 4 : 12) * pixels_of(header.image);
        }
        if (!view.image.empty()) {
            header = read_image_header(view.image);
            reading = std::max(reading, weights + decoding_bytes(view.image, header));
        }
    } catch (const InputError&) {
        return {};
    }
    const double scaled = scale * scale * pixels_of(header.image);
    return {reading + (scale < 1 ? kScaling * scaled : 0), kKept * scaled};
}

}  // namespace burnish
