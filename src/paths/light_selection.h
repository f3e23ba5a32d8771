// Which emitter a light sample goes to, and how often. The probability is a function of emitter
// and position alone, so that light found by another technique gets the density of this one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "burnish/renderer.h"
#include "core/alias_table.h"
#include "paths/light_tree.h"

namespace burnish {

inline constexpr LightSelection kDefaultLightSelection = LightSelection::kUniform;

/// An emitter at infinity.
struct InfiniteLight {
    std::uint32_t emitter = 0;
    float irradiance = 0;  ///< luminous: pi times mean radiance, or that of parallel light
};

/// The emitters of a scene as a choice sees them.
struct EmitterSummary {
    std::size_t count = 0;               ///< of all
    std::vector<LightBounds> bounds;     ///< of those at finite distance
    std::vector<std::uint32_t> emitter;  ///< parallel to bounds
    std::vector<InfiniteLight> infinite;
    std::int32_t sky = -1;  ///< that of them which rays find; -1: none
    Vec3f middle;           ///< of what is lit, roughly
};

struct LightSelector {
    LightSelection selection = LightSelection::kUniform;
    std::uint32_t emitters = 0;
    AliasTable by_power;    ///< kPower
    LightTree tree;         ///< kTree, of emitters at finite distance
    bool has_tree = false;  ///< there is one of these
    /// An emitter at infinity, and the share of it in itself and those behind it: the last one's is
    /// 1.
    struct Infinite {
        std::uint32_t emitter = 0;
        float share_of_rest = 1;
    };
    std::vector<Infinite> infinite;
    float infinite_irradiance = 0;  ///< of all of them
    std::int32_t sky = -1;          ///< the emitter at infinity that rays find, if any
    float sky_share = 1;            ///< of it in all at infinity
};

LightSelector build_light_selector(const EmitterSummary& emitters, LightSelection selection);

struct SelectedEmitter {
    std::uint32_t emitter = 0;
    float inverse_probability = 1;  ///< 1 / probability
    float rest = 0;                 ///< what is left of u[0]: uniform in [0, 1)
};

/// u: four independent uniforms in [0, 1); the choice takes the first, and of the last only bits
/// that a place on an emitter does not feel. There is at least one emitter.
SelectedEmitter select_emitter(const LightSelector& selector, const Vec3f& position,
                               const std::array<float, 4>& u);

/// Sixteen at a time, bit by bit the same.
std::array<SelectedEmitter, kLanes> select_emitters(const LightSelector& selector,
                                                    const Vec3<Packet>& position,
                                                    const std::array<Packet, 4>& u);

/// 1 / probability with which select_emitter gives this emitter at this position; infinity where it
/// never does.
float inverse_probability(const LightSelector& selector, const Vec3f& position,
                          std::uint32_t emitter);
/// The same of the emitter at infinity that rays find, which there is. T: float or Packet.
template <class T>
T infinity_one_in(const LightSelector& selector, const Vec3<T>& position);

}  // namespace burnish
