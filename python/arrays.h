// Images as arrays of Python, [height, width, channels], float32.
#pragma once

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

#include "burnish/image.h"

namespace burnish::python {

namespace nb = nanobind;

/// str(object), repr(object) and the name of its type.
std::string text_of(nb::handle object);
std::string repr_of(nb::handle object);
std::string type_of(nb::handle object);
/// A message or a name that may hold a path; what is not UTF-8 is escaped.
nb::object to_text(const std::string& text);
/// A path, as Python has those that are not UTF-8: the other way of to_path.
nb::object from_path(const std::string& path);

/// A warning; throws where a filter makes an exception of it. Of text as to_text takes it.
void warn(PyObject* category, const std::string& text);

/// What an array holds.
enum class Meaning {
    kLinear,   ///< texels, images: whole numbers without a sign are refused, for they are codes
    kColours,  ///< radiance and derivatives by it: likewise, and of three channels alone
    kWeights,  ///< of pixels: whole numbers above 1 are refused, for they are codes, too
};

/// A TypeError, to be thrown.
inline nb::builtin_exception type_error(const std::string& text) {
    return nb::type_error(text.c_str());
}

/// An image from anything that numpy makes an array of, or that speaks DLPack: [height, width],
/// [height, width, 1] or [height, width, 3], of colours the last alone. Throws TypeError and
/// InputError; what: whose array it is.
Image to_image(nb::handle given, const std::string& what, Meaning meaning = Meaning::kLinear);

/// The numbers, row by row, of anything that numpy makes an array of, or that speaks DLPack, of
/// this shape; 0: any length. Throws TypeError and InputError; what: whose they are; expected: such
/// an array in words.
std::vector<double> to_numbers(nb::handle given, const std::string& what,
                               const std::string& expected, const std::vector<std::size_t>& shape);

/// A numpy array that owns the image's values; None of an empty image.
nb::object to_array(Image image);

/// A numpy array of the image's values, without a copy, that cannot be written and keeps `owner`;
/// None of an empty image.
nb::object view_of(const Image& image, nb::handle owner);

}  // namespace burnish::python
