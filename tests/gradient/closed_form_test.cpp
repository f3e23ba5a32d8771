// Scenes whose images, and the derivatives of whose images, are known in closed form, through the
// whole renderer and the gradient estimators. All are diffuse, so L = rho E / pi:
//
//   a convex body under a constant sky    E = pi Le, whatever its shape: L = rho Le
//   a point light over a plane            E = I cos / d^2
//   a rectangle of light over a plane     E = Le / 2 sum_k angle_k (n . edge normal_k) [Lambert
//   1760]
//
// and dL / drho = E / pi: the derivative by a texel is a sum over the pixels that show it.
#include <gtest/gtest.h>

#include "gradient/estimators.h"
#include "gradient/small_scene.h"
#include "ledger_entries.h"
#include "render/render.h"
#include "student.h"

namespace burnish {
namespace {

using namespace test::ledger;
using test::accepted;
using test::rejected;
using test::scaled;
using test::seed_of;
using Point = Vec3<double>;
using Irradiance = Vec3<double> (*)(const Point&);

constexpr int kSide = 16;                      ///< pixels a side
constexpr double kFloor = 1.25, kTexel = 0.5;  ///< half a side of the plane, a texel
constexpr int kFloorTexels = static_cast<int>(2 * kFloor / kTexel);  ///< a side

/// A scene, its exact image, and which texel of its texture each pixel shows.
struct ClosedForm {
    Scene scene;
    std::vector<double> image;  ///< [pixel][channel]
    std::vector<int> texel;     ///< of each pixel
};

Scene empty_scene(const Bitmap& reflectance) {
    Scene scene;
    scene.film = {kSide, kSide, 0, 0, kSide, kSide, {FilterKind::kBox, 0.5f}};
    scene.textures = {reflectance};
    Diffuse diffuse, black;
    diffuse.reflectance.texture = {0};
    black.reflectance.constant = {0, 0, 0};
    scene.bsdfs = {diffuse, black};
    scene.materials = {{"body", {0}, {}}, {"black", {1}, {}}};
    scene.parameters = {{"body.reflectance.data", {0}}};
    return scene;
}

double reflectance(const Scene& scene, int texel, int channel) {
    const auto& bitmap = std::get<Bitmap>(scene.textures[0]);
    return double{bitmap.values[static_cast<std::size_t>(3 * texel + channel)]};
}

// ---- A convex body under a constant sky

const Rgbf kSky{0.7f, 1.1f, 1.6f};

ClosedForm make_convex_body() {
    ClosedForm form;
    form.scene = empty_scene(test::make_bitmap(1, 3, TextureFilter::kNearest, 0.3f, 0.8f, 71));
    form.scene.film.filter = {};  // a Gaussian: of a constant it leaves the constant
    form.scene.camera.to_world = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    form.scene.camera.fov_x = 9;
    form.scene.shapes = {{"body", Sphere{}, {0}, {}}};
    form.scene.emitters = {ConstantEmitter{kSky}};
    for (int pixel = 0; pixel < kSide * kSide; ++pixel) {
        form.texel.push_back(0);
        for (int c = 0; c < 3; ++c)
            form.image.push_back(reflectance(form.scene, 0, c) * double{kSky[c]});
    }
    return form;
}

// ---- A plane, seen from above: the film shows [-1, 1]^2 of it, a pixel 1/8 a side

ClosedForm make_plane(Irradiance irradiance) {
    ClosedForm form;
    form.scene =
        empty_scene(test::make_bitmap(kFloorTexels, 3, TextureFilter::kNearest, 0.3f, 0.8f, 72));
    form.scene.camera.to_world = look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0});
    form.scene.camera.fov_x = 2 * std::atan(0.5) * 180 / std::numbers::pi;
    constexpr float edge = static_cast<float>(kFloor);
    form.scene.shapes = {
        {"plane", test::make_quad({-edge, -edge, 0}, {2 * edge, 0, 0}, {0, 2 * edge, 0}), {0}, {}}};
    constexpr int kSteps = 32;  // midpoints: an error of 1e-6
    constexpr double kPixel = 2.0 / kSide;
    for (int row = 0; row < kSide; ++row)
        for (int column = 0; column < kSide; ++column) {
            const double left = -1 + column * kPixel, top = 1 - row * kPixel;
            const int texel =
                static_cast<int>((top - kPixel / 2 + kFloor) / kTexel) * kFloorTexels +
                static_cast<int>((left + kPixel / 2 + kFloor) / kTexel);
            form.texel.push_back(texel);
            Point sum{};
            for (int j = 0; j < kSteps; ++j)
                for (int i = 0; i < kSteps; ++i)
                    sum += irradiance(
                        {left + (i + 0.5) / kSteps * kPixel, top - (j + 0.5) / kSteps * kPixel, 0});
            for (int c = 0; c < 3; ++c)
                form.image.push_back(reflectance(form.scene, texel, c) * sum[c] /
                                     (kSteps * kSteps * std::numbers::pi));
        }
    return form;
}

