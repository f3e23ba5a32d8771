#include "cli/rated_name.h"

#include <fmt/format.h>

#include "cli/commands.h"
#include "optimize/option_value.h"
#include "scene/constants.h"

namespace burnish {

bool ends_in_rate(const std::string& text) {
    const std::size_t at = text.rfind('@');
    return at != std::string::npos && parse_number(text.substr(at + 1));
}

RatedName split_rate(const Scene& scene, const std::string& text) {
    const std::size_t at = text.rfind('@');
    if (at == std::string::npos || means_input(scene, text)) return {text, 0};
    if (at == 0)
        throw UsageError(
            fmt::format("--parameter: found no name before the @, expected one before the rate {}",
                        text.substr(1)));
    const std::optional<double> rate = parse_number(text.substr(at + 1));
    if (!rate || !(*rate > 0))
        throw UsageError(
            fmt::format("--parameter: the learning rate of '{}' is '{}', expected a positive "
                        "number after the @",
                        text.substr(0, at), text.substr(at + 1)));
    return {text.substr(0, at), *rate};
}

}  // namespace burnish
