#include "cli/option_text.h"

namespace burnish {

CLI::Validator in_range(const Range& range) {
    return CLI::Validator([range](const std::string& text) { return range_complaint(range, text); },
                          "");
}

}  // namespace burnish
