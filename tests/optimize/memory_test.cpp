// Memory that is estimated: records as many as a trial promises, a window that keeps within a
// limit, and parts that grow with what they are of.
#include "optimize/memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "gradient/estimator.h"
#include "optimize/band_memory.h"
#include "optimize/small_problem.h"
#include "optimize/state.h"

namespace burnish {
namespace {

constexpr std::uint32_t kSeed = 4;

PathCache small_cache() {
    PathCache cache;
    cache.window = 3, cache.samples = 6;
    return cache;
}

MemoryEstimate memory_of(const Estimator& estimator, const Scene& scene, const Theta& theta) {
    const TracedScene traced = prepare(scene);
    const std::vector<std::vector<char>> reaching = reaching_pixels({&traced, 1}, theta);
    return estimate_memory(estimator, {{&traced, 1}, {}, reaching},
                           plan_caches(estimator, {&traced, 1}, reaching, theta), theta, kSeed);
}

TEST(Memory, OfRecordsIsWhatAPathCacheHolds) {
    const Scene scene = test::small_scene_of(96);
    Options options;
    options.estimator = small_cache(), options.seed = kSeed;
    Solver solver(test::problem_of(scene), options);
    solver.step();
    const State after = solver.state();
    const auto& state = std::get<PathCacheState>(after.values().views[0].estimator);
    ASSERT_EQ(state.halves[1].passes.size(), 3u);

    const Theta theta = test::theta_of(scene);
    const MemoryEstimate estimate = memory_of(options.estimator, scene, theta);
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    PathCacheWorkspace workspace = make_workspace(small_cache(), binding);
    shade({binding, kSeed, Sequence::kSobol}, state, workspace);
    const auto actual = static_cast<double>(size_of(state, workspace).bytes);
    EXPECT_NEAR(estimate.records, actual, 0.15 * actual);
    EXPECT_LT(actual, estimate.max_records);
    EXPECT_DOUBLE_EQ(estimate.samples, estimate.max_records) << "six fresh passes, and six kept";
}

TEST(Memory, OfFreshPassesEndsAtWhatTheCacheKeeps) {
    const Scene scene = test::small_scene_of(32);
    const Theta theta = test::theta_of(scene);
    PathCache cache{.samples = 64, .window = 1};
    const MemoryEstimate many = memory_of(cache, scene, theta);
    cache.samples = 2;
    EXPECT_DOUBLE_EQ(many.samples, memory_of(cache, scene, theta).samples);
    cache.samples = 1;
    EXPECT_DOUBLE_EQ(many.samples, 2 * memory_of(cache, scene, theta).samples);
}

TEST(Memory, OfRecordsKeepsWithinALimit) {
    const Scene scene = test::small_scene_of(32);
    const Theta theta = test::theta_of(scene);
    PathCache cache = small_cache();
    const MemoryEstimate free = memory_of(cache, scene, theta);
    cache.max_bytes = static_cast<std::size_t>(0.7 * free.max_records);
    const MemoryEstimate limited = memory_of(cache, scene, theta);
    EXPECT_DOUBLE_EQ(limited.max_records, free.max_records * 2 / 3);
    EXPECT_DOUBLE_EQ(limited.records, free.records * 2 / 3);
    EXPECT_DOUBLE_EQ(maximum(limited), without_records(limited) + limited.max_records);
    EXPECT_LT(expected(limited), maximum(limited));
}

TEST(Memory, GrowsWithWhatItIsOf) {
    const Scene small = test::small_scene_of(32);
    const Theta theta = test::theta_of(small);
    const MemoryEstimate before = memory_of(small_cache(), small, theta);
    EXPECT_DOUBLE_EQ(memory_of(small_cache(), test::small_scene_of(64), theta).images,
                     4 * before.images);

    Scene detailed = small;
    auto& mesh = std::get<Mesh>(detailed.shapes[0].geometry);
    const auto triangles = mesh.triangles;
    for (int i = 0; i < 100; ++i)
        mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
    EXPECT_GT(memory_of(small_cache(), detailed, theta).scene,
              before.scene + 200 * sizeof(TriangleRecord));

    Theta one = theta;
    one.textures.pop_back();
    EXPECT_LT(memory_of(small_cache(), small, one).textures, before.textures);

    const MemoryEstimate mc = memory_of(MonteCarlo{}, small, theta);
    EXPECT_EQ(mc.max_records, 0);
    const MemoryEstimate three = memory_of(MonteCarlo{.samples = 3}, small, theta);
    EXPECT_DOUBLE_EQ(three.samples, 3 * mc.samples);
    EXPECT_GT(memory_of(Reservoirs{.samples = 3}, small, theta).samples, 3 * mc.samples);
}

/// The small scene whose roughness has so many texels, and comes so often along each side.
Scene scene_with_roughness(int side, int texels, float repeats) {
    Scene scene = test::small_scene_of(side);
    Bitmap roughness = test::make_bitmap(texels, 1, TextureFilter::kNearest, 0.35f, 0.7f, 62);
    roughness.to_uv = {{repeats, 0, 0, 0, repeats, 0}};
    scene.textures[1] = roughness;
    return scene;
}

/// Each band adds up in memory of its own: where a texture repeats, that of all of its texels.
TEST(Memory, OfBandsCountsTheTexelsThatEachComesTo) {
    constexpr int kTexels = 512;
    const double array = kTexels * kTexels * sizeof(float);
    const auto arrays = [&](const Scene& scene) {
        const Theta theta = test::theta_of(scene);
        const TracedScene traced = prepare(scene);
        const std::vector<std::vector<char>> reaching = reaching_pixels({&traced, 1}, theta);
        return band_bytes({&traced, 1}, reaching, theta, kSeed) / array;
    };
    const Scene once = scene_with_roughness(256, kTexels, 1),
                often = scene_with_roughness(256, kTexels, 40);
    const TracedScene traced = prepare(often);
    const Theta theta = test::theta_of(often);
    const auto tiles = make_cache_tiles(traced.film, reaching_pixels(Binding(traced, theta)));
    int bands = 0;
    for (std::size_t b = 0; b < kViewBands; ++b)
        bands += !tiles_of({b, b + 1}, tiles.size()).empty();
    ASSERT_GT(bands, 16);
    EXPECT_GT(arrays(often), bands);
    EXPECT_LT(arrays(often), 1.3 * bands);
    EXPECT_GT(arrays(once), 1);
    EXPECT_LT(arrays(once), 4) << "neighbouring tiles overlap little";

    EXPECT_GT(memory_of(small_cache(), often, theta).textures,
              memory_of(small_cache(), once, theta).textures + (bands - 4) * array);
    EXPECT_EQ(memory_of(MonteCarlo{}, often, theta).textures,
              memory_of(MonteCarlo{}, once, theta).textures);
}

/// And of two views that see other texels in the same bands both.
TEST(Memory, OfBandsStaysFromViewToView) {
    const Scene here = scene_with_roughness(128, 512, 1);
    Scene there = here;
    there.camera.to_world = look_at({0.3, 2.6, 1.8}, {0, 0.1, 0}, {0, 0, 1});
    const Theta theta = test::theta_of(here);
    const auto bytes = [&](const std::vector<TracedScene>& views) {
        return band_bytes(views, reaching_pixels(views, theta), theta, kSeed);
    };
    const TracedScene front = prepare(here), back = prepare(there);
    const double one = bytes({front});
    EXPECT_NEAR(bytes({front, front}), one, 0.2 * one);
    EXPECT_GT(bytes({front, back}), 1.5 * one);
}

/// A view keeps reservoirs, two for each texel, and the unknowns under which they were made, and
/// those before for as long as an iteration lasts; in it candidates become reservoirs, too.
TEST(Memory, OfAHistoryCountsItsReservoirsAndTextures) {
    const Reservoirs options{.samples = 1, .confidence_cap = 1};
    const auto samples = [&](int texels, std::size_t views, std::size_t batch) {
        const Scene scene = scene_with_roughness(16, texels, 1);
        const Theta theta = test::theta_of(scene);
        const std::vector<TracedScene> all(views, prepare(scene));
        const auto reaching = reaching_pixels(all, theta);
        return estimate_memory(options, {all, {}, reaching}, {}, theta, kSeed, batch).samples;
    };
    const double texels = 512 * 512 - 256 * 256, textures = texels * sizeof(float),
                 reservoirs = 2 * texels * sizeof(HistorySample);
    for (const auto& [views, batch] : {std::array<std::size_t, 2>{1, 1}, {3, 1}, {3, 2}, {3, 9}})
        EXPECT_DOUBLE_EQ(
            samples(512, views, batch) - samples(256, views, batch),
            static_cast<double>(views + std::min(views, batch)) * (reservoirs + textures) +
                2 * reservoirs);
}

TEST(Memory, OfASkyCountsOnceHoweverItIsTurned) {
    const Scene scene = test::small_scene_of(32);
    const Theta theta = test::theta_of(scene);
    const TracedScene none = prepare(scene);
    const auto under = [&](const TracedScene& view, const SharedImage& sky, float scale) {
        return with_emitters(view, {EnvironmentEmitter{sky, scale, {}}});
    };
    const auto scene_bytes = [&](const std::vector<TracedScene>& views) {
        const auto reaching = reaching_pixels(views, theta);
        return estimate_memory(MonteCarlo{}, {views, {}, reaching}, {}, theta, kSeed).scene;
    };
    const SharedImage sky = share(make_image(64, 32, 3, 0.5f));
    const TracedScene first = under(none, sky, 1), turned = under(first, sky, 2),
                      other = under(none, share(make_image(64, 32, 3, 0.7f)), 1);
    EXPECT_GT(scene_bytes({none, first}), scene_bytes({none}) + 64 * 32 * sizeof(Rgbf));
    EXPECT_EQ(scene_bytes({none, first, turned}), scene_bytes({none, first}));
    EXPECT_GT(scene_bytes({first, other}), scene_bytes({first}) + 64 * 32 * sizeof(Rgbf));
}

double share_of(const Scene& scene, const Theta& theta) {
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    return record_share(binding, reaching_pixels(binding), 1);
}

TEST(Memory, NothingIsKeptOfWhatIsNotSeen) {
    Scene scene = test::small_scene_of(32);
    const Theta theta = test::theta_of(scene);
    const double share = share_of(scene, theta);
    EXPECT_GT(share, 0.1);
    EXPECT_LT(share, 1);
    scene.camera.to_world = look_at({0, 0, 5}, {0, 0, 10}, {0, 1, 0});
    EXPECT_EQ(share_of(scene, theta), 0);
}

}  // namespace
}  // namespace burnish
