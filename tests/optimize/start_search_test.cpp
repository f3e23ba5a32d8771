// The search for the start: known answers, the valley that descent misses, and what it leaves
// alone.
#include "optimize/start_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "burnish/error.h"
#include "core/parallel.h"
#include "gradient/small_scene.h"
#include "optimize/floor_scene.h"
#include "optimize/search_uniform.h"
#include "optimize/state.h"
#include "shading/filter.h"

namespace burnish {
namespace {

using namespace test;

double error_after(const Scene& scene, Start start, int iterations) {
    Options options;
    options.loss = Loss::kRelMse;
    Solver solver(searched_problem(scene, start), options);
    for (int i = 0; i < iterations; ++i) solver.step();
    return distance_of(solver.texture(0), truth_of(scene, 0));
}

/// From 0.5 the picture gets better towards matt under relMSE: beyond the hump of the loss lies
/// another valley. Replacing the search by 0.5 is the seeded defect that must fail here.
TEST(StartSearch, StartsInTheValleyThatDescentMisses) {
    const Scene scene = smooth_scene();
    const auto starts_right = [&](const Start& start) {
        return error_after(scene, start, 0) < 0.1 && error_after(scene, start, 60) < 0.1;
    };
    EXPECT_TRUE(starts_right(SearchStart{}));
    EXPECT_FALSE(starts_right(0.5f));
    EXPECT_GT(error_after(scene, 0.5f, 60), error_after(scene, 0.5f, 0)) << "away from the truth";
}

/// By powers of two, so that nothing is rounded otherwise. The picture's white is below 1.
TEST(StartSearch, IsTheSameHoweverDarkThePictureIs) {
    const auto searched = [](float brightness) {
        Scene scene = smooth_scene();
        scene.emitters = {
            AreaEmitter{{8 * brightness, 8 * brightness, 8 * brightness}, {1}},
            ConstantEmitter{{0.01f * brightness, 0.01f * brightness, 0.01f * brightness}}};
        return Solver(searched_problem(scene, SearchStart{}), {}).texture(0);
    };
    const Image expected = searched(1);
    EXPECT_LT(distance_of(expected, truth_of(smooth_scene(), 0)), 0.1);
    for (const int power : {-4, -20, -40})
        EXPECT_EQ(searched(std::ldexp(1.0f, power)), expected) << power;
}

/// Of a dark photograph whose exposure is fitted, too.
TEST(StartSearch, IsTheSameHoweverDarkAPhotographIs) {
    const Scene scene = smooth_scene();
    const auto searched = [&](float exposure) {
        Problem problem = searched_problem(scene, SearchStart{});
        for (float& v : problem.views[0].image.values) v *= exposure;
        problem.views[0].exposure = FitExposure{};
        return Solver(problem, {}).texture(0);
    };
    const Image expected = searched(0.25f);
    EXPECT_LT(distance_of(expected, truth_of(scene, 0)), 0.15);  // 0.385 from 0.5
    for (const int power : {-6, -12})
        EXPECT_EQ(searched(std::ldexp(1.0f, power)), expected) << power;
}

/// Of a picture of few tiles, too.
TEST(StartSearch, TellsHowFarItIs) {
    const Scene scene = smooth_scene();
    const Problem problem = searched_problem(scene, SearchStart{});
    std::vector<double> told;
    const Solver solver(problem, {}, [&](const std::string& stage, double share) {
        if (stage == "searching the start") told.push_back(share);
    });
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    ASSERT_FALSE(told.empty());
    EXPECT_LT(told.front(), 1);
    EXPECT_EQ(told.back(), 1);
    EXPECT_TRUE(std::ranges::any_of(told, [](double share) { return share > 0.2 && share < 0.8; }));
}

/// No view sees an unknown, as where light alone that bounces comes from it.
TEST(StartSearch, TellsThatItIsDoneWhereNothingIsSeen) {
    Scene scene = smooth_scene();
    scene.camera.to_world = look_at({0, 0, 5}, {0, 0, 10}, {0, 1, 0});
    std::vector<double> told;
    const Solver solver(searched_problem(scene, SearchStart{}), {},
                        [&](const std::string&, double share) { told.push_back(share); });
    ASSERT_FALSE(told.empty());
    EXPECT_EQ(told.back(), 1);
}

TEST(StartSearch, FindsColorsByTheRatioOfPictureAndRender) {
    Principled floor;  // neither lobe but the diffuse one matters much
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].constant = 0.8f;
    const Scene scene = floor_scene(floor, {bitmap_of(8, 3, [](int x, int, int c) {
                                        return (x < 4 ? 0.2f : 0.7f) + 0.1f * static_cast<float>(c);
                                    })});
    const Solver solver(searched_problem(scene, SearchStart{}), {});
    const Image truth = truth_of(scene, 0);
    for (const int x0 : {1, 5})  // away from the edge, which pixels blur
        for (int c = 0; c < 3; ++c) {
            double mean = 0;  // a texel has few pixels: what is left of their noise is several %
            for (int y = 0; y < 8; ++y)
                for (int x = x0; x < x0 + 2; ++x)
                    mean += double{solver.texture(0).at(x, y, c)} / 16;
            EXPECT_NEAR(mean, truth.at(x0, 0, c), 0.02 * double{truth.at(x0, 0, c)}) << x0;
        }
}

Bitmap halves(int side, float left, float right) {
    return bitmap_of(side, 1, [=](int x, int, int) { return 2 * x < side ? left : right; });
}

/// Roughness and metallic of one material, with textures of different sizes.
TEST(StartSearch, SearchesUnknownsOfOneMaterialTogether) {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    floor[PrincipledScalar::kMetallic].texture = {1};
    const Scene scene = floor_scene(floor, {halves(16, 0.12f, 0.35f), halves(8, 1, 0)});
    Options options;
    options.stop.iterations = 1, options.evaluation_samples = 2;
    const Summary summary = solve(searched_problem(scene, SearchStart{}), options);
    ASSERT_EQ(summary.searched.size(), 1u);
    EXPECT_EQ(summary.searched[0].unknowns, (std::vector<std::size_t>{0, 1}));
    EXPECT_EQ(summary.searched[0].tried.size(), 30u);
    EXPECT_LT(distance_of(summary.textures[0].start, truth_of(scene, 0)), 0.15);
    EXPECT_LT(distance_of(summary.textures[1].start, truth_of(scene, 1)), 0.15);
}

/// The regions are those of the texture with the most texels, whatever is named first.
TEST(StartSearch, RegionsAreThoseOfTheFinestTexture) {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    floor[PrincipledScalar::kMetallic].texture = {1};
    const Bitmap roughness =
        bitmap_of(16, 1, [](int x, int y, int) { return (x / 4 + y / 4) % 2 ? 0.08f : 0.35f; });
    Scene scene = floor_scene(floor, {roughness, halves(2, 1, 1)});
    const Solver finest_first(searched_problem(scene, SearchStart{}), {});
    EXPECT_LT(distance_of(finest_first.texture(0), truth_of(scene, 0)), 0.15);
    std::swap(scene.parameters[0], scene.parameters[1]);
    const Solver finest_last(searched_problem(scene, SearchStart{}), {});
    EXPECT_EQ(finest_last.texture(1), finest_first.texture(0));
    EXPECT_EQ(finest_last.texture(0), finest_first.texture(1));
}

/// Two texels of the second texture, one above the other, for one of the first, which is wide and
/// has more; its regions are texels.
TEST(StartSearch, TexelsOfATextureLieInTheRegionsAroundThem) {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    floor[PrincipledScalar::kMetallic].texture = {1};
    Bitmap roughness = bitmap_of(16, 1, [](int, int y, int) { return y % 4 < 2 ? 0.12f : 0.35f; });
    roughness.width = 64, roughness.height = 4;
    roughness.filter = TextureFilter::kBilinear;
    const Scene scene = floor_scene(floor, {roughness, halves(8, 1, 0)});
    const Solver solver(searched_problem(scene, SearchStart{}), {});
    const Image& metallic = solver.texture(1);
    EXPECT_LT(distance_of(metallic, truth_of(scene, 1)), 0.3);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_EQ(metallic.at(x, y, 0), metallic.at(x, y & ~1, 0)) << x << ' ' << y;
}

/// A colour that is not much coarser keeps its regions, which have more squares each.
TEST(StartSearch, RegionsAreThoseOfAColorUnlessOthersAreMuchFiner) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].texture = {1};
    const auto regions_with = [&](int color, int roughness, bool color_first) {
        const Bitmap color_map = bitmap_of(color, 3, [](int, int, int) { return 0.5f; });
        Scene scene = floor_scene(floor, {color_map, halves(roughness, 0.3f, 0.3f)});
        if (!color_first) std::swap(scene.parameters[0], scene.parameters[1]);
        const auto setup = make_setup(searched_problem(scene, SearchStart{}), {});
        const SearchInput input = search_input(setup);
        return make_search_plan(input.views, input.unknowns, 0).groups.at(0).regions.width;
    };
    for (const bool color_first : {true, false}) {
        EXPECT_EQ(regions_with(8, 16, color_first), 8);
        EXPECT_EQ(regions_with(8, 32, color_first), 32);
        EXPECT_EQ(regions_with(1, 2, color_first), 2) << "a constant has none";
    }
}

