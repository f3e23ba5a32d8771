// Options of the commands: ranges of numbers, names of choices, texts that may not be empty.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "optimize/option_value.h"

namespace burnish {

/// Refuses what is not a number of the range, in one sentence.
CLI::Validator in_range(const Range& range);

/// What is said of an empty text: of a variable of the shell that is not set, mostly. Empty where
/// it is not.
std::string complaint_of_empty(const std::string& text);
/// Refuses an empty text.
CLI::Validator not_empty();

/// Throws UsageError with the known names and the nearest one where `name` is not one of them.
/// what: what the name is of.
void require_known(const char* what, const std::string& name,
                   const std::vector<std::string>& known);

/// An option whose value is a text that may not be empty. type: what stands for it in the help.
/// `value` must outlive the parsing, here and below.
template <class T>
CLI::Option* add_text(CLI::App& app, const char* name, T& value, const char* type,
                      const std::string& help) {
    return app.add_option(name, value, help)->type_name(type)->check(not_empty());
}

/// An option whose value is a number of the range; `value` holds the default.
template <class T>
CLI::Option* add_number(CLI::App& app, const char* name, T& value, const char* type,
                        const std::string& help, const Range& range) {
    return app.add_option(name, value, help)
        ->type_name(type)
        ->check(in_range(range))
        ->capture_default_str();
}

/// An option whose value is one of the names of E, of those that are admitted. `value` takes the
/// choice and holds the default.
template <class E>
CLI::Option* add_choice(CLI::App& app, const char* name, E& value, const std::string& help,
                        bool (*admits)(const E&) = nullptr) {
    const OptionInfo info{.name = name, .sentence = ""};
    const auto parse = [&value, info](const std::string& text) { from_text(info, text, value); };
    const auto check = [info, admits, scratch = value](const std::string& text) mutable {
        const bool known = from_text(info, text, scratch).empty() && (!admits || admits(scratch));
        return known ? ""
                     : "expected one of " + choice_list(", ", admits) + ", found '" + text + "'";
    };
    return app.add_option_function<std::string>(name, parse, help)
        ->type_name(choice_list("|", admits))
        ->default_str(to_text(info, value))
        ->check(CLI::Validator(check, ""));
}

}  // namespace burnish
