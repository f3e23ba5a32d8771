#include "cli/help.h"

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>
#include <sstream>

namespace burnish {

namespace {

constexpr std::size_t kColumn = 34, kHelpWidth = 100;

/// Inheritance is how the parser's library is told.
class PlainFormatter : public CLI::Formatter {
  public:
    std::string make_option_opts(const CLI::Option* option) const override {
        std::string text;
        if (option->get_type_size() != 0) text = " " + option->get_type_name();
        if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
        return option->get_required() ? text + " (required)" : text;
    }
};

}  // namespace

std::string wrap(const std::string& text, std::size_t width) {
    std::istringstream words(text);
    std::string wrapped, word;
    std::size_t column = 0;
    while (words >> word) {
        const bool breaks = column > 0 && column + 1 + word.size() > width;
        if (column > 0) wrapped += breaks ? '\n' : ' ';
        column = breaks ? word.size() : column + (column > 0) + word.size();
        wrapped += word;
    }
    return wrapped;
}

std::string help_text(CLI::App& app, const CLI::Success& asked) {
    const bool all = asked.get_name() == "CallForAllHelp";
    for (CLI::App* command : app.get_subcommands())
        for (CLI::Option* option : command->get_options())
            if (option->get_group() == kMoreOptions && (!all || option->get_description().empty()))
                option->group("");  // hidden; while the parser reads, it would have no name
    std::ostringstream text;
    app.exit(asked, text, text);
    return text.str();
}

void arrange_help(CLI::App& app) {
    const auto formatter = std::make_shared<PlainFormatter>();
    formatter->column_width(kColumn);
    app.formatter(formatter);
    for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
        command->formatter(formatter);
        for (CLI::Option* option : command->get_options())
            option->description(wrap(option->get_description(), kHelpWidth - kColumn));
    }
}

}  // namespace burnish
