// An integrating sphere, whose image and derivatives are known in closed form: the camera in the
// middle of a sphere that shines and reflects, L(x) = Le + rho(x) H, H = Le / (1 - mean of rho).
#pragma once

#include <numbers>

#include "gradient/small_scene.h"
#include "paths/trace_input.h"

namespace burnish::test {

inline constexpr int kTexels = 4;  ///< a side

/// What each pixel shows of each texel, and the share of each texel in the sphere.
struct IntegratingSphere {
    Scene scene;
    std::vector<std::array<double, kTexels * kTexels>> shown;
    std::array<double, kTexels * kTexels> share{};
};

inline const Rgbf kGlow{0.6f, 0.9f, 0.3f};

inline std::size_t texel_at(const Bitmap& bitmap, const Vec3f& d) {
    constexpr double kPi = std::numbers::pi;
    const double u = std::atan2(double{d.y}, double{d.x}) / (2 * kPi);
    const double v = std::acos(std::clamp(double{d.z}, -1.0, 1.0)) / kPi;
    return footprint(bitmap, {static_cast<float>(u < 0 ? u + 1 : u), static_cast<float>(v)})
        .texel[0];
}

inline IntegratingSphere make_integrating_sphere() {
    IntegratingSphere form;
    Scene& scene = form.scene;
    scene.camera.to_world = look_at({0, 0, 0}, {1, 0.4, 0.3}, {0, 0, 1});
    scene.camera.fov_x = 80;
    scene.film = {8, 8, 0, 0, 8, 8, {FilterKind::kBox, 0.5f}};
    scene.max_depth = kUnboundedDepth;
    scene.rr_depth = 3;
    scene.textures = {make_bitmap(kTexels, 3, TextureFilter::kNearest, 0.3f, 0.8f, 67)};
    Diffuse diffuse;
    diffuse.reflectance.texture = {0};
    scene.bsdfs = {diffuse};
    scene.materials = {{"inside", {0}, {}}};
    Sphere sphere;
    sphere.radius = 2;
    sphere.flip_normals = true;
    scene.shapes = {{"sphere", sphere, {0}, {0}}};
    scene.emitters = {AreaEmitter{kGlow, {0}}};
    scene.parameters = {{"inside.reflectance.data", {0}}};
    const auto& bitmap = std::get<Bitmap>(scene.textures[0]);
    constexpr int kGrid = 64;
    for (int pixel = 0; pixel < 64; ++pixel) {
        auto& shown = form.shown.emplace_back();
        shown.fill(0);
        for (int k = 0; k < kGrid * kGrid; ++k) {
            const Vec2f film{
                (static_cast<float>(pixel % 8) + (static_cast<float>(k % kGrid) + 0.5f) / kGrid) /
                    8,
                (static_cast<float>(pixel / 8) + (static_cast<float>(k / kGrid) + 0.5f) / kGrid) /
                    8};
            const Vec3f d = camera_ray(scene.camera, scene.film, film).direction;
            shown[texel_at(bitmap, d)] += 1.0 / (kGrid * kGrid);
        }
    }
    // A texel lies between two meridians and two parallels; rows of equal polar angle.
    for (std::size_t row = 0; row < kTexels; ++row) {
        const double begin = std::cos(std::numbers::pi * static_cast<double>(row) / kTexels);
        const double end = std::cos(std::numbers::pi * static_cast<double>(row + 1) / kTexels);
        for (std::size_t column = 0; column < kTexels; ++column) {
            const double angle =
                2 * std::numbers::pi * (static_cast<double>(column) + 0.5) / kTexels;
            const double middle = std::numbers::pi * (static_cast<double>(row) + 0.5) / kTexels;
            const Vec3f d{static_cast<float>(std::sin(middle) * std::cos(angle)),
                          static_cast<float>(std::sin(middle) * std::sin(angle)),
                          static_cast<float>(std::cos(middle))};
            form.share[texel_at(bitmap, d)] = (begin - end) / 2 / kTexels;
        }
    }
    return form;
}

inline double texel_value(const IntegratingSphere& form, std::size_t texel, std::size_t channel) {
    return double{std::get<Bitmap>(form.scene.textures[0]).values[3 * texel + channel]};
}

/// The mean reflectance.
inline double mean_reflectance(const IntegratingSphere& form, std::size_t channel) {
    double mean = 0;
    for (std::size_t t = 0; t < form.share.size(); ++t)
        mean += form.share[t] * texel_value(form, t, channel);
    return mean;
}

/// Light that falls on every point, divided by pi, after so many bounces.
inline double received(double mean, double glow, int bounces) {
    double sum = 0, term = glow;
    for (int k = 0; k < bounces; ++k) sum += term, term *= mean;
    return sum;
}

inline constexpr int kAllBounces = 400;

inline std::vector<double> exact_image(const IntegratingSphere& form, int bounces) {
    std::vector<double> image;
    for (const auto& shown : form.shown)
        for (std::size_t c = 0; c < 3; ++c) {
            double seen = 0;
            for (std::size_t t = 0; t < shown.size(); ++t)
                seen += shown[t] * texel_value(form, t, c);
            const double glow = double{kGlow[static_cast<int>(c)]};
            image.push_back(glow + seen * received(mean_reflectance(form, c), glow, bounces));
        }
    return image;
}

/// d sum(A I) / d(texel), [texel][channel]. onward: with what a texel sends to other points, too.
inline std::vector<double> exact_gradient(const IntegratingSphere& form, const Image& adjoint,
                                          bool onward) {
    std::vector<double> gradient(3 * form.share.size(), 0);
    for (std::size_t pixel = 0; pixel < form.shown.size(); ++pixel)
        for (std::size_t c = 0; c < 3; ++c) {
            const double a = double{adjoint.values[3 * pixel + c]};
            const double glow = double{kGlow[static_cast<int>(c)]};
            const double mean = mean_reflectance(form, c);
            double seen = 0;
            for (std::size_t t = 0; t < form.share.size(); ++t)
                seen += form.shown[pixel][t] * texel_value(form, t, c);
            for (std::size_t t = 0; t < form.share.size(); ++t)
                gradient[3 * t + c] +=
                    a * (form.shown[pixel][t] * glow / (1 - mean) +
                         (onward ? seen * glow * form.share[t] / ((1 - mean) * (1 - mean)) : 0));
        }
    return gradient;
}

/// The grid of kGrid^2 rays misplaces an edge by at most half a cell.
inline constexpr double kGridSlack = 2e-4;

}  // namespace burnish::test
