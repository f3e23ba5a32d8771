// The solver and the loop over it.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <filesystem>
#include <map>
#include <mutex>

#include "burnish/checkpoint.h"
#include "burnish/error.h"
#include "optimize/checkpoint.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/options.h"
#include "python/work.h"

namespace burnish::python {

namespace {

/// What the solver's work owns. Used by one thread at a time: the worker's, or that of a call for
/// which it rests.
struct Run {
    explicit Run(Solver s) : solver(std::move(s)) {}
    Solver solver;
    std::optional<Iteration> made;  ///< by a step, until it is handed over
    bool failed = false;            ///< a step has, half-way
};

struct PythonSolver {
    std::shared_ptr<Run> run;
    std::vector<std::string> names;
    std::shared_ptr<Function> loss;  ///< for the garbage collector
    std::size_t views = 0;
    std::unique_ptr<Worker> worker = std::make_unique<Worker>();
};

PythonSolver make_solver(const PythonProblem& problem, const std::optional<State>& state,
                         const nb::kwargs& given) {
    const Options options = options_of(given, "Solver");
    const Flag goes_on = std::make_shared<std::atomic<bool>>(false);
    PythonSolver made;
    made.names = names_of(problem.problem);
    made.views = problem.problem.views.size();
    made.loss = problem.loss;
    made.run = compute([problem = with_loss(problem, goes_on), options, state](const Flag&) {
        return std::make_shared<Run>(state ? Solver(problem, options, *state)
                                           : Solver(problem, options));
    });
    return made;
}

/// One step. Where Ctrl-C ends the waiting for it, the next call hands it over.
PythonIteration step(nb::handle self) {
    auto& solver = nb::cast<PythonSolver&>(self);
    solver.worker->run([run = solver.run] {
        if (run->made) return;
        if (run->failed)
            throw Error(
                "an iteration of this solver has failed half-way: begin another solver, from a "
                "state that was kept before");
        try {
            run->made = run->solver.step();
        } catch (...) {
            run->failed = true;
            throw;
        }
    });
    return {*std::exchange(solver.run->made, {}), nb::borrow(self)};
}

PythonIteration next(nb::handle self) {
    auto& solver = nb::cast<PythonSolver&>(self);
    solver.worker->wait();
    if (!solver.run->made && solver.run->solver.ending()) throw nb::stop_iteration();
    return step(self);
}

/// Of what an iteration leaves, while none is under way.
template <class Body>
auto resting(PythonSolver& solver, const Body& body) {
    solver.worker->wait();
    return body(solver.run->solver);
}

std::size_t checked_view(const PythonSolver& solver, std::size_t view) {
    if (view < solver.views) return view;
    throw nb::index_error(("view: found " + std::to_string(view) + ", the problem has " +
                           std::to_string(solver.views))
                              .c_str());
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

int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (!nb::inst_ready(self)) return 0;
    const auto* solver = nb::inst_ptr<PythonSolver>(self);
    // The solver's own and the run's; more while a problem holds it, too.
    if (solver->loss && solver->loss.use_count() == 2) Py_VISIT(solver->loss->get().ptr());
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
            const std::uint32_t samples = to_count(spp, "spp", 2);
            return work<Evaluation>(s, [samples](const Solver& x) { return x.evaluate(samples); });
        },
        nb::arg("spp") = 64, nb::sig("def evaluate(self, spp: int = 64) -> Evaluation"),
        "The present textures with fresh samples.");
}

std::string text_of_options() {
    return "\n\nOptions, of which None is the default:\n\n" + options_text();
}

void bind_steps(nb::module_& m) {
    static PyType_Slot slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(traverse)},
                                  {0, nullptr}};
    static const std::string signature =
        "def __init__(self, problem: Problem, state: State | None = None" + options_signature() +
        ") -> None";
    static const std::string doc =
        "Advances a problem by iterations: `for it in Solver(problem, iterations=100)`. It goes on "
        "from a state where one is given.\nCtrl-C ends the waiting for an iteration, not the "
        "iteration: the solver stays usable." +
        text_of_options();
    nb::class_<PythonSolver> c(m, "Solver", doc.c_str(), nb::type_slots(slots));
    c.def(
        "__init__",
        [](PythonSolver* self, const PythonProblem& problem, const std::optional<State>& state,
           const nb::kwargs& options) {
            new (self) PythonSolver(make_solver(problem, state, options));
        },
        nb::arg("problem"), nb::arg("state") = nb::none(), nb::arg("options"),
        nb::sig(signature.c_str()));
    c.def(
        "__iter__", [](nb::handle self) { return nb::borrow(self); },
        nb::sig("def __iter__(self) -> Solver"));
    c.def("__next__", next, nb::sig("def __next__(self) -> Iteration"));
    c.def("step", step, nb::sig("def step(self) -> Iteration"),
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
        return "Solver(" + std::to_string(s.names.size()) + " unknowns, " +
               std::to_string(s.views) + " views)";
    });
    bind_textures(c);
}

