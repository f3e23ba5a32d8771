#include "experiments/ablation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "experiments/parameterizations.h"

namespace burnish {

namespace {

constexpr const char* kCacheGroup = "path cache, its image included";
constexpr const char* kSampling = "adaptive sampling";

struct Row {
    std::string group, name;
    Estimator estimator;
    EstimateNumbers numbers;
};

/// The order of the first rows.
enum : std::size_t { kMcRow, kRisRow, kPrisRow, kGrisRow, kPgrisRow };
/// Those of which there are several runs.
constexpr std::array<std::size_t, 3> kRowsOfRuns{kPrisRow, kGrisRow, kPgrisRow};

/// Rows of one trajectory of a scene.
struct Rows {
    const TargetScene& scene;
    const Trajectory& trajectory;
    const DerivativeReference& reference;
    const WorkNote& note;
    std::vector<Row> rows = {};
};

/// Adds the row of an estimator; traced: the scene, or the same with other lights chosen.
void run(Rows& to, const TracedScene& traced, const std::string& group, const std::string& name,
         const Estimator& estimator, std::uint32_t seed) {
    const auto make = [&] {
        to.note(to.scene.source.name + ": " + name);
        const DerivativeEstimate estimate =
            estimate_along(traced, to.trajectory, estimator, seed, to.note.share);
        return EstimateNumbers{estimate.seconds, derivative_error(estimate.gradient, to.reference)};
    };
    const std::string whole_name = fmt::format("{}: {}, seed {}", group, name, seed);
    to.rows.push_back(
        {group, name, estimator, to.note.numbers ? to.note.numbers(whole_name, make) : make()});
}

/// The paper's estimator with one thing changed.
template <class Change>
Reservoirs with(Reservoirs paper, const Change& change) {
    change(paper);
    return paper;
}

/// The estimators with less than the paper's, and with other choices of each part.
void run_variants(Rows& rows, const ReproduceOptions& options) {
    const Reservoirs paper = paper_estimator(rows.scene, options);
    const auto add = [&](const std::string& group, const std::string& name, const Estimator& e) {
        run(rows, rows.scene.traced(), group, name, e, estimate_seed(options));
    };
    const auto part = [&](bool positivization, bool reuse) {
        return with(paper,
                    [&](Reservoirs& o) { o.positivization = positivization, o.reuse = reuse; });
    };
    add("estimator", "mc: no resampling, no reuse", baseline_estimator());
    add("estimator", "ris: |q|, no reuse", part(false, false));
    add("estimator", "pris: positivized, no reuse", part(true, false));
    add("estimator", "gris: |q|, reuse", part(false, true));
    add("estimator", "pgris: positivized, reuse", paper);
    add("shift", "identity shift", with(paper, [](auto& o) { o.shift = Shift::kIdentity; }));
    add("target", "target: the integrand",
        with(paper, [](auto& o) { o.target_function = TargetFunction::kIntegrand; }));
    add("weights", "defensive weights",
        with(paper, [](auto& o) { o.merge = MergeRule::kDefensive; }));
    MonteCarlo mc = baseline_estimator();
    mc.adaptive_sampling = true;
    add(kSampling, "mc, adaptive sampling", mc);
    add(kSampling, "pgris, adaptive sampling",
        with(paper, [](auto& o) { o.adaptive_sampling = true; }));
}

/// The error of pgris over that of pris, which does not reuse, and of gris, which is not
/// positivized, run by run.
struct PartRatios {
    std::vector<double> reuse, positivization;
};

std::string name_of_run(const Row& row, std::uint32_t k) {
    return fmt::format("{}, run {}", row.name, k);
}

/// first: the rows, which are the first run; each further one has random numbers of its own.
PartRatios run_again(const Rows& first, const ReproduceOptions& options, ExperimentResult& result) {
    PartRatios ratios;
    const auto add = [&](const Row& pris, const Row& gris, const Row& pgris) {
        ratios.reuse.push_back(positive_ratio(pgris.numbers.error.nmse, pris.numbers.error.nmse));
        ratios.positivization.push_back(
            positive_ratio(pgris.numbers.error.nmse, gris.numbers.error.nmse));
    };
    add(first.rows[kPrisRow], first.rows[kGrisRow], first.rows[kPgrisRow]);
    for (std::uint32_t k = 1; k < options.runs; ++k) {
        Rows again{first.scene, first.trajectory, first.reference, first.note};
        for (const std::size_t i : kRowsOfRuns) {
            const Row& row = first.rows[i];
            run(again, first.scene.traced(), row.group, name_of_run(row, k), row.estimator,
                estimate_seed(options, k));
        }
        add(again.rows[0], again.rows[1], again.rows[2]);
        for (const Row& r : again.rows) measure(result, first.scene.source.name, r.name, r.numbers);
    }
    return ratios;
}

void measure_rows(ExperimentResult& result, const std::string& scene,
                  const std::vector<Row>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool has_runs = std::ranges::find(kRowsOfRuns, i) != kRowsOfRuns.end();
        measure(result, scene, has_runs ? name_of_run(rows[i], 0) : rows[i].name, rows[i].numbers);
    }
}

/// Until a cap that no history reaches.
void run_caps(Rows& rows, const ReproduceOptions& options) {
    Reservoirs o = paper_estimator(rows.scene, options);
    for (const float cap : {1.0f, 4.0f, 8.0f, 16.0f, 32.0f, 64.0f}) {
        o.confidence_cap = cap;
        o.merge = MergeRule::kBalance;
        run(rows, rows.scene.traced(), "M_cap", fmt::format("M_cap {:g}", cap), o,
            estimate_seed(options));
        o.merge = MergeRule::kDefensive;
        run(rows, rows.scene.traced(), "M_cap, defensive",
            fmt::format("M_cap {:g}, defensive", cap), o, estimate_seed(options));
        if (cap > static_cast<float>(options.iterations)) break;
    }
}

/// The path cache, which goes beyond the paper: the default first, then what differs from it in one
/// thing. Where there is one light, there is no choice of lights.
void run_caches(Rows& rows, const ReproduceOptions& options) {
    const auto add = [&](const std::string& name, const TracedScene& traced, Sequence sequence) {
        PathCache cache;
        cache.sequence = sequence;
        run(rows, traced, kCacheGroup, name, cache, estimate_seed(options));
    };
    const TracedScene& traced = rows.scene.traced();
    add("path cache: Sobol numbers, lights uniformly", traced, Sequence::kSobol);
    add("path cache: independent numbers", traced, Sequence::kIndependent);
    const Scene& scene = rows.scene.scene();
    if (scene.emitters.size() < 2) return;
    add("path cache: lights resampled", prepare(scene, LightSelection::kResampled),
        Sequence::kSobol);
    add("path cache: lights by power", prepare(scene, LightSelection::kPower), Sequence::kSobol);
    add("path cache: lights by a tree", prepare(scene, LightSelection::kTree), Sequence::kSobol);
}

/// pgris against mc where the textures move slower and faster.
void run_rate(Rows& rows, double rate, const ReproduceOptions& options) {
    const auto add = [&](const char* name, const Estimator& e) {
        run(rows, rows.scene.traced(), "learning rate",
            fmt::format("learning rate {:g}, {}", rate, name), e, estimate_seed(options));
    };
    const Reservoirs paper = paper_estimator(rows.scene, options);
    add("pgris", paper);
    add("pgris, defensive", with(paper, [](auto& o) { o.merge = MergeRule::kDefensive; }));
    add("mc", baseline_estimator());
}

std::vector<Row> run_rates(const TargetScene& scene, const ReproduceOptions& options,
                           const WorkNote& note) {
    std::vector<Row> all;
    for (const double factor : {0.2, 5.0}) {
        Options paper = paper_options(scene, options);
        paper.learning_rate = factor * double{scene.source.learning_rate};
        const std::string name = fmt::format("learning rate {:g}", *paper.learning_rate);
        note(scene.source.name + ": " + name);
        const Trajectory trajectory =
            record_trajectory(scene, paper, options.iterations, note.share);
        const auto make = [&] {
            return converged_derivative(scene.traced(), trajectory, options.reference_samples,
                                        options.seed, note.share);
        };
        const DerivativeReference reference = note.reference ? note.reference(name, make) : make();
        Rows rows{scene, trajectory, reference, note};
        run_rate(rows, *paper.learning_rate, options);
        std::move(rows.rows.begin(), rows.rows.end(), std::back_inserter(all));
    }
    return all;
}

Table table_of(const std::vector<Row>& rows) {
    Table table{
        {"what", "variant", "paper's error", "NMSE", "median relative error", "derivative, s"}, {}};
    for (const Row& r : rows)
        table.rows.push_back({r.group, r.name, fmt::format("{:.3g}", r.numbers.error.paper),
                              nmse_text(r.numbers.error.nmse),
                              fmt::format("{:.3g}", r.numbers.error.median_relative),
                              fmt::format("{:.4f}", r.numbers.seconds)});
    return table;
}

Plot cap_plot(const std::vector<Row>& rows) {
    Plot plot{"M_cap", "NMSE", {{"balance weights", {}}, {"defensive weights", {}}}, true};
    double cap[2] = {1, 1};
    for (const Row& r : rows)
        for (const std::size_t k : {0u, 1u})
            if (r.group == (k == 0 ? "M_cap" : "M_cap, defensive")) {
                plot.curves[k].points.push_back({cap[k], r.numbers.error.nmse});
                cap[k] *= cap[k] == 1 ? 4 : 2;
            }
    return plot;
}

/// The rows of run_caches in words: errors and seconds, relative to the first's.
std::string caches_text(const std::vector<Row>& rows) {
    const auto is_cache = [](const Row& r) { return r.group == kCacheGroup; };
    const auto first = std::find_if(rows.begin(), rows.end(), is_cache);
    std::string text = fmt::format("{} {}", first->name, nmse_text(first->numbers.error.nmse));
    for (auto r = first + 1; r != rows.end() && is_cache(*r); ++r)
        text += fmt::format(", {} {} in {:.2f} times the seconds", r->name,
                            multiple_text(r->numbers.error.nmse, first->numbers.error.nmse, "that"),
                            r->numbers.seconds / first->numbers.seconds);
    return text;
}

/// What adaptive sampling does to mc and pgris, the rows of the group kSampling.
std::string sampling_text(const std::vector<Row>& rows) {
    const auto first =
        std::find_if(rows.begin(), rows.end(), [](const Row& r) { return r.group == kSampling; });
    const auto text = [](const char* name, const Row& adaptive, const Row& uniform) {
        return fmt::format(
            "{} {} in {:.2f} times the seconds", name,
            multiple_text(adaptive.numbers.error.nmse, uniform.numbers.error.nmse, "the NMSE"),
            adaptive.numbers.seconds / uniform.numbers.seconds);
    };
    return fmt::format("With adaptive sampling, {}, {}.", text("mc", first[0], rows[kMcRow]),
                       text("pgris", first[1], rows[kPgrisRow]));
}

Figure figure_of(const TargetScene& scene, const std::vector<Row>& rows, const PartRatios& runs) {
    const auto nmse = [&](std::size_t i) { return nmse_text(rows[i].numbers.error.nmse); };
    const RatioInterval reuse = ratio_interval(runs.reuse),
                        positivization = ratio_interval(runs.positivization);
    Figure f;
    f.title = title_of(scene);
    f.claim =
        "Without positivization, with |q| as the target, the variance of the gradient is higher; "
        "reuse lowers it further.";
    f.measured = fmt::format(
        "NMSE of the first run: mc {}, ris {}, pris {}, gris {}, pgris {}. The error of "
        "pgris, {}, over that of pris, by reuse: {}; over that of gris, by positivization: {}.",
        nmse(kMcRow), nmse(kRisRow), nmse(kPrisRow), nmse(kGrisRow), nmse(kPgrisRow),
        interval_text(runs.reuse.size()), text_of(reuse), text_of(positivization));
    f.verdict = verdict_of_parts(verdict_below_one(positivization), verdict_below_one(reuse));
    f.why = ablation_reason(positivization, reuse);
    f.measured += " Beyond the paper: " + caches_text(rows) + ". " + sampling_text(rows);
    f.tables.push_back(table_of(rows));
    f.plots.push_back(cap_plot(rows));
    return f;
}

}  // namespace