const Point kLamp{0.4, -0.3, 0.6};
const Rgbf kIntensity{2, 3, 1};

Point in_double(const Rgbf& c) { return {double{c.x}, double{c.y}, double{c.z}}; }

Point irradiance_of_point(const Point& p) {
    const Point d = kLamp - p;
    return in_double(kIntensity) * (d.z / (length(d) * dot(d, d)));
}

Point irradiance_without_cosine(const Point& p) {
    const Point d = kLamp - p;
    return in_double(kIntensity) * (1 / dot(d, d));
}

Scene with_lamp(Scene scene, double height) {
    scene.emitters = {PointEmitter{
        {static_cast<float>(kLamp.x), static_cast<float>(kLamp.y), static_cast<float>(height)},
        kIntensity}};
    return scene;
}

const Rgbf kPanel{5, 8, 6};
const Vec3f kCorner{0.8f, -0.6f, 0.7f}, kU{0.1f, 1.1f, 0.2f}, kV{0.7f, 0, -0.1f};

/// kPanel's light on an upward plane.
Point irradiance_of_rectangle(const Point& p) {
    std::array<Point, 4> to;
    const std::array<Vec3f, 4> corners{kCorner, kCorner + kU, kCorner + kU + kV, kCorner + kV};
    for (std::size_t k = 0; k < 4; ++k) to[k] = normalize(in_double(corners[k]) - p);
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Point normal = cross(to[k], to[(k + 1) % 4]);
        sum += std::acos(dot(to[k], to[(k + 1) % 4])) * normal.z / length(normal);
    }
    return in_double(kPanel) * (std::abs(sum) / 2);
}

Scene with_panel(Scene scene, float size) {
    scene.emitters = {AreaEmitter{kPanel, {1}}};
    scene.shapes.push_back({"panel", test::make_quad(kCorner, kU, kV * size), {1}, {0}});
    return scene;
}

ClosedForm make_point_light() {
    ClosedForm form = make_plane(irradiance_of_point);
    form.scene = with_lamp(form.scene, kLamp.z);
    return form;
}

ClosedForm make_rectangle_light() {
    ClosedForm form = make_plane(irradiance_of_rectangle);
    form.scene = with_panel(form.scene, 1);
    return form;
}

// ---- Values

/// The values of all pixels, and the mean of each channel over them.
std::vector<double> with_means(std::vector<double> pixels) {
    const std::size_t count = pixels.size();
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t i = c; i < count; i += 3) sum += pixels[i];
        pixels.push_back(sum / static_cast<double>(count / 3));
    }
    return pixels;
}

/// Sums in single precision, and the midpoints behind the exact value, relative to it.
constexpr double kRelativeRounding = 5e-6;

/// p-value of "the expected value of every pixel, and of their mean, is the exact one".
double image_p_value(const ClosedForm& form) {
    const TracedScene traced = prepare(form.scene);
    const TextureTable textures{form.scene.textures, {}};
    const std::vector<double> exact = with_means(form.image);
    std::vector<test::RunningMean> means(exact.size());
    constexpr std::uint32_t kPasses = 16;
    for (std::uint32_t b = 0; b < scaled(kClosedImages, 256u); ++b) {
        const TraceInput input{
            &traced, &textures,           {seed_of(kClosedImages, b), Stream::kTest},
            kPasses, SurfaceChoice::kAll, {}};
        const Image image = render(input, 0, kPasses);
        const std::vector<double> values = with_means({image.values.begin(), image.values.end()});
        for (std::size_t i = 0; i < means.size(); ++i) means[i].add(values[i]);
    }
    return test::exact_p_value(means, exact, kRelativeRounding);
}

