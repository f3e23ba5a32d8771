// What a run says of itself: iterations, evaluations, states, summaries.
#include <fmt/format.h>
#include <nanobind/operators.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <limits>

#include "core/count_of.h"
#include "image/files.h"
#include "optimize/state.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/work.h"

namespace burnish::python {

std::vector<std::string> names_of(const Problem& problem) {
    std::vector<std::string> names;
    for (const Unknown& u : problem.unknowns) names.push_back(u.name);
    return names;
}

namespace {

template <auto member>
auto field_of() {
    return [](const PythonIteration& i) { return i.values.*member; };
}

int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (nb::inst_ready(self)) Py_VISIT(nb::inst_ptr<PythonIteration>(self)->solver.ptr());
    return 0;
}

int clear(PyObject* self) {
    if (nb::inst_ready(self)) nb::inst_ptr<PythonIteration>(self)->solver = nb::none();
    return 0;
}

void bind_iteration(nb::module_& m) {
    static PyType_Slot slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(traverse)},
                                  {Py_tp_clear, reinterpret_cast<void*>(clear)},
                                  {0, nullptr}};
    nb::class_<PythonIteration>(m, "Iteration", "What an iteration did.", nb::type_slots(slots))
        .def_prop_ro("number", field_of<&Iteration::number>(), "From 0.")
        .def_prop_ro("loss", field_of<&Iteration::loss>(),
                     "Of the iteration's noisy images, before its step, the mean over the views "
                     "that it visited: above that of\nconverged ones.")
        .def_prop_ro("held_out_loss", field_of<&Iteration::held_out_loss>(),
                     "After the step, where patience has checked it.")
        .def_prop_ro("seconds", field_of<&Iteration::seconds>(),
                     "At its end: of the run since its first iteration began, the callback's "
                     "included; of a Solver within its steps.")
        .def_prop_ro("image_seconds", field_of<&Iteration::image_seconds>())
        .def_prop_ro("derivative_seconds", field_of<&Iteration::derivative_seconds>())
        .def_prop_ro("step_seconds", field_of<&Iteration::step_seconds>())
        .def_prop_ro("paths", field_of<&Iteration::paths>(), "Behind the derivative.")
        .def_prop_ro(
            "rejected",
            [](const PythonIteration& i) {
                return i.values.rejected_image + i.values.rejected_derivatives;
            },
            "Contributions that were not finite and were left out.")
        .def_prop_ro(
            "textures",
            [](const PythonIteration& i) -> nb::object {
                if (!i.solver.is_none()) return i.solver.attr("textures");
                const Solver& solver = solver_of(i);
                nb::dict all;
                for (std::size_t k = 0; k < solver.problem().unknowns.size(); ++k)
                    all[solver.problem().unknowns[k].name.c_str()] = to_array(solver.texture(k));
                return all;
            },
            nb::sig("def textures(self) -> dict[str, numpy.typing.NDArray[numpy.float32]]"),
            "Those of the solver, without copies: they move on with its next iteration. In a "
            "callback of solve: copies.")
        .def("__repr__", [](const PythonIteration& i) {
            return fmt::format("Iteration({}, loss={:f}, seconds={:f})", i.values.number,
                               i.values.loss, i.values.seconds);
        });
}

