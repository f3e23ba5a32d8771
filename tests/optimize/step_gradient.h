// The gradient of an iteration through the public interface, and what it must be: the slope of the
// loss between converged images.
#pragma once

#include "core/parallel.h"
#include "ledger.h"
#include "optimize/loss.h"
#include "optimize/state.h"
#include "render/renderer.h"
#include "student.h"

namespace burnish::test {

/// Adam forgets at once, so that its mean is the gradient of the last iteration; texels on their
/// own and steps too short to move any of them.
inline Options gradient_options(const Estimator& estimator) {
    Options options;
    options.estimator = estimator;
    options.parameterization = Parameterization::kTexels;
    options.adam.beta1 = 0;
    options.adam.initial_rate = 0.0f;
    options.learning_rate = 1e-12;
    options.loss = Loss::kRelMse;
    options.background_samples = 64;
    return options;
}

/// dL / d(texture) of the last iteration, parallel to the unknowns.
inline std::vector<Image> gradient_of(const Solver& solver) {
    std::vector<Image> gradient;
    const State state = solver.state();
    for (const PyramidState& p : state.values().pyramids) {
        gradient.push_back(p.levels.front().values);
        std::vector<float>& values = gradient.back().values;
        const std::vector<float>& mean = p.levels.front().adam.mean;
        std::copy(mean.begin(), mean.end(), values.begin());
    }
    return gradient;
}

/// What is done to a state between two iterations.
using Tamper = void (*)(State::Values&);
inline void leave_alone(State::Values&) {}

/// A solver whose textures are others: those of a script, not of the loop.
inline Solver with_textures(const Problem& problem, const Options& options, const Solver& solver,
                            const Theta& theta, Tamper tamper = leave_alone) {
    State::Values values = solver.state().values();
    tamper(values);
    for (std::size_t i = 0; i < theta.textures.size(); ++i)
        values.theta.textures[i].values = values.pyramids[i].levels.front().values =
            theta.textures[i].values;
    return Solver(problem, options, State(std::move(values)));
}

/// A direction in the space of all texels: an image for each texture.
using Direction = std::vector<Image>;

inline double dot(const Direction& a, const std::vector<Image>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t k = 0; k < a[i].values.size(); ++k)
            sum += double{a[i].values[k]} * double{b[i].values[k]};
    return sum;
}

inline TextureValues moved(const Problem& problem, const Theta& theta, const Direction& direction,
                           float by) {
    TextureValues values;
    for (std::size_t i = 0; i < theta.textures.size(); ++i) {
        Image image = theta.textures[i].values;
        for (std::size_t k = 0; k < image.values.size(); ++k)
            image.values[k] += by * direction[i].values[k];
        values[problem.unknowns[i].name] = std::move(image);
    }
    return values;
}

/// How a slope is measured.
struct SlopeOptions {
    std::uint32_t samples = 64, replicas = 24;
    float step = 0.03f;
    std::uint32_t seed = 0;
};

/// The slope of the problem's loss along each direction, by central differences of rendered images.
/// The adjoint's image is independent of the others, so the slope is unbiased for a loss whose
/// adjoint is affine in the image.
inline std::vector<MeanEstimate> slopes(const Problem& problem, const Theta& theta,
                                        const std::vector<Direction>& directions,
                                        const SlopeOptions& o) {
    const auto render = [&](std::size_t k, float by, std::uint32_t seed) {
        return problem.renderer.render(o.samples, seed, moved(problem, theta, directions[k], by));
    };
    std::vector<std::vector<double>> values(o.replicas);
    parallel_for(o.replicas, [&](std::size_t r) {
        const std::uint32_t seed = o.seed + 2 * static_cast<std::uint32_t>(r);
        const Image image = render(0, 0, seed);
        const Image adjoint =
            problem.loss
                ? problem.loss(image, 0).adjoint
                : evaluate_loss(Loss::kRelMse, image, problem.views[0].image, problem.views[0].mask)
                      .adjoint;
        for (std::size_t k = 0; k < directions.size(); ++k) {
            const Image up = render(k, o.step, seed + 1), down = render(k, -o.step, seed + 1);
            double slope = 0;
            for (std::size_t i = 0; i < up.values.size(); ++i)
                slope +=
                    double{adjoint.values[i]} * (double{up.values[i]} - double{down.values[i]});
            values[r].push_back(slope / (2 * double{o.step}));
        }
    });
    std::vector<RunningMean> means(directions.size());
    for (const auto& replica : values)
        for (std::size_t k = 0; k < replica.size(); ++k) means[k].add(replica[k]);
    std::vector<MeanEstimate> result;
    for (const RunningMean& m : means) result.push_back(estimate_of(m));
    return result;
}

}  // namespace burnish::test
