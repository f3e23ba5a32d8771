// A light tree [CK18]: a binary hierarchy over emitters at finite distance, in which an emitter is
// chosen by walking down and taking a side of each split with probability
//
//     P(side) = I(side) / (I(left) + I(right)),   I = intensity * cosine bound / distance^2,
//
// I the irradiance that a group of emitters could cause at the point that is lit: a bound of the
// cosine at the group, from the cone of its normals and from its size. I is never zero where the
// intensity is not, and no P is below kMinShare where both sides shine, so every emitter that
// could light a point is chosen there with positive probability.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/box.h"
#include "core/packet.h"

namespace burnish {

/// Where an emitter or a group of them is, and which way it shines.
struct LightBounds {
    Box box;               ///< holds it
    Vec3f axis{0, 0, 1};   ///< unit; of the cone that holds the normals of its front
    float cos_spread = 1;  ///< of the cone's half angle; -1: it shines into all directions
    float intensity = 0;   ///< luminous, per steradian along the axis; finite, not negative
};

/// Mean of the positive part of the cosine between the axis and the normals of a cone, all equally
/// frequent: 1/4 for all normals.
inline float mean_cosine(float cos_spread) {
    return cos_spread > 0 ? (1 + cos_spread) / 2 : 1 / (2 * (1 - cos_spread));
}

struct LightTree {
    /// What a group looks like from afar: half a cache line.
    struct Node {
        Vec3f center;
        float radius = 0;  ///< of a sphere about the box; positive
        float intensity = 0;
        std::uint32_t axis_xy = 0, axis_z_spread = 0;  ///< halves: signed, times kUnit; low first
        std::uint32_t next = 0;                        ///< 2 * split, or 2 * emitter + 1
    };
    /// One cache line: what a step of a walk reads. Sixteen of them are transposed into packets.
    struct alignas(64) Split {
        std::array<Node, 2> side;
    };
    static constexpr float kUnit = 32767;

    std::uint32_t root = 0;     ///< as Node::next
    std::vector<Split> splits;  ///< the root's first; of a lone emitter: it, and nothing
    /// Of each emitter: its sides from the root, lowest bit first.
    std::vector<std::uint64_t> path;
};
static_assert(sizeof(LightTree::Split) == 64);

/// Neither side of a split is chosen less often, if it shines at all.
inline constexpr float kMinShare = 1.0f / 1024;

/// emitter[i] is the number by which the emitter with bounds[i] is known, below `numbers`. At least
/// one. Deterministic; n emitters take n log n steps, and no walk more than 64.
LightTree build_light_tree(std::span<const LightBounds> bounds,
                           std::span<const std::uint32_t> emitter, std::size_t numbers);

/// The interval of uniform numbers that leads to a group; its width is the probability.
struct LightInterval {
    double begin = 0, width = 1;

    /// Goes on to a side of a split, decide(where side 1 begins). Returns it.
    template <class Decide>
    std::size_t enter(float share_of_first, const Decide& decide) {
        const double first = width * static_cast<double>(share_of_first), middle = begin + first;
        const std::size_t side = decide(middle);
        begin = side ? middle : begin;
        width = side ? width - first : first;
        return side;
    }
};

/// A walk: what u leads to, so far.
struct LightWalk {
    double u = 0;
    LightInterval interval;
    std::uint32_t next = 0;  ///< as Node::next
};

/// Sixteen of them.
struct alignas(64) LightWalks {
    std::array<double, kLanes> u, begin, width;
    std::array<std::uint32_t, kLanes> next;
};

/// Goes on to an emitter, seen from a position. u lies in the interval of the walk.
void walk_light_tree(const LightTree& tree, const Vec3f& position, LightWalk& walk);
/// Bit by bit the same. Walks that are at an emitter already stay.
void walk_light_tree(const LightTree& tree, const Vec3<Packet>& position, LightWalks& walks);

/// The part of an interval that leads to an emitter: bit by bit that of a walk.
LightInterval interval_in_tree(const LightTree& tree, const Vec3f& position, std::uint32_t emitter,
                               LightInterval interval);

/// Irradiance of all emitters of the tree together: of the two sides of its first split, which know
/// more than one sphere about all. T: float or Packet.
template <class T>
T total_importance(const LightTree& tree, const Vec3<T>& position);

}  // namespace burnish
