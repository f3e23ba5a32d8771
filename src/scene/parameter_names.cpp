#include "scene/parameter_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "burnish/error.h"

namespace burnish {

namespace {

constexpr std::size_t kMaxListed = 12;

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == '.')
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

bool is_short_form(const std::string& short_form, const std::string& full_name) {
    const std::vector<std::string> full = split(full_name);
    auto at = full.begin();
    for (const std::string& part : split(short_form)) {
        at = std::find(at, full.end(), part);
        if (at == full.end()) return false;
        ++at;
    }
    return true;
}

/// The parts of a name but for a side of its material and the last .data or .value.
std::vector<std::string> plain_parts(const std::string& name) {
    std::vector<std::string> parts = split(name);
    if (parts.back() == "data" || parts.back() == "value") parts.pop_back();
    const auto is_side = [](const std::string& part) {
        return part == "brdf_0" || part == "brdf_1";
    };
    if (!parts.empty())  // the first is of the material's id
        parts.erase(std::remove_if(parts.begin() + 1, parts.end(), is_side), parts.end());
    return parts;
}

/// How far a typed name is from a full one: from the whole, or from its nearest part, so that
/// "roughnes" finds every roughness.
std::size_t distance_to(const std::string& typed, const std::string& full) {
    std::size_t nearest = edit_distance(typed, full);
    const std::vector<std::string> parts = split(full);
    for (const std::string& part : parts) nearest = std::min(nearest, edit_distance(typed, part));
    // The short form that people use most: material.parameter.
    for (std::size_t k = 1; k < parts.size(); ++k)
        nearest = std::min(nearest, edit_distance(typed, parts.front() + "." + parts[k]));
    return nearest;
}

/// The names within a third of the typed length of the nearest one, nearest first; none where none
/// is near.
std::vector<std::string> near_names(const std::vector<Parameter>& parameters,
                                    const std::string& typed) {
    std::vector<std::pair<std::size_t, std::string>> ranked;
    for (const Parameter& p : parameters) ranked.emplace_back(distance_to(typed, p.name), p.name);
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    const std::size_t near = std::max<std::size_t>(2, typed.size() / 3);
    std::vector<std::string> names;
    for (const auto& [distance, name] : ranked)
        if (distance <= std::min(near, ranked.front().first + 1)) names.push_back(name);
    return names;
}

[[noreturn]] void fail_unknown(const std::vector<Parameter>& parameters, const std::string& name) {
    if (parameters.empty())
        throw InputError(
            fmt::format("no parameter is called '{}': the scene has no bitmap texture "
                        "that a BSDF reads",
                        name));
    std::vector<std::string> names = near_names(parameters, name);
    const char* what = names.empty() ? "expected one of" : "did you mean:";
    if (names.empty())
        for (const Parameter& p : parameters) names.push_back(p.name);
    throw InputError(
        fmt::format("no parameter is called '{}', {} {}", name, what, list_of(std::move(names))));
}

}  // namespace

std::string list_of(std::vector<std::string> names) {
    const std::size_t left = names.size() - std::min(names.size(), kMaxListed);
    names.resize(names.size() - left);
    return fmt::format("{}{}", fmt::join(names, ", "),
                       left ? fmt::format(" and {} more", left) : "");
}

NameMatch match_name(const std::string& text, const std::string& full_name) {
    if (text == full_name) return NameMatch::kFullName;
    if (!is_short_form(text, full_name)) return NameMatch::kNone;
    return plain_parts(text) == plain_parts(full_name) ? NameMatch::kPlainName
                                                       : NameMatch::kShortForm;
}

std::size_t find_parameter(const std::vector<Parameter>& parameters, const std::string& name) {
    std::vector<std::size_t> matches;
    auto best = NameMatch::kShortForm;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const NameMatch match = match_name(name, parameters[i].name);
        if (match == NameMatch::kFullName) return i;
        if (match < best) continue;
        if (match > best) matches.clear();
        best = match;
        matches.push_back(i);
    }
    if (matches.empty()) fail_unknown(parameters, name);
    std::vector<std::string> names;
    std::set<std::int32_t> textures;
    for (const std::size_t i : matches) {
        names.push_back(parameters[i].name);
        textures.insert(parameters[i].texture.value);
    }
    if (textures.size() > 1)
        throw InputError(fmt::format("the parameter name '{}' is ambiguous, it matches: {}", name,
                                     list_of(std::move(names))));
    return matches.front();
}

void require_distinct(const std::vector<std::string>& names,
                      const std::vector<TextureId>& textures) {
    for (std::size_t i = 0; i < names.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (textures[k] == textures[i])
                throw InputError(names[k] == names[i]
                                     ? fmt::format("the parameter {} is given twice", names[i])
                                     : fmt::format("the parameters {} and {} are one texture",
                                                   names[k], names[i]));
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
    const std::size_t width = b.size() + 1;
    std::vector<std::size_t> d((a.size() + 1) * width);
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t k = 0; k <= b.size(); ++k) {
            std::size_t& min = d[i * width + k];
            min = std::max(i, k);
            if (i == 0 || k == 0) continue;
            min = std::min({d[(i - 1) * width + k] + 1, d[i * width + k - 1] + 1,
                            d[(i - 1) * width + k - 1] + (a[i - 1] == b[k - 1] ? 0 : 1)});
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
                min = std::min(min, d[(i - 2) * width + k - 2] + 1);
        }
    return d.back();
}

std::string nearest_name(const std::string& written, const std::vector<std::string>& names) {
    std::string nearest;
    std::size_t limit = written.size() / 3 + 1;
    for (const std::string& name : names)
        if (const std::size_t found = edit_distance(written, name); found < limit)
            nearest = name, limit = found;
    return nearest;
}

std::string expected_name(const std::string& written, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(written, names);
    return fmt::format("{} one of {}",
                       nearest.empty() ? "expected" : "did you mean " + nearest + "? Expected",
                       fmt::join(names, ", "));
}

}  // namespace burnish
