#include "paths/ray_columns.h"

#include <utility>

namespace burnish {

namespace {

constexpr int kBits = 3;  // per axis
constexpr std::size_t kCells = 1u << (3 * kBits);
using Keys = std::array<std::uint16_t, kMaxLanes>;

/// Morton index of the cell of a direction among 8 x 8 x 8 cells of the cube [-1, 1]^3.
LaneIntegers direction_keys(const Vec3<Packet>& direction) {
    const auto cell = [](const Packet& x) {
        const Packet scaled = (x + Packet(1.0f)) * Packet(0.5f * (1 << kBits));
        const Packet inside = min(scaled, Packet((1 << kBits) - 1.0f));
        // Written so that NaN gives a cell too.
        return to_integers(select(scaled > Packet(0.0f), inside, Packet(0.0f)));
    };
    const auto spread = [](const LaneIntegers& bits) {
        return (bits & 1) | (bits & 2) << 2 | (bits & 4) << 4;
    };
    return spread(cell(direction.x)) << 2 | spread(cell(direction.y)) << 1 |
           spread(cell(direction.z));
}

/// Of each entry of the list.
void find_keys(const ColumnVec3& direction, const ActiveList& list, Keys& keys) {
    for (std::size_t first = 0; first < list.count; first += kLanes) {
        std::array<std::uint32_t, kLanes> wide;
        store(wide.data(), direction_keys(gather(direction, indices(list, first))));
        for (std::size_t k = 0; k < kLanes; ++k)
            keys[first + k] = static_cast<std::uint16_t>(wide[k]);
    }
}

}  // namespace

void sort_by_direction(const ColumnVec3& direction, ActiveList& list) {
    if (list.count <= kPacketRays) return;
    Keys keys;
    find_keys(direction, list, keys);
    std::array<std::uint16_t, kCells> next{};
    for (std::size_t k = 0; k < list.count; ++k) ++next[keys[k]];
    std::uint16_t begin = 0;
    for (std::uint16_t& n : next)
        begin = static_cast<std::uint16_t>(begin + std::exchange(n, begin));
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
