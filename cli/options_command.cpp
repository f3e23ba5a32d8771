// burnish options: the options of `optimize` as a page of the reference. Hidden: for the project.

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <algorithm>

#include "cli/commands.h"
#include "cli/failures.h"
#include "cli/help.h"
#include "cli/settings.h"

namespace burnish {

namespace {

constexpr std::size_t kPageWidth = 120;

constexpr const char* kHead = R"(# Options of `burnish optimize`

This page is printed by `burnish options --markdown`.

Every option has a dotted name. `--set NAME=VALUE` sets it, `--options FILE.json` reads several from a file
(`{"path_cache": {"window": 8}, "stop.iterations": 100}`), and options that are used most have a flag of their own.
Later settings win: defaults, then the file, then the command line; of two `--set` of one option the later, but those of
an option that is repeatable are taken together, in the place of the file's. Two values are written with a comma,
`--set scene.size=640,480`, in a file as an array. A flag and `--set` of one option are an error, and so is an option
that the others rule out; one of a file need only have an effect in the file, so that `--estimator mc` beside it drops
what it says of another estimator. A `summary.json` can be given as the file: it holds the settings that repeat its run
to the byte.

In C++, `burnish::Options` has the fields of the same names; the `scene`, `problem` and `run` groups belong to the
command line.
)";

/// Markdown takes <name> for HTML.
std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '<' ? std::string("\\<") : std::string(1, c);
    return result;
}

std::string group_of(const Setting& s) {
    const std::string name = s.info.name;
    const std::size_t dot = name.find('.');
    return dot == std::string::npos ? "General" : "`" + name.substr(0, dot) + "`";
}

/// What its values are; empty of any text.
std::string takes_text(const Setting& s) {
    if (s.expected != "a text")
        return fmt::format(" Takes {}{}{}.", s.is_pair ? "two values, each " : "", s.expected,
                           *s.info.unit ? fmt::format(", in {}", s.info.unit) : "");
    return s.placeholder == "TEXT" ? "" : fmt::format(" Takes `{}`.", s.placeholder);
}

std::string entry(const Setting& s) {
    std::string text = fmt::format("- **`{}`**", s.info.name);
    if (*s.info.flag) text += fmt::format(" (`{}`)", s.info.flag);
    text += fmt::format(": {}.", escaped(s.info.sentence));
    text += takes_text(s);
    if (!s.default_value.empty()) text += fmt::format(" Default: `{}`.", s.default_value);
    if (!s.needs.empty()) text += fmt::format(" Needs {}.", s.needs);
    return wrap(text, kPageWidth) + "\n";
}

void print_markdown() {
    std::string page = kHead;
    std::vector<std::string> groups;
    for (const Setting& s : all_settings())
        if (std::find(groups.begin(), groups.end(), group_of(s)) == groups.end())
            groups.push_back(group_of(s));
    for (const std::string& group : groups) {
        page += fmt::format("\n## {}\n\n", group);
        for (const Setting& s : all_settings())
            if (group_of(s) == group) page += entry(s);
    }
    print(page);
}

}  // namespace

void add_options_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("options", "Prints the options of optimize");
    command->group("");
    auto markdown = std::make_shared<bool>(false);
    command->add_flag("--markdown", *markdown, "A page of the reference")->required();
    command->callback([markdown] { print_markdown(); });
}

}  // namespace burnish
