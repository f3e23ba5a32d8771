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

/// The emitters of a scene as a choice sees them.
struct EmitterSummary {
    std::size_t count = 0;               ///< of all
    std::vector<LightBounds> bounds;     ///< of those at finite distance
    std::vector<std::uint32_t> emitter;  ///< parallel to bounds
    std::optional<std::uint32_t> infinite;
    float infinite_irradiance = 0;  ///< luminous: pi times mean radiance
    Vec3f middle;                   ///< of what is lit, roughly
};

struct LightSelector {
    LightSelection selection = LightSelection::kUniform;
    std::uint32_t emitters = 0;
    AliasTable by_power;         ///< kPower
    LightTree tree;              ///< kTree, of emitters at finite distance
    bool has_tree = false;       ///< there is one of these
    std::int32_t infinite = -1;  ///< the emitter at infinity, if any
    float infinite_irradiance = 0;
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
/// The same of the emitter at infinity, which there is. T: float or Packet.
template <class T>
T infinity_one_in(const LightSelector& selector, const Vec3<T>& position);

}  // namespace burnish