/// A colour of two halves.
Bitmap gray_and_tinted() {
    return bitmap_of(
        8, 3, [](int x, int, int c) { return x < 4 ? 0.2f : 0.5f + 0.1f * static_cast<float>(c); });
}

/// Colour and roughness of one material: ten candidates, the colour of each by the ratio.
TEST(StartSearch, SearchesAColorWithARoughness) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].texture = {1};
    const Scene scene = floor_scene(floor, {gray_and_tinted(), halves(16, 0.3f, 0.3f)});
    Options options;
    options.stop.iterations = 1, options.evaluation_samples = 2;
    const Summary summary = solve(searched_problem(scene, SearchStart{}), options);
    ASSERT_EQ(summary.searched.size(), 1u);
    EXPECT_EQ(summary.searched[0].tried.size(), 10u);
    EXPECT_LT(distance_of(summary.textures[0].start, truth_of(scene, 0)), 0.1);
    EXPECT_LT(distance_of(summary.textures[1].start, truth_of(scene, 1)), 0.15);
}

/// A constant has one value, that with which all pixels lose least, whatever is named first.
TEST(StartSearch, AConstantStartsWhereAllPixelsLoseLeast) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].texture = {1};
    Scene scene = floor_scene(floor, {gray_and_tinted(), halves(1, 0.25f, 0.25f)});
    const Solver colors_first(searched_problem(scene, SearchStart{}), {});
    EXPECT_EQ(colors_first.texture(1).values, std::vector<float>{0.25f});
    std::swap(scene.parameters[0], scene.parameters[1]);
    const Solver constant_first(searched_problem(scene, SearchStart{}), {});
    EXPECT_EQ(constant_first.texture(0).values, std::vector<float>{0.25f});
    EXPECT_EQ(constant_first.texture(1), colors_first.texture(0));
}

