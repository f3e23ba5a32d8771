// The command line does what the API does: every option, through flags, --set and files.
#include "cli/settings.h"

#include <gtest/gtest.h>

#include <CLI/App.hpp>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/optimize_options.h"
#include "cli/options_file.h"
#include "error_of.h"
#include "temporary_folder.h"

namespace burnish {
namespace {

/// What the program makes of a whole line.
Settings parse_line(std::vector<std::string> arguments) {
    CLI::App app;
    OptimizeArguments parsed;
    add_optimize_options(app, parsed);
    std::reverse(arguments.begin(), arguments.end());
    app.parse(arguments);
    return make_settings(parsed);
}

/// What the program makes of arguments.
Settings parse(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"scene.xml", "--parameter", "a", "-o", "out"});
    return parse_line(std::move(arguments));
}

template <class E>
E& as(Options& o) {
    return std::get<E>(o.estimator);
}

/// An option, a value that is not its default, what it needs, and the same in C++.
struct Case {
    const char* name;
    const char* value;
    void (*set)(Options&);
    std::vector<std::string> before = {};
    Estimator estimator = PathCache{};
};

const std::vector<std::string> kMc{"--estimator", "mc"}, kPgris{"--estimator", "pgris"};

std::vector<Case> cases() {
    const Estimator mc = MonteCarlo{}, pgris = Reservoirs{};
    return {
        {"estimator", "mc", [](Options& o) { o.estimator = MonteCarlo{}; }},
        {"path_cache.samples", "7", [](Options& o) { as<PathCache>(o).samples = 7; }},
        {"path_cache.window", "5", [](Options& o) { as<PathCache>(o).window = 5; }},
        {"path_cache.sequence", "independent",
         [](Options& o) { as<PathCache>(o).sequence = Sequence::kIndependent; }},
        {"path_cache.max_bytes", "12345678901",
         [](Options& o) { as<PathCache>(o).max_bytes = 12345678901; }},
        {"monte_carlo.image_samples", "6", [](Options& o) { as<MonteCarlo>(o).image_samples = 6; },
         kMc, mc},
        {"monte_carlo.image_window", "6", [](Options& o) { as<MonteCarlo>(o).image_window = 6; },
         kMc, mc},
        {"monte_carlo.samples", "3", [](Options& o) { as<MonteCarlo>(o).samples = 3; }, kMc, mc},
        {"monte_carlo.adaptive_sampling", "false",
         [](Options& o) { as<MonteCarlo>(o).adaptive_sampling = false; }, kMc, mc},
        {"reservoirs.image_samples", "6", [](Options& o) { as<Reservoirs>(o).image_samples = 6; },
         kPgris, pgris},
        {"reservoirs.image_window", "6", [](Options& o) { as<Reservoirs>(o).image_window = 6; },
         kPgris, pgris},
        {"reservoirs.samples", "3", [](Options& o) { as<Reservoirs>(o).samples = 3; }, kPgris,
         pgris},
        {"reservoirs.adaptive_sampling", "false",
         [](Options& o) { as<Reservoirs>(o).adaptive_sampling = false; }, kPgris, pgris},
        {"reservoirs.target_function", "integrand",
         [](Options& o) { as<Reservoirs>(o).target_function = TargetFunction::kIntegrand; }, kPgris,
         pgris},
        {"reservoirs.shift", "identity",
         [](Options& o) { as<Reservoirs>(o).shift = Shift::kIdentity; }, kPgris, pgris},
        {"reservoirs.merge", "defensive",
         [](Options& o) { as<Reservoirs>(o).merge = MergeRule::kDefensive; }, kPgris, pgris},
        {"reservoirs.confidence_cap", "0.1",
         [](Options& o) { as<Reservoirs>(o).confidence_cap = 0.1f; }, kPgris, pgris},
        {"loss", "l2", [](Options& o) { o.loss = Loss::kL2; }},
        {"learning_rate", "0.03", [](Options& o) { o.learning_rate = 0.03; }},
        {"adam.beta1", "0.7", [](Options& o) { o.adam.beta1 = 0.7f; }},
        {"adam.beta2", "0.97", [](Options& o) { o.adam.beta2 = 0.97f; }},
        {"adam.gate", "false", [](Options& o) { o.adam.gate = false; }},
        {"adam.initial_rate", "0.3", [](Options& o) { o.adam.initial_rate = 0.3f; }},
        {"parameterization", "texels",
         [](Options& o) { o.parameterization = Parameterization::kTexels; }},
        {"pyramid.levels", "3", [](Options& o) { o.pyramid.levels = 3; }},
        {"pyramid.weight_decay", "0.7", [](Options& o) { o.pyramid.weight_decay = 0.7f; }},
        {"unvisited", "keep", [](Options& o) { o.unvisited = Unvisited::kKeep; }},
        {"search_again", "30", [](Options& o) { o.search_again = 30; }},
        {"search_effort", "2.5", [](Options& o) { o.search_effort = 2.5; }},
        {"background_samples", "64", [](Options& o) { o.background_samples = 64; }},
        {"batch", "5", [](Options& o) { o.batch = 5; }, {"--views", "transforms.json"}},
        {"seed", "4294967295", [](Options& o) { o.seed = 4294967295u; }},
        {"stop.iterations", "17", [](Options& o) { o.stop.iterations = 17; }},
        {"stop.seconds", "1.7", [](Options& o) { o.stop.seconds = 1.7; }},
        {"stop.patience", "3", [](Options& o) { o.stop.patience = 3; }},
        {"evaluation_samples", "9", [](Options& o) { o.evaluation_samples = 9; }},
    };
}

