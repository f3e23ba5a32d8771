#include "gradient/path_cache/iteration.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "render/shade.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

/// The whole static part gets a pass at the start and then in every kStaticPeriod'th iteration, so
/// many in all; pixels that mix it with what is optimised get one in each iteration, up to
/// SolveOptions::static_samples_per_pixel.
constexpr std::uint32_t kStaticPasses = 16, kStaticPeriod = 8;
/// Both kinds of passes are numbered on their own: a low-discrepancy sequence wants to be taken
/// without gaps.
constexpr std::uint32_t kFirstNearPass = 1024;

void gather_static(const Problem& problem, const SolveOptions& options, SolveState& state,
                   std::size_t& rejected) {
    const bool everywhere =
        state.iteration % kStaticPeriod == 0 && state.iteration < kStaticPasses * kStaticPeriod;
    if (!everywhere && state.static_passes >= options.static_samples_per_pixel) return;
    const Scene& scene = *problem.scene->scene;
    const TextureTable textures = texture_table(scene, state.theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, state.theta);
    const TraceInput input{
        problem.scene, &textures, {options.seed, Stream::kImage}, 1, SurfaceChoice::kConstant,
        unknowns,       false,     options.pool.sequence};
    // Samples reach a halo further than the pixels that they are for.
    const std::vector<char> none, &samples = everywhere ? none : state.pool.near_unknown.samples,
                                  &pixels = everywhere ? none : state.pool.near_unknown.pixels;
    RenderCounts counts;
    const std::uint32_t pass =
        everywhere ? state.iteration / kStaticPeriod : kFirstNearPass + state.static_passes;
    const Image extra = render(input, 0, pass, 1, &counts, {}, samples);
    rejected += counts.rejected;
    add_static_passes(extra, 1, pixels, state);
}

/// The plan for so many pixels that see an optimised texture.
PoolPlan plan_for(const Scene& scene, const Theta& theta, const PoolOptions& options,
                  std::size_t pixels) {
    const std::vector<char> unknowns = unknown_bsdfs(scene, theta);
    const TextureTable textures = texture_table(scene, theta);
    const auto shaders = make_record_shaders(scene, textures, theta_slots(scene, theta));
    std::size_t per_record = 0;
    for (std::size_t i = 0; i < shaders.size(); ++i)
        if (unknowns[i]) per_record = std::max(per_record, bytes_per_record(shaders[i]));
    PoolPlan plan{pixels, pixels * kTechniques * per_record, options.window};
    if (options.memory == 0 || plan.bytes_per_pass == 0) return plan;
    const std::size_t fitting = options.memory / (2 * plan.bytes_per_pass);
    if (fitting == 0)
        throw InputError("a pool with one pass in each bank takes up to " +
                         std::to_string(2 * plan.bytes_per_pass) +
                         " bytes: expected a memory limit above it, found " +
                         std::to_string(options.memory));
    plan.window = static_cast<std::uint32_t>(std::min<std::size_t>(plan.window, fitting));
    return plan;
}

void start_pool(const Problem& problem, const SolveOptions& options, SolveState& state) {
    const Scene& scene = *problem.scene->scene;
    state.pool = make_pool(scene, state.theta);
    std::size_t pixels = 0;
    for (const PoolTile& tile : state.pool.tiles) pixels += tile.pixels.size();
    state.pool.most = plan_for(scene, state.theta, options.pool, pixels).window;
}

/// to += scale (a + b + ...), value by value.
template <class... Images>
void add(Image& to, float scale, const Images&... images) {
    parallel_chunks(to.values.size(), std::size_t{1} << 16, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) to.values[i] += scale * (images.values[i] + ...);
    });
}

}  // namespace

PoolPlan plan_pool(const Scene& scene, const Theta& theta, const PoolOptions& options) {
    const std::vector<char> seen = visible_pixels(scene, unknown_bsdfs(scene, theta));
    return plan_for(scene, theta, options,
                    static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1)));
}

void iterate_pool(const Problem& problem, const SolveOptions& options, SolveState& state,
                  IterationReport& report) {
    Stopwatch watch;
    if (state.iteration == 0) start_pool(problem, options, state);
    const PoolInput input{problem.scene, &state.theta, options.seed, options.pool.sequence};
    gather_static(problem, options, state, report.rejected_image);
    report.rejected_image += trace_fresh(input, options.pool.samples_per_pixel, state.pool);
    keep_window(state.pool, state.pool.most);

    auto [images, not_finite] = pool_images(input, state.pool);
    report.counts.rejected += not_finite;
    std::array<Image, 2> adjoints;
    Image mean = state.static_image;
    add(mean, 0.5f, images[0], images[1]);
    report.loss = loss_value(options.loss, mean, problem.target, problem.mask);
    for (std::size_t b = 0; b < 2; ++b) {
        add(images[b], 1.0f, state.static_image);
        adjoints[b] = evaluate_loss(options.loss, images[b], problem.target, problem.mask).adjoint;
    }
    report.image_seconds = watch.lap();
    const std::vector<SplitGradient>& gradient = pool_gradient(input, state.pool, adjoints);
    report.counts.records = pool_size(state.pool).records;
    report.counts.outliers = state.pool.outliers;
    report.derivative_seconds = watch.lap();
    take_step(options, gradient, state);
    report.step_seconds = watch.lap();
}

}  // namespace burnish
