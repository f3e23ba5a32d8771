// Camera rays against the reference table and against each other.
#include "shading/camera.h"

#include <gtest/gtest.h>

#include "core/packet.h"
#include "core/random.h"
#include "csv.h"
#include "worst.h"

namespace burnish::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// Horizontal field of view from that along axis 0-4: x, y, diagonal, smaller, larger.
double horizontal_fov(double degrees, int axis, double aspect) {
    double tangent = std::tan(degrees * kPi / 360);
    const bool along_y = axis == 1 || (axis == 3 && aspect > 1) || (axis == 4 && aspect < 1);
    if (along_y) tangent *= aspect;
    if (axis == 2) tangent /= std::sqrt(1 + 1 / (aspect * aspect));
    return std::atan(tangent) * 360 / kPi;
}

struct View {
    PerspectiveCamera camera;
    Film film;
};

/// The transform of look_at with up = +y.
Transform look_from(const Vec3<double>& origin, const Vec3<double>& target) {
    const Vec3<double> z = normalize(target - origin),
                       x = normalize(cross(Vec3<double>{0, 1, 0}, z));
    const Vec3<double> y = cross(z, x);
    return {
        {x.x, y.x, z.x, origin.x, x.y, y.y, z.y, origin.y, x.z, y.z, z.z, origin.z, 0, 0, 0, 1}};
}

View view_of(const CsvRow& row) {
    View v;
    v.film.width = static_cast<int>(row["width"]);
    v.film.height = static_cast<int>(row["height"]);
    v.camera.fov_x =
        horizontal_fov(row["fov"], static_cast<int>(row["fov_axis"]), row["width"] / row["height"]);
    v.camera.principal_offset_x = row["ppo_x"];
    v.camera.principal_offset_y = row["ppo_y"];
    v.camera.near_clip = static_cast<float>(row["near_clip"]);
    v.camera.to_world = look_from({row["origin_x"], row["origin_y"], row["origin_z"]},
                                  {row["target_x"], row["target_y"], row["target_z"]});
    return v;
}

/// The largest difference to the table's rays, in any component, with the film position moved by
/// (dx, dy).
double worst_difference(float dx, float dy) {
    double worst = 0;
    for (const CsvRow& row : reference_table("camera.csv")) {
        const View v = view_of(row);
        const Vec2f film{static_cast<float>(row["film_x"]) + dx,
                         static_cast<float>(row["film_y"]) + dy};
        const CameraRay<float> ray = camera_ray(v.camera, v.film, film);
        const Vec3<double> o{row["ray_o_x"], row["ray_o_y"], row["ray_o_z"]};
        const Vec3<double> d{row["ray_d_x"], row["ray_d_y"], row["ray_d_z"]};
        for (int i = 0; i < 3; ++i) {
            worst = test::worse(worst, std::abs(static_cast<double>(ray.direction[i]) - d[i]));
            worst = test::worse(
                worst, std::abs(static_cast<double>(ray.origin[i]) - o[i]) / (1 + std::abs(o[i])));
        }
    }
    return worst;
}

/// 2e-6: the table's inputs have seven digits and its chain of single precision matrices loses two
/// bits.
TEST(Camera, AgreesWithTheTable) {
    EXPECT_LT(worst_difference(0, 0), 2e-6);
    EXPECT_GT(worst_difference(1e-4f, 0), 2e-5);  // the comparison sees a hundredth of a pixel
    EXPECT_GT(worst_difference(0, 1e-4f), 2e-5);
}

TEST(Camera, RaysRunFromTheNearToTheFarPlane) {
    View v;
    v.camera.near_clip = 0.5f;
    v.camera.far_clip = 20.0f;
    v.camera.to_world = look_from({1, 2, 3}, {4, -1, 2});
    const Vec3f z = transform_vector(v.camera.to_world, {0, 0, 1}), eye{1, 2, 3};
    for (const Vec2f film : {Vec2f{0, 0}, Vec2f{0.5f, 0.5f}, Vec2f{0.9f, 0.1f}}) {
        const CameraRay<float> ray = camera_ray(v.camera, v.film, film);
        const Vec3f end = ray.origin + ray.direction * ray.max_distance;
        EXPECT_NEAR(dot(ray.origin - eye, z), 0.5f, 1e-5f);
        EXPECT_NEAR(dot(end - eye, z), 20.0f, 2e-5f);
    }
}

/// Rays of Mitsuba 3.9.1.
struct KnownRay {
    Vec2f film;
    Vec3f origin, direction;
    float max_distance;
};

