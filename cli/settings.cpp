#include "cli/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "burnish/error.h"
#include "captures/capture.h"
#include "cli/commands.h"
#include "cli/option_text.h"
#include "core/positive_float.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

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
    for (const RunRow& row : run_table())
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
    s.alone = row.alone;
    const auto values = get(row, RunSettings{});
    if (!values.empty()) s.default_value = values.front();
    return s;
}

[[noreturn]] void fail_for_name(const std::string& name) {
    std::vector<std::string> names;
    for (const Setting& s : all_settings()) names.push_back(s.info.name);
    const std::string nearest = nearest_name(name, names);
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
                row && name != "estimator" && is_held(*row, options)) {
                if (const std::string wrong = complaint(*row, g.values.back()); !wrong.empty())
                    throw UsageError(g.label + ": " + wrong);
                set_option(*row, g.values.back(), options);
            }
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
bool shares_rate(const RunSettings& run) { return run.learning_rates.empty() && has_unrated(run); }
bool searches(const RunSettings& run) {
    return run.starts.empty() || std::ranges::count(run.starts, "search") > 0;
}
/// An image stays as it is where no sample comes.
bool starts_from_no_image(const RunSettings& run) {
    return searches(run) || std::ranges::any_of(run.starts, [](const std::string& start) {
               return parse_number(start).has_value();
           });
}
bool may_have_views(const RunSettings& run) {
    return is_capture(run.scene) || !run.views.empty() || run.sensors.size() > 1;
}

/// Options of burnish::Options whose effect follows from the run beside them.
struct RunCondition {
    const char* option;
    bool (*holds)(const RunSettings&);
};
constexpr RunCondition kRunConditions[] = {{"learning_rate", shares_rate},
                                           {"search_again", searches},
                                           {"search_effort", searches},
                                           {"unvisited", starts_from_no_image},
                                           {"batch", may_have_views}};

Setting setting_of(const OptionRow& row) {
    return {row.info, placeholder(row), expected_text(row), default_text(row), row.condition.needs};
}

bool has_effect_in(const RunSettings& run, const std::string& name) {
    for (const RunCondition& c : kRunConditions)
        if (name == c.option) return c.holds(run);
    return true;
}

bool has_effect(const std::string& name, const Settings& settings) {
    if (!has_effect_in(settings.run, name)) return false;
    if (const RunRow* row = find_run_row(name)) return !row->holds || row->holds(settings.run);
    const OptionRow* row = find_option(name);
    return has_effect(*row, settings.options) ||
           (settings.compared && has_effect(*row, *settings.compared));
}

}  // namespace

std::optional<Exposure> parse_exposure(const std::string& text) {
    if (text == "fit") return FitExposure{};
    if (text == "fit_rgb") return FitExposure{true};
    const std::optional<double> number = parse_number(text);
    if (!number || !is_positive_float(*number)) return std::nullopt;
    const auto e = static_cast<float>(*number);
    return ExposureFactors{e, e, e};
}

const std::vector<Setting>& all_settings() {
    static const std::vector<Setting> all = [] {
        std::vector<Setting> settings;
        for (const RunRow& row : run_table()) settings.push_back(setting_of(row));
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
    const OptionRow* option = find_option(name);
    const RunRow* row = find_run_row(name);
    if (!option && !row) fail_for_name(name);
    if (text.empty()) return complaint_of_empty(text);
    if (option) return complaint(*option, text);
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
        needs += needs.empty() ? "" : ", or ";
        needs += run ? run->needs : find_option(name)->condition.needs;
    }
    const auto has_row_of = [&](const char* group) {
        return std::ranges::any_of(given.names,
                                   [&](const std::string& n) { return n.starts_with(group); });
    };
    if (has_row_of("monte_carlo.") && has_row_of("reservoirs."))
        return "an estimator other than path_cache";
    return needs;
}

std::vector<SettingText> recorded_settings(const Settings& settings) {
    std::vector<SettingText> texts;
    for (const RunRow& row : run_table()) {
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

std::vector<std::string> setting_texts(const Settings& settings) {
    const std::vector<SettingText> recorded = recorded_settings(settings);
    std::vector<std::string> texts;
    for (const Setting& s : all_settings()) {
        const auto own = std::ranges::find_if(recorded, [&](const SettingText& r) {
            return std::string_view(r.info->name) == s.info.name;
        });
        texts.push_back(own == recorded.end() ? "none"
                                              : fmt::format("{}", fmt::join(own->values, ", ")));
    }
    return texts;
}

}  // namespace burnish
