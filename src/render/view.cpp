#include "render/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "burnish/error.h"
#include "burnish/photograph.h"
#include "core/parsed.h"
#include "core/require.h"
#include "core/variant.h"
#include "image/image.h"
#include "image/texels.h"
#include "image/whole.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

/// What names a sensor of a scene.
std::string expected_sensor(const std::vector<SceneSensor>& sensors) {
    std::vector<std::string> ids;
    for (const SceneSensor& s : sensors) ids.push_back(s.id);
    if (sensors.empty()) return "none";
    const std::string numbers = std::to_string(sensors.back().number);
    return list_of(std::move(ids)) + " or " +
           (sensors.size() == 1 ? "the number " + numbers : "a number from 0 to " + numbers);
}

std::string list_or_none(const std::vector<std::string>& names) {
    return names.empty() ? "none" : list_of(names);
}

const SceneSensor& find_sensor(const Scene& scene, const std::string& name) {
    const auto& sensors = scene.sensors;
    auto found = std::ranges::find(sensors, name, &SceneSensor::id);
    if (found != sensors.end()) return *found;
    if (const std::optional<std::size_t> number = parsed<std::size_t>(name))
        found = std::ranges::find(sensors, *number, &SceneSensor::number);
    if (found != sensors.end()) return *found;
    throw InputError("there is no sensor '" + name + "' in the scene, expected " +
                     expected_sensor(sensors));
}

bool is_cropped(const Film& film) {
    return film.crop_width != film.width || film.crop_height != film.height;
}

/// The height of a picture of this width that has the aspect ratio of the crop window.
double rows_of(const Film& film, int width) {
    return double{1} * width * film.crop_height / film.crop_width;
}

/// Makes the crop window the whole film: the same rays, which no longer depend on whole pixels of a
/// larger film.
void keep_crop_window(PerspectiveCamera& camera, Film& film) {
    const double width = film.width, height = film.height;
    const auto offset = [](double old, double whole, int first, int part) {
        return 0.5 - ((0.5 - old) * whole - first) / part;
    };
    camera.principal_offset_x =
        offset(camera.principal_offset_x, width, film.crop_x, film.crop_width);
    camera.principal_offset_y =
        offset(camera.principal_offset_y, height, film.crop_y, film.crop_height);
    constexpr double kHalf = std::numbers::pi / 360;  // of degrees
    const double share = film.crop_width / width;
    camera.fov_x = std::atan(std::tan(camera.fov_x * kHalf) * share) / kHalf;
    camera.orthographic_width *= share;
    film.width = film.crop_width, film.height = film.crop_height;
    film.crop_x = film.crop_y = 0;
}

void require_sides(const std::string& whose, int width, int height) {
    const std::string found = whose + " has " + size_text(width, height) + " pixels";
    require(is_side(width) && is_side(height),
            found + ": expected 1 to " + std::to_string(kMaxImageSide) + " a side");
    require(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) <= kMaxImagePixels,
            found + ": expected at most " + std::to_string(kMaxImagePixels) + " in all");
}

/// A sensor with a picture of another size: its field of view stays, and its middle.
void resize(int width, int height, PerspectiveCamera& camera, Film& film) {
    if (width == film.crop_width && height == film.crop_height) return;
    require_sides("the picture", width, height);
    require_aspect(film, width, height, 1);
    if (is_cropped(film)) keep_crop_window(camera, film);
    camera.principal_offset_y *= rows_of(film, width) / height;
    film.width = film.crop_width = width, film.height = film.crop_height = height;
}

TracedScene through_sensor(const TracedScene& view, const Sensor& wanted) {
    const Scene& scene = *view.scene;
    SceneSensor sensor{"", scene.camera, scene.film};
    if (!wanted.name.empty()) sensor = find_sensor(scene, wanted.name);
    if (wanted.width != 0 || wanted.height != 0)
        resize(wanted.width, wanted.height, sensor.camera, sensor.film);
    return with_camera(view, make_camera_rays(sensor.camera, sensor.film), sensor.film);
}

