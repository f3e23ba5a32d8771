// Cameras, lenses and lights.
#include <fmt/format.h>
#include <nanobind/operators.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>

#include "burnish/error.h"
#include "burnish/view.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace burnish::python {

namespace {

/// Four rows of four numbers, or anything that numpy makes an array of them.
Matrix to_matrix(nb::handle value, const std::string& what) {
    const auto numbers = to_numbers(value, what, "four rows of four numbers", {4, 4});
    Matrix m{};
    std::copy(numbers.begin(), numbers.end(), m.begin());
    return m;
}

nb::object to_array(const Matrix& m) {
    std::vector<std::vector<double>> rows;
    for (std::size_t row = 0; row < 4; ++row)
        rows.emplace_back(m.begin() + static_cast<std::ptrdiff_t>(4 * row),
                          m.begin() + static_cast<std::ptrdiff_t>(4 * row + 4));
    nb::object array = nb::module_::import_("numpy").attr("array")(rows);
    array.attr("setflags")(nb::arg("write") = false);  // a copy: what is written would be lost
    return array;
}

/// All that exist.
constexpr std::pair<const char*, LensKind> kLenses[] = {{"pinhole", LensKind::kPinhole},
                                                        {"brown_conrady", LensKind::kBrownConrady},
                                                        {"fisheye", LensKind::kFisheye}};

LensKind lens_kind(const std::string& name) {
    std::string known;
    for (const auto& [own, kind] : kLenses) {
        if (name == own) return kind;
        known += (known.empty() ? "" : ", ") + std::string(own);
    }
    throw InputError("the lens is \"" + name + "\", expected one of " + known);
}

const char* name_of(LensKind kind) {
    for (const auto& [name, known] : kLenses)
        if (kind == known) return name;
    return "";
}

std::size_t coefficient_count(LensKind kind) {
    switch (kind) {
        case LensKind::kPinhole:
            return 0;
        case LensKind::kBrownConrady:
            return 8;
        case LensKind::kFisheye:
            return 4;
    }
    return 0;
}

Lens make_lens(const std::string& kind, nb::handle given) {
    Lens lens{lens_kind(kind)};
    const auto coefficients = to_numbers(given, "coefficients", "a row of numbers", {0});
    const std::size_t max = coefficient_count(lens.kind);
    if (coefficients.size() > max)
        throw InputError(fmt::format("the lens has {} coefficients, expected at most {}",
                                     coefficients.size(), max));
    std::copy(coefficients.begin(), coefficients.end(), lens.coefficients.begin());
    return lens;
}

/// What cannot be written: it would be lost.
nb::tuple coefficients_of(const Lens& lens) {
    nb::list all;
    for (std::size_t i = 0; i < coefficient_count(lens.kind); ++i) all.append(lens.coefficients[i]);
    return nb::tuple(all);
}

void bind_lens(nb::module_& m) {
    nb::class_<Lens>(
        m, "Lens",
        "The distortion of a lens: 'pinhole' (none), 'brown_conrady' (k1 k2 p1 p2 k3 k4 k5 k6) or "
        "'fisheye' (k1 k2 k3 k4),\nas OpenCV and COLMAP have them; coefficients that are left out "
        "are 0.",
        nb::type_slots(kNoHash))
        .def(
            "__init__",
            [](Lens* self, const std::string& kind, nb::object coefficients) {
                new (self) Lens(make_lens(kind, coefficients));
            },
            nb::arg("kind") = "pinhole", nb::arg("coefficients").none() = nb::tuple(),
            nb::sig("def __init__(self, kind: str = 'pinhole', coefficients: "
                    "numpy.typing.ArrayLike = []) -> None"))
        .def_prop_ro("kind", [](const Lens& l) { return name_of(l.kind); })
        .def_prop_ro("coefficients", coefficients_of,
                     nb::sig("def coefficients(self) -> tuple[float, ...]"),
                     "As many as the kind has.")
        .def(Copyable{"kind", "coefficients"})
        .def(nb::self == nb::self, nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__repr__", [](const Lens& l) {
            return std::string("Lens('") + name_of(l.kind) + "', " + repr_of(coefficients_of(l)) +
                   ")";
        });
}

void init_camera(Camera* self, int width, int height, double focal_x, std::optional<double> focal_y,
                 std::optional<double> center_x, std::optional<double> center_y,
                 nb::object to_world, const Lens& lens) {
    new (self) Camera{width,
                      height,
                      focal_x,
                      focal_y.value_or(focal_x),
                      center_x.value_or(0.5 * width),
                      center_y.value_or(0.5 * height),
                      to_world.is_none() ? kIdentityMatrix : to_matrix(to_world, "camera_to_world"),
                      lens};
}