/// A number that two materials share, each with a colour: the one whose colour is searched tells
/// it.
TEST(StartSearch, MaterialsWhoseColorIsNotSearchedSayNothingOfWhatTheyShare) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].texture = {2};
    const Bitmap dark = bitmap_of(8, 3, [](int, int, int) { return 0.1f; });
    Scene scene = floor_scene(floor, {gray_and_tinted(), dark, halves(1, 0.25f, 0.25f)});
    Principled wall = floor;
    wall.base_color.texture = {1};
    scene.bsdfs.push_back(wall);
    scene.materials.push_back({"wall", {2}, {2}});
    scene.shapes.push_back({"wall", make_quad({-1, 1, 0}, {2, 0, 0}, {0, 0, 0.8f}), {2}, {}});
    for (int order = 0; order < 2; ++order) {
        const Solver solver(searched_problem(scene, SearchStart{}), {});
        EXPECT_NEAR(solver.texture(2).values[0], 0.25f, 0.1f) << order;
        std::swap(scene.parameters[0], scene.parameters[1]);
    }
}

/// Losses decide, however much more the costs of that value are, and unknown regions have no say.
TEST(StartSearch, AConstantHasTheValueThatLosesLeastByAnyMargin) {
    SearchGroup group;
    group.members = {0, 1}, group.uniform = {0, 1};
    group.candidates = {{0, 0.1f}, {1, 0.1f}, {0, 0.7f}, {1, 0.7f}};
    group.regions.regions.resize(3);
    const GroupSums sums{{9000, 9000, 0}, {5, 6, 3, 4, 5, 6, 4, 2, 0, 0, 9, 9}, {}, {}};
    const SearchPlan plan;
    std::vector<float> costs{0, 10, 5000, 5020, 7, 0, 4020, 4000, 0, 0, 0, 0};
    fix_uniform({plan, group, sums}, costs);
    const float never = costs[0];
    EXPECT_GT(never, 500);
    EXPECT_EQ(costs,
              (std::vector<float>{never, never, 0, 20, never, never, 20, 0, never, never, 0, 0}));
}

/// Samples that are too few for each pixel are worse than larger pixels.
TEST(StartSearch, TakesEnoughSamplesOfManyPixels) {
    const auto setup = make_setup(searched_problem(smooth_scene(), SearchStart{}), {});
    const SearchInput input = search_input(setup);
    const auto plan_of = [&](std::size_t views) {
        return make_search_plan(std::vector<SearchView>(views, input.views.front()), input.unknowns,
                                0);
    };
    const SearchPlan few = plan_of(10), many = plan_of(200);
    EXPECT_EQ(few.scale, 1);
    EXPECT_GE(few.passes, 12u);
    EXPECT_GT(many.scale, 1);
    EXPECT_GE(many.passes, 32u);
}

