#include <fmt/format.h>

#include <array>
#include <cmath>

#include "experiments/decay_rates.h"
#include "experiments/experiments.h"

namespace burnish {

namespace {

constexpr std::array<float, 3> kBeta1{0.8f, 0.9f, 0.95f}, kBeta2{0.99f, 0.999f, 0.9999f};

/// The loss after a run, with fresh samples and without their noise.
double run_sweep(const TargetScene& scene, const Options& run, const ReproduceOptions& options) {
    Solver solver(problem_of(scene), run);
    step_for(solver, options.sweep_seconds);
    return loss_without_noise(solver.evaluate(options.evaluation_samples, 1));
}

/// mc, pgris with the replay shift, pgris with the identity shift.
std::array<Estimator, 3> estimators(const TargetScene& scene, const ReproduceOptions& options) {
    Reservoirs replay = paper_estimator(scene, options), identity = replay;
    identity.shift = Shift::kIdentity;
    return {baseline_estimator(options), replay, identity};
}

constexpr std::array<const char*, 3> kEstimatorNames{"mc", "pgris, replay", "pgris, identity"};

/// Losses over all pairs of decay rates.
struct DecayRuns {
    std::vector<std::array<float, 2>> betas;
    std::array<std::vector<double>, 3> losses;  ///< of each estimator, parallel to `betas`
};

DecayRuns run_pairs(const TargetScene& scene, const ReproduceOptions& options, const WorkNote& note,
                    ExperimentResult& result) {
    DecayRuns runs;
    for (const float beta1 : kBeta1)
        for (const float beta2 : kBeta2) {
            note(fmt::format("{}: runs with beta1 {:g}, beta2 {:g}", scene.source.name, beta1,
                             beta2));
            runs.betas.push_back({beta1, beta2});
            for (std::size_t k = 0; k < 3; ++k) {
                Options run = paper_options(scene, options);
                run.estimator = estimators(scene, options)[k];
                run.seed = options.seed + static_cast<std::uint32_t>(runs.betas.size() - 1);
                run.adam.beta1 = beta1, run.adam.beta2 = beta2;
                runs.losses[k].push_back(run_sweep(scene, run, options));
                result.measurements.push_back(
                    {result.name, scene.source.name,
                     fmt::format("{}, beta1 {:g}, beta2 {:g}", kEstimatorNames[k], beta1, beta2),
                     "loss", runs.losses[k].back()});
            }
        }
    return runs;
}

Table table_of(const DecayRuns& runs) {
    Table table{{"beta1", "beta2", kEstimatorNames[0], kEstimatorNames[1], kEstimatorNames[2]}, {}};
    for (std::size_t i = 0; i < runs.betas.size(); ++i) {
        table.rows.push_back(
            {fmt::format("{:g}", runs.betas[i][0]), fmt::format("{:g}", runs.betas[i][1])});
        for (const auto& losses : runs.losses)
            table.rows.back().push_back(fmt::format("{:.4g}", losses[i]));
    }
    return table;
}

std::string spread_text(double percent) {
    return std::isnan(percent) ? "more than noise can tell" : fmt::format("{:.0f} %", percent);
}

Figure decay_figure(const TargetScene& scene, const ReproduceOptions& options, const WorkNote& note,
                    ExperimentResult& result) {
    const DecayRuns runs = run_pairs(scene, options, note, result);
    const DecayComparison replay = compare_decay(runs.losses[1], runs.losses[0]),
                          identity = compare_decay(runs.losses[2], runs.losses[0]);
    Figure f;
    f.title = scene.source.name + ": decay rates of Adam";
    f.claim =
        "Over beta1 in [0.8, 0.95] and beta2 in [0.99, 0.9999] the method consistently outperforms "
        "the baseline, and the errors differ by less than 10 %.";
    f.measured = fmt::format(
        "After {:g} s each the loss of pgris over that of mc, {}, is {} with replay and {} with "
        "the identity shift; it is below mc in {} of {} pairs with replay and in {} with the "
        "identity shift. The loss varies, the noise of single runs included, by {} with mc, by {} "
        "with pgris and replay, by {} with the identity shift.",
        options.sweep_seconds, interval_text(runs.betas.size()), text_of(replay.ratio),
        text_of(identity.ratio), replay.wins, runs.betas.size(), identity.wins,
        spread_text(spread_percent(runs.losses[0])), spread_text(replay.spread_percent),
        spread_text(identity.spread_percent));
    f.verdict = verdict_of_ways(replay.verdict, identity.verdict);
    if (replay.verdict == Verdict::kPartly)
        f.why =
            "The losses are those of single runs, whose noise is in their range; and the runs are "
            "short, so that the start of the averages still shows.";
    else if (falls_short(f.verdict))
        f.why =
            "The runs are short, so that the start of the averages still shows; and the claim "
            "is about the time of the derivative alone, while here the image counts too.";
    f.tables.push_back(table_of(runs));
    return f;
}

constexpr std::size_t kLags = 8;
constexpr std::uint32_t kFrozen = 32;

/// What frozen textures tell of an estimator: the correlation of its errors over iterations, and
/// the error that is left in Adam's first moment.
struct Correlation {
    std::array<double, kLags + 1> lag{};         ///< [0] is 1
    double nmse = 0;                             ///< of single gradients
    std::array<double, kBeta1.size()> moment{};  ///< NMSE of the average, per beta1
};

/// Sums over texels, and for each lag over the later half of the iterations, where the history is
/// as long as it gets.
struct ErrorSums {
    std::array<double, kLags + 1> products{}, squares{};  ///< e_v e_(v - lag) and e_(v - lag)^2
    std::array<double, kBeta1.size()> moment{};           ///< squared error of the average
};

ErrorSums sum_errors(const TargetScene& scene, const Study& study, const Estimator& estimator,
                     std::uint32_t seed, const Progress& progress) {
    const Theta& theta = study.trajectory.theta.back();
    const auto& reference = study.reference.gradient.values;
    const std::size_t n = reference.size();
    std::array<std::vector<float>, kLags + 1> errors;  // a ring
    std::array<std::vector<float>, kBeta1.size()> moments;
    for (auto& m : moments) m.assign(n, 0.0f);
    ErrorSums sums;
    ScriptedEstimator along(estimator, seed);
    for (std::uint32_t v = 0; v < kFrozen; ++v) {
        const Image gradient =
            estimate_next(scene.traced(), theta, study.trajectory.adjoint.back(), v, along);
        if (progress) progress((v + 1.0) / kFrozen);
        auto& error = errors[v % errors.size()];
        error.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            error[i] = gradient.values[i] - reference[i];
            for (std::size_t k = 0; k < moments.size(); ++k)
                moments[k][i] = kBeta1[k] * moments[k][i] + (1 - kBeta1[k]) * gradient.values[i];
        }
        if (v < kFrozen / 2) continue;
        for (std::size_t lag = 0; lag <= kLags; ++lag) {
            const auto& before = errors[(v - lag) % errors.size()];
            for (std::size_t i = 0; i < n; ++i)
                sums.products[lag] += double{error[i]} * double{before[i]},
                    sums.squares[lag] += double{before[i]} * double{before[i]};
        }
    }
    for (std::size_t k = 0; k < moments.size(); ++k) {
        const double weight = 1 - std::pow(double{kBeta1[k]}, kFrozen);  // Adam's correction
        for (std::size_t i = 0; i < n; ++i)
            sums.moment[k] += std::pow(double{moments[k][i]} / weight - double{reference[i]}, 2);
    }
    return sums;
}

/// An error is the estimate's less the reference's own, which all of them share: each product and
/// each square holds its squared error s.
Correlation correlate(const TargetScene& scene, const Study& study, const Estimator& estimator,
                      std::uint32_t seed, const Progress& progress) {
    constexpr double kCount = kFrozen - kFrozen / 2;
    const ErrorSums sums = sum_errors(scene, study, estimator, seed, progress);
    const double power = dot(study.reference.gradient, study.reference.gradient),
                 s = study.reference.squared_error;
    const auto root = [&](double squares) {
        const double own = squares / kCount - s;
        return own > 0 ? std::sqrt(own) : NAN;
    };
    Correlation c;
    for (std::size_t lag = 0; lag <= kLags; ++lag)
        c.lag[lag] =
            (sums.products[lag] / kCount - s) / (root(sums.products[0]) * root(sums.squares[lag]));
    c.nmse = normalized_error(sums.products[0] / kCount, power, s);
    for (std::size_t k = 0; k < kBeta1.size(); ++k)
        c.moment[k] = normalized_error(sums.moment[k], power, s);
    return c;
}

std::string decimals_text(double value, int decimals) {
    return std::isnan(value) ? nmse_text(value) : fmt::format("{:.{}f}", value, decimals);
}

Figure correlation_figure(const TargetScene& scene, const Study& study,
                          const ReproduceOptions& options, const WorkNote& note,
                          ExperimentResult& result) {
    Figure f;
    f.title = scene.source.name + ": reused gradients are correlated";
    f.claim =
        "Reuse introduces correlation between the gradients of iterations; its effect on the "
        "optimisation is left as future work.";
    Table table{{"estimator", "NMSE of a gradient", "in Adam's mean, beta1 0.8", "beta1 0.9",
                 "beta1 0.95", "correlation of errors, lag 1", "lag 4", "lag 8"},
                {}};
    std::array<Correlation, 3> all;
    for (std::size_t k = 0; k < 3; ++k) {
        note(fmt::format("{}: correlation of {} at frozen textures", scene.source.name,
                         kEstimatorNames[k]));
        const Correlation c = all[k] = correlate(scene, study, estimators(scene, options)[k],
                                                 estimate_seed(options), note.share);
        table.rows.push_back({kEstimatorNames[k], nmse_text(c.nmse), nmse_text(c.moment[0]),
                              nmse_text(c.moment[1]), nmse_text(c.moment[2]),
                              decimals_text(c.lag[1], 3), decimals_text(c.lag[4], 3),
                              decimals_text(c.lag[8], 3)});
        for (std::size_t lag = 0; lag <= kLags; ++lag)
            result.measurements.push_back({result.name, scene.source.name,
                                           fmt::format("{}, lag {}", kEstimatorNames[k], lag),
                                           "error_correlation", c.lag[lag]});
        for (std::size_t b = 0; b < kBeta1.size(); ++b)
            result.measurements.push_back(
                {result.name, scene.source.name,
                 fmt::format("{}, beta1 {:g}", kEstimatorNames[k], kBeta1[b]),
                 "nmse_of_first_moment", c.moment[b]});
    }
    const auto averaged = [](const Correlation& c) {
        return decimals_text(positive_ratio(c.nmse, c.moment[1]), 1);
    };
    const double single = positive_ratio(all[1].nmse, all[0].nmse),
                 left = positive_ratio(all[1].moment[1], all[0].moment[1]);
    f.tables.push_back(table);
    if (std::isnan(single) || std::isnan(left)) {
        f.measured = "The reference is too noisy to tell what averages leave of the errors.";
        return f;
    }
    f.measured = fmt::format(
        "At frozen textures a single gradient of pgris with replay has {} times the error of one "
        "of mc. Averaging over iterations, as Adam with beta1 = 0.9 does, divides the error of mc "
        "by {} and that of pgris by {}: the errors of pgris are correlated ({} from one iteration "
        "to the next), so that much of what reuse wins is what the average would have won. What is "
        "left in Adam's mean is {} times the error with mc.",
        text_of(RatioInterval{single}), averaged(all[0]), averaged(all[1]),
        decimals_text(all[1].lag[1], 2), text_of(RatioInterval{left}));
    return f;
}

}  // namespace

ExperimentResult run_adam(TargetScenes scenes, const ReproduceOptions& options,
                          const WorkNote& note) {
    ExperimentResult result{"adam", "", {}, {}, 0};
    for (TargetScene& scene : scenes) {
        result.figures.push_back(decay_figure(scene, options, note, result));
        const Study& study = study_of(scene, options, note);
        result.figures.push_back(correlation_figure(scene, study, options, note, result));
    }
    return result;
}

}  // namespace burnish
