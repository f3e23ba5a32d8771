// What is to be recovered, and from what.
#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "burnish/error.h"
#include "core/count_of.h"
#include "core/parallel.h"
#include "core/variant.h"
#include "optimize/ranks.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/work.h"

namespace burnish::python {

Function::~Function() {
    const nb::gil_scoped_acquire gil;
    object_.reset();
}

std::uint32_t to_count(nb::handle value, const char* name, std::uint32_t low, std::uint32_t high) {
    const std::string expected =
        fmt::format("{}: expected a whole number from {} to {}, found ", name, low, high);
    if (!PyIndex_Check(value.ptr()) || PyBool_Check(value.ptr()))
        throw type_error(expected + repr_of(value));
    const nb::object number = nb::steal(PyNumber_Index(value.ptr()));
    if (!number.is_valid()) nb::raise_python_error();
    int overflow = 0;
    const long long n = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
    if (overflow != 0 || n < low || n > high) throw InputError(expected + text_of(number));
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

bool has_no_dimension(nb::handle value) {
    const nb::object ndim = nb::getattr(value, "ndim", nb::none());
    return !ndim.is_none() && ndim.equal(nb::int_(0));
}

/// "float32", "torch.float32"; empty: it has none.
std::string dtype_of(nb::handle value) {
    const nb::object dtype = nb::getattr(value, "dtype", nb::none());
    return dtype.is_none() ? "" : text_of(dtype);
}

bool is_scalar(nb::handle value) {
    if (PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr())) return true;
    const bool converts = nb::hasattr(value.type(), "__float__") || PyIndex_Check(value.ptr());
    const std::string dtype = dtype_of(value);
    if (dtype.empty()) return converts && !nb::hasattr(value, "ndim");
    const auto is_of = [&](const char* kind) { return dtype.find(kind) != std::string::npos; };
    return converts && has_no_dimension(value) && (is_of("float") || is_of("int") || is_of("bool"));
}

}  // namespace

std::optional<double> as_number(nb::handle value, const std::string& what) {
    if (!is_scalar(value)) return {};
    const nb::object number = nb::steal(PyNumber_Float(value.ptr()));
    if (number.is_valid()) return nb::cast<double>(number);
    PyErr_Clear();
    throw InputError(what + ": found " + repr_of(value) + ", expected a number");
}

std::optional<bool> as_bool(nb::handle value) {
    if (PyBool_Check(value.ptr())) return value.ptr() == Py_True;
    const std::string dtype = dtype_of(value);
    if ((dtype != "bool" && dtype != "torch.bool") || !has_no_dimension(value)) return {};
    return nb::cast<bool>(nb::object(value.attr("item")()));
}

namespace {

LossValue call_loss(const Function& loss, const Image& image, std::size_t view) {
    const CallFromWork call;
    const nb::object result = loss.get()(to_array(image), view);
    const bool is_pair = nb::isinstance<nb::tuple>(result) || nb::isinstance<nb::list>(result);
    if (!is_pair || nb::len(result) != 2)
        throw type_error("the loss returned " + type_of(result) +
                         ", expected a pair: its value and the adjoint dL/dI");
    LossValue value;
    const nb::object number = nb::steal(PyNumber_Float(nb::object(result[0]).ptr()));
    if (!number.is_valid()) nb::raise_python_error();
    value.value = nb::cast<double>(number);
    value.adjoint = to_image(nb::object(result[1]), "the adjoint of the loss", Meaning::kColours);
    if (value.adjoint.width != image.width || value.adjoint.height != image.height)
        throw InputError(
            fmt::format("the adjoint of the loss is [{}, {}, 3], expected the image's [{}, {}, 3]",
                        value.adjoint.height, value.adjoint.width, image.height, image.width));
    return value;
}

std::vector<std::string> call_exchange(const Function& exchange,
                                       const std::vector<std::string>& messages) {
    const CallFromWork call;
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
        throw type_error(fmt::format(
            "Ranks.exchange returned {}, expected a list with the bytes of each of {} processes",
            repr_of(result.type()), messages.size()));
    return came;
}

int rank_of(nb::handle ranks, const char* name) {
    int number = 0;
    const nb::object value = nb::getattr(ranks, name, nb::none());
    if (nb::try_cast(value, number)) return number;
    throw type_error("ranks: expected a burnish.Ranks of whole numbers, found " + repr_of(value) +
                     " as " + name + " of a " + type_of(ranks));
}

/// Of a burnish.Ranks, without its function.
Ranks to_ranks(nb::handle ranks) {
    const int rank = rank_of(ranks, "rank"), count = rank_of(ranks, "count");
    check_rank(rank, count);
    const nb::object exchange = nb::getattr(ranks, "exchange", nb::none());
    if (!PyCallable_Check(exchange.ptr()))
        throw type_error("Ranks.exchange: expected a function of a list of bytes, found " +
                         repr_of(exchange));
    return {rank, count, {}};
}

}  // namespace

