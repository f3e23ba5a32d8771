#include "cli/reproduce_report.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cli/chart.h"
#include "cli/console.h"
#include "cli/pictures.h"
#include "cli/report_figures.h"
#include "core/version.h"
#include "experiments/interval.h"

namespace burnish {

namespace {

constexpr const char* kSeriesStyles[] = {"first", "second", "third", "fourth", "fifth"};

std::string table_html(const Table& table) {
    std::string html = "<div class=\"card wide\"><table class=\"grid\"><thead><tr>";
    for (const std::string& cell : table.head) html += "<td>" + escape_html(cell) + "</td>";
    html += "</tr></thead>\n";
    for (const auto& row : table.rows) {
        html += "<tr>";
        for (const std::string& cell : row) html += "<td>" + escape_html(cell) + "</td>";
        html += "</tr>\n";
    }
    return html + "</table></div>\n";
}

std::string plot_html(const Plot& plot) {
    Chart chart{plot.log_x ? plot.x_label + " (logarithmic)" : plot.x_label, plot.y_label, {}};
    for (std::size_t k = 0; k < plot.curves.size(); ++k) {
        const Curve& curve = plot.curves[k];
        if (curve.points.empty()) continue;
        ChartSeries series{curve.name, kSeriesStyles[k % std::size(kSeriesStyles)], {}, {}};
        for (const CurvePoint& p : curve.points)
            series.points.push_back({plot.log_x ? std::log2(p.x) : p.x, p.y});
        series.marks = series.points;
        chart.series.push_back(std::move(series));
    }
    chart.whole_x = plot.log_x;  // ticks at powers of two
    if (plot.log_x) chart.x_tick_text = [](double x) { return fmt::format("{:g}", std::exp2(x)); };
    return "<div class=\"card wide\">" + chart_svg(chart) + "</div>\n";
}

std::string picture_html(const Picture& picture, float scale) {
    Image shown = shrink(picture.image, kPictureSide);
    bool srgb = true;
    if (picture.kind == PictureKind::kRadiance)
        shown = brightened(shown, scale);
    else if (picture.kind == PictureKind::kDerivative)
        shown = signed_color(shown, picture.white), srgb = false;
    else
        srgb = picture.kind == PictureKind::kColor;
    return figure(picture.name, picture.caption, shown, srgb);
}

std::string row_html(const std::vector<Picture>& row) {
    float scale = 1;
    for (const Picture& p : row)
        if (p.kind == PictureKind::kRadiance) scale = display_scale(p.image);  // the last: target
    std::string html =
        row.size() == 4 ? "<div class=\"pictures four\">\n" : "<div class=\"pictures\">\n";
    for (const Picture& p : row) html += picture_html(p, scale);
    html += "</div>\n";
    if (!row.empty() && row.front().kind == PictureKind::kDerivative)
        html +=
            "<p class=\"note\">Red: the loss grows with the texel; blue: it falls; all at one "
            "scale.</p>\n";
    return html;
}

std::string figure_html(const Figure& f) {
    std::string html = fmt::format("<h3 class=\"figure\">{}</h3>\n", escape_html(f.title));
    html += fmt::format(
        "<div class=\"card verdict {0}\"><b>{1}</b><dl><dt>The paper</dt><dd>{2}</dd>"
        "<dt>Here</dt><dd>{3}</dd>{4}</dl></div>\n",
        f.verdict == Verdict::kHolds   ? "good"
        : f.verdict == Verdict::kShown ? "plain"
                                       : "other",
        name_of(f.verdict), escape_html(f.claim), escape_html(f.measured),
        f.why.empty() ? "" : "<dt>Why</dt><dd>" + escape_html(f.why) + "</dd>");
    if (!f.plots.empty()) {
        html += "<div class=\"charts\">\n";
        for (const Plot& p : f.plots) html += plot_html(p);
        html += "</div>\n";
    }
    for (const Table& t : f.tables) html += table_html(t);
    for (const auto& row : f.pictures) html += row_html(row);
    return html;
}

/// All verdicts at a glance.
Table overview(const Reproduction& run) {
    Table table{{"experiment", "figure", "the paper's claim", "here"}, {}};
    for (const ExperimentResult& e : run.experiments)
        for (const Figure& f : e.figures)
            table.rows.push_back({e.name, f.title, f.claim, name_of(f.verdict)});
    return table;
}

constexpr const char* kStyle = R"CSS(
.card.wide { margin-top: 16px; } .charts .card.wide { margin-top: 0; }
table.grid td:first-child { white-space: nowrap; } table.grid thead td { color: var(--soft); font-weight: 400; }
h3.figure { font-size: 16px; margin: 30px 0 10px; }
.verdict { margin-bottom: 16px; } .verdict b { font-size: 15px; }
.verdict.good b { color: #2e8b57; } .verdict.other b { color: var(--accent); }
.verdict dl { display: grid; grid-template-columns: 84px 1fr; gap: 4px 12px; margin: 8px 0 0; }
.verdict dt { color: var(--soft); } .verdict dd { margin: 0; }
.pictures { margin-top: 16px; }
.chart .line.third { stroke: #7a9a3c; } .chart .mark.third { fill: #7a9a3c; }
.chart .line.fourth { stroke: #8d6bb8; } .chart .mark.fourth { fill: #8d6bb8; }
.chart .line.fifth { stroke: #d0407a; } .chart .mark.fifth { fill: #d0407a; }
)CSS";

}  // namespace

std::vector<std::pair<std::string, std::string>> settings_text(const ReproduceOptions& r,
                                                               double time_scale,
                                                               const Machine& machine,
                                                               const std::string& scenes) {
    return {
        {"image", fmt::format("{} x {}", r.width, r.height)},
        {"texture", r.texture_side > 0 ? fmt::format("at most {} texels a side", r.texture_side)
                                       : "as in the scene"},
        {"scenes", scenes.empty() ? "none" : scenes},
        {"samples per pixel of an iteration's image",
         r.image_window == 0
             ? fmt::format("{}, fresh", r.image_samples)
             : fmt::format("{} fresh ones, and those of the last {} passes, shaded again",
                           r.image_samples, 2 * r.image_window)},
        {"samples per pixel of the target", fmt::format("{}", r.target_samples)},
        {"samples per pixel of the converged derivative", fmt::format("{}", r.reference_samples)},
        {"samples per pixel that evaluate a run", fmt::format("{}", r.evaluation_samples)},
        {"iterations before a derivative is evaluated", fmt::format("{}", r.iterations)},
        {"budget of an optimisation run",
         fmt::format("{}, {:g} s of derivatives and {:g} s{}",
                     count_text(static_cast<std::size_t>(r.budget.iterations), "iteration"),
                     r.budget.derivative_seconds, r.budget.seconds,
                     has_long(r.budget)
                         ? fmt::format("; {} iterations of mc and of pgris with replay",
                                       r.budget.long_iterations)
                         : "")},
        {"runs with seeds of their own behind an interval",
         r.runs == 1 ? interval_text(r.runs) : fmt::format("{}", r.runs)},
        {"seconds of a run over Adam's decay rates", fmt::format("{:g}", r.sweep_seconds)},
        {"time scale", fmt::format("{:g}", time_scale)},
        {"seed", fmt::format("{}", r.seed)},
        {"threads", fmt::format("{}", machine.threads)},
        {"processor", machine.processor}};
}

const char* name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::kHolds:
            return "holds";
        case Verdict::kPartly:
            return "holds in part";
        case Verdict::kFails:
            return "does not hold";
        case Verdict::kUndecided:
            return "undecided";
        case Verdict::kShown:
            return "shown";
    }
    return "";
}

std::string reproduction_html(const Reproduction& run) {
    std::string html = fmt::format(
        "<h1><small>Burnish</small>The paper, reproduced</h1><p>Experiments of <i>Parameter-space "
        "ReSTIR for Differentiable and Inverse Rendering</i> on this machine, {}{}</p></header>\n",
        duration_text(run.seconds), run.stopped.empty() ? "" : "; " + escape_html(run.stopped));
    html += "<h2>At a glance</h2>\n" + table_html(overview(run));
    for (const ExperimentResult& e : run.experiments) {
        html += fmt::format("<h2>{} <small>{}, {}</small></h2>\n", escape_html(e.title),
                            escape_html(e.name), duration_text(e.seconds));
        for (const Figure& f : e.figures) html += figure_html(f);
    }
    html += "<h2>Settings</h2>\n" + table("", run.settings);
    return page_html("the paper, reproduced", kStyle, html);
}

std::string reproduction_json(const Reproduction& run) {
    nlohmann::ordered_json json;
    json["burnish"] = version_text();
    json["seconds"] = run.seconds;
    if (!run.stopped.empty()) json["stopped"] = run.stopped;
    for (const auto& [name, value] : run.settings) json["settings"][name] = value;
    json["figures"] = nlohmann::ordered_json::array();
    json["measurements"] = nlohmann::ordered_json::array();
    for (const ExperimentResult& e : run.experiments) {
        for (const Figure& f : e.figures)
            json["figures"].push_back({{"experiment", e.name},
                                       {"title", f.title},
                                       {"claim", f.claim},
                                       {"measured", f.measured},
                                       {"verdict", name_of(f.verdict)},
                                       {"why", f.why}});
        for (const Measurement& m : e.measurements)
            json["measurements"].push_back({{"experiment", m.experiment},
                                            {"scene", m.scene},
                                            {"variant", m.variant},
                                            {"metric", m.metric},
                                            {"value", m.value}});
    }
    return json.dump(2) + "\n";
}

std::string reproduction_csv(const Reproduction& run) {
    const auto quoted = [](const std::string& text) {
        return text.find(',') == std::string::npos ? text : '"' + text + '"';
    };
    std::string csv = "experiment,scene,variant,metric,value\n";
    for (const ExperimentResult& e : run.experiments)
        for (const Measurement& m : e.measurements)
            csv += fmt::format("{},{},{},{},{:.9g}\n", m.experiment, quoted(m.scene),
                               quoted(m.variant), m.metric, m.value);
    return csv;
}

}  // namespace burnish
