#include "optimize/solve.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "gradient/path_cache/iteration.h"

namespace burnish {

namespace {

/// Adds this iteration's share of passes to the static part: a full image at first, an eighth of
/// one later, until there are enough.
void gather_static(const TraceInput& trace, const SolveOptions& options, SolveState& state,
                   RenderCounts& counts) {
    const std::uint32_t wanted = state.static_passes == 0
                                     ? options.samples_per_pixel
                                     : std::max(1u, options.samples_per_pixel / 8);
    const std::uint32_t most =
        std::max(options.static_samples_per_pixel, options.samples_per_pixel);
    const std::uint32_t passes = std::min(wanted, most - std::min(most, state.static_passes));
    if (passes == 0) return;
    TraceInput input = trace;
    input.choice = SurfaceChoice::kConstant;
    const Image extra = render(input, state.iteration, 0, passes, &counts);
    add_static_passes(extra, passes, {}, state);
}

Image primal_image(const TraceInput& trace, const SolveOptions& options, SolveState& state,
                   RenderCounts& counts) {
    gather_static(trace, options, state, counts);
    TraceInput input = trace;
    input.choice = SurfaceChoice::kUnknown;
    Image image = render(input, state.iteration, 0, options.samples_per_pixel, &counts);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        image.values[i] += state.static_image.values[i];
    return image;
}

void require(bool holds, const std::string& message) {
    if (!holds) throw InputError(message);
}

std::string size_text(const Image& image) {
    return std::to_string(image.width) + " x " + std::to_string(image.height);
}

}  // namespace

InitialTexture initial_texture(const Scene& scene, Parameterization kind, TextureId texture,
                               Image values, float learning_rate) {
    const bool shares = kind != Parameterization::kTexels;
    return {texture, std::move(values), learning_rate,
            shares ? texture_charts(scene, texture) : ChartMap{},
            std::get<Bitmap>(scene[texture]).wrap == TextureWrap::kRepeat};
}

SolveState start(const SolveOptions& options, const std::vector<InitialTexture>& textures) {
    SolveState state;
    for (const InitialTexture& t : textures) {
        state.parameters.push_back(encode(options.parameterization, t.values, t.charts, t.repeats));
        state.theta.textures.push_back({t.texture, decode(state.parameters.back())});
        state.learning_rates.push_back(t.learning_rate);
    }
    return state;
}

void validate(const Problem& problem, const SolveOptions& options) {
    const Film& film = problem.scene->scene->film;
    const auto fits = [&](const Image& image) {
        return image.width == film.crop_width && image.height == film.crop_height;
    };
    const std::string expected =
        std::to_string(film.crop_width) + " x " + std::to_string(film.crop_height) + " pixels";
    require(fits(problem.target) && problem.target.channels == 3,
            "the target image has " + size_text(problem.target) + " pixels and " +
                std::to_string(problem.target.channels) +
                " channels: expected RGB of the film's size, " + expected);
    require(problem.mask.width == 0 || fits(problem.mask),
            "the mask has " + size_text(problem.mask) + " pixels: expected the film's size, " +
                expected);
    require(options.samples_per_pixel > 0, "samples per pixel are 0: expected at least 1");
    require(options.gradient.samples_per_pixel > 0,
            "derivative samples per pixel are 0: expected at least 1");
    require(options.parameterization.pyramid_levels > 0,
            "the pyramid has no level: expected at least 1");
    require(options.gradient.confidence_cap > 0, "the confidence cap is not positive");
    require(options.optimizer.learning_rate > 0, "the learning rate is not positive");
}

void add_static_passes(const Image& mean, std::uint32_t passes, std::span<const char> only,
                       SolveState& state) {
    state.static_passes += passes;
    Image& all = state.static_image;
    if (all.width == 0) {
        all = make_image(mean.width, mean.height, mean.channels);
        state.static_counts.assign(all.values.size() / 3, 0);
    }
    constexpr std::size_t kChunk = std::size_t{1} << 15;
    parallel_chunks(state.static_counts.size(), kChunk, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) {
            if (!only.empty() && !only[i]) continue;
            state.static_counts[i] += passes;
            const float share =
                static_cast<float>(passes) / static_cast<float>(state.static_counts[i]);
            for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
                all.values[k] += (mean.values[k] - all.values[k]) * share;
        }
    });
}

PrimalPass primal_pass(const Problem& problem, const SolveOptions& options, SolveState& state) {
    const Scene& scene = *problem.scene->scene;
    const TextureTable textures = texture_table(scene, state.theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, state.theta);
    const TraceInput trace{
        problem.scene,       &textures, {options.seed, Stream::kImage}, options.samples_per_pixel,
        SurfaceChoice::kAll, unknowns};
    RenderCounts counts;
    PrimalPass pass;
    pass.image = primal_image(trace, options, state, counts);
    pass.rejected = counts.rejected;
    pass.loss = evaluate_loss(options.loss, pass.image, problem.target, problem.mask);
    return pass;
}

void take_step(const SolveOptions& options, const std::vector<SplitGradient>& gradient,
               SolveState& state) {
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        OptimizerOptions optimizer = options.optimizer;
        optimizer.learning_rate = state.learning_rates[i];
        descend(optimizer, gradient[i], state.parameters[i], state.theta.textures[i].values);
    }
}

IterationReport iterate(const Problem& problem, const SolveOptions& options, SolveState& state) {
    IterationReport report;
    report.iteration = state.iteration;
    if (options.gradient.estimator == Estimator::kPool) {
        iterate_pool(problem, options, state, report);
        ++state.iteration;
        return report;
    }
    Stopwatch watch;

    const PrimalPass primal = primal_pass(problem, options, state);
    report.rejected_image = primal.rejected;
    report.loss = primal.loss.value;
    report.image_seconds = watch.lap();

    GradientOptions gradient_options = options.gradient;
    gradient_options.seed = options.seed;
    GradientResult result =
        estimate_gradient(*problem.scene, state.theta, primal.loss.adjoint, state.iteration,
                          gradient_options, std::move(state.history));
    state.history = std::move(result.history);
    report.counts = std::move(result.counts);
    report.derivative_seconds = watch.lap();

    take_step(options, unsplit(dense_gradient(state.theta, result.gradient)), state);
    ++state.iteration;
    report.step_seconds = watch.lap();
    return report;
}

Evaluation evaluate(const Problem& problem, const SolveOptions& options, const Theta& theta,
                    std::uint32_t samples_per_pixel, std::uint32_t salt, const Progress& progress) {
    const TextureTable textures = texture_table(*problem.scene->scene, theta);
    const TraceInput trace{
        problem.scene,     &textures,           {options.seed, Stream::kEvaluation},
        samples_per_pixel, SurfaceChoice::kAll, {}};
    Evaluation result;
    result.image = render(trace, salt, 0, samples_per_pixel, nullptr, progress);
    result.loss = loss_value(options.loss, result.image, problem.target, problem.mask);
    return result;
}

}  // namespace burnish
