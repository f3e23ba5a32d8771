// What reuse, positivisation, adaptive sampling and the path cache are for: less variance than
// without, at equal settings, along a script on which textures and adjoints drift. Total variance:
// the expected squared distance of a gradient from its mean, over all texels and channels.
//
// Each statement is "the variance of one is at most a share of that of another". Its p-value is
// one-sided: small where the data say that it is more.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gradient/estimator_script.h"

namespace burnish {
namespace {

using test::accepted;
using test::kScriptIterations;
using test::mc;
using test::rejected;
using test::RunningMean;
using test::Runs;
using test::scaled;
using test::Script;
using test::seed_of;
using test::Tamper;
using test::ledger::kVarianceRatios;

/// The textures and the adjoint of make_script, but they drift and keep their sign.
Script make_drifting_script() {
    Script script = test::make_script(false);
    const Image base = test::make_adjoint(script.scene, 81, true),
                drift = test::make_adjoint(script.scene, 82, true);
    for (std::size_t v = 0; v < kScriptIterations; ++v) {
        const float share = 0.05f * static_cast<float>(v);
        for (std::size_t i = 0; i < base.values.size(); ++i)
            script.adjoint[v].values[i] = base.values[i] + share * drift.values[i];
        for (std::size_t t = 0; t < script.theta[v].textures.size(); ++t) {
            std::vector<float>& texels = script.theta[v].textures[t].values.values;
            const auto& first = script.theta[0].textures[t].values.values;
            for (std::size_t i = 0; i < texels.size(); ++i)
                texels[i] = first[i] + 0.2f * (texels[i] - first[i]);
        }
    }
    return script;
}

constexpr std::size_t kRuns = 400;
/// The shares: between what is measured and what the defects make of it.
constexpr double kOfBaseline = 1, kOfGris = 0.6, kCacheOfBaseline = 0.25, kOfEven = 0.65;

/// Per run, the squared distance of the last iteration's numbers from their mean over the runs.
RunningMean total_variance(const Runs& runs, std::size_t numbers) {
    std::vector<RunningMean> means(numbers);
    for (const auto& run : runs)
        for (std::size_t i = 0; i < numbers; ++i) means[i].add(run.back()[i]);
    const double unbiased = static_cast<double>(runs.size()) / static_cast<double>(runs.size() - 1);
    RunningMean variance;
    for (const auto& run : runs) {
        double square = 0;
        for (std::size_t i = 0; i < numbers; ++i)
            square += (run.back()[i] - means[i].mean) * (run.back()[i] - means[i].mean);
        variance.add(unbiased * square);
    }
    return variance;
}

/// The left half of the picture matters little.
Script make_script_of_one_half() {
    Script script = test::make_script(false);
    for (Image& adjoint : script.adjoint)
        for (int y = 0; y < adjoint.height; ++y)
            for (int x = 0; x < adjoint.width / 2; ++x)
                for (int c = 0; c < 3; ++c) adjoint.at(x, y, c) *= 0.02f;
    return script;
}

class Variances : public testing::Test {
  protected:
    explicit Variances(Script of = make_drifting_script()) : script(std::move(of)) {}

    const Script script;
    const TracedScene traced = prepare(script.scene);
    const std::size_t numbers = numbers_of_theta();

    std::size_t numbers_of_theta() const {
        std::size_t count = 0;
        for (const ThetaTexture& t : script.theta[0].textures) count += t.values.values.size();
        return count;
    }

    RunningMean of(const Estimator& estimator, const Tamper& tamper = {}) const {
        Runs runs(scaled(kVarianceRatios, kRuns));
        parallel_for(runs.size(), [&](std::size_t run) {
            runs[run] =
                test::run_along(traced, test::spans_of(script), estimator,
                                seed_of(kVarianceRatios, static_cast<std::uint32_t>(run)), tamper);
        });
        return total_variance(runs, numbers);
    }

    /// A pass in each iteration, one of the two halves after the other; both weighed by the
    /// script's adjoint.
    RunningMean of_path_cache(std::size_t window) const {
        Runs runs(scaled(kVarianceRatios, kRuns));
        parallel_for(runs.size(), [&](std::size_t run) {
            const std::uint32_t seed =
                seed_of(kVarianceRatios, 10000 + static_cast<std::uint32_t>(run));
            PathCacheState state;
            PathCacheWorkspace workspace =
                make_workspace(PathCache{}, Binding(traced, script.theta[0]));
            for (std::size_t v = 0; v < kScriptIterations; ++v) {
                const Binding binding(traced, script.theta[v]);
                const PathCacheInput input{binding, seed, Sequence::kSobol};
                trace_passes(input, 1, workspace, state);
                keep_window(window, state);
                shade(input, state, workspace);
                const Image& adjoint = script.adjoint[v];
                const auto& gradient = accumulate(input, state, {&adjoint, &adjoint}, workspace);
                std::vector<double> all;
                for (const SplitGradient& g : gradient)
                    for (const float x : sum_of(g).values) all.push_back(double{x});
                runs[run] = {all};
            }
        });
        return total_variance(runs, numbers);
    }
};

/// p-value of "the variance of `a` is at most `share` of that of `b`".
double share_p_value(const RunningMean& a, const RunningMean& b, double share) {
    fmt::print("variance {:.4g}, {:.3f} of the other's\n", a.mean, a.mean / b.mean);
    return test::not_above_p_value(test::estimate_of(a),
                                   test::scaled_by(test::estimate_of(b), share));
}

/// Defect: what earlier iterations found is lost, and they count for nothing.
void lose_history(ReservoirsState& state, std::size_t) { state.history = {}; }

TEST_F(Variances, AreLessWithReuseAndPositivisation) {
    const RunningMean baseline = of(mc()), pgris = of(test::by_integrand(test::pgris())),
                      gris = of(test::by_integrand(test::gris()));
    EXPECT_TRUE(
        accepted(kVarianceRatios, "pgris, mc", share_p_value(pgris, baseline, kOfBaseline)));
    EXPECT_TRUE(accepted(kVarianceRatios, "pgris, gris", share_p_value(pgris, gris, kOfGris)));
    const RunningMean lost = of(test::by_integrand(test::pgris()), lose_history);
    EXPECT_TRUE(
        rejected(kVarianceRatios, "history lost", share_p_value(lost, baseline, kOfBaseline)));
    EXPECT_TRUE(
        rejected(kVarianceRatios, "one slot for both signs", share_p_value(gris, gris, kOfGris)));
}

TEST_F(Variances, AreLessWithAPathCache) {
    const RunningMean baseline = of(mc());
    EXPECT_TRUE(accepted(kVarianceRatios, "path cache, mc",
                         share_p_value(of_path_cache(100), baseline, kCacheOfBaseline)));
    EXPECT_TRUE(rejected(kVarianceRatios, "a window of one pass",
                         share_p_value(of_path_cache(1), baseline, kCacheOfBaseline)));
}

class VariancesOfOneHalf : public Variances {
  protected:
    VariancesOfOneHalf() : Variances(make_script_of_one_half()) {}
};

TEST_F(VariancesOfOneHalf, AreLessWithAdaptiveSampling) {
    MonteCarlo adaptive = mc();
    adaptive.adaptive_sampling = true;
    const RunningMean even = of(mc());
    EXPECT_TRUE(
        accepted(kVarianceRatios, "adaptive sampling", share_p_value(of(adaptive), even, kOfEven)));
    EXPECT_TRUE(rejected(kVarianceRatios, "as many samples in every pixel",
                         share_p_value(even, even, kOfEven)));
}

}  // namespace
}  // namespace burnish
