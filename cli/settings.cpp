#include "cli/settings.h"

#include <algorithm>

#include "burnish/error.h"
#include "cli/capture.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

constexpr OptionLevel kBasic = OptionLevel::kBasic;
constexpr Range kPositive{0, 1e6, false, true};

bool renders_target(const RunSettings& s) { return s.targets.empty() && s.views.empty(); }
bool has_views(const RunSettings& s) { return !s.views.empty(); }
bool has_no_capture(const RunSettings& s) { return !is_capture(s.scene); }
bool compares(const RunSettings& s) { return s.compare.has_value(); }

constexpr RunRow kTable[] = {
    {.info = {.name = "scene.file",
              .sentence = "A Mitsuba 3 XML file, or a capture.json; without one a built-in demo",
              .unit = "FILE",
              .unset = "none"},
     .field = &RunSettings::scene},
    {.info = {.name = "scene.definitions",
              .flag = "-D",
              .level = kBasic,
              .sentence = "Sets a <default> of the scene file; repeatable",
              .unit = "NAME=VALUE"},
     .field = &RunSettings::definitions},
    {.info = {.name = "scene.size",
              .flag = "--size",
              .level = kBasic,
              .sentence = "Replaces the size of the film, in pixels",
              .range = {1, 32768, true}},
     .field = &RunSettings::size},
    {.info = {.name = "scene.light_selection",
              .sentence = "Which light a light sample goes to: any, by power, or by a light tree"},
     .field = &RunSettings::light_selection},
    {.info = {.name = "problem.parameters",
              .flag = "--parameter",
              .level = kBasic,
              .sentence =
                  "Texture or constant to recover, Mitsuba's name or a short form; a constant "
                  "as one value or a texture of SIZE; repeatable",
              .unit = "NAME[:SIZE][@RATE]"},
     .field = &RunSettings::parameters},
    {.info = {.name = "problem.target",
              .flag = "--target",
              .level = kBasic,
              .sentence = "Image to match; without one rendered from the scene's textures",
              .unit = "IMAGE",
              .unset = "none"},
     .field = &RunSettings::targets},
    {.info = {.name = "problem.sensors",
              .flag = "--sensor",
              .sentence = "Camera of the scene file, by id or number; repeatable, each before its "
                          "--target",
              .unit = "ID"},
     .field = &RunSettings::sensors},
    {.info = {.name = "problem.views",
              .flag = "--views",
              .level = kBasic,
              .sentence =
                  "Cameras and pictures: a transforms.json, or the folder of a COLMAP model",
              .unit = "PATH",
              .unset = "none"},
     .field = &RunSettings::views},
    {.info = {.name = "problem.images",
              .flag = "--images",
              .sentence = "Folder of the pictures that --views names",
              .unit = "DIR",
              .unset = "none"},
     .field = &RunSettings::images,
     .needs = "--views",
     .holds = has_views},
    {.info = {.name = "problem.target_samples",
              .flag = "--target-spp",
              .sentence = "Samples per pixel of a rendered target",
              .range = {1, 1 << 20, true}},
     .field = &RunSettings::target_samples,
     .needs = "a target that is rendered, not a file",
     .holds = renders_target},
    {.info = {.name = "problem.mask",
              .flag = "--mask",
              .level = kBasic,
              .sentence = "Weights of the pixels",
              .unit = "IMAGE",
              .unset = "none"},
     .field = &RunSettings::mask},
    {.info = {.name = "problem.exposure",
              .flag = "--exposure",
              .level = kBasic,
              .sentence = "Factor of the rendered image before it meets the target; fit_rgb: and "
                          "white balance",
              .unit = "fit|fit_rgb|X"},
     .field = &RunSettings::exposure,
     .needs = "views that no capture describes",
     .holds = has_no_capture},
    {.info = {.name = "problem.scale",
              .flag = "--scale",
              .sentence = "Fits at a fraction of the pictures' size",
              .range = {0, 1, false, true}},
     .field = &RunSettings::scale},
    {.info = {.name = "problem.initial_values",
              .flag = "--init",
              .level = kBasic,
              .sentence = "Initial values, once or per parameter; 'scene': its texels [search]",
              .unit = "search|VALUE|FILE|scene"},
     .field = &RunSettings::starts},
    {.info = {.name = "problem.learning_rates",
              .flag = "--learning-rate",
              .level = kBasic,
              .sentence = "Step of the optimiser, once or per parameter [0.01, shared by material]",
              .range = kPositive},
     .field = &RunSettings::learning_rates},
    {.info = {.name = "run.compare",
              .flag = "--compare",
              .sentence = "A second run with another estimator, for the same time or iterations",
              .unset = "none"},
     .field = &RunSettings::compare},
    {.info = {.name = "run.compare_iterations",
              .sentence = "The second run ends after N iterations, whatever the first one did",
              .range = {1, 1e9, true},
              .unset = "none"},
     .field = &RunSettings::compare_iterations,
     .needs = "a second run, --compare",
     .holds = compares},
    {.info = {.name = "run.max_memory",
              .flag = "--max-memory",
              .level = kBasic,
              .sentence = "What the process may take [half of the machine's memory]",
              .unit = "GiB",
              .range = kPositive,
              .unset = "auto"},
     .field = &RunSettings::max_memory},
    {.info = {.name = "run.threads",
              .flag = "--threads",
              .level = kBasic,
              .sentence = "0: all cores",
              .range = {0, 4096, true}},
     .field = &RunSettings::threads,
     .recorded = false},
    {.info = {.name = "run.output",
              .flag = "-o,--output",
              .level = kBasic,
              .sentence = "Folder for the results",
              .unit = "DIR"},
     .field = &RunSettings::output,
     .recorded = false},
    {.info = {.name = "run.force",
              .flag = "--force",
              .sentence = "Writes into a folder that holds other things, too"},
     .field = &RunSettings::force,
     .recorded = false},
};

