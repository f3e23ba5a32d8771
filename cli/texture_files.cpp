#include "cli/texture_files.h"

#include <fmt/format.h>

#include <cmath>

#include "burnish/error.h"
#include "optimize/option_value.h"

namespace burnish {

namespace {

void require_finite(const Image& image, const std::string& what) {
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        if (std::isfinite(image.values[i])) continue;
        const auto pixel = i / static_cast<std::size_t>(image.channels);
        throw InputError(fmt::format("{}: the value at pixel ({}, {}) is {}, expected a finite one",
                                     what, pixel % static_cast<std::size_t>(image.width),
                                     pixel / static_cast<std::size_t>(image.width),
                                     image.values[i]));
    }
}

}  // namespace

void require_size(const Image& image, int width, int height, const std::string& what,
                  const std::string& expected) {
    if (image.width != width || image.height != height)
        throw InputError(fmt::format("{} is {} x {} pixels, expected {}, {} x {}", what,
                                     image.width, image.height, expected, width, height));
}

Image read_texels(const Bitmap& bitmap, const std::string& text, const std::string& what) {
    if (const auto number = parse_number(text))
        return make_image(bitmap.width, bitmap.height, bitmap.channels,
                          static_cast<float>(*number));
    ImageFile file = read_image_file(text);
    const std::string named = fmt::format("{} ({})", what, text);
    require_size(file.image, bitmap.width, bitmap.height, named, "the size of the texture");
    require_finite(file.image, named);
    if (file.encoding != PixelEncoding::kFloat && !bitmap.raw)
        for (float& v : file.image.values) v = srgb_to_linear(v);
    return with_channels(file.image, bitmap.channels);
}

Image read_radiance(const std::filesystem::path& file, int width, int height,
                    const std::string& what) {
    Image image = read_image(file);
    const std::string named = fmt::format("{} ({})", what, file.string());
    require_size(image, width, height, named, "the size of the film");
    require_finite(image, named);
    return image;
}

Image as_rgb(const Image& image) { return with_channels(image, 3); }

Image read_mask(const std::filesystem::path& file, Turning turning) {
    ImageFile read = read_image_file(file);
    if (turning == Turning::kAsStored) read.orientation = 1;
    Image mask = oriented(std::move(read.image), read.orientation);
    const std::string named = fmt::format("the mask ({})", file.string());
    require_finite(mask, named);
    bool any = false;
    for (const float weight : mask.values) {
        if (weight < 0)
            throw InputError(
                fmt::format("{} holds {}, expected weights that are not negative", named, weight));
        any = any || weight > 0;
    }
    if (!any) throw InputError(named + " is zero everywhere: no pixel would count");
    return mask;
}

std::string file_name_of(const std::string& parameter) {
    std::string name = parameter;
    for (char& c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
        if (!plain) c = '_';
    }
    if (name.empty() || name.front() == '.') name.insert(name.begin(), '_');
    return name;
}

void write_texels(const std::filesystem::path& folder, const std::string& name,
                  const Bitmap& bitmap, const Image& texels) {
    write_image(folder / (name + ".exr"), texels);
    write_image(folder / (name + ".png"), texels, !bitmap.raw);
}

}  // namespace burnish
