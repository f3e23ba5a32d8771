#include "cli/report_figures.h"

#include <fmt/format.h>

#include "cli/chart.h"
#include "cli/pictures.h"

namespace burnish {

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

}  // namespace burnish
