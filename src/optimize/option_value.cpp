#include "optimize/option_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "core/lower_case.h"
#include "core/parsed.h"

namespace burnish {

namespace {

/// To name the values of another type: a specialisation here, a BURNISH_CHOICE at the end of this
/// file.
template <class E>
constexpr Choice<E> kChoices[] = {};
template <>
constexpr Choice<bool> kChoices<bool>[] = {{"true", true}, {"false", false}};
template <>
constexpr Choice<Sequence> kChoices<Sequence>[] = {{"independent", Sequence::kIndependent},
                                                   {"sobol", Sequence::kSobol}};
template <>
constexpr Choice<Shift> kChoices<Shift>[] = {{"replay", Shift::kReplay},
                                             {"identity", Shift::kIdentity}};
template <>
constexpr Choice<TargetFunction> kChoices<TargetFunction>[] = {
    {"luminance", TargetFunction::kLuminance}, {"integrand", TargetFunction::kIntegrand}};
template <>
constexpr Choice<MergeRule> kChoices<MergeRule>[] = {{"balance", MergeRule::kBalance},
                                                     {"defensive", MergeRule::kDefensive}};
template <>
constexpr Choice<Loss> kChoices<Loss>[] = {{"relmse", Loss::kRelMse},
                                           {"l2", Loss::kL2},
                                           {"l1", Loss::kL1},
                                           {"reweighted", Loss::kReweighted}};
template <>
constexpr Choice<Parameterization> kChoices<Parameterization>[] = {
    {"pyramid", Parameterization::kPyramid}, {"texels", Parameterization::kTexels}};
template <>
constexpr Choice<Unvisited> kChoices<Unvisited>[] = {{"fill", Unvisited::kFill},
                                                     {"keep", Unvisited::kKeep}};
template <>
constexpr Choice<LightSelection> kChoices<LightSelection>[] = {
    {"resampled", LightSelection::kResampled},
    {"uniform", LightSelection::kUniform},
    {"power", LightSelection::kPower},
    {"tree", LightSelection::kTree}};
template <>
constexpr Choice<Estimator> kChoices<Estimator>[] = {
    {"path_cache", PathCache{}},
    {"mc", MonteCarlo{}},
    {"ris", Reservoirs{.positivization = false, .reuse = false}},
    {"pris", Reservoirs{.positivization = true, .reuse = false}},
    {"gris", Reservoirs{.positivization = false, .reuse = true}},
    {"pgris", Reservoirs{.positivization = true, .reuse = true}}};

template <class T>
struct OptionalOf {
    static constexpr bool holds = false;
};
template <class T>
struct OptionalOf<std::optional<T>> {
    static constexpr bool holds = true;
    using Value = T;
};

template <class T>
constexpr bool is_arithmetic_value = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;
template <class T>
constexpr bool is_string = std::is_same_v<T, std::string>;

template <class E>
bool same_choice(const E& a, const E& b) {
    return a == b;
}
/// Estimators of one name may differ in their options.
bool same_choice(const Estimator& a, const Estimator& b) {
    if (a.index() != b.index()) return false;
    const auto* x = std::get_if<Reservoirs>(&a);
    const auto* y = std::get_if<Reservoirs>(&b);
    return !x || (x->positivization == y->positivization && x->reuse == y->reuse);
}

template <class E>
const char* choice_name(const E& value) {
    const auto* const end = std::end(kChoices<E>);
    const auto* const found = std::find_if(
        std::begin(kChoices<E>), end, [&](const auto& c) { return same_choice(c.value, value); });
    return found == end ? "" : found->name;  // no enumerator: check_options refuses it
}

template <class E>
bool choose(const std::string& text, E& value) {
    for (const Choice<E>& c : kChoices<E>) {
        if (text != c.name) continue;
        value = c.value;
        return true;
    }
    return false;
}

std::string range_text(const Range& r) {
    return fmt::format("{} {} {:.10g} {} {:.10g}", r.integer ? "a whole number" : "a number",
                       r.above_low ? "above" : "from", r.low, r.above_low ? "and at most" : "to",
                       r.high);
}

bool is_in(const Range& range, double x) {
    return (range.above_low ? x > range.low : x >= range.low) && x <= range.high &&
           (!range.integer || x == std::floor(x));
}

template <class T>
void read_number(const std::string& text, double number, T& value) {
    if constexpr (std::is_same_v<T, float>) {
        // Not by way of double where that can be helped: it would round twice.
        const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
        if (read.ec != std::errc()) value = static_cast<float>(number);
    } else {
        value = static_cast<T>(number);
    }
}

}  // namespace

template <class E>
std::span<const Choice<E>> choices() {
    return kChoices<E>;
}

const char* name_of(const Estimator& estimator) { return choice_name(estimator); }

std::optional<double> parse_number(const std::string& text) {
    const std::optional<double> number = parsed<double>(without_plus(text));
    return number && std::isfinite(*number) ? number : std::nullopt;
}

std::string range_complaint(const Range& range, const std::string& text) {
    const std::optional<double> x = parse_number(text);
    if (x && is_in(range, *x)) return {};
    return fmt::format("expected {}, found '{}'", range_text(range), text);
}

template <class T>
std::string to_text(const OptionInfo& info, const T& value) {
    if constexpr (OptionalOf<T>::holds) {
        if (!value) return info.unset;
        OptionInfo of_value = info;
        of_value.unset = "";  // a value of its own, also where it is unset_value
        return to_text(of_value, *value);
    } else if constexpr (is_string<T>) {
        return value.empty() ? info.unset : value;
    } else if constexpr (is_arithmetic_value<T>) {
        if (*info.unset && value == static_cast<T>(info.unset_value)) return info.unset;
        return fmt::format("{}", value);
    } else {
        return choice_name(value);
    }
}

template <class T>
std::string expected_text(const OptionInfo& info) {
    const std::string or_unset = *info.unset ? fmt::format(" or {}", info.unset) : "";
    if constexpr (OptionalOf<T>::holds) {
        return expected_text<typename OptionalOf<T>::Value>(info);
    } else if constexpr (is_string<T>) {
        return "a text";
    } else if constexpr (is_arithmetic_value<T>) {
        return range_text(info.range) + or_unset;
    } else {
        return "one of " + choice_list<T>(", ") + or_unset;
    }
}

template <class T>
std::string from_text(const OptionInfo& info, const std::string& text, T& value) {
    const bool unset = *info.unset && text == info.unset;
    if constexpr (OptionalOf<T>::holds) {
        if (unset) {
            value.reset();
            return {};
        }
        typename OptionalOf<T>::Value read{};
        std::string complaint = from_text(info, text, read);
        if (complaint.empty()) value = std::move(read);
        return complaint;
    } else if constexpr (is_string<T>) {
        value = unset ? std::string() : text;
        return {};
    } else if constexpr (is_arithmetic_value<T>) {
        const std::optional<double> number = parse_number(text);
        if (unset) {
            value = static_cast<T>(info.unset_value);
            return {};
        }
        if (number && is_in(info.range, *number)) {
            T read{};
            read_number(text, *number, read);
            // A float may be rounded down to the end that is left out.
            if (!info.range.above_low || static_cast<double>(read) > info.range.low) {
                value = read;
                return {};
            }
        }
    } else {
        if (choose(text, value)) return {};
    }
    return fmt::format("expected {}, found '{}'", expected_text<T>(info), text);
}

template <class T>
std::string placeholder(const OptionInfo& info) {
    if constexpr (OptionalOf<T>::holds) {
        return placeholder<typename OptionalOf<T>::Value>(info);
    } else if constexpr (is_arithmetic_value<T>) {
        if (info.range.integer) return "N";
        std::string unit = *info.unit ? info.unit : "X";
        for (char& c : unit) c = upper_case(c);
        return unit;
    } else if constexpr (is_string<T>) {
        return *info.unit ? info.unit : "TEXT";
    } else {
        return choice_list<T>("|");
    }
}

#define BURNISH_OPTION_VALUE(T)                                                \
    template std::string to_text(const OptionInfo&, const T&);                 \
    template std::string from_text(const OptionInfo&, const std::string&, T&); \
    template std::string expected_text<T>(const OptionInfo&);                  \
    template std::string placeholder<T>(const OptionInfo&);
BURNISH_OPTION_VALUE(int)
BURNISH_OPTION_VALUE(float)
BURNISH_OPTION_VALUE(double)
BURNISH_OPTION_VALUE(std::uint32_t)
BURNISH_OPTION_VALUE(std::size_t)
BURNISH_OPTION_VALUE(std::string)
BURNISH_OPTION_VALUE(std::optional<bool>)
BURNISH_OPTION_VALUE(std::optional<float>)
BURNISH_OPTION_VALUE(std::optional<double>)
BURNISH_OPTION_VALUE(std::optional<Estimator>)

#define BURNISH_CHOICE(E)                          \
    template std::span<const Choice<E>> choices(); \
    BURNISH_OPTION_VALUE(E)
BURNISH_CHOICE(bool)
BURNISH_CHOICE(Sequence)
BURNISH_CHOICE(Shift)
BURNISH_CHOICE(TargetFunction)
BURNISH_CHOICE(MergeRule)
BURNISH_CHOICE(Loss)
BURNISH_CHOICE(Parameterization)
BURNISH_CHOICE(Unvisited)
BURNISH_CHOICE(LightSelection)
BURNISH_CHOICE(Estimator)
#undef BURNISH_CHOICE
#undef BURNISH_OPTION_VALUE

}  // namespace burnish