void bind_evaluation(nb::module_& m) {
    nb::class_<ViewEvaluation>(m, "ViewEvaluation", "A view of textures, with fresh samples.")
        .def_prop_ro(
            "image",
            [](nb::handle self) {
                return view_of(nb::cast<const ViewEvaluation&>(self).image, self);
            },
            nb::sig("def image(self) -> numpy.typing.NDArray[numpy.float32] | None"),
            "[height, width, 3], before the view's exposure. None: another of the ranks has it; "
            "the "
            "first one has all.")
        .def_ro("exposure", &ViewEvaluation::exposure)
        .def_ro("loss", &ViewEvaluation::loss, "Of the image, its noise included.")
        .def_ro("noise_floor", &ViewEvaluation::noise_floor,
                "What the image's noise adds to the loss on average; NaN with 'l1' and with a loss "
                "of your own.")
        .def_ro("psnr", &ViewEvaluation::psnr,
                "In dB beside the view's picture, as they are shown, over the pixels that see an "
                "unknown; less what the image's noise adds to first order.");
    nb::class_<Evaluation>(m, "Evaluation", "Textures rendered with fresh samples.")
        .def_ro("loss", &Evaluation::loss, "The mean over the fitted views, noise included.")
        .def_ro("noise_floor", &Evaluation::noise_floor, "The mean over the fitted views.")
        .def_ro("views", &Evaluation::views, nb::rv_policy::reference_internal)
        .def_ro("samples_per_pixel", &Evaluation::samples_per_pixel)
        .def_ro("rejected", &Evaluation::rejected,
                "Contributions to all images that were not finite and were left out.")
        .def("__repr__", [](const Evaluation& e) {
            return fmt::format("Evaluation(loss={:f}, noise_floor={:f})", e.loss, e.noise_floor);
        });
}

nb::bytes to_bytes(const State& state) {
    const std::string bytes = compute([state](const Flag&) { return save_state(state); });
    return nb::bytes(bytes.data(), bytes.size());
}

State from_bytes(const nb::bytes& bytes) {
    return compute([text = std::string(bytes.c_str(), bytes.size())](const Flag&) {
        return load_state(text);
    });
}

void bind_state(nb::module_& m) {
    nb::class_<State>(m, "State",
                      "All that survives an iteration. A solver or a run that is given one goes on "
                      "from it, to the same bytes.",
                      nb::type_slots(kNoHash))
        .def(
            "save",
            [](const State& state, nb::object path) {
                compute([state, file = to_path(path)](const Flag&) {
                    write_bytes(file, save_state(state));
                    return true;
                });
            },
            nb::arg("path"), nb::sig("def save(self, path: str | os.PathLike[str]) -> None"),
            "Writes a file, whole or not at all.")
        .def_static(
            "load",
            [](nb::object path) {
                return compute(
                    [file = to_path(path)](const Flag&) { return load_state(read_bytes(file)); });
            },
            nb::arg("path"), nb::sig("def load(path: str | os.PathLike[str]) -> State"),
            "Reads what save has written.")
        .def("to_bytes", to_bytes)
        .def_static("from_bytes", from_bytes, nb::arg("data"))
        .def("__getstate__", to_bytes)
        .def("__setstate__",
             [](State& self, const nb::bytes& b) { new (&self) State(from_bytes(b)); })
        .def(nb::self == nb::self, nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__repr__", [](const State& s) {
            return fmt::format("State({})", count_of(s.values().iteration, "iteration"));
        });
}

using Field = Image RecoveredTexture::*;

/// {name: array} of one part of the textures, without copies; None where there is none.
template <Field field>
nb::dict textures_of(nb::handle self) {
    const auto& summary = nb::cast<const PythonSummary&>(self);
    nb::dict all;
    for (std::size_t i = 0; i < summary.names.size(); ++i)
        all[summary.names[i].c_str()] = view_of(summary.values.textures[i].*field, self);
    return all;
}

nb::list iterations_of(const PythonSummary& s) {
    nb::list all;
    for (const Iteration& i : s.values.iterations) all.append(PythonIteration{i});
    return all;
}

nb::list view_names_of(const PythonSummary& s) {
    nb::list all;
    for (const std::string& name : s.views) all.append(to_text(name));
    return all;
}

/// NaN: a run that was suspended has evaluated nothing.
double loss_of(const Evaluation& evaluation) {
    return evaluation.views.empty() ? std::numeric_limits<double>::quiet_NaN()
                                    : loss_without_noise(evaluation);
}

constexpr const char* kTexturesSignature =
    "(self) -> dict[str, numpy.typing.NDArray[numpy.float32]]";

