// The options of burnish::Options, each described once: the command line, option files, the
// settings of a summary and the reference page are made from this table.
//
// To add an option: its field in burnish/options.h and a row in option_table.cpp.
#pragma once

#include <variant>

#include "optimize/option_value.h"

namespace burnish {

/// What a learning rate is above, so that single precision holds it, shared out among unknowns,
/// too; and at most.
inline constexpr double kMinLearningRate = 1e-36, kMaxLearningRate = 1e6;
/// The most that a search for the start takes, in units of that of a run of a minute.
inline constexpr double kMaxSearchEffort = 4;

template <class T>
using OptionField = T* (*)(Options&);  ///< null where another estimator is held

/// When an option has an effect.
struct OptionCondition {
    const char* needs;              ///< "the estimator path_cache"; empty: nothing
    bool (*holds)(const Options&);  ///< null: none decides; `needs` is of the problem
};

struct OptionRow {
    OptionInfo info;
    std::variant<OptionField<bool>, OptionField<int>, OptionField<float>, OptionField<double>,
                 OptionField<std::uint32_t>, OptionField<std::size_t>, OptionField<Sequence>,
                 OptionField<Shift>, OptionField<TargetFunction>, OptionField<MergeRule>,
                 OptionField<Loss>, OptionField<Parameterization>, OptionField<Unvisited>,
                 OptionField<Estimator>, OptionField<std::optional<bool>>,
                 OptionField<std::optional<float>>, OptionField<std::optional<double>>>
        field;
    OptionCondition condition = {"", nullptr};
};

/// All rows; the estimator first.
std::span<const OptionRow> option_table();

/// The row of a name; null where there is none.
const OptionRow* find_option(const std::string& name);

/// Whether the options hold the option: those of another estimator are not there.
bool is_held(const OptionRow& row, const Options& options);

/// Whether the option can change a result under these options.
bool has_effect(const OptionRow& row, const Options& options);

/// Whether the optimiser moves a pyramid: Options::pyramid has an effect.
inline bool has_pyramid(const Options& options) {
    switch (options.parameterization) {
        case Parameterization::kPyramid:
            return true;
        case Parameterization::kTexels:
            return false;
    }
    return false;
}

/// The option's value as text. Throws InputError where the options hold another estimator.
std::string get_option(const OptionRow& row, const Options& options);

/// Sets an option from text. Throws InputError that names the option: the text is no value of it,
/// or the options hold another estimator.
void set_option(const OptionRow& row, const std::string& text, Options& options);

/// Of its values: see option_value.h.
std::string placeholder(const OptionRow& row);
std::string expected_text(const OptionRow& row);
/// What is wrong with a text, "expected ..., found '...'"; empty where nothing is.
std::string complaint(const OptionRow& row, const std::string& text);
/// Under the defaults of the estimator that has the option.
std::string default_text(const OptionRow& row);
/// Whether the values are numbers.
bool is_number(const OptionRow& row);

}  // namespace burnish
