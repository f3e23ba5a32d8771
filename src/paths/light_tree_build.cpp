#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "paths/light_tree.h"

namespace burnish {

namespace {

constexpr std::size_t kBins = 12;
/// Splits below this depth are in the middle: with at most 2^31 emitters, no path has more than 64
/// bits.
constexpr int kDeepestSearch = 32;

struct Item {
    LightBounds bounds;
    std::uint32_t emitter = 0;
};

/// Widens a's cone until it holds b's.
void widen_cone(LightBounds& a, const LightBounds& b) {
    const float half_a = std::acos(std::clamp(a.cos_spread, -1.0f, 1.0f)),
                half_b = std::acos(std::clamp(b.cos_spread, -1.0f, 1.0f));
    const float cosine = std::clamp(dot(a.axis, b.axis), -1.0f, 1.0f), between = std::acos(cosine);
    if (between + half_b <= half_a) return;
    if (between + half_a <= half_b) {
        a.axis = b.axis, a.cos_spread = b.cos_spread;
        return;
    }
    const float half = 0.5f * (half_a + half_b + between);
    const Vec3f across = b.axis - a.axis * cosine;
    if (!(half < kPi) || !(length_squared(across) > 1e-10f)) {
        a.cos_spread = -1;
        return;
    }
    const float turn = half - half_a;
    a.axis = normalize(a.axis * std::cos(turn) + normalize(across) * std::sin(turn));
    a.cos_spread = std::cos(half);
}

/// Nothing: any union with it is the other.
constexpr LightBounds kNothing{{}, {0, 0, 1}, 2, 0};

void include(LightBounds& group, const LightBounds& b) {
    if (group.cos_spread > 1) return void(group = b);
    group.box.include(b.box);
    group.intensity += b.intensity;
    widen_cone(group, b);
}

LightBounds bounds_of(std::span<const Item> items) {
    LightBounds group = kNothing;
    for (const Item& item : items) include(group, item.bounds);
    return group;
}

/// Measure of the directions that a cone of normals shines into, weighted by the cosine [CK18 sec.
/// 4.1, M_Omega with theta_e = pi / 2].
float direction_measure(float cos_spread) {
    const float spread = std::acos(std::clamp(cos_spread, -1.0f, 1.0f)), sine = std::sin(spread);
    const float end = std::min(spread + kPi / 2, kPi);
    return 2 * kPi * (1 - cos_spread) +
           kPi / 2 * (2 * end * sine - std::cos(spread - 2 * end) - 2 * spread * sine + cos_spread);
}

/// Cost of a group [CK18 sec. 4.4]: 0 where it is empty. No area is zero, so that lamps in a line
/// are told apart.
float cost(const LightBounds& group, float min_extent) {
    if (group.cos_spread > 1) return 0;
    const Vec3f size = group.box.size() + Vec3f{min_extent, min_extent, min_extent};
    return group.intensity * direction_measure(group.cos_spread) *
           (size.x * size.y + size.y * size.z + size.z * size.x);
}

struct Plane {
    int axis = -1;        ///< -1: no plane parts the centres
    std::size_t bin = 0;  ///< the first on the right side
    float cost = kInfinity;
};

/// Where bins lie along an axis.
struct Bins {
    int axis = 0;
    float low = 0, scale = 0;