/// The floor from above: three unknowns, brass on the left. Returns the distances of their starts
/// from the truth, away from the edge, which pixels blur.
std::array<double, 3> search_brass(float roughness_of_paint) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].texture = {1};
    floor[PrincipledScalar::kMetallic].texture = {2};
    const Bitmap color = bitmap_of(8, 3, [](int x, int, int c) {
        return x < 4 ? 0.8f - 0.2f * static_cast<float>(c) : 0.2f + 0.2f * static_cast<float>(c);
    });
    const Scene scene =
        floor_scene(floor, {color, halves(16, 0.25f, roughness_of_paint), halves(16, 1, 0)});
    const Solver solver(searched_problem(scene, SearchStart{}), {});
    std::array<double, 3> distances{};
    for (std::size_t t = 0; t < 3; ++t) {
        Image start = solver.texture(t);
        const Image truth = truth_of(scene, static_cast<std::int32_t>(t));
        const int third = start.width * 3 / 8;
        for (int y = 0; y < start.height; ++y)
            for (int x = third; x < start.width - third; ++x)
                for (int c = 0; c < start.channels; ++c) start.at(x, y, c) = truth.at(x, y, c);
        distances[t] = distance_of(start, truth);
    }
    return distances;
}

/// Which roughness and metallic a region has follows where each has the colour that suits it best.
/// Replacing these colours by 0.5 must fail here.
TEST(StartSearch, SearchesColorRoughnessAndMetallicTogether) {
    const auto [color, roughness, metallic] = search_brass(0.35f);
    EXPECT_LT(color, 0.05);
    EXPECT_LT(roughness, 0.03);
    EXPECT_LT(metallic, 0.05);
}

/// Seen from one place matt paint may be half a metal of another colour; without the prior much of
/// it is, and the distance 0.31.
TEST(StartSearch, WhatPicturesLeaveOpenIsNoMetal) {
    const auto [color, roughness, metallic] = search_brass(0.7f);
    EXPECT_LT(color, 0.1);
    EXPECT_LT(metallic, 0.25);
}

/// Two materials that share nothing are searched apart.
TEST(StartSearch, GroupsUnknownsByMaterial) {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    Scene scene = floor_scene(floor, {bitmap_of(8, 1, [](int, int, int) { return 0.12f; }),
                                      bitmap_of(8, 3, [](int, int, int) { return 0.3f; })});
    Diffuse wall;
    wall.reflectance.texture = {1};
    scene.bsdfs.push_back(wall);
    scene.materials.push_back({"wall", {2}, {2}});
    scene.shapes.push_back({"wall", test::make_quad({-1, 1, 0}, {2, 0, 0}, {0, 0, 0.5f}), {2}, {}});
    Options options;
    options.stop.iterations = 1, options.evaluation_samples = 2;
    const Summary summary = solve(searched_problem(scene, SearchStart{}), options);
    ASSERT_EQ(summary.searched.size(), 2u);
    EXPECT_EQ(summary.searched[0].unknowns, std::vector<std::size_t>{0});
    EXPECT_EQ(summary.searched[1].unknowns, std::vector<std::size_t>{1});
    EXPECT_EQ(summary.searched[0].tried.size(), 10u);
    EXPECT_EQ(summary.searched[1].tried.size(), 1u);
    EXPECT_LT(distance_of(summary.textures[0].start, truth_of(scene, 0)), 0.1);
}

/// Each of two views sees one half of the floor; together they find both.
TEST(StartSearch, ReadsEveryViewThatIsFitted) {
    Scene scene = smooth_scene();
    scene.textures[0] = halves(16, 0.08f, 0.35f);
    Problem problem = searched_problem(scene, SearchStart{});
    View& left = problem.views[0];
    left.mask = make_image(48, 48, 1);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 24; ++x) left.mask.at(x, y, 0) = 1;
    const Image of_left = Solver(problem, {}).texture(0);
    View right = left;
    for (float& weight : right.mask.values) weight = 1 - weight;
    problem.views.push_back(right);
    const Image of_both = Solver(problem, {}).texture(0);
    EXPECT_LT(distance_of(of_both, truth_of(scene, 0)), distance_of(of_left, truth_of(scene, 0)));
    EXPECT_LT(distance_of(of_both, truth_of(scene, 0)), 0.1);

    right.held_out = true;
    for (float& v : right.image.values) v = 1e6f;
    problem.views.push_back(right);
    EXPECT_EQ(Solver(problem, {}).texture(0), of_both) << "one that is held out is not read";
}

