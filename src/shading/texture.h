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

#include "core/scalar.h"
#include "core/variant.h"
#include "scene/material.h"

namespace burnish {

/// The texels of one look-up, each at most once; weights are not negative and add up to 1.
struct TexelFootprint {
    int count = 0;
    std::array<std::uint32_t, 4> texel{};  ///< y * width + x
    std::array<float, 4> weight{};
};

/// The texel that a look-up reads most of.
inline std::uint32_t main_texel(const TexelFootprint& f) {
    std::size_t largest = 0;
    for (std::size_t k = 1; k < static_cast<std::size_t>(f.count); ++k)
        if (f.weight[k] > f.weight[largest]) largest = k;
    return f.texel[largest];
}

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

/// The texture coordinate of a texel's centre: what transform_uv takes there.
inline Vec2f uv_of_texel(const Bitmap& bitmap, int x, int y) {
    const auto& m = bitmap.to_uv.m;
    const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(bitmap.width) - m[2];
    const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(bitmap.height) - m[5];
    const float det = m[0] * m[4] - m[1] * m[3];
    return {(m[4] * u - m[1] * v) / det, (m[0] * v - m[3] * u) / det};
}

/// x modulo the period: in [0, period), or the period itself by rounding; 0 where x is not finite.
template <class T>
T wrap_period(const T& x, float period) {
    const T p(period), r = x - p * floor(x / p);
    return select(r >= T(0.0f) && r <= p, r, T(0.0f));
}

/// A coordinate in [0, 1], or in [0, 2] where the texture is mirrored: small enough to become an
/// index after scaling.
template <class T>
T reduce_coordinate(const T& u, TextureWrap wrap) {
    const T zero(0.0f), one(1.0f);
    const auto inside = u >= zero && u < one;
    if (all(inside)) return u;
    switch (wrap) {
        case TextureWrap::kRepeat:
            return select(inside, u, wrap_period(u, 1.0f));
        case TextureWrap::kMirror:
            return select(inside, u, wrap_period(u, 2.0f));
        case TextureWrap::kClamp:
            break;
    }
    return select(u >= zero, min(u, one), zero);
}

/// A texel index in [-1, 2 n], a whole number, back into [0, n).
template <class T>
T wrap_index(const T& i, const T& n, TextureWrap wrap) {
    const T zero(0.0f), one(1.0f);
    const auto below = i < zero, above = i >= n;
    switch (wrap) {
        case TextureWrap::kRepeat:
            return select(below, i + n, select(above, i - n, i));
        case TextureWrap::kMirror:
            return max(select(below, -one - i, select(above, n * T(2.0f) - one - i, i)), zero);
        case TextureWrap::kClamp:
            break;
    }
    return select(below, zero, select(above, n - one, i));
}

/// The two texels of one axis, the second with weight t. T: float or Packet.
template <class T>
struct AxisTaps {
    T index0, index1;  ///< whole numbers in [0, size)
    T t;               ///< 0 where both are one texel, or the filter reads one
};

template <class T>
AxisTaps<T> axis_taps(const T& u, int size, TextureFilter filter, TextureWrap wrap) {
    const T n(static_cast<float>(size)), one(1.0f), half(0.5f);
    const T x = reduce_coordinate(u, wrap) * n;
    if (filter == TextureFilter::kNearest) {
        const T i = wrap_index(T(floor(x)), n, wrap);
        return {i, i, T(0.0f)};
    }
    const T low = floor(x - half), t = (x - half) - low;
    const T i0 = wrap_index(low, n, wrap), i1 = wrap_index(T(low + one), n, wrap);
    return {i0, i1, select(i0 == i1, T(0.0f), t)};
}

/// The texels that `bitmap` reads at uv.
inline TexelFootprint footprint(const Bitmap& bitmap, const Vec2f& uv) {
    const Vec2f p = transform_uv(bitmap.to_uv, uv);
    const AxisTaps<float> x = axis_taps(p.x, bitmap.width, bitmap.filter, bitmap.wrap);
    const AxisTaps<float> y = axis_taps(p.y, bitmap.height, bitmap.filter, bitmap.wrap);
    TexelFootprint f;
    const auto add = [&](float row, float column, float weight) {
        const auto k = static_cast<std::size_t>(f.count++);
        f.texel[k] = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(bitmap.width) +
                     static_cast<std::uint32_t>(column);
        f.weight[k] = weight;
    };
    const auto add_row = [&](float row, float weight) {
        add(row, x.index0, weight * (1.0f - x.t));
        if (x.t > 0) add(row, x.index1, weight * x.t);
    };
    add_row(y.index0, 1.0f - y.t);
    if (y.t > 0) add_row(y.index1, y.t);
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

template <class T>
Rgb<T> eval_checkerboard(const Checkerboard& board, const Vec2<T>& uv) {
    const Vec2<T> p = transform_uv(board.to_uv, uv);
    const T half(0.5f);
    const auto right = p.x - floor(p.x) > half, upper = p.y - floor(p.y) > half;
    const auto same = (right && upper) || (!right && !upper);
    const auto pick = [&](float a, float b) { return select(same, T(a), T(b)); };
    const Rgbf &a = board.color0, &b = board.color1;
    return {pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)};
}

/// Any texture at uv, as linear RGB; gray bitmaps give gray. T: float, or Packet with
/// texture_packet.h.
template <class T>
Rgb<T> eval_texture(const TextureTable& table, TextureId id, const Vec2<T>& uv) {
    const auto i = static_cast<std::size_t>(id.value);
    return match(
        table.textures[i],
        [&](const Bitmap& bitmap) {
            return eval_bitmap(bitmap, table.values.empty() ? nullptr : table.values[i], uv);
        },
        [&](const Checkerboard& board) { return eval_checkerboard(board, uv); });
}

/// False where the texture is gray whatever it holds.
inline bool is_colored(const Texture& texture) {
    return match(
        texture, [](const Bitmap& bitmap) { return bitmap.channels == 3; },
        [](const Checkerboard&) { return true; });
}

template <class T>
Rgb<T> eval_color(const TextureTable& table, const ColorInput& input, const Vec2<T>& uv) {
    if (input.texture) return eval_texture(table, input.texture, uv);
    return {T(input.constant.x), T(input.constant.y), T(input.constant.z)};
}

/// The colours of a bitmap are read as luminance, those of a checkerboard as their mean; as in
/// Mitsuba, numbers find color1 where colours find color0.
template <class T>
T eval_scalar(const TextureTable& table, const ScalarInput& input, const Vec2<T>& uv) {
    if (!input.texture) return T(input.constant);
    return match(
        table.textures[static_cast<std::size_t>(input.texture.value)],
        [&](const Bitmap& bitmap) {
            const Rgb<T> color = eval_texture(table, input.texture, uv);
            return bitmap.channels == 3 ? luminance(color) : color.x;
        },
        [&](const Checkerboard& board) {
            return mean(
                eval_checkerboard(Checkerboard{board.color1, board.color0, board.to_uv}, uv));
        });
}

/// The gradient by uv of what eval_scalar reads of a bitmap: within a cell of its bilinear filter,
/// and zero of others.
inline Vec2f scalar_gradient(const TextureTable& table, TextureId id, const Vec2f& uv) {
    const auto i = static_cast<std::size_t>(id.value);
    const Bitmap* bitmap = bitmap_of(table.textures[i]);
    if (!bitmap || bitmap->filter == TextureFilter::kNearest) return {0, 0};
    const Vec2f p = transform_uv(bitmap->to_uv, uv);
    const AxisTaps<float> x = axis_taps(p.x, bitmap->width, bitmap->filter, bitmap->wrap);
    const AxisTaps<float> y = axis_taps(p.y, bitmap->height, bitmap->filter, bitmap->wrap);
    const auto read = [&](float row, float column) {
        const Rgbf color = texel_color(
            *bitmap, table.values.empty() ? nullptr : table.values[i],
            static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(bitmap->width) +
                static_cast<std::uint32_t>(column));
        return bitmap->channels == 3 ? luminance(color) : color.x;
    };
    const float v00 = read(y.index0, x.index0), v10 = read(y.index0, x.index1);
    const float v01 = read(y.index1, x.index0), v11 = read(y.index1, x.index1);
    const float dx =
        static_cast<float>(bitmap->width) * ((v10 - v00) * (1 - y.t) + (v11 - v01) * y.t);
    const float dy =
        static_cast<float>(bitmap->height) * ((v01 - v00) * (1 - x.t) + (v11 - v10) * x.t);
    const auto& m = bitmap->to_uv.m;
    return {m[0] * dx + m[3] * dy, m[1] * dx + m[4] * dy};
}

/// The transposes of eval_color and eval_scalar: the derivative by the channels of a texel, from
/// that by the colour (by its channels) or by the scalar which reads it. channels: the texture's.
template <class T>
Rgb<T> color_to_texel(int channels, const Rgb<T>& g) {
    if (channels == 1) return {g.x + g.y + g.z, T(0.0f), T(0.0f)};
    return g;
}
template <class T>
Rgb<T> scalar_to_texel(int channels, const T& g) {
    if (channels == 1) return {g, T(0.0f), T(0.0f)};
    return luminance_derivative(g);
}

// Compiled with the library alone: whoever uses them may be compiled with less optimisation.
extern template AxisTaps<float> axis_taps(const float&, int, TextureFilter, TextureWrap);
extern template Rgbf eval_texture(const TextureTable&, TextureId, const Vec2f&);

}  // namespace burnish
