#include "paths/primary_rays.h"

#include <cmath>
#include <limits>
#include <memory>

#include "core/random_packet.h"
#include "paths/light_columns.h"
#include "shading/fresnel.h"

namespace burnish {

namespace {

/// The film offsets of the passes in a batch: few passes, many samples.
class FilmOffsets {
  public:
    FilmOffsets(RandomKey key, Sequence sequence) : key_(key), sequence_(sequence) {}
    const Vec2f& operator[](std::uint32_t film_pass) {
        Entry& entry = entries_[film_pass % entries_.size()];
        if (!entry.known || entry.film_pass != film_pass)
            entry = {true, film_pass, film_offset(key_, film_pass, sequence_)};
        return entry.offset;
    }

  private:
    struct Entry {
        bool known = false;
        std::uint32_t film_pass = 0;
        Vec2f offset;
    };
    RandomKey key_;
    Sequence sequence_;
    std::array<Entry, 32> entries_;
};

void place_on_film(const TraceInput& input, std::span<const BatchSample> samples,
                   FilmLanes& place) {
    const Film& film = input.scene->film;
    const auto width = static_cast<std::uint32_t>(film.crop_width);
    const float scale_x = 1 / static_cast<float>(film.width),
                scale_y = 1 / static_cast<float>(film.height);
    const auto x0 = static_cast<float>(film.crop_x), y0 = static_cast<float>(film.crop_y);
    FilmOffsets offsets(input.key, input.sequence);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const CameraSample& s = samples[i].camera;
        place.film_pass[i] = film_pass(s, input.passes_per_iteration);
        const Vec2f& offset = offsets[place.film_pass[i]];
        place.x[i] = (static_cast<float>(s.pixel % width) + offset.x + x0) * scale_x;
        place.y[i] = (static_cast<float>(s.pixel / width) + offset.y + y0) * scale_y;
    }
    for (std::size_t i = samples.size(); i < padded(samples.size()); ++i)
        place.x[i] = place.y[i] = 0.5f;
}

/// Where sixteen samples pass a thin lens: numbers of their own, so that a pinhole's stay.
Vec2<Packet> aperture_numbers(const TraceInput& input, std::span<const BatchSample> samples,
                              std::size_t first) {
    if (!has_aperture(input.scene->camera)) return {Packet(0.0f), Packet(0.0f)};
    LaneIntegers pixel, iteration, pass;
    for (int k = 0; k < kLanes; ++k) {
        const std::size_t i = std::min(first + static_cast<std::size_t>(k), samples.size() - 1);
        const CameraSample& s = samples[i].camera;
        set(pixel, k, s.pixel), set(iteration, k, s.iteration), set(pass, k, s.pass);
    }
    const auto u = uniforms(aperture_key(input.key), pixel, iteration, pass);
    return {u[0], u[1]};
}

/// The primary rays of sixteen samples.
CameraRay<Packet> primary_ray(const TraceInput& input, std::span<const BatchSample> samples,
                              const FilmLanes& film, std::size_t i, RayLanes& primary) {
    const auto ray = camera_ray(input.scene->camera, Vec2<Packet>{load(film.x, i), load(film.y, i)},
                                aperture_numbers(input, samples, i));
    store(primary.rays.origin, i, ray.origin);
    store(primary.rays.direction, i, ray.direction);
    store(primary.rays.max_distance, i, ray.max_distance);
    return ray;
}

void trace_from_film(const TraceInput& input, std::span<const BatchSample> samples,
                     const FilmLanes& film, RayLanes& primary) {
    const TracedScene& scene = *input.scene;
    const Accel& accel = camera_accel(*scene.geometry);
    const std::size_t count = samples.size();
    for (std::size_t i = 0; i < count; i += kLanes) {
        const auto ray = primary_ray(input, samples, film, i, primary);
        const int live = static_cast<int>(std::min<std::size_t>(kLanes, count - i));
        const RayPacket packet = make_packet(ray.origin, ray.direction, ray.max_distance, live);
        const HitPacket hits = accel.intersect(packet, Coherence::kCoherent);
        std::copy(hits.shape.begin(), hits.shape.end(), &primary.shape[i]);
        std::copy(hits.primitive.begin(), hits.primitive.end(), &primary.primitive[i]);
        store(primary.distance, i, load(hits.distance.data()));
        store(primary.u, i, load(hits.u.data()));
        store(primary.v, i, load(hits.v.data()));
        for (std::size_t k = 0; k < kPacketRays; ++k)
            if (packet.valid[k])
                prefetch(scene.geometry->triangles, hits.shape[k], hits.primitive[k]);
    }
}

/// The light that samples see directly.
void see_lights(const TraceInput& input, std::size_t count, const RayLanes& rays,
                std::span<Rgbf> emitted) {
    std::fill(emitted.begin(), emitted.end(), Rgbf{});
    const Lights& lights = *input.scene->lights;
    if (input.choice == SurfaceChoice::kUnknown || input.scene->scene->hide_emitters) return;
    ActiveList missed;
    for (std::size_t i = 0; i < count; ++i) {
        if (rays.rays.max_distance[i] < 0) continue;  // outside of the lens's field
        if (rays.shape[i] < 0)
            missed.add(i);
        else if (lights.of_shape[static_cast<std::size_t>(rays.shape[i])])
            emitted[i] = emission_at_hit(lights, hit_of(rays, i), get(rays.rays.origin, i),
                                         get(rays.rays.direction, i))
                             .radiance;
    }
    ColumnVec3 radiance;
    Column pdf;
    emission_at_infinity(lights, rays.rays.origin, rays.rays.direction, missed, radiance, pdf);
    for (std::size_t k = 0; k < missed.count; ++k)
        emitted[missed.lane[k]] = get(radiance, missed.lane[k]);
}

/// The share of a ray that a surface lets through straight on, as if it were not there.
float passed_share(const Bsdf& bsdf, float cosine) {
    const Dielectric* pane = pane_of(bsdf);
    if (!pane) return 0;
    const float r = fresnel_dielectric(std::abs(cosine), pane->eta).reflectance;
    return 1 - 2 * r / (1 + r);
}

/// Takes a ray on behind the pane that it meets, if it is one. passed: times what goes through.
/// Where a normal map leaves nothing of that, the path ends as where it meets nothing.
bool pass_pane(const TraceInput& input, const SeenBsdfs& seen, std::size_t i, RayLanes& rays,
               float& passed) {
    if (!seen[i]) return false;  // black
    const Scene& scene = *input.scene->scene;
    const Vec3f direction = get(rays.rays.direction, i);
    const Surface s = surface_of(*input.scene, rays, i);
    const auto& map = scene[seen.shown[i].material].normals;
    const TurnedFrame turned =
        map ? turned_frame(*map, scene, *input.textures, hit_of(rays, i), s, direction)
            : TurnedFrame{s.shading, s.shading.n};
    const float share = passed_share(scene[seen[i]], dot(turned.shading.n, direction));
    if (share <= 0) return false;
    passed *= share;
    if (map && share_of_light(*map, turned.old_normal, turned.shading.n, direction) <= 0) {
        rays.shape[i] = -1;
        return false;
    }
    set(rays.rays.origin, i, leave_surface(s.position, s.geometric_normal, direction));
    rays.rays.max_distance[i] = std::numeric_limits<float>::infinity();
    return true;
}

/// Takes the rays that meet panes on to what is behind, as far as paths go. passed: of each the
/// share that does. What a ray meets where paths end counts as no surface, but for lamps: no path
/// goes on from it.
void pass_panes(const TraceInput& input, std::size_t count, RayLanes& rays, Column& passed) {
    const auto max_depth = static_cast<std::uint32_t>(input.scene->scene->max_depth);
    ActiveList onward;
    for (std::size_t i = 0; i < count; ++i) onward.add(i);
    for (std::uint32_t depth = 1; onward.count > 0; ++depth) {
        if (depth == max_depth) {
            const auto& emitters = input.scene->lights->of_shape;
            for (std::size_t k = 0; k < onward.count; ++k) {
                auto& shape = rays.shape[onward.lane[k]];
                if (shape >= 0 && !emitters[static_cast<std::size_t>(shape)]) shape = -1;
            }
            return;
        }
        const SeenBsdfs seen = seen_bsdfs(input, count, rays);
        onward.count = 0;
        for (std::size_t i = 0; i < count; ++i)
            if (rays.shape[i] >= 0 && pass_pane(input, seen, i, rays, passed[i])) onward.add(i);
        for (std::size_t first = 0; first < onward.count; first += kPacketRays) {
            const ColumnIndices lanes = indices(onward, first);
            const HitPacket hits = input.scene->geometry->accel.intersect(gather(rays.rays, lanes),
                                                                          Coherence::kIncoherent);
            for (std::size_t k = 0; k < static_cast<std::size_t>(lanes.live); ++k)
                set_hit(rays, lanes.at[k], hit_of(hits, k));
        }
    }
}

}  // namespace

