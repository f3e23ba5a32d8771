// Numbers in attributes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// Throws InputError where the word is not a finite number that a float can hold.
double parse_number(std::string_view word, const Place& place);

/// Numbers separated by blanks or commas. Throws InputError where one is not a finite number.
std::vector<double> parse_numbers(const std::string& text, const Place& place);

}  // namespace burnish::mitsuba
