#include "cli/report_figures.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/chart.h"
#include "cli/console.h"
#include "cli/pictures.h"
#include "cli/report_style.h"
#include "core/version.h"

namespace burnish {

namespace {

/// Pictures with no longer side are enlarged with their pixels as squares. What shrink() has
/// averaged is no such picture: half of the most that it is asked for is more.
constexpr int kSmall = 180;

/// small: the longest side of a picture whose pixels are squares.
std::string img(const std::string& name, const Image& image, bool srgb, int small) {
    const bool is_small = std::max(image.width, image.height) <= small;
    return fmt::format("<img{} alt=\"{}\" src=\"{}\">", is_small ? " class=\"small\"" : "",
                       escape_html(name), png_data_uri(image, srgb));
}

std::string caption(const std::string& name, const std::string& more) {
    return fmt::format("<figcaption><b>{}</b>{}</figcaption>", escape_html(name),
                       more.empty() ? "" : " &middot; " + escape_html(more));
}

}  // namespace

std::string page_html(const std::string& title, const char* more_style, const std::string& body) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>Burnish: {}</title>\n<style>{}{}</style>\n</head>\n<body>\n<main>\n<header>{}"
        "<footer>{}</footer>\n</main>\n</body>\n</html>\n",
        title, kReportStyle, more_style, body, escape_html(version_text()));
}

std::string figure(const std::string& name, const std::string& more, const Image& image,
                   bool srgb) {
    return "<figure>" + img(name, image, srgb, kSmall) + caption(name, more) + "</figure>\n";
}

std::string strip(const std::string& name, const std::string& more,
                  const std::vector<StripPicture>& pictures) {
    const int small = kSmall / static_cast<int>(pictures.size());  // each has a part of the width
    std::string html = "<figure><div class=\"strip\">";
    for (const StripPicture& p : pictures)
        html += img(name + ": " + p.what, p.image, p.srgb, small);
    return html + "</div>" + caption(name, more) + "</figure>\n";
}

std::string color_key(float white, const std::string& meaning) {
    return fmt::format(
        "<div class=\"key\"><span>0</span><i style=\"background:linear-gradient("
        "to right, {})\"></i><span>{:.3g}</span><span>{}</span></div>\n",
        false_color_gradient(), white, meaning);
}

std::string table(const std::string& title, const TableRows& rows) {
    std::string html = "<div class=\"card\">";
    if (!title.empty()) html += "<h3>" + title + "</h3>";
    html += "<table>\n";
    for (const auto& [name, value] : rows)
        html +=
            fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", escape_html(name), escape_html(value));
    return html + "</table></div>\n";
}

std::string loss_text(double loss) { return "loss " + significant_text(loss, 4); }

}  // namespace burnish
