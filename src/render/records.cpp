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

}  // namespace

std::uint32_t pack_direction(const Vec3f& d) {
    const float scale = 1 / (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z));
    const float x = d.x * scale, y = d.y * scale;
    return cell(x + y, 65536.0f) << 16 | cell(x - y, 32768.0f) << 1 | (d.z < 0 ? 1u : 0u);
}

TileRecords pack_records(std::span<const DirectSample> direct_samples, const Tile& tile,
                         int film_width) {
    TileRecords records;
    std::vector<BsdfId> bsdfs;  // in order of appearance: a tile sees few
    for (const DirectSample& d : direct_samples)
        if (d.has_unknowns && std::find(bsdfs.begin(), bsdfs.end(), d.record.bsdf) == bsdfs.end())
            bsdfs.push_back(d.record.bsdf);
    for (const BsdfId bsdf : bsdfs) {
        const auto begin = static_cast<std::uint32_t>(records.blocks.size());
        std::size_t lane = kLanes;
        for (const DirectSample& d : direct_samples) {
            if (!d.has_unknowns || d.record.bsdf != bsdf) continue;
            if (lane == kLanes) records.blocks.emplace_back(), lane = 0;
            RecordBlock& block = records.blocks.back();
            const PathRecord& r = d.record;
            block.pixel[lane] = pixel_in(tile, r.pixel, film_width);
            block.u[lane] = r.uv.x, block.v[lane] = r.uv.y;
            block.wi[lane] = pack_direction(r.wi_local);
            block.wo[lane] = pack_direction(r.wo_local);
            store(block.radiance_over_pdf, lane, r.radiance_over_pdf);
            ++lane, ++records.count;
        }
        records.runs.push_back({bsdf, begin, static_cast<std::uint32_t>(records.blocks.size())});
    }
    records.blocks.shrink_to_fit();
    return records;
}

TileRecords pack_chains(const ChainOutput& chains, std::span<const BatchSample> samples,
                        const Tile& tile, int film_width) {
    TileRecords records;
    records.count = static_cast<std::uint32_t>(chains.vertices.size());
    records.chains.resize(chains.vertices.size());
    std::vector<BsdfId> bsdfs;  // in order of appearance
    for (const ChainVertex& v : chains.vertices)
        if (std::find(bsdfs.begin(), bsdfs.end(), v.bsdf) == bsdfs.end()) bsdfs.push_back(v.bsdf);
    for (const BsdfId bsdf : bsdfs) {
        const auto begin = static_cast<std::uint32_t>(records.vertices.size());
        std::uint32_t lane = kLanes;
        for (std::size_t i = 0; i < chains.vertices.size(); ++i) {
            const ChainVertex& v = chains.vertices[i];
            if (v.bsdf != bsdf) continue;
            if (lane == kLanes) records.vertices.emplace_back(), lane = 0;
            const std::uint32_t pixel = samples[static_cast<std::size_t>(v.sample)].camera.pixel;
            records.vertices.back().pixel[lane] = pixel_in(tile, pixel, film_width);
            store(records.vertices.back(), lane, v);
            const auto block = static_cast<std::uint32_t>(records.vertices.size() - 1);
            records.chains[i] = {2 * (block * kLanes + lane)};
            ++lane;
        }
        records.runs.push_back({bsdf, begin, static_cast<std::uint32_t>(records.vertices.size())});
    }
    for (const Chain& chain : chains.chains) ++records.chains[chain.end - 1].word;
    records.vertices.shrink_to_fit();
    return records;
}

std::size_t bytes_of(const TileRecords& records) {
    return sizeof(TileRecords) + records.blocks.capacity() * sizeof(RecordBlock) +
           records.vertices.capacity() * sizeof(VertexBlock) +
           records.chains.capacity() * sizeof(ChainLink) +
           records.runs.capacity() * sizeof(RecordRun);
}

}  // namespace burnish
