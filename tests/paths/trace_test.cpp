// trace_batch: results do not depend on batch composition, and a path that is traced again alone is
// the path that was traced. That the paths are right: tests/reference/paths_test.cpp.
#include "paths/trace.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "gradient/blends.h"
#include "gradient/candidates.h"
#include "paths/ray_columns.h"

namespace burnish {
namespace {

/// A sample gives the same bits alone, in a full batch, and in any order.
TEST(TraceBatch, ASampleDoesNotDependOnItsCompany) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {80, Stream::kTest}, 8, SurfaceChoice::kAll, {}};
    std::vector<BatchSample> samples(kBatchSamples);
    for (std::uint32_t i = 0; i < kBatchSamples; ++i) samples[i].camera = {i % 256, 0, i / 256};
    std::vector<Rgbf> together(samples.size());
    trace_radiance(input, samples, together);
    std::reverse(samples.begin(), samples.end());
    std::size_t begin = 0;
    for (const std::size_t size : {1u, 15u, 16u, 17u, 300u, 675u}) {
        std::vector<Rgbf> part(size);
        trace_radiance(input, std::span(samples).subspan(begin, size), part);
        for (std::size_t i = 0; i < size; ++i)
            EXPECT_EQ(part[i], together[samples.size() - 1 - begin - i]);
        begin += size;
    }
    EXPECT_EQ(begin, samples.size());
}

TEST(RayColumns, SortingByDirectionKeepsEveryLane) {
    auto direction = std::make_unique<ColumnVec3>();
    ActiveList list;
    test::RandomSource random{81};
    for (std::size_t i = 0; i < 1000; ++i) {
        set(*direction, i,
            normalize(Vec3f{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)}));
        if (i % 3 != 1) list.add(i);
    }
    direction->x[6] = NAN;
    ActiveList sorted = list;
    sort_by_direction(*direction, sorted);
    ASSERT_EQ(sorted.count, list.count);
    const auto octant = [&](std::size_t i) {
        return 4 * (direction->x[i] > 0) + 2 * (direction->y[i] > 0) + (direction->z[i] > 0);
    };
    for (std::size_t k = 1; k < sorted.count; ++k)
        EXPECT_LE(octant(sorted.lane[k - 1]), octant(sorted.lane[k]));
    std::sort(sorted.lane.begin(), sorted.lane.begin() + static_cast<int>(sorted.count));
    EXPECT_TRUE(std::equal(sorted.lane.begin(), sorted.lane.begin() + static_cast<int>(list.count),
                           list.lane.begin()));
}

TEST(TraceBatch, SplitsIntoStaticAndDynamicParts) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const TextureTable textures = texture_table(scene, theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, theta);
    std::array<double, 3> sums{};
    for (const SurfaceChoice choice :
         {SurfaceChoice::kAll, SurfaceChoice::kUnknown, SurfaceChoice::kConstant}) {
        const TraceInput input{&traced, &textures, {78, Stream::kTest}, 1, choice, unknowns};
        std::vector<BatchSample> samples(256);
        for (std::uint32_t i = 0; i < 256; ++i) samples[i].camera = {i, 0, 0};
        BatchOutput out;
        trace_batch(input, samples, out);
        double& sum = sums[static_cast<std::size_t>(choice)];
        for (const Rgbf& e : out.emitted) sum += double{e.x};
        for (const DirectSample& d : out.direct_samples) sum += double{d.value.x};
    }
    EXPECT_NEAR(sums[0], sums[1] + sums[2], 1e-9 * sums[0]);
    EXPECT_GT(sums[1], 0);
    EXPECT_GT(sums[2], 0);
}

TEST(TraceBatch, ReplayOfAPathIsThePath) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const TextureTable textures = texture_table(scene, theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, theta);
    const TraceInput input{
        &traced, &textures, {79, Stream::kDerivative}, 4, SurfaceChoice::kUnknown, unknowns};
    std::size_t rejected = 0;
    const std::vector<TracedPath> traced_paths = trace_paths(input, 5, 4).paths;
    std::vector<PathSample> names;
    for (const TracedPath& p : traced_paths) names.push_back(p.path);
    std::reverse(names.begin(), names.end());  // in other company
    const std::vector<PathRecord> replayed = trace_again(input, names, rejected);
    ASSERT_GT(traced_paths.size(), 500u);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const PathRecord& a = traced_paths[names.size() - 1 - i].record;
        const PathRecord& b = replayed[i];
        EXPECT_EQ(a.pixel, b.pixel);
        EXPECT_EQ(a.technique, b.technique);
        EXPECT_EQ(a.wo_local, b.wo_local);
        EXPECT_EQ(a.radiance_over_pdf, b.radiance_over_pdf);
        EXPECT_EQ(a.uv.x, b.uv.x);
    }
}

