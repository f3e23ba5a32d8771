// Memory that is foretold: records as many as a trial promises, a window that keeps within a limit,
// and parts that grow with what they are of.
#include "optimize/memory.h"

#include <gtest/gtest.h>

#include "gradient/path_cache/iteration.h"
#include "gradient/small_scene.h"

namespace burnish {
namespace {

Scene scene_of(int side) {
    Scene scene = test::make_small_scene();
    scene.film = {side, side, 0, 0, side, side, scene.film.filter};
    return scene;
}

SolveOptions pool_options() {
    SolveOptions options;
    options.gradient.estimator = Estimator::kPool;
    options.pool.window = 3;
    options.pool.samples_per_pixel = 6;
    options.seed = 4;
    return options;
}

TEST(Memory, OfRecordsIsWhatAPoolHolds) {
    const Scene scene = scene_of(96);
    const TracedScene traced = prepare(scene);
    const SolveOptions options = pool_options();
    std::vector<InitialTexture> textures;
    for (const ThetaTexture& t : test::theta_of(scene).textures)
        textures.push_back({t.texture, t.values, 0.01f});
    SolveState state = start(options, textures);
    const MemoryPlan plan = plan_memory(traced, state.theta, options);
    const Problem problem{&traced, make_image(96, 96, 3, 0.2f), {}};
    iterate(problem, options, state);
    ASSERT_EQ(state.pool.banks[1].batches.size(), 3u);
    const auto actual = static_cast<double>(pool_size(state.pool).bytes);
    EXPECT_NEAR(plan.records, actual, 0.15 * actual);
    EXPECT_LT(actual, plan.max_records);
    EXPECT_EQ(plan.samples, 0);
}

TEST(Memory, OfRecordsKeepsWithinALimit) {
    const Scene scene = scene_of(32);
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    SolveOptions options = pool_options();
    const MemoryPlan free = plan_memory(traced, theta, options);
    options.pool.memory = static_cast<std::size_t>(0.7 * free.max_records);
    const MemoryPlan limited = plan_memory(traced, theta, options);
    EXPECT_DOUBLE_EQ(limited.max_records, free.max_records * 2 / 3);
    EXPECT_DOUBLE_EQ(limited.records, free.records * 2 / 3);
    EXPECT_DOUBLE_EQ(most(limited), without_records(limited) + limited.max_records);
    EXPECT_LT(expected(limited), most(limited));
}

TEST(Memory, GrowsWithWhatItIsOf) {
    const Scene small = scene_of(32);
    const Theta theta = test::theta_of(small);
    SolveOptions options = pool_options();
    const auto plan = [&](const Scene& scene, const Theta& t) {
        return plan_memory(prepare(scene), t, options);
    };
    const MemoryPlan before = plan(small, theta);
    EXPECT_DOUBLE_EQ(plan(scene_of(64), theta).images, 4 * before.images);

    Scene detailed = small;
    auto& mesh = std::get<Mesh>(detailed.shapes[0].geometry);
    const auto triangles = mesh.triangles;
    for (int i = 0; i < 100; ++i)
        mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
    EXPECT_GT(plan(detailed, theta).scene, before.scene + 200 * sizeof(TriangleRecord));

    Theta one = theta;
    one.textures.pop_back();
    EXPECT_LT(plan(small, one).textures, before.textures);

    options.gradient.estimator = Estimator::kMc;
    const MemoryPlan mc = plan(small, theta);
    EXPECT_EQ(mc.max_records, 0);
    options.gradient.samples_per_pixel = 3;
    EXPECT_DOUBLE_EQ(plan(small, theta).samples, 3 * mc.samples);
    options.gradient.estimator = Estimator::kPgris;
    EXPECT_GT(plan(small, theta).samples, 3 * mc.samples);
}

TEST(Memory, NothingIsKeptOfWhatIsNotSeen) {
    Scene scene = scene_of(32);
    const Theta theta = test::theta_of(scene);
    const double share = record_share(prepare(scene), theta, 1);
    EXPECT_GT(share, 0.1);
    EXPECT_LT(share, 1);
    scene.camera.to_world = look_at({0, 0, 5}, {0, 0, 10}, {0, 1, 0});
    EXPECT_EQ(record_share(prepare(scene), theta, 1), 0);
}

}  // namespace
}  // namespace burnish