std::string ablation_reason(const RatioInterval& positivization, const RatioInterval& reuse) {
    std::vector<std::string> reasons;
    if (stands_above_one(positivization)) reasons.emplace_back(kPositivizationReason);
    if (stands_above_one(reuse))
        reasons.emplace_back(
            "The textures move so much between iterations that the history says little about "
            "the present.");
    const Verdict of_reuse = verdict_below_one(reuse);
    if (reasons.empty() &&
        falls_short(verdict_of_parts(verdict_below_one(positivization), of_reuse))) {
        const bool is_reuse = of_reuse == Verdict::kUndecided;
        const char* part = is_reuse ? "reuse" : "positivization";
        reasons.push_back(
            std::isnan((is_reuse ? reuse : positivization).ratio)
                ? fmt::format("The noise of the converged derivative hides what {} does.", part)
                : fmt::format(
                      "The interval of {} holds 1: more runs or larger pictures would decide.",
                      part));
    }
    return fmt::format("{}", fmt::join(reasons, " "));
}

ExperimentResult run_ablation(TargetScenes scenes, const ReproduceOptions& options,
                              const WorkNote& note) {
    ExperimentResult result{"ablation", "", {}, {}, 0};
    for (TargetScene& scene : scenes) {
        const Study& study = study_of(scene, options, note);
        Rows rows{scene, study.trajectory, study.reference, note};
        run_variants(rows, options);
        const PartRatios runs = run_again(rows, options, result);
        run_caps(rows, options);
        run_caches(rows, options);
        for (Row& r : run_rates(scene, options, note)) rows.rows.push_back(std::move(r));
        measure_rows(result, scene.source.name, rows.rows);
        const ParameterizationStudy shared = study_parameterizations(scene, options, note);
        measure(result, scene.source.name, shared);
        Figure figure = figure_of(scene, rows.rows, runs);
        figure.measured += fmt::format(" {}", parameterization_text(shared, options.sweep_seconds));
        figure.tables.push_back(parameterization_table(shared));
        result.figures.push_back(std::move(figure));
    }
    return result;
}

}  // namespace burnish
