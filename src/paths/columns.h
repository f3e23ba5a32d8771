// A batch of samples as structures of arrays: one float per sample and field, so that every stage
// works on sixteen samples at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <variant>

#include "core/packet.h"
#include "core/vec.h"
#include "scene/material.h"

namespace burnish {

/// The most samples in one batch.
inline constexpr int kBatchSamples = 1024;
static_assert(kBatchSamples % kLanes == 0);

/// Room for a batch whose points are sorted by kind of BSDF, each kind padded to whole packets.
inline constexpr std::size_t kMaxLanes = kBatchSamples + kLanes * std::variant_size_v<Bsdf>;

struct alignas(64) Column {
    std::array<float, kMaxLanes> v;
    float& operator[](std::size_t i) { return v[i]; }
    const float& operator[](std::size_t i) const { return v[i]; }
};

inline Packet load(const Column& lane, std::size_t i) { return load(&lane[i]); }
inline void store(Column& lane, std::size_t i, const Packet& p) { store(&lane[i], p); }

struct ColumnVec3 {
    Column x, y, z;
};

inline Vec3<Packet> load(const ColumnVec3& v, std::size_t i) {
    return {load(&v.x[i]), load(&v.y[i]), load(&v.z[i])};
}
inline void store(ColumnVec3& to, std::size_t i, const Vec3<Packet>& v) {
    store(&to.x[i], v.x), store(&to.y[i], v.y), store(&to.z[i], v.z);
}
inline Vec3f get(const ColumnVec3& v, std::size_t i) { return {v.x[i], v.y[i], v.z[i]}; }
inline void set(ColumnVec3& to, std::size_t i, const Vec3f& v) {
    to.x[i] = v.x, to.y[i] = v.y, to.z[i] = v.z;
}

/// A list of lanes: those of a batch that go on to a stage.
struct ActiveList {
    std::array<std::uint16_t, kMaxLanes> lane;
    std::size_t count = 0;

    void add(std::size_t i) { lane[count++] = static_cast<std::uint16_t>(i); }
};

/// Sixteen indices from a list, starting at `first`: behind the end its last lane again, so that
/// packets never hold undefined lanes. `live` are real.
struct ColumnIndices {
    std::array<std::uint16_t, kLanes> at;
    int live;
};
inline ColumnIndices indices(const ActiveList& list, std::size_t first) {
    ColumnIndices r;
    for (std::size_t k = 0; k < kLanes; ++k)
        r.at[k] = list.lane[std::min(first + k, list.count - 1)];
    r.live = static_cast<int>(std::min<std::size_t>(kLanes, list.count - first));
    return r;
}

/// Sixteen lanes, by their indices.
inline Packet gather(const Column& lane, const std::uint16_t* at) { return gather(&lane[0], at); }
inline Vec3<Packet> gather(const ColumnVec3& v, const std::uint16_t* at) {
    return {gather(v.x, at), gather(v.y, at), gather(v.z, at)};
}
inline Packet gather(const Column& lane, const ColumnIndices& i) { return gather(lane, &i.at[0]); }
inline Vec3<Packet> gather(const ColumnVec3& v, const ColumnIndices& i) {
    return gather(v, &i.at[0]);
}
inline void scatter(Column& to, const ColumnIndices& i, const Packet& p) {
    float values[kLanes];
    store(values, p);
    for (int k = 0; k < i.live; ++k) to[i.at[static_cast<std::size_t>(k)]] = values[k];
}
inline void scatter(ColumnVec3& to, const ColumnIndices& i, const Vec3<Packet>& v) {
    scatter(to.x, i, v.x), scatter(to.y, i, v.y), scatter(to.z, i, v.z);
}

/// A count rounded up to whole packets.
inline std::size_t padded(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

}  // namespace burnish
