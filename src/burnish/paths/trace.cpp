#include "burnish/paths/trace.h"

#include <cmath>
#include <limits>

#include "burnish/core/packet.h"
#include "burnish/shading/diffuse.h"
#include "burnish/shading/principled.h"

namespace burnish {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Shadow rays stop this far before the light, relative to the distance: ten times the offset of
/// leave_surface.
constexpr float kShadowShortening = 8.9e-4f;

using Lane = std::array<float, kBatchSamples>;
struct LaneVec3 {
    alignas(64) Lane x, y, z;
    void set(std::size_t i, const Vec3f& v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
    Vec3f get(std::size_t i) const { return {x[i], y[i], z[i]}; }
    Vec3<Packet> load_packet(std::size_t i) const {
        return {load(&x[i]), load(&y[i]), load(&z[i])};
    }
    void store_packet(std::size_t i, const Vec3<Packet>& v) {
        store(&x[i], v.x), store(&y[i], v.y), store(&z[i], v.z);
    }
};

/// A surface that scatters: one lane of the shading stages.
struct ScatterPoint {
    int sample = 0;
    Surface surface;
    Vec3f wi_local;
    float side = 1;  ///< -1: a two-sided material seen from behind; local z is mirrored
    BsdfId bsdf;
    bool dynamic = false;
};

/// The stages' shared memory: one per thread, reused from batch to batch.
struct Workspace {
    std::vector<ScatterPoint> points[std::variant_size_v<Bsdf>];  // by kind of BSDF
    LaneVec3 wi, wo, f;
    alignas(64) Lane pdf, u_lobe, u_x, u_y;
    alignas(64) Lane parameters[14];
    std::array<LightSample, kBatchSamples> light;
    std::array<char, kBatchSamples> live;
    std::array<LightChoice, kBatchSamples> choice;
    std::array<std::uint32_t, kBatchSamples> film_pass;
};

std::array<float, 4> draw_uniforms(const TraceInput& input, const CameraSample& s,
                                   Technique technique) {
    return uniforms(input.key, s.pixel, s.iteration,
                    s.pass * kTechniques + static_cast<std::uint32_t>(technique));
}

// ---- Primary rays
// ----------------------------------------------------------------------------------------

void set_ray(RayPacket& packet, int lane, const Vec3f& origin, const Vec3f& direction,
             float max_distance) {
    const auto i = static_cast<std::size_t>(lane);
    packet.valid[i] = -1;
    packet.origin_x[i] = origin.x, packet.origin_y[i] = origin.y, packet.origin_z[i] = origin.z;
    packet.direction_x[i] = direction.x, packet.direction_y[i] = direction.y,
    packet.direction_z[i] = direction.z;
    packet.max_distance[i] = max_distance;
}

void clear_rays(RayPacket& packet) {
    packet.valid.fill(0);
    for (auto* a : {&packet.origin_x, &packet.origin_y, &packet.origin_z, &packet.direction_x,
                    &packet.direction_y, &packet.max_distance})
        a->fill(0);
    packet.direction_z.fill(1);
}

/// The side that the camera sees, or nothing where it is black.
bool scatters(const Scene& scene, const Material& material, ScatterPoint& p) {
    const bool front = p.wi_local.z > 0;
    if (p.wi_local.z == 0) return false;
    if (front) {
        p.bsdf = material.front;
        return true;
    }
    if (material.back) {
        p.bsdf = material.back;
        p.side = -1;
        p.wi_local.z = -p.wi_local.z;
        return true;
    }
    p.bsdf = material.front;  // one-sided: only transmission shows behind
    const auto* principled = std::get_if<Principled>(&scene[material.front]);
    return principled && principled->has_spec_trans;
}

bool chosen(SurfaceChoice choice, bool dynamic) {
    return choice == SurfaceChoice::kAll || (choice == SurfaceChoice::kDynamic) == dynamic;
}

/// Adds the light seen directly, and the surface to the list of its BSDF's kind.
void meet_surface(const TraceInput& input, const Ray& ray, const Hit& hit, int sample,
                  BatchOutput& out, Workspace& w) {
    const Scene& scene = *input.scene->scene;
    const bool takes_static = input.choice != SurfaceChoice::kDynamic;
    if (hit.shape < 0) {
        if (takes_static && !scene.hide_emitters)
            out.emitted[static_cast<std::size_t>(sample)] =
                emission_at_infinity(input.scene->lights, ray.direction).radiance;
        return;
    }
    const Shape& shape = scene.shapes[static_cast<std::size_t>(hit.shape)];
    if (shape.emitter && takes_static && !scene.hide_emitters)
        out.emitted[static_cast<std::size_t>(sample)] =
            emission_at_hit(input.scene->lights, hit, ray.origin, ray.direction).radiance;

    ScatterPoint p;
    p.sample = sample;
    const Material& material = scene[shape.material];
    if (!input.dynamic_bsdfs.empty() && input.choice != SurfaceChoice::kAll) {
        const auto is_dynamic = [&](BsdfId id) {
            return id && input.dynamic_bsdfs[static_cast<std::size_t>(id.value)];
        };
        if (!chosen(input.choice, is_dynamic(material.front)) &&
            !chosen(input.choice, is_dynamic(material.back)))
            return;  // neither side can matter: skip the surface
    }
    p.surface = surface_at(scene, *input.scene->triangles, hit, ray.origin, ray.direction);
    p.wi_local = to_local(p.surface.shading, -ray.direction);
    if (!scatters(scene, material, p)) return;
    p.dynamic = !input.dynamic_bsdfs.empty() &&
                input.dynamic_bsdfs[static_cast<std::size_t>(p.bsdf.value)] != 0;
    if (chosen(input.choice, p.dynamic)) w.points[scene[p.bsdf].index()].push_back(p);
}

/// Film positions of the samples as fractions of the whole film, in w.u_x and w.u_y.
void place_on_film(const TraceInput& input, std::span<const BatchSample> samples, Workspace& w) {
    const Film& film = input.scene->scene->film;
    const auto width = static_cast<std::uint32_t>(film.crop_width);
    const float scale_x = 1 / static_cast<float>(film.width),
                scale_y = 1 / static_cast<float>(film.height);
    const auto x0 = static_cast<float>(film.crop_x), y0 = static_cast<float>(film.crop_y);
    std::uint32_t pass = 0;
    Vec2f offset;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const CameraSample& s = samples[i].camera;
        w.film_pass[i] = film_pass(s, input.passes_per_iteration);
        if (i == 0 || w.film_pass[i] != pass) offset = film_offset(input.key, w.film_pass[i]);
        pass = w.film_pass[i];
        w.u_x[i] = (static_cast<float>(s.pixel % width) + offset.x + x0) * scale_x;
        w.u_y[i] = (static_cast<float>(s.pixel / width) + offset.y + y0) * scale_y;
    }
}

/// The camera's rays of 16 samples; lanes from n on are dead.
RayPacket camera_packet(const CameraRays& camera, const Workspace& w, std::size_t first,
                        std::size_t n) {
    const auto ray = camera_ray(camera, Vec2<Packet>{load(&w.u_x[first]), load(&w.u_y[first])});
    RayPacket packet;
    for (std::size_t k = 0; k < kPacketRays; ++k) packet.valid[k] = k < n ? -1 : 0;
    store(packet.origin_x.data(), ray.origin.x);
    store(packet.origin_y.data(), ray.origin.y);
    store(packet.origin_z.data(), ray.origin.z);
    store(packet.direction_x.data(), ray.direction.x);
    store(packet.direction_y.data(), ray.direction.y);
    store(packet.direction_z.data(), ray.direction.z);
    store(packet.max_distance.data(), ray.max_distance);
    return packet;
}

void trace_primary(const TraceInput& input, std::span<const BatchSample> samples, BatchOutput& out,
                   Workspace& w) {
    place_on_film(input, samples, w);
    const TriangleTable& triangles = *input.scene->triangles;
    for (std::size_t first = 0; first < samples.size(); first += kPacketRays) {
        const std::size_t n = std::min<std::size_t>(kPacketRays, samples.size() - first);
        const RayPacket rays = camera_packet(input.scene->camera, w, first, n);
        const HitPacket hits = input.scene->accel.intersect(rays, Coherence::kCoherent);
        for (std::size_t k = 0; k < n; ++k) {
            if (hits.shape[k] < 0) continue;
            const auto& records = triangles[static_cast<std::size_t>(hits.shape[k])];
            if (!records.empty()) prefetch(records[static_cast<std::size_t>(hits.primitive[k])]);
        }
        for (std::size_t k = 0; k < n; ++k) {
            const Ray ray{{rays.origin_x[k], rays.origin_y[k], rays.origin_z[k]},
                          {rays.direction_x[k], rays.direction_y[k], rays.direction_z[k]},
                          rays.max_distance[k]};
            meet_surface(input, ray,
                         {hits.shape[k], hits.primitive[k], hits.distance[k], hits.u[k], hits.v[k]},
                         static_cast<int>(first + k), out, w);
        }
    }
}

// ---- BSDF parameters of a list of points, as packets
// -------------------------------------------------------

struct PrincipledFlags {
    bool spec_trans = false, clearcoat = false, sheen = false, flatness = false, spec_tint = false,
         anisotropic = false;
};

/// Looks up every parameter of every point into w.parameters; the flags say which lobes any point
/// has.
PrincipledFlags load_principled(const TraceInput& input, const std::vector<ScatterPoint>& points,
                                Workspace& w) {
    const Scene& scene = *input.scene->scene;
    std::array<const Principled*, kBatchSamples> bsdfs;
    PrincipledFlags flags;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& bsdf = std::get<Principled>(scene[points[i].bsdf]);
        bsdfs[i] = &bsdf;
        w.parameters[13][i] = bsdf.eta;
        flags.spec_trans |= bsdf.has_spec_trans, flags.clearcoat |= bsdf.has_clearcoat;
        flags.sheen |= bsdf.has_sheen, flags.flatness |= bsdf.has_flatness;
        flags.spec_tint |= bsdf.has_spec_tint, flags.anisotropic |= bsdf.has_anisotropic;
    }
    // One parameter at a time: in a short loop the look-ups of many points wait for memory
    // together.
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Rgbf base = eval_color(*input.textures, bsdfs[i]->base_color, points[i].surface.uv);
        w.parameters[0][i] = base.x, w.parameters[1][i] = base.y, w.parameters[2][i] = base.z;
    }
    for (std::size_t k = 0; k < kPrincipledScalars; ++k)
        for (std::size_t i = 0; i < points.size(); ++i)
            w.parameters[3 + k][i] =
                eval_scalar(*input.textures, bsdfs[i]->scalars[k], points[i].surface.uv);
    return flags;
}

