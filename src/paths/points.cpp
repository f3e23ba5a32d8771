#include "paths/points.h"

#include <functional>

#include "core/random_packet.h"
#include "core/sobol.h"

namespace burnish {

namespace {

/// What names the numbers of sixteen samples.
struct SampleNames {
    LaneIntegers pixel, iteration, pass, film_pass;
};

SampleNames names_of(const TraceInput& input, std::span<const BatchSample> samples,
                     const PointLanes& points, std::size_t first) {
    SampleNames names;
    for (int k = 0; k < kLanes; ++k) {
        const CameraSample& s = samples[points.sample[first + static_cast<std::size_t>(k)]].camera;
        set(names.pixel, k, s.pixel), set(names.iteration, k, s.iteration);
        set(names.pass, k, s.pass);
        set(names.film_pass, k, film_pass(s, input.passes_per_iteration));
    }
    return names;
}

// Those of the first vertex, whose light adds up.
static_assert(kSobolBlocksInOrder == kTechniques);

std::uint32_t sobol_block(Technique technique, std::uint32_t bounce) {
    return bounce * kTechniques + static_cast<std::uint32_t>(technique);
}

/// Those of one technique at a bounce.
std::array<Packet, 4> uniforms_of(const TraceInput& input, const SampleNames& s,
                                  Technique technique, std::uint32_t bounce) {
    if (input.sequence == Sequence::kSobol)
        return sobol_uniforms(input.key, s.pixel, s.film_pass, sobol_block(technique, bounce));
    return uniforms(input.key, s.pixel, s.iteration,
                    s.pass * std::uint32_t{kTechniques} + static_cast<std::uint32_t>(technique),
                    bounce);
}

/// A fifth one of the light sample.
Packet choice_of(const TraceInput& input, const SampleNames& s, std::uint32_t bounce) {
    if (input.sequence == Sequence::kSobol)
        return sobol_fifth(input.key, s.pixel, s.film_pass,
                           sobol_block(Technique::kEmitter, bounce));
    return uniforms_of(input, s, Technique::kEmitter, bounce + kCandidateNumbers)[0];
}

/// The lanes behind a kind's last point repeat it.
void pad_kind(std::size_t end, const IndexRange& kind, PointLanes& points) {
    for (std::size_t i = end; i < kind.end; ++i) {
        points.sample[i] = points.sample[end - 1];
        points.bsdf[i] = points.bsdf[end - 1];
        points.material[i] = points.material[end - 1];
        points.has_unknowns[i] = 0;
    }
}

/// Gives every sample that sees a BSDF a lane, by counting: kind by kind, BSDF by BSDF.
void sort_points(const TraceInput& input, std::size_t count, const SeenBsdfs& seen,
                 PointLanes& points) {
    const BsdfOrder& order = input.scene->geometry->bsdf_order;
    points.has_shares = false;
    const auto rank = [&](BsdfId id) {
        return static_cast<std::size_t>(order.rank[static_cast<std::size_t>(id.value)]);
    };
    thread_local std::vector<std::size_t> next;  // scratch memory only: lanes of each rank
    next.assign(order.kind_begin.back(), 0);
    for (std::size_t i = 0; i < count; ++i) {
        if (!seen[i]) continue;
        ++next[rank(seen[i])];
        points.has_shares |= seen.shown[i].chance < 1;
    }

    std::array<std::size_t, std::variant_size_v<Bsdf>> end{};
    std::size_t lane = 0;
    for (std::size_t kind = 0; kind < end.size(); ++kind) {
        points.kinds[kind].begin = lane;
        for (std::size_t r = order.kind_begin[kind]; r < order.kind_begin[kind + 1]; ++r)
            lane += std::exchange(next[r], lane);
        end[kind] = lane;
        points.kinds[kind].end = lane = padded(lane);
    }
    points.count = lane;
    for (std::size_t i = 0; i < count; ++i) {
        if (!seen[i]) continue;
        const std::size_t at = next[rank(seen[i])]++;
        points.sample[at] = static_cast<std::uint16_t>(i);
        points.bsdf[at] = seen[i];
        points.material[at] = seen.shown[i].material;
        points.has_unknowns[at] = is_unknown(input, seen[i]);
        if (!points.has_shares) continue;
        points.share[at] = seen.shown[i].share, points.chance[at] = seen.shown[i].chance;
    }
    points.live.count = 0;
    for (std::size_t kind = 0; kind < end.size(); ++kind) {
        for (std::size_t i = points.kinds[kind].begin; i < end[kind]; ++i) points.live.add(i);
        pad_kind(end[kind], points.kinds[kind], points);
    }
}

void put(const Surface& s, std::size_t i, PointLanes& points) {
    set(points.position, i, s.position);
    set(points.geometric_normal, i, s.geometric_normal);
    set(points.s, i, s.shading.s), set(points.t, i, s.shading.t), set(points.n, i, s.shading.n);
    points.u[i] = s.uv.x, points.v[i] = s.uv.y;
}

void put(const SurfaceOf<Packet>& s, std::size_t i, PointLanes& points) {
    store(points.position, i, s.position);
    store(points.geometric_normal, i, s.geometric_normal);
    store(points.s, i, s.shading.s), store(points.t, i, s.shading.t);
    store(points.n, i, s.shading.n);
    store(points.u, i, s.uv.x), store(points.v, i, s.uv.y);
}

/// One truth value for each lane of a packet.
using PacketLanes = std::array<bool, kLanes>;

Mask to_mask(const PacketLanes& lanes) {
    Mask m;
    for (int k = 0; k < kLanes; ++k) set(m, k, lanes[static_cast<std::size_t>(k)]);
    return m;
}

/// The surfaces of some of sixteen points, all on one sphere, but for their texture coordinates.
void find_on_sphere(const Sphere& sphere, const RayLanes& rays, std::size_t i,
                    const PacketLanes& lanes, PointLanes& points) {
    const std::uint16_t* samples = &points.sample[i];
    const Vec3<Packet> near = gather(rays.rays.origin, samples) +
                              gather(rays.rays.direction, samples) * gather(rays.distance, samples);
    const SurfaceOf<Packet> s = sphere_surface(sphere, axes_of(sphere), near);
    const Mask mask = to_mask(lanes);
    const auto put_lanes = [&](ColumnVec3& to, const Vec3<Packet>& v) {
        store(to, i, select(mask, v, load(to, i)));
    };
    put_lanes(points.position, s.position);
    put_lanes(points.geometric_normal, s.geometric_normal);
    put_lanes(points.s, s.shading.s), put_lanes(points.t, s.shading.t);
    put_lanes(points.n, s.shading.n);
}

/// The surfaces of those of sixteen points whose shapes have no triangles.
void find_without_triangles(const TracedScene& traced, const RayLanes& rays, std::size_t i,
                            PacketLanes lanes, PointLanes& points) {
    /// Null where the point is found alone: other shapes, and where the texture coordinate is read.
    const auto sphere_of = [&](std::size_t k) {
        const auto bsdf = static_cast<std::size_t>(points.bsdf[i + k].value);
        const auto shape = static_cast<std::size_t>(rays.shape[points.sample[i + k]]);
        return traced.geometry->reads_uv[bsdf] || points.has_unknowns[i + k]
                   ? nullptr
                   : std::get_if<Sphere>(&traced.scene->shapes[shape].geometry);
    };
    for (std::size_t k = 0; k < kLanes; ++k) {
        if (!lanes[k]) continue;
        const Sphere* const sphere = sphere_of(k);
        if (!sphere) {
            put(surface_of(traced, rays, points.sample[i + k]), i + k, points);
            continue;
        }
        PacketLanes same{};
        for (std::size_t j = k; j < kLanes; ++j) same[j] = lanes[j] && sphere_of(j) == sphere;
        find_on_sphere(*sphere, rays, i, same, points);
        for (std::size_t j = k; j < kLanes; ++j) lanes[j] = lanes[j] && !same[j];
    }
}

/// The surfaces of sixteen points.
void find_surfaces(const TracedScene& traced, const RayLanes& rays, std::size_t i,
                   PointLanes& points) {
    static const TriangleRecord kNone{};
    std::array<const TriangleRecord*, kLanes> records;
    PacketLanes others;
    for (std::size_t k = 0; k < kLanes; ++k) {
        const std::size_t s = points.sample[i + k];
        const auto& mesh = traced.geometry->triangles[static_cast<std::size_t>(rays.shape[s])];
        records[k] = mesh.empty() ? &kNone : &mesh[static_cast<std::size_t>(rays.primitive[s])];
        others[k] = mesh.empty();
    }
    const std::uint16_t* samples = &points.sample[i];
    if (std::ranges::all_of(others, std::identity{}))
        put(SurfaceOf<Packet>{}, i, points);
    else
        put(triangle_surface(gather(records), gather(rays.u, samples), gather(rays.v, samples)), i,
            points);
    if (std::ranges::any_of(others, std::identity{}))
        find_without_triangles(traced, rays, i, others, points);
}

/// Turns the frames of the points whose materials have normal maps.
void turn_normals(const TraceInput& input, const RayLanes& rays, PointLanes& points) {
    const Scene& scene = *input.scene->scene;
    points.has_turned = false;
    for (std::size_t i = 0; i < points.count; ++i) {
        const auto& normals = scene[points.material[i]].normals;
        if (!normals) continue;
        points.has_turned = true;
        const Surface old{get(points.position, i),
                          get(points.geometric_normal, i),
                          {get(points.s, i), get(points.t, i), get(points.n, i)},
                          {points.u[i], points.v[i]}};
        const std::size_t sample = points.sample[i];
        const auto [frame, old_normal] =
            turned_frame(*normals, scene, *input.textures, hit_of(rays, sample), old,
                         get(rays.rays.direction, sample));
        set(points.old_normal, i, old_normal);
        set(points.s, i, frame.s), set(points.t, i, frame.t), set(points.n, i, frame.n);
    }
}

/// Directions back along the rays, and the sides that they meet.
void face_ray(const TracedScene& traced, const RayLanes& rays, std::size_t i, PointLanes& points) {
    const Vec3<Packet> direction = gather(rays.rays.direction, &points.sample[i]);
    Vec3<Packet> wi = to_local(load_frame(points, i), -direction);
    PacketLanes has_sides;
    for (std::size_t k = 0; k < has_sides.size(); ++k)
        has_sides[k] = (*traced.scene)[points.material[i + k]].has_sides();
    const Packet side =
        select(to_mask(has_sides) && wi.z < Packet(0.0f), Packet(-1.0f), Packet(1.0f));
    wi.z = wi.z * side;
    store(points.wi, i, wi);
    store(points.side, i, side);
}

/// One-sided surfaces show from behind only what they transmit.
bool can_be_lit(const Scene& scene, const PointLanes& points, std::size_t i) {
    const float z = points.wi.z[i];
    return z > 0 || (z < 0 && transmits(scene[points.bsdf[i]]));
}

}  // namespace

void find_points(const TraceInput& input, std::size_t count, const RayLanes& rays,
                 PointLanes& points) {
    const TracedScene& traced = *input.scene;
    sort_points(input, count, seen_bsdfs(input, count, rays), points);
    for (std::size_t i = 0; i < points.count; i += kLanes) find_surfaces(traced, rays, i, points);
    if (has_layers(*traced.scene)) turn_normals(input, rays, points);
    for (std::size_t i = 0; i < points.count; i += kLanes) face_ray(traced, rays, i, points);
    ActiveList lit;
    for (std::size_t k = 0; k < points.live.count; ++k)
        if (can_be_lit(*traced.scene, points, points.live.lane[k])) lit.add(points.live.lane[k]);
    points.live = lit;
}

void draw_uniforms(const TraceInput& input, std::span<const BatchSample> samples,
                   const PointLanes& points, Technique technique, std::uint32_t bounce,
                   std::array<Column, 4>& u) {
    for (std::size_t i = 0; i < points.count; i += kLanes) {
        const auto drawn =
            uniforms_of(input, names_of(input, samples, points, i), technique, bounce);
        for (std::size_t k = 0; k < 4; ++k) store(u[k], i, drawn[k]);
    }
}

void draw_choice(const TraceInput& input, std::span<const BatchSample> samples,
                 const PointLanes& points, std::uint32_t bounce, Column& u) {
    for (std::size_t i = 0; i < points.count; i += kLanes)
        store(u, i, choice_of(input, names_of(input, samples, points, i), bounce));
}

}  // namespace burnish
