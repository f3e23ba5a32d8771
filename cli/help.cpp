#include "cli/help.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <sstream>
#include <vector>

namespace burnish {

namespace {

constexpr std::size_t kColumn = 34, kMinWidth = 60, kMaxWidth = 100;

/// Inheritance is how the parser's library is told.
class PlainFormatter : public CLI::Formatter {
  public:
    explicit PlainFormatter(std::size_t width) : width_(width) { column_width(kColumn); }
    std::string make_subcommand(const CLI::App* command) const override {
        std::string head = "  " + command->get_name() + " ";
        head.resize(std::max(head.size(), kColumn), ' ');
        return head + wrap(command->get_description(), width_ - kColumn, kColumn) + "\n";
    }
    std::string make_option_opts(const CLI::Option* option) const override {
        std::string text;
        if (option->get_type_size() != 0) text = " " + option->get_type_name();
        const char* alone = option->get_expected_min() == 0 ? "alone: " : "";
        if (!option->get_default_str().empty())
            text += " [" + (alone + option->get_default_str()) + "]";
        return option->get_required() ? text + " (required)" : text;
    }

  private:
    std::size_t width_;
};

}  // namespace

std::size_t help_width() {
    winsize size{};
    const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? std::clamp<std::size_t>(size.ws_col, kMinWidth, kMaxWidth) : kMaxWidth;
}

std::string wrap(const std::string& text, std::size_t width, std::size_t indent) {
    std::istringstream words(text);
    std::string wrapped, word;
    std::size_t column = 0;
    while (words >> word) {
        const bool breaks = column > 0 && column + 1 + word.size() > width;
        if (breaks)
            wrapped += "\n" + std::string(indent, ' ');
        else if (column > 0)
            wrapped += ' ';
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

void arrange_help(CLI::App& app, std::size_t width) {
    const auto formatter = std::make_shared<PlainFormatter>(width);
    std::vector<CLI::App*> all = app.get_subcommands([](CLI::App*) { return true; });
    all.push_back(&app);
    for (CLI::App* command : all) {
        command->formatter(formatter);
        command->description(wrap(command->get_description(), width));
        for (CLI::Option* option : command->get_options())
            option->description(wrap(option->get_description(), width - kColumn));
    }
}

}  // namespace burnish
