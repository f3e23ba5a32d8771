#include "cli/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

constexpr double kWidth = 640, kHeight = 340;
constexpr double kLeft = 76, kRight = 18, kTop = 20, kBottom = 50;

/// The data's extent, x from 0, y widened to a little more than what is shown.
struct Extent {
    double x_high = 1, y_low = 1, y_high = 1;
};

/// A logarithmic axis has no place for others.
bool is_shown(const ChartPoint& p) { return p.y > 0 && std::isfinite(p.y); }

/// Every point that is shown of every series.
template <class F>
void for_points(const Chart& chart, F f) {
    for (const ChartSeries& s : chart.series)
        for (const auto* points : {&s.points, &s.marks})
            for (const ChartPoint& p : *points)
                if (is_shown(p)) f(p);
}

Extent extent_of(const Chart& chart) {
    Extent e{0, INFINITY, 0};
    for_points(chart, [&](const ChartPoint& p) {
        e.x_high = std::max(e.x_high, p.x);
        e.y_low = std::min(e.y_low, p.y);
        e.y_high = std::max(e.y_high, p.y);
    });
    if (!(e.y_high > 0)) return {};
    if (!(e.x_high > 0)) e.x_high = 1;
    return {e.x_high, e.y_low / 1.25, e.y_high * 1.25};
}

double place_x(const Extent& e, double x) {
    return kLeft + x / e.x_high * (kWidth - kLeft - kRight);
}
double place_y(const Extent& e, double y) {
    const double share = std::log(y / e.y_low) / std::log(e.y_high / e.y_low);
    return kHeight - kBottom - share * (kHeight - kTop - kBottom);
}

std::string axes(const Chart& chart, const Extent& e) {
    std::string svg;
    const double bottom = kHeight - kBottom, right = kWidth - kRight;
    for (const double y : log_ticks(e.y_low, e.y_high))
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\"/>"
            "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.6g}</text>",
            kLeft, place_y(e, y), right, kLeft - 8, place_y(e, y) + 4, y);
    constexpr double kMaxTicks = 8;
    const double max = chart.whole_x ? std::clamp(e.x_high, 1.0, kMaxTicks) : kMaxTicks;
    for (const double x : linear_ticks(0, e.x_high, static_cast<int>(max)))
        svg += fmt::format(
            "<line class=\"axis\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\"/>"
            "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>",
            place_x(e, x), bottom, bottom + 5, bottom + 19,
            chart.x_tick_text ? chart.x_tick_text(x) : fmt::format("{:.6g}", x));
    svg += fmt::format("<path class=\"axis\" d=\"M{0:.1f} {1:.1f}V{2:.1f}H{3:.1f}\"/>", kLeft, kTop,
                       bottom, right);
    svg += fmt::format(
        "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}"
        "</text>",
        (kLeft + right) / 2, kHeight - 10, escape_html(chart.x_label));
    svg += fmt::format(
        "<text class=\"label\" transform=\"translate(16 {:.1f}) rotate(-90)\" "
        "text-anchor=\"middle\">{}</text>",
        (kTop + bottom) / 2, escape_html(chart.y_label));
    return svg;
}

std::string line(const ChartSeries& series, const Extent& e) {
    std::string path;
    for (const ChartPoint& p : series.points)
        if (is_shown(p))
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", place_x(e, p.x),
                                place_y(e, p.y));
    std::string svg = fmt::format("<path class=\"line {}\" d=\"{}\"/>", series.style, path);
    for (const ChartPoint& p : series.marks)
        if (is_shown(p))
            svg += fmt::format("<circle class=\"mark {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"/>",
                               series.style, place_x(e, p.x), place_y(e, p.y));
    return svg;
}

/// The names of the lines, in rows above the plot: the last row ends at y = 0.
struct Legend {
    std::string svg;
    double height = 0;
};

Legend legend(const Chart& chart) {
    if (chart.series.size() < 2) return {};
    constexpr double kRow = 20, kSample = 34, kLetter = 7.5, kGap = 18;  // a letter at most
    std::vector<ChartPoint> places;
    double x = kLeft, y = 0;
    for (const ChartSeries& s : chart.series) {
        const double width = kSample + kLetter * static_cast<double>(s.name.size());
        if (x > kLeft && x + width > kWidth - kRight) x = kLeft, y += kRow;
        places.push_back({x, y});
        x += width + kGap;
    }
    Legend result{"", y + kRow};
    for (std::size_t i = 0; i < places.size(); ++i)
        result.svg += fmt::format(
            "<path class=\"line {0}\" d=\"M{1:.1f} {2:.1f}h26\"/>"
            "<text x=\"{3:.1f}\" y=\"{4:.1f}\">{5}</text>",
            chart.series[i].style, places[i].x, places[i].y - result.height + 12,
            places[i].x + kSample, places[i].y - result.height + 16,
            escape_html(chart.series[i].name));
    return result;
}

}  // namespace

std::string chart_svg(const Chart& chart) {
    const Extent e = extent_of(chart);
    const Legend names = legend(chart);
    std::string svg = fmt::format(
        "<svg class=\"chart\" viewBox=\"0 {} {} {}\" role=\"img\" "
        "aria-label=\"{} over {}\">",
        0 - names.height /* not -0 */, kWidth, kHeight + names.height, escape_html(chart.y_label),
        escape_html(chart.x_label));
    svg += axes(chart, e);
    for (const ChartSeries& s : chart.series) svg += line(s, e);
    return svg + names.svg + "</svg>";
}

std::vector<double> linear_ticks(double low, double high, int max_steps) {
    const double min_step = (high - low) / max_steps;
    double step = std::pow(10.0, std::floor(std::log10(min_step)));
    for (const double factor : {2.0, 2.5, 2.0}) {
        if (step >= min_step) break;
        step *= factor;
    }
    std::vector<double> ticks;
    for (double i = std::ceil(low / step); i * step <= high * (1 + 1e-9); ++i)
        ticks.push_back(i * step);
    return ticks;
}

std::vector<double> log_ticks(double low, double high) {
    const double decades = std::log10(high / low);
    std::vector<double> ticks;
    for (double k = std::floor(std::log10(low)); k <= std::log10(high); ++k)
        for (const double factor : {1.0, 2.0, 5.0}) {
            const double tick = factor * std::pow(10.0, k);
            const bool wanted = factor == 1.0 || decades < 3;
            if (wanted && tick >= low && tick <= high) ticks.push_back(tick);
        }
    // Less than a factor of about three: powers of ten are too far apart.
    return ticks.size() < 3 ? linear_ticks(low, high, 6) : ticks;
}

std::string escape_html(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '<')
            escaped += "&lt;";
        else if (c == '>')
            escaped += "&gt;";
        else if (c == '&')
            escaped += "&amp;";
        else if (c == '"')
            escaped += "&quot;";
        else
            escaped += c;
    }
    return escaped;
}

}  // namespace burnish
