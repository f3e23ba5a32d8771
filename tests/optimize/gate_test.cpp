// The signal-to-noise gate of a path cache at the truth, where all of a gradient is noise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "gradient/small_scene.h"
#include "ledger_entries.h"
#include "optimize/step_gradient.h"

namespace burnish {
namespace {

/// The floor fills the picture: there is no background, whose noise the halves would share.
Problem problem_at_truth() {
    Scene scene = test::make_small_scene();
    scene.camera.fov_x = 10;
    Problem problem{make_renderer(scene), {}, {}};
    problem.views = {{problem.renderer.render(1 << 15, 215), {}}};
    const Theta truth = test::theta_of(scene);
    for (std::size_t i = 0; i < truth.textures.size(); ++i)
        problem.unknowns.push_back({scene.parameters[i].name, truth.textures[i].values});
    return problem;
}

/// Of the texels' channels that have had a gradient, the share whose gate is shut.
double shut_share(const Solver& solver) {
    const State state = solver.state();
    std::size_t shut = 0, all = 0;
    for (const PyramidState& p : state.values().pyramids) {
        const AdamState& adam = p.levels.front().adam;
        for (std::size_t i = 0; i < adam.square.size(); ++i) {
            if (adam.square[i] == 0) continue;
            ++all;
            if (snr_gate(adam.square[i], adam.noise[i]) == 0) ++shut;
        }
    }
    return static_cast<double>(shut) / static_cast<double>(all);
}

/// Its mean over the steps in which the window fills.
double mean_shut_share(const Problem& problem, Sequence sequence, std::uint32_t seed) {
    constexpr int kSteps = 4;
    PathCache cache;
    cache.samples = 32, cache.window = 32, cache.sequence = sequence;
    Options options = test::gradient_options(cache);
    options.adam.gate = true;
    options.seed = seed;
    Solver solver(problem, options);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        solver.step();
        sum += shut_share(solver);
    }
    return sum / kSteps;
}

using ProblemOf = std::function<Problem(std::uint32_t seed)>;

/// Over runs of other seeds: texels of one run depend on each other.
test::MeanEstimate mean_over_seeds(const ProblemOf& problem, Sequence sequence) {
    const test::LedgerEntry& entry = test::ledger::kGateAtTruth;
    std::vector<double> shares(test::scaled(entry, 400u));
    parallel_for(shares.size(), [&](std::size_t r) {
        const std::uint32_t seed = test::seed_of(entry, static_cast<std::uint32_t>(r));
        shares[r] = mean_shut_share(problem(seed), sequence, seed);
    });
    test::RunningMean mean;
    for (const double share : shares) mean.add(share);
    return test::estimate_of(mean);
}

/// p-value of "the mean lies in the bounds". A gate is shut where the halves' product, averaged
/// over the steps, is not positive: half of the time where noise is symmetric and the halves do not
/// depend on each other. Errors of image and derivative within a half go together, so at the truth
/// the halves have a correlation c >= 0, and of normal noise 1/2 - arcsin(c) / pi are shut; skewed
/// noise takes its share, too. c is about the relative variance of a pixel of one half: here at
/// most 0.15.
double bounds_p_value(const test::MeanEstimate& share) {
    return test::welch_p_value(share, {std::clamp(share.mean, 0.45, 0.5), 0});
}

TEST(GateAtTheTruth, IsShutForHalfOfTheTexels) {
    const test::LedgerEntry& entry = test::ledger::kGateAtTruth;
    const Problem problem = problem_at_truth();
    for (const Sequence sequence : {Sequence::kSobol, Sequence::kIndependent}) {
        const test::MeanEstimate share = mean_over_seeds([&](auto) { return problem; }, sequence);
        const char* name = sequence == Sequence::kSobol ? "sobol" : "independent";
        fmt::print("{}: shut {:.4f} +- {:.4f}\n", name, share.mean, share.standard_error);
        EXPECT_TRUE(accepted(entry, name, bounds_p_value(share)));
    }
    const ProblemOf with_one_image = [&](std::uint32_t seed) {
        Problem other = problem;
        const Image image = problem.renderer.render(64, seed);
        other.loss = [image, target = problem.views[0].image](const Image&, std::size_t) {
            return evaluate_loss(Loss::kRelMse, image, target, {});
        };
        return other;
    };
    EXPECT_TRUE(rejected(entry, "halves weighed by one image",
                         bounds_p_value(mean_over_seeds(with_one_image, Sequence::kSobol))));
}

}  // namespace
}  // namespace burnish