/// An option of the run, values that are not its default, what it needs, and the same in C++.
struct RunCase {
    std::string name;
    std::vector<std::string> values;
    void (*set)(RunSettings&);
    std::vector<std::string> before = {};
};

std::vector<RunCase> run_cases() {
    using R = RunSettings;
    using Texts = std::vector<std::string>;
    const Texts two_parameters{"--parameter", "b"}, views{"--views", "transforms.json"},
        compare{"--compare", "mc"};
    return {
        {"scene.file", {"a.xml"}, [](R& r) { r.scene = "a.xml"; }},
        {"scene.definitions",
         {"light=12", "x=a b"},
         [](R& r) {
             r.definitions = {"light=12", "x=a b"};
         }},
        {"scene.size",
         {"40", "30"},
         [](R& r) {
             r.size = {40, 30};
         }},
        {"scene.ignore_unsupported", {"true"}, [](R& r) { r.ignore_unsupported = true; }},
        {"scene.light_selection",
         {"tree"},
         [](R& r) { r.light_selection = LightSelection::kTree; }},
        {"problem.parameters",
         {"b@0.2", "c:8"},
         [](R& r) {
             r.parameters = {"b@0.2", "c:8"};
         }},
        {"problem.target",
         {"t.exr", "u.exr"},
         [](R& r) {
             r.targets = {"t.exr", "u.exr"};
         }},
        {"problem.sensors",
         {"0", "1"},
         [](R& r) {
             r.sensors = {"0", "1"};
         }},
        {"problem.views", {"transforms.json"}, [](R& r) { r.views = "transforms.json"; }},
        {"problem.images", {"pictures"}, [](R& r) { r.images = "pictures"; }, views},
        {"problem.target_samples", {"8"}, [](R& r) { r.target_samples = 8; }},
        {"problem.mask", {"m.png"}, [](R& r) { r.mask = "m.png"; }},
        {"problem.ignore_background", {"true"}, [](R& r) { r.ignore_background = true; }},
        {"problem.held_out",
         {"x", "y"},
         [](R& r) {
             r.held_out = {"x", "y"};
         }},
        {"problem.exposure", {"fit_rgb"}, [](R& r) { r.exposure = "fit_rgb"; }},
        {"problem.scale", {"0.3"}, [](R& r) { r.scale = 0.3; }},
        {"problem.initial_values",
         {"0.25", "scene"},
         [](R& r) {
             r.starts = {"0.25", "scene"};
         },
         two_parameters},
        {"problem.learning_rates",
         {"0.1", "0.02"},
         [](R& r) {
             r.learning_rates = {0.1, 0.02};
         },
         two_parameters},
        {"run.compare", {"mc"}, [](R& r) { r.compare = MonteCarlo{}; }},
        {"run.compare_iterations", {"4"}, [](R& r) { r.compare_iterations = 4; }, compare},
        {"run.max_memory", {"2.5"}, [](R& r) { r.max_memory = 2.5; }},
        {"run.threads", {"3"}, [](R& r) { r.threads = 3; }},
        {"run.output", {"elsewhere"}, [](R& r) { r.output = "elsewhere"; }},
        {"run.force", {"true"}, [](R& r) { r.force = true; }},
        {"run.checkpoint_seconds", {"7.5"}, [](R& r) { r.checkpoint_seconds = 7.5; }},
        {"run.live", {"127.0.0.1:9"}, [](R& r) { r.live = "127.0.0.1:9"; }},
    };
}

