// The sensors `perspective`, `thinlens` and `orthographic`.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/box.h"
#include "mitsuba/loader.h"
#include "mitsuba/numbers.h"
#include "mitsuba/transforms.h"

namespace burnish::mitsuba {

namespace {

constexpr double kDegrees = std::numbers::pi / 180;

/// 36 x 24 mm film: the diagonal field of view, in degrees, of a focal length such as "50mm".
double diagonal_fov(const Properties& properties, std::string text) {
    if (text.size() > 2 && text.substr(text.size() - 2) == "mm") text.resize(text.size() - 2);
    const std::vector<double> length = parse_numbers(text, properties.node->place);
    if (length.size() != 1 || !(length[0] > 0))
        fail(properties.node->place,
             fmt::format("\"focal_length\" is \"{:.40}\", expected a length such as \"50mm\"",
                         text));
    return 2 * std::atan(std::sqrt(36.0 * 36.0 + 24.0 * 24.0) / (2 * length[0])) / kDegrees;
}

/// In the order of the words of `fov_axis`.
enum FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };

/// Horizontal field of view in degrees from that along another axis; aspect = width / height.
double horizontal_fov(double fov, int axis, double aspect) {
    if (axis == kSmaller) axis = aspect > 1 ? kY : kX;
    if (axis == kLarger) axis = aspect > 1 ? kX : kY;
    const double t = std::tan(fov * kDegrees / 2);
    if (axis == kY) return 2 * std::atan(t * aspect) / kDegrees;
    if (axis == kDiagonal)
        return 2 * std::atan(t / std::sqrt(1 + 1 / (aspect * aspect))) / kDegrees;
    return fov;
}

}  // namespace

double take_fov_x(Loader& loader, Properties& properties, double aspect) {
    const Place& place = properties.node->place;
    const Property* fov = take(properties, "fov");
    const Property* focal_length = take(properties, "focal_length");
    if (fov && focal_length)
        fail(focal_length->site->place,
             "found both \"fov\" and \"focal_length\", expected at most one of them");
    const int axis = take_choice_in_any_case(properties, "fov_axis",
                                             {"x", "y", "diagonal", "smaller", "larger"}, 0);
    if (const Property* given = take(properties, "fov_axis"); given && !fov)
        note(loader, given->site->place,
             "\"fov_axis\" has no effect without \"fov\": a focal length means the diagonal");
    if (!fov)
        return horizontal_fov(
            diagonal_fov(properties, take_string(properties, "focal_length", "50mm")), kDiagonal,
            aspect);
    const double degrees = take_number(properties, "fov", 0);
    if (!(degrees > 0 && degrees < 180))
        fail(place, fmt::format("\"fov\" is {}, expected degrees between 0 and 180", degrees));
    return horizontal_fov(degrees, axis, aspect);
}