/// Evaluates, samples and weighs one kind of BSDF for 16 lanes at a time.
struct PrincipledPackets {
    const Workspace& w;
    PrincipledFlags flags;

    PrincipledParameters<Packet> at(std::size_t i) const {
        PrincipledParameters<Packet> p;
        const auto lane = [&](std::size_t k) { return load(&w.parameters[k][i]); };
        p.base_color = {lane(0), lane(1), lane(2)};
        p.roughness = lane(3), p.anisotropic = lane(4), p.metallic = lane(5),
        p.spec_trans = lane(6);
        p.spec_tint = lane(7), p.sheen = lane(8), p.sheen_tint = lane(9), p.flatness = lane(10);
        p.clearcoat = lane(11), p.clearcoat_gloss = lane(12), p.eta = lane(13);
        p.has_spec_trans = flags.spec_trans, p.has_clearcoat = flags.clearcoat,
        p.has_sheen = flags.sheen;
        p.has_flatness = flags.flatness, p.has_spec_tint = flags.spec_tint,
        p.has_anisotropic = flags.anisotropic;
        return p;
    }
    Rgb<Packet> eval(std::size_t i, const Vec3<Packet>& wi, const Vec3<Packet>& wo) const {
        return eval_principled(at(i), wi, wo);
    }
    Packet pdf(std::size_t i, const Vec3<Packet>& wi, const Vec3<Packet>& wo) const {
        return pdf_principled(at(i), wi, wo);
    }
    auto sample(std::size_t i, const Vec3<Packet>& wi, const Vec2<Packet>& u,
                const Packet& u_lobe) const {
        return sample_principled(at(i), wi, u, u_lobe);
    }
};

