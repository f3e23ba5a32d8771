#include "cli/option_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/commands.h"
#include "scene/parameter_names.h"

namespace burnish {

CLI::Validator in_range(const Range& range) {
    return CLI::Validator([range](const std::string& text) { return range_complaint(range, text); },
                          "");
}

std::string complaint_of_empty(const std::string& text) {
    return text.empty() ? "found an empty text, expected a value" : "";
}

CLI::Validator not_empty() { return CLI::Validator(complaint_of_empty, ""); }

void require_known(const char* what, const std::string& name,
                   const std::vector<std::string>& known) {
    if (std::ranges::find(known, name) != known.end()) return;
    throw UsageError(
        fmt::format("there is no {} '{}', {}", what, name, expected_name(name, known)));
}

}  // namespace burnish
