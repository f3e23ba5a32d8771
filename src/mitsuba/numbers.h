// Words of a text, and numbers in attributes.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// Calls body with the words of a text, which are parted by any number of the blanks.
void for_words(std::string_view text, std::string_view blanks, const auto& body) {
    for (std::size_t end = 0;;) {
        const std::size_t begin = text.find_first_not_of(blanks, end);
        if (begin == std::string_view::npos) return;
        end = std::min(text.find_first_of(blanks, begin), text.size());
        body(text.substr(begin, end - begin));
    }
}

/// Whether a word is one of several that are parted by spaces.
bool contains_word(std::string_view words, std::string_view word);

/// Throws InputError where the word is not a finite number that a float can hold.
double parse_number(std::string_view word, const Place& place);

/// Numbers separated by blanks or commas. Throws InputError where one is not a finite number.
std::vector<double> parse_numbers(const std::string& text, const Place& place);

}  // namespace burnish::mitsuba
