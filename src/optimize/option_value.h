// Values of options as text: names of choices, ranges of numbers, and what was expected where a
// text does not fit. A value that is written and read again is the same value.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "burnish/options.h"
#include "burnish/renderer.h"

namespace burnish {

/// Who needs an option. Basic ones are in --help.
enum class OptionLevel { kBasic, kExpert };

/// The numbers that an option takes.
struct Range {
    double low = 0, high = 0;
    bool integer = false;
    bool above_low = false;  ///< the low end itself is not allowed
};

/// What is said of an option, whatever it is an option of.
struct OptionInfo {
    const char* name;       ///< dotted: "path_cache.window"
    const char* flag = "";  ///< of the command line, "--spp"; empty: none of its own
    OptionLevel level = OptionLevel::kExpert;
    const char* sentence;
    const char* unit = "";     ///< of a number; empty: a count, a factor
    Range range = {};          ///< of a number
    const char* unset = "";    ///< the word for no value of its own: "auto", "none"
    double unset_value = 0.0;  ///< the number that it stands for; not of std::optional
};

/// The names of the values of an enumeration, of bool, and of Estimator: all of kChoices in the
/// source file.
template <class E>
struct Choice {
    const char* name;
    E value;
};
template <class E>
std::span<const Choice<E>> choices();

/// "a, b, c": the names of the values that are admitted.
template <class E>
std::string choice_list(const char* separator, bool (*admits)(const E&) = nullptr) {
    std::string text;
    for (const Choice<E>& c : choices<E>())
        if (!admits || admits(c.value))
            text += (text.empty() ? "" : separator) + std::string(c.name);
    return text;
}

/// mc, ris, pris, gris, pgris or path_cache.
const char* name_of(const Estimator& estimator);

/// The finite number that the whole text spells, if it does. A point is a point in any locale.
std::optional<double> parse_number(const std::string& text);

/// "expected a whole number from 1 to 64, found '65'"; empty where the text is in the range.
std::string range_complaint(const Range& range, const std::string& text);

/// The value as text, as short as it can be without becoming another value. T: bool, float, double,
/// int, std::uint32_t, std::size_t, std::string, an enumeration that has names, Estimator, or an
/// optional of these.
template <class T>
std::string to_text(const OptionInfo& info, const T& value);

/// Reads a value; returns the complaint "expected ..., found '...'", empty where there is none, and
/// leaves the value as it was where there is one. An estimator comes with its defaults.
template <class T>
std::string from_text(const OptionInfo& info, const std::string& text, T& value);

/// What a text may be: "a whole number from 1 to 64", "one of a, b".
template <class T>
std::string expected_text(const OptionInfo& info);

/// A placeholder for a value in the help: "N", "SECONDS", "a|b".
template <class T>
std::string placeholder(const OptionInfo& info);

}  // namespace burnish
