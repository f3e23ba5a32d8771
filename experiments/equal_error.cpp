#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "experiments/experiments.h"

namespace burnish {

namespace {

struct Sweep {
    std::vector<std::uint32_t> samples;
    std::vector<DerivativeEstimate> estimates;
    std::vector<double> nmse;
};

/// Continues the baseline's 1, 2, 4, ... samples per pixel until its error is below the goal.
void extend_sweep(const TargetScene& scene, const Study& study, const ReproduceOptions& options,
                  double goal, const WorkNote& note, Sweep& sweep) {
    while (sweep.nmse.empty() || sweep.nmse.back() > goal) {
        const std::uint32_t samples = sweep.samples.empty() ? 1 : 2 * sweep.samples.back();
        if (samples > options.max_samples) return;
        note(fmt::format("{}: mc with {} spp", scene.source.name, samples));
        sweep.samples.push_back(samples);
        sweep.estimates.push_back(estimate_along(
            scene.traced(), study.trajectory, baseline_estimator(samples), estimate_seed(options)));
        sweep.nmse.push_back(
            derivative_error(sweep.estimates.back().gradient, study.reference.gradient).nmse);
    }
}

/// Where the sweep first crosses the goal, on logarithmic axes: samples and seconds.
struct Crossing {
    double samples = 1, seconds = 0;
};
std::optional<Crossing> crossing_of(const Sweep& s, double goal) {
    const auto first =
        std::find_if(s.nmse.begin(), s.nmse.end(), [&](double error) { return error <= goal; });
    if (first == s.nmse.end()) return {};
    const auto at = static_cast<std::size_t>(first - s.nmse.begin());
    if (at == 0) return Crossing{1, s.estimates[0].seconds};
    const double t = std::log(s.nmse[at - 1] / goal) / std::log(s.nmse[at - 1] / s.nmse[at]);
    const double a = s.estimates[at - 1].seconds, b = s.estimates[at].seconds;
    return Crossing{s.samples[at - 1] * std::pow(2.0, t), a + t * (b - a)};
}

/// A row of the table: pgris with a shift, beside what mc needs for its error.
struct EqualError {
    Shift shift;
    double nmse = 0, seconds = 0;
    std::optional<Crossing> mc;  ///< empty: more samples than the sweep has
    double mc_seconds = 0;       ///< where mc is empty, those of the sweep's end: a lower bound

    double ratio() const { return mc_seconds / seconds; }
};

std::string variant_of(Shift shift) {
    return shift == Shift::kReplay ? "pgris, replay" : "pgris, identity";
}

EqualError compare(const TargetScene& scene, const Study& study, const ReproduceOptions& options,
                   Shift shift, const WorkNote& note, Sweep& sweep) {
    note(scene.source.name + ": " + variant_of(shift));
    Reservoirs pgris = paper_estimator(scene, options);
    pgris.shift = shift;
    const DerivativeEstimate estimate =
        estimate_along(scene.traced(), study.trajectory, pgris, estimate_seed(options), note.share);
    EqualError row{shift, 0, estimate.seconds, {}};
    row.nmse = derivative_error(estimate.gradient, study.reference.gradient).nmse;
    extend_sweep(scene, study, options, row.nmse, note, sweep);
    row.mc = crossing_of(sweep, row.nmse);
    row.mc_seconds = row.mc ? row.mc->seconds : sweep.estimates.back().seconds;
    return row;
}

void measure_row(const TargetScene& scene, const EqualError& row, double image_seconds,
                 ExperimentResult& result) {
    const auto add = [&](const char* metric, double value) {
        result.measurements.push_back(
            {result.name, scene.source.name, variant_of(row.shift), metric, value});
    };
    add("nmse", row.nmse), add("derivative_seconds", row.seconds);
    if (!row.mc) return;
    add("mc_samples_per_pixel", row.mc->samples), add("mc_seconds", row.mc->seconds);
    add("mc_iteration_seconds", row.mc->seconds + image_seconds);
    add("iteration_seconds", row.seconds + image_seconds);
}

std::string samples_text(const EqualError& row, const ReproduceOptions& options) {
    return row.mc ? fmt::format("{:.2f}", row.mc->samples)
                  : fmt::format("more than {}", options.max_samples);
}

Table table_of(const std::vector<EqualError>& rows, const ReproduceOptions& options) {
    Table table{
        {"estimator", "NMSE", "derivative, s", "mc: samples per pixel", "mc: s", "time saved"}, {}};
    for (const EqualError& row : rows) {
        const char* at_least = row.mc ? "" : "more than ";
        table.rows.push_back({variant_of(row.shift), fmt::format("{:.3g}", row.nmse),
                              fmt::format("{:.4f}", row.seconds), samples_text(row, options),
                              fmt::format("{}{:.4f}", at_least, row.mc_seconds),
                              fmt::format("{}{:.2f} times", at_least, row.ratio())});
    }
    return table;
}

Plot plot_of(const std::vector<EqualError>& rows, const Sweep& sweep) {
    Plot plot{"samples per pixel of mc", "NMSE", {{"mc", {}}}, true};
    for (std::size_t k = 0; k < sweep.nmse.size(); ++k)
        plot.curves[0].points.push_back({static_cast<double>(sweep.samples[k]), sweep.nmse[k]});
    for (const EqualError& row : rows)
        plot.curves.push_back(
            {variant_of(row.shift),
             {{1, row.nmse}, {static_cast<double>(sweep.samples.back()), row.nmse}}});
    return plot;
}

Figure figure_of(const TargetScene& scene, const std::vector<EqualError>& rows, const Sweep& sweep,
                 double image_seconds, const ReproduceOptions& options) {
    Figure f;
    f.title = title_of(scene);
    f.claim = "Reuse is worth many samples per pixel: fewer are needed for the same error.";
    f.measured = fmt::format(
        "For the error of pgris with replay mc needs {} samples per pixel, with the identity "
        "shift {}; the whole iteration adds the image, {:.3f} s, to both.",
        samples_text(rows[0], options), samples_text(rows[1], options), image_seconds);
    const bool saves = std::max(rows[0].ratio(), rows[1].ratio()) > 1;
    f.verdict = saves ? Verdict::kHolds : Verdict::kFails;
    if (!saves)
        f.why = "More samples are needed, but on a CPU they cost less than shifting the history.";
    f.tables.push_back(table_of(rows, options));
    f.plots.push_back(plot_of(rows, sweep));
    return f;
}

}  // namespace

ExperimentResult run_equal_error(TargetScenes scenes, const ReproduceOptions& options,
                                 const WorkNote& note) {
    ExperimentResult result{"equal-error", "", {}, {}, 0};
    for (TargetScene& scene : scenes) {
        const Study& study = study_of(scene, options, note);
        const double image_seconds = study.trajectory.image_seconds;
        Sweep sweep;
        std::vector<EqualError> rows;
        for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
            rows.push_back(compare(scene, study, options, shift, note, sweep));
            measure_row(scene, rows.back(), image_seconds, result);
        }
        result.figures.push_back(figure_of(scene, rows, sweep, image_seconds, options));
    }
    return result;
}

}  // namespace burnish
