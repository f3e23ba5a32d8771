// Words that are numbers.
#pragma once

#include <charconv>
#include <cmath>
#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>

namespace burnish {

/// Whether a number that std::from_chars finds out of range is too close to 0, not too far from it.
inline bool is_tiny(std::string_view number) {
    std::istringstream stream{std::string(number)};
    stream.imbue(std::locale::classic());
    double value = 0;
    stream >> value;  // out of range: the largest number, or one next to 0
    return std::abs(value) < 1;
}

/// The number that the whole word spells, without blanks or a "+": what is too close to 0 for T is
/// 0. None where the word is no number, or one that T does not hold.
template <class T>
std::optional<T> parsed(std::string_view word) {
    T value{};
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (stop != end) return std::nullopt;
    if (error == std::errc()) return value;
    if constexpr (std::is_floating_point_v<T>)
        if (error == std::errc::result_out_of_range && is_tiny(word)) return T{};
    return std::nullopt;
}

/// Without the "+" that may stand before a number, but for one before another sign.
inline std::string_view without_plus(std::string_view word) {
    return word.substr(word.starts_with('+') && !word.starts_with("+-"));
}

}  // namespace burnish
