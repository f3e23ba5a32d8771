#include "paths/light_tree.h"

#include <cstring>

namespace burnish {

namespace {

/// A node unpacked. T: float or Packet.
template <class T>
struct Side {
    Vec3<T> center;
    T radius, intensity;
    Vec3<T> axis;
    T cos_spread;
};

float low_half(std::uint32_t word) { return static_cast<float>(static_cast<std::int16_t>(word)); }
float high_half(std::uint32_t word) {
    return static_cast<float>(static_cast<std::int16_t>(word >> 16));
}
Packet low_half(const Packet& word) {
    return per_register<Packet>([&](std::size_t i) {
        const auto bits = reinterpret_cast<Register<std::int32_t>>(word.r[i]);
        return __builtin_convertvector((bits << 16) >> 16, Register<float>);
    });
}
Packet high_half(const Packet& word) {
    return per_register<Packet>([&](std::size_t i) {
        const auto bits = reinterpret_cast<Register<std::int32_t>>(word.r[i]);
        return __builtin_convertvector(bits >> 16, Register<float>);
    });
}

template <class T, class Word>
Side<T> unpack(const Vec3<T>& center, const T& radius, const T& intensity, const Word& axis_xy,
               const Word& axis_z_spread) {
    const T unit(1 / LightTree::kUnit);
    return {center,
            radius,
            intensity,
            {low_half(axis_xy) * unit, high_half(axis_xy) * unit, low_half(axis_z_spread) * unit},
            high_half(axis_z_spread) * unit};
}

template <class T>
using Sides = std::array<Side<T>, 2>;

Sides<float> unpack(const LightTree::Split& split) {
    const auto side = [](const LightTree::Node& n) {
        return unpack(n.center, n.radius, n.intensity, n.axis_xy, n.axis_z_spread);
    };
    return {side(split.side[0]), side(split.side[1])};
}

/// One split per lane; also where each side leads, as bits.
struct SplitPackets {
    Sides<Packet> sides;
    std::array<Packet, 2> next;
};

SplitPackets gather_splits(const LightTree& tree, const std::array<std::uint32_t, kLanes>& at) {
    PacketBlock words;
    for (std::size_t k = 0; k < kLanes; ++k)
        words[k] = load(reinterpret_cast<const float*>(&tree.splits[at[k]]));
    transpose(words);
    const auto side = [&](std::size_t w) {
        return unpack(Vec3<Packet>{words[w], words[w + 1], words[w + 2]}, words[w + 3],
                      words[w + 4], words[w + 5], words[w + 6]);
    };
    return {{side(0), side(8)}, {words[7], words[15]}};
}

/// Irradiance on a surface that faces the group, as a fraction: dividing once is enough.
template <class T>
struct Importance {
    T over, under;
};

template <class T>
Importance<T> importance(const Side<T>& side, const Vec3<T>& position) {
    // A lower bound of the cosine: bounds are rounded, and shading normals are not the surface's.
    const T min_cosine(1.0f / 64), zero(0.0f);
    const Vec3<T> away = position - side.center;
    const T squared = max(length_squared(away), T(1e-30f)), distance = sqrt(squared);
    const T cosine = side.cos_spread, along = dot(side.axis, away);
    // n . (position - y) with n a normal of the cone and y a point of the sphere is at most this.
    const T turned = cosine * along + sqrt(max(T(1.0f) - cosine * cosine, zero) *
                                           max(squared - along * along, zero));
    const T height = select(along < cosine * distance, turned, distance) + side.radius;
    const T bounded = max(min(height, distance), min_cosine * distance);
    return {side.intensity * bounded, distance * max(squared, side.radius * side.radius)};
}

/// The probability of taking side 0.
template <class T>
T share_of_first(const Sides<T>& sides, const Vec3<T>& position) {
    const T zero(0.0f), one(1.0f), bound(kMinShare);
    const Importance<T> a = importance(sides[0], position), b = importance(sides[1], position);
    const T x = a.over * b.under, y = b.over * a.under;
    // What overflows is not a number; min and max give their second argument then.
    const T share = max(min(x / (x + y), one - bound), bound);
    const auto first = sides[0].intensity > zero, second = sides[1].intensity > zero;
    return select(first, select(second, share, one), select(second, zero, T(0.5f)));
}

/// Whether a node's `next` is an emitter.
bool is_leaf(std::uint32_t next) { return next & 1; }

/// Eight walks in vectors, as wide as the widest registers.
constexpr std::size_t kHalf = kLanes / 2;
using Doubles = double __attribute__((vector_size(8 * kHalf)));
using Longs = std::int64_t __attribute__((vector_size(8 * kHalf)));
using Floats = float __attribute__((vector_size(4 * kHalf)));
using Integers = std::int32_t __attribute__((vector_size(4 * kHalf)));

template <class Vector>
Vector load_half(const void* from) {
    Vector v;
    std::memcpy(&v, from, sizeof v);
    return v;
}

/// LightInterval::enter for the walks that are not at an emitter: without branches, since each lane
/// turns another way.
void enter(const Packet& share, const std::array<Packet, 2>& to, LightWalks& walks) {
    alignas(64) std::array<float, kLanes> shares, to_first, to_second;
    store(shares.data(), share), store(to_first.data(), to[0]), store(to_second.data(), to[1]);
    for (std::size_t k = 0; k < kLanes; k += kHalf) {
        const auto u = load_half<Doubles>(&walks.u[k]), begin = load_half<Doubles>(&walks.begin[k]),
                   width = load_half<Doubles>(&walks.width[k]);
        const auto next = load_half<Integers>(&walks.next[k]);
        const Doubles first =
            width * __builtin_convertvector(load_half<Floats>(&shares[k]), Doubles);
        const Doubles middle = begin + first;
        const Longs second = u >= middle;
        const Integers arrived = -(next & 1);
        const Longs stays = __builtin_convertvector(arrived, Longs);
        const Doubles side_begin = second ? middle : begin,
                      side_width = second ? width - first : first;
        const Integers turns = __builtin_convertvector(second, Integers);
        const Integers side = (load_half<Integers>(&to_second[k]) & turns) |
                              (load_half<Integers>(&to_first[k]) & ~turns);
        const Doubles new_begin = stays ? begin : side_begin,
                      new_width = stays ? width : side_width;
        const Integers new_next = (next & arrived) | (side & ~arrived);
        std::memcpy(&walks.begin[k], &new_begin, sizeof new_begin);
        std::memcpy(&walks.width[k], &new_width, sizeof new_width);
        std::memcpy(&walks.next[k], &new_next, sizeof new_next);
    }
}

}  // namespace

void walk_light_tree(const LightTree& tree, const Vec3f& position, LightWalk& walk) {
    while (!is_leaf(walk.next)) {
        const LightTree::Split& split = tree.splits[walk.next / 2];
        const std::size_t side =
            walk.interval.enter(share_of_first(unpack(split), position),
                                [&](double middle) { return walk.u >= middle; });
        walk.next = split.side[side].next;
    }
}

void walk_light_tree(const LightTree& tree, const Vec3<Packet>& position, LightWalks& walks) {
    const auto all_arrived = [&] {
        std::uint32_t leaves = 1;
        for (const std::uint32_t next : walks.next) leaves &= next;
        return leaves != 0;
    };
    while (!all_arrived()) {
        std::array<std::uint32_t, kLanes> at;
        for (std::size_t k = 0; k < kLanes; ++k)
            at[k] = is_leaf(walks.next[k]) ? 0 : walks.next[k] / 2;
        const SplitPackets splits = gather_splits(tree, at);
        enter(share_of_first(splits.sides, position), splits.next, walks);
    }
}

LightInterval interval_in_tree(const LightTree& tree, const Vec3f& position, std::uint32_t emitter,
                               LightInterval interval) {
    std::uint64_t path = tree.path[emitter];
    for (std::uint32_t next = tree.root; !is_leaf(next); path >>= 1) {
        const LightTree::Split& split = tree.splits[next / 2];
        interval.enter(share_of_first(unpack(split), position), [=](double) { return path & 1; });
        next = split.side[path & 1].next;
    }
    return interval;
}

template <class T>
T total_importance(const LightTree& tree, const Vec3<T>& position) {
    const auto of = [&](const LightTree::Node& node) {
        const auto side =
            unpack(node.center, node.radius, node.intensity, node.axis_xy, node.axis_z_spread);
        const Vec3<T> center{T(side.center.x), T(side.center.y), T(side.center.z)},
            axis{T(side.axis.x), T(side.axis.y), T(side.axis.z)};
        const auto i = importance(
            Side<T>{center, T(side.radius), T(side.intensity), axis, T(side.cos_spread)}, position);
        return i.over / i.under;
    };
    const LightTree::Split& first = tree.splits[0];
    return of(first.side[0]) + of(first.side[1]);
}

template float total_importance(const LightTree&, const Vec3f&);
template Packet total_importance(const LightTree&, const Vec3<Packet>&);

}  // namespace burnish
