#include "mitsuba/tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "mitsuba/numbers.h"

namespace burnish::mitsuba {

namespace {

struct TagRule {
    std::string_view tag, required, optional;  ///< attributes, separated by blanks
};

constexpr std::string_view kPlugin = "id name version", kNumbers = "value x y z name id";
/// Every element of the language and its attributes.
constexpr std::array kTags{
    TagRule{"scene", "version", "id type"},
    TagRule{"default", "name value", ""},
    TagRule{"include", "filename", "name id"},
    TagRule{"path", "value", ""},
    TagRule{"alias", "id as", ""},
    TagRule{"ref", "id", "name"},
    TagRule{"bsdf", "type", kPlugin},
    TagRule{"emitter", "type", kPlugin},
    TagRule{"film", "type", kPlugin},
    TagRule{"integrator", "type", kPlugin},
    TagRule{"medium", "type", kPlugin},
    TagRule{"phase", "type", kPlugin},
    TagRule{"rfilter", "type", kPlugin},
    TagRule{"sampler", "type", kPlugin},
    TagRule{"sensor", "type", kPlugin},
    TagRule{"shape", "type", kPlugin},
    TagRule{"texture", "type", kPlugin},
    TagRule{"volume", "type", kPlugin},
    TagRule{"float", "name value", "id"},
    TagRule{"integer", "name value", "id"},
    TagRule{"boolean", "name value", "id"},
    TagRule{"string", "name value", "id"},
    TagRule{"rgb", "value", "name id"},
    TagRule{"srgb", "value", "name id"},
    TagRule{"spectrum", "", "name value filename type id version unit"},
    TagRule{"point", "name", "value x y z id"},
    TagRule{"vector", "name", "value x y z id"},
    TagRule{"transform", "name", "id"},
    TagRule{"translate", "", kNumbers},
    TagRule{"scale", "", kNumbers},
    TagRule{"rotate", "angle", kNumbers},
    TagRule{"lookat", "origin target", "up"},
    TagRule{"lookAt", "origin target", "up"},
    TagRule{"matrix", "value", ""},
};

const TagRule& rule_of(const std::string& tag, const Place& place) {
    const auto* rule =
        std::find_if(kTags.begin(), kTags.end(), [&](const TagRule& r) { return r.tag == tag; });
    if (rule == kTags.end())
        fail(place, fmt::format("found the element <{}>, expected one of the scene language "
                                "(shape, bsdf, float, ...)",
                                tag));
    return *rule;
}

}  // namespace

void check_tag(const Node& node) { rule_of(node.tag, node.place); }

void check_attributes(const Node& node) {
    const TagRule& rule = rule_of(node.tag, node.place);
    for (const auto& [name, value] : node.attributes)
        if (!contains_word(rule.required, name) && !contains_word(rule.optional, name))
            fail(node.place,
                 fmt::format("<{}> has the attribute \"{}\", expected {}{}{}", node.tag, name,
                             rule.required, rule.required.empty() ? "" : " ", rule.optional));
    for_words(rule.required, " ", [&](std::string_view name) {
        if (std::none_of(node.attributes.begin(), node.attributes.end(),
                         [&](const auto& a) { return a.first == name; }))
            fail(node.place, fmt::format("<{}> lacks the attribute \"{}\"", node.tag, name));
    });
}

}  // namespace burnish::mitsuba
