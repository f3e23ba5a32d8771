#include "render/records.h"

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

std::uint32_t cell(float x, float cells) {
    return static_cast<std::uint32_t>(std::clamp((x * 0.5f + 0.5f) * cells, 0.0f, cells - 1));
}

void store(std::array<LaneValues, 3>& to, std::size_t lane, const Rgbf& value) {
    for (std::size_t c = 0; c < 3; ++c) to[c][lane] = value[static_cast<int>(c)];
}

void store(VertexBlock& block, std::size_t lane, const ChainVertex& v) {
    block.u[lane] = v.uv.x, block.v[lane] = v.uv.y;
    block.wi[lane] = pack_direction(v.wi);
    block.wo_light[lane] = pack_direction(v.wo_light);
    block.wo_next[lane] = pack_direction(v.wo_next);
    store(block.emitted, lane, v.emitted);
    store(block.gathered, lane, v.gathered);
    store(block.onward, lane, v.onward);
}

/// Packs items in order, BSDF by BSDF, and says which blocks are whose. bsdf_of(i): none where the
/// item is left out. put(i, block, lane) fills a lane of the last block.
template <class Block>
void pack_runs(std::size_t count, const auto& bsdf_of, const auto& put, std::vector<Block>& blocks,
               std::vector<RecordRun>& runs) {
    std::vector<BsdfId> bsdfs;  // in order of appearance: a tile sees few
    for (std::size_t i = 0; i < count; ++i)
        if (bsdf_of(i) && std::find(bsdfs.begin(), bsdfs.end(), bsdf_of(i)) == bsdfs.end())
            bsdfs.push_back(bsdf_of(i));
    for (const BsdfId bsdf : bsdfs) {
        const auto begin = static_cast<std::uint32_t>(blocks.size());
        std::size_t lane = kLanes;
        for (std::size_t i = 0; i < count; ++i) {
            if (bsdf_of(i) != bsdf) continue;
            if (lane == kLanes) blocks.emplace_back(), lane = 0;
            put(i, blocks.back(), lane++);
        }
        runs.push_back({bsdf, begin, static_cast<std::uint32_t>(blocks.size())});
    }
    blocks.shrink_to_fit();
}

}  // namespace

std::uint32_t pack_direction(const Vec3f& d) {
    const float scale = 1 / (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z));
    const float x = d.x * scale, y = d.y * scale;
    return cell(x + y, 65536.0f) << 16 | cell(x - y, 32768.0f) << 1 | (d.z < 0 ? 1u : 0u);
}

TileRecords pack_records(std::span<const DirectSample> direct_samples, const Tile& tile,
                         int film_width) {
    TileRecords records;
    const auto bsdf_of = [&](std::size_t i) {
        const DirectSample& d = direct_samples[i];
        return d.has_unknowns ? d.record.bsdf : BsdfId{};
    };
    const auto put = [&](std::size_t i, RecordBlock& block, std::size_t lane) {
        const PathRecord& r = direct_samples[i].record;
        block.pixel[lane] = pixel_in(tile, r.pixel, film_width);
        block.u[lane] = r.uv.x, block.v[lane] = r.uv.y;
        block.wi[lane] = pack_direction(r.wi_local);
        block.wo[lane] = pack_direction(r.wo_local);
        store(block.radiance_over_pdf, lane, r.radiance_over_pdf);
        ++records.count;
    };
    pack_runs(direct_samples.size(), bsdf_of, put, records.blocks, records.runs);
    return records;
}

TileRecords pack_chains(const ChainOutput& chains, std::span<const BatchSample> samples,
                        const Tile& tile, int film_width) {
    TileRecords records;
    records.count = static_cast<std::uint32_t>(chains.vertices.size());
    records.chains.resize(chains.vertices.size());
    const auto bsdf_of = [&](std::size_t i) { return chains.vertices[i].bsdf; };
    const auto put = [&](std::size_t i, VertexBlock& block, std::size_t lane) {
        const ChainVertex& v = chains.vertices[i];
        const std::uint32_t pixel = samples[static_cast<std::size_t>(v.sample)].camera.pixel;
        block.pixel[lane] = pixel_in(tile, pixel, film_width);
        store(block, lane, v);
        const std::size_t place = (records.vertices.size() - 1) * kLanes + lane;
        records.chains[i] = {static_cast<std::uint32_t>(2 * place)};
    };
    pack_runs(chains.vertices.size(), bsdf_of, put, records.vertices, records.runs);
    for (const Chain& chain : chains.chains) ++records.chains[chain.end - 1].word;
    return records;
}

std::size_t bytes_of(const TileRecords& records) {
    return sizeof(TileRecords) + records.blocks.capacity() * sizeof(RecordBlock) +
           records.vertices.capacity() * sizeof(VertexBlock) +
           records.chains.capacity() * sizeof(ChainLink) +
           records.runs.capacity() * sizeof(RecordRun);
}

}  // namespace burnish
