// The BSDFs of a batch of points, sixteen at a time: their parameters looked up into lanes, and one
// type per kind of BSDF that evaluates and samples a packet of them.
#pragma once

#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/index_range.h"
#include "paths/columns.h"
#include "scene/scene.h"
#include "shading/bsdf.h"

namespace burnish {

/// Places in a row of kinds other than `principled`: those of `principledthin`, the longest.
/// paths/traced_scene.cpp checks the rows of a scene.
inline constexpr std::size_t kBsdfRowInputs = kBsdfColor + kThinScalars;

/// The parameters of a batch of points. Diffuse and principled points use the named columns, those
/// of other kinds rows of inputs and constants.
struct BsdfColumns {
    ColumnVec3 color;  ///< base colour or reflectance
    std::array<Column, kPrincipledScalars> scalar;
    Column eta, specular_rate, clearcoat_rate, diffuse_rate;
    Column min_transmission, min_diffuse, min_clearcoat;
    std::array<Column, kBsdfRowInputs> inputs;
    std::array<Column, kBsdfConstants> constants;
    std::array<const float*, kMaxLanes> tables;
};

/// For each texture of the scene a value in place of its texels, NaN where they are read; empty:
/// all are.
using ConstantTextures = std::vector<float>;

/// Where the points' BSDFs are read: bsdfs[i] is that of lane i. Points of one BSDF follow one
/// another.
struct BsdfPoints {
    const Scene* scene = nullptr;
    const TextureTable* textures = nullptr;
    std::span<const BsdfId> bsdfs;
    const Column *u = nullptr, *v = nullptr;  ///< texture coordinates
    std::span<const float> constants = {};    ///< ConstantTextures
};

/// The rows of points whose BSDFs are neither diffuse nor principled.
void look_up_rows(const BsdfPoints& points, const IndexRange& range, BsdfColumns& lanes);

/// The points of one kind of BSDF, a packet at a time: eval_pdf(i, wi, wo) and sample(i, wi, u,
/// u_lobe) for the packet that begins at lane i. One specialisation for each alternative of Bsdf,
/// where the one for rows does not do.
template <class Kind>
class BsdfPackets {
  public:
    BsdfPackets(const BsdfPoints& points, const IndexRange& range, BsdfColumns& lanes)
        : lanes_(&lanes) {
        look_up_rows(points, range, lanes);
    }

    BsdfValue<Packet> eval_pdf(std::size_t i, const Vec3<Packet>& wi,
                               const Vec3<Packet>& wo) const {
        const auto p = at(i);
        return {eval_bsdf(p, wi, wo), pdf_bsdf(p, wi, wo)};
    }
    SampledDirection<Packet> sample(std::size_t i, const Vec3<Packet>& wi, const Vec2<Packet>& u,
                                    const Packet& u_lobe) const {
        return sample_bsdf(at(i), wi, u, u_lobe);
    }

  private:
    auto at(std::size_t i) const {
        BsdfInputs<Packet> inputs{};
        for (std::size_t k = 0; k < kBsdfRowInputs; ++k) inputs[k] = load(lanes_->inputs[k], i);
        BsdfConstants<Packet> constants;
        for (std::size_t k = 0; k < kBsdfConstants; ++k)
            constants.v[k] = load(lanes_->constants[k], i);
        std::copy_n(&lanes_->tables[i], kLanes, constants.table.of_lane.begin());
        return row_parameters(RowOf<Kind>{}, inputs, constants);
    }
    const BsdfColumns* lanes_;
};

template <>
class BsdfPackets<Diffuse> {
  public:
    BsdfPackets(const BsdfPoints& points, const IndexRange& range, BsdfColumns& lanes);

    BsdfValue<Packet> eval_pdf(std::size_t i, const Vec3<Packet>& wi,
                               const Vec3<Packet>& wo) const {
        return {eval_diffuse(at(i), wi, wo), pdf_diffuse(at(i), wi, wo)};
    }
    SampledDirection<Packet> sample(std::size_t i, const Vec3<Packet>& wi, const Vec2<Packet>& u,
                                    const Packet&) const {
        return sample_diffuse(at(i), wi, u);
    }

  private:
    DiffuseParameters<Packet> at(std::size_t i) const { return {load(lanes_->color, i)}; }
    const BsdfColumns* lanes_;
};

template <>
class BsdfPackets<Principled> {
  public:
    BsdfPackets(const BsdfPoints& points, const IndexRange& range, BsdfColumns& lanes);

    BsdfValue<Packet> eval_pdf(std::size_t i, const Vec3<Packet>& wi,
                               const Vec3<Packet>& wo) const {
        return eval_pdf_principled(at(i), wi, wo);
    }
    SampledDirection<Packet> sample(std::size_t i, const Vec3<Packet>& wi, const Vec2<Packet>& u,
                                    const Packet& u_lobe) const {
        return sample_principled(at(i), wi, u, u_lobe);
    }

  private:
    PrincipledParameters<Packet> at(std::size_t i) const;

    const BsdfColumns* lanes_;
    PrincipledParameters<Packet> lobes_{};  ///< of its members only the has_ flags are used
};

/// The lanes of each kind, whole packets; in the order of Bsdf's alternatives.
using LanesOfKinds = std::array<IndexRange, std::variant_size_v<Bsdf>>;

/// All kinds of a batch, in that order.
inline auto make_bsdf_packets(const BsdfPoints& points, const LanesOfKinds& kinds,
                              BsdfColumns& lanes) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
        return std::tuple{
            BsdfPackets<std::variant_alternative_t<I, Bsdf>>(points, kinds[I], lanes)...};
    }
    (std::make_index_sequence<std::variant_size_v<Bsdf>>());
}

}  // namespace burnish