std::string sensor_name(nb::handle name) {
    if (nb::isinstance<nb::str>(name)) return text_of(name);
    if (PyIndex_Check(name.ptr()) && !PyBool_Check(name.ptr()))
        return std::to_string(to_count(name, "name", 0));
    throw type_error("name: expected the id of a sensor or its number, found " + repr_of(name));
}

void init_sensor(Sensor* self, nb::object name, int width, int height) {
    new (self) Sensor{sensor_name(name), width, height};
}

void bind_sensor(nb::module_& m) {
    nb::class_<Sensor>(m, "Sensor",
                       "A sensor of the scene file, by its id or its number from 0; '': the first "
                       "one, as the camera of a\nView the renderer's. width, height: of the "
                       "picture, in the place of the film's, unless both are 0.",
                       nb::type_slots(kNoHash))
        .def("__init__", &init_sensor, nb::arg("name").none() = "", nb::arg("width") = 0,
             nb::arg("height") = 0,
             nb::sig("def __init__(self, name: str | int = '', width: int = 0, height: int = 0) -> "
                     "None"))
        .def_rw("name", &Sensor::name)
        .def_rw("width", &Sensor::width)
        .def_rw("height", &Sensor::height)
        .def(Copyable{"name", "width", "height"})
        .def(nb::self == nb::self, nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__repr__", [](const Sensor& s) {
            return fmt::format("Sensor('{}', width={}, height={})", s.name, s.width, s.height);
        });
}

void bind_camera(nb::module_& m) {
    nb::class_<Camera>(m, "Camera",
                       "A camera with a lens. Sizes, focal lengths and the principal point are in "
                       "pixels; the upper left corner of the\nfirst pixel lies at (0, 0). "
                       "camera_to_world: a rotation and a translation, four rows of four numbers; "
                       "the\ncamera's x points right, y down, z forward.",
                       nb::type_slots(kNoHash))
        .def("__init__", init_camera, nb::arg("width"), nb::arg("height"), nb::arg("focal_x"),
             nb::arg("focal_y") = nb::none(), nb::arg("center_x") = nb::none(),
             nb::arg("center_y") = nb::none(), nb::arg("camera_to_world") = nb::none(),
             nb::arg("lens") = Lens{},
             nb::sig("def __init__(self, width: int, height: int, focal_x: float, focal_y: float | "
                     "None = None, center_x: float | None = None, center_y: float | None = None, "
                     "camera_to_world: numpy.typing.ArrayLike | None = None, lens: Lens = "
                     "Lens('pinhole')) -> None"))
        .def_rw("width", &Camera::width)
        .def_rw("height", &Camera::height)
        .def_rw("focal_x", &Camera::focal_x)
        .def_rw("focal_y", &Camera::focal_y)
        .def_rw("center_x", &Camera::center_x)
        .def_rw("center_y", &Camera::center_y)
        .def_prop_rw(
            "lens", [](const Camera& c) { return c.lens; },
            [](Camera& c, const Lens& lens) { c.lens = lens; })
        .def_prop_rw(
            "camera_to_world", [](const Camera& c) { return to_array(c.camera_to_world); },
            [](Camera& c, nb::object to_world) {
                c.camera_to_world = to_matrix(to_world, "camera_to_world");
            },
            nb::for_getter(
                nb::sig("def camera_to_world(self) -> numpy.typing.NDArray[numpy.float64]")))
        .def(
            "scaled",
            [](const Camera& c, double factor) {
                if (!(factor > 0 && factor <= 1))
                    throw InputError(
                        fmt::format("the factor is {}, expected one above 0, at most 1", factor));
                return scaled(c, factor);
            },
            nb::arg("factor"), "The camera of a picture at a fraction of its size.")
        .def(Copyable{"width", "height", "focal_x", "focal_y", "center_x", "center_y",
                      "camera_to_world", "lens"})
        .def(nb::self == nb::self, nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__repr__", [](const Camera& c) {
            return fmt::format("Camera({}, {}, focal_x={:f})", c.width, c.height, c.focal_x);
        });
}

std::string text_of_environment(const Environment& e) {
    const std::string image =
        e.image ? fmt::format("{} x {} pixels", e.image->width, e.image->height) : "None";
    return fmt::format("Environment({}, scale={})", image, repr_of(nb::cast(e.scale)));
}

nb::object emitters_of(const Lighting& lighting) {
    if (!lighting.emitters) return nb::none();
    return nb::tuple(nb::cast(*lighting.emitters));
}