void load_diffuse(const TraceInput& input, const std::vector<ScatterPoint>& points, Workspace& w) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& bsdf = std::get<Diffuse>((*input.scene->scene)[points[i].bsdf]);
        const Rgbf r = eval_color(*input.textures, bsdf.reflectance, points[i].surface.uv);
        w.parameters[0][i] = r.x, w.parameters[1][i] = r.y, w.parameters[2][i] = r.z;
    }
}

struct DiffusePackets {
    const Workspace& w;

    DiffuseParameters<Packet> at(std::size_t i) const {
        return {{load(&w.parameters[0][i]), load(&w.parameters[1][i]), load(&w.parameters[2][i])}};
    }
    Rgb<Packet> eval(std::size_t i, const Vec3<Packet>& wi, const Vec3<Packet>& wo) const {
        return eval_diffuse(at(i), wi, wo);
    }
    Packet pdf(std::size_t i, const Vec3<Packet>& wi, const Vec3<Packet>& wo) const {
        return pdf_diffuse(at(i), wi, wo);
    }
    auto sample(std::size_t i, const Vec3<Packet>& wi, const Vec2<Packet>& u, const Packet&) const {
        return sample_diffuse(at(i), wi, u);
    }
};

// ---- Draws
// -------------------------------------------------------------------------------------------------

