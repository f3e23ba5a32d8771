#include "cli/optimize_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <algorithm>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/help.h"
#include "cli/option_text.h"
#include "cli/options_file.h"
#include "cli/scene_input.h"
#include "core/positive_float.h"
#include "live/connection.h"
#include "optimize/run_inputs.h"

namespace burnish {

namespace {

// What the built-in goblet gets where nothing else is asked for: about half a minute on two cores.
// Its texture has about as many texels as the picture has pixels.
const Given kDemo[] = {
    {"", {"problem.parameters"}, {"mat-goblet.roughness"}},
    {"", {"scene.size"}, {"256", "256"}},
    {"", {"learning_rate"}, {"0.004"}},
    {"", {"path_cache.samples"}, {"8"}},
    {"", {"monte_carlo.image_samples", "reservoirs.image_samples"}, {"16"}},
};
const Given kDemoStop{"", {"stop.seconds"}, {"20"}};

/// Rows of one flag: those of several estimators share one.
struct Flag {
    Setting first;
    std::vector<std::string> names, defaults;
};

std::vector<Flag> flags() {
    std::vector<Flag> all;
    for (const Setting& s : all_settings()) {
        if (!*s.info.flag) continue;
        auto flag = std::find_if(all.begin(), all.end(), [&](const Flag& f) {
            return std::string_view(f.first.info.flag) == s.info.flag;
        });
        if (flag == all.end()) flag = all.insert(all.end(), {s, {}, {}});
        flag->names.push_back(s.info.name);
        if (std::find(flag->defaults.begin(), flag->defaults.end(), s.default_value) ==
            flag->defaults.end())
            flag->defaults.push_back(s.default_value);
    }
    return all;
}

/// As the messages name it: "--output" of "-o,--output".
std::string label_of(const Flag& flag) {
    const std::string text = flag.first.info.flag;
    return text.substr(text.rfind(',') + 1);
}

/// The defaults, where there are any that say something; of a flag that may have no value what it
/// then means: the parser gives it that one.
std::string default_of(const Flag& flag) {
    if (*flag.first.alone) return flag.first.alone;
    if (*flag.first.info.unset && flag.first.default_value == flag.first.info.unset) return {};
    return fmt::format("{}", fmt::join(flag.defaults, " or "));
}

/// An option file holds what a flag would be refused for: each value fits at least one row.
std::string complaint_of(const std::vector<std::string>& names, const std::string& text) {
    std::string wrong;
    for (const std::string& name : names)
        if (wrong = complaint(name, text); wrong.empty()) return {};
    return wrong;
}

void add_flag(CLI::App& command, const Flag& flag, OptimizeArguments& arguments) {
    const auto give = [&arguments, label = label_of(flag),
                       names = flag.names](const std::vector<std::string>& values) {
        // The parser checks no empty text of a flag that may have no value.
        if (values.empty() || values.front().empty())
            throw UsageError(label + ": " + complaint_of_empty(""));
        arguments.flags.push_back({label, names, values});
    };
    CLI::Option* option = nullptr;
    if (flag.first.is_flag) {
        option = command.add_flag_callback(
            flag.first.info.flag, [give] { give({"true"}); }, flag.first.info.sentence);
    } else {
        option = command.add_option_function<std::vector<std::string>>(flag.first.info.flag, give,
                                                                       flag.first.info.sentence);
        option->type_name(flag.first.placeholder)
            ->default_str(default_of(flag))
            ->check(CLI::Validator(
                [names = flag.names](const std::string& text) { return complaint_of(names, text); },
                ""));
        if (!flag.first.is_list) option->expected(flag.first.is_pair ? 2 : 1);
        if (*flag.first.alone) option->expected(0, 1);
        option->allow_extra_args(false);  // what follows is the scene or another option
    }
    if (flag.first.info.level == OptionLevel::kExpert) option->group(kMoreOptions);
}

/// What --help-all says of the options that have no flag.
std::string set_help() {
    constexpr std::size_t kIndent = 6;
    std::string text = "Set with --set NAME=VALUE or in a file of --options:\n";
    for (const Setting& s : all_settings())
        if (!*s.info.flag)
            text +=
                fmt::format("  {} {} [{}]\n      {}\n", s.info.name, s.placeholder, s.default_value,
                            wrap(s.info.sentence, help_width() - kIndent, kIndent));
    return text;
}

/// One more option in the list would be one too many for --help.
void add_help_all(CLI::App& command) {
    const char* text = "--help-all shows the other options, and what --set takes.";
    command.footer(text);
    command
        .add_flag_callback(
            "--help-all",
            [&command] {
                command.footer(set_help());
                throw CLI::CallForAllHelp();
            },
            "All options")
        ->group(kMoreOptions);
}

Given parse_set(const std::string& text) {
    const auto [name, value] = split_assignment("--set", text);
    Given g{"--set " + name, {name}, {value}};
    bool is_pair = false;
    try {
        is_pair = find_setting(name).is_pair;
    } catch (const InputError& error) {
        throw UsageError(std::string("--set: ") + error.what());
    }
    if (is_pair && !value.empty()) {
        const std::size_t at = value.find_first_of(" x,");
        if (at == std::string::npos)
            throw UsageError(
                fmt::format("{}: expected two values, as 640,480, found '{}'", g.label, value));
        g.values = {value.substr(0, at), value.substr(at + 1)};
    }
    for (const std::string& v : g.values)
        if (const std::string wrong = complaint(name, v); !wrong.empty())
            throw UsageError(g.label + ": " + wrong);
    return g;
}

/// The later ones of a list option join the earlier ones; others replace them.
void add_sets(const std::vector<std::string>& sets, std::vector<Given>& given) {
    std::vector<Given> parsed;
    for (const std::string& text : sets) {
        Given g = parse_set(text);
        const auto same = std::find_if(parsed.begin(), parsed.end(),
                                       [&](const Given& p) { return p.names == g.names; });
        if (find_setting(g.names.front()).is_list && same != parsed.end())
            same->values.push_back(g.values.front());
        else
            parsed.push_back(std::move(g));
    }
    given.insert(given.end(), parsed.begin(), parsed.end());
}

/// Whether a flag says the same as --set NAME. One that estimators share may leave the option of
/// one of them to --set, where that of another has an effect.
bool gives(const Given& flag, const std::string& name, const Settings& settings) {
    if (std::ranges::count(flag.names, name) == 0) return false;
    Given others = flag;
    std::erase(others.names, name);
    return others.names.empty() || !missing_for(others, settings).empty();
}

/// line: flags, the scene and --set.
void require_once(const std::vector<Given>& line, const Settings& settings) {
    const auto is_set = [](const Given& g) { return g.label.starts_with("--set "); };
    for (const Given& set : line)
        for (const Given& flag : line)
            if (is_set(set) && !is_set(flag) && gives(flag, set.names.front(), settings))
                throw UsageError(
                    fmt::format("{} and {} give one option twice", flag.label, set.label));
}

/// Of a run that goes on.
bool may_be_given(const std::string& name) {
    return may_change(name) || name == "run.threads" || name == "run.max_memory" ||
           name == "run.checkpoint_seconds" || name == "run.live";
}

bool is_default(const Given& g) {
    return g.values.back() == find_setting(g.names.front()).default_value;
}

bool names_stop_rule(const Given& g) { return g.names.front().starts_with("stop."); }

/// An option of the command line must have an effect. One of a file may have it in the file alone:
/// the command line may have chosen another estimator since. A default of a file says nothing.
void check_effects(const std::vector<Given>& from_file, const std::vector<Given>& from_line,
                   const Settings& settings) {
    for (const Given& g : from_line)
        if (const std::string needs = missing_for(g, settings); !needs.empty())
            throw UsageError(fmt::format("{} has no effect: it needs {}", g.label, needs));
    const Settings alone = assemble(from_file);
    for (const Given& g : from_file)
        if (const std::string needs = missing_for(g, settings);
            !needs.empty() && !missing_for(g, alone).empty() && !is_default(g))
            throw InputError(fmt::format("{} has no effect: it needs {}", g.label, needs));
}

void require_one_or_each(const char* option, std::size_t count, std::size_t parameters) {
    if (count > 1 && count != parameters)
        throw UsageError(
            fmt::format("{} is given {} times for {}, expected once or once per parameter", option,
                        count, count_text(parameters, "parameter")));
}

/// A scene that follows --live is not taken for one.
void check_address(const std::string& text) {
    try {
        const Address needs_port{"127.0.0.1", ""};
        parse_address(text, needs_port);
    } catch (const InputError& error) {
        throw UsageError(std::string("--live: ") + error.what());
    }
}

void check_run(const Settings& settings) {
    const RunSettings& run = settings.run;
    if (run.parameters.empty())
        throw UsageError("--parameter: expected the name of a texture to recover; `burnish info " +
                         shell_word(run.scene) + "` lists them");
    if (!parse_exposure(run.exposure))
        throw UsageError(fmt::format("--exposure: expected fit, fit_rgb or {}, found '{}'",
                                     kPositiveFloat, run.exposure));
    if (!run.live.empty()) check_address(run.live);
    require_one_or_each("--init", run.starts.size(), run.parameters.size());
    require_one_or_each("--learning-rate", run.learning_rates.size(), run.parameters.size());
    const std::string name = name_of(settings.options.estimator);
    if (run.compare && name_of(*run.compare) == name)
        throw UsageError(fmt::format("--compare {0}: the first run uses {0} already", name));
}

}  // namespace

void take_process(const RunSettings& from, RunSettings& to) {
    to.threads = from.threads, to.max_memory = from.max_memory, to.live = from.live;
    to.checkpoint_seconds = from.checkpoint_seconds;
}

void add_optimize_options(CLI::App& command, OptimizeArguments& arguments) {
    add_text(command, "scene", arguments.scene, "FILE", find_setting("scene.file").info.sentence);
    for (const Flag& flag : flags()) add_flag(command, flag, arguments);
    command.add_option("--set", arguments.sets, "Sets an option by its name; repeatable")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
    add_text(command, "--options", arguments.options_file, "FILE",
             "Options as JSON, e.g. an earlier run's summary.json: repeats it");
    add_text(command, "--resume", arguments.resume, "DIR",
             "Goes on with the run in a folder that was stopped there");
    add_help_all(command);
}

Settings make_settings(const OptimizeArguments& arguments) {
    std::vector<Given> from_file = arguments.options, from_line = arguments.flags;
    if (!arguments.options_file.empty())
        for (Given& g : read_options_file(arguments.options_file))
            from_file.push_back(std::move(g));
    if (!arguments.scene.empty())
        from_line.push_back({"the scene", {"scene.file"}, {arguments.scene}});
    add_sets(arguments.sets, from_line);
    std::vector<Given> given = from_file;
    given.insert(given.end(), from_line.begin(), from_line.end());
    if (assemble(given).run.scene.empty()) {
        if (std::none_of(given.begin(), given.end(), names_stop_rule))
            given.insert(given.begin(), kDemoStop);
        given.insert(given.begin(), std::begin(kDemo), std::end(kDemo));
    }
    Settings settings = assemble(given);
    require_once(from_line, settings);
    check_run(settings);
    check_effects(from_file, from_line, settings);
    if (settings.run.starts.empty()) settings.run.starts = {"search"};
    if (std::none_of(given.begin(), given.end(),
                     [](const Given& g) { return g.names.front() == "run.output"; }))
        log_info("results go to ./" + settings.run.output + " (-o names another folder)");
    return settings;
}

std::vector<Given> changes_of(const OptimizeArguments& arguments) {
    std::vector<Given> line = arguments.flags;
    add_sets(arguments.sets, line);
    if (!arguments.scene.empty() || !arguments.options_file.empty())
        throw UsageError("--resume: the run has its scene and options: expected none beside it");
    for (const Given& g : line)
        if (!may_be_given(g.names.front()))
            throw UsageError(fmt::format(
                "{}: --resume goes on with the run's own options: expected beside it --iterations, "
                "--time, --patience, --evaluation-spp, --threads, --max-memory, --live "
                "or --checkpoint-every alone",
                g.label));
    return line;
}

Settings resumed_settings(const std::string& folder, const std::string& recorded,
                          const std::vector<Given>& changes) {
    std::vector<Given> given = read_options_text(recorded, "the checkpoint");
    given.insert(given.end(), changes.begin(), changes.end());
    Settings settings = assemble(given);
    require_once(changes, settings);
    settings.run.output = folder;
    if (!settings.run.live.empty()) check_address(settings.run.live);
    return settings;
}

}  // namespace burnish
