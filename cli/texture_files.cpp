#include "cli/texture_files.h"

#include <fmt/format.h>

#include <set>
#include <utility>

#include "captures/pictures.h"
#include "image/texels.h"
#include "image/whole.h"
#include "optimize/option_value.h"
#include "optimize/views.h"

namespace burnish {

Image read_texels(const Bitmap& bitmap, const std::string& text, const std::string& what) {
    if (const auto number = parse_number(text))
        return make_image(bitmap.width, bitmap.height, bitmap.channels,
                          static_cast<float>(*number));
    ImageFile file = read_image_file(text);
    const auto min_side = [](int side) { return side == kBitmapSide ? kBitmapSide : 1; };
    file.image = padded_to(std::move(file.image), min_side(bitmap.width), min_side(bitmap.height));
    const std::string named = fmt::format("{} ({})", what, text);
    require_size(file.image, bitmap.width, bitmap.height, named, "the size of the texture");
    require_finite(file.image, named);
    if (file.encoding != PixelEncoding::kFloat && !bitmap.raw)
        for (float& v : file.image.values) v = srgb_to_linear(v);
    return with_channels(std::move(file.image), bitmap.channels);
}

Image read_radiance(const std::filesystem::path& file, int width, int height,
                    const std::string& what) {
    Image image = read_image(file);
    const std::string named = fmt::format("{} ({})", what, file.string());
    require_size(image, width, height, named, "the size of the film");
    require_finite(image, named);
    return image;
}

std::string file_name_of(const std::string& given) {
    std::string name = given;
    for (char& c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
        if (!plain) c = '_';
    }
    if (name.empty() || name.front() == '.') name.insert(name.begin(), '_');
    constexpr std::size_t kMax = 200;  // of the 255 bytes of a file system: endings follow
    return name.substr(0, kMax);
}

std::vector<std::string> unique_names(std::vector<std::string> names) {
    std::set<std::string> taken;
    for (std::string& name : names) {
        const std::string plain = name;
        for (int n = 2; !taken.insert(name).second; ++n) name = fmt::format("{}_{}", plain, n);
    }
    return names;
}

std::vector<std::string> folder_names(const std::vector<View>& views) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < views.size(); ++i)
        names.push_back(file_name_of(name_of(views[i], i)));
    return unique_names(std::move(names));
}

}  // namespace burnish
