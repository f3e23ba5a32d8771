// Texture look-ups: which texels a texture coordinate touches and with which weights, and the value
// there. uv' = to_uv uv is wrapped afterwards. Texel (x, y) has its centre at ((x + 1/2) / width,
// (y + 1/2) / height); row 0 is v = 0. Any uv is allowed: huge ones lose precision, non-finite ones
// read the texel at 0.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/material.h"

namespace burnish {

/// The texels of one look-up, each at most once; weights are positive and add up to 1.
struct TexelFootprint {
    int count = 0;
    std::array<std::uint32_t, 4> texel{};  ///< y * width + x
    std::array<float, 4> weight{};
};

/// What the shading reads. values[t], where there is one and it is not null, replaces the texels of
/// bitmap t by linear floats [height, width, channels]: a texture that is being optimised.
struct TextureTable {
    std::span<const Texture> textures;
    std::vector<const float*> values;  ///< empty, or one per texture
};

template <class T>
Vec2<T> transform_uv(const UvTransform& t, const Vec2<T>& uv) {
    const auto row = [&](std::size_t i) {
        return T(t.m[i]) * uv.x + T(t.m[i + 1]) * uv.y + T(t.m[i + 2]);
    };
    return {row(0), row(3)};
}

/// Into [0, period), or the period itself by rounding; 0 where x is not finite.
inline float wrap_period(float x, float period) {
    const float r = x - period * std::floor(x / period);
    return r >= 0 && r <= period ? r : 0.0f;
}

/// A coordinate in periods of the texture such that it fits an int after scaling by any size.
inline float reduce_coordinate(float u, TextureWrap wrap) {
    switch (wrap) {
        case TextureWrap::kRepeat:
            return u >= 0 && u < 1 ? u : wrap_period(u, 1.0f);
        case TextureWrap::kMirror:
            return u >= 0 && u < 1 ? u : wrap_period(u, 2.0f);
        case TextureWrap::kClamp:
            break;
    }
    return u >= 0 ? (u <= 1 ? u : 1.0f) : 0.0f;
}

/// A texel index in [-1, 2 size] back into [0, size).
inline int wrap_index(int i, int size, TextureWrap wrap) {
    if (i >= 0 && i < size) return i;
    switch (wrap) {
        case TextureWrap::kRepeat:
            return i < 0 ? i + size : i - size;
        case TextureWrap::kMirror: {
            const int j = i < 0 ? -1 - i : 2 * size - 1 - i;
            return j < 0 ? 0 : j;
        }
        case TextureWrap::kClamp:
            break;
    }
    return i < 0 ? 0 : size - 1;
}

/// The one or two texels of one axis.
struct AxisFootprint {
    int count;
    std::array<int, 2> index;
    std::array<float, 2> weight;
};

inline AxisFootprint axis_footprint(float u, int size, TextureFilter filter, TextureWrap wrap) {
    const float x = reduce_coordinate(u, wrap) * static_cast<float>(size);
    if (filter == TextureFilter::kNearest)
        return {1, {wrap_index(static_cast<int>(x), size, wrap), 0}, {1.0f, 0.0f}};
    const float low = std::floor(x - 0.5f), t = (x - 0.5f) - low;
    const int i0 = wrap_index(static_cast<int>(low), size, wrap);
    const int i1 = wrap_index(static_cast<int>(low) + 1, size, wrap);
    if (i0 == i1 || !(t > 0)) return {1, {i0, 0}, {1.0f, 0.0f}};
    return {2, {i0, i1}, {1.0f - t, t}};
}

/// The texels that `bitmap` reads at uv.
inline TexelFootprint footprint(const Bitmap& bitmap, const Vec2f& uv) {
    const Vec2f p = transform_uv(bitmap.to_uv, uv);
    const AxisFootprint x = axis_footprint(p.x, bitmap.width, bitmap.filter, bitmap.wrap);
    const AxisFootprint y = axis_footprint(p.y, bitmap.height, bitmap.filter, bitmap.wrap);
    TexelFootprint f;
    for (std::size_t j = 0; j < static_cast<std::size_t>(y.count); ++j) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(x.count); ++i) {
            const auto k = static_cast<std::size_t>(f.count++);
            f.texel[k] =
                static_cast<std::uint32_t>(y.index[j]) * static_cast<std::uint32_t>(bitmap.width) +
                static_cast<std::uint32_t>(x.index[i]);
            f.weight[k] = y.weight[j] * x.weight[i];
        }
    }
    return f;
}

/// One texel as linear RGB. values: null, or floats that replace the bitmap's own.
inline Rgbf texel_color(const Bitmap& bitmap, const float* values, std::uint32_t texel) {
    const auto channels = static_cast<std::size_t>(bitmap.channels);
    const std::size_t at = channels * texel;
    const auto read = [&](std::size_t i) {
        if (values) return values[i];
        return bitmap.codes.empty() ? bitmap.values[i] : bitmap.decode[bitmap.codes[i]];
    };
    if (channels == 1) return {read(at), read(at), read(at)};
    return {read(at), read(at + 1), read(at + 2)};
}

inline Rgbf eval_bitmap(const Bitmap& bitmap, const float* values, const Vec2f& uv) {
    const TexelFootprint f = footprint(bitmap, uv);
    Rgbf sum{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(f.count); ++k)
        sum += texel_color(bitmap, values, f.texel[k]) * f.weight[k];
    return sum;
}

inline Rgbf eval_checkerboard(const Checkerboard& board, const Vec2f& uv) {
    const Vec2f p = transform_uv(board.to_uv, uv);
    const bool right = p.x - std::floor(p.x) > 0.5f, upper = p.y - std::floor(p.y) > 0.5f;
    return right == upper ? board.color0 : board.color1;
}

/// Any texture at uv, as linear RGB; gray bitmaps give gray.
inline Rgbf eval_texture(const TextureTable& table, TextureId id, const Vec2f& uv) {
    const auto i = static_cast<std::size_t>(id.value);
    const Texture& texture = table.textures[i];
    if (const auto* board = std::get_if<Checkerboard>(&texture))
        return eval_checkerboard(*board, uv);
    return eval_bitmap(*std::get_if<Bitmap>(&texture),
                       table.values.empty() ? nullptr : table.values[i], uv);
}

/// True where reading the texture as a scalar takes the luminance of its colours.
inline bool is_colored(const Texture& texture) {
    const auto* bitmap = std::get_if<Bitmap>(&texture);
    return !bitmap || bitmap->channels == 3;
}

inline Rgbf eval_color(const TextureTable& table, const ColorInput& input, const Vec2f& uv) {
    return input.texture ? eval_texture(table, input.texture, uv) : input.constant;
}

/// An RGB texture is read as luminance.
inline float eval_scalar(const TextureTable& table, const ScalarInput& input, const Vec2f& uv) {
    if (!input.texture) return input.constant;
    const Rgbf color = eval_texture(table, input.texture, uv);
    const bool colored = is_colored(table.textures[static_cast<std::size_t>(input.texture.value)]);
    return colored ? luminance(color) : color.x;
}

}  // namespace burnish
