// The same bytes for any number of threads: image, gradient, reservoirs, and textures after some
// iterations. More threads than cores too, in arenas of their own.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cstring>

#include "core/parallel.h"
#include "optimize/solve.h"
#include "gradient/small_scene.h"

namespace burnish {
namespace {

/// Everything that a run leaves, as bytes.
struct Bytes {
    std::string data;

    template <class T>
    void add(const T& value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        data.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    void add(const Image& image) {
        for (const float v : image.values) add(v);
    }
    void add(const Vec3f& v) { add(v.x), add(v.y), add(v.z); }
};

void add_sample(Bytes& bytes, const HistorySample& s) {
    bytes.add(s.key.slot), bytes.add(s.key.texel), bytes.add(s.q), bytes.add(s.W);
    bytes.add(s.path.camera.pixel), bytes.add(s.path.camera.iteration);
    bytes.add(s.path.camera.pass), bytes.add(s.path.technique);
    bytes.add(s.record.pixel), bytes.add(s.record.uv.x), bytes.add(s.record.uv.y);
    bytes.add(s.record.wi_local), bytes.add(s.record.wo_local);
    bytes.add(s.record.radiance_over_pdf);
}

/// Image after one pass, then three iterations of the descent.
std::string run_all(SolveOptions options) {
    Scene scene = test::make_small_scene();
    scene.film.width = scene.film.height = scene.film.crop_width = scene.film.crop_height = 40;
    const TracedScene traced = prepare(scene);
    Problem problem{&traced, make_image(40, 40, 3, 0.2f), {}};
    options.samples_per_pixel = 2;
    options.parameterization.kind = Parameterization::kPyramid;
    std::vector<InitialTexture> textures;
    for (const ThetaTexture& t : test::theta_of(scene).textures)
        textures.push_back({t.texture, t.values, 0.05f});
    SolveState state = start(options, textures);
    Bytes bytes;
    for (int i = 0; i < 3; ++i) {
        const IterationReport report = iterate(problem, options, state);
        bytes.add(report.loss);
        for (const Outlier& e : report.counts.outliers)
            bytes.add(e.value), bytes.add(e.pixel), bytes.add(e.slot), bytes.add(e.texel),
                bytes.add(e.technique);
    }
    for (const ThetaTexture& t : state.theta.textures) bytes.add(t.values);
    for (const HistorySample& s : state.history.samples) add_sample(bytes, s);
    bytes.add(state.history.confidence), bytes.add(state.static_image);
    for (const float s : state.history.pixels.squares) bytes.add(s);
    bytes.add(evaluate(problem, options, state.theta, 2, 0).image);

    GradientOptions alone = options.gradient;
    if (alone.estimator == Estimator::kPool) return bytes.data;  // of a descent alone
    alone.seed = options.seed;
    const Image adjoint = test::make_adjoint(scene, 71, true);
    const auto result = estimate_gradient(traced, state.theta, adjoint, 9, alone, state.history);
    for (const TexelGradient& g : result.gradient)
        bytes.add(g.key.slot), bytes.add(g.key.texel), bytes.add(g.g);
    for (const HistorySample& s : result.history.samples) add_sample(bytes, s);
    return bytes.data;
}

std::string run_with(int threads, const SolveOptions& options) {
    const ThreadLimit limit(threads);
    tbb::task_arena arena(threads);
    return arena.execute([&] { return run_all(options); });
}

void expect_same_bytes(SolveOptions options, const char* what) {
    options.seed = 5;
    const std::string one = run_with(1, options);
    for (const int threads : {2, 3, 5})
        EXPECT_TRUE(run_with(threads, options) == one)
            << name_of(options.gradient.estimator) << ", " << what << ", " << threads << " threads";
    options.seed = 6;
    EXPECT_FALSE(run_with(1, options) == one) << "another seed, other bytes";
}

TEST(Determinism, ResultsAreTheSameBytesForAnyNumberOfThreads) {
    for (const Estimator estimator :
         {Estimator::kMc, Estimator::kRis, Estimator::kPris, Estimator::kGris, Estimator::kPgris})
        for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
            if (!has_history(estimator) && shift == Shift::kIdentity) continue;
            SolveOptions options;
            options.gradient.estimator = estimator;
            options.gradient.shift = shift;
            options.gradient.samples_per_pixel = 2;
            expect_same_bytes(options, name_of(shift));
        }
}

TEST(Determinism, OfAnAdaptiveChoiceOfPixelsToo) {
    for (const Estimator estimator : {Estimator::kMc, Estimator::kPgris}) {
        SolveOptions options;
        options.gradient.estimator = estimator;
        options.gradient.pixels = PixelChoice::kAdaptive;
        expect_same_bytes(options, "adaptive");
    }
}

TEST(Determinism, OfPoolsToo) {
    for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol}) {
        SolveOptions options;
        options.gradient.estimator = Estimator::kPool;
        options.pool.sequence = sequence;
        expect_same_bytes(options, sequence == Sequence::kSobol ? "sobol" : "independent");
    }
}

}  // namespace
}  // namespace burnish