/// Whether some position of a coarse grid on the film has a ray.
bool sees_anything(const CameraRays& rays) {
    constexpr int kGrid = 32;
    if (!has_lens(rays)) return true;
    for (int i = 0; i < kGrid * kGrid; ++i)
        if (bent_direction(rays.bent, {(i % kGrid + 0.5) / kGrid, (i / kGrid + 0.5) / kGrid}))
            return true;
    return false;
}

/// How far aside of the axis the picture reaches where the camera looks 1 far, along x and y.
double reach_aside(const Camera& camera) {
    return std::max((std::abs(camera.center_x) + camera.width) / camera.focal_x,
                    (std::abs(camera.center_y) + camera.height) / camera.focal_y);
}

void check_pixels(const Camera& camera) {
    require_sides("the camera", camera.width, camera.height);
    require(
        camera.focal_x > 0 && camera.focal_y > 0 && std::isfinite(camera.focal_x) &&
            std::isfinite(camera.focal_y),
        fmt::format("the camera's focal lengths are {:g} and {:g} pixels: expected both above 0",
                    camera.focal_x, camera.focal_y));
    require(std::isfinite(camera.center_x) && std::isfinite(camera.center_y),
            "the camera's principal point is not finite");
    constexpr double kMaxAside = 1e5;  // with a near plane at 1e12, rays begin within kMaxRayReach
    require(reach_aside(camera) <= kMaxAside,
            "the camera sees more than 1e5 times as far to a side as ahead: expected longer focal "
            "lengths, or a principal point nearer to the picture");
}

/// Its axes are perpendicular, as projections take them to be; those that are to single precision
/// stay as they are.
Camera with_right_angles(Camera camera) {
    constexpr double kRounding = 2e-7;  // of products of columns, each rounded to a float
    const Transform to_world{camera.camera_to_world};
    if (!is_rigid(to_world, kRounding)) camera.camera_to_world = orthonormalised(to_world).m;
    return camera;
}

TracedScene through_camera(const TracedScene& view, const Camera& given) {
    check_camera(given);
    const Camera camera = with_right_angles(given);
    require(std::all_of(camera.lens.coefficients.begin(), camera.lens.coefficients.end(),
                        [](double c) { return std::isfinite(c); }),
            "the lens has coefficients that are not finite");
    const PerspectiveCamera& first = view.scene->camera;
    Film film = view.scene->film;
    film.width = film.crop_width = camera.width;
    film.height = film.crop_height = camera.height;
    film.crop_x = film.crop_y = 0;
    const CameraRays rays = make_camera_rays(camera, first.near_clip, first.far_clip);
    require(sees_anything(rays),
            "no part of the picture lies in the field of the lens, where its distortion grows with "
            "the angle to the axis: expected other coefficients");
    return with_camera(view, rays, film);
}

bool is_environment(const Emitter& emitter) {
    return match(
        emitter, [](const AreaEmitter&) { return false; },
        [](const EnvironmentEmitter&) { return true; }, [](const ConstantEmitter&) { return true; },
        [](const PointEmitter&) { return false; }, [](const SpotEmitter&) { return false; },
        [](const DirectionalEmitter&) { return false; },
        [](const ProjectorEmitter&) { return false; });
}

/// The scene's emitters of these ids.
std::vector<Emitter> emitters_of(const Scene& scene, const std::vector<std::string>& wanted) {
    require_emitters(scene, wanted);
    std::vector<Emitter> emitters;
    for (std::size_t i = 0; i < scene.emitter_ids.size(); ++i)
        if (std::find(wanted.begin(), wanted.end(), scene.emitter_ids[i]) != wanted.end())
            emitters.push_back(scene.emitters[i]);
    return emitters;
}

