// The look-ups of texture.h for sixteen texture coordinates at a time: lane by lane the same bits,
// wherever the texels are finite.
#pragma once

#include "core/packet.h"
#include "shading/texture.h"

namespace burnish {

/// footprint for sixteen coordinates: taps x taps texels, columns and rows apart.
struct FootprintPackets {
    std::size_t taps = 2;  ///< 1 (nearest) or 2 on each axis
    std::array<LaneIntegers, 2> x, y;
    std::array<Packet, 2> weight_x, weight_y;
};

inline FootprintPackets footprint_packets(const Bitmap& bitmap, const Vec2<Packet>& uv) {
    const Vec2<Packet> p = transform_uv(bitmap.to_uv, uv);
    const AxisTaps<Packet> x = axis_taps(p.x, bitmap.width, bitmap.filter, bitmap.wrap);
    const AxisTaps<Packet> y = axis_taps(p.y, bitmap.height, bitmap.filter, bitmap.wrap);
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
        for (int k = 0; k < kLanes; ++k) texels[k] = bitmap.decode[bitmap.codes[get(at, k)]];
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

}  // namespace burnish
