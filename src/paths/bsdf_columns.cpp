#include "paths/bsdf_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shading/texture_packet.h"

namespace burnish {

namespace {

/// Calls body(bsdf, run) for each run of points of one BSDF.
template <class Body>
void for_runs(const BsdfPoints& points, const IndexRange& range, const Body& body) {
    for (std::size_t begin = range.begin; begin < range.end;) {
        const BsdfId id = points.bsdfs[begin];
        std::size_t end = begin + 1;
        while (end < range.end && points.bsdfs[end] == id) ++end;
        body(id, IndexRange{begin, end});
        begin = end;
    }
}

Vec2<Packet> uv_at(const BsdfPoints& points, std::size_t i) {
    return {load(*points.u, i), load(*points.v, i)};
}

/// Where the packet of a lane begins.
std::size_t packet_of(std::size_t lane) { return lane / kLanes * kLanes; }

/// Stores the lanes of p, at lane i of the batch, that belong to the run.
void store_run(Column& to, const IndexRange& run, std::size_t i, const Packet& p) {
    if (run.begin <= i && i + kLanes <= run.end) {
        store(to, i, p);
        return;
    }
    for (std::size_t k = std::max(run.begin, i); k < std::min(run.end, i + kLanes); ++k)
        to[k] = get(p, static_cast<int>(k - i));
}

void fill(Column& to, const IndexRange& run, float constant) {
    std::fill_n(&to[run.begin], run.size(), constant);
}

/// The value in place of a texture's texels, NaN: there is none.
float constant_of(const BsdfPoints& points, TextureId texture) {
    if (!texture || points.constants.empty()) return std::numeric_limits<float>::quiet_NaN();
    return points.constants[static_cast<std::size_t>(texture.value)];
}

void look_up(const BsdfPoints& points, const ColorInput& input, const IndexRange& run,
             const std::array<Column*, 3>& to) {
    if (const float constant = constant_of(points, input.texture); !std::isnan(constant)) {
        for (Column* channel : to) fill(*channel, run, constant);
        return;
    }
    for (std::size_t i = packet_of(run.begin); i < run.end; i += kLanes) {
        const Rgb<Packet> c = eval_color(*points.textures, input, uv_at(points, i));
        store_run(*to[0], run, i, c.x), store_run(*to[1], run, i, c.y);
        store_run(*to[2], run, i, c.z);
    }
}
void look_up(const BsdfPoints& points, const ColorInput& input, const IndexRange& run,
             ColumnVec3& to) {
    look_up(points, input, run, {&to.x, &to.y, &to.z});
}

void look_up(const BsdfPoints& points, const ScalarInput& input, const IndexRange& run,
             Column& to) {
    if (!input.texture) {
        fill(to, run, input.constant);
        return;
    }
    if (const float constant = constant_of(points, input.texture); !std::isnan(constant)) {
        fill(to, run, constant);
        return;
    }
    for (std::size_t i = packet_of(run.begin); i < run.end; i += kLanes)
        store_run(to, run, i, eval_scalar(*points.textures, input, uv_at(points, i)));
}

/// Nothing for kinds whose columns have names.
BsdfConstants<float> constants_of(const Bsdf& bsdf) {
    return std::visit(
        [](const auto& b) {
            if constexpr (requires { bsdf_constants(b); })
                return bsdf_constants(b);
            else
                return BsdfConstants<float>{};
        },
        bsdf);
}

}  // namespace

void look_up_rows(const BsdfPoints& points, const IndexRange& range, BsdfColumns& lanes) {
    for_runs(points, range, [&](BsdfId id, const IndexRange& run) {
        const Bsdf& bsdf = (*points.scene)[id];
        std::size_t place = 0;
        for (const ColorInput& color : colors_of(bsdf)) {
            look_up(points, color, run,
                    {&lanes.inputs[place], &lanes.inputs[place + 1], &lanes.inputs[place + 2]});
            place += 3;
        }
        for (const ScalarInput& scalar : scalars_of(bsdf))
            look_up(points, scalar, run, lanes.inputs[place++]);
        for (; place < kBsdfRowInputs; ++place) fill(lanes.inputs[place], run, 0);
        const BsdfConstants<float> constants = constants_of(bsdf);
        for (std::size_t k = 0; k < kBsdfConstants; ++k)
            fill(lanes.constants[k], run, constants.v[k]);
        std::fill_n(&lanes.tables[run.begin], run.size(), constants.table.of_lane[0]);
    });
}

BsdfPackets<Diffuse>::BsdfPackets(const BsdfPoints& points, const IndexRange& range,
                                  BsdfColumns& lanes)
    : lanes_(&lanes) {
    for_runs(points, range, [&](BsdfId id, const IndexRange& run) {
        look_up(points, std::get<Diffuse>((*points.scene)[id]).reflectance, run, lanes.color);
    });
}

BsdfPackets<Principled>::BsdfPackets(const BsdfPoints& points, const IndexRange& range,
                                     BsdfColumns& lanes)
    : lanes_(&lanes) {
    auto& p = lobes_;
    p.has_spec_trans = p.has_clearcoat = p.has_sheen = p.has_flatness = p.has_spec_tint =
        p.has_anisotropic = false;
    for_runs(points, range, [&](BsdfId id, const IndexRange& run) {
        const auto& bsdf = std::get<Principled>((*points.scene)[id]);
        p.has_spec_trans |= bsdf.has_spec_trans, p.has_clearcoat |= bsdf.has_clearcoat;
        p.has_sheen |= bsdf.has_sheen, p.has_flatness |= bsdf.has_flatness;
        p.has_spec_tint |= bsdf.has_spec_tint, p.has_anisotropic |= bsdf.has_anisotropic;
        look_up(points, bsdf.base_color, run, lanes.color);
        for (std::size_t k = 0; k < kPrincipledScalars; ++k)
            look_up(points, bsdf.scalars[k], run, lanes.scalar[k]);
        fill(lanes.eta, run, bsdf.eta);
        fill(lanes.specular_rate, run, bsdf.specular_rate);
        fill(lanes.clearcoat_rate, run, bsdf.clearcoat_rate);
        fill(lanes.diffuse_rate, run, bsdf.diffuse_rate);
        fill(lanes.min_transmission, run, min_transmission(bsdf));
        fill(lanes.min_diffuse, run, min_diffuse(bsdf));
        fill(lanes.min_clearcoat, run, min_clearcoat(bsdf));
    });
}

PrincipledParameters<Packet> BsdfPackets<Principled>::at(std::size_t i) const {
    PrincipledParameters<Packet> p = lobes_;
    const auto scalar = [&](PrincipledScalar k) {
        return load(lanes_->scalar[static_cast<std::size_t>(k)], i);
    };
    using enum PrincipledScalar;
    p.base_color = load(lanes_->color, i);
    p.roughness = scalar(kRoughness), p.anisotropic = scalar(kAnisotropic);
    p.metallic = scalar(kMetallic), p.spec_trans = scalar(kSpecTrans);
    p.spec_tint = scalar(kSpecTint), p.sheen = scalar(kSheen), p.sheen_tint = scalar(kSheenTint);
    p.flatness = scalar(kFlatness), p.clearcoat = scalar(kClearcoat);
    p.clearcoat_gloss = scalar(kClearcoatGloss);
    p.eta = load(lanes_->eta, i), p.specular_rate = load(lanes_->specular_rate, i);
    p.clearcoat_rate = load(lanes_->clearcoat_rate, i);
    p.diffuse_rate = load(lanes_->diffuse_rate, i);
    p.min_transmission = load(lanes_->min_transmission, i);
    p.min_diffuse = load(lanes_->min_diffuse, i);
    p.min_clearcoat = load(lanes_->min_clearcoat, i);
    return p;
}

}  // namespace burnish
