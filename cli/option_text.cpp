#include "cli/option_text.h"

namespace burnish {

CLI::Validator in_range(const Range& range) {
    return CLI::Validator([range](const std::string& text) { return range_complaint(range, text); },
                          "");
}

std::string complaint_of_empty(const std::string& text) {
    return text.empty() ? "found an empty text, expected a value" : "";
}

CLI::Validator not_empty() { return CLI::Validator(complaint_of_empty, ""); }

}  // namespace burnish
