#include "paths/ray_columns.h"

namespace burnish {

namespace {

constexpr int kBits = 3;  // per axis
constexpr std::size_t kCells = 1u << (3 * kBits);
using Keys = std::array<std::uint16_t, kMaxLanes>;

/// Morton index of the cell of a direction among 8 x 8 x 8 cells of the cube [-1, 1]^3.
void direction_keys(const ColumnVec3& direction, const ActiveList& list, Keys& keys) {
    constexpr std::array<std::uint16_t, 1 << kBits> kSpread{0, 1, 8, 9, 64, 65, 72, 73};
    const auto cell = [](float x) {
        const float scaled = (x + 1) * (0.5f * (1 << kBits));
        // Written so that NaN gives a cell too.
        return scaled > 0 ? static_cast<std::size_t>(std::min(scaled, (1 << kBits) - 1.0f)) : 0;
    };
    for (std::size_t k = 0; k < list.count; ++k) {
        const std::size_t i = list.lane[k];
        keys[k] = static_cast<std::uint16_t>(kSpread[cell(direction.x[i])] << 2 |
                                             kSpread[cell(direction.y[i])] << 1 |
                                             kSpread[cell(direction.z[i])]);
    }
}

}  // namespace

void sort_by_direction(const ColumnVec3& direction, ActiveList& list) {
    if (list.count <= kPacketRays) return;
    Keys keys;
    direction_keys(direction, list, keys);
    std::array<std::uint16_t, kCells + 1> next{};
    for (std::size_t k = 0; k < list.count; ++k) ++next[keys[k] + 1u];
    for (std::size_t c = 0; c < kCells; ++c)
        next[c + 1] = static_cast<std::uint16_t>(next[c + 1] + next[c]);
    ActiveList sorted;
    for (std::size_t k = 0; k < list.count; ++k) sorted.lane[next[keys[k]]++] = list.lane[k];
    std::copy_n(sorted.lane.begin(), list.count, list.lane.begin());
}

RayPacket make_packet(const Vec3<Packet>& origin, const Vec3<Packet>& direction,
                      const Packet& max_distance, int live) {
    RayPacket packet;
    for (int k = 0; k < kPacketRays; ++k)
        packet.valid[static_cast<std::size_t>(k)] = k < live ? -1 : 0;
    store(packet.origin_x.data(), origin.x);
    store(packet.origin_y.data(), origin.y);
    store(packet.origin_z.data(), origin.z);
    store(packet.direction_x.data(), direction.x);
    store(packet.direction_y.data(), direction.y);
    store(packet.direction_z.data(), direction.z);
    store(packet.max_distance.data(), max_distance);
    return packet;
}

RayPacket gather(const RayColumns& rays, const ColumnIndices& i) {
    return make_packet(gather(rays.origin, i), gather(rays.direction, i),
                       gather(rays.max_distance, i), i.live);
}

void keep_unoccluded(const Accel& accel, const RayColumns& rays, ActiveList& list) {
    ActiveList kept;
    for (std::size_t first = 0; first < list.count; first += kPacketRays) {
        const ColumnIndices i = indices(list, first);
        const auto blocked = accel.occluded(gather(rays, i), Coherence::kIncoherent);
        for (std::size_t k = 0; k < static_cast<std::size_t>(i.live); ++k)
            if (!blocked[k]) kept.add(i.at[k]);
    }
    list.count = kept.count;
    std::copy_n(kept.lane.begin(), kept.count, list.lane.begin());
}

}  // namespace burnish