/// Of many views some are read, spread evenly over those that are fitted.
TEST(StartSearch, ReadsSomeOfManyViews) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    problem.views.resize(40, problem.views.front());
    problem.views[0].held_out = true;
    const SearchInput input = search_input(make_setup(std::move(problem), {}));
    ASSERT_EQ(input.fitted.size(), 16u);
    ASSERT_EQ(input.views.size(), 16u);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(input.fitted[i], i * 39 / 16);
}

/// Beside an unknown that is not searched, whose values are those of the run.
TEST(StartSearch, NamesUnknownsByTheirPlaceAmongAll) {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    floor[PrincipledScalar::kMetallic].texture = {1};
    const Scene scene = floor_scene(floor, {halves(16, 0.12f, 0.35f), halves(8, 1, 0)});
    Problem problem = searched_problem(scene, SearchStart{});
    problem.unknowns[0].start = 0.5f;
    Options options;
    options.stop.iterations = 1, options.evaluation_samples = 2;
    const Summary summary = solve(problem, options);
    ASSERT_EQ(summary.searched.size(), 1u);
    EXPECT_EQ(summary.searched[0].unknowns, std::vector<std::size_t>{1});
    EXPECT_GT(summary.search_seconds, 0);

    const auto setup = make_setup(problem, options);
    ASSERT_EQ(unsearched(setup).textures.size(), 1u);
    EXPECT_EQ(unsearched(setup).textures[0].values, make_image(16, 16, 1, 0.5f));
    Theta theta = initial_theta(setup);
    theta.textures[0].values = make_image(16, 16, 1, 0.3f);
    EXPECT_EQ(unsearched(setup, &theta).textures[0].values, make_image(16, 16, 1, 0.3f));
}

/// The tiles of several views side by side: as one view after the other.
TEST(StartSearch, AddsViewsInTheirOrder) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    for (int i = 0; i < 2; ++i) problem.views.push_back(problem.views.front());
    const auto setup = make_setup(std::move(problem), {});
    const SearchInput input = search_input(setup);
    ASSERT_EQ(input.views.size(), 3u);
    const SearchPlan plan = make_search_plan(input.views, input.unknowns, 1, 1);
    const std::vector<SearchFrame> frames = make_search_frames(plan, input.views);
    const std::vector<GroupColors> none(plan.groups.size());
    const auto sums_of = [&](const auto& add) {
        std::vector<GroupSums> sums;
        for (const SearchGroup& g : plan.groups) sums.push_back(make_sums(g));
        add(sums);
        return sums;
    };
    std::vector<double> shares;
    const auto together = sums_of([&](std::vector<GroupSums>& sums) {
        add_views(frames, none, sums, [&](double share) { shares.push_back(share); });
    });
    const auto in_turn = sums_of([&](std::vector<GroupSums>& sums) {
        for (const SearchFrame& frame : frames) add_views({&frame, 1}, none, sums);
    });
    EXPECT_EQ(together[0].losses, in_turn[0].losses);
    EXPECT_EQ(together[0].costs, in_turn[0].costs);
    EXPECT_NE(sums_of([&](auto& sums) {
                  add_views({&frames[1], 1}, none, sums);
              })[0]
                  .losses,
              sums_of([&](auto& sums) {
                  add_views({&frames[2], 1}, none, sums);
              })[0]
                  .losses)
        << "views have random numbers of their own";
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_EQ(shares.back(), 1);
}

/// Two minutes are worth twice the samples, ten four times; less than one changes nothing.
TEST(StartSearch, ALongRunSearchesLonger) {
    const Problem problem = searched_problem(smooth_scene(), SearchStart{});
    const auto start = [&](double seconds) {
        Options options;
        options.stop.seconds = seconds;
        return Solver(problem, options).texture(0);
    };
    const Image any = Solver(problem, {}).texture(0);
    EXPECT_EQ(start(1), any);
    EXPECT_EQ(start(60), any);
    EXPECT_NE(start(120), any);
    EXPECT_EQ(start(240), start(600));
    EXPECT_NE(start(240), start(120));
    EXPECT_LT(distance_of(start(240), truth_of(smooth_scene(), 0)), 0.1);
}

