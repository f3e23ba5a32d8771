// Pictures and cameras that are written down in files: captures, reconstructions, transforms.
#include "captures/capture.h"

#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "burnish/error.h"
#include "captures/pictures.h"
#include "captures/views.h"
#include "core/at_place.h"
#include "core/count_of.h"
#include "core/variant.h"
#include "optimize/views.h"
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
        at_place(captured.places.view, [&] {
            throw InputError(
                "the view " + captured.view.name +
                " has no image: expected one, for no picture is rendered in its place");
        });
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
            fmt::format("scale: found {}, expected a number above 0, at most 1", scale));
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

std::vector<std::string> to_view_names(nb::handle names) {
    if (nb::isinstance<nb::str>(names)) return {text_of(names)};
    const std::string expected = "held_out: expected names of views, found ";
    if (!nb::hasattr(names, "__iter__")) throw type_error(expected + repr_of(names));
    std::vector<std::string> all;
    for (const nb::handle name : names) {
        if (!nb::isinstance<nb::str>(name)) throw type_error(expected + repr_of(name));
        all.push_back(text_of(name));
    }
    return all;
}

void hold_out(const std::vector<std::string>& held_out, std::vector<CapturedView>& views) {
    std::vector<std::string> names;
    for (const CapturedView& v : views) names.push_back(v.view.name);
    for (const std::string& name : held_out)
        views[find_view(names, name, "held_out")].view.held_out = true;
}

PythonCapture read_whole_capture(nb::handle path, double scale, nb::handle held_out) {
    return compute(
        [file = to_path(path), scale, names = to_view_names(held_out)](const Flag& is_abandoned) {
            Capture capture = read_capture(file);
            hold_out(names, capture.views);
            return PythonCapture{std::move(capture.scene), std::move(capture.definitions),
                                 with_pictures(capture.views, scale, is_abandoned)};
        });
}

std::vector<View> read_all_views(nb::handle path, nb::handle images, double scale,
                                 nb::handle exposure, nb::handle held_out) {
    const Exposure of_all = to_exposure(exposure);
    return compute([file = to_path(path), folder = images.is_none() ? "" : to_path(images), scale,
                    of_all, names = to_view_names(held_out)](const Flag& is_abandoned) {
        std::vector<CapturedView> views = read_views(file, folder);
        for (CapturedView& v : views) v.view.exposure = of_all;
        hold_out(names, views);
        return with_pictures(views, scale, is_abandoned);
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
                return to_text(
                    fmt::format("Capture('{}', {})", c.scene, count_of(c.views.size(), "view")));
            },
            nb::sig("def __repr__(self) -> str"));
    m.def(
        "read_capture", read_whole_capture, nb::arg("path"), nb::arg("scale") = 1.0,
        nb::arg("held_out").none() = nb::tuple(),
        nb::sig("def read_capture(path: str | os.PathLike[str], scale: float = 1.0, held_out: "
                "collections.abc.Iterable[str] = ()) -> Capture"),
        "Reads a capture.json with its pictures and masks. scale: of the pictures' size, in (0, "
        "1]. held_out: names of views\nthat are not fitted, but evaluated, besides those that the "
        "file holds out. The scene is not read: the picture of a\nsensor may be a row shorter than "
        "its film's aspect ratio asks for, which the program refuses.");
    m.def("read_views", read_all_views, nb::arg("path"), nb::arg("images") = nb::none(),
          nb::arg("scale") = 1.0, nb::arg("exposure").none() = 1.0,
          nb::arg("held_out").none() = nb::tuple(),
          nb::sig("def read_views(path: str | os.PathLike[str], images: str | os.PathLike[str] | "
                  "None = None, scale: float = 1.0, exposure: numpy.typing.ArrayLike | "
                  "typing.Literal['fit', 'fit_rgb'] = 1.0, held_out: "
                  "collections.abc.Iterable[str] = ()) -> list[View]"),
          "Reads the views of a COLMAP reconstruction (a folder) or a transforms.json, with their "
          "pictures. images: the folder\nof the pictures, which a reconstruction needs. "
          "exposure: of all views. held_out: names of views that are not fitted,\nbut evaluated.");
}

}  // namespace burnish::python
