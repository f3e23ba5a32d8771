// Lens distortion against its inverse, and the rays of cameras with lenses.
#include "shading/lens.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/random.h"
#include "shading/camera.h"
#include "worst.h"

namespace burnish::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

const Lens kLenses[] = {
    {LensKind::kBrownConrady, {}},
    {LensKind::kBrownConrady, {-0.2, 0.05}},
    {LensKind::kBrownConrady, {0.3, -0.1}},
    {LensKind::kBrownConrady, {-0.31, 0.12, 0.006, -0.009}},
    {LensKind::kBrownConrady, {0.11, -0.04, -0.05, 0.04}},
    {LensKind::kBrownConrady, {0.9, 0.25, 0.002, -0.003, 0.02, 1.2, 0.5, 0.06}},
    {LensKind::kFisheye, {}},
    {LensKind::kFisheye, {-0.05, 0.02, -0.008, 0.001}},
    {LensKind::kFisheye, {0.1, -0.05}},
};

/// The direction at an angle to the axis.
Vec3<double> direction(double angle, double around) {
    return {std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around),
            std::cos(angle)};
}

double angle_of(const FieldLens& lens) {
    return lens.lens.kind == LensKind::kFisheye ? lens.radius : std::atan(lens.radius);
}

/// The largest difference between directions of the field and what their coordinates are undone to.
double worst_return(const FieldLens& lens, double share) {
    double worst = 0;
    for (int i = 0; i <= 40; ++i)
        for (int k = 0; k < 12; ++k) {
            const Vec3<double> d = direction(share * angle_of(lens) * i / 40, 0.5 * k);
            const auto back = undistort(lens, distort(lens.lens, d));
            if (!back) return 1;
            for (int c = 0; c < 3; ++c) worst = test::worse(worst, std::abs((*back)[c] - d[c]));
        }
    return worst;
}

TEST(Lens, IsUndoneToDoublePrecision) {
    for (const Lens& lens : kLenses) {
        const FieldLens field = with_field(lens, 1);
        EXPECT_GT(angle_of(field), 30 * kDegree);
        EXPECT_LT(worst_return(field, 0.95), 1e-13)
            << static_cast<int>(lens.kind) << " " << lens.coefficients[0];
        EXPECT_LT(worst_return(field, 0.9999), 1e-11) << lens.coefficients[0];
    }
}

/// r (1 - r^2 / 6) grows until r = sqrt(2), where its value is the largest.
TEST(Lens, HasAFieldThatEndsWhereItTurnsBack) {
    const FieldLens lens = with_field({LensKind::kBrownConrady, {-1.0 / 6}}, 1);
    const double end = std::sqrt(2 * (1 - 0.01));  // where the slope is 0.01
    EXPECT_NEAR(lens.radius, end, 1e-9);
    const double value = end * (1 - end * end / 6);
    EXPECT_TRUE(undistort(lens, {value * (1 - 1e-9), 0}));
    EXPECT_FALSE(undistort(lens, {value * (1 + 1e-9), 0}));
    EXPECT_FALSE(undistort(lens, {0, -10}));

    const FieldLens fisheye = with_field({LensKind::kFisheye, {-1.0 / 6}}, 1);
    EXPECT_NEAR(fisheye.radius, end, 1e-9);
    EXPECT_NEAR(with_field({LensKind::kFisheye, {}}, 1).radius, std::numbers::pi, 1e-12);
    // The denominator vanishes at r = 1.
    EXPECT_LT(with_field({LensKind::kBrownConrady, {0, 0, 0, 0, 0, -1}}, 1).radius, 1);
}

TEST(Lens, OfAbsurdCoefficientsHasASmallFieldOrNone) {
    for (const double c : {1e300, -1e300, 1e20, -1e20})
        for (std::size_t i = 0; i < 8; ++i)
            for (const LensKind kind : {LensKind::kBrownConrady, LensKind::kFisheye}) {
                Lens lens{kind, {}};
                lens.coefficients[i] = c;
                const FieldLens field = with_field(lens, 1);
                EXPECT_GE(field.radius, 0);
                for (const double x : {0.0, 1e-12, 0.1, 1.0, 100.0}) {
                    const auto d = undistort(field, {x, -x});
                    const Vec3<double> v = d.value_or(Vec3<double>{0, 0, 1});
                    EXPECT_NEAR(dot(v, v), 1, 1e-12);
                }
            }
}