namespace {

/// Rigid, and within reach.
Transform checked_camera_transform(const Properties& properties, const Transform& to_world) {
    require_reach(properties.node->place, "camera", column_of(to_world, 3));
    return orthonormalised(to_world);
}

Transform take_camera_transform(Properties& properties) {
    const Transform to_world = take_transform(properties, "to_world").value_or(Transform{});
    const UniformScale scale = uniform_scale(to_world, 1e-3);
    if (!scale.uniform || std::abs(scale.scale - 1) > 1e-3)
        fail(properties.node->place, fmt::format("\"to_world\" of the camera scales (by {:.6g}) or "
                                                 "shears, expected a rotation and translation",
                                                 scale.scale));
    return checked_camera_transform(properties, to_world);
}

/// The scale of an orthographic camera says how much it sees. Returns that along the view.
double take_orthographic_transform(Properties& properties, PerspectiveCamera& camera) {
    Transform to_world = take_transform(properties, "to_world").value_or(Transform{});
    std::array<double, 3> scale{};
    for (int j = 0; j < 3; ++j) {
        double& s = scale[static_cast<std::size_t>(j)];
        s = length(column_of(to_world, j));
        for (int i = 0; i < 3 && s > 0; ++i) to_world(i, j) /= s;
    }
    if (!(scale[0] > 0 && scale[2] > 0 && std::abs(scale[1] / scale[0] - 1) < 1e-3) ||
        !uniform_scale(to_world, 1e-3).uniform)
        fail(properties.node->place,
             fmt::format("\"to_world\" of the orthographic camera shears or scales x and y "
                         "differently (by {:.6g} and {:.6g}), expected one scale",
                         scale[0], scale[1]));
    camera.to_world = checked_camera_transform(properties, to_world);
    camera.orthographic_width = 2 * scale[0];
    return scale[2];
}

void take_principal_point(Properties& properties, PerspectiveCamera& camera) {
    constexpr double kMaxOffset = 1000;  // widths and heights of the film
    camera.principal_offset_x =
        take_within(properties, "principal_point_offset_x", 0, -kMaxOffset, kMaxOffset);
    camera.principal_offset_y =
        take_within(properties, "principal_point_offset_y", 0, -kMaxOffset, kMaxOffset);
}

void take_thin_lens(Properties& properties, PerspectiveCamera& camera) {
    take_required(properties, "aperture_radius");
    constexpr float kMin = 1e-12f, kMax = static_cast<float>(kMaxDistance);
    camera.aperture_radius = take_float(properties, "aperture_radius", 0);
    camera.focus_distance =
        take_float(properties, "focus_distance", std::min(camera.far_clip, kMax));
    const auto within = [](float v, float low) { return v >= low && v <= kMax; };
    if (!within(camera.aperture_radius, 0) || !within(camera.focus_distance, kMin))
        fail(properties.node->place,
             fmt::format("\"aperture_radius\" is {} and \"focus_distance\" {}, expected "
                         "numbers of at least 0 and {:g}, and of at most {:g}",
                         camera.aperture_radius, camera.focus_distance, kMin, kMax));
}

/// A scale moves the near plane, as in Mitsuba. The planes stay as far apart as they are given.
void take_clipping_planes(Properties& properties, double scale, PerspectiveCamera& camera) {
    const float near = take_float(properties, "near_clip", camera.near_clip);
    const float far = take_float(properties, "far_clip", camera.far_clip);
    const double moved = scale * near;
    camera.near_clip = static_cast<float>(moved);
    camera.far_clip = static_cast<float>(moved + (double{far} - near));
    const std::string scaled = scale == 1 ? "" : fmt::format(" at a scale of {:g}", scale);
    if (!(camera.near_clip > 0 && camera.near_clip < camera.far_clip))
        fail(properties.node->place,
             fmt::format("the clipping planes are {} and {}{}, expected 0 < near_clip < far_clip",
                         near, far, scaled));
    if (!(camera.near_clip <= kMaxDistance))
        fail(
            properties.node->place,
            fmt::format("the near clipping plane is at {}{}, expected it within {:g} of the camera",
                        near, scaled, kMaxDistance));
}

/// How far aside of its axis a camera's rays are where it looks 1 far, where they begin and where a
/// thin lens is sharp, whichever is farthest; of an orthographic camera, everywhere.
double reach_aside(const PerspectiveCamera& camera, const Film& film) {
    const bool is_parallel = camera.orthographic_width > 0,
               is_thin_lens = camera.aperture_radius > 0;
    const double half_width =
        is_parallel ? camera.orthographic_width / 2 : std::tan(camera.fov_x * kDegrees / 2);
    const double tall = static_cast<double>(film.height) / film.width;
    const double aside =
        half_width * std::hypot(1 + 2 * std::abs(camera.principal_offset_x),
                                (1 + 2 * std::abs(camera.principal_offset_y)) * tall);
    if (is_parallel) return aside;
    const double near = std::max(1.0, double{camera.near_clip});
    if (!is_thin_lens) return aside * near;
    const double focus = camera.focus_distance;
    return (aside + camera.aperture_radius / focus) * std::max(near, focus);
}

void require_reach_aside(const Place& place, const SceneSensor& sensor) {
    const double reach = reach_aside(sensor.camera, sensor.film);
    if (!(reach <= kMaxRayReach))
        fail(place, fmt::format("the camera's rays go {:.6g} aside of its axis, expected at most "
                                "{:g}, as of a smaller field of view or scale",
                                reach, kMaxRayReach));
}

Box box_of(const Scene& scene) {
    Box box;
    for (const Shape& shape : scene.shapes) box.include(burnish::box_of(scene, shape));
    return box;
}

/// A picture that can be written and read again.
void require_pixels(const Place& place, const Film& film) {
    const auto pixels =
        static_cast<std::size_t>(film.crop_width) * static_cast<std::size_t>(film.crop_height);
    if (pixels > kMaxImagePixels)
        fail(place, fmt::format("the picture has {} x {} pixels, expected at most {} in all",
                                film.crop_width, film.crop_height, kMaxImagePixels));
}

}  // namespace

