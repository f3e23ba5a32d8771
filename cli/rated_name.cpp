#include "cli/rated_name.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/commands.h"
#include "optimize/option_value.h"
#include "scene/parameter_names.h"

namespace burnish {

bool ends_in_rate(const std::string& text) {
    const std::size_t at = text.rfind('@');
    return at != std::string::npos && parse_number(text.substr(at + 1));
}

RatedName split_rate(const std::vector<Parameter>& parameters, const std::string& text) {
    const std::size_t at = text.rfind('@');
    const bool whole = std::any_of(parameters.begin(), parameters.end(),
                                   [&](const Parameter& p) { return is_short_form(text, p.name); });
    if (at == std::string::npos || whole) return {text, 0};
    const std::optional<double> rate = parse_number(text.substr(at + 1));
    if (!rate || !(*rate > 0))
        throw UsageError(
            fmt::format("--parameter: the learning rate of '{}' is '{}', expected a positive "
                        "number after the @",
                        text.substr(0, at), text.substr(at + 1)));
    return {text.substr(0, at), *rate};
}

}  // namespace burnish