Vec3f direction_to_local(const ScatterPoint& p, const Vec3f& world) {
    Vec3f local = to_local(p.surface.shading, world);
    local.z *= p.side;
    return local;
}

Vec3f direction_to_world(const ScatterPoint& p, Vec3f local) {
    local.z *= p.side;
    return to_world(p.surface.shading, local);
}

/// Whether a ray for this lane can matter: its value is not zero, or its derivative may not be.
bool worth_tracing(const TraceInput& input, const Workspace& w, const ScatterPoint& p,
                   std::size_t lane) {
    if (!is_black(w.f.get(lane))) return true;
    if (!input.keep_black || !p.dynamic) return false;
    if (w.wo.z[lane] > 0) return true;
    const auto* principled = std::get_if<Principled>(&(*input.scene->scene)[p.bsdf]);
    return principled && principled->has_spec_trans;
}

void push_draw(const TraceInput& input, const Workspace& w, std::span<const BatchSample> samples,
               const ScatterPoint& p, Technique technique, std::size_t lane,
               const Rgbf& radiance_over_pdf, BatchOutput& out) {
    const Rgbf value = w.f.get(lane) * radiance_over_pdf;
    if (is_black(value) && !(input.keep_black && p.dynamic)) return;
    if (!is_finite(value)) {
        ++out.rejected;
        return;
    }
    const auto s = static_cast<std::size_t>(p.sample);
    PathRecord record{samples[s].camera.pixel, technique,        p.bsdf,
                      w.film_pass[s],          p.surface.uv,     w.wi.get(lane),
                      w.wo.get(lane),          radiance_over_pdf};
    out.draws.push_back({p.sample, record, value, p.dynamic});
}

/// Traces a packet's shadow rays and keeps the draws that arrive.
struct ShadowRays {
    const TraceInput& input;
    std::span<const BatchSample> samples;
    const std::vector<ScatterPoint>& points;
    const Workspace& w;
    BatchOutput& out;
    RayPacket packet;
    std::array<std::size_t, kPacketRays> lanes{};
    std::array<Rgbf, kPacketRays> radiance_over_pdf{};
    int count = 0;

