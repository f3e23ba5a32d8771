#include "optimize/option_value.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "core/parsed.h"

namespace burnish {

namespace {

constexpr Choice<Sequence> kSequences[] = {{"independent", Sequence::kIndependent},
                                           {"sobol", Sequence::kSobol}};
constexpr Choice<Shift> kShifts[] = {{"replay", Shift::kReplay}, {"identity", Shift::kIdentity}};
constexpr Choice<TargetFunction> kTargetFunctions[] = {{"luminance", TargetFunction::kLuminance},
                                                       {"integrand", TargetFunction::kIntegrand}};
constexpr Choice<MergeRule> kMergeRules[] = {{"balance", MergeRule::kBalance},
                                             {"defensive", MergeRule::kDefensive}};
constexpr Choice<Loss> kLosses[] = {
    {"relmse", Loss::kRelMse}, {"l2", Loss::kL2}, {"l1", Loss::kL1}};
constexpr Choice<Parameterization> kParameterizations[] = {{"pyramid", Parameterization::kPyramid},
                                                           {"texels", Parameterization::kTexels}};
constexpr Choice<Unvisited> kUnvisited[] = {{"fill", Unvisited::kFill}, {"keep", Unvisited::kKeep}};
constexpr Choice<LightSelection> kLightSelections[] = {{"resampled", LightSelection::kResampled},
                                                       {"uniform", LightSelection::kUniform},
                                                       {"power", LightSelection::kPower},
                                                       {"tree", LightSelection::kTree}};
constexpr Choice<bool> kBools[] = {{"true", true}, {"false", false}};

Reservoirs reservoirs(bool positivization, bool reuse) {
    Reservoirs r;
    r.positivization = positivization, r.reuse = reuse;
    return r;
}
const Choice<Estimator> kEstimators[] = {
    {"path_cache", PathCache{}},       {"mc", MonteCarlo{}},
    {"ris", reservoirs(false, false)}, {"pris", reservoirs(true, false)},
    {"gris", reservoirs(false, true)}, {"pgris", reservoirs(true, true)}};

}  // namespace

template <>
std::span<const Choice<Sequence>> choices() {
    return kSequences;
}
template <>
std::span<const Choice<Shift>> choices() {
    return kShifts;
}
template <>
std::span<const Choice<TargetFunction>> choices() {
    return kTargetFunctions;
}
template <>
std::span<const Choice<MergeRule>> choices() {
    return kMergeRules;
}
template <>
std::span<const Choice<Loss>> choices() {
    return kLosses;
}
template <>
std::span<const Choice<Parameterization>> choices() {
    return kParameterizations;
}
template <>
std::span<const Choice<Unvisited>> choices() {
    return kUnvisited;
}
template <>
std::span<const Choice<LightSelection>> choices() {
    return kLightSelections;
}
template <>
std::span<const Choice<bool>> choices() {
    return kBools;
}
template <>
std::span<const Choice<Estimator>> choices() {
    return kEstimators;
}

namespace {

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
    for (const Choice<E>& c : choices<E>())
        if (same_choice(c.value, value)) return c.name;
    return "";
}

template <class E>
bool choose(const std::string& text, E& value) {
    for (const Choice<E>& c : choices<E>()) {
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

const char* name_of(const Estimator& estimator) { return choice_name(estimator); }

std::optional<double> parse_number(const std::string& text) {
    std::string_view word = text;
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    const std::optional<double> number = parsed<double>(word);
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
            read_number(text, *number, value);
            return {};
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
        for (char& c : unit) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
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
BURNISH_OPTION_VALUE(bool)
BURNISH_OPTION_VALUE(int)
BURNISH_OPTION_VALUE(float)
BURNISH_OPTION_VALUE(double)
BURNISH_OPTION_VALUE(std::uint32_t)
BURNISH_OPTION_VALUE(std::size_t)
BURNISH_OPTION_VALUE(std::string)
BURNISH_OPTION_VALUE(Sequence)
BURNISH_OPTION_VALUE(Shift)
BURNISH_OPTION_VALUE(TargetFunction)
BURNISH_OPTION_VALUE(MergeRule)
BURNISH_OPTION_VALUE(Loss)
BURNISH_OPTION_VALUE(Parameterization)
BURNISH_OPTION_VALUE(Unvisited)
BURNISH_OPTION_VALUE(LightSelection)
BURNISH_OPTION_VALUE(Estimator)
BURNISH_OPTION_VALUE(std::optional<bool>)
BURNISH_OPTION_VALUE(std::optional<float>)
BURNISH_OPTION_VALUE(std::optional<double>)
BURNISH_OPTION_VALUE(std::optional<std::uint32_t>)
BURNISH_OPTION_VALUE(std::optional<Estimator>)
#undef BURNISH_OPTION_VALUE

}  // namespace burnish
