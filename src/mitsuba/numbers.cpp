#include "mitsuba/numbers.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "core/parsed.h"

namespace burnish::mitsuba {

bool contains_word(std::string_view words, std::string_view word) {
    bool found = false;
    for_words(words, " ", [&](std::string_view w) { found |= w == word; });
    return found;
}

double parse_number(std::string_view word, const Place& place) {
    const std::optional<double> value = parsed<double>(without_plus(word));
    if (!value || !(std::abs(*value) <= std::numeric_limits<float>::max()))
        fail(place, fmt::format("found \"{:.40}\", expected a finite number", word));
    return *value;
}

std::vector<double> parse_numbers(const std::string& text, const Place& place) {
    std::vector<double> numbers;
    for_words(text, " ,\t\n\r",
              [&](std::string_view word) { numbers.push_back(parse_number(word, place)); });
    return numbers;
}

}  // namespace burnish::mitsuba
