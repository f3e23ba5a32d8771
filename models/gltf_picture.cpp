#include "models/gltf_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

float determinant_of(const UvTransform& t) { return t.m[0] * t.m[4] - t.m[1] * t.m[3]; }

/// Of a transform onto a line or a point: the pseudoinverse, which for rank 1 is the transpose over
/// the sum of squares. From elsewhere it goes by the nearest point of the line.
UvTransform pseudoinverse_of(const UvTransform& t) {
    const auto& [a, b, c, d, e, f] = t.m;
    const float squares = a * a + b * b + d * d + e * e;
    const auto over = [&](float x) { return squares > 0 ? x / squares : 0; };
    return {{over(a), over(d), over(-a * c - d * f), over(b), over(e), over(-b * c - e * f)}};
}

/// Back from uv' to uv: to one of those that go there.
UvTransform inverse_of(const UvTransform& t) {
    const auto& [a, b, c, d, e, f] = t.m;
    const float determinant = determinant_of(t);
    if (determinant == 0) return pseudoinverse_of(t);
    const auto over = [&](float x) { return x / determinant; };
    return {{over(e), over(-b), over(b * f - c * e), over(-d), over(a), over(c * d - a * f)}};
}

/// How often a raster lies within the unit square of uv. Those that show a line of themselves are
/// no place for others.
float repetitions_of(const Raster& raster) {
    const float determinant = std::abs(determinant_of(raster.to_uv));
    return determinant > 0 ? determinant : std::numeric_limits<float>::infinity();
}

/// Texels for a side (0: width) of the unit square that `back` takes to uv: as fine as the raster.
int texels_under(const Raster& raster, const UvTransform& back, std::size_t side) {
    constexpr float kMax = 4096, kRounding = 1e-5f;
    const auto& m = raster.to_uv.m;
    const float du = back.m[side], dv = back.m[3 + side];
    const float texels = std::hypot((m[0] * du + m[1] * dv) * static_cast<float>(raster.width),
                                    (m[3] * du + m[4] * dv) * static_cast<float>(raster.height));
    return static_cast<int>(std::ceil(std::min(kMax, texels * (1 - kRounding))));
}

/// Calls visit(linear RGB) for each texel of a row.
template <class Visit>
void for_texels(const Raster& raster, std::size_t row, const ColorAt& color, const Visit& visit) {
    const UvTransform back = inverse_of(raster.to_uv);
    const float v = (static_cast<float>(row) + 0.5f) / static_cast<float>(raster.height);
    for (int x = 0; x < raster.width; ++x) {
        const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(raster.width);
        visit(color(transform_uv(back, Vec2f{u, v})));
    }
}

}  // namespace

std::optional<Raster> raster_of(const TextureTable& table, TextureId id) {
    if (!id) return {};
    const Raster r = raster_of(table.textures[static_cast<std::size_t>(id.value)]);
    return r.width * r.height > 1 ? std::optional(r) : std::nullopt;
}

std::optional<Raster> joint_raster(const TextureTable& table, const std::vector<TextureId>& read) {
    std::vector<Raster> rasters;
    for (const TextureId id : read)
        if (const std::optional<Raster> r = raster_of(table, id)) rasters.push_back(*r);
    if (rasters.empty()) return {};
    Raster joint = *std::min_element(
        rasters.begin(), rasters.end(),
        [](const Raster& a, const Raster& b) { return repetitions_of(a) < repetitions_of(b); });
    const UvTransform back = inverse_of(joint.to_uv);
    for (const Raster& r : rasters) {
        joint.width = std::max({joint.width, r.width, texels_under(r, back, 0)});
        joint.height = std::max({joint.height, r.height, texels_under(r, back, 1)});
    }
    return joint;
}

float largest_of(const Raster& raster, const ColorAt& color) {
    std::vector<float> of_rows(static_cast<std::size_t>(raster.height));
    parallel_for(of_rows.size(), [&](std::size_t row) {
        float largest = -std::numeric_limits<float>::infinity();
        for_texels(raster, row, color, [&](const Rgbf& c) {
            largest = std::max({largest, c.x, c.y, c.z});
        });
        of_rows[row] = largest;
    });
    return *std::max_element(of_rows.begin(), of_rows.end());
}

CodedImage picture_of(const Raster& raster, bool srgb, const ColorAt& color) {
    const auto row_size = 3 * static_cast<std::size_t>(raster.width);
    CodedImage image{raster.width, raster.height, 3, srgb, {}};
    image.codes.resize(row_size * static_cast<std::size_t>(raster.height));
    parallel_for(static_cast<std::size_t>(raster.height), [&](std::size_t row) {
        std::uint8_t* code = image.codes.data() + row * row_size;
        for_texels(raster, row, color, [&](const Rgbf& c) {
            for (int k = 0; k < 3; ++k) *code++ = code_of(c[k], srgb);
        });
    });
    return image;
}

}  // namespace burnish
