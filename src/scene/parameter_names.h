// Names of parameters as people type them: Mitsuba's full name, or any short form that means one
// texture.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace burnish {

/// How well a text names a parameter, the best last.
enum class NameMatch {
    kNone,
    kShortForm,  ///< its dot-separated parts are parts of the name, in that order: "roughness"
    kPlainName,  ///< it leaves out .brdf_0, .brdf_1 and the last .data or .value alone
    kFullName,
};
NameMatch match_name(const std::string& text, const std::string& full_name);

/// The parameter that a name means: its index in `parameters`. Those that it names best count; of
/// several with one full name the first is meant, and several that share one texture are no
/// ambiguity. Throws InputError: the name is unknown (says the near ones, or all) or ambiguous
/// (says all matches).
std::size_t find_parameter(const std::vector<Parameter>& parameters, const std::string& name);

/// Throws InputError where two of the names mean one texture; names both. textures: what the names
/// mean.
void require_distinct(const std::vector<std::string>& names,
                      const std::vector<TextureId>& textures);

/// The least number of characters inserted, removed, replaced or exchanged with the next one
/// between a and b, each touched once.
std::size_t edit_distance(const std::string& a, const std::string& b);

/// The name at the least distance from what was written, at most a third of its characters; empty:
/// none is so near.
std::string nearest_name(const std::string& written, const std::vector<std::string>& names);

/// What is expected in place of a name that is none of them: "expected one of a, b", or "did you
/// mean b? Expected one of a, b".
std::string expected_name(const std::string& written, const std::vector<std::string>& names);

/// "a, b, c and 4 more"
std::string list_of(std::vector<std::string> names);

}  // namespace burnish