template <class T>
struct ElementOf {
    static constexpr bool list = false;
    using Type = T;
};
template <class T>
struct ElementOf<std::vector<T>> {
    static constexpr bool list = true;
    using Type = T;
};

/// Calls body(T{}) with the type of the row's value.
template <class Body>
auto with_type(const RunRow& row, const Body& body) {
    return std::visit(
        [&](auto field) {
            RunSettings settings;
            return body(std::decay_t<decltype(settings.*field)>{});
        },
        row.field);
}

const RunRow* find_run_row(const std::string& name) {
    for (const RunRow& row : kTable)
        if (name == row.info.name) return &row;
    return nullptr;
}

void set(const RunRow& row, const std::vector<std::string>& texts, RunSettings& settings) {
    std::visit(
        [&](auto field) {
            auto& value = settings.*field;
            using T = ElementOf<std::decay_t<decltype(value)>>;
            if constexpr (T::list) {
                value.assign(texts.size(), {});
                for (std::size_t i = 0; i < texts.size(); ++i)
                    from_text(row.info, texts[i], value[i]);
                if (texts.size() == 1 && texts[0] == row.info.unset) value.clear();
            } else {
                from_text(row.info, texts.back(), value);
            }
        },
        row.field);
}

std::vector<std::string> get(const RunRow& row, const RunSettings& settings) {
    return std::visit(
        [&](auto field) {
            const auto& value = settings.*field;
            using T = ElementOf<std::decay_t<decltype(value)>>;
            std::vector<std::string> texts;
            if constexpr (T::list)
                for (const auto& v : value) texts.push_back(to_text(row.info, v));
            else
                texts.push_back(to_text(row.info, value));
            return texts;
        },
        row.field);
}

Setting setting_of(const RunRow& row) {
    Setting s{row.info, "", "", "", row.needs};
    s.is_pair = std::holds_alternative<RunField<std::vector<int>>>(row.field);
    s.is_flag = std::holds_alternative<RunField<bool>>(row.field);
    with_type(row, [&](auto value) {
        using T = ElementOf<decltype(value)>;
        s.placeholder = placeholder<typename T::Type>(row.info);
        s.expected = expected_text<typename T::Type>(row.info);
        s.is_list = T::list && !s.is_pair;
    });
    if (s.is_pair) s.placeholder = "W H";
    const auto values = get(row, RunSettings{});
    if (!values.empty()) s.default_value = values.front();
    return s;
}

Setting setting_of(const OptionRow& row) {
    return {row.info, placeholder(row), expected_text(row), default_text(row), row.condition.needs};
}

