#include "cli/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/chart.h"
#include "cli/console.h"
#include "cli/pictures.h"
#include "cli/report_style.h"
#include "core/version.h"

namespace burnish {

namespace {

constexpr int kTextureSide = 512;  // texture pictures are shrunk to this: the files hold all texels

std::string tile(const std::string& label, const std::string& number, const std::string& more) {
    return fmt::format("<div class=\"tile\"><span>{}</span><b>{}</b><span>{}</span></div>\n",
                       escape_html(label), escape_html(number), escape_html(more));
}

std::string figure(const std::string& name, const std::string& more, const Image& image,
                   bool srgb) {
    return fmt::format(
        "<figure><img alt=\"{0}\" src=\"{2}\"><figcaption><b>{0}</b>{1}"
        "</figcaption></figure>\n",
        escape_html(name), more.empty() ? "" : " &middot; " + escape_html(more),
        png_data_uri(image, srgb));
}

std::string color_key(float white, const std::string& meaning) {
    return fmt::format(
        "<div class=\"key\"><span>0</span><i style=\"background:linear-gradient("
        "to right, {})\"></i><span>{:.3g}</span><span>{}</span></div>\n",
        false_color_gradient(), white, meaning);
}

std::string loss_text(double loss) { return fmt::format("loss {:.4g}", loss); }
std::string change_text(double from, double to) { return fmt::format("{:.3g} → {:.3g}", from, to); }

/// "12 times lower", or what happened instead.
std::string ratio_text(double from, double to) {
    if (!(to > 0) || !(from > 0)) return "";
    return from >= to ? fmt::format("{:.3g} times lower", from / to)
                      : fmt::format("{:.3g} times higher", to / from);
}

std::string other_text(const RunResult& run, const std::string& number) {
    return fmt::format("{}: {}", name_of(run.compared->estimator), number);
}

/// What an estimator keeps from iteration to iteration.
std::string kept_text(const RunResult& run, Estimator estimator) {
    const SolveOptions& solve = run.options.solve;
    if (estimator == Estimator::kPool)
        return fmt::format("two banks of {} passes, {} fresh ones in an iteration",
                           solve.pool.window, solve.pool.samples_per_pixel);
    if (!has_history(estimator)) return "no history";
    return fmt::format("{} shift, confidence cap {:g}", name_of(solve.gradient.shift),
                       solve.gradient.confidence_cap);
}

std::string tiles(const RunResult& run) {
    const JudgedDescent& r = run.result;
    const JudgedDescent* other = run.compared ? &*run.compared : nullptr;
    std::string html = "<div class=\"tiles\">\n";
    html += tile("Loss of the image", change_text(run.initial.loss, r.evaluation.loss),
                 other ? other_text(run, fmt::format("{:.3g}", other->evaluation.loss))
                       : ratio_text(run.initial.loss, r.evaluation.loss));
    for (std::size_t i = 0; i < r.texture_errors.size(); ++i)
        html += tile("Error of the texture (RMSE)",
                     change_text(run.initial_errors[i], r.texture_errors[i]),
                     other ? other_text(run, fmt::format("{:.3g}", other->texture_errors[i]))
                           : run.subjects[i].name);
    const double n = static_cast<double>(r.descent.rows.size());
    html += tile("Iterations", std::to_string(r.descent.rows.size()),
                 fmt::format("{} in all, {:.3g} s each", duration_text(r.descent.seconds),
                             r.descent.seconds / n));
    html += tile("Estimator", name_of(r.estimator), kept_text(run, r.estimator));
    return html + "</div>\n";
}

std::string image_section(const RunResult& run) {
    const float exposure = exposure_for(run.target);
    const auto shown = [&](const Image& image) { return exposed(image, exposure); };
    const Image before = relative_error(run.initial.image, run.target);
    const Image after = relative_error(run.result.evaluation.image, run.target);
    const float white = std::max(percentile(before, 0.99), 1e-6f);
    std::string html = "<h2>The picture</h2>\n<div class=\"pictures three\">\n";
    html += figure("Start", loss_text(run.initial.loss), shown(run.initial.image), true);
    html += figure("Result", loss_text(run.result.evaluation.loss),
                   shown(run.result.evaluation.image), true);
    html += figure("Target", run.options.target.empty() ? "rendered" : run.options.target,
                   shown(run.target), true);
    html += figure("Difference at the start", "", false_color(before, white), false);
    html += figure("Difference of the result", "", false_color(after, white), false);
    if (run.compared)
        html += figure(
            fmt::format("Difference with {}", name_of(run.compared->estimator)),
            loss_text(run.compared->evaluation.loss),
            false_color(relative_error(run.compared->evaluation.image, run.target), white), false);
    return html + "</div>\n" + color_key(white, "relative difference to the target");
}

std::string texture_section(const RunResult& run, std::size_t i) {
    const TextureSubject& s = run.subjects[i];
    const Image& after = run.result.descent.theta.textures[i].values;
    const auto show = [&](const std::string& name, const std::string& more, const Image& texels) {
        return figure(name, more, shrink(texels, kTextureSide), !s.raw);
    };
    const auto error = [&](double e) { return fmt::format("error {:.4f}", e); };
    std::string html = fmt::format("<h2>{}<small>{} × {} texels, {}</small></h2>\n",
                                   escape_html(s.name), s.initial.width, s.initial.height,
                                   s.initial.channels == 1 ? "one channel" : "RGB");
    if (!s.truth)
        return html + "<div class=\"pictures three\">\n" + show("Start", "", s.initial) +
               show("Result", "", after) + "</div>\n";
    Image difference = absolute_error(after, *s.truth);
    for (std::size_t t = 0; t < s.reached.size(); ++t)
        if (!s.reached[t]) difference.values[t] = 0;
    const float white = std::max(percentile(absolute_error(s.initial, *s.truth), 0.99), 1e-3f);
    html += "<div class=\"pictures four\">\n";
    html += show("Truth", "", *s.truth);
    html += show("Result", error(run.result.texture_errors[i]), after);
    if (run.compared)
        html += show(fmt::format("Result of {}", name_of(run.compared->estimator)),
                     error(run.compared->texture_errors[i]),
                     run.compared->descent.theta.textures[i].values);
    else
        html += show("Start", error(run.initial_errors[i]), s.initial);
    html += figure("Difference", "result and truth",
                   false_color(shrink(difference, kTextureSide), white), false);
    return html + "</div>\n" + color_key(white, "difference, where light reaches the texture");
}

/// Where the picture says something about the texture, and how surely.
std::string evidence_section(const RunResult& run, std::size_t i) {
    std::string html = "<div style=\"height:18px\"></div><div class=\"pictures four\">\n";
    for (const auto& [name, map] : evidence_maps(run.result.descent, i))
        html += name == "coverage" ? figure("Coverage", "iterations with samples",
                                            false_color(shrink(map, kTextureSide), 1), false)
                                   : figure("Confidence", "agreement of the two banks",
                                            false_color(shrink(map, kTextureSide), 1), false);
    return html + "</div>\n" +
           color_key(1, "share of the iterations, and of the gradient's square");
}

ChartSeries loss_series(const RunResult& run, const JudgedDescent& judged, const char* style,
                        bool over_seconds) {
    ChartSeries series{name_of(judged.estimator), style, {}, {}};
    for (const HistoryRow& r : judged.descent.rows)
        series.points.push_back(
            {over_seconds ? r.seconds : static_cast<double>(r.iteration), r.loss});
    const double end =
        over_seconds ? judged.descent.seconds : static_cast<double>(judged.descent.rows.size());
    series.marks = {{0, run.initial.loss}, {end, judged.evaluation.loss}};
    return series;
}

std::string chart_section(const RunResult& run) {
    std::string html = "<h2>The descent</h2>\n<div class=\"charts\">\n";
    for (const bool over_seconds : {false, true}) {
        Chart chart{over_seconds ? "seconds" : "iteration", "loss", {}};
        chart.series.push_back(loss_series(run, run.result, "first", over_seconds));
        if (run.compared)
            chart.series.push_back(loss_series(run, *run.compared, "second", over_seconds));
        html += "<div class=\"card\">" + chart_svg(chart) + "</div>\n";
    }
    return html + fmt::format(
                      "</div>\n<p class=\"note\">Lines: the loss of each iteration's own image, "
                      "whose noise it holds. Dots: the start and the result, with {} fresh samples "
                      "per pixel.</p>\n",
                      run.options.evaluation_samples);
}

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string table(const std::string& title, const Rows& rows) {
    std::string html = "<div class=\"card\"><h3>" + title + "</h3><table>\n";
    for (const auto& [name, value] : rows)
        html +=
            fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", escape_html(name), escape_html(value));
    return html + "</table></div>\n";
}

Rows number_rows(const RunResult& run, const JudgedDescent& judged) {
    const Descent& d = judged.descent;
    Rows rows{{"loss at the start", fmt::format("{:.6g}", run.initial.loss)},
              {"loss of the result", fmt::format("{:.6g}", judged.evaluation.loss)},
              {"iterations", std::to_string(d.rows.size())},
              {"descent", duration_text(d.seconds)},
              {"ended by", name_of(d.ending)}};
    if (run.noise_floor)
        rows.insert(rows.begin() + 2,
                    {"of that, noise of judging", fmt::format("{:.6g}", *run.noise_floor)});
    for (std::size_t i = 0; i < judged.texture_errors.size(); ++i) {
        const TextureSubject& s = run.subjects[i];
        rows.emplace_back("error of " + s.name,
                          fmt::format("{:.5f}, at the start {:.5f}", judged.texture_errors[i],
                                      run.initial_errors[i]));
        rows.emplace_back("texels that it counts",
                          fmt::format("{} of {}",
                                      count_text(static_cast<std::size_t>(
                                          std::count(s.reached.begin(), s.reached.end(), 1))),
                                      count_text(s.reached.size())));
    }
    rows.emplace_back("paths on the textures", count_text(d.counts.records));
    rows.emplace_back("derivatives", count_text(d.counts.candidates));
    rows.emplace_back("not finite, left out", fmt::format("{} derivatives, {} draws of the image",
                                                          d.counts.rejected, d.rejected_image));
    if (!d.counts.outliers.empty())
        rows.emplace_back("largest contribution",
                          describe(d.counts.outliers.front(), *run.scene, d.theta));
    return rows;
}

std::string table_section(const RunResult& run) {
    Rows seconds;
    for (const auto& [name, s] : run.phases) seconds.emplace_back(name, duration_text(s));
    seconds.emplace_back("peak memory", bytes_text(peak_memory()));
    seconds.emplace_back("predicted", memory_text(run.memory));
    std::string html = "<h2>Numbers</h2>\n<div class=\"tables\">\n<div>";
    html += table(name_of(run.result.estimator), number_rows(run, run.result));
    if (run.compared)
        html += "<div style=\"height:18px\"></div>" +
                table(name_of(run.compared->estimator), number_rows(run, *run.compared));
    html += "<div style=\"height:18px\"></div>" + table("Time and memory", seconds);
    return html + "</div>\n" + table("Settings", settings_of(run)) + "</div>\n";
}

std::string title_of(const RunResult& run) {
    std::string title;
    for (const TextureSubject& s : run.subjects) title += (title.empty() ? "" : ", ") + s.name;
    return title;
}

}  // namespace

std::string report_html(const RunResult& run) {
    const std::string title = escape_html(title_of(run));
    const std::string scene =
        escape_html(run.options.demo ? "the built-in goblet" : run.options.scene.file);
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>Burnish: {}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n<header>"
        "<h1><small>Burnish</small>{}</h1><p>recovered from a picture of {}, {} × {} pixels</p>"
        "</header>\n",
        title, kReportStyle, title, scene, run.target.width, run.target.height);
    html += tiles(run) + image_section(run);
    for (std::size_t i = 0; i < run.subjects.size(); ++i)
        html += texture_section(run, i) + evidence_section(run, i);
    html += chart_section(run) + table_section(run);
    return html + fmt::format("<footer>{}</footer>\n</main>\n</body>\n</html>\n",
                              escape_html(version_text()));
}

}  // namespace burnish