void bind_summary(nb::module_& m) {
    nb::class_<PythonSummary> c(m, "Summary", "What a run found.");
    c.def_prop_ro("textures", textures_of<&RecoveredTexture::values>,
                  nb::sig((std::string("def textures") + kTexturesSignature).c_str()),
                  "The recovered textures, {name: [height, width, channels]}, linear, in [0, 1].");
    c.def_prop_ro("starts", textures_of<&RecoveredTexture::start>,
                  nb::sig((std::string("def starts") + kTexturesSignature).c_str()),
                  "The starts of the unknowns, given or searched; also of a run that went on from "
                  "a state, which began at the state's textures.");
    c.def_prop_ro("coverage", textures_of<&RecoveredTexture::coverage>,
                  nb::sig((std::string("def coverage") + kTexturesSignature).c_str()),
                  "The share of the iterations for which samples had visited each texel, "
                  "[height, width, 1].");
    c.def_prop_ro("confidence", textures_of<&RecoveredTexture::confidence>,
                  nb::sig("def confidence(self) -> dict[str, numpy.typing.NDArray[numpy.float32] | "
                          "None]"),
                  "How surely each texel is known, 0 to 1, [height, width, 1]; None where the "
                  "estimator does not say.");
    c.def_prop_ro("iterations", iterations_of, nb::sig("def iterations(self) -> list[Iteration]"),
                  "Every one; of more than 16,384 the last of every two, of twice as many that of "
                  "every four, and so on.");
    c.def_prop_ro(
        "iteration_count", [](const PythonSummary& s) { return s.values.counts.iterations; },
        "How many the run had.");
    c.def_prop_ro(
        "ending", [](const PythonSummary& s) { return name_of(s.values.ending); },
        "'iterations', 'time', 'patience', 'cancelled', or 'suspended': another of the ranks has "
        "stopped the run, and\nnothing is evaluated.");
    c.def_prop_ro(
        "seconds", [](const PythonSummary& s) { return s.values.seconds; },
        "Of the iterations, the callback's between them included.");
    c.def_prop_ro(
        "search_seconds", [](const PythonSummary& s) { return s.values.search_seconds; },
        "Of the search for the start.");
    c.def_prop_ro(
        "initial_loss", [](const PythonSummary& s) { return loss_of(s.values.start); },
        "Of start, without its noise floor where that is known: without noise on average. With "
        "'l1' and with a loss of your own it holds the noise of as many samples as loss.");
    c.def_prop_ro(
        "loss", [](const PythonSummary& s) { return loss_of(s.values.result); },
        "Of the result, to be compared with initial_loss. NaN, both, where the run was suspended.");
    c.def_prop_ro(
        "start", [](const PythonSummary& s) -> const Evaluation& { return s.values.start; },
        nb::rv_policy::reference_internal,
        "Of the textures where the run began, starts or those of the state that was given, with "
        "few samples; with as many as\nthe result where its noise floor is not known.");
    c.def_prop_ro(
        "result", [](const PythonSummary& s) -> const Evaluation& { return s.values.result; },
        nb::rv_policy::reference_internal, "Of the textures.");
    c.def_prop_ro("view_names", view_names_of, nb::sig("def view_names(self) -> list[str]"),
                  "Of each view of start and result, empty where it has none.");
    c.def_prop_ro(
        "state", [](const PythonSummary& s) { return s.values.state; },
        "From which the run can go on.");
    c.def("__repr__", [](const PythonSummary& s) {
        return fmt::format("Summary(loss {:f} -> {:f}, {}, {:f} seconds)", loss_of(s.values.start),
                           loss_of(s.values.result),
                           count_of(s.values.counts.iterations, "iteration"), s.values.seconds);
    });
}

}  // namespace

void bind_results(nb::module_& m) {
    bind_iteration(m);
    bind_evaluation(m);
    bind_state(m);
    bind_summary(m);
}

}  // namespace burnish::python