/// With a tangential part the field is no longer bounded by a circle on the film.
TEST(Lens, FieldOfATangentialLensIsWhereItsJacobianIsPositive) {
    const Lens lens{LensKind::kBrownConrady, {-0.1, 0, 0.05, -0.08}};
    const FieldLens field = with_field(lens, 1);
    EXPECT_LT(field.radius, with_field({LensKind::kBrownConrady, {-0.1}}, 1).radius);
    std::size_t inside = 0, outside = 0;
    for (double x = -3; x <= 3; x += 0.05)
        for (double y = -3; y <= 3; y += 0.05) {
            const auto d = undistort(field, {x, y});
            (d ? inside : outside) += 1;
            if (!d) continue;
            const Vec2<double> u = distort(lens, *d);
            EXPECT_NEAR(u.x, x, 1e-11);
            EXPECT_NEAR(u.y, y, 1e-11);
            EXPECT_LE(std::hypot(d->x, d->y) / d->z, field.radius * (1 + 1e-12));
        }
    EXPECT_GT(inside, 500u);
    EXPECT_GT(outside, 500u);
}

TEST(Lens, FisheyeSeesBehindItself) {
    const FieldLens lens = with_field({LensKind::kFisheye, {}}, 1);
    const auto d = undistort(lens, {0, 2});
    ASSERT_TRUE(d);
    EXPECT_NEAR(d->y, std::sin(2), 1e-14);
    EXPECT_NEAR(d->z, std::cos(2), 1e-14);
    EXPECT_NEAR(distort(lens.lens, *d).y, 2, 1e-14);
    EXPECT_EQ(undistort(lens, {0, 0})->z, 1);
}

Camera camera_with(const Lens& lens) {
    Camera camera{640, 480, 500, 510, 320, 250};
    camera.camera_to_world = {0, 0, 1, 2, 1, 0, 0, -1, 0, 1, 0, 3, 0, 0, 0, 1};
    camera.lens = lens;
    return camera;
}

TEST(LensRays, WithoutDistortionAreThoseOfAPinhole) {
    const CameraRays straight = make_camera_rays(camera_with({}), 0.5f, 20);
    const CameraRays bent =
        make_camera_rays(camera_with({LensKind::kBrownConrady, {1e-300}}), 0.5f, 20);
    EXPECT_FALSE(has_lens(straight));
    ASSERT_TRUE(has_lens(bent));
    for (int i = 0; i < 100; ++i) {
        const Vec2f film{static_cast<float>(i % 10) / 10, static_cast<float>(i / 10) / 10};
        const auto a = camera_ray<float>(straight, film), b = camera_ray<float>(bent, film);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(a.direction[c], b.direction[c], 2e-7);
            EXPECT_NEAR(a.origin[c], b.origin[c], 1e-6);
        }
        EXPECT_NEAR(a.max_distance, b.max_distance, 1e-5);
    }
}

TEST(LensRays, OfPacketsAreThoseOfFloats) {
    for (const Lens& lens : kLenses) {
        const CameraRays rays = make_camera_rays(camera_with(lens), 0.1f, 100);
        Vec2<Packet> film;
        for (int i = 0; i < kLanes; ++i)
            set(film.x, i, 0.13f * static_cast<float>(i) - 0.5f),
                set(film.y, i, 1.3f - 0.11f * static_cast<float>(i));
        const CameraRay<Packet> wide = camera_ray(rays, film);
        for (int i = 0; i < kLanes; ++i) {
            const auto one = camera_ray(rays, Vec2f{get(film.x, i), get(film.y, i)});
            EXPECT_EQ(get(wide.max_distance, i), one.max_distance);
            for (int c = 0; c < 3; ++c) {
                EXPECT_EQ(get(wide.origin[c], i), one.origin[c]);
                EXPECT_EQ(get(wide.direction[c], i), one.direction[c]);
            }
        }
    }
}

TEST(LensRays, EndBeforeTheyStartOutsideOfTheField) {
    const CameraRays rays =
        make_camera_rays(camera_with({LensKind::kBrownConrady, {-1.0}}), 0.1f, 100);
    EXPECT_GT(camera_ray(rays, Vec2f{0.5f, 0.5f}).max_distance, 0);
    EXPECT_LT(camera_ray(rays, Vec2f{0, 0}).max_distance, 0);
}

}  // namespace
}  // namespace burnish::test
