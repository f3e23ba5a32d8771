// Problems and options: what is refused, and what the optimiser is told.
#include "optimize/setup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "burnish/error.h"
#include "error_of.h"
#include "optimize/option_table.h"
#include "optimize/small_problem.h"
#include "optimize/state_cases.h"
#include "optimize/without_effect.h"
#include "render/renderer.h"

namespace burnish {
namespace {

Problem small_problem() { return test::problem_of(test::make_small_scene()); }

TEST(Setup, SharesTheLearningRateAmongTheUnknownsOfABsdf) {
    Problem problem = small_problem();
    problem.unknowns[0].learning_rate = 0;
    Options options;
    options.learning_rate = 0.03;
    const auto two = make_setup(problem, options);
    EXPECT_FLOAT_EQ(two.unknowns[0].adam.learning_rate, 0.015f);
    EXPECT_FLOAT_EQ(two.unknowns[1].adam.learning_rate, 0.05f) << "its own";
    problem.unknowns.pop_back();
    EXPECT_FLOAT_EQ(make_setup(problem, options).unknowns[0].adam.learning_rate, 0.03f);
}

TEST(Setup, GatesStepsWhereAGradientIsSplitAndThereAreLevels) {
    const auto adam_of = [](const Options& options) {
        return make_setup(small_problem(), options).unknowns[0].adam;
    };
    Options options;
    EXPECT_TRUE(adam_of(options).gate);
    EXPECT_FLOAT_EQ(adam_of(options).initial_rate, 0.02f);
    EXPECT_FLOAT_EQ(adam_of(options).weight_decay, options.pyramid.weight_decay);
    EXPECT_GT(adam_of(options).damping, 0);
    options.adam.initial_rate = 0.5f;
    EXPECT_FLOAT_EQ(adam_of(options).initial_rate, 0.5f);
    options = {};
    options.estimator = MonteCarlo{};
    EXPECT_FALSE(adam_of(options).gate);
    EXPECT_FLOAT_EQ(adam_of(options).initial_rate, 0);
    options = {};
    options.parameterization = Parameterization::kTexels;
    EXPECT_FALSE(adam_of(options).gate);
    EXPECT_FLOAT_EQ(adam_of(options).weight_decay, 0);
    EXPECT_FLOAT_EQ(adam_of(options).damping, 0);
    options.adam.gate = true;
    EXPECT_TRUE(adam_of(options).gate);
    options.parameterization = Parameterization::kPyramid;
    options.adam.gate = false;
    EXPECT_FALSE(adam_of(options).gate);
}

/// All pixels tell a constant: what they say is no noise.
TEST(Setup, DoesNotGateAConstant) {
    Scene scene = test::make_small_scene();
    scene.textures[0] = test::make_bitmap(1, 3, TextureFilter::kNearest, 0, 1, 1);
    Options options;
    const auto adam = [&] { return make_setup(test::problem_of(scene), options).unknowns[0].adam; };
    EXPECT_FALSE(adam().gate);
    EXPECT_FLOAT_EQ(adam().initial_rate, 0.02f);
    options.adam.gate = true;
    EXPECT_TRUE(adam().gate);
}

TEST(Setup, TexturesThatRepeatHaveNoBorders) {
    for (const TextureWrap wrap :
         {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp}) {
        Scene scene = test::make_small_scene();
        std::get<Bitmap>(scene.textures[0]).wrap = wrap;
        Options options;
        const auto repeats = [&] {
            return make_setup(test::problem_of(scene), options)
                .unknowns[0]
                .maps.prolongation.repeats;
        };
        EXPECT_EQ(repeats(), wrap == TextureWrap::kRepeat);
    }
}

/// Half of it for each of two unknowns of one material.
TEST(Setup, ChoosesALearningRateByTheStart) {
    Problem problem = small_problem();
    for (Unknown& u : problem.unknowns) u.learning_rate = 0;
    problem.unknowns[0].start = 0.5f, problem.unknowns[1].start = SearchStart{};
    const auto setup = make_setup(problem, {});
    EXPECT_FLOAT_EQ(setup.unknowns[0].adam.learning_rate, 0.005f);
    EXPECT_LE(setup.unknowns[1].adam.learning_rate, 0.0025f);
}

TEST(Setup, ABatchOfAllViewsHasAnEffect) {
    const Problem problem = small_problem();
    const Scene& scene = *problem.renderer.data().traced.scene;
    Options options;
    options.batch = 3;
    EXPECT_TRUE(options_without_effect(options, scene, {}, 3).empty());
    EXPECT_EQ(options_without_effect(options, scene, {}, 2).size(), 1u);
}

TEST(Setup, APyramidOfOneTexelHasOneLevel) {
    Scene scene = test::make_small_scene();
    const TextureId texture = scene.parameters[0].texture;
    Options options;
    options.pyramid.levels = 3, options.pyramid.weight_decay = 2;
    EXPECT_TRUE(options_without_effect(options, scene, {{texture}, {}}, 1).empty());
    auto& bitmap = std::get<Bitmap>(scene[texture]);
    bitmap.width = bitmap.height = 1;
    EXPECT_EQ(options_without_effect(options, scene, {{texture}, {}}, 1).size(), 2u);
    options.parameterization = Parameterization::kTexels;
    EXPECT_TRUE(options_without_effect(options, scene, {{texture}, {}}, 1).empty());
    options.parameterization = Parameterization::kPyramid;
    options.pyramid = {};
    EXPECT_TRUE(options_without_effect(options, scene, {{texture}, {}}, 1).empty());
}

TEST(Setup, LevelsThatTexturesDoNotHaveHaveNoEffect) {
    Scene scene = test::make_small_scene();
    const TextureId texture = scene.parameters[0].texture;
    auto& bitmap = std::get<Bitmap>(scene[texture]);
    bitmap.width = 64, bitmap.height = 33;
    Options options;
    const auto found = [&](int levels) {
        options.pyramid.levels = levels;
        return options_without_effect(options, scene, {{texture}, {}}, 1);
    };
    ASSERT_EQ(found(30).size(), 1u);
    EXPECT_EQ(found(30)[0],
              "pyramid.levels has no effect above 7, where a texel is the whole texture: found 30");
    EXPECT_EQ(make_maps(30, 64, 33, {}, false).sizes.size(), 7u);
    EXPECT_TRUE(found(7).empty());
    bitmap.width = bitmap.height = 2;
    EXPECT_TRUE(found(Pyramid{}.levels).empty()) << "which nobody asked for";
}

TEST(Setup, SearchesThatARunEndsBeforeHaveNoEffect) {
    const Scene scene = test::make_small_scene();
    const TextureId texture = scene.parameters[1].texture;
    Options options;
    options.search_again = 1000;
    const auto found = [&](std::uint32_t iterations) {
        options.stop.iterations = iterations;
        return options_without_effect(options, scene, {{texture}, {texture}}, 1);
    };
    ASSERT_EQ(found(250).size(), 1u);
    EXPECT_EQ(found(250)[0],
              "search_again has no effect in 250 iterations: the first search comes after 250, a "
              "quarter of 1000");
    EXPECT_TRUE(found(251).empty());
    options.stop = {};
    EXPECT_EQ(options_without_effect(options, scene, {{texture}, {texture}}, 1).size(), 1u)
        << "200 iterations";
    options.stop.seconds = 1;
    EXPECT_TRUE(options_without_effect(options, scene, {{texture}, {texture}}, 1).empty());
}

/// Expects that a change of a good problem is refused.
template <class Change>
void expect_refused(const char* what, const Change& change) {
    Problem problem = small_problem();
    Options options;
    EXPECT_NO_THROW(make_setup(problem, options));
    change(problem, options);
    EXPECT_THROW(make_setup(problem, options), InputError) << what;
}

TEST(Setup, RefusesProblemsThatDoNotFit) {
    using P = Problem;
    using O = Options;
    expect_refused("no view", [](P& p, O&) { p.views.clear(); });
    expect_refused("held out", [](P& p, O&) { p.views[0].held_out = true; });
    expect_refused("size", [](P& p, O&) { p.views[0].image = make_image(15, 16, 3); });
    expect_refused("channels", [](P& p, O&) { p.views[0].image = make_image(16, 16, 1); });
    expect_refused("mask", [](P& p, O&) { p.views[0].mask = make_image(16, 15, 1); });
    expect_refused("mask", [](P& p, O&) { p.views[0].mask = make_image(16, 16, 2); });
    expect_refused("no pixel of a view that is fitted", [](P& p, O&) {
        p.views.push_back(p.views[0]);
        p.views[1].held_out = true;
        p.views[0].mask = make_image(16, 16, 1);
    });
    expect_refused("no unknown", [](P& p, O&) { p.unknowns.clear(); });
    expect_refused("twice", [](P& p, O&) { p.unknowns[1] = p.unknowns[0]; });
    expect_refused("name", [](P& p, O&) { p.unknowns[0].name = "nothing"; });
    expect_refused("start", [](P& p, O&) { p.unknowns[0].start = 1.5f; });
    expect_refused("start", [](P& p, O&) { p.unknowns[0].start = NAN; });
    expect_refused("start", [](P& p, O&) { p.unknowns[0].start = make_image(3, 4, 3, 0.5f); });
    expect_refused("start", [](P& p, O&) { p.unknowns[0].start = make_image(4, 4, 3, -1.0f); });
}

/// An image of this shape with a value too few.
Image cut(Image image) {
    image.values.pop_back();
    return image;
}

TEST(Setup, RefusesImagesWithTooFewValues) {
    using P = Problem;
    using O = Options;
    expect_refused("picture", [](P& p, O&) { p.views[0].image = cut(make_image(16, 16, 3)); });
    expect_refused("mask", [](P& p, O&) { p.views[0].mask = cut(make_image(16, 16, 1, 1.0f)); });
    expect_refused("empty mask", [](P& p, O&) { p.views[0].mask = {16, 16, 1, {}}; });
    expect_refused("start", [](P& p, O&) {
        const ParameterInfo info = p.renderer.parameters()[0];
        p.unknowns[0].start = cut(make_image(info.width, info.height, info.channels, 0.5f));
    });
    expect_refused("environment", [](P& p, O&) {
        p.views[0].lighting.environment =
            Environment{share(cut(make_image(4, 2, 3, 0.5f))), {}, {}};
    });
    const Renderer renderer = small_problem().renderer;
    const ParameterInfo info = renderer.parameters()[0];
    const Image texels = make_image(info.width, info.height, info.channels, 0.5f);
    EXPECT_NO_THROW(renderer.render(1, 0, {{info.name, texels}}));
    EXPECT_THROW(renderer.render(1, 0, {{info.name, cut(texels)}}), InputError);
}

TEST(Setup, RefusesRanksThatAreNone) {
    for (const auto& [rank, count] : {std::pair{0, 0}, {-1, 2}, {2, 2}, {0, 2}}) {
        Problem problem = small_problem();
        problem.ranks.rank = rank, problem.ranks.count = count;
        EXPECT_THROW(make_setup(problem, {}), InputError) << rank << " of " << count;
    }
}

TEST(Setup, RefusesFilmsThatAreTooLarge) {
    const auto load = [](int width, int height) {
        return Renderer::load("none.xml", {.width = width, .height = height});
    };
    EXPECT_NE(test::error_of([&] { load(32769, 1); }).find("at most 32768"), std::string::npos);
    for (const int none : {0, -1})  // the scene's size is taken
        EXPECT_EQ(test::error_of([&] { load(32769, none); }).find("at most 32768"),
                  std::string::npos);
}

TEST(Setup, RefusesAnAdjointOfAnotherShapeThanTheImage) {
    for (const float exposure : {1.0f, 2.0f}) {
        Problem problem = small_problem();
        problem.views[0].exposure = ExposureFactors{exposure, exposure, exposure};
        Image adjoint;
        problem.loss = [&](const Image&, std::size_t) { return LossValue{0, adjoint}; };
        for (const Image& wrong : {Image{}, make_image(16, 16, 1), make_image(8, 8, 3),
                                   cut(make_image(16, 16, 3)), Image{16, 16, 3, {}}}) {
            adjoint = wrong;
            Solver solver(problem, Options{});
            EXPECT_THROW(solver.step(), InputError) << wrong.width << " " << wrong.channels;
        }
        adjoint = make_image(16, 16, 3);
        EXPECT_NO_THROW(Solver(problem, Options{}).step());
    }
}

TEST(Setup, RefusesEvaluationsOfTooFewOrFarTooManySamples) {
    const Solver solver(small_problem(), Options{});
    for (const std::uint32_t samples : {0u, 1u, (1u << 20) + 1, 4000000000u})
        EXPECT_THROW(solver.evaluate(samples), InputError) << samples;
    EXPECT_EQ(solver.evaluate(2).samples_per_pixel, 2u);
}

/// Samples of delta lobes are no records, so their light would not follow the texture.
TEST(Setup, RefusesUnknownsOfSmoothSurfaces) {
    const auto complaint_of = [](const Bsdf& bsdf) {
        Scene scene = test::make_small_scene();
        scene.bsdfs[0] = bsdf;
        set_texture(scene.bsdfs[0], 0, {0});
        scene.parameters.resize(1);
        return test::error_of([&] { make_setup(test::problem_of(scene), Options{}); });
    };
    EXPECT_EQ(complaint_of(RoughConductor{}), "");
    for (const Bsdf& bsdf : {Bsdf(Conductor{}), Bsdf(Plastic{}), Bsdf(Dielectric{})})
        EXPECT_NE(complaint_of(bsdf).find("a smooth conductor, plastic or dielectric: expected"),
                  std::string::npos)
            << complaint_of(bsdf);
}

/// What the unknown does beside the BSDF has no derivative, and records keep it as it was.
TEST(Setup, RefusesUnknownsThatTurnNormalsOrShine) {
    const Scene scene = test::make_small_scene();
    EXPECT_NO_THROW(make_setup(test::problem_of(scene), Options{}));
    Scene turned = scene;
    turned.materials[0].normals = NormalMap{.texture = {1}, .height_scale = 0.1f};
    EXPECT_THROW(make_setup(test::problem_of(turned), Options{}), InputError);
    Scene shining = scene;
    std::get<AreaEmitter>(shining.emitters[0]).texture = {0};
    EXPECT_THROW(make_setup(test::problem_of(shining), Options{}), InputError);
}

/// Numbers just outside of a range, and NaN.
template <class V>
std::vector<V> outside(const Range& range) {
    using Limits = std::numeric_limits<V>;
    if constexpr (std::is_floating_point_v<V>) {
        const V low = static_cast<V>(range.low), high = static_cast<V>(range.high);
        return {range.above_low ? low : std::nextafter(low, -Limits::infinity()),
                std::nextafter(high, Limits::infinity()), Limits::quiet_NaN()};
    } else {
        std::vector<V> values;
        if (range.low > static_cast<double>(Limits::lowest()))
            values.push_back(static_cast<V>(range.low) - 1);
        if (range.high < static_cast<double>(Limits::max()))
            values.push_back(static_cast<V>(range.high) + 1);
        return values;
    }
}

template <class T>
struct NumberOf {
    using Type = T;
};
template <class T>
struct NumberOf<std::optional<T>> {
    using Type = T;
};

/// Expects that options whose number of this row is out of range are refused by the row's name.
/// Returns how many were tried.
template <class T>
int expect_range(const OptionRow& row, OptionField<T> field, Options options) {
    using V = typename NumberOf<T>::Type;
    int tried = 0;
    if constexpr (std::is_arithmetic_v<V> && !std::is_same_v<V, bool>) {
        for (const V value : outside<V>(row.info.range)) {
            const bool is_unset = std::is_same_v<T, V> && *row.info.unset &&
                                  static_cast<double>(value) == row.info.unset_value;
            if (is_unset) continue;
            *field(options) = value, ++tried;
            const std::string error = test::error_of([&] { make_setup(small_problem(), options); });
            EXPECT_TRUE(error.starts_with(std::string(row.info.name) + ": expected a "))
                << row.info.name << " = " << value << ": " << error;
        }
    }
    return tried;
}

TEST(Setup, RefusesOptionsOutOfTheRangeOfTheTable) {
    for (const OptionRow& row : option_table()) {
        if (!is_number(row)) continue;
        Options options;
        for (const Choice<Estimator>& c : choices<Estimator>())
            if (!is_held(row, options)) options.estimator = c.value;
        const int tried =
            std::visit([&](auto field) { return expect_range(row, field, options); }, row.field);
        const bool takes_all = row.info.range.low == 0 &&
                               row.info.range.high == std::numeric_limits<std::uint32_t>::max();
        EXPECT_EQ(tried > 0, !takes_all) << row.info.name;
    }
}

TEST(Setup, RangesHoldTheirBounds) {
    for (const OptionRow& row : option_table()) {
        if (!is_number(row)) continue;
        const Range& range = row.info.range;
        EXPECT_EQ(complaint(row, std::to_string(range.high)), "") << row.info.name;
        EXPECT_EQ(complaint(row, std::to_string(range.low)).empty(), !range.above_low)
            << row.info.name;
    }
}

/// Above 0 as it is written, 0 as the float that it becomes.
TEST(Setup, TextIsInTheRangeOfAnOptionAsItIsRead) {
    const auto of_cap = [](const char* text) {
        return complaint(*std::ranges::find_if(option_table(),
                                               [](const OptionRow& row) {
                                                   return row.info.name ==
                                                          std::string("reservoirs.confidence_cap");
                                               }),
                         text);
    };
    EXPECT_EQ(of_cap("1e-60"), "expected a number above 0 and at most 1000000, found '1e-60'");
    EXPECT_EQ(of_cap("1e-30"), "");
}

TEST(Setup, RefusesRatesOfUnknownsOutOfRange) {
    for (const double rate : {-1.0, 1e-46, 1e-36, 1e39, double{INFINITY}, double{NAN}})
        expect_refused("rate", [&](Problem& p, Options&) { p.unknowns[0].learning_rate = rate; });
}

TEST(Setup, SaysThatTheMemoryOfACacheIsTooLittle) {
    Options options;
    options.estimator = PathCache{.max_bytes = 100};
    EXPECT_THROW(Solver(small_problem(), options), ResourceError);
}

}  // namespace
}  // namespace burnish
