#include "models/gltf_picture.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/variant.h"

namespace burnish {

namespace {

Raster raster_of(const Texture& texture) {
    return match(
        texture,
        [](const Bitmap& b) {
            return Raster{b.to_uv, b.width, b.height, b.filter, b.wrap};
        },
        [](const Checkerboard& board) { return Raster{.to_uv = board.to_uv}; });
}

/// Back from uv' to uv; the identity where there is no way back.
UvTransform inverse_of(const UvTransform& t) {
    const auto& [a, b, c, d, e, f] = t.m;
    const float determinant = a * e - b * d;
    if (determinant == 0) return {};
    const auto over = [&](float x) { return x / determinant; };
    return {{over(e), over(-b), over(b * f - c * e), over(-d), over(a), over(c * d - a * f)}};
}

}  // namespace

std::optional<Raster> raster_of(const TextureTable& table, TextureId id) {
    if (!id) return {};
    const Raster r = raster_of(table.textures[static_cast<std::size_t>(id.value)]);
    return r.width * r.height > 1 ? std::optional(r) : std::nullopt;
}

std::optional<Raster> joint_raster(const TextureTable& table, const std::vector<TextureId>& read) {
    std::optional<Raster> joint;
    for (const TextureId id : read) {
        const std::optional<Raster> r = raster_of(table, id);
        if (!r) continue;
        if (!joint) joint = r;
        joint->width = std::max(joint->width, r->width);
        joint->height = std::max(joint->height, r->height);
    }
    return joint;
}

CodedImage picture_of(const Raster& raster, bool srgb, const ColorAt& color) {
    const UvTransform back = inverse_of(raster.to_uv);
    const auto row_size = 3 * static_cast<std::size_t>(raster.width);
    CodedImage image{raster.width, raster.height, 3, srgb, {}};
    image.codes.resize(row_size * static_cast<std::size_t>(raster.height));
    parallel_for(static_cast<std::size_t>(raster.height), [&](std::size_t row) {
        std::uint8_t* code = image.codes.data() + row * row_size;
        for (int x = 0; x < raster.width; ++x) {
            const Vec2f center{
                (static_cast<float>(x) + 0.5f) / static_cast<float>(raster.width),
                (static_cast<float>(row) + 0.5f) / static_cast<float>(raster.height)};
            const Rgbf c = color(transform_uv(back, center));
            for (int k = 0; k < 3; ++k) *code++ = code_of(c[k], srgb);
        }
    });
    return image;
}

}  // namespace burnish
