// The solver.
#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "burnish/error.h"
#include "core/count_of.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/options.h"
#include "python/work.h"
#include "render/renderer.h"

namespace burnish::python {

namespace {

/// What the solver's work owns. Used by one thread at a time: the worker's, or that of a call for
/// which it rests.
struct Run {
    explicit Run(Solver s) : solver(std::move(s)) {}
    Solver solver;
    std::optional<Iteration> made;  ///< by a step, until it is handed over
    bool has_ended = false;         ///< a step has failed, and none can follow
};

struct PythonSolver {
    std::shared_ptr<Run> run;
    std::vector<std::string> names;
    Functions functions;  ///< the run's, for the garbage collector
    std::size_t views = 0;
    std::unique_ptr<Worker> worker = std::make_unique<Worker>();
};

PythonSolver make_solver(const PythonProblem& problem, const State* state,
                         const nb::kwargs& given) {
    const Options options = options_of(given, "Solver", problem);
    const Flag goes_on = std::make_shared<std::atomic<bool>>(false);
    PythonSolver made;
    made.names = names_of(problem.problem);
    made.views = problem.problem.views.size();
    made.functions = copy_of(problem.functions);
    made.run = compute([problem = with_functions({problem.problem, made.functions}, goes_on),
                        options, state, owner = owner_of(state)](const Flag& is_abandoned) mutable {
        const StageProgress progress = [&](const char*, double) { check_abandoned(is_abandoned); };
        return std::make_shared<Run>(state ? Solver(std::move(problem), options, *state)
                                           : Solver(std::move(problem), options, progress));
    });
    return made;
}

/// What fails before the optimiser's step leaves the solver as it was, and so does a loss that
/// raises in a check after it. ResourceError: the step is half done. Of several processes the
/// others may have gone on: any failure ends the solver.
void step(Run& run) {
    if (run.has_ended)
        throw Error(
            "an iteration of this solver has failed half-way: begin another solver, from a state "
            "that was kept before");
    const bool has_others = run.solver.problem().ranks.count > 1;
    try {
        run.made = run.solver.step();
    } catch (const ResourceError&) {
        run.has_ended = true;
        throw;
    } catch (...) {
        run.has_ended = has_others;
        throw;
    }
}

/// One step; none where a rule has ended the loop, if rules count. Where Ctrl-C ends the waiting
/// for it, the next call hands it over.
std::optional<Iteration> advance(PythonSolver& solver, bool rules_count) {
    std::optional<Iteration> made;
    solver.worker->run(
        [run = solver.run, rules_count] {
            const bool is_over = rules_count && run->solver.ending();
            if (!run->made && !is_over) step(*run);
        },
        [&] { made = std::exchange(solver.run->made, {}); });
    return made;
}

PythonIteration step_once(nb::handle self) {
    return {*advance(nb::cast<PythonSolver&>(self), false), nb::borrow(self)};
}

/// StopIteration of a loss is an error, as that of a generator's body is: it would end the loop.
PythonIteration next(nb::handle self) {
    auto& solver = nb::cast<PythonSolver&>(self);
    std::optional<Iteration> made;
    try {
        made = advance(solver, true);
    } catch (nb::python_error& e) {
        if (!e.matches(PyExc_StopIteration)) throw;
        nb::raise_from(e, PyExc_RuntimeError, "the loss raised StopIteration");
    }
    if (!made) throw nb::stop_iteration();
    return {*made, nb::borrow(self)};
}

/// Of what an iteration leaves, while none is under way.
template <class Body>
auto resting(PythonSolver& solver, const Body& body) {
    solver.worker->wait();
    return body(solver.run->solver);
}

std::size_t checked_view(const PythonSolver& solver, std::size_t view) {
    if (view < solver.views) return view;
    throw nb::index_error(
        fmt::format("view: found {}, the problem has {}", view, solver.views).c_str());
}

nb::dict textures(nb::handle self) {
    const auto& solver = nb::cast<const PythonSolver&>(self);
    nb::dict all;
    for (std::size_t i = 0; i < solver.names.size(); ++i)
        all[solver.names[i].c_str()] = view_of(solver.run->solver.texture(i), self);
    return all;
}

template <class Result, class Body>
Result work(PythonSolver& solver, Body body) {
    auto result = std::make_shared<std::optional<Result>>();
    solver.worker->run([=, run = solver.run] { result->emplace(body(run->solver)); });
    return std::move(**result);
}

nb::dict recovered(PythonSolver& solver) {
    auto textures =
        work<std::vector<RecoveredTexture>>(solver, [](const Solver& s) { return s.recovered(); });
    nb::dict all;
    for (std::size_t i = 0; i < textures.size(); ++i)
        all[solver.names[i].c_str()] = to_array(std::move(textures[i].values));
    return all;
}

/// Whether nothing but the solver holds the run: work that goes on does, too, and calls its
/// functions.
bool rests(const PythonSolver& solver) { return solver.run.use_count() == 1; }

int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (!nb::inst_ready(self)) return 0;
    const auto& solver = *nb::inst_ptr<PythonSolver>(self);
    if (!rests(solver)) return 0;
    for (const auto* f : {&solver.functions.loss, &solver.functions.exchange})
        if (*f) Py_VISIT((*f)->get().ptr());
    return 0;
}

int clear(PyObject* self) {
    if (!nb::inst_ready(self)) return 0;
    const auto& solver = *nb::inst_ptr<PythonSolver>(self);
    if (!rests(solver)) return 0;
    for (const auto* f : {&solver.functions.loss, &solver.functions.exchange})
        if (*f) (*f)->clear();
    return 0;
}

void bind_textures(nb::class_<PythonSolver>& c) {
    c.def_prop_ro("textures", textures,
                  nb::sig("def textures(self) -> dict[str, numpy.typing.NDArray[numpy.float32]]"),
                  "The present texels, {name: [height, width, channels]}, in [0, 1]: without "
                  "copies; they move on with the iterations,\nand cannot be written.");
    c.def("recovered", recovered,
          nb::sig("def recovered(self) -> dict[str, numpy.typing.NDArray[numpy.float32]]"),
          "What solve returns as textures after as many iterations: texels that no sample visited "
          "are filled or kept.");
    c.def(
        "image",
        [](PythonSolver& s, std::size_t view) {
            return to_array(
                resting(s, [&](const Solver& x) { return x.image(checked_view(s, view)); }));
        },
        nb::arg("view") = 0,
        nb::sig("def image(self, view: int = 0) -> numpy.typing.NDArray[numpy.float32] | None"),
        "The image of a view when an iteration last visited it, before its exposure; None: none "
        "did.");
    c.def(
        "exposure",
        [](PythonSolver& s, std::size_t view) {
            return resting(s, [&](const Solver& x) { return x.exposure(checked_view(s, view)); });
        },
        nb::arg("view") = 0);
    c.def(
        "evaluate",
        [](PythonSolver& s, nb::object spp) {
            const std::uint32_t samples = to_count(spp, "spp", 2, kMaxSamplesPerPixel);
            const Flag is_abandoned = std::make_shared<std::atomic<bool>>(false);
            try {
                return work<Evaluation>(s, [samples, is_abandoned](const Solver& x) {
                    return x.evaluate(samples, 0, progress_of(is_abandoned));
                });
            } catch (...) {
                *is_abandoned = true;
                throw;
            }
        },
        nb::arg("spp") = 64, nb::sig("def evaluate(self, spp: int = 64) -> Evaluation"),
        "The present textures with fresh samples, 2 to 1048576 per pixel.");
}

void bind_steps(nb::module_& m) {
    static PyType_Slot slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(traverse)},
                                  {Py_tp_clear, reinterpret_cast<void*>(clear)},
                                  {0, nullptr}};
    static const std::string signature =
        "def __init__(self, problem: Problem, state: State | None = None" + options_signature() +
        ") -> None";
    static const std::string doc =
        "Advances a problem by iterations: `for it in Solver(problem, iterations=100)`. It goes on "
        "from a state where one is given.\nCtrl-C ends the waiting for an iteration, not the "
        "iteration: the solver stays usable." +
        options_text();
    nb::class_<PythonSolver> c(m, "Solver", doc.c_str(), nb::type_slots(slots));
    c.def(
        "__init__",
        [](PythonSolver* self, const PythonProblem& problem, const State* state,
           const nb::kwargs& options) {
            new (self) PythonSolver(make_solver(problem, state, options));
        },
        nb::arg("problem"), nb::arg("state") = nb::none(), nb::arg("options"),
        nb::sig(signature.c_str()));
    c.def(
        "__iter__", [](nb::handle self) { return nb::borrow(self); },
        nb::sig("def __iter__(self) -> Solver"));
    c.def("__next__", next, nb::sig("def __next__(self) -> Iteration"));
    c.def("step", step_once, nb::sig("def step(self) -> Iteration"),
          "One iteration, whatever the rules say that end a loop.");
    c.def_prop_ro(
        "iterations",
        [](PythonSolver& s) { return resting(s, [](const Solver& x) { return x.iterations(); }); },
        "Iterations done, those behind the state included.");
    c.def_prop_ro(
        "ending",
        [](PythonSolver& s) -> std::optional<std::string> {
            const auto ending = resting(s, [](const Solver& x) { return x.ending(); });
            if (!ending) return {};
            return name_of(*ending);
        },
        "The rule that has ended the loop: 'iterations', 'time', 'patience', or None.");
    c.def_prop_ro(
        "state",
        [](PythonSolver& s) { return work<State>(s, [](const Solver& x) { return x.state(); }); },
        "A copy of all that survives an iteration.");
    c.def("__repr__", [](const PythonSolver& s) {
        return fmt::format("Solver({}, {})", count_of(s.names.size(), "unknown"),
                           count_of(s.views, "view"));
    });
    bind_textures(c);
}

}  // namespace

const Solver& solver_of(const PythonIteration& i) {
    if (i.current && *i.current) return **i.current;
    if (i.solver.is_none())
        throw Error(
            "an iteration of solve has textures while its callback runs alone: iterate over a "
            "Solver");
    PythonSolver& solver = nb::cast<PythonSolver&>(i.solver);
    solver.worker->wait();
    return solver.run->solver;
}

void bind_solver(nb::module_& m) { bind_steps(m); }

}  // namespace burnish::python
