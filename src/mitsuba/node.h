// An element of a scene file, and errors that name its place.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "burnish/error.h"

namespace burnish::mitsuba {

/// Where something was written; line and column count from 1, column in bytes.
struct Place {
    std::string file;
    int line = 0, column = 0;
};

/// "FILE:LINE:COLUMN".
std::string place_text(const Place& place);
/// "FILE:LINE:COLUMN: text" as one sentence.
std::string sentence(const Place& place, const std::string& text);
/// Throws that sentence as InputError.
[[noreturn]] void fail(const Place& place, const std::string& text);

/// What Mitsuba has and this reader has not.
struct Unsupported : InputError {
    using InputError::InputError;
};
/// Throws it.
[[noreturn]] void fail_unsupported(const Place& place, const std::string& text);

struct Node {
    std::string tag;
    std::vector<std::pair<std::string, std::string>>
        attributes;              ///< $parameters already substituted
    std::vector<Node> children;  ///< without default, include, path and alias
    Place place;
    int order = 0;  ///< position in document order, over all files
};

/// The value of an attribute; empty where it is absent.
const std::string& attribute(const Node& node, const std::string& name);
/// The id, or the fallback where it has none.
std::string id_or(const Node& node, std::string fallback);

}  // namespace burnish::mitsuba
