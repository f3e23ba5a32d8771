// Path records packed for streaming: what is kept of the samples of many iterations and shaded
// again in each. Sixteen records make a block, a structure of arrays of 30 bytes a record; blocks
// of one BSDF make a run. Where light bounces, the vertices of chains are packed in the same way,
// 58 bytes each and 4 for their place in the chain.
//
// A packed record is the record: whatever is evaluated, when traced or later, is evaluated from it,
// so that rounding changes the paths by a hair and never makes two evaluations of one path differ.
#pragma once

#include <span>
#include <vector>

#include "core/packet.h"
#include "paths/chains.h"
#include "render/pass_convolution.h"

namespace burnish {

/// Pixels on a side of a tile: records know their pixel within it.
inline constexpr int kRecordTile = 32;

/// A unit direction in 32 bits: the upper hemisphere as a square, 16 by 15 bits, and the sign of z.
/// z is never 0. Half a cell is 1.5e-5 of a and 3.1e-5 of b, so x and y below err by 2.3e-5 and z
/// by 3.1e-5 at most, and the direction by sqrt(3) times their length: 8e-5.
///
/// p = (x, y) / (|x| + |y| + |z|) lies in the diamond |p.x| + |p.y| <= 1, which a turn by 45
/// degrees makes the square of a = p.x + p.y and b = p.x - p.y. Its cells are named by number and
/// stand for their centre, which is never on the rim.
std::uint32_t pack_direction(const Vec3f& direction);

inline Vec3<Packet> unpack_directions(const std::array<std::uint32_t, kLanes>& packed) {
    const LaneIntegers words = load(packed.data());
    const auto centre = [](const LaneIntegers& cell, float cells) {
        return to_floats(cell) * Packet(2 / cells) + Packet(1 / cells - 1);
    };
    const Packet a = centre(words >> 16, 65536.0f), b = centre(words >> 1 & 0x7fffu, 32768.0f);
    const Packet x = Packet(0.5f) * (a + b), y = Packet(0.5f) * (a - b);
    const Packet z = Packet(1.0f) - abs(x) - abs(y);
    const Packet scale = Packet(1.0f) / sqrt(x * x + y * y + z * z);
    const Packet sign = to_floats(words & 1u);
    return {x * scale, y * scale, z * scale * (Packet(1.0f) - sign - sign)};
}

/// One number for each lane of a block. A colour is three in a row.
using LaneValues = std::array<float, kLanes>;

inline Rgb<Packet> load(const LaneValues* from) {
    return {load(from[0].data()), load(from[1].data()), load(from[2].data())};
}
inline void store(LaneValues* to, const Rgb<Packet>& v) {
    store(to[0].data(), v.x), store(to[1].data(), v.y), store(to[2].data(), v.z);
}

/// Sixteen records of one BSDF in one tile. Lanes behind the last record have no radiance.
struct RecordBlock {
    LaneValues u{}, v{};
    std::array<std::uint32_t, kLanes> wi{}, wo{};  ///< packed local directions
    std::array<LaneValues, 3> radiance_over_pdf{};
    std::array<std::uint16_t, kLanes> pixel{};  ///< y * tile width + x, within the tile

    friend bool operator==(const RecordBlock&, const RecordBlock&) = default;
};
static_assert(sizeof(RecordBlock) == 30 * kLanes);

/// Sixteen vertices of one BSDF in one tile: see ChainVertex. Lanes behind the last one are in no
/// chain.
struct VertexBlock {
    LaneValues u{}, v{};
    std::array<std::uint32_t, kLanes> wi{}, wo_light{}, wo_next{};  ///< packed local directions
    std::array<LaneValues, 3> emitted{}, gathered{}, onward{};      ///< E, D, C
    std::array<std::uint16_t, kLanes> pixel{};  ///< y * tile width + x, within the tile

    friend bool operator==(const VertexBlock&, const VertexBlock&) = default;
};
static_assert(sizeof(VertexBlock) == 58 * kLanes);

/// Where a vertex of a chain lies, and whether the chain ends with it.
struct ChainLink {
    std::uint32_t word = 0;  ///< twice the place, plus one at the end of a chain

    std::size_t block() const { return word / 2 / kLanes; }
    std::size_t lane() const { return word / 2 % kLanes; }
    bool is_last() const { return (word & 1u) != 0; }

    friend bool operator==(const ChainLink&, const ChainLink&) = default;
};

/// Consecutive blocks of one BSDF.
struct RecordRun {
    BsdfId bsdf;
    std::uint32_t begin = 0, end = 0;  ///< blocks

    friend bool operator==(const RecordRun&, const RecordRun&) = default;
};

/// The samples of one pass on surfaces with unknowns in one tile: records of direct light, or
/// chains.
struct TileRecords {
    std::vector<RecordBlock> blocks;
    std::vector<VertexBlock> vertices;
    std::vector<ChainLink> chains;  ///< of each vertex: chain by chain, from the camera on
    std::vector<RecordRun> runs;    ///< cover the blocks or the vertices, in order
    std::uint32_t count = 0;        ///< records or vertices, without padding

    friend bool operator==(const TileRecords&, const TileRecords&) = default;
};

inline std::span<const RecordBlock> blocks_of(const RecordRun& run, const TileRecords& records) {
    return std::span(records.blocks).subspan(run.begin, run.end - run.begin);
}
inline std::span<const VertexBlock> vertices_of(const RecordRun& run, const TileRecords& records) {
    return std::span(records.vertices).subspan(run.begin, run.end - run.begin);
}

/// Packs the samples on surfaces with unknowns, in the order of trace_batch. film_width: pixels of
/// the image that the tile is a part of.
TileRecords pack_records(std::span<const DirectSample> direct_samples, const Tile& tile,
                         int film_width);

/// Packs chains, which `samples` were traced for.
TileRecords pack_chains(const ChainOutput& chains, std::span<const BatchSample> samples,
                        const Tile& tile, int film_width);

/// What a tile's records take, without what lies beside them.
std::size_t bytes_of(const TileRecords& records);

/// Sixteen records, ready to be shaded.
struct RecordPacket {
    Vec2<Packet> uv;
    Vec3<Packet> wi_local, wo_local;
    Rgb<Packet> radiance_over_pdf;
};
inline RecordPacket unpack_records(const RecordBlock& block) {
    return {{load(block.u.data()), load(block.v.data())},
            unpack_directions(block.wi),
            unpack_directions(block.wo),
            load(block.radiance_over_pdf.data())};
}

}  // namespace burnish