    void add(std::size_t lane, const Rgbf& radiance) {
        const LightSample& light = w.light[lane];
        const Surface& s = points[lane].surface;
        const Vec3f origin = leave_surface(s.position, s.geometric_normal, light.direction_world);
        if (count == 0) clear_rays(packet);
        // The direction to the light's point, from the origin that was moved off the surface.
        if (std::isinf(light.distance)) {
            set_ray(packet, count, origin, light.direction_world, kInfinity);
        } else {
            const Vec3f to_light = s.position + light.direction_world * light.distance - origin;
            const float distance = length(to_light);
            set_ray(packet, count, origin, to_light * (1 / distance),
                    distance * (1 - kShadowShortening));
        }
        lanes[static_cast<std::size_t>(count)] = lane;
        radiance_over_pdf[static_cast<std::size_t>(count)] = radiance;
        if (++count == kPacketRays) flush();
    }
    void flush() {
        if (count == 0) return;
        const auto blocked = input.scene->accel.occluded(packet, Coherence::kIncoherent);
        for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
            if (!blocked[k])
                push_draw(input, w, samples, points[lanes[k]], Technique::kEmitter, lanes[k],
                          radiance_over_pdf[k], out);
        count = 0;
    }
};

template <class Packets>
void draw_emitters(const TraceInput& input, std::span<const BatchSample> samples,
                   const std::vector<ScatterPoint>& points, const Packets& bsdf, Workspace& w,
                   BatchOutput& out) {
    // Choosing all lights before looking at any lets their memory arrive in the meantime.
    for (std::size_t i = 0; i < points.size(); ++i) {
        const CameraSample& camera = samples[static_cast<std::size_t>(points[i].sample)].camera;
        w.choice[i] =
            choose_light(input.scene->lights, draw_uniforms(input, camera, Technique::kEmitter));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        w.light[i] =
            samples[static_cast<std::size_t>(points[i].sample)].emitter
                ? sample_light(input.scene->lights, w.choice[i], points[i].surface.position)
                : LightSample{};
        w.wo.set(i, direction_to_local(points[i], w.light[i].direction_world));
    }
    for (std::size_t i = 0; i < points.size(); i += kLanes) {
        const Vec3<Packet> wi = w.wi.load_packet(i), wo = w.wo.load_packet(i);
        w.f.store_packet(i, bsdf.eval(i, wi, wo));
        store(&w.pdf[i], bsdf.pdf(i, wi, wo));
    }
    ShadowRays shadows{input, samples, points, w, out, {}, {}, {}, 0};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const LightSample& light = w.light[i];
        if (!(light.pdf > 0) || is_black(light.radiance)) continue;
        if (!worth_tracing(input, w, points[i], i)) continue;
        const float pdf_bsdf = light.delta ? 0.0f : w.pdf[i];
        shadows.add(i, light.radiance * (1 / (light.pdf + pdf_bsdf)));
    }
    shadows.flush();
}

/// Radiance that a BSDF draw finds at its end.
EmissionSample emission_found(const TraceInput& input, const HitPacket& hits, const RayPacket& rays,
                              std::size_t k, const Vec3f& position) {
    const Vec3f direction{rays.direction_x[k], rays.direction_y[k], rays.direction_z[k]};
    if (hits.shape[k] < 0) return emission_at_infinity(input.scene->lights, direction);
    const Hit hit{hits.shape[k], hits.primitive[k], hits.distance[k], hits.u[k], hits.v[k]};
    return emission_at_hit(input.scene->lights, hit, position, direction);
}