Functions copy_of(const Functions& functions) {
    const auto copied = [](const std::shared_ptr<Function>& f) {
        return f ? std::make_shared<Function>(nb::borrow(f->get())) : nullptr;
    };
    return {copied(functions.loss), copied(functions.exchange)};
}

Problem with_functions(PythonProblem problem, const Flag& is_abandoned) {
    Problem whole = std::move(problem.problem);
    const Functions& own = problem.functions;
    if (own.exchange)
        whole.ranks.exchange = [exchange = own.exchange,
                                is_abandoned](std::vector<std::string> messages) {
            check_abandoned(is_abandoned);
            const Stoppable unstopped({});
            return call_exchange(*exchange, messages);
        };
    if (own.loss)
        whole.loss = [loss = own.loss, is_abandoned](const Image& image, std::size_t view) {
            check_abandoned(is_abandoned);
            const Stoppable unstopped({});  // in Python nobody knows Stopped
            return call_loss(*loss, image, view);
        };
    return whole;
}

namespace {

Start to_start(const std::string& name, nb::handle start) {
    if (start.is_none()) return SearchStart{};
    if (const auto number = as_number(start, "the start of " + name))
        return static_cast<float>(*number);
    return to_image(start, "the start of " + name);
}

nb::object start_of(nb::handle self) {
    return match(
        nb::cast<const Unknown&>(self).start,
        [](const SearchStart&) -> nb::object { return nb::none(); },
        [](float value) -> nb::object { return nb::float_(value); },
        [&](const Image& image) { return view_of(image, self); });
}

std::optional<double> learning_rate_of(const Unknown& unknown) {
    return unknown.learning_rate > 0 ? std::optional(unknown.learning_rate) : std::nullopt;
}

void bind_unknown(nb::module_& m) {
    nb::class_<Unknown>(m, "Unknown",
                        "A texture to recover. name: of its parameter, Mitsuba's or any short form "
                        "that means one texture. start: a value for\nall texels, an array of the "
                        "texture's size; None: searched from the pictures, with a loss of your own "
                        "0.5.\nlearning_rate: None: shared out among the unknowns of a "
                        "material.")
        .def(
            "__init__",
            [](Unknown* self, const std::string& name, nb::object start,
               std::optional<double> learning_rate) {
                if (learning_rate && !(*learning_rate > 0))
                    throw InputError(
                        fmt::format("the learning rate of {} is {:g}, expected one above 0", name,
                                    *learning_rate));
                new (self) Unknown{name, to_start(name, start), learning_rate.value_or(0)};
            },
            nb::arg("name"), nb::arg("start") = nb::none(), nb::arg("learning_rate") = nb::none(),
            nb::sig("def __init__(self, name: str, start: numpy.typing.ArrayLike | None = None, "
                    "learning_rate: float | None = None) -> None"))
        .def_ro("name", &Unknown::name)
        .def_prop_ro(
            "start", start_of,
            nb::sig("def start(self) -> float | numpy.typing.NDArray[numpy.float32] | None"))
        .def_prop_ro("learning_rate", learning_rate_of)
        .def(Copyable{"name", "start", "learning_rate"})
        .def("__repr__", [](const Unknown& u) { return "Unknown('" + u.name + "')"; });
}

Unknown to_unknown(nb::handle unknown) {
    if (nb::isinstance<Unknown>(unknown)) return nb::cast<Unknown>(unknown);
    if (nb::isinstance<nb::str>(unknown)) return {text_of(unknown)};
    throw type_error("unknowns: found " + type_of(unknown) + ", expected a name or an Unknown");
}

std::vector<Unknown> to_unknowns(nb::handle unknowns) {
    std::vector<Unknown> all;
    if (nb::isinstance<nb::str>(unknowns) || nb::isinstance<Unknown>(unknowns))
        all.push_back(to_unknown(unknowns));
    else if (nb::hasattr(unknowns, "items"))  // its values would be lost
        throw type_error("unknowns: found " + type_of(unknowns) +
                         ", expected names or Unknowns; a start is that of Unknown(name, "
                         "start=...)");
    else if (!nb::hasattr(unknowns, "__iter__"))
        throw type_error("unknowns: expected names or Unknowns, found " + repr_of(unknowns));
    else
        for (const nb::handle unknown : unknowns) all.push_back(to_unknown(unknown));
    return all;
}

int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (!nb::inst_ready(self)) return 0;
    const Functions& own = nb::inst_ptr<PythonProblem>(self)->functions;
    // A run of solve that goes on shares them.
    for (const auto* f : {&own.loss, &own.exchange})
        if (f->use_count() == 1) Py_VISIT((*f)->get().ptr());
    return 0;
}