/// Small scenes with all that a camera's ray can meet before light is scattered.
std::map<std::string, Scene> scenes_to_replay() {
    std::map<std::string, Scene> scenes{{"quads", test::make_small_scene()},
                                        {"blends", test::make_small_scene_of_blends()}};
    Scene ball = test::make_small_scene();
    std::get<Sphere>(ball.shapes[2].geometry) = {};
    std::get<Sphere>(ball.shapes[2].geometry).radius = 0.5f;
    ball.shapes[2].material = {0}, ball.shapes[2].emitter = {};
    ball.emitters.erase(ball.emitters.begin() + 1);
    scenes["ball"] = ball;
    Scene instance = test::make_small_scene();
    instance.prototypes = {instance.shapes[0]};
    instance.shapes[0].geometry = Instance{0, rotation({0, 0, 1}, 30), rotation({0, 0, 1}, -30)};
    scenes["instance"] = instance;
    Scene bumps = test::make_small_scene();
    bumps.textures.emplace_back(test::make_bitmap(4, 1, TextureFilter::kBilinear, 0.0f, 0.2f, 63));
    bumps.materials[0].normals = NormalMap{.texture = {2}, .height_scale = 1};
    scenes["bumps"] = bumps;
    Scene lens = test::make_small_scene();
    lens.camera.aperture_radius = 0.1f, lens.camera.focus_distance = 2;
    scenes["lens"] = lens;
    Scene wall = test::make_small_scene();  // which hides either light from a part of the floor
    wall.shapes.push_back(
        {"wall", test::make_quad({-0.1f, -0.6f, 0.1f}, {0, 1, 0}, {0, 0, 1}), {1}, {}});
    scenes["wall"] = wall;
    return scenes;
}

struct SceneToReplay {
    std::string name;
    Scene scene;
    LightSelection selection;
};
std::vector<SceneToReplay> selections_to_replay() {
    std::vector<SceneToReplay> all;
    for (const auto& [name, scene] : scenes_to_replay())
        for (const auto s : {LightSelection::kUniform, LightSelection::kResampled})
            all.push_back({name, scene, s});
    return all;
}

/// Paths that were traced under some textures, under others: with the rays that textures change,
/// and with all.
TEST(TraceBatch, ReplayWithoutRaysIsReplayWithRays) {
    for (const auto& [name, scene, selection] : selections_to_replay()) {
        SCOPED_TRACE(name + std::to_string(static_cast<int>(selection)));
        const TracedScene traced = prepare(scene, selection);
        const Theta theta = test::theta_of(scene);
        Theta other = theta;
        for (ThetaTexture& t : other.textures)
            for (float& v : t.values.values) v = 1.2f * v - 0.1f;
        const Binding born(traced, theta), later(traced, other);
        std::array<std::size_t, kTechniques> counts{};
        std::size_t changed = 0, hidden = 0;
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol}) {
            const auto under = [&](const Binding& binding) {
                TraceInput input = unknown_derivatives(binding, {79, Stream::kDerivative}, 16);
                input.sequence = sequence;
                return input;
            };
            const auto paths = trace_paths(under(born), 3, 16).paths;
            std::vector<PathSample> names;
            std::vector<Hit> hits;
            std::vector<PathRecord> records;
            for (const TracedPath& p : paths)
                names.push_back(p.path), hits.push_back(p.hit), records.push_back(p.record);
            std::size_t rejected = 0;
            const auto fast = replay_paths(under(later), names, hits, records, rejected),
                       slow = trace_again(under(later), names, rejected);
            EXPECT_EQ(rejected, 0u);
            ASSERT_EQ(fast.size(), paths.size());
            for (std::size_t i = 0; i < paths.size(); ++i) {
                EXPECT_EQ(fast[i], slow[i]);
                ++counts[static_cast<std::size_t>(names[i].technique)];
                changed += slow[i] != paths[i].record;
                hidden += names[i].technique == Technique::kEmitter && slow[i] == PathRecord{};
            }
        }
        EXPECT_GT(counts[0], 500u);
        EXPECT_GT(counts[1], 500u);
        EXPECT_GT(changed, 500u);
        if (name == "wall" && selection == LightSelection::kResampled) {
            EXPECT_GT(hidden, 5u);
        }
    }
}

}  // namespace
}  // namespace burnish