template <class Packets>
void draw_bsdfs(const TraceInput& input, std::span<const BatchSample> samples,
                const std::vector<ScatterPoint>& points, const Packets& bsdf, Workspace& w,
                BatchOutput& out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const BatchSample& s = samples[static_cast<std::size_t>(points[i].sample)];
        const auto u = draw_uniforms(input, s.camera, Technique::kBsdf);
        w.u_x[i] = u[0], w.u_y[i] = u[1], w.u_lobe[i] = u[2];
    }
    for (std::size_t i = 0; i < points.size(); i += kLanes) {
        const Vec3<Packet> wi = w.wi.load_packet(i);
        const auto drawn =
            bsdf.sample(i, wi, {load(&w.u_x[i]), load(&w.u_y[i])}, load(&w.u_lobe[i]));
        w.wo.store_packet(i, drawn.wo_local);
        w.f.store_packet(i, bsdf.eval(i, wi, drawn.wo_local));
        store(&w.pdf[i], drawn.pdf);
        for (int k = 0; k < kLanes; ++k)
            w.live[i + static_cast<std::size_t>(k)] = get(drawn.valid, k);
    }
    RayPacket packet;
    std::array<std::size_t, kPacketRays> lanes;
    std::size_t count = 0;
    const auto flush = [&] {
        if (count == 0) return;
        const HitPacket hits = input.scene->accel.intersect(packet, Coherence::kIncoherent);
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t i = lanes[k];
            const EmissionSample e =
                emission_found(input, hits, packet, k, points[i].surface.position);
            if (is_black(e.radiance)) continue;
            push_draw(input, w, samples, points[i], Technique::kBsdf, i,
                      e.radiance * (1 / (e.pdf + w.pdf[i])), out);
        }
        count = 0;
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!w.live[i] || !samples[static_cast<std::size_t>(points[i].sample)].bsdf ||
            !(w.pdf[i] > 0))
            continue;
        if (!worth_tracing(input, w, points[i], i)) continue;
        const Surface& s = points[i].surface;
        const Vec3f direction = direction_to_world(points[i], w.wo.get(i));
        if (count == 0) clear_rays(packet);
        set_ray(packet, static_cast<int>(count),
                leave_surface(s.position, s.geometric_normal, direction), direction, kInfinity);
        lanes[count] = i;
        if (++count == kPacketRays) flush();
    }
    flush();
}

/// Fills the lanes behind the last point with copies of it: packets never hold undefined lanes.
void load_directions(const std::vector<ScatterPoint>& points, Workspace& w) {
    for (std::size_t i = 0; i < points.size(); ++i) w.wi.set(i, points[i].wi_local);
    const std::size_t padded = (points.size() + kLanes - 1) / kLanes * kLanes;
    for (std::size_t i = points.size(); i < padded; ++i) {
        w.wi.set(i, points.back().wi_local);
        w.wo.set(i, points.back().wi_local);
        for (auto& parameter : w.parameters) parameter[i] = parameter[points.size() - 1];
        w.u_x[i] = w.u_y[i] = w.u_lobe[i] = 0.5f;
    }
}

template <class Packets>
void draw(const TraceInput& input, std::span<const BatchSample> samples,
          const std::vector<ScatterPoint>& points, const Packets& bsdf, Workspace& w,
          BatchOutput& out) {
    load_directions(points, w);
    if (!input.scene->scene->emitters.empty()) {
        draw_emitters(input, samples, points, bsdf, w, out);
        draw_bsdfs(input, samples, points, bsdf, w, out);
    }
}

}  // namespace

TracedScene prepare(const Scene& scene) {
    auto triangles = std::make_unique<const TriangleTable>(make_triangle_table(scene));
    Lights lights = build_lights(scene, *triangles);
    return {&scene, Accel(scene), std::move(triangles), std::move(lights),
            make_camera_rays(scene.camera, scene.film)};
}

void trace_batch(const TraceInput& input, std::span<const BatchSample> samples, BatchOutput& out) {
    thread_local Workspace w;  // scratch memory only: nothing in it outlives the call
    out.emitted.assign(samples.size(), Rgbf{});
    out.draws.clear();
    out.rejected = 0;
    for (auto& list : w.points) list.clear();
    trace_primary(input, samples, out, w);
    if (const auto& points = w.points[0]; !points.empty()) {
        load_diffuse(input, points, w);
        draw(input, samples, points, DiffusePackets{w}, w, out);
    }
    if (const auto& points = w.points[1]; !points.empty()) {
        const PrincipledFlags flags = load_principled(input, points, w);
        draw(input, samples, points, PrincipledPackets{w, flags}, w, out);
    }
}

}  // namespace burnish
