// The BSDFs of a batch under several textures at once: samples and densities are those of a mixture
// in equal parts.
#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "paths/bsdf_columns.h"

namespace burnish {

/// All kinds of a batch, under one component of the mixture.
using ComponentPackets =
    decltype(make_bsdf_packets(std::declval<const BsdfPoints&>(),
                               std::declval<const LanesOfKinds&>(), std::declval<BsdfColumns&>()));

/// One entry for each component; without any that of the points' own textures. lanes: grows to one
/// for each.
inline std::vector<ComponentPackets> make_mixture_packets(
    BsdfPoints points, const LanesOfKinds& kinds, std::span<const ConstantTextures> components,
    std::vector<BsdfColumns>& lanes) {
    const std::size_t count = std::max<std::size_t>(1, components.size());
    if (lanes.size() < count) lanes.resize(count);
    std::vector<ComponentPackets> packets;
    packets.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        if (!components.empty()) points.constants = components[k];
        packets.push_back(make_bsdf_packets(points, kinds, lanes[k]));
    }
    return packets;
}

/// The points of kind I: values are those of the first component, densities and samples the
/// mixture's. Delta lobes are those of the component that is sampled: whoever mixes leaves the
/// textures of a BSDF with delta lobes as they are, so that its components agree.
template <std::size_t I>
struct BsdfMixture {
    using Kind = std::variant_alternative_t<I, Bsdf>;
    static constexpr bool kHasDelta = kHasDeltaLobes<Kind>;
    static constexpr bool kHasOnlyDelta = kHasOnlyDeltaLobes<Kind>;  ///< eval_pdf gives zeros

    std::span<const ComponentPackets> components;

    BsdfValue<Packet> eval_pdf(std::size_t i, const Vec3<Packet>& wi,
                               const Vec3<Packet>& wo) const {
        auto sum = std::get<I>(components[0]).eval_pdf(i, wi, wo);
        if (components.size() == 1) return sum;
        for (const ComponentPackets& other : components.subspan(1))
            sum.pdf = sum.pdf + std::get<I>(other).eval_pdf(i, wi, wo).pdf;
        sum.pdf = sum.pdf * Packet(1 / static_cast<float>(components.size()));
        return sum;
    }
    /// u_component: says which component is sampled.
    SampledDirection<Packet> sample(std::size_t i, const Vec3<Packet>& wi, const Vec2<Packet>& u,
                                    const Packet& u_lobe, const Packet& u_component) const {
        auto sampled = std::get<I>(components[0]).sample(i, wi, u, u_lobe);
        for (std::size_t k = 1; k < components.size(); ++k) {
            const auto other = std::get<I>(components[k]).sample(i, wi, u, u_lobe);
            const float begin = static_cast<float>(k) / static_cast<float>(components.size());
            const auto chosen = u_component >= Packet(begin);
            sampled.wo_local = select(chosen, other.wo_local, sampled.wo_local);
            sampled.proper = (chosen && other.proper) || (!chosen && sampled.proper);
            sampled.eta = select(chosen, other.eta, sampled.eta);
        }
        return sampled;
    }
};

/// The BSDFs of a batch's points.
struct PointBsdfs {
    std::vector<ComponentPackets> packets;
    LanesOfKinds kinds;

    /// Calls body(bsdf, lanes) for each kind.
    template <class Body>
    void for_each_kind(const Body& body) const {
        [&]<std::size_t... I>(std::index_sequence<I...>) {
            (body(BsdfMixture<I>{packets}, kinds[I]), ...);
        }
        (std::make_index_sequence<std::variant_size_v<Bsdf>>());
    }
};

}  // namespace burnish
