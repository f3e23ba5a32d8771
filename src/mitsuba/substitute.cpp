#include "mitsuba/substitute.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "burnish/error.h"
#include "scene/parameter_names.h"

namespace burnish::mitsuba {

namespace {

/// The longest defined name that `text` starts with; end() where there is none.
Definitions::iterator longest_match(Definitions& definitions, std::string_view text) {
    while (true) {
        // Of the names up to the text, the last is the longest that the text begins with, or else
        // all that it begins with are no longer than what it shares with that one.
        auto last = definitions.upper_bound(text);
        if (last == definitions.begin()) return definitions.end();
        const std::string_view name = (--last)->first;
        if (text.starts_with(name)) return last;
        const auto differs =
            std::mismatch(text.begin(), text.end(), name.begin(), name.end()).first;
        text = text.substr(0, static_cast<std::size_t>(differs - text.begin()));
    }
}

std::string_view identifier(std::string_view text) {
    std::size_t end = 0;
    while (end < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_'))
        ++end;
    return text.substr(0, end);
}

}  // namespace

Definitions command_line_definitions(const std::map<std::string, std::string>& given) {
    Definitions definitions;
    for (const auto& [name, value] : given)
        if (!name.empty()) definitions[name] = {value, true, false};
    return definitions;
}

bool is_defined(const Definitions& definitions, const std::string& name) {
    return definitions.count(name) != 0;
}

void define(Definitions& definitions, const std::string& name, const std::string& value,
            const Place& place) {
    if (name.empty()) fail(place, "<default> has an empty name, expected one such as \"spp\"");
    const auto [definition, is_new] = definitions.emplace(name, Definition{value, false, false});
    if (!is_new) definition->second.used = true;  // the command line meant this scene
}

std::string substitute(Definitions& definitions, const std::string& text, const Place& place) {
    constexpr std::size_t kMaxLength = std::size_t{1} << 20;
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '$') {
            result += text[++i];
        } else if (text[i] != '$') {
            result += text[i];
        } else {
            const std::string_view rest = std::string_view(text).substr(i + 1);
            const auto match = longest_match(definitions, rest);
            if (match == definitions.end())
                fail(place, fmt::format("the parameter \"${}\" is not defined, expected <default "
                                        "name=\"{}\" .../> or "
                                        "-D {}=...",
                                        identifier(rest), identifier(rest), identifier(rest)));
            match->second.used = true;
            result += match->second.value;
            if (result.size() > kMaxLength)
                fail(place,
                     fmt::format("an attribute is longer than {} bytes once its parameters are "
                                 "filled in",
                                 kMaxLength));
            i += match->first.size();
        }
    }
    return result;
}

void check_given(const Definitions& definitions, const std::string& file) {
    std::vector<std::string> known;
    for (const auto& [name, definition] : definitions)
        if (!definition.from_command_line || definition.used) known.push_back("$" + name);
    for (const auto& [name, definition] : definitions) {
        if (!definition.from_command_line || definition.used) continue;
        throw InputError(fmt::format(
            "{}: a value is given for ${}, which the scene does not have; expected {}", file, name,
            known.empty() ? "none, as it has no <default>" : "one for " + list_of(known)));
    }
}

}  // namespace burnish::mitsuba
