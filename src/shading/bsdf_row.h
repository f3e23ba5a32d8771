// What a BSDF reads at a point, as rows of numbers: inputs, which may come from textures and carry
// derivatives, and what its kind has besides and no texture changes.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <type_traits>

#include "core/packet.h"
#include "core/vec.h"
#include "scene/material.h"

namespace burnish {

/// Places in a row of inputs: those of `principled`, the longest.
inline constexpr std::size_t kBsdfColor = 3;
inline constexpr std::size_t kBsdfInputs = kBsdfColor + kPrincipledScalars;

/// The channels of each colour, then the scalars; kinds with fewer ignore the rest.
template <class T>
using BsdfInputs = std::array<T, kBsdfInputs>;

inline constexpr std::size_t kBsdfConstants = 7;

/// A table of RoughPlastic::transmittance, for each lane of U its own.
template <class U>
struct TransmittanceTable {
    static constexpr std::size_t kTables = std::is_same_v<U, Packet> ? kLanes : 1;
    std::array<const float*, kTables> of_lane{};
};

/// The constants of a BSDF; what they mean its bsdf_constants says.
template <class U>
struct BsdfConstants {
    std::array<U, kBsdfConstants> v{};
    TransmittanceTable<U> table;
};

/// The least probability of a lobe that has one.
inline constexpr float kLobeShare = 0.05f;

/// The least probability of a lobe whose weight textures set and whose directions no other lobe
/// draws, or other lobes all too rarely, as narrow facets those of a diffuse one: where the weight
/// is 0 its derivative needs samples all the same, and so do records that are shaded again once it
/// has grown. 0 where no texture sets it.
inline float min_share(std::initializer_list<TextureId> textures) {
    const bool any = std::any_of(textures.begin(), textures.end(), [](TextureId t) { return !!t; });
    return any ? kLobeShare : 0;
}

/// The same constants for another plain type, a packet's in every lane.
template <class U>
BsdfConstants<U> broadcast(const BsdfConstants<float>& from) {
    BsdfConstants<U> to;
    for (std::size_t i = 0; i < kBsdfConstants; ++i) to.v[i] = U(from.v[i]);
    to.table.of_lane.fill(from.table.of_lane[0]);
    return to;
}

template <class T>
Rgb<T> color_at(const BsdfInputs<T>& row, std::size_t place) {
    return {row[place], row[place + 1], row[place + 2]};
}
template <class U>
Rgb<U> color_at(const BsdfConstants<U>& constants, std::size_t place) {
    return {constants.v[place], constants.v[place + 1], constants.v[place + 2]};
}

}  // namespace burnish
