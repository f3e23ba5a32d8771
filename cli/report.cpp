#include "cli/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "cli/chart.h"
#include "cli/console.h"
#include "cli/pictures.h"
#include "cli/process_memory.h"
#include "cli/report_figures.h"
#include "cli/report_search.h"
#include "cli/report_views.h"
#include "cli/run_result.h"
#include "core/joined.h"
#include "image/quality.h"
#include "optimize/loss.h"

namespace burnish {

namespace {

constexpr int kTextureSide = 512;  // texture pictures are shrunk to this: the files hold all texels

std::string tile(const std::string& label, const std::string& number, const std::string& more) {
    return fmt::format("<div class=\"tile\"><span>{}</span><b>{}</b><span>{}</span></div>\n",
                       escape_html(label), escape_html(number), escape_html(more));
}

std::string change_text(double from, double to) {
    return significant_text(from, 3) + " → " + significant_text(to, 3);
}

/// "12 times lower", or what happened instead.
std::string ratio_text(double from, double to) {
    if (!(to > 0) || !(from > 0)) return "";
    return from >= to ? digits_text(from / to) + " times lower"
                      : digits_text(to / from) + " times higher";
}

std::string other_text(const RunResult& run, const std::string& number) {
    return fmt::format("{}: {}", name_of(*run.compared), number);
}

/// history: empty where there is none. window: of the kept image; 0: it is of fresh samples alone.
std::string kept_text(const std::string& history, std::uint32_t window) {
    if (window == 0) return history.empty() ? "no history" : history;
    const std::string image = "an image of " + halves_text(window);
    return history.empty() ? image : history + "; " + image;
}

/// What an estimator keeps from iteration to iteration.
std::string kept_text(const RunResult& run, const PathCache& cache) {
    return fmt::format("{}, {} in an iteration", run.kept_text,
                       count_text(cache.samples, "fresh sample"));
}
std::string kept_text(const RunResult&, const Reservoirs& r) {
    const std::string history =
        fmt::format("{} shift, confidence cap {:g}",
                    r.shift == Shift::kReplay ? "replay" : "identity", r.confidence_cap);
    return kept_text(r.reuse ? history : "", r.image_window);
}
std::string kept_text(const RunResult&, const MonteCarlo& o) {
    return kept_text("", o.image_window);
}

std::string tiles(const RunResult& run) {
    const Summary& s = run.result.summary;
    const EvaluatedRun* other = run.compared ? &*run.compared : nullptr;
    std::string html = "<div class=\"tiles\">\n";
    const double start = loss_without_noise(s.start), loss = loss_without_noise(s.result);
    html +=
        tile("Loss of the image", change_text(start, loss),
             other ? other_text(run, significant_text(loss_without_noise(other->summary.result), 3))
             : is_too_noisy(s.result) ? "too noisy to tell: more --evaluation-spp"
                                      : ratio_text(start, loss));
    for (std::size_t i = 0; i < run.result.texture_errors.size(); ++i)
        html +=
            tile("Error of the texture (RMSE)",
                 error_text(run.initial_errors[i].seen, 3) + " → " +
                     error_text(run.result.texture_errors[i].seen, 3),
                 run.textures[i].name +
                     (other ? ", " + other_text(run, error_text(other->texture_errors[i].seen, 3))
                            : ""));
    const double n = s.counts.iterations;
    html += tile("Iterations", std::to_string(s.counts.iterations),
                 fmt::format("{} in all, {:.3g} s each{}", duration_text(s.seconds), s.seconds / n,
                             s.ending == Ending::kCancelled ? ", ended early by a signal" : ""));
    html += tile(
        "Estimator", name_of(run.result),
        std::visit([&](const auto& e) { return kept_text(run, e); }, run.result.options.estimator));
    return html + "</div>\n";
}

/// Of a constant.
std::string value_section(const RunResult& run, std::size_t i) {
    const TargetTexture& t = run.textures[i];
    std::string html = fmt::format("<h2>{} <small>one value</small></h2>\n<div class=\"tiles\">\n",
                                   escape_html(t.name));
    html += tile("Result", values_text(run.result.summary.textures[i].values), "");
    html += tile("Start", values_text(t.initial), "");
    if (t.truth) html += tile("Truth", values_text(*t.truth), "");
    if (run.compared)
        html += tile(fmt::format("Result of {}", name_of(*run.compared)),
                     values_text(run.compared->summary.textures[i].values), "");
    return html + "</div>\n";
}

std::string texture_heading(const TargetTexture& t) {
    return fmt::format("<h2>{} <small>{} × {} texels, {}, {}</small></h2>\n", escape_html(t.name),
                       t.initial.width, t.initial.height,
                       t.initial.channels == 1 ? "one channel" : "RGB",
                       t.raw ? "shown as they are" : "shown sRGB-coded");
}

std::string texture_section(const RunResult& run, std::size_t i) {
    const TargetTexture& t = run.textures[i];
    if (is_one_value(t.initial)) return value_section(run, i);
    const Image& after = run.result.summary.textures[i].values;
    const auto show = [&](const std::string& name, const std::string& more, const Image& texels) {
        return figure(name, more, shrink(texels, kTextureSide), !t.raw);
    };
    const auto error = [&](double e) { return "error " + error_text(e, 4); };
    const std::string heading = texture_heading(t);
    if (!t.truth) {
        std::string html = heading + "<div class=\"pictures three\">\n";
        html += show("Start", "", t.initial) + show("Result", "", after);
        if (run.compared)
            html += show(fmt::format("Result of {}", name_of(*run.compared)), "",
                         run.compared->summary.textures[i].values);
        return html + "</div>\n";
    }
    const std::vector<char>& visited = t.evidence.visited;
    const float white =
        std::max(quantile(absolute_error(t.initial, *t.truth), 0.99, visited), 1e-3f);
    const auto difference = [&](const std::string& whose, const Image& texels) {
        const Image shown = shrink(absolute_error(texels, *t.truth), kTextureSide, visited);
        return figure("Difference", whose + " and truth", false_color(shown, white), false);
    };
    std::string html =
        heading + fmt::format("<div class=\"pictures {}\">\n", run.compared ? "three" : "four");
    html += show("Truth", "", *t.truth);
    html += show("Result", error(run.result.texture_errors[i].seen), after);
    html += show("Start", error(run.initial_errors[i].seen), t.initial);
    html += difference("result", after);
    if (run.compared) {
        const std::string name = name_of(*run.compared);
        const Image& other = run.compared->summary.textures[i].values;
        html += show("Result of " + name, error(run.compared->texture_errors[i].seen), other);
        html += difference("result of " + name, other);
    }
    return html + "</div>\n" + color_key(white, "difference, where light reaches the texture");
}

/// Where the picture says something about the texture, and how surely.
std::string evidence_section(const RunResult& run, std::size_t i) {
    if (is_one_value(run.textures[i].initial)) return "";
    const RecoveredTexture& t = run.result.summary.textures[i];
    std::vector<char> covered(t.coverage.values.size());
    for (std::size_t k = 0; k < covered.size(); ++k) covered[k] = t.coverage.values[k] > 0;
    std::string html = "<div style=\"height:18px\"></div><div class=\"pictures four\">\n", key;
    for (const auto& [name, map] : evidence_maps(t)) {
        const bool is_coverage = name == "coverage";
        const Image shown =
            is_coverage ? shrink(*map, kTextureSide) : shrink(*map, kTextureSide, covered);
        html +=
            figure(is_coverage ? "Coverage" : "Confidence",
                   is_coverage ? "iterations with samples" : "signal-to-noise gate of the gradient",
                   false_color(shown, 1), false);
        key += is_coverage ? "coverage: share of the iterations"
                           : "; confidence: higher where less noise";
    }
    html += "</div>\n" + color_key(1, key);
    const std::string unvisited = unvisited_text(run, i);
    return unvisited.empty() ? html : html + "<p class=\"note\">" + unvisited + "</p>\n";
}

ChartSeries loss_series(const EvaluatedRun& run, const char* style, bool over_seconds) {
    const Summary& s = run.summary;
    ChartSeries series{name_of(run), style, {}, {}};
    for (const Iteration& i : s.iterations)
        series.points.push_back({over_seconds ? i.seconds : static_cast<double>(i.number), i.loss});
    const double end = over_seconds ? s.seconds : s.counts.iterations;
    series.marks = {{0, loss_without_noise(s.start)}, {end, loss_without_noise(s.result)}};
    return series;
}

std::string chart_section(const RunResult& run) {
    std::string html = "<h2>The run</h2>\n<div class=\"charts\">\n";
    for (const bool over_seconds : {false, true}) {
        Chart chart{over_seconds ? "seconds" : "iteration", "loss", {}};
        chart.whole_x = !over_seconds;
        chart.series.push_back(loss_series(run.result, "first", over_seconds));
        if (run.compared) {
            chart.series.push_back(loss_series(*run.compared, "second", over_seconds));
            std::vector<ChartPoint>& marks = chart.series.back().marks;
            marks.erase(marks.begin());  // the start, which both have
        }
        html += "<div class=\"card wide\">" + chart_svg(chart) + "</div>\n";
    }
    return html + fmt::format(
                      "</div>\n<p class=\"note\">Lines: the loss of each iteration's own image, "
                      "with its noise. Dots: the start, {}, and the result, with {} fresh samples "
                      "per pixel.</p>\n",
                      is_unbiased(run.settings.options.loss) ? "without noise on average"
                                                             : "with the noise of as many samples",
                      run.result.summary.result.samples_per_pixel);
}

/// Of weighted_texture_error.
std::string weighted_text(double error) {
    return std::isfinite(error) ? fmt::format("{:.5f}", error) : "too noisy to tell";
}

TableRows number_rows(const RunResult& run, const EvaluatedRun& evaluated) {
    const Summary& s = evaluated.summary;
    TableRows rows;
    const auto add_loss = [&](const char* name, const char* noise, const Evaluation& e) {
        rows.emplace_back(name, significant_text(loss_without_noise(e), 6));
        if (std::isfinite(e.noise_floor))
            rows.emplace_back(noise, significant_text(e.noise_floor, 6));
    };
    add_loss("loss at the start", "noise of the start, taken off", s.start);
    add_loss("loss of the result", "noise of its evaluation, taken off", s.result);
    rows.emplace_back("iterations", std::to_string(s.counts.iterations));
    rows.emplace_back("optimisation", duration_text(s.seconds));
    rows.emplace_back("ended by", ended_by(s));
    for (std::size_t i = 0; i < evaluated.texture_errors.size(); ++i) {
        const TargetTexture& t = run.textures[i];
        rows.emplace_back("error of " + t.name, error_text(evaluated.texture_errors[i].seen, 5) +
                                                    ", at the start " +
                                                    error_text(run.initial_errors[i].seen, 5));
        rows.emplace_back(
            "weighted with how much each texel moves the pictures",
            fmt::format("{}, at the start {}", weighted_text(evaluated.texture_errors[i].weighted),
                        weighted_text(run.initial_errors[i].weighted)));
        rows.emplace_back(
            "texels that it counts",
            fmt::format("{} of {}",
                        count_text(static_cast<std::size_t>(
                            std::count(t.evidence.visited.begin(), t.evidence.visited.end(), 1))),
                        count_text(t.evidence.visited.size())));
    }
    const RunCounts& counts = s.counts;
    const bool keeps = std::holds_alternative<PathCache>(evaluated.options.estimator);
    rows.emplace_back(keeps ? "paths shaded, kept ones in every iteration" : "paths shaded",
                      count_text(counts.paths));
    if (counts.derivatives > 0) rows.emplace_back("derivatives", count_text(counts.derivatives));
    rows.emplace_back("not finite, left out",
                      fmt::format("{} derivatives, {} samples of the image",
                                  counts.rejected_derivatives, counts.rejected_image));
    return rows;
}

TableRows settings_rows(const RunResult& run) {
    TableRows rows;
    for (const SettingText& s : recorded_settings(repeatable_settings(run)))
        rows.emplace_back(s.info->name, fmt::format("{}", fmt::join(s.values, ", ")));
    return rows;
}

std::string table_section(const RunResult& run) {
    TableRows seconds;
    for (const auto& [name, s] : run.phases) seconds.emplace_back(name, duration_text(s));
    seconds.emplace_back("peak memory", bytes_text(peak_memory()));
    seconds.emplace_back("memory estimate", memory_text(run.memory));
    std::string html = "<h2>Numbers</h2>\n<div class=\"tables\">\n<div>";
    html += table(name_of(run.result), number_rows(run, run.result));
    if (run.compared)
        html += "<div style=\"height:18px\"></div>" +
                table(name_of(*run.compared), number_rows(run, *run.compared));
    html += "<div style=\"height:18px\"></div>" + table("Time and memory", seconds);
    return html + "</div>\n" + table("Settings", settings_rows(run)) + "</div>\n";
}

/// What other programs take, beside the report.
std::string deliverables_section(const RunResult& run) {
    const std::string links = joined(run.deliverables, [](const auto& deliverable) {
        return fmt::format("<a href=\"{0}\">{0}</a>", deliverable.second);
    });
    return links.empty() ? "" : "<p class=\"note\">For other programs: " + links + "</p>\n";
}

}  // namespace

std::string report_html(const RunResult& run) {
    const std::string title = escape_html(joined(run.textures, &TargetTexture::name));
    const std::string& file = run.settings.run.scene;
    const std::string scene = escape_html(file.empty() ? "the built-in goblet" : file);
    const Image& first = run.views.front().image;
    const std::string pictures =
        run.views.size() == 1
            ? fmt::format("a picture of {}, {} × {} pixels", scene, first.width, first.height)
            : fmt::format("{} pictures of {}", fitted_count(run), scene);
    std::string html = fmt::format(
        "<h1><small>Burnish</small>{}</h1><p>recovered from {}</p></header>\n", title, pictures);
    html += tiles(run) + views_section(run);
    for (std::size_t i = 0; i < run.textures.size(); ++i)
        html += texture_section(run, i) + evidence_section(run, i);
    html +=
        deliverables_section(run) + search_section(run) + chart_section(run) + table_section(run);
    return page_html(title, "", html);
}

}  // namespace burnish
