#include "render/shade_chains.h"

#include "core/finite_lanes.h"

namespace burnish {

namespace {

/// A vertex as a record of its light sample.
RecordBlock light_record(const VertexBlock& vertex) {
    return {vertex.u, vertex.v, vertex.wi, vertex.wo_light, vertex.emitted, vertex.pixel};
}

/// As a record of unit light from the next vertex.
RecordBlock next_record(const VertexBlock& vertex) {
    RecordBlock record{vertex.u, vertex.v, vertex.wi, vertex.wo_next, {}, vertex.pixel};
    for (LaneValues& channel : record.radiance_over_pdf) channel.fill(1);
    return record;
}

/// The lanes in which all of these are finite.
Mask finite_lanes(std::span<const LaneValues> values) {
    Mask finite(true);
    for (const LaneValues& v : values) finite = finite && finite_lanes(load(v.data()));
    return finite;
}

void clear_others(const Mask& kept, std::span<LaneValues> values) {
    for (LaneValues& v : values) store(v.data(), select(kept, load(v.data()), Packet(0.0f)));
}

/// f at all vertices in both directions, with derivatives; what is not finite becomes 0 and is
/// marked.
void shade_vertices(std::span<const RecordShader> shaders, const TileRecords& records,
                    RecordMemory& memory, ChainScratch& w) {
    const std::size_t blocks = records.vertices.size();
    w.light.resize(3 * blocks), w.next.resize(3 * blocks);
    w.next_derivatives.resize(memory.derivatives.size());
    w.is_finite.assign(blocks * kLanes, 1);
    const LaneValues* constant_inputs = memory.constant_inputs.data();
    std::size_t derivative = 0;
    for (const RecordRun& run : records.runs) {
        const RecordShader& shader = shaders[static_cast<std::size_t>(run.bsdf.value)];
        look_up_unknown(shader, vertices_of(run, records), w.unknown_inputs);
        const LaneValues* unknown_inputs = w.unknown_inputs.data();
        const std::size_t seeds = 3 * shader.derivatives();
        for (std::size_t b = run.begin; b < run.end; ++b) {
            const std::span<LaneValues> by_light(memory.derivatives.data() + derivative, seeds);
            const std::span<LaneValues> by_next(w.next_derivatives.data() + derivative, seeds);
            const std::span<LaneValues> light(&w.light[3 * b], 3), next(&w.next[3 * b], 3);
            const VertexBlock& vertex = records.vertices[b];
            store(light.data(), shade(shader, light_record(vertex), constant_inputs, unknown_inputs,
                                      by_light.data()));
            store(next.data(), shade(shader, next_record(vertex), constant_inputs, unknown_inputs,
                                     by_next.data()));
            const Mask finite = finite_lanes(light) && finite_lanes(next) &&
                                finite_lanes(by_light) && finite_lanes(by_next);
            if (!all(finite)) {
                for (const auto& values : {light, next, by_light, by_next})
                    clear_others(finite, values);
                for (int k = 0; k < kLanes; ++k)
                    w.is_finite[b * kLanes + static_cast<std::size_t>(k)] = get(finite, k);
            }
            constant_inputs += shader.constant_inputs.size();
            unknown_inputs += shader.unknown_values();
            derivative += seeds;
        }
    }
}

Rgbf get(const std::vector<LaneValues>& values, const ChainLink& at) {
    const LaneValues* v = &values[3 * at.block()];
    return {v[0][at.lane()], v[1][at.lane()], v[2][at.lane()]};
}
Rgbf get(const std::array<LaneValues, 3>& values, std::size_t lane) {
    return {values[0][lane], values[1][lane], values[2][lane]};
}
void set(std::vector<LaneValues>& values, const ChainLink& at, const Rgbf& to) {
    LaneValues* v = &values[3 * at.block()];
    v[0][at.lane()] = to.x, v[1][at.lane()] = to.y, v[2][at.lane()] = to.z;
}

/// R_1 of a chain, with what lies behind and before each of its vertices.
Rgbf sweep(const TileRecords& records, std::span<const ChainLink> chain, ChainScratch& w) {
    Rgbf rest;
    for (auto link = chain.rbegin(); link != chain.rend(); ++link) {
        const VertexBlock& vertex = records.vertices[link->block()];
        const Rgbf behind =
            get(vertex.gathered, link->lane()) + get(vertex.onward, link->lane()) * rest;
        set(w.behind, *link, behind);
        rest = get(w.light, *link) + get(w.next, *link) * behind;
    }
    Rgbf before{1, 1, 1};
    for (const ChainLink& link : chain) {
        set(w.before, link, before);
        before =
            before * get(w.next, link) * get(records.vertices[link.block()].onward, link.lane());
    }
    return rest;
}

bool is_finite_chain(std::span<const ChainLink> chain, const Rgbf& value, const ChainScratch& w) {
    if (!is_finite(value)) return false;
    for (const ChainLink& link : chain)
        if (!w.is_finite[link.block() * kLanes + link.lane()] || !is_finite(get(w.before, link)) ||
            !is_finite(get(w.behind, link)))
            return false;
    return true;
}

/// Values to pixels. Returns the number of chains that are not finite: they count for nothing.
std::size_t sweep_chains(const TileRecords& records, ChainScratch& w, std::vector<float>& pass) {
    w.before.assign(w.light.size(), {}), w.behind.assign(w.light.size(), {});
    std::size_t rejected = 0;
    for (std::size_t begin = 0, end = 0; begin < records.chains.size(); begin = end) {
        while (!records.chains[end++].is_last()) {
        }
        const auto chain = std::span(records.chains).subspan(begin, end - begin);
        const Rgbf value = sweep(records, chain, w);
        if (!is_finite_chain(chain, value, w)) {
            ++rejected;
            for (const ChainLink& link : chain) set(w.before, link, {}), set(w.behind, link, {});
            continue;
        }
        const VertexBlock& first = records.vertices[chain.front().block()];
        float* to = &pass[3 * std::size_t{first.pixel[chain.front().lane()]}];
        to[0] += value.x, to[1] += value.y, to[2] += value.z;
    }
    return rejected;
}

/// P_k (f'(wo_light) E_k + f'(wo_next) (D_k + C_k R_{k+1})). Returns the number of vertices that
/// were left out because a derivative is not finite.
std::size_t join_derivatives(std::span<const RecordShader> shaders, const TileRecords& records,
                             const ChainScratch& w, std::vector<LaneValues>& derivatives) {
    std::size_t rejected = 0;
    LaneValues* by_light = derivatives.data();
    const LaneValues* by_next = w.next_derivatives.data();
    for (const RecordRun& run : records.runs) {
        const std::size_t seeds = shaders[static_cast<std::size_t>(run.bsdf.value)].derivatives();
        for (std::size_t b = run.begin; b < run.end; ++b) {
            const Rgb<Packet> before = load(&w.before[3 * b]), behind = load(&w.behind[3 * b]);
            const std::span<LaneValues> joined(by_light, 3 * seeds);
            for (std::size_t k = 0; k < seeds; ++k, by_light += 3, by_next += 3)
                store(by_light, before * (load(by_light) + load(by_next) * behind));
            const Mask finite = finite_lanes(joined);
            if (all(finite)) continue;
            clear_others(finite, joined);
            for (int k = 0; k < kLanes; ++k) rejected += !get(finite, k);
        }
    }
    return rejected;
}

}  // namespace

std::size_t shade_chains(std::span<const RecordShader> shaders, const TileRecords& records,
                         RecordMemory& memory, ChainScratch& scratch, std::vector<float>& pass) {
    shade_vertices(shaders, records, memory, scratch);
    const std::size_t rejected = sweep_chains(records, scratch, pass);
    return rejected + join_derivatives(shaders, records, scratch, memory.derivatives);
}

}  // namespace burnish
