// Pictures, and what they were taken with.
#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include <algorithm>

#include "burnish/error.h"
#include "burnish/photograph.h"
#include "optimize/views.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/work.h"

namespace burnish::python {

Exposure to_exposure(nb::handle value) {
    const std::string expected = "a number, three numbers, 'fit' or 'fit_rgb'";
    if (nb::isinstance<nb::str>(value)) {
        const std::string name = text_of(value);
        if (name == "fit") return FitExposure{};
        if (name == "fit_rgb") return FitExposure{true};
        throw InputError("exposure: found " + repr_of(value) + ", expected " + expected);
    }
    if (const auto number = as_number(value, "exposure")) {
        const auto e = static_cast<float>(*number);
        return ExposureFactors{e, e, e};
    }
    const auto numbers = to_numbers(value, "exposure", expected, {3});
    ExposureFactors factors{};
    std::ranges::transform(numbers, factors.begin(),
                           [](double e) { return static_cast<float>(e); });
    return factors;
}

namespace {

nb::object from_exposure(const Exposure& exposure) {
    if (const auto* fit = std::get_if<FitExposure>(&exposure))
        return nb::str(fit->by_channel ? "fit_rgb" : "fit");
    return nb::tuple(nb::cast(std::get<ExposureFactors>(exposure)));
}

bool is_path(nb::handle value) {
    return nb::isinstance<nb::str>(value) || nb::hasattr(value, "__fspath__");
}

/// A file is read as a photograph: its weights and a mask become one.
void set_picture(nb::handle image, nb::handle mask, View& view) {
    if (!is_path(image)) {
        view.image = to_image(image, "the image of the view", Meaning::kColours);
        if (!mask.is_none()) view.mask = to_image(mask, "the mask of the view", Meaning::kWeights);
        return;
    }
    std::optional<Image> own;
    if (!mask.is_none()) own = to_image(mask, "the mask of the view", Meaning::kWeights);
    Photograph p = compute([file = to_path(image), own](const Flag&) {
        Photograph read = read_photograph(file);
        if (own) add_mask(*own, read);
        return read;
    });
    view.mask = weights_of(p);
    view.image = std::move(p.image);
}

View make_view(nb::handle image, nb::handle mask, const std::string& name,
               const std::optional<ViewCamera>& camera, const std::optional<Lighting>& lighting,
               nb::handle exposure, nb::handle held_out) {
    const std::optional<bool> is_held_out = as_bool(held_out);
    if (!is_held_out)
        throw type_error("held_out: expected True or False, found " + repr_of(held_out));
    View view;
    set_picture(image, mask, view);
    view.name = name;
    if (camera) view.camera = *camera;
    if (lighting) view.lighting = *lighting;
    view.exposure = to_exposure(exposure);
    view.held_out = *is_held_out;
    return view;
}

/// Through its camera; the lights do not matter.
View without_background(const Renderer& renderer, const View& view) {
    return compute([renderer, masked = view](const Flag&) mutable {
        naming_view(masked, 0, 1, [&] {
            const bool is_renderers = masked.camera == ViewCamera{};
            mask_background(is_renderers ? renderer : renderer.with_camera(masked.camera), masked);
        });
        return std::move(masked);
    });
}

}  // namespace

void bind_view(nb::module_& m) {
    nb::class_<View>(
        m, "View",
        "A picture to match.\n\nimage: [height, width, 3], linear RGB radiance; or a "
        "file, read as read_photograph does. mask: weights of pixels\n[height, width, "
        "1 or 3]. camera: None: the renderer's; of one that was loaded the scene's "
        "first sensor. lighting:\nlikewise. exposure: of the rendered image, before "
        "it meets `image`: a number, three, 'fit' (the one that fits best),\n'fit_rgb' "
        "(one for each channel). held_out: never fitted, evaluated at the end only.")
        .def(
            "__init__",
            [](View* self, nb::object image, nb::object mask, const std::string& name,
               const std::optional<ViewCamera>& camera, const std::optional<Lighting>& lighting,
               nb::object exposure, nb::object held_out) {
                new (self) View(make_view(image, mask, name, camera, lighting, exposure, held_out));
            },
            nb::arg("image"), nb::arg("mask") = nb::none(), nb::arg("name") = "",
            nb::arg("camera") = nb::none(), nb::arg("lighting") = nb::none(),
            nb::arg("exposure").none() = 1.0, nb::arg("held_out").none() = false,
            nb::sig("def __init__(self, image: numpy.typing.ArrayLike | os.PathLike[str], mask: "
                    "numpy.typing.ArrayLike | None = None, name: str = '', camera: Sensor | Camera "
                    "| None = None, lighting: Lighting | None = None, exposure: "
                    "numpy.typing.ArrayLike | "
                    "typing.Literal['fit', 'fit_rgb'] = 1.0, held_out: bool = False) -> None"))
        .def_prop_ro(
            "image",
            [](nb::handle self) { return view_of(nb::cast<const View&>(self).image, self); },
            nb::sig("def image(self) -> numpy.typing.NDArray[numpy.float32]"))
        .def_prop_ro(
            "mask", [](nb::handle self) { return view_of(nb::cast<const View&>(self).mask, self); },
            nb::sig("def mask(self) -> numpy.typing.NDArray[numpy.float32] | None"))
        .def_prop_ro(
            "name", [](const View& v) { return to_text(v.name); }, nb::sig("def name(self) -> str"))
        .def_ro("camera", &View::camera)
        .def_ro("lighting", &View::lighting)
        .def_prop_ro(
            "exposure", [](const View& v) { return from_exposure(v.exposure); },
            nb::sig("def exposure(self) -> tuple[float, float, float] | str"))
        .def_ro("held_out", &View::held_out)
        .def(Copyable{"image", "mask", "name", "camera", "lighting", "exposure", "held_out"})
        .def(
            "__repr__",
            [](const View& v) {
                return to_text(fmt::format("View('{}', {} x {} pixels)", v.name, v.image.width,
                                           v.image.height));
            },
            nb::sig("def __repr__(self) -> str"));
    m.def(
        "mask_background", without_background, nb::arg("renderer"), nb::arg("view"),
        nb::sig("def mask_background(renderer: Renderer, view: View) -> View"),
        "The view with the weight 0 for the pixels that show no surface of the scene, or the "
        "edge of one, through its camera.\nThrows InputError: the image or the mask does not fit, "
        "the camera has an aperture, no other pixel is left, or\neach of these has the weight 0.");
}

namespace {

bool is_list(nb::handle value) {
    return nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value);
}

/// Whether it is one picture, [height, width, 3], of lists to some depth: rows, or numbers.
bool is_picture(nb::handle list) {
    constexpr int kDimensions = 3;
    nb::object first = nb::borrow(list);
    int depth = 0;
    for (; depth <= kDimensions && is_list(first) && nb::len(first) > 0; ++depth) first = first[0];
    const nb::object own = nb::getattr(first, "ndim", nb::int_(0));
    return own.equal(nb::int_(kDimensions - depth));
}

/// A View, or a picture alone.
View to_view(nb::handle value) {
    if (nb::isinstance<View>(value)) return nb::cast<View>(value);
    View view;
    set_picture(value, nb::none(), view);
    return view;
}

}  // namespace

std::vector<View> to_views(nb::handle views) {
    std::vector<View> all;
    if (is_list(views) && !is_picture(views))
        for (const nb::handle view : views) all.push_back(to_view(view));
    else
        all.push_back(to_view(views));
    return all;
}

}  // namespace burnish::python