/// A picture that was exposed twice as long says the same.
TEST(StartSearch, KnowsTheExposureOfAView) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    for (float& v : problem.views[0].image.values) v = 4 * v;
    problem.views[0].exposure = ExposureFactors{4, 4, 4};
    EXPECT_LT(distance_of(Solver(problem, {}).texture(0), truth_of(smooth_scene(), 0)), 0.1);
}

/// The exposure of one view is not known: it follows with the start.
TEST(StartSearch, FindsTheExposureOfAView) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    for (float& v : problem.views[0].image.values) v = 4 * v;
    problem.views[0].exposure = FitExposure{};
    EXPECT_LT(distance_of(Solver(problem, {}).texture(0), truth_of(smooth_scene(), 0)), 0.1);
    problem.views[0].exposure = ExposureFactors{1, 1, 1};
    EXPECT_GT(distance_of(Solver(problem, {}).texture(0), truth_of(smooth_scene(), 0)), 0.1)
        << "without it the answer is another one";
}

/// A colour beside an exposure: known from the view whose exposure is.
TEST(StartSearch, FindsColorsBesideExposures) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].constant = 0.8f;
    const Scene scene = floor_scene(floor, {bitmap_of(8, 3, [](int x, int, int c) {
                                        return (x < 4 ? 0.2f : 0.7f) + 0.1f * static_cast<float>(c);
                                    })});
    Problem problem = searched_problem(scene, SearchStart{});
    problem.views.push_back(problem.views[0]);
    for (float& v : problem.views[1].image.values) v = 3 * v;
    problem.views[1].exposure = FitExposure{true};
    EXPECT_LT(distance_of(Solver(problem, {}).texture(0), truth_of(scene, 0)), 0.1);
}

/// A floor of one colour, or of one roughness, before a gray wall.
Scene before_a_wall(bool is_color, float value) {
    Principled floor = is_color ? Principled{} : metal();
    (is_color ? floor.base_color.texture : floor[PrincipledScalar::kRoughness].texture) = {0};
    if (is_color) floor[PrincipledScalar::kRoughness].constant = 0.8f;
    Scene scene =
        floor_scene(floor, {bitmap_of(8, is_color ? 3 : 1, [=](int, int, int) { return value; })});
    Diffuse gray;
    gray.reflectance.constant = {0.8f, 0.8f, 0.8f};
    scene.bsdfs.push_back(gray);
    scene.materials.push_back({"wall", {2}, {}});
    scene.shapes.push_back({"wall", make_quad({-1, 1, 0}, {2, 0, 0}, {0, 0, 2}), {2}, {}});
    scene.max_depth = 5;
    return scene;
}

/// A known wall tells the exposure, with the light that the unknown floor throws on it: that of a
/// colour of 0.5 or of a smooth metal, whatever the floor is.
TEST(StartSearch, FindsExposuresWithLightFromUnknowns) {
    const auto distance = [&](const Scene& scene, const Exposure& exposure) {
        Problem problem = searched_problem(scene, SearchStart{});
        problem.views[0].exposure = exposure;
        return distance_of(Solver(problem, {}).texture(0), truth_of(scene, 0));
    };
    const Scene gray = before_a_wall(true, 0.5f), rough = before_a_wall(false, 0.6f);
    EXPECT_LT(distance(gray, ExposureFactors{1, 1, 1}), 0.03);
    EXPECT_LT(distance(gray, FitExposure{}), 0.03);
    EXPECT_LT(distance(rough, FitExposure{}), distance(rough, ExposureFactors{1, 1, 1}) + 0.01);
    for (const float value : {0.2f, 0.8f}) {
        const Scene scene = before_a_wall(true, value);
        EXPECT_LT(distance(scene, FitExposure{}), distance(scene, ExposureFactors{1, 1, 1}) + 0.05);
    }
}

/// Squares of the picture overflow in single precision, then those of the exposure, too.
TEST(StartSearch, FindsColorsUnderHugeExposures) {
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].constant = 0.8f;
    Scene scene =
        floor_scene(floor, {bitmap_of(8, 3, [](int x, int, int) { return x < 4 ? 0.2f : 0.7f; })});
    std::get<ConstantEmitter>(scene.emitters[1]).radiance = {10, 10, 10};
    for (const float e : {1e19f, 1.8e19f, 2e19f}) {
        Problem problem = searched_problem(scene, SearchStart{});
        for (float& v : problem.views[0].image.values) v = e * v;
        problem.views[0].exposure = ExposureFactors{e, e, e};
        EXPECT_LT(distance_of(Solver(problem, {}).texture(0), truth_of(scene, 0)), 0.1) << e;
    }
}

