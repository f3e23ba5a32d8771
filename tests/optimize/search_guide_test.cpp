// What the search for the start takes from known textures: details finer than its regions, and
// nothing where they say nothing.
#include "optimize/search_guide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/parallel.h"
#include "optimize/floor_scene.h"
#include "optimize/setup.h"
#include "optimize/state.h"
#include "texture/unvisited.h"

namespace burnish {
namespace {

using namespace test;

constexpr int kSide = 64;

/// Whether a texel is of the second of two metals, speckled at random.
bool is_second(int x, int y) {
    const auto h = static_cast<std::uint32_t>(x / 3) * 0x9e3779b1u ^
                   static_cast<std::uint32_t>(y / 3) * 0x85ebca77u;
    return ((h ^ h >> 15) * 0x2c1b3c6du >> 13 & 1u) != 0;
}

/// Texture 0: the roughness of the metals. Texture 1: their colours, alike in luminance; those of
/// the texels `apart` from where they are.
Scene speckled_scene(int apart) {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    floor.base_color.texture = {1};
    return floor_scene(
        floor,
        {bitmap_of(kSide, 1, [](int x, int y, int) { return is_second(x, y) ? 0.35f : 0.08f; }),
         bitmap_of(kSide, 3, [=](int x, int y, int c) {
             const bool second = is_second(x + apart, y + 3 * apart);
             return c == (second ? 0 : 2) ? 0.8f : 0.6f;
         })});
}

Problem problem_of(const Scene& scene) {
    Problem problem = searched_problem(scene, SearchStart{});
    problem.unknowns.pop_back();
    return problem;
}

double error_of(const Scene& scene, const Problem& problem) {
    return distance_of(Solver(problem, {}).texture(0), truth_of(scene, 0));
}

/// Of a start that takes no notice of colours: they are recovered, too, from what they are.
double error_without(const Scene& scene) {
    Problem problem = searched_problem(scene, SearchStart{});
    problem.unknowns[1].start = truth_of(scene, 1);
    return error_of(scene, problem);
}

/// Spots are three texels wide, regions two; no guides is the seeded defect.
TEST(SearchGuide, FindsDetailsFinerThanRegions) {
    const Scene scene = speckled_scene(0);
    const double guided = error_of(scene, problem_of(scene)), without = error_without(scene);
    EXPECT_GT(without, 0.1);
    EXPECT_LT(guided, 0.7 * without);
}

TEST(SearchGuide, SaysNothingWhereColoursHaveNothingToDoWithIt) {
    const Scene scene = speckled_scene(17);
    const double guided = error_of(scene, problem_of(scene)), without = error_without(scene);
    EXPECT_NEAR(guided, without, 0.02 * without);
}

/// The start has details that pictures do not resolve: long steps lose them, and those that move
/// the pictures little.
TEST(SearchGuide, GuidedStartsHaveShortSteps) {
    const auto adam_of = [](Problem problem) {
        return make_setup(std::move(problem), {}).unknowns[0].adam;
    };
    const Scene scene = speckled_scene(0);
    Problem problem = problem_of(scene);
    const AdamOptions guided = adam_of(problem);
    EXPECT_EQ(guided.learning_rate, 0.003f);
    problem.unknowns[0].start = 0.3f;
    const AdamOptions given = adam_of(problem);
    EXPECT_EQ(given.learning_rate, 0.01f) << "nothing is searched";
    EXPECT_GT(guided.damping, 2 * given.damping);
    const AdamOptions searched = adam_of(searched_problem(scene, SearchStart{}));
    EXPECT_EQ(searched.learning_rate, 0.005f / 2) << "nothing is known";
    EXPECT_EQ(searched.damping, given.damping);
}

/// Known textures say what the roughness is where the picture has no pixel; its surroundings do
/// not.
TEST(SearchGuide, GuidedStartsStayWhereNoSampleComes) {
    const Scene scene = speckled_scene(0);
    const Image truth = truth_of(scene, 0);
    Problem problem = problem_of(scene);
    Image& mask = problem.views[0].mask;
    mask = make_image(48, 48, 1, 1);
    for (int i = 0; i < 48 * 48; ++i)
        if (i % 48 < 24) mask.values[static_cast<std::size_t>(i)] = 0;
    Options options;
    options.stop.iterations = 4, options.evaluation_samples = 2;
    const RecoveredTexture kept = solve(problem, options).textures[0];
    EXPECT_FALSE(kept.filled);

    Image filled = kept.values;
    std::vector<std::uint32_t> visits;
    for (const float c : kept.coverage.values) visits.push_back(c > 0);
    fill_unvisited(visits, {}, false, filled);
    double error_kept = 0, error_filled = 0;
    int unvisited = 0;
    for (std::size_t i = 0; i < visits.size(); ++i) {
        if (visits[i] > 0) continue;
        ++unvisited;
        EXPECT_EQ(kept.values.values[i], kept.start.values[i]);
        error_kept += std::pow(kept.values.values[i] - truth.values[i], 2);
        error_filled += std::pow(filled.values[i] - truth.values[i], 2);
    }
    EXPECT_GT(unvisited, 1000);
    EXPECT_LT(error_kept, 0.25 * error_filled);

    problem.unknowns[0].start = 0.3f;
    EXPECT_TRUE(solve(problem, options).textures[0].filled) << "nothing is searched";
}

/// Around the charts no surface reads, but filters and smaller copies of a texture do.
TEST(SearchGuide, TexelsThatNoSurfaceReadsAreFilled) {
    Scene scene = speckled_scene(0);
    for (Texture& texture : scene.textures)
        std::get<Bitmap>(texture).to_uv.m = {0.5f, 0, 0, 0, 0.5f, 0};
    Options options;
    options.stop.iterations = 4, options.evaluation_samples = 2;
    const RecoveredTexture t = solve(problem_of(scene), options).textures[0];
    EXPECT_FALSE(t.filled);
    const ChartMap charts = texture_charts(scene, {0});
    float low = 1, high = 0;
    for (std::size_t i = 0; i < charts.size(); ++i)
        if (charts[i] > 0)
            low = std::min(low, t.values.values[i]), high = std::max(high, t.values.values[i]);
    int outside = 0;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        if (charts[i] > 0) continue;
        ++outside;
        EXPECT_GE(t.values.values[i], low);
        EXPECT_LE(t.values.values[i], high);
    }
    EXPECT_GT(outside, 2000);
    EXPECT_LT(high, 0.45) << "what no surface reads starts at 0.5";
}

TEST(SearchGuide, IsTheSameForAnyNumberOfThreads) {
    const Problem problem = problem_of(speckled_scene(0));
    std::set<std::string> states;
    for (const int threads : {1, 2, 3, 5}) {
        const ThreadLimit limit(threads);
        states.insert(save_state(Solver(problem, {}).state()));
    }
    EXPECT_EQ(states.size(), 1u);
}

TEST(SearchGuide, KnownTexturesOfTheSameMaterialGuide) {
    Scene scene = speckled_scene(0);
    scene.textures.push_back(scene.textures[1]);  // of another material
    Principled other;
    other.base_color.texture = {2};
    scene.bsdfs.push_back(other);
    const TextureId roughness{0}, color{1};
    EXPECT_EQ(guides_of(scene, roughness, {{roughness}}), std::vector{color});
    EXPECT_TRUE(guides_of(scene, roughness, {{roughness, color}}).empty());
    EXPECT_TRUE(guides_of(scene, color, {{color}}).empty()) << "no roughness";
    RoughConductor brushed;  // reads it beside one that has no guide
    brushed.roughness.anisotropic = true;
    brushed.roughness.alpha[0].texture = roughness, brushed.roughness.alpha[1].texture = {3};
    scene.textures.push_back(scene.textures[0]);
    scene.bsdfs.push_back(brushed);
    EXPECT_EQ(guides_of(scene, roughness, {{roughness}}), (std::vector<TextureId>{color, {3}}));
    EXPECT_TRUE(guides_of(scene, roughness, {{roughness, {3}}}).empty());
    EXPECT_TRUE(guides_of(scene, {3}, {{roughness, {3}}}).empty());
    scene.bsdfs.pop_back();
    std::get<Bitmap>(scene.textures[1]).is_attribute = true;
    EXPECT_TRUE(guides_of(scene, roughness, {{roughness}}).empty());
}

/// A file of one colour, of codes or of floats, says nothing.
TEST(SearchGuide, TexturesOfOneValueDoNotGuide) {
    const TextureId roughness{0}, color{1};
    Scene scene = speckled_scene(0);
    scene.textures[1] = bitmap_of(kSide, 3, [](int, int, int c) { return c == 1 ? 0.3f : 0.6f; });
    EXPECT_TRUE(guides_of(scene, roughness, {{roughness}}).empty());
    auto& bitmap = std::get<Bitmap>(scene.textures[1]);
    bitmap.codes.assign(bitmap.values.size(), 40), bitmap.values.clear();
    EXPECT_TRUE(guides_of(scene, roughness, {{roughness}}).empty());
    bitmap.codes.back() = 41;
    EXPECT_EQ(guides_of(scene, roughness, {{roughness}}), std::vector{color});
}

/// Texels of a guide with the grid of the unknown are read as they are. The same guide with twice
/// as many texels goes by its filter.
TEST(SearchGuide, GuidesOfTheSameGridAreAsTheirFilterSays) {
    Scene scene = speckled_scene(0);
    const auto fine = [](int x, int y, int c) {
        return is_second(x / 2, y / 2) ? 0.2f * static_cast<float>(c + 1) : 0.7f;
    };
    scene.textures[1] =
        bitmap_of(kSide, 3, [&](int x, int y, int c) { return fine(2 * x, 2 * y, c); });
    scene.textures.push_back(bitmap_of(2 * kSide, 3, fine));
    scene.textures.push_back(scene.textures[1]);
    auto& turned = std::get<Bitmap>(scene.textures.back());
    turned.to_uv.m = {0, 1, 0, 1, 0, 0};
    const auto& bitmap = std::get<Bitmap>(scene.textures[0]);
    const auto read = [&](TextureId guide) {
        SearchGroup group;
        group.regions = make_regions(ChartMap(kSide * kSide, 1), kSide, kSide, 4);
        group.guides = {guide};
        return read_guides(scene, group, bitmap);
    };
    const Rows same = read({1}), filtered = read({2});
    ASSERT_EQ(same.values.size(), filtered.values.size());
    for (std::size_t i = 0; i < same.values.size(); ++i)
        EXPECT_NEAR(same.values[i], filtered.values[i], 1e-6f) << i;
    EXPECT_NE(read({3}), same) << "another grid";
}

/// Two leaves of 100 regions: the sure ones of a leaf decide for those that do not know.
TEST(SearchGuide, OpenRegionsFollowTheirLike) {
    SearchGroup group;
    group.candidates = {{0.1f}, {0.5f}, {0.9f}};
    const std::size_t n = 3, regions = 200;
    std::vector<std::uint32_t> leaves(regions);
    std::vector<char> known(regions, 1);
    std::vector<float> costs(regions * n, 0.0f);
    for (std::size_t r = 0; r < regions; ++r) {
        leaves[r] = r < 100 ? 0 : 1;
        const std::size_t own = r < 100 ? 0 : 2;
        for (std::size_t k = 0; r % 4 == 0 && k < n; ++k) costs[r * n + k] = k == own ? 0 : 8;
    }
    add_guide_costs(group, leaves, known, costs);
    for (std::size_t r = 0; r < regions; ++r) {
        const auto first = costs.begin() + static_cast<std::ptrdiff_t>(r * n);
        EXPECT_EQ(std::min_element(first, first + 3) - first, r < 100 ? 0 : 2) << r;
    }
}

/// A dark floor of one roughness, whose colour is not known either: few squares tell the two apart.
TEST(SearchShares, SeveralUnknownsHaveValuesThatManyRegionsHave) {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    floor.base_color.texture = {1};
    const Scene scene =
        floor_scene(floor, {bitmap_of(kSide, 1, [](int, int, int) { return 0.35f; }),
                            bitmap_of(kSide, 3, [](int x, int y, int c) {
                                return is_second(x, y) ? 0.1f : 0.05f * static_cast<float>(c + 1);
                            })});
    const Solver solver(searched_problem(scene, SearchStart{}), {});
    EXPECT_LT(distance_of(solver.texture(0), truth_of(scene, 0)), 0.01);
}

}  // namespace
}  // namespace burnish
