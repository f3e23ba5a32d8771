#include "mitsuba/ply_attributes.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace burnish::mitsuba {

namespace {

using Postfixes = std::array<std::string_view, 4>;

constexpr std::array<Postfixes, 3> kPostfixes{
    {{"x", "y", "z", "w"}, {"0", "1", "2", "3"}, {"1", "2", "3", "4"}}};
constexpr std::array<Postfixes, 2> kColorPostfixes{
    {{"r", "g", "b", "a"}, {"red", "green", "blue", "alpha"}}};

/// How many properties from `first` on are prefix + postfixes[0], [1], ...; lists are none.
std::size_t run_length(const PlyElement& element, std::size_t first, const std::string& prefix,
                       const Postfixes& postfixes) {
    std::size_t k = 0;
    while (k < postfixes.size() && first + k < element.properties.size()) {
        const PlyProperty& property = element.properties[first + k];
        if (property.is_list || property.name != prefix + std::string(postfixes[k])) break;
        ++k;
    }
    return k;
}

struct Run {
    std::string name;        ///< of the attribute; empty: it is none
    std::size_t length = 0;  ///< of the properties; 0: no run begins here
};

/// An attribute that has a name of its own is one value or three.
Run named_run(const std::string& name, std::size_t length) {
    return {length == 1 || length == 3 ? name : "", length};
}

/// What begins at a property.
Run run_at(const PlyElement& element, std::size_t first) {
    for (const Postfixes& color : kColorPostfixes)
        if (const std::size_t n = run_length(element, first, "", color); n >= 3)
            return {"color", n};
    const std::string& name = element.properties[first].name;
    const std::size_t underscore = name.rfind('_');
    if (underscore == std::string::npos || underscore == 0) return {};
    const std::string prefix = name.substr(0, underscore + 1);
    const std::string own = name.substr(0, underscore);
    if (const std::size_t n = run_length(element, first, prefix, kColorPostfixes[0]); n > 0)
        return named_run(own + "_color", n);
    for (const Postfixes& postfixes : kPostfixes)
        if (const std::size_t n = run_length(element, first, prefix, postfixes); n > 0)
            return named_run(own, n);
    return {};
}

}  // namespace

AttributeColumns attribute_columns(const PlyElement& element, const std::string& start) {
    AttributeColumns columns;
    columns.of_property.assign(element.properties.size(), -1);
    for (std::size_t i = 0; i < element.properties.size();) {
        const Run run = run_at(element, i);
        if (run.length == 0) {
            ++i;
            continue;
        }
        const std::size_t begin = i;
        i += run.length;
        if (run.name.empty()) continue;
        std::fill_n(columns.of_property.begin() + static_cast<std::ptrdiff_t>(begin), run.length,
                    static_cast<int>(columns.attributes.size()));
        columns.attributes.push_back(
            {start + run.name, start == "face_", static_cast<int>(run.length), {}});
    }
    return columns;
}

}  // namespace burnish::mitsuba
