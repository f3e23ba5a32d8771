// Values of a JSON file with their places, so that what is wrong is said with the file and the key.
// What reads one throws InputError: the place, what was found and what was expected.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/view.h"

namespace burnish {

struct Value {
    const nlohmann::json& value;
    std::string file, key;  ///< "views[0].camera"; empty: the document
};

/// Of a file of at most kMaxTextFile bytes. what: what it is, for the message.
nlohmann::json parse_json(const std::string& file, const std::string& what);
/// Of a text that stands in the file from byte `first` on.
nlohmann::json parse_json(std::string_view text, const std::string& file, std::size_t first,
                          const std::string& what);

/// "capture.json: views[0].camera", in messages.
std::string place_of(const Value& v);

[[noreturn]] void fail(const Value& v, const std::string& expected);

Value member(const Value& object, const std::string& name);
Value element(const Value& array, std::size_t i);
inline bool has(const Value& object, const char* name) { return object.value.contains(name); }

/// An object of these keys alone.
void check_object(const Value& v, const std::vector<std::string>& known);
void require_member(const Value& object, const char* name);

std::string text(const Value& v);
double number(const Value& v);
std::vector<double> numbers(const Value& v, std::size_t count);
/// Four rows of four numbers.
Matrix matrix(const Value& v);
/// Of a camera: a rotation, off by a thousandth at most, and a translation; the last row, as far
/// off at most, becomes 0 0 0 1. axes: the signs of the camera's axes in those of x right, y down,
/// z forward.
Matrix camera_to_world(const Value& v, const std::array<double, 3>& axes);
/// A side of a picture: see is_side.
int side(const Value& v);

/// Where `named` leads from a folder, or empty where it is absolute or leaves it by "..". Links are
/// not looked at: pictures often lie on another disk.
std::string path_within(const std::string& folder, const std::string& named);
/// A file that the file names: within its folder.
std::string file_of(const Value& v);

}  // namespace burnish