void trace_primary_rays(const TraceInput& input, std::span<const BatchSample> samples,
                        FilmLanes& film, RayLanes& primary, std::span<Rgbf> emitted) {
    place_on_film(input, samples, film);
    trace_from_film(input, samples, film, primary);
    see_lights(input, samples.size(), primary, emitted);
}

void repeat_primary_rays(const TraceInput& input, std::span<const BatchSample> samples,
                         std::span<const Hit> hits, FilmLanes& film, RayLanes& primary) {
    place_on_film(input, samples, film);
    for (std::size_t i = 0; i < samples.size(); i += kLanes)
        primary_ray(input, samples, film, i, primary);
    for (std::size_t i = 0; i < hits.size(); ++i) set_hit(primary, i, hits[i]);
}

void trace_coverage(const TraceInput& input, std::span<const BatchSample> samples,
                    std::span<Rgbf> seen) {
    struct Memory {
        FilmLanes film;
        RayLanes rays;
        Column passed;
    };
    thread_local const auto memory = std::make_unique<Memory>();  // scratch memory only
    place_on_film(input, samples, memory->film);
    RayLanes& rays = memory->rays;
    trace_from_film(input, samples, memory->film, rays);
    Column& passed = memory->passed;
    for (std::size_t i = 0; i < samples.size(); ++i)
        passed[i] = rays.rays.max_distance[i] >= 0 ? 1.0f : 0.0f;
    const Scene& scene = *input.scene->scene;
    const bool has_paths = scene.max_depth > 0;  // without any nothing is seen
    const bool sky = input.scene->lights->infinite && !scene.hide_emitters && !scene.direct_alpha;
    if (has_paths && !scene.direct_alpha && !sky) pass_panes(input, samples.size(), rays, passed);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const bool ends = rays.shape[i] >= 0 || sky, has_ray = rays.rays.max_distance[i] >= 0;
        seen[i] = {has_paths && has_ray ? (ends ? 1 : 1 - passed[i]) : 0, 1, 0};
    }
}

}  // namespace burnish
