// What is to be recovered, and from what.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include <cmath>

#include "burnish/error.h"
#include "burnish/photograph.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/work.h"

namespace burnish::python {

Function::~Function() {
    const nb::gil_scoped_acquire gil;
    object_.reset();
}

std::uint32_t to_count(nb::handle value, const char* name, std::uint32_t low) {
    const std::string expected = std::string(name) + ": expected a whole number from " +
                                 std::to_string(low) + " to 4294967295, found ";
    if (!PyIndex_Check(value.ptr()) || PyBool_Check(value.ptr()))
        throw nb::type_error((expected + repr_of(value)).c_str());
    const nb::object number = nb::steal(PyNumber_Index(value.ptr()));
    if (!number.is_valid()) nb::raise_python_error();
    int overflow = 0;
    const long long n = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
    if (overflow != 0 || n < low || n > 0xffffffffLL) throw InputError(expected + text_of(number));
    return static_cast<std::uint32_t>(n);
}

std::string to_path(nb::handle path) {
    const nb::object text = nb::steal(PyOS_FSPath(path.ptr()));
    if (!text.is_valid()) nb::raise_python_error();
    PyObject* bytes = nullptr;
    if (!PyUnicode_FSConverter(text.ptr(), &bytes)) nb::raise_python_error();
    const nb::bytes encoded = nb::steal<nb::bytes>(bytes);
    return {encoded.c_str(), encoded.size()};
}

namespace {

/// A number in the place of an array.
std::optional<double> as_number(nb::handle value) {
    if (!PyFloat_Check(value.ptr()) && !PyLong_Check(value.ptr())) return {};
    return nb::cast<double>(value);
}

}  // namespace

TextureValues to_textures(nb::handle textures, const Renderer& renderer) {
    TextureValues values;
    if (textures.is_none()) return values;
    if (!nb::hasattr(textures, "items"))
        throw nb::type_error("textures: expected a mapping of names to arrays");
    for (const nb::handle item : textures.attr("items")()) {
        const std::string name = text_of(nb::object(item[0]));
        const nb::object value = item[1];
        if (const auto number = as_number(value)) {
            if (!std::isfinite(*number))
                throw InputError(name + ": found " + repr_of(value) + ", expected a finite number");
            Image image = renderer.texture(name);
            std::fill(image.values.begin(), image.values.end(), static_cast<float>(*number));
            values[name] = std::move(image);
        } else {
            values[name] = to_image(value, name);
        }
    }
    return values;
}

namespace {

LossValue call_loss(const Function& loss, const Image& image, std::size_t view) {
    const nb::gil_scoped_acquire gil;
    const nb::object result = loss.get()(to_array(image), view);
    const bool is_pair = nb::isinstance<nb::tuple>(result) || nb::isinstance<nb::list>(result);
    if (!is_pair || nb::len(result) != 2)
        throw nb::type_error((std::string("the loss returned ") + type_of(result) +
                              ", expected a pair: its value and the adjoint dL/dI")
                                 .c_str());
    LossValue value;
    const nb::object number = nb::steal(PyNumber_Float(nb::object(result[0]).ptr()));
    if (!number.is_valid()) nb::raise_python_error();
    value.value = nb::cast<double>(number);
    value.adjoint = to_image(nb::object(result[1]), "the adjoint of the loss");
    if (value.adjoint.width != image.width || value.adjoint.height != image.height ||
        value.adjoint.channels != 3)
        throw InputError("the adjoint of the loss is [" + std::to_string(value.adjoint.height) +
                         ", " + std::to_string(value.adjoint.width) + ", " +
                         std::to_string(value.adjoint.channels) + "], expected the image's [" +
                         std::to_string(image.height) + ", " + std::to_string(image.width) +
                         ", 3]");
    return value;
}

std::vector<std::string> call_exchange(const Function& exchange,
                                       const std::vector<std::string>& messages) {
    const nb::gil_scoped_acquire gil;
    nb::list sent;
    for (const std::string& message : messages)
        sent.append(nb::bytes(message.data(), message.size()));
    const nb::object result = exchange.get()(sent);
    std::vector<std::string> came;
    if (nb::isinstance<nb::list>(result))
        for (const nb::handle message : result) {
            if (!nb::isinstance<nb::bytes>(message)) break;
            const auto bytes = nb::cast<nb::bytes>(message);
            came.emplace_back(bytes.c_str(), bytes.size());
        }
    if (came.size() != messages.size())
        throw nb::type_error(("Ranks.exchange returned " + repr_of(result.type()) +
                              ", expected a list with the bytes of each of " +
                              std::to_string(messages.size()) + " processes")
                                 .c_str());
    return came;
}

/// Of a burnish.Ranks, without its function.
Ranks to_ranks(nb::handle ranks) {
    const auto rank = nb::cast<int>(ranks.attr("rank")), count = nb::cast<int>(ranks.attr("count"));
    if (count < 1 || rank < 0 || rank >= count)
        throw InputError("the ranks are process " + std::to_string(rank) + " of " +
                         std::to_string(count) + ", expected one from 0 to their number less one");
    if (!PyCallable_Check(nb::object(ranks.attr("exchange")).ptr()))
        throw nb::type_error("Ranks.exchange: expected a function of a list of bytes");
    return {rank, count, {}};
}

}  // namespace

Problem with_functions(const PythonProblem& problem, const Flag& is_abandoned) {
    Problem copy = problem.problem;
    if (problem.exchange)
        copy.ranks.exchange = [exchange = problem.exchange,
                               is_abandoned](std::vector<std::string> messages) {
            check_abandoned(is_abandoned);
            return call_exchange(*exchange, messages);
        };
    if (problem.loss)
        copy.loss = [loss = problem.loss, is_abandoned](const Image& image, std::size_t view) {
            check_abandoned(is_abandoned);
            return call_loss(*loss, image, view);
        };
    return copy;
}

Exposure to_exposure(nb::handle value) {
    if (nb::isinstance<nb::str>(value)) {
        const std::string name = nb::cast<std::string>(value);
        if (name == "fit") return FitExposure{};
        if (name == "fit_rgb") return FitExposure{true};
    } else if (const auto number = as_number(value)) {
        const auto e = static_cast<float>(*number);
        return ExposureFactors{e, e, e};
    } else if (ExposureFactors factors; nb::try_cast(value, factors)) {
        return factors;
    }
    throw InputError(std::string("exposure: found ") + repr_of(value) +
                     ", expected a number, three numbers, 'fit' or 'fit_rgb'");
}

namespace {

nb::object from_exposure(const Exposure& exposure) {
    if (const auto* fit = std::get_if<FitExposure>(&exposure))
        return nb::str(fit->by_channel ? "fit_rgb" : "fit");
    return nb::cast(std::get<ExposureFactors>(exposure));
}

bool is_path(nb::handle value) {
    return nb::isinstance<nb::str>(value) || nb::hasattr(value, "__fspath__");
}

/// A file is read as a photograph: its weights and a mask become one.
void set_picture(nb::handle image, nb::handle mask, View& view) {
    if (!is_path(image)) {
        view.image = to_image(image, "the image of the view");
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
               const std::optional<ViewCamera>& camera, const Lighting& lighting,
               nb::handle exposure, bool held_out) {
    View view;
    set_picture(image, mask, view);
    view.name = name;
    if (camera) view.camera = *camera;
    view.lighting = lighting;
    view.exposure = to_exposure(exposure);
    view.held_out = held_out;
    return view;
}

void bind_view(nb::module_& m) {
    nb::class_<View>(m, "View",
                     "A picture to match.\n\nimage: [height, width, 3], linear RGB radiance; or a "
                     "file, read as read_photograph does. mask: weights of pixels\n[height, width, "
                     "1 or 3]. camera: None: the scene's first sensor. exposure: of the rendered "
                     "image, before it meets\n`image`: a number, three, 'fit' (the one that fits "
                     "best), 'fit_rgb' (one for each channel). held_out: never fitted,\nevaluated "
                     "at the end only.")
        .def(
            "__init__",
            [](View* self, nb::object image, nb::object mask, const std::string& name,
               const std::optional<ViewCamera>& camera, const Lighting& lighting,
               nb::object exposure, bool held_out) {
                new (self) View(make_view(image, mask, name, camera, lighting, exposure, held_out));
            },
            nb::arg("image"), nb::arg("mask") = nb::none(), nb::arg("name") = "",
            nb::arg("camera") = nb::none(), nb::arg("lighting") = Lighting{},
            nb::arg("exposure") = 1.0, nb::arg("held_out") = false,
            nb::sig("def __init__(self, image: numpy.typing.ArrayLike | os.PathLike[str], mask: "
                    "numpy.typing.ArrayLike | None = None, name: str = '', camera: Sensor | Camera "
                    "| None = None, lighting: Lighting = ..., exposure: float | "
                    "collections.abc.Sequence[float] | typing.Literal['fit', 'fit_rgb'] = 1.0, "
                    "held_out: bool = False) -> None"))
        .def_prop_ro(
            "image",
            [](nb::handle self) { return view_of(nb::cast<const View&>(self).image, self); },
            nb::sig("def image(self) -> numpy.typing.NDArray[numpy.float32]"))
        .def_prop_ro(
            "mask", [](const View& v) { return to_array(v.mask); },
            nb::sig("def mask(self) -> numpy.typing.NDArray[numpy.float32] | None"))
        .def_ro("name", &View::name)
        .def_ro("camera", &View::camera)
        .def_ro("lighting", &View::lighting)
        .def_prop_ro(
            "exposure", [](const View& v) { return from_exposure(v.exposure); },
            nb::sig("def exposure(self) -> list[float] | str"))
        .def_ro("held_out", &View::held_out)
        .def("__repr__", [](const View& v) {
            return "View('" + v.name + "', " + std::to_string(v.image.width) + " x " +
                   std::to_string(v.image.height) + " pixels)";
        });
}

Start to_start(const std::string& name, nb::handle start) {
    if (start.is_none()) return SearchStart{};
    if (const auto number = as_number(start)) return static_cast<float>(*number);
    return to_image(start, "the start of " + name);
}

void bind_unknown(nb::module_& m) {
    nb::class_<Unknown>(m, "Unknown",
                        "A texture to recover. name: of its parameter, Mitsuba's or any short form "
                        "that means one texture. start: a value for\nall texels, an array of the "
                        "texture's size; None: searched from the pictures. learning_rate: None: "
                        "shared out\namong the unknowns of a material.")
        .def(
            "__init__",
            [](Unknown* self, const std::string& name, nb::object start,
               std::optional<double> learning_rate) {
                if (learning_rate && !(*learning_rate > 0))
                    throw InputError("the learning rate of " + name + " is " +
                                     std::to_string(*learning_rate) + ", expected one above 0");
                new (self) Unknown{name, to_start(name, start), learning_rate.value_or(0)};
            },
            nb::arg("name"), nb::arg("start") = nb::none(), nb::arg("learning_rate") = nb::none(),
            nb::sig("def __init__(self, name: str, start: numpy.typing.ArrayLike | None = None, "
                    "learning_rate: float | None = None) -> None"))
        .def_ro("name", &Unknown::name)
        .def("__repr__", [](const Unknown& u) { return "Unknown('" + u.name + "')"; });
}

std::vector<View> to_views(nb::handle views) {
    std::vector<View> all;
    if (nb::isinstance<View>(views)) {
        all.push_back(nb::cast<View>(views));
    } else if (nb::isinstance<nb::list>(views) || nb::isinstance<nb::tuple>(views)) {
        for (const nb::handle view : views)
            if (nb::isinstance<View>(view))
                all.push_back(nb::cast<View>(view));
            else
                all.push_back(make_view(view, nb::none(), "", {}, {}, nb::float_(1.0), false));
    } else {
        all.push_back(make_view(views, nb::none(), "", {}, {}, nb::float_(1.0), false));
    }
    return all;
}

Unknown to_unknown(nb::handle unknown) {
    if (nb::isinstance<Unknown>(unknown)) return nb::cast<Unknown>(unknown);
    if (nb::isinstance<nb::str>(unknown)) return {nb::cast<std::string>(unknown)};
    throw nb::type_error(
        (std::string("unknowns: found ") + type_of(unknown) + ", expected a name or an Unknown")
            .c_str());
}

std::vector<Unknown> to_unknowns(nb::handle unknowns) {
    std::vector<Unknown> all;
    if (nb::isinstance<nb::str>(unknowns) || nb::isinstance<Unknown>(unknowns))
        all.push_back(to_unknown(unknowns));
    else
        for (const nb::handle unknown : unknowns) all.push_back(to_unknown(unknown));
    return all;
}

}  // namespace

void bind_problem(nb::module_& m) {
    bind_view(m);
    bind_unknown(m);
    nb::class_<PythonProblem>(
        m, "Problem",
        "Textures to recover from pictures of a scene.\n\nviews: a View, an image, a file, or a "
        "list of these. unknowns: a name, an Unknown, or a list of these. loss: of your\nown, "
        "called with the image [height, width, 3] of a view and the number of the view; it returns "
        "its value and the adjoint\ndL/dI [height, width, 3]. None: that of the options. ranks: "
        "the "
        "processes that solve it together, each with the\nsame problem: see burnish.mpi. None: "
        "this "
        "one alone.")
        .def(
            "__init__",
            [](PythonProblem* self, const Renderer& renderer, nb::object views, nb::object unknowns,
               nb::object loss, nb::object ranks) {
                if (!loss.is_none() && !PyCallable_Check(loss.ptr()))
                    throw nb::type_error(
                        "loss: expected a function of an image and the number of "
                        "a view; losses by name are options of solve");
                PythonProblem problem{{renderer, to_views(views), to_unknowns(unknowns), {}}};
                if (!loss.is_none()) problem.loss = std::make_shared<Function>(loss);
                if (!ranks.is_none()) {
                    problem.problem.ranks = to_ranks(ranks);
                    problem.exchange = std::make_shared<Function>(ranks.attr("exchange"));
                }
                new (self) PythonProblem(std::move(problem));
            },
            nb::arg("renderer"), nb::arg("views"), nb::arg("unknowns"),
            nb::arg("loss") = nb::none(), nb::arg("ranks") = nb::none(),
            nb::sig("def __init__(self, renderer: Renderer, views: View | numpy.typing.ArrayLike | "
                    "os.PathLike[str] | collections.abc.Sequence[View | numpy.typing.ArrayLike | "
                    "os.PathLike[str]], unknowns: str | Unknown | collections.abc.Iterable[str | "
                    "Unknown], loss: "
                    "collections.abc.Callable[[numpy.typing.NDArray[numpy.float32], int], "
                    "tuple[float, numpy.typing.ArrayLike]] | None = None, ranks: "
                    "burnish._ranks.Ranks | None = None) -> None"))
        .def_prop_ro("renderer", [](const PythonProblem& p) { return p.problem.renderer; })
        .def("__repr__", [](const PythonProblem& p) {
            return "Problem(" + std::to_string(p.problem.views.size()) + " views, " +
                   std::to_string(p.problem.unknowns.size()) + " unknowns)";
        });
}

}  // namespace burnish::python