/// An image that environments share, as one object of Python: a pickle has it once.
struct Sky {
    SharedImage image;
};

nb::object sky_of(const Environment& e) {
    if (!e.image) return nb::none();
    const nb::object known = nb::type<Sky>().attr("known");
    const nb::int_ key(reinterpret_cast<std::uintptr_t>(e.image.get()));
    nb::object sky = known.attr("get")(key);
    if (sky.is_none()) known[key] = sky = nb::cast(Sky{e.image});
    return sky;
}

void bind_sky(nb::module_& m) {
    nb::class_<Sky>(m, "_Sky", nb::is_weak_referenceable())
        .def("__init__",
             [](Sky* self, nb::object image) {
                 new (self) Sky{share(to_image(image, "the environment", Meaning::kColours))};
             })
        .def_prop_ro(
            "image",
            [](nb::handle self) { return view_of(*nb::cast<const Sky&>(self).image, self); })
        .def(Copyable{"image"})
        .attr("known") = nb::module_::import_("weakref").attr("WeakValueDictionary")();
}

void bind_environment(nb::module_& m) {
    nb::class_<Environment>(m, "Environment",
                            "Light from infinity. image: radiance [height, width, 3]; an "
                            "Environment: its image, which both then share;\nNone: that of the "
                            "scene. scale: of the radiance. to_world: a rotation.",
                            nb::type_slots(kNoHash))
        .def(
            "__init__",
            [](Environment* self, nb::object image, std::optional<double> scale,
               nb::object to_world) {
                Environment e;
                if (nb::isinstance<Environment>(image))
                    e.image = nb::cast<const Environment&>(image).image;
                else if (nb::isinstance<Sky>(image))
                    e.image = nb::cast<const Sky&>(image).image;
                else if (!image.is_none())
                    e.image = share(to_image(image, "the environment", Meaning::kColours));
                e.scale = scale;
                if (!to_world.is_none()) e.to_world = to_matrix(to_world, "to_world");
                new (self) Environment(std::move(e));
            },
            nb::arg("image") = nb::none(), nb::arg("scale") = nb::none(),
            nb::arg("to_world") = nb::none(),
            nb::sig("def __init__(self, image: numpy.typing.ArrayLike | Environment | None = None, "
                    "scale: float | None = None, to_world: numpy.typing.ArrayLike | None = None) "
                    "-> None"))
        .def_prop_ro(
            "image",
            [](nb::handle self) {
                const SharedImage& image = nb::cast<const Environment&>(self).image;
                return image ? view_of(*image, self) : nb::none();
            },
            nb::sig("def image(self) -> numpy.typing.NDArray[numpy.float32] | None"))
        .def_ro("scale", &Environment::scale)
        .def_prop_ro(
            "to_world",
            [](const Environment& e) { return e.to_world ? to_array(*e.to_world) : nb::none(); },
            nb::sig("def to_world(self) -> numpy.typing.NDArray[numpy.float64] | None"))
        .def_prop_ro("_sky", sky_of)
        .def(Copyable{"_sky", "scale", "to_world"})
        .def(nb::self == nb::self, nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__repr__", text_of_environment);
}

void bind_lighting(nb::module_& m) {
    nb::class_<Lighting>(
        m, "Lighting",
        "What shines. emitters: ids of those that are on; None: all of the scene. "
        "environment: in the place of the\nscene's; it is on whatever emitters says.",
        nb::type_slots(kNoHash))
        .def(
            "__init__",
            [](Lighting* self, std::optional<std::vector<std::string>> emitters,
               std::optional<Environment> environment) {
                new (self) Lighting{std::move(emitters), std::move(environment)};
            },
            nb::arg("emitters") = nb::none(), nb::arg("environment") = nb::none())
        .def_prop_ro("emitters", emitters_of,
                     nb::sig("def emitters(self) -> tuple[str, ...] | None"))
        .def_ro("environment", &Lighting::environment)
        .def(Copyable{"emitters", "environment"})
        .def(nb::self == nb::self, nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__repr__", [](const Lighting& l) {
            return "Lighting(emitters=" + repr_of(emitters_of(l)) + ", environment=" +
                   (l.environment ? text_of_environment(*l.environment) : "None") + ")";
        });
}

}  // namespace

void bind_cameras(nb::module_& m) {
    bind_lens(m);
    bind_sensor(m);
    bind_camera(m);
    bind_sky(m);
    bind_environment(m);
    bind_lighting(m);
}

}  // namespace burnish::python
