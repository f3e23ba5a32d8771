// Typed reading of one plugin element. Every child is taken by name once; `warn_unknown` lists what
// nobody took.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "core/vec.h"
#include "mitsuba/xml.h"

namespace burnish::mitsuba {

/// A child of a plugin element, with its reference resolved.
struct Property {
    std::string name;            ///< empty for an unnamed child
    const Node* node = nullptr;  ///< what was meant: the child, or the target of the <ref>
    const Node* site = nullptr;  ///< where it was written
    bool taken = false;
};

struct Properties {
    const Node* node = nullptr;
    std::string type;  ///< of the plugin
    std::vector<Property> all;
};

/// Counts the values that references mean. Throws InputError: a parameter given twice, an unknown
/// id, see add_referred.
Properties open_properties(Document& document, const Node& node);

/// Throws InputError unless the property is one of the tags, of which the first is said to be
/// expected.
void expect_tag(const Property& property, std::initializer_list<const char*> tags);

/// The property of that name, marked as taken; nullptr where there is none.
const Property* take(Properties& properties, const std::string& name);
/// The same; throws InputError where there is none.
const Property& take_required(Properties& properties, const std::string& name);
/// The children of one tag (say, "bsdf"), named or not, marked as taken.
std::vector<const Property*> take_tag(Properties& properties, const std::string& tag);
/// The only one of them; nullptr where there is none. Throws InputError: a second one.
const Property* take_only(Properties& properties, const std::string& tag);

// Values, or the default where the property is absent. Throw InputError: another type, not a
// number, out of range.
double take_number(Properties& properties, const std::string& name, double fallback);
double take_within(Properties& properties, const char* name, double fallback, double minimum,
                   double maximum);
float take_float(Properties& properties, const std::string& name, float fallback);
int take_integer(Properties& properties, const std::string& name, int fallback, int minimum,
                 int maximum);
bool take_boolean(Properties& properties, const std::string& name, bool fallback);
std::string take_string(Properties& properties, const std::string& name,
                        const std::string& fallback);
/// "filename", which must be there and may not be empty.
std::string take_file_name(Properties& properties);
/// One of the words of `choices`, as its index.
int take_choice(Properties& properties, const std::string& name,
                const std::vector<std::string>& choices, int fallback);
/// The same, of words that may be written in capitals; those of `choices` are not.
int take_choice_in_any_case(Properties& properties, const std::string& name,
                            const std::vector<std::string>& choices, int fallback);
std::optional<Vec3<double>> take_point(Properties& properties, const std::string& name);
std::optional<Transform> take_transform(Properties& properties, const std::string& name);

/// Takes properties that have no effect here and need no word.
void ignore(Properties& properties, std::initializer_list<const char*> names);

/// One warning that lists all properties that nobody took.
void warn_unknown(const Properties& properties, std::vector<std::string>& warnings);

/// Throws InputError for a plugin that is not read: Unsupported, by name, where Mitsuba has it
/// (`known`, separated by blanks).
[[noreturn]] void fail_plugin(const Node& node, const std::string& known,
                              const std::string& expected);

}  // namespace burnish::mitsuba