int clear(PyObject* self) {
    if (nb::inst_ready(self)) nb::inst_ptr<PythonProblem>(self)->functions = {};
    return 0;
}

}  // namespace

void bind_problem(nb::module_& m) {
    bind_unknown(m);
    static PyType_Slot slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(traverse)},
                                  {Py_tp_clear, reinterpret_cast<void*>(clear)},
                                  {0, nullptr}};
    nb::class_<PythonProblem>(
        m, "Problem",
        "Textures to recover from pictures of a scene.\n\nviews: a View, an image, a file, or a "
        "list of these. unknowns: a name, an Unknown, or a list of these. loss: of your\nown, "
        "called with the whole image [height, width, 3] of a view, times its exposure, and the "
        "number of the view; it\nreturns its value and the adjoint dL/dI [height, width, 3]. The "
        "view's mask counts in psnr alone: apply it in the\nloss. None: that of the options. "
        "ranks: the processes that solve it together, each with the same problem: see\n"
        "burnish.mpi. None: this one alone.",
        nb::type_slots(slots))
        .def(
            "__init__",
            [](PythonProblem* self, const Renderer& renderer, nb::object views, nb::object unknowns,
               nb::object loss, nb::object ranks) {
                if (!loss.is_none() && !PyCallable_Check(loss.ptr()))
                    throw type_error(
                        "loss: expected a function of an image and the number of a view, found " +
                        repr_of(loss) + "; losses by name are options of solve");
                PythonProblem problem{{renderer, to_views(views), to_unknowns(unknowns), {}}};
                if (!loss.is_none()) problem.functions.loss = std::make_shared<Function>(loss);
                if (!ranks.is_none()) {
                    problem.problem.ranks = to_ranks(ranks);
                    problem.functions.exchange = std::make_shared<Function>(ranks.attr("exchange"));
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
            return fmt::format("Problem({}, {})", count_of(p.problem.views.size(), "view"),
                               count_of(p.problem.unknowns.size(), "unknown"));
        });
}

}  // namespace burnish::python
