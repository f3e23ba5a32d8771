// Options as text: numbers, ranges, and names of choices. One table per choice serves the parser,
// the help, the summary and the report.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>

#include "texture/coverage.h"
#include "optimize/solve.h"

namespace burnish {

/// The finite number that the whole text spells, if it does.
std::optional<double> parse_number(const std::string& text);

struct Range {
    double low, high;
    bool integer = false;
    bool above_low = false;  ///< the low end itself is not allowed
};
/// Refuses what is not a number of the range, in one sentence.
CLI::Validator in_range(const Range& range);

template <class E>
struct Choice {
    const char* name;
    E value;
};
inline constexpr Choice<Estimator> kEstimatorNames[] = {
    {"mc", Estimator::kMc},     {"ris", Estimator::kRis},     {"pris", Estimator::kPris},
    {"gris", Estimator::kGris}, {"pgris", Estimator::kPgris}, {"pool", Estimator::kPool}};
/// Those that make a gradient from one image.
inline constexpr Choice<Estimator> kGradientEstimatorNames[] = {{"mc", Estimator::kMc},
                                                                {"ris", Estimator::kRis},
                                                                {"pris", Estimator::kPris},
                                                                {"gris", Estimator::kGris},
                                                                {"pgris", Estimator::kPgris}};
inline constexpr Choice<Shift> kShiftNames[] = {{"replay", Shift::kReplay},
                                                {"identity", Shift::kIdentity}};
inline constexpr Choice<Target> kTargetNames[] = {{"luminance", Target::kLuminance},
                                                  {"integrand", Target::kIntegrand}};
inline constexpr Choice<MergeRule> kMergeNames[] = {{"balance", MergeRule::kBalance},
                                                    {"defensive", MergeRule::kDefensive}};
inline constexpr Choice<Upsampling> kUpsamplingNames[] = {{"bilinear", Upsampling::kBilinear},
                                                          {"box", Upsampling::kBox}};
inline constexpr Choice<PixelChoice> kPixelChoiceNames[] = {{"uniform", PixelChoice::kUniform},
                                                            {"adaptive", PixelChoice::kAdaptive}};
inline constexpr Choice<Sequence> kSequenceNames[] = {{"independent", Sequence::kIndependent},
                                                      {"sobol", Sequence::kSobol}};
inline constexpr Choice<LightSelection> kLightSelectionNames[] = {
    {"uniform", LightSelection::kUniform},
    {"power", LightSelection::kPower},
    {"tree", LightSelection::kTree}};
inline constexpr Choice<Loss> kLossNames[] = {
    {"relmse", Loss::kRelMse}, {"l2", Loss::kL2}, {"l1", Loss::kL1}};
inline constexpr Choice<Optimizer> kOptimizerNames[] = {
    {"agreement", Optimizer::kGatedAdam}, {"adam", Optimizer::kAdam}, {"sgd", Optimizer::kSgd}};
inline constexpr Choice<Parameterization> kParameterizationNames[] = {
    {"pyramid", Parameterization::kPyramid},
    {"smooth", Parameterization::kSmooth},
    {"texels", Parameterization::kTexels}};
inline constexpr Choice<Unvisited> kUnvisitedNames[] = {{"fill", Unvisited::kFill},
                                                          {"keep", Unvisited::kKeep}};

template <class E, std::size_t N>
const char* choice_name(const Choice<E> (&choices)[N], E value) {
    for (const Choice<E>& c : choices)
        if (c.value == value) return c.name;
    return "";
}

/// "mc, ris, pris"
template <class E, std::size_t N>
std::string choice_list(const Choice<E> (&choices)[N], const char* separator) {
    std::string text;
    for (const Choice<E>& c : choices)
        text += (text.empty() ? "" : separator) + std::string(c.name);
    return text;
}

/// An option whose value is one of the choices, which must outlive the parsing.
template <class E, std::size_t N, class Assign>
CLI::Option* add_choice_option(CLI::App& app, const std::string& name,
                               const Choice<E> (&choices)[N], const Assign& assign,
                               const std::string& help) {
    const auto parse = [&choices, assign](const std::string& text) {
        for (const Choice<E>& c : choices)
            if (text == c.name) assign(c.value);
    };
    const auto check = [&choices](const std::string& text) -> std::string {
        for (const Choice<E>& c : choices)
            if (text == c.name) return {};
        return "expected one of " + choice_list(choices, ", ") + ", found '" + text + "'";
    };
    return app.add_option_function<std::string>(name, parse, help)
        ->type_name(choice_list(choices, "|"))
        ->check(CLI::Validator(check, ""));
}

/// The same where `value` takes the choice and holds the default; it must outlive the parsing.
template <class E, std::size_t N>
CLI::Option* add_choice(CLI::App& app, const std::string& name, E& value,
                        const Choice<E> (&choices)[N], const std::string& help) {
    return add_choice_option(
               app, name, choices, [&value](E chosen) { value = chosen; }, help)
        ->default_str(choice_name(choices, value));
}

}  // namespace burnish
