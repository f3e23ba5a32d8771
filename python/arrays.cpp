#include "python/arrays.h"

#include <fmt/format.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "burnish/error.h"
#include "image/image.h"
#include "image/whole.h"

namespace burnish::python {

namespace {

/// Of a new reference to a text; what cannot be encoded is escaped.
std::string take_text(PyObject* text) {
    const nb::object owned = nb::steal(text);
    if (!owned.is_valid()) nb::raise_python_error();
    const nb::object bytes =
        nb::steal(PyUnicode_AsEncodedString(owned.ptr(), "utf-8", "backslashreplace"));
    if (!bytes.is_valid()) nb::raise_python_error();
    return {PyBytes_AsString(bytes.ptr()), static_cast<std::size_t>(PyBytes_Size(bytes.ptr()))};
}

}  // namespace

std::string text_of(nb::handle object) { return take_text(PyObject_Str(object.ptr())); }
std::string repr_of(nb::handle object) { return take_text(PyObject_Repr(object.ptr())); }
std::string type_of(nb::handle object) {
    return text_of(nb::object(object.type().attr("__name__")));
}

namespace {

nb::object checked(PyObject* made) {
    if (!made) nb::raise_python_error();
    return nb::steal(made);
}

}  // namespace

nb::object to_text(const std::string& text) {
    const auto size = static_cast<Py_ssize_t>(text.size());
    return checked(PyUnicode_DecodeUTF8(text.data(), size, "backslashreplace"));
}
nb::object from_path(const std::string& path) {
    const auto size = static_cast<Py_ssize_t>(path.size());
    return checked(PyUnicode_DecodeFSDefaultAndSize(path.data(), size));
}

void warn(PyObject* category, const std::string& text) {
    if (PyErr_WarnFormat(category, 1, "%U", to_text(text).ptr()) != 0) nb::raise_python_error();
}

namespace {

constexpr const char* kArray = "an array of numbers";

[[noreturn]] void fail_for_type(const std::string& what, const std::string& expected,
                                const std::string& found) {
    throw type_error(what + ": expected " + expected + ", found " + found);
}

bool is_sequence(nb::handle object) {
    return nb::isinstance<nb::list>(object) || nb::isinstance<nb::tuple>(object);
}

/// numpy would drop its mask, and those of the rows and pixels of lists. depth: of the lists that
/// are looked into.
void require_no_mask(nb::handle array, const std::string& what, int depth = 2) {
    if (is_sequence(array)) {
        if (depth == 0) return;
        for (const nb::handle element : array) require_no_mask(element, what, depth - 1);
        return;
    }
    if (PyFloat_CheckExact(array.ptr()) || !nb::hasattr(array, "mask")) return;
    const nb::module_ masked = nb::module_::import_("numpy.ma");
    if (nb::isinstance(array, masked.attr("MaskedArray")) &&
        nb::cast<bool>(masked.attr("is_masked")(array)))
        throw InputError(what +
                         ": found a masked array, whose mask would be lost; expected its .data or "
                         ".filled(), and for a View mask=~array.mask");
}

/// As numpy sees it.
nb::object as_numpy(nb::handle array, const std::string& what, const std::string& expected) {
    if (array.is_none() || nb::isinstance<nb::str>(array) || nb::isinstance<nb::dict>(array))
        fail_for_type(what, expected, type_of(array));
    require_no_mask(array, what);
    const nb::module_ numpy = nb::module_::import_("numpy");
    const bool has_own = nb::hasattr(array, "__array__") || PyObject_CheckBuffer(array.ptr());
    try {
        if (!has_own && nb::hasattr(array, "__dlpack__")) return numpy.attr("from_dlpack")(array);
        return numpy.attr("asarray")(array);
    } catch (nb::python_error& e) {
        nb::raise_from(e, PyExc_TypeError, "%s: expected %s, found %s", what.c_str(),
                       expected.c_str(), type_of(array).c_str());
    }
}

std::string shape_text(nb::handle array) { return repr_of(nb::object(array.attr("shape"))); }

std::string kind_of(nb::handle array) {
    return nb::cast<std::string>(array.attr("dtype").attr("kind"));
}
std::string dtype_of_array(nb::handle array) { return text_of(nb::object(array.attr("dtype"))); }
bool has_numbers(nb::handle array) {  // numpy knows no kind of bfloat16
    return kind_of(array).find_first_of("fiub") != std::string::npos ||
           dtype_of_array(array) == "bfloat16";
}

/// Of an array of whole numbers.
void require_weights(const Image& image, const std::string& what, const std::string& type) {
    const float max = *std::max_element(image.values.begin(), image.values.end());
    if (max > 1)
        throw InputError(fmt::format("{}: found {} up to {}, expected weights from 0 to 1", what,
                                     type, static_cast<long long>(max)));
}

}  // namespace

Image to_image(nb::handle given, const std::string& what, Meaning meaning) {
    nb::object array = as_numpy(given, what, kArray);
    const std::string kind = kind_of(array), type = dtype_of_array(array);
    if (!has_numbers(array)) fail_for_type(what, kArray, "one of " + type);
    if (meaning != Meaning::kWeights && (kind == "u" || kind == "b"))
        throw InputError(what + ": found " + type +
                         ", expected linear values as floating-point numbers; read_image and "
                         "read_photograph decode files");
    const std::size_t ndim = nb::len(nb::object(array.attr("shape")));
    const auto shape = [&](std::size_t i) { return nb::cast<std::size_t>(array.attr("shape")[i]); };
    const std::size_t channels = ndim == 3 ? shape(2) : 1;
    const bool one_channel_fits = meaning != Meaning::kColours;
    if (ndim < 2 || ndim > 3 || (channels != 3 && !(one_channel_fits && channels == 1)))
        throw InputError(what + ": found the shape " + shape_text(array) + ", expected " +
                         (one_channel_fits ? "(height, width), (height, width, 1) or " : "") +
                         "(height, width, 3)");
    if (std::min(shape(0), shape(1)) < 1 ||
        std::max(shape(0), shape(1)) > std::size_t{kMaxImageSide})
        throw InputError(fmt::format("{}: found the shape {}, expected sides of 1 to {}", what,
                                     shape_text(array), kMaxImageSide));
    const nb::module_ numpy = nb::module_::import_("numpy");
    array = numpy.attr("ascontiguousarray")(array, numpy.attr("float32"));
    const auto values = nb::cast<nb::ndarray<const float, nb::c_contig, nb::device::cpu>>(array);
    Image image{static_cast<int>(shape(1)),
                static_cast<int>(shape(0)),
                static_cast<int>(channels),
                {values.data(), values.data() + values.size()}};
    require_finite(image, what);
    if (meaning == Meaning::kWeights && (kind == "u" || kind == "i"))
        require_weights(image, what, type);
    return image;
}

std::vector<double> to_numbers(nb::handle given, const std::string& what,
                               const std::string& expected, const std::vector<std::size_t>& shape) {
    nb::object array = as_numpy(given, what, expected);
    const auto own = nb::cast<std::vector<std::size_t>>(array.attr("shape"));
    const bool may_be_numbers = kind_of(array) == "O" && !own.empty();  // such as fractions
    if (!has_numbers(array) && !may_be_numbers)
        fail_for_type(what, expected,
                      own.empty() ? type_of(given) : "an array of " + dtype_of_array(array));
    const auto fits = [](std::size_t a, std::size_t b) { return b == 0 || a == b; };
    if (!std::equal(own.begin(), own.end(), shape.begin(), shape.end(), fits))
        throw InputError(what + ": found the shape " + shape_text(array) + ", expected " +
                         expected);
    try {
        array = array.attr("astype")("float64").attr("ravel")();
    } catch (nb::python_error& e) {
        nb::raise_from(e, PyExc_TypeError, "%s: expected %s, found %s", what.c_str(),
                       expected.c_str(), repr_of(given).c_str());
    }
    return nb::cast<std::vector<double>>(array.attr("tolist")());
}

namespace {

using Array = nb::ndarray<nb::numpy, float, nb::ndim<3>>;
using View = nb::ndarray<nb::numpy, const float, nb::ndim<3>>;

template <class A, class Values>
nb::object array_of(const Image& image, Values* values, nb::handle owner) {
    return nb::cast(
        A(values,
          {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width),
           static_cast<std::size_t>(image.channels)},
          owner),
        nb::rv_policy::reference);
}

}  // namespace

nb::object to_array(Image image) {
    if (image.width == 0) return nb::none();
    auto* owned = new Image(std::move(image));
    const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<Image*>(p); });
    return array_of<Array>(*owned, owned->values.data(), owner);
}

nb::object view_of(const Image& image, nb::handle owner) {
    if (image.width == 0) return nb::none();
    return array_of<View>(image, image.values.data(), owner);
}

}  // namespace burnish::python
