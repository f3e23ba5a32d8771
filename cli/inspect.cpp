#include "cli/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "cli/console.h"
#include "cli/findings.h"
#include "core/stopwatch.h"
#include "core/variant.h"
#include "optimize/memory.h"
#include "render/render.h"

namespace burnish {

namespace {

/// Luminance averaged over the sphere: rows weigh with the sine of their polar angle.
double mean_radiance(const EnvironmentEmitter& environment) {
    const Image& image = *environment.image;
    double sum = 0, weights = 0;
    for (int y = 0; y < image.height; ++y) {
        const double weight = std::sin(std::numbers::pi * (y + 0.5) / image.height);
        for (int x = 0; x < image.width; ++x)
            sum += weight *
                   double{luminance(Rgbf{image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)})};
        weights += weight * image.width;
    }
    return double{environment.scale} * sum / weights;
}

/// Intensity over the beam, and half of it on average between beam and cutoff.
double power(const Scene& scene, const SpotEmitter& spot) {
    const auto cap = [](float degrees) {
        return 2 * std::numbers::pi * (1 - std::cos(double{degrees} * std::numbers::pi / 180));
    };
    return 0.5 * (cap(spot.beam_width) + cap(spot.cutoff)) *
           double{luminance(spot.intensity * mean_texture(scene, spot.texture))};
}

/// The irradiance that it gives at distance 1, over what it lights there.
double power(const Scene& scene, const ProjectorEmitter& projector) {
    const double width = 2 * std::tan(projector.fov_x * std::numbers::pi / 360);
    return std::numbers::pi * width * width / projector.aspect *
           double{luminance(projector.irradiance * mean_texture(scene, projector.texture))};
}

void add_light(const Scene& scene, const Emitter& emitter,
               std::map<std::string, LightFacts>& kinds) {
    const auto of_kind = [&](const char* kind) -> LightFacts& {
        LightFacts& facts = kinds[kind];
        facts.kind = kind;
        ++facts.count;
        return facts;
    };
    match(
        emitter,
        [&](const AreaEmitter& area) {
            LightFacts& facts = of_kind("area");
            const double size = area_of(scene[area.shape].geometry);
            facts.area += size;
            facts.power += std::numbers::pi * size * double{luminance(mean_radiance(scene, area))};
        },
        [&](const PointEmitter& point) {
            of_kind("point").power += 4 * std::numbers::pi * double{luminance(point.intensity)};
        },
        [&](const ConstantEmitter& constant) {
            of_kind("constant").mean_radiance = double{luminance(constant.radiance)};
        },
        [&](const EnvironmentEmitter& environment) {
            of_kind("environment").mean_radiance = mean_radiance(environment);
        },
        [&](const SpotEmitter& spot) { of_kind("spot").power += power(scene, spot); },
        [&](const DirectionalEmitter& light) {
            of_kind("directional").irradiance += double{luminance(light.irradiance)};
        },
        [&](const ProjectorEmitter& projector) {
            of_kind("projector").power += power(scene, projector);
        });
}

ParameterFacts facts_of(const Parameter& parameter, const Bitmap& bitmap) {
    const Image texels = linear_image(bitmap);
    const auto [low, high] = std::ranges::minmax(texels.values);
    const double sum = std::accumulate(texels.values.begin(), texels.values.end(), 0.0);
    return {.name = parameter.name,
            .file = bitmap.file,
            .width = bitmap.width,
            .height = bitmap.height,
            .channels = bitmap.channels,
            .filter = bitmap.filter,
            .wrap = bitmap.wrap,
            .raw = bitmap.raw,
            .low = double{low},
            .mean = sum / static_cast<double>(texels.values.size()),
            .high = double{high}};
}

constexpr int kProbe = 96;  // a grid of kProbe x kProbe camera rays

/// What the rays of a coarse picture meet.
struct Seen {
    std::vector<std::size_t> materials;  ///< rays per material
    std::size_t nothing = 0, black_back = 0;
};

CameraRay<float> probe_ray(const Film& film, const CameraRays& camera, int x, int y) {
    const Vec2f position{
        (static_cast<float>(film.crop_x) +
         (static_cast<float>(x) + 0.5f) / kProbe * static_cast<float>(film.crop_width)) /
            static_cast<float>(film.width),
        (static_cast<float>(film.crop_y) +
         (static_cast<float>(y) + 0.5f) / kProbe * static_cast<float>(film.crop_height)) /
            static_cast<float>(film.height)};
    return camera_ray<float>(camera, position);
}

void record(const Scene& scene, const TriangleTable& triangles, const Hit& hit,
            const CameraRay<float>& ray, Seen& seen) {
    if (hit.shape < 0) {
        ++seen.nothing;
        return;
    }
    const Shape& shape = scene.shapes[static_cast<std::size_t>(hit.shape)];
    ++seen.materials[static_cast<std::size_t>(shape.material.value)];
    const bool behind =
        dot(surface_at(scene, triangles, hit, ray.origin, ray.direction).geometric_normal,
            ray.direction) > 0;
    if (behind && !shape.emitter && has_black_back(scene, shape.material)) ++seen.black_back;
}

Seen look(const TracedScene& traced) {
    const Scene& scene = *traced.scene;
    Seen seen;
    seen.materials.assign(scene.materials.size(), 0);
    for (int first = 0; first < kProbe * kProbe; first += kPacketRays) {
        RayPacket rays;
        std::array<CameraRay<float>, kPacketRays> probes;
        for (std::size_t i = 0; i < kPacketRays; ++i) {
            const int at = first + static_cast<int>(i);
            probes[i] = probe_ray(traced.film, traced.camera, at % kProbe, at / kProbe);
            const CameraRay<float>& ray = probes[i];
            rays.valid[i] = -1;
            rays.origin_x[i] = ray.origin.x, rays.direction_x[i] = ray.direction.x;
            rays.origin_y[i] = ray.origin.y, rays.direction_y[i] = ray.direction.y;
            rays.origin_z[i] = ray.origin.z, rays.direction_z[i] = ray.direction.z;
            rays.max_distance[i] = ray.max_distance;  // below 0 nothing is hit
        }
        const HitPacket hits = camera_accel(*traced.geometry).intersect(rays, Coherence::kCoherent);
        for (std::size_t i = 0; i < kPacketRays; ++i)
            record(scene, traced.geometry->triangles,
                   {hits.shape[i], hits.primitive[i], hits.distance[i], hits.u[i], hits.v[i]},
                   probes[i], seen);
    }
    return seen;
}

double share_of(std::size_t rays) { return static_cast<double>(rays) / (kProbe * kProbe); }

/// Adds the share of a picture that shows each parameter, times a weight.
void add_shares(const Scene& scene, const Seen& seen, double weight, std::vector<double>& shares) {
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        const auto textures = textures_of(scene, MaterialId{static_cast<std::int32_t>(m)});
        for (std::size_t i = 0; i < scene.parameters.size(); ++i)
            if (std::count(textures.begin(), textures.end(), scene.parameters[i].texture) > 0)
                shares[i] += weight * share_of(seen.materials[m]);
    }
}

