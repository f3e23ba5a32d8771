// Which emitter a light sample goes to, and how often. The probability is a function of emitter
// and position alone, so that light found by another technique gets the density of this one. A
// resampled light sample has several candidates, each of which is drawn so;
// paths/light_resampling.h says which of them it is.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/renderer.h"
#include "core/alias_table.h"
#include "paths/light_tree.h"

namespace burnish {

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
    AliasTable by_power;                     ///< kPower, kResampled
    std::vector<float> inverse_probability;  ///< of each emitter by that table
    LightTree tree;  ///< kTree, of emitters at finite distance; without splits: there is none
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

/// The most candidates of a light sample, and how many there are of more emitters.
inline constexpr std::uint32_t kMaxCandidates = 8, kDrawnCandidates = 4;

/// Whether candidate c is emitter c. Of more emitters candidates are drawn by power, each from a
/// part of its own of all choices.
inline bool has_candidate_of_each(const LightSelector& s) {
    return s.selection == LightSelection::kResampled && s.emitters <= kMaxCandidates;
}
/// At least 1.
inline std::uint32_t candidates_of(const LightSelector& s) {
    switch (s.selection) {
        case LightSelection::kUniform:
        case LightSelection::kPower:
        case LightSelection::kTree:
            return 1;
        case LightSelection::kResampled:
            return has_candidate_of_each(s) ? s.emitters : kDrawnCandidates;
    }
    return 1;
}

struct SelectedEmitter {
    std::uint32_t emitter = 0;
    float inverse_probability = 1;  ///< 1 / probability; 1 / expected number of candidates
    float rest = 0;                 ///< what is left of u[0]: uniform in [0, 1)
};

/// u: four independent uniforms in [0, 1); the choice takes the first, and of the last only bits
/// that a place on an emitter does not feel. There is at least one emitter. candidate: below
/// candidates_of.
SelectedEmitter select_emitter(const LightSelector& selector, const Vec3f& position,
                               const std::array<float, 4>& u, std::uint32_t candidate = 0);

/// Sixteen at a time, bit by bit the same.
std::array<SelectedEmitter, kLanes> select_emitters(const LightSelector& selector,
                                                    const Vec3<Packet>& position,
                                                    const std::array<Packet, 4>& u,
                                                    std::uint32_t candidate = 0);

/// 1 / probability with which select_emitter gives this emitter at this position; infinity where it
/// never does. Of several candidates 1 / expected number of those that it is.
float inverse_probability(const LightSelector& selector, const Vec3f& position,
                          std::uint32_t emitter);
/// The same of the emitter at infinity that rays find, which there is. T: float or Packet.
template <class T>
T inverse_probability_at_infinity(const LightSelector& selector, const Vec3<T>& position);

}  // namespace burnish