[[noreturn]] void fail_for_name(const std::string& name) {
    std::string nearest;
    std::size_t least = name.size();
    for (const Setting& s : all_settings())
        if (const std::size_t d = edit_distance(name, s.info.name); d < least)
            least = d, nearest = s.info.name;
    throw InputError("there is no option '" + name + "'" +
                     (nearest.empty() ? "" : ", did you mean " + nearest + "?"));
}

/// Of one run. The estimator comes first, because the other options are its own.
Options options_of(const std::vector<Given>& given, const Estimator& estimator) {
    Options options;
    options.estimator = estimator;
    for (const Given& g : given)
        for (const std::string& name : g.names)
            if (const OptionRow* row = find_option(name);
                row && name != "estimator" && is_held(*row, options))
                set_option(*row, g.values.back(), options);
    return options;
}

Estimator estimator_of(const std::vector<Given>& given) {
    const OptionRow& row = *find_option("estimator");
    Options options;
    for (const Given& g : given)
        if (g.names.front() == row.info.name) set_option(row, g.values.back(), options);
    return options.estimator;
}

/// Learning rates of their own leave nothing for the shared one.
bool shares_rate(const RunSettings& run) {
    return run.learning_rates.empty() &&
           std::any_of(run.parameters.begin(), run.parameters.end(),
                       [](const std::string& p) { return p.find('@') == std::string::npos; });
}

bool has_effect(const std::string& name, const Settings& settings) {
    if (name == "learning_rate" && !shares_rate(settings.run)) return false;
    if (const RunRow* row = find_run_row(name)) return !row->holds || row->holds(settings.run);
    const OptionRow* row = find_option(name);
    return has_effect(*row, settings.options) ||
           (settings.compared && has_effect(*row, *settings.compared));
}

}  // namespace

std::span<const RunRow> run_table() { return kTable; }

const std::vector<Setting>& all_settings() {
    static const std::vector<Setting> all = [] {
        std::vector<Setting> settings;
        for (const RunRow& row : kTable) settings.push_back(setting_of(row));
        for (const OptionRow& row : option_table()) settings.push_back(setting_of(row));
        return settings;
    }();
    return all;
}

const Setting& find_setting(const std::string& name) {
    for (const Setting& s : all_settings())
        if (name == s.info.name) return s;
    fail_for_name(name);
}

std::string complaint(const std::string& name, const std::string& text) {
    if (const OptionRow* row = find_option(name)) return complaint(*row, text);
    const RunRow* row = find_run_row(name);
    if (!row) fail_for_name(name);
    return with_type(*row, [&](auto value) {
        typename ElementOf<decltype(value)>::Type element{};
        return from_text(row->info, text, element);
    });
}

Settings assemble(const std::vector<Given>& given) {
    Settings settings;
    for (const Given& g : given)
        for (const std::string& name : g.names)
            if (const RunRow* row = find_run_row(name)) set(*row, g.values, settings.run);
    settings.options = options_of(given, estimator_of(given));
    if (settings.run.compare) settings.compared = options_of(given, *settings.run.compare);
    return settings;
}

std::string missing_for(const Given& given, const Settings& settings) {
    std::string needs;
    for (const std::string& name : given.names) {
        if (has_effect(name, settings)) return {};
        const RunRow* run = find_run_row(name);
        needs +=
            (needs.empty() ? "" : ", or ") +
            std::string(name == "learning_rate" ? "an unknown without a learning rate of its own"
                        : run                   ? run->needs
                                                : find_option(name)->condition.needs);
    }
    return needs;
}

std::vector<SettingText> recorded_settings(const Settings& settings) {
    std::vector<SettingText> texts;
    for (const RunRow& row : kTable) {
        const auto values = get(row, settings.run);
        const Setting& s = find_setting(row.info.name);
        const bool is_list = s.is_list || s.is_pair;
        if (row.recorded && has_effect(row.info.name, settings) && !values.empty())
            texts.push_back({&row.info, is_list, values});
    }
    for (const OptionRow& row : option_table()) {
        if (!has_effect(row.info.name, settings)) continue;
        const Options& holder =
            has_effect(row, settings.options) ? settings.options : *settings.compared;
        texts.push_back({&row.info, false, {get_option(row, holder)}});
    }
    return texts;
}

}  // namespace burnish
