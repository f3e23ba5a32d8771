// Letters of ASCII, of names that are the same in any case. Those of the C library follow the
// locale of the program that calls: in Turkish "I" has no lower case in one byte.
#pragma once

#include <string>

namespace burnish {

constexpr char lower_case(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
constexpr char upper_case(char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

inline std::string lower_case(std::string text) {
    for (char& c : text) c = lower_case(c);
    return text;
}

}  // namespace burnish