/// Pixels without weight say nothing: what they hold does not matter.
TEST(StartSearch, LeavesMaskedPixelsOut) {
    const Scene scene = smooth_scene();
    Problem problem = searched_problem(scene, SearchStart{});
    Image& target = problem.views[0].image;
    problem.views[0].mask = make_image(target.width, target.height, 1, 1.0f);
    const Image whole = Solver(problem, {}).texture(0);
    for (int y = 0; y < target.height; ++y)
        for (int x = 0; x < target.width / 3; ++x) problem.views[0].mask.at(x, y, 0) = 0;
    const Image masked = Solver(problem, {}).texture(0);
    for (int y = 0; y < target.height; ++y)
        for (int x = 0; x < target.width / 3; ++x)
            for (int c = 0; c < 3; ++c) target.at(x, y, c) = c == 1 ? NAN : 1e6f;
    EXPECT_EQ(Solver(problem, {}).texture(0), masked);
    problem.views[0].mask = {};
    for (float& v : target.values) v = std::isnan(v) ? 1e6f : v;
    EXPECT_NE(Solver(problem, {}).texture(0), whole) << "without a mask it does matter";
}

/// Ratios of weights matter alone. By powers of two, so that nothing is rounded otherwise.
TEST(StartSearch, IsTheSameWhateverTheScaleOfTheMasks) {
    const Scene scene = smooth_scene();
    Problem problem = searched_problem(scene, SearchStart{});
    problem.views.push_back(problem.views[0]);
    const auto searched = [&](float weight) {
        problem.views[0].mask = make_image(48, 48, 1, weight);
        problem.views[1].mask = make_image(48, 48, 3, weight / 2);
        return Solver(problem, {}).texture(0);
    };
    const Image expected = searched(1);
    EXPECT_LT(distance_of(expected, truth_of(scene, 0)), 0.1);
    for (const int power : {-10, -60, 10})
        EXPECT_EQ(searched(std::ldexp(1.0f, power)), expected) << power;
}

/// Nor does it matter what pixels weigh that see no unknown: here those of a view that looks away.
TEST(StartSearch, IsTheSameWhateverOtherPixelsWeigh) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    problem.views.push_back(problem.views[0]);
    Camera up;
    up.width = up.height = 48, up.focal_x = up.focal_y = 48, up.center_x = up.center_y = 24;
    up.camera_to_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5, 0, 0, 0, 1};
    problem.views[1].camera = up;
    const Image expected = Solver(problem, {}).texture(0);
    const float small = std::ldexp(1.0f, -10);
    problem.views[0].mask = make_image(48, 48, 1, small);
    EXPECT_EQ(make_setup(problem, {}).max_mask, small);
    EXPECT_EQ(Solver(problem, {}).texture(0), expected);
    problem.views[0].mask = make_image(48, 48, 1);
    EXPECT_EQ(make_setup(problem, {}).max_mask, 1) << "none counts";
}

/// Pixels of the lamp's reflection that are black, which no roughness explains, do not decide for
/// those around them. Costs that are sums of squares must fail here.
TEST(StartSearch, PixelsThatNothingExplainsDoNotDecide) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    const Image start = Solver(problem, {}).texture(0);
    Image& target = problem.views[0].image;
    int bright = 0, black = 0;
    for (std::size_t i = 0; i < target.values.size(); i += 3) {
        if (target.values[i] < 1 || bright++ % 2 == 1) continue;
        for (std::size_t c = 0; c < 3; ++c) target.values[i + c] = 0;
        ++black;
    }
    EXPECT_GT(black, 10);
    EXPECT_LT(distance_of(Solver(problem, {}).texture(0), start), 0.01);
}

TEST(StartSearch, IsTheSameForAnyNumberOfThreads) {
    const Problem problem = searched_problem(smooth_scene(), SearchStart{});
    std::set<std::string> states;
    for (int threads = 1; threads <= 5; ++threads) {
        const ThreadLimit limit(threads);
        states.insert(save_state(Solver(problem, {}).state()));
    }
    EXPECT_EQ(states.size(), 1u);
    Options other;
    other.seed = 1;
    EXPECT_NE(save_state(Solver(problem, other).state()), *states.begin());
}

