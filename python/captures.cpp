// Pictures and cameras that are written down in files: captures, reconstructions, transforms.
#include "captures/capture.h"

#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "burnish/error.h"
#include "captures/pictures.h"
#include "captures/views.h"
#include "core/variant.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/work.h"

namespace burnish::python {

namespace {

struct PythonCapture {
    std::string scene;
    std::map<std::string, std::string> definitions;
    std::vector<View> views;
};

View with_picture(const CapturedView& captured, double scale) {
    if (captured.image.empty())
        throw InputError("the view " + captured.view.name +
                         " has no image: expected one, for no picture is rendered in its place");
    Photograph p = read_picture(captured, read_mask(captured).weights, scale,
                                "the target of " + captured.view.name);
    View view = captured.view;
    view.camera = match(
        view.camera,
        [&](const Sensor& s) -> ViewCamera {
            return Sensor{s.name, p.image.width, p.image.height};
        },
        [&](const Camera& c) -> ViewCamera { return scaled(c, scale); });
    view.mask = weights_of(p);
    view.image = std::move(p.image);
    return view;
}

std::vector<View> with_pictures(const std::vector<CapturedView>& captured, double scale,
                                const Flag& is_abandoned) {
    if (!(scale > 0 && scale <= 1))
        throw InputError(
            fmt::format("scale: found {:f}, expected a number above 0, at most 1", scale));
    std::vector<View> views;
    for (const CapturedView& c : captured) {
        check_abandoned(is_abandoned);
        views.push_back(with_picture(c, scale));
    }
    return views;
}

/// What follows cannot be written: it would be lost.
nb::object definitions_of(const PythonCapture& capture) {
    return nb::module_::import_("types").attr("MappingProxyType")(capture.definitions);
}

nb::tuple views_of(nb::handle self) {
    nb::list views;
    for (const View& view : nb::cast<const PythonCapture&>(self).views)
        views.append(nb::cast(view, nb::rv_policy::reference_internal, self));
    return nb::tuple(views);
}

PythonCapture read_whole_capture(nb::handle path, double scale) {
    return compute([file = to_path(path), scale](const Flag& is_abandoned) {
        Capture capture = read_capture(file);
        return PythonCapture{std::move(capture.scene), std::move(capture.definitions),
                             with_pictures(capture.views, scale, is_abandoned)};
    });
}

std::vector<View> read_all_views(nb::handle path, nb::handle images, double scale,
                                 nb::handle exposure) {
    const Exposure of_all = to_exposure(exposure);
    return compute([file = to_path(path), folder = images.is_none() ? "" : to_path(images), scale,
                    of_all](const Flag& is_abandoned) {
        std::vector<View> views = with_pictures(read_views(file, folder), scale, is_abandoned);
        for (View& view : views) view.exposure = of_all;
        return views;
    });
}

}  // namespace

void bind_captures(nb::module_& m) {
    nb::class_<PythonCapture>(m, "Capture",
                              "A scene and its views: load(capture.scene, "
                              "definitions=capture.definitions) is their renderer.")
        .def_prop_ro(
            "scene", [](const PythonCapture& c) { return from_path(c.scene); },
            nb::sig("def scene(self) -> str"), "Its file.")
        .def_prop_ro("definitions", definitions_of,
                     nb::sig("def definitions(self) -> types.MappingProxyType[str, str]"),
                     "Values of $names of the scene file.")
        .def_prop_ro("views", views_of, nb::sig("def views(self) -> tuple[View, ...]"))
        .def(
            "__repr__",
            [](const PythonCapture& c) {
                return to_text(fmt::format("Capture('{}', {} views)", c.scene, c.views.size()));
            },
            nb::sig("def __repr__(self) -> str"));
    m.def("read_capture", read_whole_capture, nb::arg("path"), nb::arg("scale") = 1.0,
          nb::sig("def read_capture(path: str | os.PathLike[str], scale: float = 1.0) -> Capture"),
          "Reads a capture.json with its pictures and masks. scale: of the pictures' size, in (0, "
          "1].");
    m.def("read_views", read_all_views, nb::arg("path"), nb::arg("images") = nb::none(),
          nb::arg("scale") = 1.0, nb::arg("exposure") = 1.0,
          nb::sig("def read_views(path: str | os.PathLike[str], images: str | os.PathLike[str] | "
                  "None = None, scale: float = 1.0, exposure: numpy.typing.ArrayLike | "
                  "typing.Literal['fit', 'fit_rgb'] = 1.0) -> list[View]"),
          "Reads the views of a COLMAP reconstruction (a folder) or a transforms.json, with their "
          "pictures. images: the folder\nof the pictures, which a reconstruction needs. "
          "exposure: of all views.");
}

}  // namespace burnish::python
