#include "mitsuba/numbers.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "core/parsed.h"

namespace burnish::mitsuba {

namespace {

bool is_separator(char c) { return c == ' ' || c == ',' || c == '\t' || c == '\n' || c == '\r'; }

}  // namespace

double parse_number(std::string_view word, const Place& place) {
    const std::string_view digits = !word.empty() && word[0] == '+' ? word.substr(1) : word;
    const std::optional<double> value = parsed<double>(digits);
    if (!value || !(std::abs(*value) <= std::numeric_limits<float>::max()))
        fail(place, fmt::format("found \"{:.40}\", expected a finite number", word));
    return *value;
}

std::vector<double> parse_numbers(const std::string& text, const Place& place) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < text.size();) {
        if (is_separator(text[i])) {
            ++i;
            continue;
        }
        const std::size_t begin = i;
        while (i < text.size() && !is_separator(text[i])) ++i;
        numbers.push_back(parse_number(std::string_view(text).substr(begin, i - begin), place));
    }
    return numbers;
}

}  // namespace burnish::mitsuba