TEST(ClosedForm, ConvexBodyUnderAConstantSkyShowsRhoTimesLe) {
    ClosedForm form = make_convex_body();
    EXPECT_TRUE(accepted(kClosedImages, "constant sky", image_p_value(form)));
    Sphere occluder;
    occluder.center = {1.5f, 0, 2.5f};
    occluder.radius = 0.25f;
    form.scene.shapes.push_back({"occluder", occluder, {1}, {}});
    EXPECT_TRUE(rejected(kClosedImages, "sky occluded by 1 %", image_p_value(form)));
}

TEST(ClosedForm, PointLightObeysTheInverseSquareAndTheCosine) {
    ClosedForm form = make_point_light();
    EXPECT_TRUE(accepted(kClosedImages, "point light", image_p_value(form)));
    ClosedForm flat = form;
    flat.image = make_plane(irradiance_without_cosine).image;
    EXPECT_TRUE(rejected(kClosedImages, "cosine left out", image_p_value(flat)));
    form.scene = with_lamp(form.scene, 1.01 * kLamp.z);
    EXPECT_TRUE(rejected(kClosedImages, "lamp 1 % higher", image_p_value(form)));
}

TEST(ClosedForm, RectangleLightObeysItsFormFactor) {
    ClosedForm form = make_rectangle_light();
    EXPECT_TRUE(accepted(kClosedImages, "rectangle", image_p_value(form)));
    form.scene = with_panel(make_plane(irradiance_of_rectangle).scene, 1.02f);
    EXPECT_TRUE(rejected(kClosedImages, "rectangle 2 % longer", image_p_value(form)));
}

// ---- Derivatives

/// dL / drho of each texel and channel, for the adjoint A: sum of A I / rho over its pixels.
std::vector<double> exact_gradient(const ClosedForm& form, const Image& adjoint, bool divide) {
    const auto& bitmap = std::get<Bitmap>(form.scene.textures[0]);
    std::vector<double> gradient(bitmap.values.size());
    for (std::size_t pixel = 0; pixel < form.texel.size(); ++pixel)
        for (int c = 0; c < 3; ++c) {
            const std::size_t from = 3 * pixel + static_cast<std::size_t>(c);
            const std::size_t to = static_cast<std::size_t>(3 * form.texel[pixel] + c);
            const double rho = divide ? reflectance(form.scene, form.texel[pixel], c) : 1;
            gradient[to] += double{adjoint.values[from]} * form.image[from] / rho;
        }
    return gradient;
}

/// p-value of "the gradient of every texel and channel is the exact one". `divide`: by rho, as it
/// must be.
double gradient_p_value(const ClosedForm& form, const Estimator& estimator, bool divide = true) {
    const TracedScene traced = prepare(form.scene);
    const Theta theta = test::theta_of(form.scene);
    const Binding binding(traced, theta);
    const Image adjoint = test::make_adjoint(form.scene, 73, true);
    const std::vector<double> exact = exact_gradient(form, adjoint, divide);
    const std::uint32_t iterations = std::holds_alternative<MonteCarlo>(estimator) ? 1 : 3;
    std::vector<test::RunningMean> means(exact.size());
    for (std::uint32_t run = 0; run < scaled(kClosedGradients, 600u); ++run) {
        EstimatorState state = make_state(estimator);
        GradientResult result;
        for (std::uint32_t v = 0; v < iterations; ++v)
            result = test::estimate(estimator, binding, adjoint,
                                    {seed_of(kClosedGradients, run), v}, state);
        const Image image = dense_gradient(theta, result.gradient)[0];
        for (std::size_t i = 0; i < means.size(); ++i) means[i].add(double{image.values[i]});
    }
    return test::exact_p_value(means, exact, kRelativeRounding);
}

TEST(ClosedForm, DerivativesByReflectanceAreTheIrradianceOverPi) {
    const std::pair<const char*, ClosedForm> forms[] = {{"constant sky", make_convex_body()},
                                                        {"point light", make_point_light()},
                                                        {"rectangle", make_rectangle_light()}};
    Reservoirs pgris = test::by_integrand(test::pgris());
    pgris.samples = 2;
    for (const auto& [name, form] : forms)
        for (const Estimator& estimator : {Estimator{test::mc(2)}, Estimator{pgris}})
            EXPECT_TRUE(accepted(kClosedGradients,
                                 std::string(name) + ", " + test::name_of(estimator),
                                 gradient_p_value(form, estimator)));
    for (const auto& [name, form] : forms)
        EXPECT_TRUE(rejected(kClosedGradients, "value taken for the derivative",
                             gradient_p_value(form, test::mc(2), false)))
            << name;
}

}  // namespace
}  // namespace burnish
