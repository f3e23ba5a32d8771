#include "experiments/equal_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/experiments.h"

namespace burnish {

namespace {

/// The baseline's errors with random numbers of one run.
struct Sweep {
    std::vector<std::uint32_t> samples;
    std::vector<DerivativeEstimate> estimates;
    std::vector<double> nmse;
};

/// Continues the baseline's 1, 2, 4, ... samples per pixel until its error is below the goal.
/// Several runs tell how much its seconds vary, so that each is timed for a short while.
void extend_sweep(const TargetScene& scene, const Study& study, const ReproduceOptions& options,
                  std::uint32_t run, double goal, const WorkNote& note, Sweep& sweep) {
    const double enough_seconds = options.runs > 1 ? 0.1 : kEnoughSeconds;
    while (sweep.nmse.empty() || sweep.nmse.back() > goal) {  // false of NaN
        const std::uint32_t samples = sweep.samples.empty() ? 1 : 2 * sweep.samples.back();
        if (samples > options.max_samples) return;
        note(fmt::format("{}: mc with {} spp, run {} of {}", scene.source.name, samples, run + 1,
                         options.runs));
        sweep.samples.push_back(samples);
        sweep.estimates.push_back(
            estimate_along(scene.traced(), study.trajectory, baseline_estimator(samples),
                           estimate_seed(options, run), {}, kMaxAtOnce, enough_seconds));
        sweep.nmse.push_back(
            derivative_error(sweep.estimates.back().gradient, study.reference).nmse);
    }
}

/// On logarithmic axes.
Crossing crossing_of(const Sweep& s, double goal) {
    const auto first =
        std::find_if(s.nmse.begin(), s.nmse.end(), [&](double error) { return !(error > goal); });
    if (first == s.nmse.end())
        return {static_cast<double>(s.samples.back()), s.estimates.back().seconds, true};
    if (std::isnan(goal) || std::isnan(*first)) return {NAN, NAN};
    const auto at = static_cast<std::size_t>(first - s.nmse.begin());
    if (at == 0) return {1, s.estimates[0].seconds};
    const double t = std::log(s.nmse[at - 1] / goal) / std::log(s.nmse[at - 1] / s.nmse[at]);
    const double a = s.estimates[at - 1].seconds, b = s.estimates[at].seconds;
    const double factor = std::pow(2.0, t);  // of the samples; seconds grow in proportion to them
    return {s.samples[at - 1] * factor, a + (factor - 1) * (b - a)};
}

/// A row of the table: all runs of a shift.
struct EqualError {
    Shift shift;
    std::vector<EqualErrorRun> runs = {};
};

/// The geometric mean over the runs, with its interval.
template <class Value>
RatioInterval mean_of(std::span<const EqualErrorRun> runs, Value value) {
    std::vector<double> values;
    for (const EqualErrorRun& run : runs) values.push_back(value(run));
    return ratio_interval(values);
}
RatioInterval samples_of_mc(std::span<const EqualErrorRun> runs) {
    return mean_of(runs, [](const EqualErrorRun& run) { return run.mc.samples; });
}
RatioInterval seconds_of_mc(std::span<const EqualErrorRun> runs) {
    return mean_of(runs, [](const EqualErrorRun& run) { return run.mc.seconds; });
}
/// A mean in words, after `bound` where a run is one.
std::string bounded_text(const EqualError& row, const char* bound, const RatioInterval& mean) {
    const bool is_bound = has_bound(row.runs) && !std::isnan(mean.ratio);
    return (is_bound ? bound : "") + text_of(mean);
}
std::string samples_text(const EqualError& row) {
    return bounded_text(row, "at least ", samples_of_mc(row.runs));
}
std::string seconds_text(const EqualError& row) {
    return bounded_text(row, "at most ", seconds_ratio(row.runs));
}
/// Of mc, without an interval.
std::string seconds_of_mc_text(const EqualError& row) {
    const double mean = seconds_of_mc(row.runs).ratio;
    if (std::isnan(mean)) return text_of({.ratio = mean});
    return fmt::format("{}{:.4f}", has_bound(row.runs) ? "at least " : "", mean);
}

/// What the error of a row's shift takes of mc.
std::string needs_text(const EqualError& row) {
    if (std::isnan(samples_of_mc(row.runs).ratio)) return text_of(samples_of_mc(row.runs));
    return fmt::format("{} samples per pixel, and pgris {} times the seconds of that stage",
                       samples_text(row), seconds_text(row));
}

std::string variant_of(Shift shift) {
    return shift == Shift::kReplay ? "pgris, replay" : "pgris, identity";
}

EqualErrorRun compare(const TargetScene& scene, const Study& study, const ReproduceOptions& options,
                      Shift shift, std::uint32_t run, const WorkNote& note, Sweep& sweep) {
    note(fmt::format("{}: {}, run {} of {}", scene.source.name, variant_of(shift), run + 1,
                     options.runs));
    Reservoirs pgris = paper_estimator(scene, options);
    pgris.shift = shift;
    const DerivativeEstimate estimate = estimate_along(scene.traced(), study.trajectory, pgris,
                                                       estimate_seed(options, run), note.share);
    EqualErrorRun result{
        derivative_error(estimate.gradient, study.reference).nmse, estimate.seconds, {}};
    extend_sweep(scene, study, options, run, result.nmse, note, sweep);
    result.mc = crossing_of(sweep, result.nmse);
    return result;
}

void measure_row(const TargetScene& scene, const EqualError& row, double image_seconds,
                 ExperimentResult& result) {
    std::string variant;
    const auto add = [&](const std::string& metric, double value) {
        result.measurements.push_back({result.name, scene.source.name, variant, metric, value});
    };
    for (std::size_t k = 0; k < row.runs.size(); ++k) {
        const EqualErrorRun& run = row.runs[k];
        variant = fmt::format("{}, run {}", variant_of(row.shift), k);
        add("nmse", run.nmse), add("derivative_seconds", run.seconds);
        add("iteration_seconds", run.seconds + image_seconds);
        const std::string at_least = run.mc.is_bound ? "_at_least" : "";
        add("mc_samples_per_pixel" + at_least, run.mc.samples);
        add("mc_seconds" + at_least, run.mc.seconds);
        add("mc_iteration_seconds" + at_least, run.mc.seconds + image_seconds);
    }
    variant = variant_of(row.shift);
    const RatioInterval ratio = seconds_ratio(row.runs);
    const std::string metric =
        has_bound(row.runs) ? "seconds_over_those_of_mc_at_most" : "seconds_over_those_of_mc";
    add(metric, ratio.ratio), add(metric + "_low", ratio.low), add(metric + "_high", ratio.high);
}

Table table_of(const std::vector<EqualError>& rows) {
    Table table{{"estimator", "NMSE", "derivative, s", "mc: samples per pixel", "mc: s",
                 "seconds over those of mc"},
                {}};
    for (const EqualError& row : rows) {
        const auto mean = [&](auto value) { return mean_of(row.runs, value).ratio; };
        table.rows.push_back(
            {variant_of(row.shift), nmse_text(mean([](const EqualErrorRun& r) { return r.nmse; })),
             fmt::format("{:.4f}", mean([](const EqualErrorRun& r) { return r.seconds; })),
             samples_text(row), seconds_of_mc_text(row), seconds_text(row)});
    }
    return table;
}

/// Of the first run.
Plot plot_of(const std::vector<EqualError>& rows, const Sweep& sweep) {
    Plot plot{"samples per pixel of mc", "NMSE", {{"mc", {}}}, true};
    for (std::size_t k = 0; k < sweep.nmse.size(); ++k)
        plot.curves[0].points.push_back({static_cast<double>(sweep.samples[k]), sweep.nmse[k]});
    for (const EqualError& row : rows) {
        const double nmse = row.runs.front().nmse;
        plot.curves.push_back({variant_of(row.shift),
                               {{1, nmse}, {static_cast<double>(sweep.samples.back()), nmse}}});
    }
    return plot;
}

/// rows: replay, identity.
Figure figure_of(const TargetScene& scene, const std::vector<EqualError>& rows, const Sweep& sweep,
                 double image_seconds) {
    Figure f;
    f.title = title_of(scene);
    f.claim = "Reuse is worth many samples per pixel, so that the same error takes less time.";
    f.measured = fmt::format(
        "What mc needs in its derivative stage for the error of pgris, {}: with replay {}; with "
        "the identity shift {}. The whole iteration adds the image, {:.3g} s, to both.",
        interval_text(rows[0].runs.size()), needs_text(rows[0]), needs_text(rows[1]),
        image_seconds);
    f.verdict = verdict_of_ways(verdict_of(rows[0].runs), verdict_of(rows[1].runs));
    f.why = equal_error_reason(rows[0].runs, f.verdict);
    f.tables.push_back(table_of(rows));
    f.plots.push_back(plot_of(rows, sweep));
    return f;
}

}  // namespace

bool has_bound(std::span<const EqualErrorRun> runs) {
    return std::any_of(runs.begin(), runs.end(),
                       [](const EqualErrorRun& run) { return run.mc.is_bound; });
}

RatioInterval seconds_ratio(std::span<const EqualErrorRun> runs) {
    return mean_of(runs, [](const EqualErrorRun& run) { return run.seconds / run.mc.seconds; });
}

Verdict verdict_of(std::span<const EqualErrorRun> runs) {
    const RatioInterval ratio = seconds_ratio(runs);
    return has_bound(runs) ? bounds_below_one(ratio) : verdict_below_one(ratio);
}

std::string equal_error_reason(std::span<const EqualErrorRun> replay, Verdict of_figure) {
    const RatioInterval ratio = seconds_ratio(replay);
    const bool is_bound = has_bound(replay);
    if (!is_bound && stands_above_one(ratio)) {
        if (samples_of_mc(replay).ratio > 1)
            return fmt::format(
                "mc needs more samples for the error of replay, but on a CPU they cost less than "
                "shifting the history: {:.3g} s in place of {:.3g} s.",
                seconds_of_mc(replay).ratio,
                mean_of(replay, [](const EqualErrorRun& run) { return run.seconds; }).ratio);
        return fmt::format(
            "A single sample per pixel of mc has no higher error than replay, and shifting the "
            "history takes {:.2f} times its seconds.",
            ratio.ratio);
    }
    if (!falls_short(of_figure)) return {};
    if (is_bound && !std::isnan(ratio.ratio))
        return "The error of replay is out of reach for mc here: a bound of its seconds does not "
               "decide.";
    return reason_of_doubt(ratio, "replay", "the converged derivative");
}

ExperimentResult run_equal_error(TargetScenes scenes, const ReproduceOptions& options,
                                 const WorkNote& note) {
    ExperimentResult result{"equal-error", "", {}, {}, 0};
    for (TargetScene& scene : scenes) {
        const Study& study = study_of(scene, options, note);
        const double image_seconds = study.trajectory.image_seconds;
        std::vector<EqualError> rows{{Shift::kReplay}, {Shift::kIdentity}};
        Sweep first;
        for (std::uint32_t k = 0; k < options.runs; ++k) {
            Sweep sweep;
            for (EqualError& row : rows)
                row.runs.push_back(compare(scene, study, options, row.shift, k, note, sweep));
            if (k == 0) first = std::move(sweep);
        }
        for (const EqualError& row : rows) measure_row(scene, row, image_seconds, result);
        result.figures.push_back(figure_of(scene, rows, first, image_seconds));
    }
    return result;
}

}  // namespace burnish
