#include "python/options.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <map>
#include <vector>

#include "burnish/error.h"
#include "optimize/option_table.h"
#include "optimize/without_effect.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "render/renderer.h"
#include "scene/parameter_names.h"

namespace burnish::python {

namespace {

/// The name of a keyword argument: that of the command line's option, or else the table's.
std::string keyword_of(const OptionRow& row) {
    std::string name = *row.info.flag ? row.info.flag + 2 : row.info.name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '.' || c == '-'; }, '_');
    return name;
}

/// Each keyword with its rows, one for each estimator that has the option.
struct Keyword {
    std::string name;
    std::vector<const OptionRow*> rows;
};
const std::vector<Keyword>& keywords() {
    static const std::vector<Keyword> all = [] {
        std::vector<Keyword> found;
        for (const OptionRow& row : option_table()) {
            const std::string name = keyword_of(row);
            const auto same = std::find_if(found.begin(), found.end(),
                                           [&](const Keyword& k) { return k.name == name; });
            if (same == found.end())
                found.push_back({name, {&row}});
            else
                same->rows.push_back(&row);
        }
        return found;
    }();
    return all;
}

[[noreturn]] void fail_for_name(const std::string& function, const std::string& name) {
    std::vector<std::string> names;
    for (const Keyword& k : keywords()) names.push_back(k.name);
    const std::string nearest = nearest_name(name, names);
    throw type_error(function + "() has no option '" + name + "'" +
                     (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
}

std::string value_text(const std::string& name, const OptionRow& row, nb::handle value) {
    if (nb::isinstance<nb::str>(value)) return text_of(value);
    if (const auto truth = as_bool(value)) return *truth ? "true" : "false";
    if (PyIndex_Check(value.ptr())) {
        const nb::object whole = nb::steal(PyNumber_Index(value.ptr()));
        if (whole.is_valid()) return text_of(whole);
        PyErr_Clear();  // an array of floating-point numbers
    }
    if (const auto number = as_number(value, name)) return repr_of(nb::float_(*number));
    throw type_error(name + ": expected " + expected_text(row) + ", found " + type_of(value));
}

/// With the keyword's name in the place of the table's.
void set(const std::string& name, const OptionRow& row, const std::string& text, Options& options) {
    if (const std::string wrong = complaint(row, text); !wrong.empty())
        throw InputError(name + ": " + wrong);
    set_option(row, text, options);
}

/// The row that these options hold.
const OptionRow& held_row(const Keyword& keyword, const Options& options) {
    for (const OptionRow* row : keyword.rows)
        if (is_held(*row, options)) return *row;
    return *keyword.rows.front();
}

/// A loss of one's own leaves nothing to search with: the start is 0.5.
bool is_searched(const PythonProblem& p, const Unknown& unknown) {
    return std::holds_alternative<SearchStart>(unknown.start) && !p.functions.loss;
}
bool searches(const PythonProblem& p) {
    return std::ranges::any_of(p.problem.unknowns,
                               [&](const Unknown& u) { return is_searched(p, u); });
}
bool shares_rate(const PythonProblem& p) {
    return std::ranges::any_of(p.problem.unknowns,
                               [](const Unknown& u) { return u.learning_rate == 0; });
}
bool starts_from_no_image(const PythonProblem& p) {
    return std::ranges::any_of(p.problem.unknowns, [](const Unknown& u) {
        return !std::holds_alternative<Image>(u.start);
    });
}
bool has_views(const PythonProblem& p) { return p.problem.views.size() > 1; }
bool has_no_loss(const PythonProblem& p) { return !p.functions.loss; }

/// Options whose effect follows from the problem.
struct ProblemCondition {
    const char* option;
    bool (*holds)(const PythonProblem&);
    const char* needs = "";  ///< beside what the table says
};
constexpr ProblemCondition kProblemConditions[] = {
    {"loss", has_no_loss, "a problem without a loss of its own"},
    {"learning_rate", shares_rate},
    {"search_again", searches},
    {"search_effort", searches},
    {"unvisited", starts_from_no_image},
    {"batch", has_views},
};
const ProblemCondition* find_condition(const Keyword& keyword) {
    for (const ProblemCondition& c : kProblemConditions)
        if (keyword.name == c.option) return &c;
    return nullptr;
}

/// What a keyword has an effect with; empty: always.
std::string needs_of(const Keyword& keyword) {
    std::string needs;
    const auto add = [&](const std::string& more) {
        if (!more.empty()) needs += (needs.empty() ? "" : ", or ") + more;
    };
    for (const OptionRow* row : keyword.rows) add(row->condition.needs);
    if (const ProblemCondition* c = find_condition(keyword)) add(c->needs);
    return needs;
}

void require_effect(const Keyword& keyword, const Options& options, const PythonProblem& problem) {
    const OptionRow& row = held_row(keyword, options);
    const ProblemCondition* c = find_condition(keyword);
    if (is_held(row, options) && has_effect(row, options) && (!c || c->holds(problem))) return;
    throw InputError(keyword.name + " needs " + needs_of(keyword));
}

bool has_mask(const View& view) {
    return std::ranges::any_of(view.mask.values, [](float weight) { return weight != 1; });
}

void warn_without_effect(const Options& options, const PythonProblem& p) {
    const Scene& scene = p.problem.renderer.data().scene();
    UnknownTextures unknowns;
    for (const Unknown& u : p.problem.unknowns) {
        unknowns.all.push_back(find_texture(scene, u.name));
        if (is_searched(p, u)) unknowns.searched.push_back(unknowns.all.back());
    }
    const auto fitted = static_cast<std::size_t>(
        std::ranges::count_if(p.problem.views, [](const View& v) { return !v.held_out; }));
    for (const std::string& sentence : options_without_effect(options, scene, unknowns, fitted))
        warn(PyExc_UserWarning, sentence);
    if (p.functions.loss && std::ranges::any_of(p.problem.views, has_mask))
        warn(
            PyExc_UserWarning,
            "a loss of your own gets the whole images: the masks of the views count in psnr alone, "
            "unless it applies them");
}

}  // namespace

Options options_of(const nb::kwargs& given, const std::string& function,
                   const PythonProblem& problem) {
    std::map<std::string, nb::handle> values;
    for (const auto& [key, value] : given)
        if (!value.is_none()) values[text_of(key)] = value;
    Options options;
    // The table begins with the estimator, of which others are options.
    for (const Keyword& k : keywords()) {
        const auto at = values.find(k.name);
        if (at == values.end()) continue;
        const OptionRow& row = held_row(k, options);
        const std::string text = value_text(k.name, row, at->second);
        if (is_held(row, options)) set(k.name, row, text, options);
    }
    for (const auto& [key, unused] : given) {
        const std::string name = text_of(key);
        const auto k = std::find_if(keywords().begin(), keywords().end(),
                                    [&](const Keyword& known) { return known.name == name; });
        if (k == keywords().end()) fail_for_name(function, name);
        if (values.count(name)) require_effect(*k, options, problem);
    }
    warn_without_effect(options, problem);
    return options;
}

namespace {

std::string python_type(const OptionRow& row) {
    if (is_number(row)) return row.info.range.integer ? "int" : "float";
    const std::string choices = placeholder(row);
    if (choices == "true|false") return "bool";
    std::string literal = "typing.Literal['";
    for (const char c : choices) literal += c == '|' ? "', '" : std::string(1, c);
    return literal + "']";
}

/// "auto" and "none" are None.
std::string default_of(const OptionRow& row) {
    const std::string text = default_text(row);
    if (*row.info.unset && text == row.info.unset) return "None (" + text + ")";
    return text == "true" ? "True" : text == "false" ? "False" : text;
}

std::string expected_of(const OptionRow& row) {
    return placeholder(row) == "true|false" ? "True or False" : expected_text(row);
}

/// What the rows of a keyword say, each once: "4 or 32".
std::string of_all(const Keyword& k, std::string (*say)(const OptionRow&)) {
    std::vector<std::string> said;
    std::string text;
    for (const OptionRow* row : k.rows) {
        const std::string words = say(*row);
        if (std::find(said.begin(), said.end(), words) != said.end()) continue;
        text += (said.empty() ? "" : " or ") + words;
        said.push_back(words);
    }
    return text;
}

std::string sentence_of(const Keyword& k) {
    const OptionRow& row = *k.rows.front();
    std::string text = std::string(row.info.sentence) + "; " + of_all(k, expected_of);
    if (*row.info.unit) text += ", in " + std::string(row.info.unit);
    text += "; default " + of_all(k, default_of);
    const std::string needs = needs_of(k);
    return needs.empty() ? text + "." : text + ". Needs " + needs + ".";
}

}  // namespace

std::string options_signature() {
    std::string text = ", *";
    for (const Keyword& k : keywords())
        text += ", " + k.name + ": " + python_type(*k.rows.front()) + " | None = None";
    return text;
}

std::string options_text() {
    std::string text = "\n\nOptions, of which None is the default:\n\n";
    for (const Keyword& k : keywords()) text += "    " + k.name + ": " + sentence_of(k) + "\n";
    return text;
}

nb::list options_list() {
    nb::list all;
    for (const Keyword& k : keywords())
        all.append(nb::make_tuple(k.name, std::string(k.rows.front()->info.sentence),
                                  of_all(k, expected_of), of_all(k, default_of)));
    return all;
}

}  // namespace burnish::python
