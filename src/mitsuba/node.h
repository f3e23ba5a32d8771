// An element of a scene file, and errors that name its place.
#pragma once

#include <cstddef>
#include <set>
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
    /// $parameters already substituted.
    std::vector<std::pair<std::string, std::string>> attributes;
    std::vector<Node> children;  ///< without default, include, path and alias
    Place place;
    int order = 0;  ///< position in document order, over all files
};
inline constexpr int kNew = -1;  ///< Node::order of an element that no file held

/// The value of an attribute; empty where it is absent.
const std::string& attribute(const Node& node, const std::string& name);
/// The same, to be changed; nullptr where it is absent.
std::string* find_attribute(Node& node, const std::string& name);
/// The id, or the fallback where it has none.
std::string id_or(const Node& node, std::string fallback);

/// An element <tag name="..." value="..."/> that no file held.
Node make_value(const std::string& tag, const std::string& name, const std::string& value,
                const Place& place = {});
/// Numbers, colours, words and transforms: in Mitsuba 3 they have no ids, and no <ref> means one.
bool is_value(const Node& node);
/// Bytes, about, with all that is inside.
std::size_t size_of(const Node& node);
/// Adds the bytes of what a reference means to those of others, which are read or copied for each.
/// Throws InputError where they are more than any scene has.
void add_referred(std::size_t& bytes, const Node& ref, const Node& target);
/// Removes the children of these names.
void drop_children(Node& node, const std::set<std::string>& names);

}  // namespace burnish::mitsuba