Control call_callback(const Function& callback, const Iteration& i) {
    const nb::gil_scoped_acquire gil;
    const nb::object answer = callback.get()(PythonIteration{i, nb::none()});
    const int ends = PyObject_IsTrue(answer.ptr());
    if (ends < 0) nb::raise_python_error();
    return ends ? Cancel : Continue;
}

void call_progress(const Function& progress, const char* stage, double share) {
    const nb::gil_scoped_acquire gil;
    progress.get()(stage, share);
}

std::shared_ptr<Function> to_function(nb::handle function, const char* name) {
    if (function.is_none()) return {};
    if (!PyCallable_Check(function.ptr()))
        throw nb::type_error((std::string(name) + ": expected a function").c_str());
    return std::make_shared<Function>(nb::borrow(function));
}

/// One run at a time writes into a folder: one that nobody waits for any more may still end.
std::mutex& lock_of(const std::string& folder) {
    static std::mutex guard;
    static auto& locks = *new std::map<std::filesystem::path, std::mutex>;  // for threads at exit
    const std::lock_guard lock(guard);
    return locks[std::filesystem::weakly_canonical(folder)];
}

/// Goes on from the newest checkpoint of the folder where there is one.
Summary solve_with_checkpoints(const Problem& problem, const Options& options,
                               const std::string& folder, const Callback& callback,
                               const StageProgress& progress) {
    const std::lock_guard lock(lock_of(folder));
    Checkpoints checkpoints;
    checkpoints.folder = folder;
    if (checkpoints_in(folder).empty())
        return solve(problem, options, checkpoints, callback, progress);
    return solve(problem, options, load_checkpoint(folder), checkpoints, callback, progress);
}

PythonSummary run(const PythonProblem& problem, const std::optional<State>& state,
                  nb::handle callback, nb::handle progress, nb::handle checkpoints,
                  const nb::kwargs& given) {
    const Options options = options_of(given, "solve");
    const auto hear = to_function(callback, "callback"), tell = to_function(progress, "progress");
    const std::string folder = checkpoints.is_none() ? "" : to_path(checkpoints);
    if (state && !folder.empty())
        throw InputError("solve: found a state and a folder of checkpoints, expected one of them");
    Summary summary =
        compute([problem, options, state, hear, tell, folder](const Flag& is_abandoned) {
            const Callback after = [&](const Iteration& i) {
                if (!folder.empty() && is_over(is_abandoned)) return Suspend;
                check_abandoned(is_abandoned);
                return hear ? call_callback(*hear, i) : Continue;
            };
            const StageProgress stages = [&](const char* stage, double share) {
                check_abandoned(is_abandoned);
                if (tell) call_progress(*tell, stage, share);
            };
            // With checkpoints the iteration is done first.
            const Problem own =
                with_loss(problem, folder.empty() ? is_abandoned
                                                  : std::make_shared<std::atomic<bool>>(false));
            if (!folder.empty()) return solve_with_checkpoints(own, options, folder, after, stages);
            return state ? solve(own, options, *state, after, stages)
                         : solve(own, options, after, stages);
        });
    return {std::move(summary), names_of(problem.problem)};
}

}  // namespace

void bind_solver(nb::module_& m) {
    bind_steps(m);
    static const std::string signature =
        "def solve(problem: Problem, state: State | None = None, callback: "
        "collections.abc.Callable[[Iteration], object] | None = None, progress: "
        "collections.abc.Callable[[str, float], object] | None = None, checkpoints: "
        "str | os.PathLike[str] | None = None" +
        options_signature() + ") -> Summary";
    static const std::string doc =
        "Recovers the textures of a problem: iterates until a rule ends the run, evaluates the "
        "result.\n\nstate: from which the run goes on. callback: called after each iteration; one "
        "that returns a true value ends the run.\nprogress: told the name and the share that is "
        "done of what comes before and after the iterations.\ncheckpoints: a folder: the run goes "
        "on from the newest checkpoint there, to the bytes of an uninterrupted one, and\nwrites "
        "one every minute, at its end, and after Ctrl-C." +
        text_of_options();
    m.def("solve", run, nb::arg("problem"), nb::arg("state") = nb::none(),
          nb::arg("callback") = nb::none(), nb::arg("progress") = nb::none(),
          nb::arg("checkpoints") = nb::none(), nb::arg("options"), nb::sig(signature.c_str()),
          doc.c_str());
}

}  // namespace burnish::python
