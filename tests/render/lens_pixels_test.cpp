// Pixels of cameras with lenses: no ray that meets a BSDF starts in a pixel that is not marked, and
// what sees nothing is black whatever the sky.
#include "render/lens_pixels.h"

#include <gtest/gtest.h>

#include "gradient/small_scene.h"
#include "paths/trace.h"
#include "render/render.h"
#include "render/renderer.h"
#include "render/visible_pixels.h"

namespace burnish {
namespace {

struct LensCase {
    const char* name;
    Lens lens;
    double focal;  ///< pixels, of a film of 90 x 70
    bool has_blind;
};

const LensCase kCases[] = {
    {"barrel", {LensKind::kBrownConrady, {-0.2, 0.03}}, 70, false},
    {"cushion", {LensKind::kBrownConrady, {0.4, 0.1}}, 60, false},
    {"tangential", {LensKind::kBrownConrady, {-0.2, 0.05, 0.05, -0.04}}, 70, false},
    {"barrel that turns back", {LensKind::kBrownConrady, {-0.4}}, 45, true},
    {"fisheye", {LensKind::kFisheye, {-0.02, 0.01}}, 30, false},
    {"fisheye that sees behind itself", {LensKind::kFisheye, {}}, 15, true},
};

/// The eye of the small scene's camera, with a lens.
TracedScene through(const TracedScene& view, const LensCase& c) {
    Camera camera{90, 70, c.focal, 1.1 * c.focal, 47, 33};
    const Transform& m = view.scene->camera.to_world;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            camera.camera_to_world[static_cast<std::size_t>(4 * row + column)] =
                (column < 2 ? -1 : 1) * m(row, column);
    camera.lens = c.lens;
    Film film = view.film;
    film.width = film.crop_width = 90, film.height = film.crop_height = 70;
    film.crop_x = film.crop_y = 0;
    return with_camera(view, make_camera_rays(camera, 0.01f, 1000), film);
}

/// The pixels in which paths on the BSDFs start.
std::vector<char> seen_pixels(const TracedScene& traced, const std::vector<char>& bsdfs) {
    const TextureTable textures{traced.scene->textures, {}};
    const TraceInput input{&traced, &textures, {41, Stream::kTest}, 1, SurfaceChoice::kUnknown,
                           bsdfs};
    std::vector<char> seen(90 * 70, 0);
    BatchOutput out;
    for (std::uint32_t pass = 0; pass < 64; ++pass)
        for (std::uint32_t pixel = 0; pixel < seen.size(); pixel += 70) {
            std::vector<BatchSample> samples;
            for (std::uint32_t i = pixel; i < pixel + 70; ++i) samples.push_back({{i, pass, 0}});
            trace_batch(input, samples, out);
            for (const DirectSample& d : out.direct_samples) seen[d.record.pixel] = 1;
        }
    return seen;
}

/// How many entries of `a` are not in `b`.
std::size_t missing(const std::vector<char>& a, const std::vector<char>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] && !b[i];
    return count;
}

std::vector<char> shifted(const std::vector<char>& marks, std::size_t pixels) {
    std::vector<char> result(marks.size(), 0);
    for (std::size_t i = 0; i < marks.size(); ++i)
        if (i % 90 >= pixels) result[i] = marks[i - pixels];
    return result;
}

/// One triangle of the floor, under a white sky.
Scene triangle_scene() {
    Scene scene = test::make_small_scene();
    scene.shapes.resize(1);
    scene.emitters = {ConstantEmitter{{1, 1, 1}}};
    std::get<Mesh>(scene.shapes[0].geometry).triangles.resize(1);
    return scene;
}

TEST(LensPixels, NoRayMeetsTheBsdfElsewhere) {
    const Scene scene = triangle_scene();
    const TracedScene straight = prepare(scene);
    for (const LensCase& c : kCases) {
        const TracedScene traced = through(straight, c);
        const std::vector<char> bsdfs{1, 0}, marks = visible_pixels(traced, bsdfs),
                                             seen = seen_pixels(traced, bsdfs);
        EXPECT_GT(std::count(seen.begin(), seen.end(), 1), 40) << c.name;
        EXPECT_EQ(missing(seen, marks), 0u) << c.name;
        EXPECT_GT(missing(seen, shifted(marks, 2)), 0u) << c.name << ": a shift must be noticed";
        // No mark lies farther than two pixels from what is seen, or from the end of the field.
        std::vector<char> near = dilate(seen, 90, 70, 2);
        const std::vector<char> end = dilate(blind_pixels(traced), 90, 70, 1);
        for (std::size_t i = 0; i < near.size(); ++i) near[i] |= end[i];
        EXPECT_EQ(missing(marks, near), 0u) << c.name;
    }
}

TEST(LensPixels, WithoutDistortionMarkAsAPinholeDoes) {
    const Scene scene = test::make_small_scene();
    const TracedScene straight = prepare(scene);
    const std::vector<char> bsdfs{1, 0};
    const auto count = [&](const Lens& lens) {
        const std::vector<char> marks =
            visible_pixels(through(straight, {"", lens, 70, false}), bsdfs);
        return static_cast<double>(std::count(marks.begin(), marks.end(), 1));
    };
    const double pinhole = count({}), bent = count({LensKind::kBrownConrady, {1e-300}});
    EXPECT_GE(bent, pinhole);
    EXPECT_LT(bent, 1.1 * pinhole + 90);
}

TEST(LensPixels, WhatLiesOutsideOfTheFieldIsBlack) {
    Scene scene = test::make_small_scene();
    scene.emitters = {ConstantEmitter{{1, 1, 1}}};
    scene.shapes.resize(1);
    scene.film.filter = {FilterKind::kBox, 0.5f};
    const TracedScene straight = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    for (const LensCase& c : kCases) {
        const TracedScene traced = through(straight, c);
        const std::vector<char> blind = blind_pixels(traced);
        EXPECT_EQ(std::count(blind.begin(), blind.end(), 1) > 0, c.has_blind) << c.name;
        TraceInput input;
        input.scene = &traced, input.textures = &textures, input.key = {3, Stream::kTest};
        input.passes_per_iteration = 4;
        const Image image = render(input, 0, 4);
        std::size_t black = 0;
        for (std::size_t i = 0; i < blind.size(); ++i) {
            const bool is_black = image.values[3 * i] == 0;
            black += is_black;
            EXPECT_TRUE(blind[i] || !is_black) << c.name << ", pixel " << i;  // floor or sky
        }
        EXPECT_EQ(black > 0, c.has_blind) << c.name;
    }
    const std::vector<char> none = blind_pixels(straight);
    EXPECT_EQ(std::count(none.begin(), none.end(), 1), 0);
}

}  // namespace
}  // namespace burnish
