#include "paths/light_selection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.h"

namespace burnish {

namespace {

/// Of all choices by power, this share is made uniformly: a dim lamp may hang near.
constexpr double kUniformShare = 0.1;
/// Light from infinity takes no less and no more than this while there are lamps that shine: in a
/// room the sky is bright, and walls hide it.
constexpr float kMinInfinite = 0.1f, kMaxInfinite = 0.5f;

/// Luminous flux. What shines into all directions has a cone of all normals, a flat lamp one of
/// one normal: intensity is L A (1/4 of it for all normals), flux pi L A.
double luminous_power(const LightBounds& b) {
    return std::numbers::pi * static_cast<double>(b.intensity / mean_cosine(b.cos_spread));
}

/// The share of a in what a and b cause. T: float or Packet.
template <class T>
T bounded_share(const T& a, const T& b) {
    const T zero(0.0f), one(1.0f);
    const T share = max(min(a / (a + b), T(kMaxInfinite)), T(kMinInfinite));
    return select(a > zero, select(b > zero, share, one), select(b > zero, zero, T(0.5f)));
}

/// Irradiance of lamps at `middle`, as if they shone into all directions alike.
double irradiance_by_power(const EmitterSummary& emitters) {
    double sum = 0;
    for (const LightBounds& b : emitters.bounds) {
        const auto squared =
            static_cast<double>(std::max(length_squared(emitters.middle - b.box.center()),
                                         0.25f * length_squared(b.box.size())));
        if (squared > 0) sum += luminous_power(b) / (4 * std::numbers::pi * squared);
    }
    return sum;
}

float total_irradiance(std::span<const InfiniteLight> lights) {
    float sum = 0;
    for (const InfiniteLight& l : lights) sum += l.irradiance;
    return sum;
}

/// Of light from infinity; equal shares where all are black.
float share_in(const InfiniteLight& light, std::span<const InfiniteLight> all) {
    if (all.size() == 1) return 1;
    const float total = total_irradiance(all);
    return total > 0 ? light.irradiance / total : 1 / static_cast<float>(all.size());
}

/// Lamps share by flux what the light from infinity leaves of them at the middle of the scene.
AliasTable make_power_table(const EmitterSummary& emitters) {
    std::vector<double> weight(emitters.count);
    double total = 0;
    for (std::size_t i = 0; i < emitters.bounds.size(); ++i)
        total += weight[emitters.emitter[i]] = luminous_power(emitters.bounds[i]);
    if (!emitters.infinite.empty()) {
        const float infinite = total_irradiance(emitters.infinite);
        const auto share = static_cast<double>(
            bounded_share(infinite, static_cast<float>(irradiance_by_power(emitters))));
        for (double& w : weight) w *= total > 0 ? (1 - share) / total : 0;
        for (const InfiniteLight& l : emitters.infinite)
            weight[l.emitter] = share * static_cast<double>(share_in(l, emitters.infinite));
        total = total > 0 ? 1 : share;
    }
    for (double& w : weight)
        w = (total > 0 ? (1 - kUniformShare) * w / total : 0) +
            kUniformShare / static_cast<double>(emitters.count);
    return make_alias_table(weight);
}

SelectedEmitter select_uniformly(std::uint32_t emitters, float u) {
    const auto count = static_cast<float>(emitters), scaled = u * count;
    const std::uint32_t emitter = std::min(static_cast<std::uint32_t>(scaled), emitters - 1);
    const float left = scaled - static_cast<float>(emitter);
    return {emitter, count, std::clamp(left, 0.0f, 0x1.fffffep-1f)};
}

/// 36 random bits: the 24 of one number cannot reach every emitter of many. The others are the last
/// 12 of u[3], whose first 12 say where on an emitter.
double selection_uniform(const std::array<float, 4>& u) {
    const float scaled = u[3] * 0x1p12f;
    return fine_uniform(u[0], scaled - std::floor(scaled));
}

bool has_tree(const LightSelector& s) { return !s.tree.splits.empty(); }

/// The part of the choices that goes to infinity.
template <class T>
T share_of_infinite(const LightSelector& s, const Vec3<T>& position) {
    if (s.infinite.empty() || !has_tree(s)) return T(has_tree(s) ? 0.0f : 1.0f);
    return bounded_share(T(s.infinite_irradiance), total_importance(s.tree, position));
}

/// A walk that took the first decisions: it is at an emitter at infinity, or enters the tree.
LightWalk begin_walk(const LightSelector& s, float share, double u) {
    LightWalk walk{u, {}, 0};
    const auto beyond = [&](double middle) { return walk.u >= middle; };
    const bool enters = walk.interval.enter(share, beyond);
    if (enters && has_tree(s)) {
        walk.next = s.tree.root;
        return walk;
    }
    std::size_t i = 0;
    while (i + 1 < s.infinite.size() && walk.interval.enter(s.infinite[i].share_of_rest, beyond))
        ++i;
    walk.next = 2 * s.infinite[i].emitter + 1;
    return walk;
}

SelectedEmitter end_of(const LightWalk& walk) {
    const LightInterval& at = walk.interval;
    return {walk.next / 2, static_cast<float>(1 / at.width),
            std::min(static_cast<float>((walk.u - at.begin) / at.width), 0x1.fffffep-1f)};
}

SelectedEmitter select_by_tree(const LightSelector& s, const Vec3f& position, double u) {
    LightWalk walk = begin_walk(s, share_of_infinite(s, position), u);
    walk_light_tree(s.tree, position, walk);
    return end_of(walk);
}

float inverse_probability_in_tree(const LightSelector& s, const Vec3f& position,
                                  std::uint32_t emitter) {
    const auto found =
        std::find_if(s.infinite.begin(), s.infinite.end(),
                     [&](const LightSelector::Infinite& i) { return i.emitter == emitter; });
    const bool infinite = found != s.infinite.end();
    LightInterval at;
    at.enter(share_of_infinite(s, position), [=](double) { return !infinite; });
    if (!infinite) at = interval_in_tree(s.tree, position, emitter, at);
    for (auto i = s.infinite.begin(); infinite && i != found; ++i)
        at.enter(i->share_of_rest, [](double) { return true; });
    if (infinite && std::next(found) != s.infinite.end())
        at.enter(found->share_of_rest, [](double) { return false; });
    return static_cast<float>(1 / at.width);
}

void set_infinite(const EmitterSummary& emitters, LightSelector& s) {
    const std::span<const InfiniteLight> all(emitters.infinite);
    s.sky = emitters.sky;
    s.infinite_irradiance = total_irradiance(all);
    for (std::size_t i = 0; i < all.size(); ++i) {
        s.infinite.push_back({all[i].emitter, share_in(all[i], all.subspan(i))});
        if (static_cast<std::int32_t>(all[i].emitter) == s.sky) s.sky_share = share_in(all[i], all);
    }
}

void set_table(const EmitterSummary& emitters, LightSelector& s) {
    s.by_power = make_power_table(emitters);
    for (const float p : s.by_power.probability)  // each candidate draws from a part of it
        s.inverse_probability.push_back(1 / (static_cast<float>(candidates_of(s)) * p));
}

void set_tree(const EmitterSummary& emitters, LightSelector& s) {
    if (emitters.bounds.empty()) return;
    s.tree = build_light_tree(emitters.bounds, emitters.emitter, emitters.count);
}

SelectedEmitter select_by_power(const LightSelector& s, const std::array<float, 4>& u,
                                std::uint32_t candidate) {
    const double part = candidate + selection_uniform(u);
    const auto drawn = sample_alias_table(s.by_power, part / candidates_of(s));
    return {drawn.index, s.inverse_probability[drawn.index],
            std::min(static_cast<float>(drawn.remainder), 0x1.fffffep-1f)};
}

std::array<float, 4> lane_of(const std::array<Packet, 4>& u, int lane) {
    return {get(u[0], lane), get(u[1], lane), get(u[2], lane), get(u[3], lane)};
}

std::array<SelectedEmitter, kLanes> select_by_tree(const LightSelector& s,
                                                   const Vec3<Packet>& position,
                                                   const std::array<Packet, 4>& u) {
    const Packet share = share_of_infinite(s, position);
    LightWalks walks;
    for (int lane = 0; lane < kLanes; ++lane) {
        const auto k = static_cast<std::size_t>(lane);
        const LightWalk walk = begin_walk(s, get(share, lane), selection_uniform(lane_of(u, lane)));
        walks.u[k] = walk.u, walks.next[k] = walk.next;
        walks.begin[k] = walk.interval.begin, walks.width[k] = walk.interval.width;
    }
    walk_light_tree(s.tree, position, walks);
    std::array<SelectedEmitter, kLanes> selected;
    for (std::size_t k = 0; k < kLanes; ++k)
        selected[k] = end_of({walks.u[k], {walks.begin[k], walks.width[k]}, walks.next[k]});
    return selected;
}

}  // namespace

LightSelector build_light_selector(const EmitterSummary& emitters, LightSelection selection) {
    LightSelector s;
    s.selection = selection;
    s.emitters = static_cast<std::uint32_t>(emitters.count);
    set_infinite(emitters, s);
    switch (selection) {
        case LightSelection::kUniform:
            break;
        case LightSelection::kPower:
        case LightSelection::kResampled:
            set_table(emitters, s);
            break;
        case LightSelection::kTree:
            set_tree(emitters, s);
            break;
    }
    return s;
}

SelectedEmitter select_emitter(const LightSelector& s, const Vec3f& position,
                               const std::array<float, 4>& u, std::uint32_t candidate) {
    if (s.emitters == 1) return select_uniformly(s.emitters, u[0]);
    switch (s.selection) {
        case LightSelection::kUniform:
            return select_uniformly(s.emitters, u[0]);
        case LightSelection::kPower:
            return select_by_power(s, u, candidate);
        case LightSelection::kTree:
            return select_by_tree(s, position, selection_uniform(u));
        case LightSelection::kResampled:
            if (has_candidate_of_each(s)) return {candidate, 1, u[0]};
            return select_by_power(s, u, candidate);
    }
    return {};
}

namespace {

/// Whether the tree chooses among several emitters; other choices do not look at the position.
bool chooses_by_tree(const LightSelector& s) {
    switch (s.selection) {
        case LightSelection::kUniform:
        case LightSelection::kPower:
        case LightSelection::kResampled:
            return false;
        case LightSelection::kTree:
            return s.emitters > 1;
    }
    return false;
}

}  // namespace

std::array<SelectedEmitter, kLanes> select_emitters(const LightSelector& s,
                                                    const Vec3<Packet>& position,
                                                    const std::array<Packet, 4>& u,
                                                    std::uint32_t candidate) {
    if (chooses_by_tree(s)) return select_by_tree(s, position, u);
    std::array<SelectedEmitter, kLanes> selected;
    for (int lane = 0; lane < kLanes; ++lane) {
        const auto k = static_cast<std::size_t>(lane);
        selected[k] = select_emitter(s, Vec3f{}, lane_of(u, lane), candidate);
    }
    return selected;
}

float inverse_probability(const LightSelector& s, const Vec3f& position, std::uint32_t emitter) {
    if (s.emitters == 1) return 1;
    switch (s.selection) {
        case LightSelection::kUniform:
            return static_cast<float>(s.emitters);
        case LightSelection::kPower:
            return s.inverse_probability[emitter];
        case LightSelection::kTree:
            return inverse_probability_in_tree(s, position, emitter);
        case LightSelection::kResampled:
            return has_candidate_of_each(s) ? 1 : s.inverse_probability[emitter];
    }
    return 0;
}

template <class T>
T inverse_probability_at_infinity(const LightSelector& s, const Vec3<T>& position) {
    if (chooses_by_tree(s)) return T(1.0f) / (share_of_infinite(s, position) * T(s.sky_share));
    return T(inverse_probability(s, Vec3f{}, static_cast<std::uint32_t>(s.sky)));
}
template float inverse_probability_at_infinity(const LightSelector&, const Vec3f&);
template Packet inverse_probability_at_infinity(const LightSelector&, const Vec3<Packet>&);

}  // namespace burnish