/// A run that goes on from a state has the start that was found, and does not search again: the
/// picture may even be another one.
TEST(StartSearch, IsPartOfTheState) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    Options options;
    options.stop.iterations = 2, options.evaluation_samples = 2;
    Solver solver(problem, options);
    const Image start = solver.texture(0);
    solver.step();
    const State state = load_state(save_state(solver.state()));
    Problem other = problem;
    for (float& v : other.views[0].image.values) v = 0.5f;
    const Summary summary = solve(other, options, state);
    EXPECT_EQ(summary.textures[0].start, start);
    EXPECT_TRUE(summary.searched.empty());

    Problem given = problem;
    given.unknowns[0].start = 0.5f;
    EXPECT_THROW(Solver(given, options, state), InputError);
    EXPECT_THROW(Solver(problem, options, Solver(given, options).state()), InputError);
}

TEST(StartSearch, IsHalfWithALossOfYourOwn) {
    Problem problem = searched_problem(smooth_scene(), SearchStart{});
    problem.loss = [](const Image& image, std::size_t) {
        return LossValue{0, make_image(image.width, image.height, 3)};
    };
    EXPECT_EQ(Solver(problem, {}).texture(0), make_image(16, 16, 1, 0.5f));
}

/// An image that was given stays where no sample comes; a value or a search does not.
TEST(StartSearch, AGivenImageIsKeptWhereNothingIsSeen) {
    const Scene scene = smooth_scene();
    Problem problem = searched_problem(scene, 0.5f);
    problem.views[0].mask = make_image(48, 48, 1, 1.0f);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 24; ++x) problem.views[0].mask.at(x, y, 0) = 0;
    Options options;
    options.stop.iterations = 3, options.evaluation_samples = 2;
    options.learning_rate = 0.05;
    Image given = make_image(16, 16, 1);
    for (std::size_t i = 0; i < given.values.size(); ++i)
        given.values[i] = 0.1f + 0.002f * static_cast<float>(i);
    std::size_t unseen = 0, filled = 0;
    for (const bool is_given : {true, false}) {
        if (is_given)
            problem.unknowns[0].start = given;
        else
            problem.unknowns[0].start = 0.5f;
        const RecoveredTexture t = solve(problem, options).textures[0];
        for (std::size_t i = 0; i < given.values.size(); ++i) {
            if (t.coverage.values[i] > 0) continue;
            ++unseen;
            EXPECT_TRUE(!is_given || t.values.values[i] == given.values[i]);
            filled += !is_given && t.values.values[i] != 0.5f;
        }
    }
    EXPECT_GT(unseen, 100u);
    EXPECT_GT(filled, 20u);
}

/// Where no sample comes to any texel nothing is there to fill from.
TEST(StartSearch, AStartOfWhichNothingIsSeenIsNotFilled) {
    Scene scene = smooth_scene();
    for (const bool is_seen : {true, false}) {
        if (!is_seen) scene.camera.to_world = look_at({0, 0, 5}, {0, 0, 10}, {0, 1, 0});
        Options options;
        options.stop.iterations = 2, options.evaluation_samples = 2;
        const RecoveredTexture t = solve(searched_problem(scene, 0.5f), options).textures[0];
        EXPECT_EQ(t.filled, is_seen);
        EXPECT_EQ(t.values == t.start, !is_seen);
    }
}

/// With a uniform offset, shifts have the density of the filter about the square's pixels.
TEST(StartSearch, ShiftsFollowTheFilter) {
    for (const ReconstructionFilter filter :
         {ReconstructionFilter{FilterKind::kBox, 0.5f}, ReconstructionFilter{FilterKind::kTent, 1},
          ReconstructionFilter{FilterKind::kGaussian, 2}})
        for (const int scale : {1, 2, 3}) {
            // The share of shifts by strips of the offset against the integral of the density.
            constexpr int kOffsets = 32, kDraws = 256;
            double mean = 0, square = 0;
            for (int o = 0; o < kOffsets; ++o)
                for (int k = 0; k < kDraws; ++k) {
                    const float offset = (static_cast<float>(o) + 0.5f) / kOffsets;
                    const double at =
                        draw_shift(filter, scale, offset, (static_cast<float>(k) + 0.5f) / kDraws) +
                        double{offset} - 0.5 * scale;
                    mean += at / (kOffsets * kDraws), square += at * at / (kOffsets * kDraws);
                }
            // Variances of independent summands add up: of a square's pixels, and of the filter.
            double of_filter = 0, total = 0;
            for (int i = -2000; i <= 2000; ++i) {
                const double x = i / 1000.0, h = std::max(0.0, eval_filter_exact(filter, x));
                of_filter += h * x * x, total += h;
            }
            EXPECT_NEAR(mean, 0, 0.01) << scale;
            EXPECT_NEAR(square, (scale * scale - 1) / 12.0 + of_filter / total, 0.02) << scale;
        }
}

}  // namespace
}  // namespace burnish
