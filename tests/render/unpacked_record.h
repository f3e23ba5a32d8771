// One lane of packed records as an ordinary record: what the packed forms are checked against.
#pragma once

#include "render/records.h"

namespace burnish::test {

inline PathRecord unpack_record(const RecordBlock& block, std::size_t lane, BsdfId bsdf,
                                const Tile& tile, int film_width) {
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

}  // namespace burnish::test
