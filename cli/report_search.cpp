#include "cli/report_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "cli/chart.h"
#include "cli/console.h"
#include "cli/report_figures.h"
#include "core/joined.h"

namespace burnish {

namespace {

constexpr std::size_t kMaxValues = 12;  ///< of a table

/// In the order in which they were tried.
std::vector<SearchedValues> shown_values(const SearchedGroup& group) {
    std::vector<SearchedValues> shown = group.tried;
    while (shown.size() > kMaxValues)
        shown.erase(std::min_element(
            shown.begin(), shown.end(), [](const SearchedValues& a, const SearchedValues& b) {
                return std::pair(a.regions, -a.loss) < std::pair(b.regions, -b.loss);
            }));
    return shown;
}

/// Colours are not tried: each region has its own.
std::string tried_text(const RunResult& run, const SearchedGroup& group, const SearchedValues& v) {
    std::string text;
    for (std::size_t m = 0; m < group.unknowns.size(); ++m)
        text += (text.empty() ? "" : ", ") + (run.textures[group.unknowns[m]].is_color
                                                  ? std::string("colour")
                                                  : fmt::format("{}", v.values[m]));
    return text;
}

std::string group_table(const RunResult& run, const SearchedGroup& group) {
    const std::string names =
        joined(group.unknowns, [&](std::size_t u) { return run.textures[u].name; });
    const std::vector<SearchedValues> shown = shown_values(group);
    TableRows rows;
    for (const SearchedValues& v : shown)
        rows.emplace_back(
            tried_text(run, group, v),
            fmt::format("{} everywhere; {} region{} here", loss_text(v.loss), count_text(v.regions),
                        v.regions == 1 ? " starts" : "s start"));
    if (const std::size_t tried = group.tried.size(); tried > shown.size())
        rows.emplace_back(fmt::format("{} of {}", count_text(tried - shown.size(), "other"), tried),
                          "not shown: summary.json has all");
    if (!group.guides.empty())
        rows.emplace_back("guided by", fmt::format("{}", fmt::join(group.guides, ", ")));
    return table(escape_html(names), rows);
}

}  // namespace

std::string search_section(const RunResult& run) {
    const Summary& s = run.result.summary;
    if (s.searched.empty()) return "";
    std::string html = fmt::format(
        "<h2>The start</h2>\n<p class=\"note\">Searched in {}: each region of a texture starts "
        "from the values at which the pixels that see it lose least, among those that were tried; "
        "colours from the ratio of target and render.</p>\n<div class=\"tables\">\n",
        duration_text(s.search_seconds));
    for (const SearchedGroup& group : s.searched) html += group_table(run, group);
    html += "</div>\n";
    for (const SearchedAgain& again : s.searched_again)
        html += fmt::format(
            "<p class=\"note\">Searched again before iteration {}: {} took other values.</p>\n",
            again.iteration, count_text(again.texels, "texel"));
    return html;
}

}  // namespace burnish
