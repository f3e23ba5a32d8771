// Textures: bitmap, checkerboard, mesh_attribute.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "burnish/error.h"
#include "image/texels.h"
#include "mitsuba/attributes.h"
#include "mitsuba/colors.h"
#include "mitsuba/loader.h"

namespace burnish::mitsuba {

namespace {

UvTransform take_uv_transform(Properties& properties) {
    const Transform m = take_transform(properties, "to_uv").value_or(Transform{});
    const auto f = [&](int row, int column) { return static_cast<float>(m(row, column)); };
    return {
        {f(0, 0), f(0, 1), f(0, 3), f(1, 0), f(1, 1), f(1, 3)}};  // drops z, keeps the translation
}

void use_codes(Bitmap& bitmap, const Image& image) {
    bitmap.codes.resize(image.values.size());
    std::transform(image.values.begin(), image.values.end(), bitmap.codes.begin(),
                   [](float v) { return static_cast<std::uint8_t>(std::lround(v * 255.0f)); });
    for (std::size_t code = 0; code < 256; ++code) {
        const float v = static_cast<float>(code) / 255.0f;
        bitmap.decode[code] = bitmap.raw ? v : srgb_to_linear(v);
    }
}

void use_values(Loader& loader, const Node& node, Bitmap& bitmap, ImageFile file) {
    bitmap.values = std::move(file.image.values);
    if (file.encoding == PixelEncoding::kUnorm16 && !bitmap.raw)
        for (float& v : bitmap.values) v = srgb_to_linear(v);
    replace_non_finite(loader, node.place, bitmap.file, bitmap.values);
    loader.outside[&node] =
        outside_values(fmt::format("the texture \"{}\"", bitmap.file), bitmap.values);
}

Bitmap read_bitmap(Loader& loader, Properties& properties) {
    Bitmap bitmap;
    bitmap.file = take_file_name(properties);
    bitmap.filter = take_choice(properties, "filter_type", {"nearest", "bilinear"}, 1) == 0
                        ? TextureFilter::kNearest
                        : TextureFilter::kBilinear;
    constexpr TextureWrap kWraps[] = {TextureWrap::kRepeat, TextureWrap::kMirror,
                                      TextureWrap::kClamp};
    bitmap.wrap = kWraps[take_choice(properties, "wrap_mode", {"repeat", "mirror", "clamp"}, 0)];
    bitmap.raw = take_boolean(properties, "raw", false);
    bitmap.to_uv = take_uv_transform(properties);
    ignore(properties, {"format", "accel", "cache", "max_anisotropy"});  // how Mitsuba reads texels

    ImageFile file = load_image(loader, properties.node->place, bitmap.file);
    file.image = padded_to(std::move(file.image), kBitmapSide, kBitmapSide);
    bitmap.width = file.image.width;
    bitmap.height = file.image.height;
    bitmap.channels = file.image.channels;
    if (file.encoding == PixelEncoding::kUnorm8)
        use_codes(bitmap, file.image);
    else
        use_values(loader, *properties.node, bitmap, std::move(file));
    loader.kept += static_cast<double>(bitmap.codes.size() + bitmap.values.size() * sizeof(float));
    return bitmap;
}

Rgbf take_board_color(Properties& properties, const char* name, float fallback) {
    return take_color(properties, name, {fallback, fallback, fallback});
}

Texture read_texture(Loader& loader, Properties& properties) {
    if (properties.type == "bitmap") return read_bitmap(loader, properties);
    if (properties.type == "mesh_attribute") return read_mesh_attribute(loader, properties);
    if (properties.type == "checkerboard")
        return Checkerboard{take_board_color(properties, "color0", 0.4f),
                            take_board_color(properties, "color1", 0.2f),
                            take_uv_transform(properties)};
    fail_plugin(*properties.node, "d65 rawconstant srgb uniform volume",
                "\"bitmap\", \"checkerboard\" or \"mesh_attribute\"");
}

TextureId add_texture(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    Texture texture = read_texture(loader, properties);
    warn_unknown(properties, loader.result.warnings);
    auto& textures = loader.result.scene.textures;
    const TextureId id{static_cast<std::int32_t>(textures.size())};
    textures.push_back(std::move(texture));
    loader.textures.emplace(&node, id);
    return id;
}

/// Once for each texture.
void warn_outside(Loader& loader, const Node& node, TextureUse use) {
    const auto found = loader.outside.find(&node);
    if (found == loader.outside.end() || use == TextureUse::kAny) return;
    const OutsideValues& values = found->second;
    const auto count = use == TextureUse::kDiffTrans ? values.of_two : values.of_one;
    if (count == 0) return;
    log_warning(
        loader, node.place,
        fmt::format("{} has {} values outside [0, {}]", values.texture, count, max_of(use)));
    loader.outside.erase(found);
}

}  // namespace

TextureId load_texture(Loader& loader, const Node& node, TextureUse use) {
    const auto known = loader.textures.find(&node);
    const TextureId id = known != loader.textures.end() ? known->second : add_texture(loader, node);
    warn_outside(loader, node, use);
    return id;
}

OutsideValues outside_values(std::string texture, const std::vector<float>& values, float scale) {
    const auto outside = [&](TextureUse use) {
        return std::count_if(values.begin(), values.end(), [&](float v) {
            return !(v * scale >= 0 && v * scale <= max_of(use));
        });
    };
    return {std::move(texture), outside(TextureUse::kMaterial), outside(TextureUse::kDiffTrans)};
}

void tell_reading(const Loader& loader, const std::filesystem::path& file, double bytes) {
    if (!loader.options.before_reading) return;
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);  // reading it says why not
    loader.options.before_reading(file, bytes + (error ? 0 : static_cast<double>(size)),
                                  loader.kept);
}

ImageFile load_image(Loader& loader, const Place& place, const std::string& name) {
    const std::filesystem::path file = resolve_file(loader.document, place, name);
    try {
        if (loader.options.before_reading) {
            const ImageFile header = read_image_header(file);
            const Image& shape = header.image;
            tell_reading(loader, file,
                         double{sizeof(float)} * shape.channels * shape.width * shape.height +
                             header.chunk_bytes);
        }
        return read_image_file(file);
    } catch (const InputError& error) {
        fail(place, error.what());
    }
}

void replace_non_finite(Loader& loader, const Place& place, const std::string& name,
                        std::vector<float>& values) {
    const auto bad = [](float v) { return !std::isfinite(v); };
    const auto count = std::count_if(values.begin(), values.end(), bad);
    std::replace_if(values.begin(), values.end(), bad, 0.0f);
    if (count > 0)
        log_warning(
            loader, place,
            fmt::format("\"{}\" has {} values that are not finite: read as 0", name, count));
}

}  // namespace burnish::mitsuba
