// The public gradient is the mean of the estimator's own estimates, at the textures that are given.
#include "gradient/mean_gradient.h"

#include <gtest/gtest.h>

#include <limits>

#include "burnish/error.h"
#include "burnish/gradient.h"
#include "optimize/strip_scene.h"
#include "render/renderer.h"

namespace burnish {
namespace {

constexpr std::uint32_t kSeed = 7;

struct Strips {
    Renderer renderer = make_renderer(test::make_strip_scene(12, 4));
    Image adjoint = make_image(12, 12, 3);

    Strips() {
        test::RandomSource random{17};
        for (float& a : adjoint.values) a = random.next(-1.0f, 1.0f);
    }
    const std::vector<Parameter>& parameters() const { return renderer.data().scene().parameters; }
};

/// Three estimates of four passes, at theta.
std::vector<Image> mean_of_three(const Strips& strips, const Theta& theta) {
    const Binding binding(strips.renderer.data().traced, theta);
    std::vector<std::vector<Image>> estimates;
    for (std::uint32_t i = 0; i < 3; ++i) {
        MonteCarloState state;
        const MonteCarlo options{.samples = 4, .adaptive_sampling = false};
        estimates.push_back(dense_gradient(
            theta, estimate_gradient(options, binding, strips.adjoint, kSeed, i, state).gradient));
    }
    std::vector<Image> mean = estimates[0];
    for (std::size_t t = 0; t < mean.size(); ++t)
        for (std::size_t k = 0; k < mean[t].values.size(); ++k) {
            double sum = 0;
            for (const auto& e : estimates) sum += double{e[t].values[k]};
            mean[t].values[k] = static_cast<float>(sum / 3);
        }
    return mean;
}

TEST(MeanGradient, IsThatOfTheEstimatesAtTheGivenTextures) {
    const Strips strips;
    const Theta theta = test::theta_of(strips.renderer.data().scene());
    std::vector<std::string> names;
    for (const Parameter& p : strips.parameters()) names.push_back(p.name);
    const GradientOptions options{.samples = 12, .seed = kSeed};
    const std::vector<Image> own =
        estimate_gradient(strips.renderer, names, strips.adjoint, options);
    EXPECT_EQ(own, mean_of_three(strips, theta));

    // One parameter, with another one's texels replaced, which is no unknown.
    Theta other{{theta.textures[0]}, {theta.textures[1]}};
    for (float& v : other.replaced[0].values.values) v = 0.9f;
    GradientOptions replaced = options;
    replaced.textures[names[1]] = other.replaced[0].values;
    const std::vector<Image> there =
        estimate_gradient(strips.renderer, {names[0]}, strips.adjoint, replaced);
    ASSERT_EQ(there.size(), 1u);
    EXPECT_EQ(there[0], mean_of_three(strips, other)[0]);
    EXPECT_NE(there[0], own[0]);
}

/// A grey plane under parallel light: nothing is noisy, and each pixel is the reflectance times its
/// derivative. A sum of floats would be wrong by 0.3 %.
TEST(MeanGradient, AddsUpAMillionSamplesOfOneTexel) {
    constexpr int kPixels = 512;
    Scene scene;
    scene.film = {kPixels, kPixels, 0, 0, kPixels, kPixels, {FilterKind::kBox, 0.5f}};
    scene.camera.to_world = look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0});
    scene.camera.fov_x = 40;
    scene.textures = {test::make_bitmap(1, 3, TextureFilter::kNearest, 0.5f, 0.5f, 1)};
    Diffuse diffuse;
    diffuse.reflectance.texture = {0};
    scene.bsdfs = {diffuse};
    scene.materials = {{"plane", {0}, {}}};
    scene.parameters = {{"plane.reflectance.data", {0}}};
    scene.shapes = {{"plane", test::make_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), {0}, {}}};
    DirectionalEmitter sun;
    sun.direction = {0.6f, 0, -0.8f};
    sun.irradiance = {2, 3, 1};
    scene.emitters = {sun};
    const Renderer renderer = make_renderer(scene);
    const Image gradient =
        estimate_gradient(renderer, {"plane.reflectance.data"},
                          make_image(kPixels, kPixels, 3, 1.0f), {.samples = 4})[0];
    const Image image = renderer.render(1, 0);
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t i = c; i < image.values.size(); i += 3) sum += double{image.values[i]};
        EXPECT_NEAR(double{gradient.values[c]} * 0.5 / sum, 1, 1e-5);
    }
}

TEST(MeanGradient, ReservoirsHaveNoHistory) {
    const Strips strips;
    const Theta theta = test::theta_of(strips.renderer.data().scene());
    const Binding binding(strips.renderer.data().traced, theta);
    const auto mean = [&](const Reservoirs& options) {
        return mean_gradient({options, 12, kSeed}, binding, strips.adjoint);
    };
    EXPECT_EQ(mean({.reuse = true}), mean({.reuse = false}));
    EXPECT_NE(mean({.positivization = false}), mean({.positivization = true}));
}

TEST(MeanGradient, ReportsEveryEstimate) {
    const Strips strips;
    const Theta theta = test::theta_of(strips.renderer.data().scene());
    std::vector<std::uint32_t> numbers;
    std::size_t records = 0;
    mean_gradient({MonteCarlo{}, 9, kSeed}, Binding(strips.renderer.data().traced, theta),
                  strips.adjoint, [&](const GradientCounts& counts, std::uint32_t i, auto count) {
                      EXPECT_EQ(count, 3u);
                      numbers.push_back(i);
                      records += counts.records;
                  });
    EXPECT_EQ(numbers, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_GT(records, 9u * 12 * 12 / 2);
}

TEST(MeanGradient, SaysWhatItCannotDo) {
    const Strips strips;
    const Theta theta = test::theta_of(strips.renderer.data().scene());
    const Binding binding(strips.renderer.data().traced, theta);
    EXPECT_THROW(mean_gradient({PathCache{}, 4, 0}, binding, strips.adjoint), InputError);
    EXPECT_THROW(mean_gradient({MonteCarlo{}, 0, 0}, binding, strips.adjoint), InputError);
    const std::string name = strips.parameters()[0].name;
    const auto refused = [&](const std::vector<std::string>& names, const Image& adjoint,
                             const GradientOptions& options) {
        EXPECT_THROW(estimate_gradient(strips.renderer, names, adjoint, options), InputError);
    };
    refused({}, strips.adjoint, {});
    refused({name, name}, strips.adjoint, {});
    refused({"nothing"}, strips.adjoint, {});
    Scene scene = test::make_strip_scene(12, 4);
    scene.parameters[0].name = "mat.base_color";
    const Image texels = theta.textures[0].values;
    const GradientOptions twice{.textures = {{"mat.base_color", texels}, {"base_color", texels}}};
    EXPECT_THROW(
        estimate_gradient(make_renderer(std::move(scene)), {"roughness"}, strips.adjoint, twice),
        InputError);
    refused({name}, make_image(12, 11, 3), {});
    refused({name}, make_image(12, 12, 1), {});
    refused({name}, {12, 12, 3, {1, 2, 3}}, {});
    Image broken = strips.adjoint;
    broken.values[100] = std::numeric_limits<float>::quiet_NaN();
    refused({name}, broken, {});
    refused({name}, make_image(12, 12, 3, 1e38f), {});
    refused({name}, strips.adjoint, {.samples = 0});
    refused({name}, strips.adjoint, {.textures = {{name, make_image(1, 1, 3)}}});
}

}  // namespace
}  // namespace burnish