    std::size_t of(const Item& item) const {
        const float at = (item.bounds.box.center()[axis] - low) * scale;
        return std::min(static_cast<std::size_t>(std::max(at, 0.0f)), kBins - 1);
    }
};

/// The cheapest plane between bins of an axis [CK18 eq. 1]: long boxes are cut across.
Plane cheapest_plane(std::span<const Item> items, const Bins& bins, float min_extent,
                     float regularity) {
    std::array<LightBounds, kBins> bin;
    bin.fill(kNothing);
    for (const Item& item : items) include(bin[bins.of(item)], item.bounds);
    std::array<float, kBins> right{};
    LightBounds group = kNothing;
    for (std::size_t i = kBins - 1; i > 0; --i) {
        if (bin[i].cos_spread <= 1) include(group, bin[i]);
        right[i] = cost(group, min_extent);
    }
    Plane best;
    group = kNothing;
    for (std::size_t i = 1; i < kBins; ++i) {
        if (bin[i - 1].cos_spread <= 1) include(group, bin[i - 1]);
        const float sum = regularity * (cost(group, min_extent) + right[i]);
        if (sum < best.cost) best = {bins.axis, i, sum};
    }
    return best;
}

/// The number of items that go to the left; they are moved there.
std::size_t part(std::span<Item> items, int depth) {
    Box centers;
    for (const Item& item : items) centers.include(item.bounds.box.center());
    const Vec3f size = centers.size();
    const float longest = std::max(size.x, std::max(size.y, size.z));
    const std::size_t middle = items.size() / 2;
    if (depth >= kDeepestSearch || !(longest > 0) || !std::isfinite(longest)) return middle;

    Plane best;
    Bins best_bins;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(size[axis] > 0)) continue;
        const Bins bins{axis, centers.low[axis], static_cast<float>(kBins) / size[axis]};
        const Plane plane = cheapest_plane(items, bins, 1e-3f * longest, longest / size[axis]);
        if (plane.cost < best.cost) best = plane, best_bins = bins;
    }
    if (best.axis < 0) return middle;
    const auto end = std::stable_partition(
        items.begin(), items.end(), [&](const Item& i) { return best_bins.of(i) < best.bin; });
    const auto left = static_cast<std::size_t>(end - items.begin());
    return left == 0 || left == items.size() ? middle : left;
}

/// Two numbers of [-1, 1] as halves of a word.
std::uint32_t pack(float low, float high) {
    const auto half = [](float x) {
        const long rounded = std::lround(std::clamp(x, -1.0f, 1.0f) * LightTree::kUnit);
        return static_cast<std::uint32_t>(rounded) & 0xffffu;
    };
    return half(low) | half(high) << 16;
}

LightTree::Node node_of(const LightBounds& b, float min_radius, std::uint32_t next) {
    LightTree::Node node;
    node.center = b.box.center();
    node.radius = std::max(0.5f * length(b.box.size()), min_radius);
    node.intensity = b.intensity;
    node.axis_xy = pack(b.axis.x, b.axis.y);
    node.axis_z_spread = pack(b.axis.z, b.cos_spread);
    node.next = next;
    return node;
}

struct Builder {
    LightTree& tree;
    float min_radius;

    /// `path` leads to the items, which are `depth` splits below the root.
    LightTree::Node build(std::span<Item> items, int depth, std::uint64_t path) {
        if (items.size() == 1) {
            tree.path[items[0].emitter] = path;
            return node_of(items[0].bounds, min_radius, 2 * items[0].emitter + 1);
        }
        const LightBounds bounds = bounds_of(items);
        const std::size_t left = part(items, depth), split = tree.splits.size();
        tree.splits.emplace_back();
        const auto first = build(items.first(left), depth + 1, path);
        const auto second =
            build(items.subspan(left), depth + 1, path | std::uint64_t{1} << std::min(depth, 63));
        tree.splits[split].side = {first, second};
        return node_of(bounds, min_radius, static_cast<std::uint32_t>(2 * split));
    }
};

}  // namespace

LightTree build_light_tree(std::span<const LightBounds> bounds,
                           std::span<const std::uint32_t> emitter, std::size_t numbers) {
    LightTree tree;
    tree.path.resize(numbers);
    tree.splits.reserve(bounds.size() - 1);
    std::vector<Item> items;
    items.reserve(bounds.size());
    for (std::size_t i = 0; i < bounds.size(); ++i) items.push_back({bounds[i], emitter[i]});
    const LightBounds all = bounds_of(items);
    // No point at a lamp makes its importance infinite.
    const float min_radius = std::max(1e-4f * length(all.box.size()), 1e-15f);
    const LightTree::Node root = Builder{tree, min_radius}.build(items, 0, 0);
    tree.root = root.next;
    if (tree.splits.empty()) tree.splits.push_back({{root, {{}, min_radius}}});
    return tree;
}

}  // namespace burnish