void check_environment_image(const Image& image) {
    require(image.channels == 3 && image.width >= 2 && image.height >= 2,
            "the environment has " + size_text(image.width, image.height) + " pixels of " +
                std::to_string(image.channels) + " channels: expected RGB of at least 2 x 2");
    require_whole(image, "the environment");
    require_finite(image, "the environment");
    for (std::size_t i = 0; i < image.values.size(); i += 3)
        if (luminance(Rgbf{image.values[i], image.values[i + 1], image.values[i + 2]}) < 0)
            throw InputError(
                "the environment has texels of negative luminance: expected 0 or more");
}

/// of_scene: null where the scene has no map.
EnvironmentEmitter changed(const Environment& environment, const EnvironmentEmitter* of_scene) {
    EnvironmentEmitter emitter;
    if (environment.image) {
        const Image& image = *environment.image;
        check_environment_image(image);
        emitter.image = image.height < kEnvironmentRows
                            ? share(padded_to(image, 2, kEnvironmentRows))
                            : environment.image;
    } else {
        require(of_scene != nullptr,
                "the scene has no environment map to turn or scale: expected an image");
        emitter = *of_scene;
    }
    if (environment.scale) {
        require(*environment.scale >= 0 && *environment.scale <= std::numeric_limits<float>::max(),
                fmt::format("the environment's scale is {:g}: expected a number from 0 to 3.4e38",
                            *environment.scale));
        emitter.scale = static_cast<float>(*environment.scale);
    }
    if (environment.to_world) {
        require(is_rigid(Transform{*environment.to_world}),
                "to_world of the environment scales, shears or mirrors: expected a rotation");
        emitter.to_world = Transform{*environment.to_world};
        for (int i = 0; i < 3; ++i) emitter.to_world(i, 3) = 0;  // infinitely far away
    }
    return emitter;
}

}  // namespace

void check_camera(const Camera& camera) {
    check_pixels(camera);
    require(is_rigid(Transform{camera.camera_to_world}),
            "camera_to_world scales, shears or mirrors: expected a rotation and a translation");
    const Matrix& m = camera.camera_to_world;
    require(length(Vec3<double>{m[3], m[7], m[11]}) <= kMaxDistance,
            "the camera is further than 1e12 from the origin");
}

void require_emitters(const Scene& scene, const std::vector<std::string>& ids) {
    for (const std::string& id : ids)
        require(std::find(scene.emitter_ids.begin(), scene.emitter_ids.end(), id) !=
                    scene.emitter_ids.end(),
                "there is no emitter '" + id + "' in the scene, expected " +
                    list_or_none(scene.emitter_ids));
}

void require_aspect(const Film& film, int width, int height, int cut) {
    const double missing = rows_of(film, width) - height;
    require(missing > -1 && missing < 1 + cut,
            "the picture has " + size_text(width, height) +
                " pixels: expected the aspect ratio of the sensor's " +
                (is_cropped(film) ? "crop window, " : "film, ") +
                size_text(film.crop_width, film.crop_height));
}

Camera scaled(const Camera& camera, double factor) {
    const ScaledSize size = scaled_size(camera.width, camera.height, factor);
    Camera small = camera;
    small.width = size.width, small.height = size.height;
    small.focal_x /= size.step, small.focal_y /= size.step;
    small.center_x = (camera.center_x - 0.5 * camera.width) / size.step + 0.5 * size.width;
    small.center_y = (camera.center_y - 0.5 * camera.height) / size.step + 0.5 * size.height;
    return small;
}

TracedScene through(const TracedScene& view, const ViewCamera& camera) {
    return match(
        camera, [&](const Sensor& s) { return through_sensor(view, s); },
        [&](const Camera& c) { return through_camera(view, c); });
}

TracedScene under(const TracedScene& view, const Lighting& lighting) {
    const Scene& scene = *view.scene;
    std::vector<Emitter> emitters =
        lighting.emitters ? emitters_of(scene, *lighting.emitters) : scene.emitters;
    if (lighting.environment) {
        std::erase_if(emitters, is_environment);
        emitters.push_back(changed(*lighting.environment, environment_map(scene)));
    }
    return with_emitters(view, std::move(emitters));
}

}  // namespace burnish
