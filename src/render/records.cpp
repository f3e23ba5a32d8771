#include "render/records.h"

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

std::uint32_t cell(float x, float cells) {
    return static_cast<std::uint32_t>(std::clamp((x * 0.5f + 0.5f) * cells, 0.0f, cells - 1));
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
            const int x = static_cast<int>(r.pixel) % film_width - tile.x0;
            const int y = static_cast<int>(r.pixel) / film_width - tile.y0;
            block.pixel[lane] = static_cast<std::uint16_t>(y * tile.width + x);
            block.u[lane] = r.uv.x, block.v[lane] = r.uv.y;
            block.wi[lane] = pack_direction(r.wi_local);
            block.wo[lane] = pack_direction(r.wo_local);
            for (std::size_t c = 0; c < 3; ++c)
                block.radiance_over_pdf[c][lane] = r.radiance_over_pdf[static_cast<int>(c)];
            ++lane, ++records.count;
        }
        records.runs.push_back({bsdf, begin, static_cast<std::uint32_t>(records.blocks.size())});
    }
    records.blocks.shrink_to_fit();
    return records;
}

PathRecord unpack_record(const RecordBlock& block, std::size_t lane, BsdfId bsdf, const Tile& tile,
                         int film_width) {
    const RecordPacket all = unpack_records(block);
    const int i = static_cast<int>(lane), pixel = block.pixel[lane];
    const auto at = [i](const Vec3<Packet>& v) {
        return Vec3f{get(v.x, i), get(v.y, i), get(v.z, i)};
    };
    PathRecord record;
    record.pixel = static_cast<std::uint32_t>((tile.y0 + pixel / tile.width) * film_width +
                                              tile.x0 + pixel % tile.width);
    record.bsdf = bsdf;
    record.uv = {block.u[lane], block.v[lane]};
    record.wi_local = at(all.wi_local), record.wo_local = at(all.wo_local);
    record.radiance_over_pdf = at(all.radiance_over_pdf);
    return record;
}

}  // namespace burnish