View distant_view() {
    View v;
    v.film.width = 64, v.film.height = 48;
    v.camera.fov_x = 40;
    v.camera.near_clip = 0.5f, v.camera.far_clip = 20;
    v.camera.to_world = look_from({1, 2, 6}, {0, 0.5, 0});
    return v;
}

void expect_rays(const View& v, std::initializer_list<KnownRay> expected) {
    for (const KnownRay& e : expected) {
        const CameraRay<float> ray = camera_ray(v.camera, v.film, e.film);
        EXPECT_LT(length(ray.origin - e.origin), 3e-6f);
        EXPECT_LT(length(ray.direction - e.direction), 1e-6f);
        EXPECT_NEAR(ray.max_distance, e.max_distance, 1e-5f);
    }
}

TEST(Camera, OrthographicRaysAreParallel) {
    View v = distant_view();
    v.camera.orthographic_width = 5;
    const Vec3f forward{-0.15961738f, -0.23942608f, -0.9577043f};
    expect_rays(v, {{{0.1f, 0.3f}, {-1.0821173f, 2.6084728f, 5.672819f}, forward, 19.5f},
                    {{0.75f, 0.9f}, {2.212225f, 0.42391554f, 5.6699014f}, forward, 19.5f}});
}

View thin_lens() {
    View v = distant_view();
    v.camera.aperture_radius = 0.15f, v.camera.focus_distance = 5;
    return v;
}

TEST(Camera, TheMiddleOfAThinLensIsAPinhole) {
    expect_rays(thin_lens(), {{{0.1f, 0.3f},
                               {0.77443516f, 1.9332945f, 5.532189f},
                               {-0.4307807f, -0.12739316f, -0.89341986f},
                               20.421129f},
                              {{0.75f, 0.9f},
                               {1.0142437f, 1.7742718f, 5.531976f},
                               {0.02740175f, -0.43425146f, -0.9003748f},
                               20.272587f}});
}

TEST(Camera, RaysOfAThinLensMeetInFocus) {
    const View v = thin_lens();
    const CameraRays rays = make_camera_rays(v.camera, v.film);
    const Vec3f z = transform_vector(v.camera.to_world, {0, 0, 1}), eye{1, 2, 6};
    const auto at_depth = [&](const CameraRay<float>& ray, float depth) {
        const float to_plane = depth - dot(ray.origin - eye, z);
        return ray.origin + ray.direction * (to_plane / dot(ray.direction, z));
    };
    double mean_square = 0;
    constexpr int kCount = 4096;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const auto u = uniforms({8, Stream::kTest}, i, 0, 0);
        const Vec2f film{u[0], u[1]};
        const CameraRay<float> ray = camera_ray(rays, film, Vec2f{u[2], u[3]}),
                               middle = camera_ray(rays, film);
        EXPECT_LT(length(at_depth(ray, 5) - at_depth(middle, 5)), 2e-5f);
        const float from_middle = length(at_depth(ray, 0) - eye);
        EXPECT_LE(from_middle, 0.15001f);
        mean_square += double{from_middle} * double{from_middle} / kCount;
        EXPECT_NEAR(dot(ray.origin - eye, z), 0.5f, 1e-5f);
    }
    EXPECT_NEAR(mean_square, 0.15 * 0.15 / 2, 2e-4);  // uniform on the disk
}

void expect_packets(const View& v) {
    const CameraRays rays = make_camera_rays(v.camera, v.film);
    Vec2<Packet> film, aperture;
    for (int i = 0; i < kLanes; ++i) {
        const auto u = uniforms({7, Stream::kTest}, static_cast<std::uint32_t>(i), 0, 0);
        set(film.x, i, u[0]), set(aperture.x, i, u[2]);
        set(film.y, i, u[1]), set(aperture.y, i, u[3]);
    }
    const CameraRay<Packet> wide = camera_ray(rays, film, aperture);
    for (int i = 0; i < kLanes; ++i) {
        const CameraRay<float> one = camera_ray(rays, Vec2f{get(film.x, i), get(film.y, i)},
                                                Vec2f{get(aperture.x, i), get(aperture.y, i)});
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(get(wide.origin[k], i), one.origin[k]);
            EXPECT_EQ(get(wide.direction[k], i), one.direction[k]);
        }
        EXPECT_EQ(get(wide.max_distance, i), one.max_distance);
    }
}

TEST(Camera, PacketsHaveTheBitsOfSingleRays) {
    expect_packets(view_of(reference_table("camera.csv").front()));
    expect_packets(thin_lens());
    View parallel = distant_view();
    parallel.camera.orthographic_width = 5;
    expect_packets(parallel);
}

}  // namespace
}  // namespace burnish::test
