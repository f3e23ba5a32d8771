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

/// Line breaks between words so that no line exceeds the width.
std::string wrap(const std::string& text) {
    std::istringstream words(text);
    std::string wrapped, word;
    std::size_t line = 0;
    while (words >> word) {
        if (line > 0 && line + 1 + word.size() > kHelpWidth - kColumn) {
            wrapped += '\n';
            line = 0;
        }
        if (line > 0) wrapped += ' ';
        wrapped += word;
        line += word.size() + (line > 0 ? 1 : 0);
    }
    return wrapped;
}

}  // namespace

void arrange_help(CLI::App& app) {
    const auto formatter = std::make_shared<PlainFormatter>();
    formatter->column_width(kColumn);
    app.formatter(formatter);
    for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
        command->formatter(formatter);
        for (CLI::Option* option : command->get_options())
            option->description(wrap(option->get_description()));
    }
}

}  // namespace burnish
