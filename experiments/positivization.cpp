#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "experiments/experiments.h"
#include "gradient/reservoirs/merge.h"

namespace burnish {

namespace {

/// sin(2 pi x) + 1/4 on [0, 1): integral 1/4, both signs.
double wave(double x) { return std::sin(2 * std::numbers::pi * x) + 0.25; }

/// Counter-based uniforms of one trial.
class Uniforms {
  public:
    Uniforms(std::uint32_t seed, std::uint32_t trial) : key_{seed, Stream::kTest}, trial_(trial) {}
    float next() {
        if (used_ == 4) block_ = uniforms(key_, trial_, 0, count_++), used_ = 0;
        return block_[used_++];
    }

  private:
    RandomKey key_;
    std::uint32_t trial_, count_ = 0;
    std::size_t used_ = 4;
    std::array<float, 4> block_{};
};

struct Spread {
    double sum = 0, squares = 0;
    std::size_t count = 0;
    void add(double x) { sum += x, squares += x * x, ++count; }
    double mean() const { return sum / static_cast<double>(count); }
    double variance() const { return squares / static_cast<double>(count) - mean() * mean(); }
};

/// Reservoirs of `candidates` uniform samples for the integrand `sign` * wave.
ReservoirPair<float> fresh(Uniforms& random, int candidates, double sign, Signs signs) {
    ReservoirPairBuilder<float> builder;
    for (int i = 0; i < candidates; ++i) {
        const float x = random.next();
        const auto q = static_cast<float>(sign * wave(double{x}));
        update(builder.slot[slot_of(signs, q)], x, q, std::fabs(double{q}) / candidates,
               random.next());
    }
    return finish(builder);
}

/// The estimate of the integral of sign * wave.
double estimate_of(const ReservoirPair<float>& pair, double sign) {
    return estimate(
        pair, [&](float x) { return sign * wave(double{x}); }, 0.0);
}

Figure sign_figure(const ReproduceOptions& options, ExperimentResult& result) {
    constexpr std::uint32_t kTrials = 20000;
    Figure f;
    f.title = "An integrand of both signs";
    f.claim =
        "Resampling with |q| keeps a floor of variance however many candidates there are, because "
        "one sample cannot stand for both signs; two reservoirs, one per sign, have none.";
    Plot plot{"candidates M", "variance", {{"ris: |q|", {}}, {"pris: one per sign", {}}}, true};
    Table table{{"M", "variance of ris", "variance of pris", "mean of ris", "mean of pris"}, {}};
    std::array<double, 2> last{}, eighth{};
    for (int m = 1; m <= 256; m *= 2) {
        std::array<Spread, 2> spread;
        for (std::uint32_t t = 0; t < kTrials; ++t)
            for (const std::size_t k : {0u, 1u}) {
                Uniforms random(options.seed + 100 + static_cast<std::uint32_t>(k), t);
                const Signs signs = k == 0 ? Signs::kAbsolute : Signs::kPositivized;
                spread[k].add(estimate_of(fresh(random, m, 1, signs), 1));
            }
        for (const std::size_t k : {0u, 1u}) {
            plot.curves[k].points.push_back({static_cast<double>(m), spread[k].variance()});
            result.measurements.push_back({result.name, "one dimension",
                                           fmt::format("{}, M {}", k == 0 ? "ris" : "pris", m),
                                           "variance", spread[k].variance()});
            if (m == 32) eighth[k] = spread[k].variance();
            last[k] = spread[k].variance();
        }
        table.rows.push_back({std::to_string(m), fmt::format("{:.4g}", spread[0].variance()),
                              fmt::format("{:.4g}", spread[1].variance()),
                              fmt::format("{:.4f}", spread[0].mean()),
                              fmt::format("{:.4f}", spread[1].mean())});
    }
    f.measured = fmt::format(
        "From 32 to 256 candidates the variance of ris goes from {:.3g} to {:.3g}, that of pris "
        "from {:.3g} to {:.3g}. The integral is 0.25.",
        eighth[0], last[0], eighth[1], last[1]);
    f.verdict =
        last[0] > 0.8 * eighth[0] && last[1] < 0.5 * eighth[1] ? Verdict::kHolds : Verdict::kFails;
    f.tables.push_back(table);
    f.plots.push_back(plot);
    return f;
}

/// What is done with a history whose sign flips in each iteration.
enum class FlipRule { kNone, kAbsolute, kDrop, kBoth };
constexpr std::array<const char*, 4> kFlipNames{"pris: no history", "gris: |q|",
                                                "positivized, flipped history dropped",
                                                "pgris: both reservoirs feed both signs"};

/// Sixteen iterations of 4 candidates each; the target changes its sign every time. The estimate of
/// the last, whose sign is +.
double flipping(std::uint32_t seed, std::uint32_t trial, FlipRule rule) {
    constexpr int kIterations = 16, kCandidates = 4;
    Uniforms random(seed, trial);
    const Signs signs = rule == FlipRule::kAbsolute ? Signs::kAbsolute : Signs::kPositivized;
    ReservoirPair<float> kept;
    float confidence = 0;
    double sign = 1;
    for (int v = 0; v < kIterations; ++v) {
        sign = v % 2 ? 1 : -1;
        const auto current = fresh(random, kCandidates, sign, signs);
        std::vector<MergeInput<float>> now, before;
        for (const auto& r : current.slot)
            if (r.W > 0) now.push_back({r.sample, r.q, -r.q, r.W});
        for (const auto& r : kept.slot) {
            if (!(r.W > 0) || rule == FlipRule::kNone || rule == FlipRule::kDrop) continue;
            before.push_back({r.sample, -r.q, r.q, r.W});
        }
        // Dropping every flipped sample drops all of this history, but not its confidence.
        const Confidence c{kCandidates, rule == FlipRule::kNone || v == 0
                                            ? 0.0f
                                            : std::min(confidence, 16.0f * kCandidates)};
        std::array<float, 4> u;
        for (float& x : u) x = random.next();
        kept = merge<float>(now, before, c, signs, BalanceWeights{}, u);
        confidence = c.current + c.history;
    }
    return estimate_of(kept, sign);
}

Figure flip_figure(const ReproduceOptions& options, ExperimentResult& result) {
    constexpr std::uint32_t kTrials = 20000;
    Figure f;
    f.title = "A target that flips between iterations";
    f.claim =
        "A sample of the positive reservoir may be a sample of the negative one in the next "
        "iteration: samples of both must be offered to both, or they are lost.";
    Table table{{"history", "mean (0.25 is right)", "standard error", "variance"}, {}};
    std::array<Spread, 4> spread;
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::uint32_t t = 0; t < kTrials; ++t)
            spread[k].add(flipping(options.seed + 200, t, static_cast<FlipRule>(k)));
        table.rows.push_back({kFlipNames[k], fmt::format("{:.4f}", spread[k].mean()),
                              fmt::format("{:.4f}", std::sqrt(spread[k].variance() / kTrials)),
                              fmt::format("{:.4g}", spread[k].variance())});
        result.measurements.push_back(
            {result.name, "one dimension", kFlipNames[k], "mean", spread[k].mean()});
        result.measurements.push_back(
            {result.name, "one dimension", kFlipNames[k], "variance", spread[k].variance()});
    }
    f.measured = fmt::format(
        "With both feeding both the mean is {:.4f} and the variance {:.1f} times lower than "
        "without a history; dropping what flipped gives {:.4f}.",
        spread[3].mean(), spread[0].variance() / spread[3].variance(), spread[2].mean());
    const double error = std::sqrt(spread[3].variance() / kTrials);
    const bool unbiased = std::fabs(spread[3].mean() - 0.25) < 5 * error;
    f.verdict = unbiased && spread[3].variance() < spread[0].variance() &&
                        std::fabs(spread[2].mean() - 0.25) > 0.02
                    ? Verdict::kHolds
                    : Verdict::kFails;
    f.tables.push_back(table);
    return f;
}

}  // namespace

ExperimentResult run_positivization(TargetScenes, const ReproduceOptions& options,
                                    const WorkNote& note) {
    note("one-dimensional integrands");
    ExperimentResult result{"positivization", "", {}, {}, 0};
    result.figures.push_back(sign_figure(options, result));
    result.figures.push_back(flip_figure(options, result));
    return result;
}

}  // namespace burnish