/// views: empty where the scene's own camera is the only one.
void add_what_is_seen(const TracedScene& traced, std::span<const TracedScene> views,
                      SceneFacts& facts) {
    const Scene& scene = *traced.scene;
    std::vector<double> pixels(scene.parameters.size());
    double all = 0, black_back = 0;
    for (const TracedScene& picture : views.empty() ? std::span(&traced, 1) : views) {
        const Seen seen = look(picture);
        const double size = pixels_of(picture.film);
        add_shares(scene, seen, size, pixels);
        all += size, black_back += size * share_of(seen.black_back);
        if (views.empty() && seen.nothing == kProbe * kProbe)
            facts.findings.push_back("the camera sees no shape at all");
    }
    for (std::size_t i = 0; i < pixels.size(); ++i) facts.parameters[i].seen = pixels[i] / all;
    if (black_back > 0)
        facts.findings.push_back(fmt::format(
            "{} of the picture{} the black back of a one-sided material: normals are flipped, "
            "<bsdf type=\"twosided\"> is missing, or the camera is inside an object",
            percent_text(black_back / all), views.size() > 1 ? "s show" : " shows"));
    const auto hidden = std::count(pixels.begin(), pixels.end(), 0.0);
    if (hidden > 0)
        facts.findings.push_back(fmt::format(
            "{} not show {} of the {} parameters (0.0 % above): they can hardly be recovered",
            views.empty() ? "a coarse picture does" : "coarse pictures of the views do", hidden,
            pixels.size()));
    check_resolution(scene, pixels, facts.findings);
}

