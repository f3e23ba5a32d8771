// A file of binary glTF 2.0: its document, and the accessors of its data. Names are the
// specification's.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "captures/json_value.h"

namespace burnish {

struct Glb {
    std::string name;
    std::string bytes;
    nlohmann::json json;
    std::size_t data = 0, data_size = 0;  ///< the binary chunk: where it begins, bytes
};

/// Throws InputError: no binary glTF 2.0, or chunks that do not fit the file; says the byte offset.
Glb open_glb(const std::filesystem::path& file);

inline Value document(const Glb& glb) { return {glb.json, glb.name, ""}; }

// What reads the document throws InputError: file, key, what was found and what was expected.

/// A whole number from 0 to `max`.
std::size_t whole(const Value& v, double max);
std::size_t whole_or(const Value& object, const char* name, std::size_t otherwise, double max);
/// How many elements a member of an object has, an array; 0 without it.
std::size_t count_of(const Value& object, const char* name);
/// The element that `index` names of an array of the document.
Value entry(const Glb& glb, const char* array, const Value& index);

/// Vectors of numbers in the data.
struct Accessor {
    std::string_view bytes;  ///< of the Glb, from the first element on; all elements lie within
    std::size_t count = 0, stride = 0;
    std::size_t type = 0;  ///< of a component, glTF's number
    bool normalized = false;
};

/// index: of the accessor. type: what it must be, "VEC3", which has so many components.
Accessor accessor(const Glb& glb, const Value& index, const std::string& type,
                  std::size_t components);

/// A component of element i as a number; of normalised integers one in [-1, 1].
double component(const Accessor& a, std::size_t i, std::size_t c);

}  // namespace burnish
