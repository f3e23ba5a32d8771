// Constants of materials as unknowns: one value, or a texture in the place of it.
#include "scene/constants.h"

#include <gtest/gtest.h>

#include <cmath>

#include "error_of.h"
#include "optimize/estimators.h"
#include "optimize/small_problem.h"
#include "optimize/start_search.h"
#include "optimize/step_gradient.h"

namespace burnish {
namespace {

/// The small scene, whose floor has a metallic of 0.6, a constant colour and no clearcoat.
Scene scene_with_constants(int side = 16) {
    Scene scene = test::small_scene_of(side);
    auto& floor = std::get<Principled>(scene.bsdfs[0]);
    floor.base_color.texture = {};
    floor.base_color.constant = {0.7f, 0.4f, 0.2f};
    const auto input = [](PrincipledScalar s) { return 3 + static_cast<int>(s); };
    scene.parameters = {{"floor.brdf_0.roughness.data", {1}}};
    scene.constants = {
        {"floor.brdf_0.base_color.value", {0}, 0, true},
        {"floor.brdf_0.metallic.value", {0}, input(PrincipledScalar::kMetallic), true},
        {"floor.brdf_0.clearcoat.value", {0}, input(PrincipledScalar::kClearcoat), false},
        {"light.reflectance.value", {1}, 0, true}};
    return scene;
}

std::string complaint_of(const std::string& name, Scene scene = scene_with_constants()) {
    return test::error_of([&] { require_parameter(scene, name); });
}

Problem problem_of_constants(Scene scene, const std::vector<std::string>& names, Start start) {
    Problem problem{make_renderer(scene), {}, {}};
    problem.views = {{problem.renderer.render(256, 3)}};
    std::vector<std::string> full;
    for (const std::string& n : names)
        full.push_back(scene.parameters[require_parameter(scene, n)].name);
    problem.renderer = make_renderer(scene);
    for (const std::string& n : full) problem.unknowns.push_back({n, start});
    return problem;
}

TEST(Constants, BecomeTexturesOfTheirValue) {
    Scene scene = scene_with_constants();
    const Image before = make_renderer(scene).render(8, 1);
    const std::size_t one = require_parameter(scene, "floor.metallic");
    EXPECT_EQ(scene.parameters[one].name, "floor.brdf_0.metallic.value");
    EXPECT_EQ(require_parameter(scene, "floor.metallic"), one) << "once";
    const std::size_t color = require_parameter(scene, "floor.base_color:8x4");
    EXPECT_EQ(scene.parameters[color].name, "floor.brdf_0.base_color.data");
    const auto& bitmap = std::get<Bitmap>(scene[scene.parameters[color].texture]);
    EXPECT_EQ(bitmap.width, 8);
    EXPECT_EQ(bitmap.height, 4);
    EXPECT_EQ(bitmap.channels, 3);
    EXPECT_FALSE(bitmap.raw);
    EXPECT_EQ(linear_image(bitmap).at(7, 3, 1), 0.4f);
    require_parameter(scene, "clearcoat");
    EXPECT_TRUE(std::get<Principled>(scene.bsdfs[0]).has_clearcoat) << "it may be there now";
    const Image after = make_renderer(scene).render(64, 1);
    const Image reference = make_renderer(scene_with_constants()).render(64, 2);
    double sum = 0, difference = 0;
    for (std::size_t i = 0; i < before.values.size(); ++i) {
        sum += double{reference.values[i]};
        difference += double{after.values[i]} - double{reference.values[i]};
    }
    EXPECT_LT(std::abs(difference), 0.02 * sum) << "the scene looks as before";
}

TEST(Constants, WhatIsWrongIsSaid) {
    EXPECT_EQ(complaint_of("floor.metallic"), "");
    EXPECT_EQ(complaint_of("floor.roughness:8"), "") << "the size that it has";
    EXPECT_EQ(
        complaint_of("floor.roughness:16"),
        "floor.roughness:16: floor.brdf_0.roughness.data is a bitmap of 8 x 8 texels: expected "
        "no other size");
    EXPECT_EQ(complaint_of("metalic"),
              "no parameter is called 'metalic', did you mean: floor.brdf_0.metallic.value");
    EXPECT_NE(complaint_of("value").find("ambiguous"), std::string::npos);
    for (const char* no_size : {"floor.metallic:0", "floor.metallic:", "floor.metallic:9x",
                                "floor.metallic:99999", "floor.metallic:-4", "floor.metallic:x8"})
        EXPECT_NE(complaint_of(no_size), "") << no_size;
    Scene bare = scene_with_constants();
    std::get<Mesh>(bare.shapes[0].geometry).uvs.clear();
    EXPECT_EQ(complaint_of("floor.metallic", bare), "");
    EXPECT_EQ(complaint_of("floor.metallic:8", bare),
              "floor.brdf_0.metallic.value: the shape 'floor' has no texture coordinates: expected "
              "some, or no size, for one value");
    Problem problem{make_renderer(scene_with_constants()), {{make_image(16, 16, 3, 0.2f)}}, {}};
    const std::string full = "floor.brdf_0.metallic.value";
    for (const auto& [name, start] :
         {std::pair{"floor.metallic", "floor.metallic: " + full}, std::pair{full.c_str(), full}}) {
        problem.unknowns = {{name, 0.5f}};
        const std::string error = test::error_of([&] { Solver(problem, {}); });
        EXPECT_TRUE(error.starts_with(start + " is a constant: expected a renderer")) << error;
    }
}

std::string complaint_of_unknown(const Scene& scene, const std::string& name) {
    Problem problem{make_renderer(scene), {{make_image(16, 16, 3, 0.2f)}}, {{name, 0.5f}}};
    return test::error_of([&] { Solver(problem, {}); });
}

/// A bitmap of "floor.001" and a constant of "floor".
TEST(Constants, AreMeantBeforeBitmapsOfOtherMaterials) {
    const auto make = [](bool is_given = true) {
        Scene scene = scene_with_constants();
        scene.parameters[0].name = "floor.001.brdf_0.roughness.data";
        scene.constants.push_back({"floor.brdf_0.roughness.value",
                                   {0},
                                   3 + static_cast<int>(PrincipledScalar::kRoughness),
                                   is_given});
        return scene;
    };
    EXPECT_EQ(complaint_of("roughness", make(false)), "") << "a default is not meant beside others";
    for (const auto& [name, full] :
         {std::pair{"floor.001.roughness", "floor.001.brdf_0.roughness.data"},
          {"floor.roughness", "floor.brdf_0.roughness.value"},
          {"floor.roughness:16", "floor.brdf_0.roughness.data"}}) {
        Scene scene = make();
        EXPECT_EQ(scene.parameters[require_parameter(scene, name)].name, full);
    }
    const std::string ambiguous =
        "the parameter name 'roughness' is ambiguous, it matches: "
        "floor.001.brdf_0.roughness.data, floor.brdf_0.roughness.value";
    EXPECT_EQ(complaint_of("roughness", make()), ambiguous);
    EXPECT_EQ(complaint_of_unknown(make(), "roughness"), ambiguous);
    EXPECT_TRUE(complaint_of_unknown(make(), "floor.roughness")
                    .starts_with("floor.roughness: floor.brdf_0.roughness.value is a constant"));
    Scene attribute = make();
    attribute.constants.clear();
    attribute.attribute_inputs = {"floor.brdf_0.roughness.data"};
    EXPECT_EQ(complaint_of("floor.001.roughness", attribute), "");
    EXPECT_NE(complaint_of("floor.roughness", attribute).find("reads a mesh attribute"),
              std::string::npos);
}

TEST(Constants, SizesOfUnknownsBelongToTheRenderer) {
    const Scene scene = scene_with_constants();
    EXPECT_EQ(complaint_of_unknown(scene, "floor.metallic:16"),
              "floor.metallic:16: floor.brdf_0.metallic.value is a constant: expected a renderer "
              "that was loaded with floor.metallic:16 among its constants");
    EXPECT_EQ(complaint_of_unknown(scene, "floor.roughness:8"),
              "floor.roughness:8: expected no size, which is for constants that a renderer is "
              "loaded with");
    EXPECT_EQ(complaint_of_unknown(scene, "floor.metalic:16"),
              "no parameter is called 'floor.metalic', did you mean: floor.brdf_0.metallic.value");
}

TEST(Constants, SizesAreOfAtMost16384TexelsASide) {
    EXPECT_EQ(split_size("m:16384").height, 16384);
    EXPECT_EQ(split_size("m:1x16384").height, 16384);
    for (const char* text : {"m:16385", "m:1x16385", "m:0", "m:0x1", "m:1x"}) {
        EXPECT_EQ(split_size(text).name, text);
        EXPECT_EQ(split_size(text).width, 0) << text;
    }
}

/// The derivative by one value is the sum of those by the texels that stand for it.
TEST(Constants, TheGradientIsTheSumOverTexels) {
    PathCache cache;
    cache.window = 2;
    for (const Estimator& estimator : {Estimator{cache}, Estimator{MonteCarlo{8, 2, false}},
                                       Estimator{MonteCarlo{8, 2, true}}}) {
        const auto gradient_with = [&](const std::string& size) {
            Problem problem =
                problem_of_constants(scene_with_constants(), {"floor.metallic" + size}, 0.6f);
            problem.views[0].image = make_image(16, 16, 3, 0.1f);
            Solver solver(problem, test::gradient_options(estimator));
            solver.step();
            const std::vector<Image> gradient = test::gradient_of(solver);
            double sum = 0;
            for (const float v : gradient[0].values) sum += double{v};
            return sum;
        };
        const double by_value = gradient_with("");
        EXPECT_NEAR(by_value, gradient_with(":16"), 1e-4 * std::abs(by_value));
        EXPECT_NE(by_value, 0);
    }
}

/// The mean of each unknown's values over the later iterations: those of one iteration are noisy.
std::vector<Image> mean_textures(const Problem& problem, const Options& options) {
    constexpr int kFirst = 100, kIterations = 250;
    Solver solver(problem, options);
    std::vector<Image> mean(problem.unknowns.size());
    for (int i = 0; i < kIterations; ++i) {
        solver.step();
        for (std::size_t t = 0; t < mean.size() && i >= kFirst; ++t) {
            const Image now = solver.texture(t);
            if (i == kFirst) mean[t] = make_image(now.width, now.height, now.channels);
            for (std::size_t k = 0; k < now.values.size(); ++k)
                mean[t].values[k] += now.values[k] / (kIterations - kFirst);
        }
    }
    return mean;
}

/// With images of enough passes: metallic and colour trade places where they are noisy.
Estimator with_window(Estimator estimator, std::uint32_t passes) {
    const auto widen = [&](auto& o) {
        if constexpr (requires { o.image_window; })
            if (o.image_window > 0) o.image_window = passes;
    };
    std::visit(widen, estimator);
    return estimator;
}

TEST(Constants, AreRecoveredByEveryEstimator) {
    for (const auto& [name, estimator] : test::all_estimators(16, 8)) {
        const Problem problem = problem_of_constants(scene_with_constants(),
                                                     {"floor.metallic", "floor.base_color"}, 0.5f);
        Options options;
        options.estimator = with_window(estimator, 16);
        options.learning_rate = 0.02;
        const std::vector<Image> mean = mean_textures(problem, options);
        EXPECT_EQ(mean[0].width, 1);
        EXPECT_NEAR(mean[0].values[0], 0.6, 0.06) << name;
        EXPECT_NEAR(mean[1].values[0], 0.7, 0.03) << name;
        EXPECT_NEAR(mean[1].values[2], 0.2, 0.03) << name;
    }
}

TEST(Constants, OneTexelIsOneLevelAndOneRegion) {
    const Problem problem =
        problem_of_constants(scene_with_constants(), {"floor.metallic"}, SearchStart{});
    burnish::Setup setup = make_setup(problem, {});
    EXPECT_EQ(setup.unknowns[0].maps.sizes.size(), 1u);
    const SearchReport report = find_starts(setup);
    ASSERT_EQ(report.groups.size(), 1u);
    std::size_t regions = 0;
    for (const SearchedValues& v : report.groups[0].tried) regions += v.regions;
    EXPECT_EQ(regions, 1u);
    EXPECT_NEAR(setup.unknowns[0].start.values[0], 0.6f, 0.15f);
    for (const Parameterization p : {Parameterization::kPyramid, Parameterization::kTexels}) {
        Options options;
        options.parameterization = p;
        Solver solver(problem, options);
        for (int i = 0; i < 3; ++i) solver.step();
        Solver again(problem, options, load_state(save_state(solver.state())));
        solver.step(), again.step();
        EXPECT_TRUE(solver.state() == again.state());
    }
}

}  // namespace
}  // namespace burnish
