// The look-ups of texture.h for sixteen texture coordinates at a time: lane by lane the same bits,
// wherever the texels are finite.
#pragma once

#include "core/packet.h"
#include "shading/texture.h"

namespace burnish {

/// axis_footprint for sixteen coordinates: two texels always, the second with weight t.
struct AxisPackets {
    Packet index0, index1;  ///< whole numbers in [0, size)
    Packet t;
};

inline AxisPackets axis_packets(const Packet& u, int size, TextureFilter filter, TextureWrap wrap) {
    const Packet zero(0.0f), one(1.0f), n(static_cast<float>(size));
    const auto wrap_period = [&](const Packet& x, float period) {
        const Packet p(period), r = x - p * floor(x / p);
        return select(r >= zero && r <= p, r, zero);
    };
    const auto inside = u >= zero && u < one;
    Packet reduced;
    if (wrap == TextureWrap::kClamp)
        reduced = select(u >= zero, min(u, one), zero);
    else
        reduced = all(inside) ? u
                              : select(inside, u,
                                       wrap_period(u, wrap == TextureWrap::kMirror ? 2.0f : 1.0f));
    const auto wrap_index = [&](const Packet& i) {
        const auto below = i < zero, above = i >= n;
        switch (wrap) {
            case TextureWrap::kRepeat:
                return select(below, i + n, select(above, i - n, i));
            case TextureWrap::kMirror:
                return max(select(below, -one - i, select(above, n * Packet(2.0f) - one - i, i)),
                           zero);
            case TextureWrap::kClamp:
                break;
        }
        return select(below, zero, select(above, n - one, i));
    };
    const Packet x = reduced * n;
    if (filter == TextureFilter::kNearest) {
        const Packet i = wrap_index(floor(x));
        return {i, i, zero};
    }
    const Packet low = floor(x - Packet(0.5f)), t = (x - Packet(0.5f)) - low;
    const Packet i0 = wrap_index(low), i1 = wrap_index(low + one);
    return {i0, i1, select(i0 == i1, zero, t)};
}

/// footprint for sixteen coordinates: taps x taps texels, columns and rows apart.
struct FootprintPackets {
    std::size_t taps = 2;  ///< 1 (nearest) or 2 on each axis
    std::array<LaneIntegers, 2> x, y;
    std::array<Packet, 2> weight_x, weight_y;
};

inline FootprintPackets footprint_packets(const Bitmap& bitmap, const Vec2<Packet>& uv) {
    const Vec2<Packet> p = transform_uv(bitmap.to_uv, uv);
    const AxisPackets x = axis_packets(p.x, bitmap.width, bitmap.filter, bitmap.wrap);
    const AxisPackets y = axis_packets(p.y, bitmap.height, bitmap.filter, bitmap.wrap);
    const Packet one(1.0f);
    return {bitmap.filter == TextureFilter::kNearest ? std::size_t{1} : 2,
            {to_integers(x.index0), to_integers(x.index1)},
            {to_integers(y.index0), to_integers(y.index1)},
            {one - x.t, x.t},
            {one - y.t, y.t}};
}

/// The bitmap's values where a footprint lies. values: null, or floats that replace its own.
inline Rgb<Packet> eval_bitmap(const Bitmap& bitmap, const float* values,
                               const FootprintPackets& foot) {
    const auto channels = static_cast<std::uint32_t>(bitmap.channels);
    const auto width = static_cast<std::uint32_t>(bitmap.width);
    const float* floats = values ? values : bitmap.codes.empty() ? bitmap.values.data() : nullptr;
    const auto decoded = [&](const LaneIntegers& at) {
        float texels[kLanes];
        for (int k = 0; k < kLanes; ++k) texels[k] = bitmap.decode[bitmap.codes[at[k]]];
        return load(texels);
    };
    Rgb<Packet> sum{};
    for (std::size_t b = 0; b < foot.taps; ++b)
        for (std::size_t a = 0; a < foot.taps; ++a) {
            const Packet weight = foot.weight_y[b] * foot.weight_x[a];
            const LaneIntegers texel = (foot.y[b] * width + foot.x[a]) * channels;
            for (std::uint32_t c = 0; c < channels; ++c) {
                const Packet v = floats ? gather(floats + c, texel) : decoded(texel + c);
                sum[static_cast<int>(c)] = sum[static_cast<int>(c)] + v * weight;
            }
        }
    if (channels == 1) sum.y = sum.z = sum.x;
    return sum;
}

inline Rgb<Packet> eval_bitmap(const Bitmap& bitmap, const float* values, const Vec2<Packet>& uv) {
    return eval_bitmap(bitmap, values, footprint_packets(bitmap, uv));
}

inline Rgb<Packet> eval_texture(const TextureTable& table, TextureId id, const Vec2<Packet>& uv) {
    const auto i = static_cast<std::size_t>(id.value);
    const Texture& texture = table.textures[i];
    if (const auto* bitmap = std::get_if<Bitmap>(&texture))
        return eval_bitmap(*bitmap, table.values.empty() ? nullptr : table.values[i], uv);
    Rgb<Packet> result;
    for (int k = 0; k < kLanes; ++k) {
        const Rgbf c =
            eval_checkerboard(*std::get_if<Checkerboard>(&texture), {get(uv.x, k), get(uv.y, k)});
        set(result.x, k, c.x), set(result.y, k, c.y), set(result.z, k, c.z);
    }
    return result;
}

/// Colour and scalar inputs.
inline Rgb<Packet> eval_color(const TextureTable& table, const ColorInput& input,
                              const Vec2<Packet>& uv) {
    if (input.texture) return eval_texture(table, input.texture, uv);
    return {Packet(input.constant.x), Packet(input.constant.y), Packet(input.constant.z)};
}

inline Packet eval_scalar(const TextureTable& table, const ScalarInput& input,
                          const Vec2<Packet>& uv) {
    if (!input.texture) return Packet(input.constant);
    const Rgb<Packet> color = eval_texture(table, input.texture, uv);
    const bool colored = is_colored(table.textures[static_cast<std::size_t>(input.texture.value)]);
    return colored ? luminance(color) : color.x;
}

}  // namespace burnish
