// Line charts as SVG: axes with ticks and labels, colours from the style sheet of the page.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace burnish {

struct ChartPoint {
    double x = 0, y = 0;
};

/// One line. style: the class of its path, which gives it a colour.
struct ChartSeries {
    std::string name, style;
    std::vector<ChartPoint> points;
    std::vector<ChartPoint> marks;  ///< drawn as dots on top
};

/// A chart with a linear x axis and a logarithmic y axis. Points with y <= 0, or that are not
/// finite, are left out. Several series are named above the plot.
struct Chart {
    std::string x_label, y_label;
    std::vector<ChartSeries> series;
    /// How the numbers of the x axis are written; empty: as they are.
    std::function<std::string(double)> x_tick_text = {};
    /// No ticks at fractions of x: it counts something, or is a logarithm.
    bool whole_x = false;
};

/// An <svg> element that scales with its surroundings.
std::string chart_svg(const Chart& chart);

/// Round numbers 1, 2, 5 times a power of ten that divide [low, high] into at most `max_steps`.
std::vector<double> linear_ticks(double low, double high, int max_steps);
/// Powers of ten within [low, high]; with 2 and 5 times them on less than three decades; round
/// steps where those are few, too.
std::vector<double> log_ticks(double low, double high);

/// <, >, & and " become entities.
std::string escape_html(const std::string& text);

}  // namespace burnish
