#include "mitsuba/properties.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>

#include "core/lower_case.h"
#include "core/parsed.h"
#include "mitsuba/numbers.h"
#include "mitsuba/transforms.h"

namespace burnish::mitsuba {

namespace {

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r\n"), last = text.find_last_not_of(" \t\r\n");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::string value_of(const Property& property) {
    return trimmed(attribute(*property.node, "value"));
}

[[noreturn]] void fail_missing(const Properties& properties, const std::string& name) {
    fail(properties.node->place, fmt::format("{} \"{}\" lacks the parameter \"{}\"",
                                             properties.node->tag, properties.type, name));
}

int choice_of(const Property& property, const std::string& word,
              const std::vector<std::string>& choices) {
    const auto found = std::find(choices.begin(), choices.end(), word);
    if (found == choices.end())
        fail(property.site->place,
             fmt::format("the parameter \"{}\" is \"{:.40}\", expected {}", property.name,
                         value_of(property), fmt::join(choices, ", ")));
    return static_cast<int>(found - choices.begin());
}

}  // namespace

void expect_tag(const Property& property, std::initializer_list<const char*> tags) {
    for (const char* tag : tags)
        if (property.node->tag == tag) return;
    fail(property.site->place, fmt::format("the parameter \"{}\" is a <{}>, expected <{}>",
                                           property.name, property.node->tag, *tags.begin()));
}

Properties open_properties(Document& document, const Node& node) {
    Properties properties{&node, attribute(node, "type"), {}};
    std::unordered_map<std::string_view, const Node*> sites;  // of what has a name
    for (const Node& child : node.children) {
        const Node& target = target_of(document, child);
        if (child.tag == "ref" && is_value(target)) add_referred(document.referred, child, target);
        const std::string& name = attribute(child, "name");
        if (!name.empty())
            if (const auto [other, is_new] = sites.try_emplace(name, &child); !is_new)
                fail(child.place, fmt::format("the parameter \"{}\" is given twice (first at {})",
                                              name, place_text(other->second->place)));
        properties.all.push_back({name, &target, &child, false});
    }
    return properties;
}

const Property* take(Properties& properties, const std::string& name) {
    for (Property& property : properties.all)
        if (property.name == name) {
            property.taken = true;
            return &property;
        }
    return nullptr;
}

const Property& take_required(Properties& properties, const std::string& name) {
    if (const Property* property = take(properties, name)) return *property;
    fail_missing(properties, name);
}

std::vector<const Property*> take_tag(Properties& properties, const std::string& tag) {
    std::vector<const Property*> found;
    for (Property& property : properties.all)
        if (property.node->tag == tag) {
            property.taken = true;
            found.push_back(&property);
        }
    return found;
}

const Property* take_only(Properties& properties, const std::string& tag) {
    const std::vector<const Property*> found = take_tag(properties, tag);
    if (found.size() > 1)
        fail(found[1]->site->place, fmt::format("the {} has a second {}, expected at most one",
                                                properties.node->tag, tag));
    return found.empty() ? nullptr : found[0];
}

double take_number(Properties& properties, const std::string& name, double fallback) {
    const Property* property = take(properties, name);
    if (!property) return fallback;
    expect_tag(*property, {"float", "integer"});
    return parse_number(value_of(*property), property->site->place);
}

double take_within(Properties& properties, const char* name, double fallback, double minimum,
                   double maximum) {
    const double value = take_number(properties, name, fallback);
    if (value >= minimum && value <= maximum) return value;
    fail(properties.node->place,
         fmt::format("\"{}\" is {}, expected a value in [{}, {}]", name, value, minimum, maximum));
}

float take_float(Properties& properties, const std::string& name, float fallback) {
    return static_cast<float>(take_number(properties, name, fallback));
}

int take_integer(Properties& properties, const std::string& name, int fallback, int minimum,
                 int maximum) {
    const Property* property = take(properties, name);
    if (!property) return fallback;
    expect_tag(*property, {"integer"});
    const std::string text = value_of(*property);
    const std::optional<int> value = parsed<int>(without_plus(text));
    if (!value || *value < minimum || *value > maximum)
        fail(property->site->place,
             fmt::format("the parameter \"{}\" is \"{:.40}\", expected an integer in [{}, {}]",
                         name, text, minimum, maximum));
    return *value;
}

bool take_boolean(Properties& properties, const std::string& name, bool fallback) {
    const Property* property = take(properties, name);
    if (!property) return fallback;
    expect_tag(*property, {"boolean"});
    const std::string text = lower_case(value_of(*property));
    if (text != "true" && text != "false")
        fail(property->site->place,
             fmt::format("the parameter \"{}\" is \"{:.40}\", expected true or false", name, text));
    return text == "true";
}

std::string take_string(Properties& properties, const std::string& name,
                        const std::string& fallback) {
    const Property* property = take(properties, name);
    if (!property) return fallback;
    expect_tag(*property, {"string"});
    return attribute(*property->node, "value");
}

std::string take_file_name(Properties& properties) {
    std::string name = take_string(properties, "filename", "");
    if (name.empty()) fail_missing(properties, "filename");
    return name;
}

int take_choice(Properties& properties, const std::string& name,
                const std::vector<std::string>& choices, int fallback) {
    const Property* property = take(properties, name);
    if (!property) return fallback;
    expect_tag(*property, {"string"});
    return choice_of(*property, value_of(*property), choices);
}

int take_choice_in_any_case(Properties& properties, const std::string& name,
                            const std::vector<std::string>& choices, int fallback) {
    const Property* property = take(properties, name);
    if (!property) return fallback;
    expect_tag(*property, {"string"});
    return choice_of(*property, lower_case(value_of(*property)), choices);
}

std::optional<Vec3<double>> take_point(Properties& properties, const std::string& name) {
    const Property* property = take(properties, name);
    if (!property) return {};
    expect_tag(*property, {"point", "vector"});
    return read_vector(*property->node, 0);
}

std::optional<Transform> take_transform(Properties& properties, const std::string& name) {
    const Property* property = take(properties, name);
    if (!property) return {};
    expect_tag(*property, {"transform"});
    return read_transform(*property->node);
}

void ignore(Properties& properties, std::initializer_list<const char*> names) {
    for (const char* name : names) take(properties, name);
}

void warn_unknown(const Properties& properties, std::vector<std::string>& warnings) {
    std::string list;
    for (const Property& property : properties.all) {
        if (property.taken) continue;
        list += fmt::format("{}\"{}\" (line {})", list.empty() ? "" : ", ",
                            property.name.empty() ? "<" + property.node->tag + ">" : property.name,
                            property.site->place.line);
    }
    if (!list.empty())
        warnings.push_back(sentence(properties.node->place,
                                    fmt::format("{} \"{}\" does not know {}: ignored",
                                                properties.node->tag, properties.type, list)));
}

void fail_plugin(const Node& node, const std::string& known, const std::string& expected) {
    const std::string& type = attribute(node, "type");
    if (contains_word(known, type))
        fail_unsupported(node.place, fmt::format("{} \"{}\" is not supported yet: expected {}",
                                                 node.tag, type, expected));
    fail(node.place, fmt::format("unknown {} \"{}\": expected {}", node.tag, type, expected));
}

}  // namespace burnish::mitsuba
