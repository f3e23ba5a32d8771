#include "cli/report_figures.h"

#include <fmt/format.h>

#include "cli/chart.h"
#include "cli/pictures.h"

namespace burnish {

namespace {

std::string caption(const std::string& name, const std::string& more) {
    return fmt::format("<figcaption><b>{}</b>{}</figcaption>", escape_html(name),
                       more.empty() ? "" : " &middot; " + escape_html(more));
}

}  // namespace

std::string figure(const std::string& name, const std::string& more, const Image& image,
                   bool srgb) {
    return fmt::format("<figure><img alt=\"{}\" src=\"{}\">{}</figure>\n", escape_html(name),
                       png_data_uri(image, srgb), caption(name, more));
}

std::string strip(const std::string& name, const std::string& more,
                  const std::vector<std::pair<std::string, std::string>>& pictures) {
    std::string html = "<figure><div class=\"strip\">";
    for (const auto& [what, uri] : pictures)
        html += fmt::format("<img alt=\"{}: {}\" src=\"{}\">", escape_html(name), what, uri);
    return html + "</div>" + caption(name, more) + "</figure>\n";
}

std::string color_key(float white, const std::string& meaning) {
    return fmt::format(
        "<div class=\"key\"><span>0</span><i style=\"background:linear-gradient("
        "to right, {})\"></i><span>{:.3g}</span><span>{}</span></div>\n",
        false_color_gradient(), white, meaning);
}

std::string loss_text(double loss) { return fmt::format("loss {:.4g}", loss); }

}  // namespace burnish
