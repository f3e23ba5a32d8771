// $parameters: <default> and the command line.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "mitsuba/node.h"

namespace burnish::mitsuba {

struct Definition {
    std::string value;
    bool from_command_line = false, used = false;
};

using Definitions = std::map<std::string, Definition, std::less<>>;  ///< by name

Definitions command_line_definitions(const std::map<std::string, std::string>& given);
bool is_defined(const Definitions& definitions, const std::string& name);
/// <default>: the first definition of a name stays.
void define(Definitions& definitions, const std::string& name, const std::string& value,
            const Place& place);
/// Replaces every $name by its value, the longest matching name first; "\$" is a plain "$". Marks
/// what it used. Throws InputError for a $ that no name follows.
std::string substitute(Definitions& definitions, const std::string& text, const Place& place);
/// Throws InputError where the command line gave a name a value that nothing in the file used: it
/// is mistyped.
void check_given(const Definitions& definitions, const std::string& file);

}  // namespace burnish::mitsuba