void require_reach(const Place& place, const char* what, const Vec3<double>& position) {
    if (!(length(position) <= kMaxDistance))
        fail(place, fmt::format("the {} is at ({:.6g}, {:.6g}, {:.6g}), expected it within {:g} of "
                                "the origin",
                                what, position.x, position.y, position.z, kMaxDistance));
}

SceneSensor read_sensor(Loader& loader, const Node& node, std::size_t number) {
    Properties properties = open_properties(loader.document, node);
    const std::string& type = properties.type;
    if (type != "perspective" && type != "thinlens" && type != "orthographic")
        fail_plugin(node, "batch distant irradiancemeter radiancemeter radiancefield",
                    "\"perspective\", \"thinlens\" or \"orthographic\"");
    SceneSensor sensor;
    sensor.number = number;
    sensor.id = id_or_made_up(loader, node, fmt::format("sensor_{}", number));
    const Property* film = take_only(properties, "film");
    sensor.film = film ? read_film(loader, *film->node) : default_film(loader.options);
    require_pixels(film ? film->node->place : node.place, sensor.film);
    if (const Property* sampler = take_only(properties, "sampler")) {
        const int count = read_sampler(loader, *sampler->node, loader.result.scene.sample_count);
        if (loader.result.scene.sensors.empty()) loader.result.scene.sample_count = count;
    }
    PerspectiveCamera& camera = sensor.camera;
    double scale = 1;
    if (type == "orthographic") {
        scale = take_orthographic_transform(properties, camera);
    } else {
        camera.to_world = take_camera_transform(properties);
        camera.fov_x = take_fov_x(loader, properties,
                                  static_cast<double>(sensor.film.width) / sensor.film.height);
    }
    take_clipping_planes(properties, scale, camera);
    if (type == "thinlens") take_thin_lens(properties, camera);
    if (type == "perspective") take_principal_point(properties, camera);
    require_reach_aside(node.place, sensor);
    ignore(properties,
           {"focus_distance", "shutter_open", "shutter_close"});  // nothing moves, nothing blurs
    warn_unknown(properties, loader.result.warnings);
    return sensor;
}

SceneSensor default_sensor(Loader& loader) {
    SceneSensor sensor{"sensor_0", {}, default_film(loader.options)};
    require_pixels(loader.document.root.place, sensor.film);
    PerspectiveCamera& camera = sensor.camera;
    camera.fov_x = 45;
    loader.result.notes.push_back(
        sentence(loader.document.root.place,
                 "the scene has no sensor: a perspective camera in front of it (-z) is taken"));
    const Box box = box_of(loader.result.scene);
    if (box.empty()) return sensor;
    const double extent = max_component(box.size()),
                 distance = extent / (2 * std::tan(camera.fov_x * kDegrees / 2));
    camera.to_world = translation({box.center().x, box.center().y, box.low.z - distance});
    const auto near = static_cast<float>(0.01 * distance);
    if (near > 0) camera.near_clip = std::min(camera.near_clip, near);
    camera.far_clip = std::max(camera.far_clip, static_cast<float>(4 * (distance + extent)));
    return sensor;
}

}  // namespace burnish::mitsuba
