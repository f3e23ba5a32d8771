#include "cli/usage_text.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <string_view>

#include "core/lower_case.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

/// The command that was named, or the program, where none was.
const CLI::App& chosen(const CLI::App& app) {
    const std::vector<CLI::App*> named = app.get_subcommands();
    return named.empty() ? app : *named.front();
}

bool is_option(const std::string& name) { return name.starts_with('-'); }

/// The commands, where there are any and no option was meant; otherwise the options.
std::vector<std::string> known_names(const CLI::App& command, const std::string& meant) {
    std::vector<std::string> known;
    if (!is_option(meant))
        for (const CLI::App* other : commands_of(command)) known.push_back(other->get_name());
    if (!known.empty()) return known;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    return known;
}

/// Whether an option of the command that was named stands before it.
bool stands_before_command(const CLI::App& app, const std::string& name) {
    const CLI::App& command = chosen(app);
    return &command != &app && !app.remaining(false).empty() && is_option(name) &&
           command.get_option_no_throw(name) != nullptr;
}

/// The first argument that is not known, and what may have been meant.
std::string unexpected_text(const CLI::App& app) {
    const std::vector<std::string> extras = app.remaining(true);
    if (extras.empty()) return "an argument is not known";
    const std::string name = extras.front().substr(0, extras.front().find('='));
    if (stands_before_command(app, name))
        return fmt::format("{}: found before the command, expected behind `{}`", name,
                           command_path(app));
    const CLI::App& command = chosen(app);
    const char* kind = "argument";
    if (is_option(name))
        kind = "option";
    else if (!commands_of(command).empty())
        kind = "command";
    const std::string nearest = nearest_name(name, known_names(command, name));
    return fmt::format("'{}' is no {} of {}{}", name, kind, command_path(app),
                       nearest.empty() ? "" : ": did you mean " + nearest + "?");
}

/// Of an option with too few or too many values.
std::string mismatch_text(const CLI::App& app, const std::string& text) {
    const std::string name = text.substr(0, text.find(':'));
    const CLI::Option* option = chosen(app).get_option_no_throw(name);
    if (!option) return text;
    const int count = option->get_expected_min();
    if (option->count() > static_cast<std::size_t>(option->get_items_expected_max()))
        return fmt::format("{}: found {} values, expected {}, {}", name, option->count(), count,
                           option->get_type_name());
    return fmt::format("{}: expected {} value{}, {}", name, count, count == 1 ? "" : "s",
                       option->get_type_name());
}

/// Of the first argument that is missing, otherwise of the first option: as the help names it, with
/// what it is.
std::string required_text(const CLI::App& app, const std::string& text) {
    const auto missing = chosen(app).get_options(
        [](const CLI::Option* o) { return o->get_required() && o->count() == 0; });
    if (missing.empty()) return text;
    const auto has_flag = [](const CLI::Option* o) { return !o->get_lnames().empty(); };
    const auto argument = std::ranges::find_if_not(missing, has_flag);
    const CLI::Option* first = argument == missing.end() ? missing.front() : *argument;
    std::string what = first->get_description();
    what.resize(std::min(what.size(), what.find(';')));
    if (what.size() > 1 && what[1] != ':') what[0] = lower_case(what[0]);
    return fmt::format(
        "{}: expected {}",
        has_flag(first) ? "--" + first->get_lnames().front() : first->get_type_name(), what);
}

/// Of an option that has an effect beside another one alone: "--images requires --views".
std::string needs_text(const std::string& text) {
    constexpr std::string_view kRequires = " requires ";
    const std::size_t at = text.find(kRequires);
    if (at == std::string::npos) return text;
    return fmt::format("{} has no effect: it needs {}", text.substr(0, at),
                       text.substr(at + kRequires.size()));
}

}  // namespace

std::string command_path(const CLI::App& app) {
    const CLI::App& command = chosen(app);
    return &command == &app ? app.get_name() : app.get_name() + " " + command.get_name();
}

bool has_help_all(const CLI::App& app) {
    return chosen(app).get_option_no_throw("--help-all") != nullptr;
}

std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) return unexpected_text(app);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return mismatch_text(app, error.what());
    if (dynamic_cast<const CLI::RequiredError*>(&error)) return required_text(app, error.what());
    if (dynamic_cast<const CLI::RequiresError*>(&error)) return needs_text(error.what());
    return error.what();
}

}  // namespace burnish
