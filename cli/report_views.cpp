#include "cli/report_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/chart.h"
#include "cli/console.h"
#include "cli/pictures.h"
#include "cli/report_figures.h"
#include "cli/view_pictures.h"
#include "core/parallel.h"
#include "image/quality.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"

namespace burnish {

namespace {

std::string of_picture(const RunResult& run, std::size_t view) {
    const std::string& file = run.sources[view].image;
    return file.empty() ? "rendered" : file;
}

/// "1.62", or that of each channel.
std::string exposure_text(const ExposureFactors& e) {
    if (e[0] == e[1] && e[1] == e[2]) return fmt::format("{:.4g}", e[0]);
    return fmt::format("{:.4g}, {:.4g}, {:.4g}", e[0], e[1], e[2]);
}

/// How pictures were read, fitted exposures, and what looks wrong.
std::string notes(const RunResult& run) {
    std::string html;
    const auto note = [&](const std::string& text) {
        html += "<p class=\"note\">" + escape_html(text) + "</p>\n";
    };
    for (const std::string& text : decoding_texts(run.sources, run.pictures.photographs))
        note(text);
    for (const std::string& text : mask_texts(run.sources, run.pictures.masks)) note(text);
    if (run.views.size() == 1 && fits_exposure(run.views[0].exposure))
        note("Exposure, fitted: " + exposure_text(run.result.summary.result.views[0].exposure));
    for (const std::string& warning : run.picture_warnings) note("Warning: " + warning);
    return html;
}

std::string decibels(double psnr) {
    return std::isfinite(psnr) ? fmt::format("{:.1f} dB", psnr) : "";
}
std::string similarity(double ssim) {
    return std::isfinite(ssim) ? fmt::format("{:.4f}", ssim) : "";
}

/// "loss 0.01, 31.2 dB, SSIM 0.9312", of what is known.
std::string quality_text(const RunResult& run, std::size_t view) {
    const ViewEvaluation& result = run.result.summary.result.views[view];
    const double ssim = run.similarities[view];
    std::string text = loss_text(loss_without_noise(result));
    if (std::isfinite(result.psnr)) text += ", " + decibels(result.psnr);
    if (std::isfinite(ssim)) text += ", SSIM " + similarity(ssim);
    return text;
}

Image exposed_image(const ViewEvaluation& view) { return exposed(view.exposure, view.image); }

/// Between a render and the picture, of the values that count.
Image difference(const ViewEvaluation& render, const View& view) {
    const Image image = exposed_image(render);
    return relative_error(image, alike_where_uncounted(view.image, image, view.mask));
}

/// The difference that is drawn brightest, of the pixels that count.
float brightest_difference(const Image& difference, const View& view) {
    return std::max(quantile(difference, 0.99, counted_pixels(view.mask)), 1e-6f);
}

std::string difference_key(float white, const std::string& to) {
    return color_key(white, "relative difference to the " + to + ", of the pixels that count");
}

/// One picture, large, with the start beside it.
std::string single_view(const RunResult& run) {
    const Summary& s = run.result.summary;
    const View& view = run.views[0];
    const float scale = display_scale(view.image, counted_pixels(view.mask));
    const Image start = exposed_image(s.start.views[0]);
    const Image result = exposed_image(s.result.views[0]);
    const Image before = difference(s.start.views[0], view);
    const Image after = difference(s.result.views[0], view);
    const float white = brightest_difference(before, view);
    std::string html = "<h2>The picture</h2>\n<div class=\"pictures three\">\n";
    html += figure("Start", loss_text(loss_without_noise(s.start)), brightened(start, scale), true);
    html += figure("Result", quality_text(run, 0), brightened(result, scale), true);
    html += figure("Target", of_picture(run, 0), brightened(view.image, scale), true);
    html += figure("Difference at the start", "", false_color(before, white), false);
    html += figure("Difference of the result", "", false_color(after, white), false);
    if (run.compared) {
        const ViewEvaluation& other = run.compared->summary.result.views[0];
        html += figure(fmt::format("Difference of {}'s result", name_of(*run.compared)),
                       loss_text(loss_without_noise(other)),
                       false_color(difference(other, view), white), false);
    }
    return html + "</div>\n" + difference_key(white, "target") + notes(run);
}

std::string table_of_views(const RunResult& run) {
    std::string html =
        "<div class=\"card wide\"><table class=\"grid\">\n<tr><th>view</th><th>use</th>"
        "<th>loss at the start</th><th>loss</th><th>PSNR</th><th>SSIM</th><th>exposure</th></tr>\n";
    const Evaluation& start = run.result.summary.start;
    const Evaluation& result = run.result.summary.result;
    for (std::size_t i = 0; i < run.views.size(); ++i) {
        html += fmt::format(
            "<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
            "<td>{}{}</td></tr>\n",
            escape_html(name_of(run.views[i], i)), run.views[i].held_out ? "held out" : "fitted",
            significant_text(loss_without_noise(start.views[i]), 4),
            significant_text(loss_without_noise(result.views[i]), 4),
            decibels(result.views[i].psnr), similarity(run.similarities[i]),
            exposure_text(result.views[i].exposure),
            fits_exposure(run.views[i].exposure) ? " (fitted)" : "");
    }
    return html + "</table></div>\n";
}

/// What is shown of one of several views, no side longer than `side`.
struct ViewPictures {
    Image picture, render;  ///< linear
    Image difference;       ///< sRGB-encoded
};
ViewPictures pictures_of(const RunResult& run, std::size_t i, float white, int side) {
    const Image& picture = run.views[i].image;
    const ViewEvaluation& result = run.result.summary.result.views[i];
    const float scale = display_scale(picture, counted_pixels(run.views[i].mask));
    return {shrink(brightened(picture, scale), side),
            shrink(brightened(exposed_image(result), scale), side),
            false_color(shrink(difference(result, run.views[i]), side), white)};
}

/// Picture, render and difference, large.
std::string row_of_view(const RunResult& run, std::size_t i, float white) {
    constexpr int kSide = 360;
    const View& view = run.views[i];
    const ViewPictures p = pictures_of(run, i, white, kSide);
    return "<div class=\"pictures view\">\n" +
           figure(name_of(view, i), (view.held_out ? "held out, " : "") + of_picture(run, i),
                  p.picture, true) +
           figure("Render", quality_text(run, i), p.render, true) +
           figure("Difference", "", p.difference, false) + "</div>\n";
}

/// The same of many views, small: those beyond the rows.
std::string contact_sheet(const RunResult& run, std::size_t first, float white) {
    constexpr int kSide = 160;
    std::string html =
        "<p class=\"note\">The other views: picture, render, difference.</p>\n"
        "<div class=\"pictures sheet\">\n";
    std::vector<std::string> strips(run.views.size() - first);
    parallel_for(strips.size(), [&](std::size_t k) {
        const std::size_t i = first + k;
        const ViewPictures p = pictures_of(run, i, white, kSide);
        strips[k] = strip(name_of(run.views[i], i),
                          (run.views[i].held_out ? "held out, " : "") + quality_text(run, i),
                          {{"picture", p.picture, true},
                           {"render", p.render, true},
                           {"difference", p.difference, false}});
    });
    for (const std::string& s : strips) html += s;
    return html + "</div>\n";
}

std::string several_views(const RunResult& run) {
    constexpr std::size_t kRows = 12;
    const Summary& s = run.result.summary;
    std::vector<float> whites(run.views.size());
    parallel_for(whites.size(), [&](std::size_t i) {
        whites[i] = brightest_difference(difference(s.start.views[i], run.views[i]), run.views[i]);
    });
    const float white = *std::max_element(whites.begin(), whites.end());
    const std::size_t rows = std::min(kRows, run.views.size());
    std::string html = "<h2>The pictures</h2>\n" + table_of_views(run);
    for (std::size_t i = 0; i < rows; ++i) html += row_of_view(run, i, white);
    if (rows < run.views.size()) html += contact_sheet(run, rows, white);
    return html + difference_key(white, "picture") + notes(run);
}

}  // namespace

std::string views_section(const RunResult& run) {
    return run.views.size() == 1 ? single_view(run) : several_views(run);
}

}  // namespace burnish
