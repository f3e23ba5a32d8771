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
void extend_sweep(const Subject& subject, const Study& study, const ReproduceOptions& options,
                  double goal, const Note& note, Sweep& sweep) {
    GradientOptions o = paper_options(subject, options).gradient;
    o.estimator = Estimator::kMc;
    while (sweep.nmse.empty() || sweep.nmse.back() > goal) {
        o.samples_per_pixel = sweep.samples.empty() ? 1 : 2 * sweep.samples.back();
        if (o.samples_per_pixel > options.max_samples) return;
        note(fmt::format("{}: mc with {} spp", subject.source.name, o.samples_per_pixel));
        sweep.samples.push_back(o.samples_per_pixel);
        sweep.estimates.push_back(estimate_along(*subject.traced, study.trajectory, o));
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

}  // namespace

ExperimentResult run_equal_error(Subjects subjects, const ReproduceOptions& options,
                                 const Note& note) {
    ExperimentResult result{"equal-error", "", {}, {}, 0};
    for (const auto& subject : subjects) {
        const std::string& name = subject->source.name;
        const Study& study = study_of(*subject, options, note);
        GradientOptions o = paper_options(*subject, options).gradient;
        Figure f;
        f.title = title_of(*subject);
        f.claim = "Reuse is worth many samples per pixel: fewer are needed for the same error.";
        Plot plot{"samples per pixel of mc", "NMSE", {}, true};
        Table table{
            {"estimator", "NMSE", "derivative, s", "mc: samples per pixel", "mc: s", "time saved"},
            {}};
        Sweep sweep;
        double best = 0;
        for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
            o.shift = shift;
            note(name + ": pgris, " + name_of(shift));
            const auto estimate = estimate_along(*subject->traced, study.trajectory, o, note.share);
            const double goal = derivative_error(estimate.gradient, study.reference.gradient).nmse;
            extend_sweep(*subject, study, options, goal, note, sweep);
            const auto at = crossing_of(sweep, goal);
            const std::string variant = std::string("pgris, ") + name_of(shift);
            // Where the sweep ends above the goal, its last time is a lower bound.
            const double seconds = at ? at->seconds : sweep.estimates.back().seconds;
            const double ratio = seconds / estimate.seconds;
            best = std::max(best, ratio);
            const char* at_least = at ? "" : "more than ";
            table.rows.push_back({variant, fmt::format("{:.3g}", goal),
                                  fmt::format("{:.4f}", estimate.seconds),
                                  at ? fmt::format("{:.2f}", at->samples)
                                     : fmt::format("more than {}", options.max_samples),
                                  fmt::format("{}{:.4f}", at_least, seconds),
                                  fmt::format("{}{:.2f} times", at_least, ratio)});
            plot.curves.push_back(
                {variant, {{1, goal}, {static_cast<double>(sweep.samples.back()), goal}}});
            const auto add = [&](const char* metric, double value) {
                result.measurements.push_back({result.name, name, variant, metric, value});
            };
            add("nmse", goal), add("derivative_seconds", estimate.seconds);
            if (at) {
                add("mc_samples_per_pixel", at->samples), add("mc_seconds", at->seconds);
                add("mc_iteration_seconds", at->seconds + study.trajectory.image_seconds);
                add("iteration_seconds", estimate.seconds + study.trajectory.image_seconds);
            }
        }
        Curve curve{"mc", {}};
        for (std::size_t k = 0; k < sweep.nmse.size(); ++k)
            curve.points.push_back({static_cast<double>(sweep.samples[k]), sweep.nmse[k]});
        plot.curves.insert(plot.curves.begin(), curve);
        f.measured = fmt::format(
            "For the error of pgris with replay mc needs {} samples per pixel, with the identity "
            "shift {}; the whole iteration adds the image, {:.3f} s, to both.",
            table.rows[0][3], table.rows[1][3], study.trajectory.image_seconds);
        f.verdict = best > 1 ? Verdict::kHolds : Verdict::kFails;
        if (best <= 1)
            f.why =
                "More samples are needed, but on a CPU they cost less than shifting the history.";
        f.tables.push_back(table);
        f.plots.push_back(plot);
        result.figures.push_back(std::move(f));
    }
    return result;
}

}  // namespace burnish
