#include "optimize/iterate.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/random.h"
#include "core/stopwatch.h"
#include "optimize/loss.h"
#include "scene/parameter_names.h"
#include "texture/coverage.h"

namespace burnish {

namespace {

/// to += scale (a + b + ...), value by value.
void add(Image& to, float scale, std::span<const Image> images) {
    parallel_chunks(to.values.size(), std::size_t{1} << 16, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) {
            float sum = images[0].values[i];
            for (std::size_t k = 1; k < images.size(); ++k) sum += images[k].values[i];
            to.values[i] += scale * sum;
        }
    });
}

/// The mean image with the background, and the adjoint of each image with it.
struct Losses {
    double value = 0;
    Image mean;
    std::vector<Image> adjoints;
};

Losses find_losses(const Setup& setup, const Image& background, std::vector<Image>& images) {
    Losses losses;
    losses.mean = background;
    add(losses.mean, 1 / static_cast<float>(images.size()), images);
    if (images.size() == 1) {
        LossValue loss = loss_of(setup, losses.mean);
        losses.value = loss.value;
        losses.adjoints.push_back(std::move(loss.adjoint));
        return losses;
    }
    losses.value = loss_value_of(setup, losses.mean);
    for (Image& image : images) {
        add(image, 1.0f, {&background, 1});
        losses.adjoints.push_back(loss_of(setup, image).adjoint);
    }
    return losses;
}

void take_step(const Setup& setup, const std::vector<SplitGradient>& gradient, State::Values& state,
               Workspace& workspace) {
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        const UnknownTexture& unknown = setup.unknowns[i];
        descend(unknown.adam, unknown.maps, gradient[i], state.pyramids[i], workspace.pyramids[i],
                state.theta.textures[i].values);
    }
}

}  // namespace

State::Values make_state(const Setup& setup) {
    State::Values state;
    state.estimator = make_state(setup.options.estimator);
    for (const UnknownTexture& u : setup.unknowns) {
        state.pyramids.push_back(encode(u.maps, u.start, u.adam.weight_decay > 0));
        state.theta.textures.push_back({u.texture, decode(u.maps, state.pyramids.back())});
    }
    return state;
}

Workspace make_workspace(const Setup& setup, const State::Values& state) {
    const Binding binding(*setup.scene, state.theta);
    Workspace workspace;
    workspace.estimator = make_workspace(setup.options.estimator, binding);
    workspace.near = near_unknown(binding);
    workspace.pyramids.resize(setup.unknowns.size());
    return workspace;
}

Iteration iterate(const Setup& setup, State::Values& state, Workspace& workspace) {
    Iteration report;
    report.number = state.iteration;
    Stopwatch watch;
    const Options& o = setup.options;
    const Binding binding(*setup.scene, state.theta);

    const BackgroundOptions background{std::max(1u, image_samples(o.estimator) / 8),
                                       o.background_samples, o.seed};
    report.rejected_image =
        gather_background(binding, workspace.near, background, state.iteration, state.background);
    const IterationKey key{o.seed, state.iteration};
    ImageEstimate image =
        estimate_image(o.estimator, binding, key, state.estimator, workspace.estimator);
    report.rejected_image += image.rejected_samples;
    Losses losses = find_losses(setup, state.background.mean, image.images);
    report.loss = losses.value;
    report.image_seconds = watch.lap();

    const GradientEstimate estimate = estimate_gradient(o.estimator, binding, losses.adjoints, key,
                                                        state.estimator, workspace.estimator);
    const GradientCounts& counts = estimate.counts;
    report.paths = counts.records, report.derivatives = counts.candidates;
    report.texels = counts.texels, report.reservoirs = counts.reservoirs;
    report.rejected_derivatives = counts.rejected + image.rejected_records;
    report.derivative_seconds = watch.lap();

    take_step(setup, estimate.gradient, state, workspace);
    workspace.image = std::move(losses.mean);
    ++state.iteration;
    report.step_seconds = watch.lap();
    return report;
}

Image evaluation_image(const Setup& setup, const Theta& theta, EvaluationKey key,
                       std::uint32_t passes, const Progress& progress) {
    const TextureTable textures = texture_table(*setup.scene->scene, theta);
    TraceInput input;
    input.scene = setup.scene;
    input.textures = &textures;
    // A seed for each half: the passes of one seed share a sequence of film offsets that fills the
    // pixel evenly, so that parts of it are not independent.
    const auto seed =
        philox4x32({key.salt, key.half, 0, 0},
                   {setup.options.seed, static_cast<std::uint32_t>(Stream::kEvaluation)})[0];
    input.key = {seed, Stream::kEvaluation};
    input.passes_per_iteration = passes;
    return render(input, 0, 0, passes, nullptr, progress);
}

Evaluation evaluate(const Setup& setup, const Theta& theta, std::uint32_t samples_per_pixel,
                    std::uint32_t salt, const Progress& progress) {
    const std::uint32_t half = samples_per_pixel / 2;
    const auto image = [&](std::uint32_t which) {
        const Progress share = [&](double done) { progress((which + done) / 2); };
        return evaluation_image(setup, theta, {salt, which}, half, progress ? share : Progress{});
    };
    Evaluation result;
    result.samples_per_pixel = 2 * half;
    const Image a = image(0), b = image(1);
    result.image = mean_of(a, b);
    result.loss = loss_value_of(setup, result.image);
    result.noise_floor = noise_floor(setup, a, b);
    return result;
}

std::vector<RecoveredTexture> recovered_textures(const Setup& setup, const State::Values& state) {
    std::vector<RecoveredTexture> textures;
    const std::vector<Parameter>& parameters = setup.scene->scene->parameters;
    for (std::size_t i = 0; i < setup.unknowns.size(); ++i) {
        const UnknownTexture& u = setup.unknowns[i];
        const PyramidState& pyramid = state.pyramids[i];
        RecoveredTexture t;
        t.name = parameters[find_parameter(parameters, setup.problem.unknowns[i].name)].name;
        t.values = state.theta.textures[i].values;
        if (setup.options.unvisited == Unvisited::kFill)
            fill_unvisited(pyramid.visits, t.values);
        else
            keep_unvisited(pyramid.visits, u.start, t.values);
        t.coverage = make_image(t.values.width, t.values.height, 1);
        for (std::size_t k = 0; k < pyramid.visits.size(); ++k)
            t.coverage.values[k] = static_cast<float>(pyramid.visits[k]) /
                                   static_cast<float>(std::max(1u, state.iteration));
        t.confidence = confidence(pyramid);
        textures.push_back(std::move(t));
    }
    return textures;
}

}  // namespace burnish