const RunRow& run_row(const std::string& name) {
    return *std::ranges::find(run_table(), name, [](const RunRow& r) { return r.info.name; });
}

RunSettings in_cpp(const RunCase& c) {
    RunSettings run = parse(c.before).run;
    c.set(run);
    return run;
}

/// The arguments with what the case needs, and with what every run needs that they do not give.
Settings parse(const RunCase& c, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), c.before.begin(), c.before.end());
    if (c.name != "scene.file") arguments.push_back("scene.xml");
    if (c.name != "problem.parameters") arguments.insert(arguments.end(), {"--parameter", "a"});
    if (c.name != "run.output") arguments.insert(arguments.end(), {"-o", "out"});
    return parse_line(std::move(arguments));
}

std::vector<std::string> sets_of(const RunCase& c) {
    if (find_setting(c.name).is_pair)
        return {"--set", c.name + "=" + c.values[0] + "," + c.values[1]};
    std::vector<std::string> sets;
    for (const std::string& value : c.values)
        sets.insert(sets.end(), {"--set", c.name + "=" + value});
    return sets;
}

Options in_cpp(const Case& c) {
    Options options;
    options.estimator = c.estimator;
    c.set(options);
    return options;
}

std::vector<std::string> with(std::vector<std::string> arguments,
                              const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(Settings, EveryOptionIsTested) {
    std::set<std::string> tested, all;
    for (const Case& c : cases()) tested.insert(c.name);
    for (const OptionRow& row : option_table()) all.insert(row.info.name);
    EXPECT_EQ(tested, all);
    tested.clear(), all.clear();
    for (const RunCase& c : run_cases()) tested.insert(c.name);
    for (const RunRow& row : run_table()) all.insert(row.info.name);
    EXPECT_EQ(tested, all);
}

TEST(Settings, SetDoesWhatTheApiDoes) {
    EXPECT_EQ(parse({}).options, Options{});
    for (const Case& c : cases()) {
        const Options options =
            parse(with(c.before, {"--set", std::string(c.name) + "=" + c.value})).options;
        EXPECT_EQ(options, in_cpp(c)) << c.name;
        EXPECT_NE(options, parse(c.before).options) << c.name << " changes nothing";
    }
}

TEST(Settings, FlagsDoWhatTheApiDoes) {
    std::size_t flags = 0;
    for (const Case& c : cases()) {
        const std::string flag = find_option(c.name)->info.flag;
        if (flag.empty()) continue;
        ++flags;
        EXPECT_EQ(parse(with(c.before, {flag, c.value})).options, in_cpp(c)) << flag;
    }
    EXPECT_EQ(flags, 12u);
}

TEST(Settings, SetTakesWhatARunTakes) {
    for (const RunCase& c : run_cases()) {
        EXPECT_EQ(parse(c, sets_of(c)).run, in_cpp(c)) << c.name;
        EXPECT_NE(in_cpp(c), parse(c.before).run) << c.name << " changes nothing";
    }
}

TEST(Settings, FlagsTakeWhatARunTakes) {
    std::size_t flags = 0;
    for (const RunCase& c : run_cases()) {
        const Setting& setting = find_setting(c.name);
        const std::string names = setting.info.flag, flag = names.substr(names.rfind(',') + 1);
        if (flag.empty()) continue;
        ++flags;
        std::vector<std::string> arguments;
        for (const std::string& value : c.values) {
            if (arguments.empty() || setting.is_list) arguments.push_back(flag);
            if (!setting.is_flag) arguments.push_back(value);
        }
        EXPECT_EQ(parse(c, arguments).run, in_cpp(c)) << flag;
    }
    EXPECT_EQ(flags, 23u);
}

TEST(Settings, ValuesSurviveTheirText) {
    for (const Case& c : cases()) {
        const OptionRow& row = *find_option(c.name);
        EXPECT_EQ(get_option(row, in_cpp(c)), c.value);
        for (const float x : {0.1f, 1.0f / 3, 0.9999989f, 1e-7f}) {
            Options options = in_cpp(c), again = options;
            if (c.name != std::string("adam.beta1")) continue;
            options.adam.beta1 = x;
            set_option(row, get_option(row, options), again);
            EXPECT_EQ(options, again) << x;
        }
    }
}

struct OptionsFile : ::testing::Test {
    void write(const std::string& text) const { std::ofstream(file) << text; }

    test::TemporaryFolder folder;
    std::string file = (folder.path / "options.json").string();
};

TEST_F(OptionsFile, JsonRoundTripsEveryOption) {
    for (const Case& c : cases()) {
        const Settings settings =
            parse(with(c.before, {"--set", std::string(c.name) + "=" + c.value}));
        write(settings_json(settings).dump());
        EXPECT_EQ(parse({"--options", file}).options, in_cpp(c)) << c.name;
    }
}

TEST_F(OptionsFile, JsonRoundTripsWhatRepeatsARun) {
    for (const RunCase& c : run_cases()) {
        const nlohmann::json json = settings_json(parse(c, sets_of(c)));
        const std::size_t dot = c.name.find('.');
        const bool recorded = json[c.name.substr(0, dot)].contains(c.name.substr(dot + 1));
        EXPECT_EQ(recorded, run_row(c.name).recorded) << c.name << json;
        if (!recorded) continue;
        write(json.dump());
        EXPECT_EQ(parse_line({"--options", file, "-o", "out"}).run, in_cpp(c)) << c.name;
    }
}

TEST_F(OptionsFile, JsonRoundTripsTheProblem) {
    const Settings a = parse({"-D",
                              "light=12",
                              "-D",
                              "x=a b",
                              "--size",
                              "40",
                              "30",
                              "--set",
                              "scene.light_selection=tree",
                              "--parameter",
                              "b@0.2",
                              "--mask",
                              "m.png",
                              "--init",
                              "0.25",
                              "--init",
                              "scene",
                              "--target-spp",
                              "8",
                              "--compare",
                              "pris",
                              "--set",
                              "run.compare_iterations=4",
                              "--set",
                              "reservoirs.samples=2",
                              "--max-memory",
                              "2.5"});
    write(settings_json(a).dump());
    CLI::App app;
    OptimizeArguments arguments;
    add_optimize_options(app, arguments);
    app.parse(std::vector<std::string>{"out", "-o", file, "--options"});
    const Settings b = make_settings(arguments);
    EXPECT_EQ(a.options, b.options);
    EXPECT_EQ(a.compared, b.compared);
    EXPECT_EQ(settings_json(a), settings_json(b));
    EXPECT_EQ(b.run.scene, "scene.xml");
    EXPECT_EQ(b.run.definitions, (std::vector<std::string>{"light=12", "x=a b"}));
    EXPECT_EQ(b.run.size, (std::vector<int>{40, 30}));
    EXPECT_EQ(b.run.light_selection, LightSelection::kTree);
    EXPECT_EQ(b.run.parameters, (std::vector<std::string>{"b@0.2", "a"}));
    EXPECT_EQ(b.run.starts, (std::vector<std::string>{"0.25", "scene"}));
    EXPECT_EQ(b.run.mask, "m.png");
    EXPECT_EQ(b.run.target_samples, 8u);
    EXPECT_EQ(b.run.compare_iterations, 4u);
    EXPECT_EQ(b.run.max_memory, 2.5);
    ASSERT_TRUE(b.compared);
    EXPECT_EQ(std::get<Reservoirs>(b.compared->estimator).samples, 2u);
    EXPECT_FALSE(std::get<Reservoirs>(b.compared->estimator).reuse);
}

TEST_F(OptionsFile, LaterSettingsWin) {
    write(R"({"path_cache": {"window": 8, "samples": 2}, "stop.iterations": 5})");
    const Settings s = parse({"--options", file, "--set", "path_cache.window=9"});
    EXPECT_EQ(std::get<PathCache>(s.options.estimator).window, 9u);
    EXPECT_EQ(std::get<PathCache>(s.options.estimator).samples, 2u);
    EXPECT_EQ(s.options.stop.iterations, 5u);
    EXPECT_EQ(parse({"--options", file, "--estimator", "mc"}).options.estimator,
              Estimator{MonteCarlo{}})
        << "what the file says of the path cache went with it";
}

TEST_F(OptionsFile, DefaultsWithoutEffectAreNoError) {
    write(R"({"search_again": 0, "batch": 1, "problem.initial_values": ["0.5"]})");
    EXPECT_EQ(parse({"--options", file}).options, Options{});
    write(R"({"search_again": 5, "problem.initial_values": ["0.5"]})");
    EXPECT_THROW(parse({"--options", file}), InputError);
}

TEST_F(OptionsFile, BadFilesAreNamed) {
    std::string deep;
    for (int i = 0; i < 100000; ++i) deep += "{\"a\":";
    const std::pair<const char*, const char*> kBad[] = {
        {"{", "byte 2: found no JSON, expected names of options"},
        {"{\"seed\": 1,, }", "byte 12: found no JSON"},
        {"{\"seed\": 1e999}", "found a number that is too large to be stored"},
        {"{\"seed\": 1, \"seed\": 2}", "the key \"seed\" stands twice"},
        {deep.c_str(), "found values 65 deep, expected names of options"},
        {"[1]", "expected a JSON object"},
        {R"({"path_cache": {"windw": 8}})", "no option 'path_cache.windw', did you mean"},
        {R"({"path_cache.window": 0})", "expected a whole number from 1 to 1048576, found '0'"},
        {R"({"loss": null})", "found null"},
        {R"({"problem": {"mask": ""}})", "problem.mask: found an empty text, expected a value"},
        {R"({"problem.target": [""]})", "problem.target: found an empty text"},
        {R"({"seed": [1, 2]})", "seed: expected one value, found 2"},
        {R"({"estimator": ["mc", "gris"]})", "estimator: expected one value, found 2"},
        {R"({"scene.size": 8})", "scene.size: expected two values, found 1"},
        {R"({"scene.size": [8, 8, 8]})", "scene.size: expected two values, found 3"},
        {R"({"reservoirs.shift": "identity"})", "reservoirs.shift has no effect: it needs"},
    };
    for (const auto& [text, message] : kBad) {
        write(text);
        try {
            parse({"--options", file});
            ADD_FAILURE() << text;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
        }
    }
}

/// The message of the UsageError that the arguments cause.
std::string usage_error(const std::vector<std::string>& arguments) {
    return test::error_of<UsageError>([&] { parse(arguments); });
}

TEST(Settings, AFlagAndSetDoNotGiveOneOption) {
    EXPECT_EQ(usage_error({"--seed", "2", "--set", "seed=1"}),
              "--seed and --set seed give one option twice");
    EXPECT_EQ(usage_error({"--set", "scene.file=other.xml"}),
              "the scene and --set scene.file give one option twice");
    EXPECT_EQ(usage_error({"--set", "problem.parameters=b"}),
              "--parameter and --set problem.parameters give one option twice");
    const std::vector<std::string> both{"--spp", "2", "--set", "path_cache.samples=3"};
    EXPECT_EQ(usage_error(both), "--spp and --set path_cache.samples give one option twice");
    const Settings compared = parse(with(both, {"--compare", "mc"}));
    EXPECT_EQ(std::get<PathCache>(compared.options.estimator).samples, 3u);
    EXPECT_EQ(std::get<MonteCarlo>(compared.compared->estimator).image_samples, 2u);
    EXPECT_EQ(parse({"--set", "seed=1", "--set", "seed=2"}).options.seed, 2u);
}

TEST(Settings, TheDemoHasDefaultsOfItsOwn) {
    const auto parse_demo = [](std::vector<std::string> arguments) {
        return parse_line(with(std::move(arguments), {"-o", "out"}));
    };
    const RunSettings run = parse_demo({}).run;
    EXPECT_EQ(run.scene, "");
    EXPECT_EQ(run.parameters, (std::vector<std::string>{"mat-goblet.roughness"}));
    EXPECT_EQ(run.size, (std::vector<int>{256, 256}));
    Options expected{.estimator = PathCache{.samples = 8}, .learning_rate = 0.004};
    expected.stop.seconds = 20;
    EXPECT_EQ(parse_demo({}).options, expected);
    expected.estimator = MonteCarlo{.image_samples = 16};
    EXPECT_EQ(parse_demo(kMc).options, expected);
    expected.estimator = Reservoirs{.image_samples = 16};
    EXPECT_EQ(parse_demo(kPgris).options, expected);
    const Stop rule = parse_demo({"--iterations", "1"}).options.stop;
    EXPECT_EQ(rule, Stop{.iterations = 1}) << "and no seconds";
}

TEST(Settings, AnEmptyTextIsNoValue) {
    for (const Setting& s : all_settings()) {
        const std::string name = s.info.name;
        EXPECT_EQ(usage_error({"--set", name + "="}),
                  "--set " + name + ": found an empty text, expected a value");
    }
    EXPECT_EQ(parse({"--set", "problem.mask=none"}).run.mask, "");
    EXPECT_EQ(parse({"--live", "--seed", "1"}).run.live, "127.0.0.1:14158");
    EXPECT_EQ(usage_error({"--live", ""}), "--live: found an empty text, expected a value");
}

TEST(Settings, ALearningRateNeedsAParameterWithoutOne) {
    OptimizeArguments arguments;
    CLI::App app;
    add_optimize_options(app, arguments);
    app.parse(
        std::vector<std::string>{"0.2", "--learning-rate", "a@0.1", "--parameter", "scene.xml"});
    EXPECT_THROW(make_settings(arguments), UsageError);
}

TEST(Settings, AnOptionWithoutEffectIsAnError) {
    const std::vector<std::string> kRis{"--estimator", "ris"},
        kTexels{"--set", "parameterization=texels"};
    for (const Case& c : cases()) {
        const std::vector<std::string> set{"--set", std::string(c.name) + "=" + c.value};
        const std::string name = c.name;
        std::vector<std::vector<std::string>> bases;
        if (name.starts_with("path_cache.")) bases = {kMc, kPgris};
        if (name.starts_with("monte_carlo.")) bases = {{}, kPgris};
        if (name.starts_with("reservoirs.")) bases = {{}, kMc};
        if (name.starts_with("pyramid.")) bases = {kTexels};
        if (name == "adam.gate") bases = {kMc, kPgris};
        if (name == "pyramid.weight_decay") bases = {kTexels, {"--set", "pyramid.levels=1"}};
        if (name == "reservoirs.shift" || name == "reservoirs.merge" ||
            name == "reservoirs.confidence_cap")
            bases.push_back(kRis);
        if (name == "learning_rate") bases = {{"--learning-rate", "0.1"}};
        if (name.starts_with("search_")) bases = {{"--init", "0.5"}, {"--init", "scene"}};
        if (name == "unvisited") bases = {{"--init", "scene"}, {"--init", "start.exr"}};
        if (name == "batch") bases = {{"--target", "t.exr"}, {"--sensor", "1"}};
        EXPECT_EQ(usage_error(with(c.before, set)), "") << name;
        EXPECT_EQ(find_setting(name).needs.empty(), bases.empty()) << name;
        for (const auto& base : bases) {
            const std::string message = usage_error(with(base, set));
            EXPECT_TRUE(message.starts_with("--set " + name + " has no effect: it needs "))
                << name << ": " << message;
        }
    }
    EXPECT_NE(usage_error({"--gradient-spp", "2"}).find("--gradient-spp has no effect"),
              std::string::npos);
    EXPECT_NE(usage_error({"--target", "t.exr", "--target-spp", "2"}).find("--target-spp has no"),
              std::string::npos);
    EXPECT_NE(usage_error({"--set", "run.compare_iterations=2"}).find("has no effect"),
              std::string::npos);
    EXPECT_EQ(usage_error({"--gradient-spp", "2", "--compare", "mc"}), "");
    EXPECT_EQ(usage_error({"--parameter", "b@0.1", "--learning-rate", "0.2"}), "");
}

}  // namespace
}  // namespace burnish
