#include "cli/option_text.h"

#include <fmt/format.h>

#include <cmath>
#include <locale>
#include <sstream>

namespace burnish {

std::optional<double> parse_number(const std::string& text) {
    // from_chars of doubles is missing in older standard libraries; the classic locale keeps the
    // decimal point a point.
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());
    double number = 0;
    stream >> std::noskipws >> number;
    if (text.empty() || stream.fail() || !stream.eof() || !std::isfinite(number)) return {};
    return number;
}

CLI::Validator in_range(const Range& range) {
    const auto check = [range](const std::string& text) -> std::string {
        const std::optional<double> x = parse_number(text);
        const bool holds = x && (range.above_low ? *x > range.low : *x >= range.low) &&
                           *x <= range.high && (!range.integer || *x == std::floor(*x));
        if (holds) return {};
        return fmt::format("expected {} {} {:.10g} {} {:.10g}, found '{}'",
                           range.integer ? "a whole number" : "a number",
                           range.above_low ? "above" : "from", range.low,
                           range.above_low ? "and at most" : "to", range.high, text);
    };
    return CLI::Validator(check, "");
}

}  // namespace burnish