void count_shapes(const Scene& scene, SceneFacts& facts) {
    for (const Shape& s : scene.shapes)
        match(
            s.geometry,
            [&](const Mesh& mesh) {
                ++facts.meshes;
                facts.triangles += mesh.triangles.size();
                facts.vertices += mesh.positions.size();
            },
            [&](const Sphere&) { ++facts.spheres; }, [&](const Disk&) { ++facts.disks; },
            [&](const Cylinder&) { ++facts.cylinders; },
            [&](const Instance&) { ++facts.instances; });
    for (const Shape& s : scene.prototypes)
        if (const Mesh* mesh = mesh_of(s.geometry)) {
            facts.triangles += mesh->triangles.size();
            facts.vertices += mesh->positions.size();
        }
}

}  // namespace

double seconds_of_a_pass(const TracedScene& traced) {
    constexpr double kMaxPixels = 2e5;
    Film film = traced.film;
    const double step = std::max(1.0, std::sqrt(pixels_of(film) / kMaxPixels));
    const auto smaller = [&](int side) { return std::max(1, static_cast<int>(side / step)); };
    film.width = smaller(film.width), film.height = smaller(film.height);
    film.crop_width = std::min(smaller(film.crop_width), film.width);
    film.crop_height = std::min(smaller(film.crop_height), film.height);
    film.crop_x = std::min(smaller(film.crop_x), film.width - film.crop_width);
    film.crop_y = std::min(smaller(film.crop_y), film.height - film.crop_height);
    const TracedScene small = with_camera(traced, traced.camera, film);
    const TextureTable textures{traced.scene->textures, {}};
    TraceInput input;
    input.scene = &small, input.textures = &textures, input.key = {0, Stream::kTrial};
    const Stopwatch watch;
    render(input, 0, 1);
    return watch.total() * pixels_of(traced.film) / pixels_of(film);
}

SceneFacts inspect(const TracedScene& traced, std::span<const TracedScene> views) {
    const Scene& scene = *traced.scene;
    SceneFacts facts;
    count_shapes(scene, facts);
    facts.memory = scene_memory(scene);
    for (const Parameter& p : scene.parameters)
        facts.parameters.push_back(facts_of(p, std::get<Bitmap>(scene[p.texture])));
    std::map<std::string, LightFacts> kinds;
    for (const Emitter& e : scene.emitters) add_light(scene, e, kinds);
    for (const auto& [kind, light] : kinds) facts.lights.push_back(light);
    check_lights(scene, facts.findings);
    check_meshes(scene, facts.findings);
    check_texture_coordinates(scene, facts.findings);
    check_textures(scene, facts.findings);
    check_overlaps(scene, facts.findings);
    check_shared_textures(scene, facts.findings);
    check_materials(scene, facts.findings);
    check_orientations(traced, facts.findings);
    check_places(scene, facts.findings);
    check_enclosed_lights(traced, facts.findings);
    add_what_is_seen(traced, views, facts);
    facts.seconds = seconds_of_a_pass(traced);
    return facts;
}

bool shows_a_shape(const TracedScene& view) { return look(view).nothing < kProbe * kProbe; }

const char* name_of(TextureFilter filter) {
    return filter == TextureFilter::kNearest ? "nearest" : "bilinear";
}

const char* name_of(TextureWrap wrap) {
    switch (wrap) {
        case TextureWrap::kRepeat:
            return "repeat";
        case TextureWrap::kMirror:
            return "mirror";
        case TextureWrap::kClamp:
            return "clamp";
    }
    return "";
}

const char* name_of(FilterKind filter) {
    switch (filter) {
        case FilterKind::kBox:
            return "box";
        case FilterKind::kTent:
            return "tent";
        case FilterKind::kGaussian:
            return "gaussian";
        case FilterKind::kMitchell:
            return "mitchell";
        case FilterKind::kCatmullRom:
            return "catmullrom";
        case FilterKind::kLanczos:
            return "lanczos";
    }
    return "";
}

}  // namespace burnish
