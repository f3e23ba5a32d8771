#include <fmt/format.h>

#include <algorithm>

#include "experiments/parameterizations.h"

namespace burnish {

namespace {

constexpr const char* kPool = "pool, its image included";
constexpr const char* kPixels = "pixels";

struct Row {
    std::string group, name;
    DerivativeEstimate estimate;
    DerivativeError error;
};

GradientOptions with(GradientOptions o, Estimator e) {
    o.estimator = e;
    return o;
}

Row row_of(const std::string& group, const std::string& name, DerivativeEstimate estimate,
           const DerivativeReference& reference) {
    const DerivativeError error = derivative_error(estimate.gradient, reference.gradient);
    return {group, name, std::move(estimate), error};
}

/// The variants of one subject: each differs from the paper's settings in one thing.
std::vector<Row> run_variants(const Subject& subject, const Study& study,
                              const ReproduceOptions& options, const Note& note) {
    const GradientOptions paper = paper_options(subject, options).gradient;
    std::vector<Row> rows;
    const auto run = [&](const std::string& group, const std::string& name,
                         const GradientOptions& o) {
        note(subject.source.name + ": " + name);
        rows.push_back(row_of(group, name,
                              estimate_along(*subject.traced, study.trajectory, o, note.share),
                              study.reference));
    };
    run("estimator", "mc: no resampling, no reuse", with(paper, Estimator::kMc));
    run("estimator", "ris: |q|, no reuse", with(paper, Estimator::kRis));
    run("estimator", "pris: positivized, no reuse", with(paper, Estimator::kPris));
    run("estimator", "gris: |q|, reuse", with(paper, Estimator::kGris));
    run("estimator", "pgris: positivized, reuse", paper);
    GradientOptions o = paper;
    o.shift = Shift::kIdentity;
    run("shift", "identity shift", o);
    o = paper;
    o.target = Target::kIntegrand;
    run("target", "target: the integrand", o);
    o = paper;
    o.merge = MergeRule::kDefensive;
    run("weights", "defensive weights", o);
    for (const Estimator e : {Estimator::kMc, Estimator::kPgris}) {
        o = with(paper, e);
        o.pixels = PixelChoice::kAdaptive;
        run(kPixels, fmt::format("{}, pixels by their part", name_of(e)), o);
    }
    for (const float cap : {1.0f, 4.0f, 8.0f, 16.0f, 32.0f, 64.0f}) {
        o = paper;
        o.confidence_cap = cap;
        run("M_cap", fmt::format("M_cap {:g}", cap), o);
        o.merge = MergeRule::kDefensive;
        run("M_cap, defensive", fmt::format("M_cap {:g}, defensive", cap), o);
        if (cap > static_cast<float>(options.iterations)) break;  // no larger one is reached
    }
    return rows;
}

/// Pools, which go beyond the paper: the default one first, then what differs from it in one thing.
/// Where there is one light, there is no choice of lights.
std::vector<Row> run_pools(const Subject& subject, const Study& study,
                           const ReproduceOptions& options, const Note& note) {
    std::vector<Row> rows;
    const auto run = [&](const std::string& name, const TracedScene& scene, Sequence sequence) {
        note(subject.source.name + ": " + name);
        PoolOptions pool;
        pool.sequence = sequence;
        rows.push_back(
            row_of(kPool, name,
                   estimate_pool_along(scene, study.trajectory, pool, options.seed + 1, note.share),
                   study.reference));
    };
    run("pool: Sobol numbers, lights uniformly", *subject.traced, Sequence::kSobol);
    run("pool: independent numbers", *subject.traced, Sequence::kIndependent);
    const Scene& scene = subject.loaded.scene;
    if (scene.emitters.size() < 2) return rows;
    run("pool: lights by power", prepare(scene, LightSelection::kPower), Sequence::kSobol);
    run("pool: lights by a tree", prepare(scene, LightSelection::kTree), Sequence::kSobol);
    return rows;
}

/// pgris against mc where the textures move slower and faster.
std::vector<Row> run_rates(const Subject& subject, const ReproduceOptions& options,
                           const Note& note) {
    std::vector<Row> rows;
    for (const float factor : {0.2f, 5.0f}) {
        SolveOptions solve = paper_options(subject, options);
        solve.optimizer.learning_rate *= factor;
        note(fmt::format("{}: learning rate {:g}", subject.source.name,
                         solve.optimizer.learning_rate));
        const Trajectory trajectory = record_trajectory(subject, options, solve, note.share);
        const auto reference = converged_derivative(subject, trajectory, options.reference_samples,
                                                    options.seed, note.share);
        for (const MergeRule merge : {MergeRule::kBalance, MergeRule::kDefensive}) {
            GradientOptions o = solve.gradient;
            o.merge = merge;
            rows.push_back(
                row_of("learning rate",
                       fmt::format("learning rate {:g}, {}", solve.optimizer.learning_rate,
                                   merge == MergeRule::kBalance ? "pgris" : "pgris, defensive"),
                       estimate_along(*subject.traced, trajectory, o), reference));
        }
        rows.push_back(row_of(
            "learning rate", fmt::format("learning rate {:g}, mc", solve.optimizer.learning_rate),
            estimate_along(*subject.traced, trajectory, with(solve.gradient, Estimator::kMc)),
            reference));
    }
    return rows;
}

Table table_of(const std::vector<Row>& rows) {
    Table table{
        {"what", "variant", "paper's error", "NMSE", "median relative error", "derivative, s"}, {}};
    for (const Row& r : rows)
        table.rows.push_back({r.group, r.name, fmt::format("{:.3g}", r.error.paper),
                              fmt::format("{:.3g}", r.error.nmse),
                              fmt::format("{:.3g}", r.error.median_relative),
                              fmt::format("{:.4f}", r.estimate.seconds)});
    return table;
}

Plot cap_plot(const std::vector<Row>& rows) {
    Plot plot{"M_cap", "NMSE", {{"balance weights", {}}, {"defensive weights", {}}}, true};
    double cap[2] = {1, 1};
    for (const Row& r : rows)
        for (const std::size_t k : {0u, 1u})
            if (r.group == (k == 0 ? "M_cap" : "M_cap, defensive")) {
                plot.curves[k].points.push_back({cap[k], r.error.nmse});
                cap[k] *= cap[k] == 1 ? 4 : 2;
            }
    return plot;
}

/// The rows of run_pools in words: errors and seconds, relative to the first's.
std::string pools_text(const std::vector<Row>& rows) {
    const auto is_pool = [](const Row& r) { return r.group == kPool; };
    const auto first = std::find_if(rows.begin(), rows.end(), is_pool);
    std::string text = fmt::format("{} {:.3g}", first->name, first->error.nmse);
    for (auto r = first + 1; r != rows.end() && is_pool(*r); ++r)
        text += fmt::format(", {} {:.2f} times that in {:.2f} times the seconds", r->name,
                            r->error.nmse / first->error.nmse,
                            r->estimate.seconds / first->estimate.seconds);
    return text;
}

/// What the choice of pixels does to mc and pgris, the rows of the group kPixels.
std::string pixels_text(const std::vector<Row>& rows) {
    const auto first =
        std::find_if(rows.begin(), rows.end(), [](const Row& r) { return r.group == kPixels; });
    const auto text = [](const char* name, const Row& adaptive, const Row& uniform) {
        return fmt::format("{} {:.2f} times the NMSE in {:.2f} times the seconds", name,
                           adaptive.error.nmse / uniform.error.nmse,
                           adaptive.estimate.seconds / uniform.estimate.seconds);
    };
    return fmt::format("With samples where pixels matter most, {}, {}.",
                       text("mc", first[0], rows[0]), text("pgris", first[1], rows[4]));
}

/// What is left of the loss at the start, without the noise of judging; not less than nothing.
double left_of(const ParameterizationStudy& s, const ParameterizationEnd& end) {
    return std::max(0.0, end.loss - s.truth_loss) / (s.loss - s.truth_loss);
}

Table table_of(const ParameterizationStudy& s) {
    Table table{{"parameterization, by pools", "iterations", "loss", "left", "texture error"}, {}};
    table.rows.push_back({"start", "0", fmt::format("{:.4g}", s.loss), "100 %",
                          fmt::format("{:.4g}", s.texture_error)});
    for (const ParameterizationEnd& end : s.ends)
        table.rows.push_back({end.name, std::to_string(end.iterations),
                              fmt::format("{:.4g}", end.loss),
                              fmt::format("{:.2g} %", 100 * left_of(s, end)),
                              fmt::format("{:.4g}", end.texture_error)});
    return table;
}

std::string text_of(const ParameterizationStudy& s, double seconds) {
    std::string text = fmt::format("After {:g} s of a pool's descent", seconds);
    for (const ParameterizationEnd& end : s.ends)
        text += fmt::format("{} {} leaves {:.2g} % of the loss (texture error {:.3f})",
                            &end == &s.ends.front() ? "" : ",", end.name, 100 * left_of(s, end),
                            end.texture_error);
    return text + fmt::format("; the texture error at the start was {:.3f}.", s.texture_error);
}

void measure(ExperimentResult& result, const std::string& scene, const ParameterizationStudy& s) {
    for (const ParameterizationEnd& end : s.ends) {
        const std::string variant = fmt::format("parameterization: {}", end.name);
        result.measurements.push_back({result.name, scene, variant, "loss", end.loss});
        result.measurements.push_back({result.name, scene, variant, "loss_left", left_of(s, end)});
        result.measurements.push_back(
            {result.name, scene, variant, "texture_error", end.texture_error});
        result.measurements.push_back(
            {result.name, scene, variant, "iterations", double(end.iterations)});
    }
}

Figure figure_of(const Subject& subject, const std::vector<Row>& rows) {
    const auto nmse = [&](std::size_t i) { return rows[i].error.nmse; };
    Figure f;
    f.title = title_of(subject);
    f.claim =
        "Without positivization, with |q| as the target, the variance of the gradient is higher; "
        "reuse lowers it further.";
    f.measured = fmt::format(
        "NMSE: mc {:.3g}, ris {:.3g}, pris {:.3g}, gris {:.3g}, pgris {:.3g}. Reuse divides the "
        "error of pris by {:.2f}, positivization that of gris by {:.2f}.",
        nmse(0), nmse(1), nmse(2), nmse(3), nmse(4), nmse(2) / nmse(4), nmse(3) / nmse(4));
    const bool reuse = nmse(4) < nmse(2), positive = nmse(4) < nmse(3);
    f.verdict = reuse && positive   ? Verdict::kHolds
                : reuse || positive ? Verdict::kPartly
                                    : Verdict::kFails;
    if (!positive)
        f.why =
            "A second reservoir pays where the samples of a texel differ in sign; where they "
            "hardly do, one with |q| does as well.";
    if (!reuse)
        f.why +=
            " The textures move so much between iterations that the history says little about "
            "the present.";
    f.measured += " Beyond the paper: " + pools_text(rows) + ". " + pixels_text(rows);
    f.tables.push_back(table_of(rows));
    f.plots.push_back(cap_plot(rows));
    return f;
}

}  // namespace

ExperimentResult run_ablation(Subjects subjects, const ReproduceOptions& options,
                              const Note& note) {
    ExperimentResult result{"ablation", "", {}, {}, 0};
    for (const auto& subject : subjects) {
        const Study& study = study_of(*subject, options, note);
        std::vector<Row> rows = run_variants(*subject, study, options, note);
        for (Row& r : run_pools(*subject, study, options, note)) rows.push_back(std::move(r));
        for (Row& r : run_rates(*subject, options, note)) rows.push_back(std::move(r));
        for (const Row& r : rows)
            measure(result, subject->source.name, r.name, r.estimate, r.error);
        const ParameterizationStudy shared = study_parameterizations(*subject, options, note);
        measure(result, subject->source.name, shared);
        Figure figure = figure_of(*subject, rows);
        figure.measured += fmt::format(" {}", text_of(shared, options.sweep_seconds));
        figure.tables.push_back(table_of(shared));
        result.figures.push_back(std::move(figure));
    }
    return result;
}

}  // namespace burnish
