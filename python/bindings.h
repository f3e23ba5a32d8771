// The parts of the module.
#pragma once

#include <nanobind/nanobind.h>

#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "burnish/solve.h"
#include "python/work.h"

namespace burnish::python {

namespace nb = nanobind;

void bind_cameras(nb::module_& m);
void bind_captures(nb::module_& m);
void bind_images(nb::module_& m);
void bind_live(nb::module_& m);
void bind_models(nb::module_& m);
void bind_renderer(nb::module_& m);
void bind_view(nb::module_& m);
void bind_problem(nb::module_& m);
void bind_results(nb::module_& m);
void bind_solve(nb::module_& m);
void bind_solver(nb::module_& m);

/// Of a type whose objects are equal by value: they have no hash, as a list has none.
inline PyType_Slot kNoHash[] = {{Py_tp_hash, reinterpret_cast<void*>(PyObject_HashNotImplemented)},
                                {0, nullptr}};

/// What copies and pickles need of a class whose constructor takes its properties.
struct Copyable : nb::def_visitor<Copyable> {
    std::vector<const char*> properties;  ///< in the order of the constructor's arguments
    Copyable(std::initializer_list<const char*> names) : properties(names) {}

    template <class Class>
    void execute(Class& c) {
        c.def(
            "__getstate__",
            [names = properties](nb::handle self) {
                nb::list values;
                for (const char* name : names) values.append(self.attr(name));
                return nb::tuple(values);
            },
            nb::sig("def __getstate__(self) -> tuple[object, ...]"));
        c.def(
            "__setstate__",
            [](nb::handle self, const nb::tuple& state) {
                nb::type<typename Class::Type>().attr("__init__")(self, *state);
            },
            nb::sig("def __setstate__(self, state: tuple[object, ...], /) -> None"));
    }
};

/// A whole number from `low` on, for what `name` says. Throws TypeError and InputError.
std::uint32_t to_count(nb::handle value, const char* name, std::uint32_t low,
                       std::uint32_t high = 0xffffffff);

/// A path: text or os.PathLike.
std::string to_path(nb::handle path);

/// Textures by name: {name: array, or a number for all texels}; None: none. All of
/// Renderer.parameters can be given: what says nothing new is left out.
TextureValues to_textures(nb::handle textures, const Renderer& renderer);

/// The texture that a name means, in any form; no texel is read. Throws InputError: there is none.
ParameterInfo texture_info(const Renderer& renderer, const std::string& name);

/// A number, three numbers, "fit" or "fit_rgb". Throws TypeError and InputError.
Exposure to_exposure(nb::handle value);

/// A number in the place of an array: of Python or numpy, or an array without dimensions. Throws
/// InputError where it is no number that a double holds; what: whose it is.
std::optional<double> as_number(nb::handle value, const std::string& what);

/// True or False, of Python or of a library of arrays.
std::optional<bool> as_bool(nb::handle value);

/// A View, a picture, or a list of these.
std::vector<View> to_views(nb::handle views);

/// An object of Python that work on any thread calls or looks at, let go with the GIL.
class Function {
  public:
    explicit Function(nb::object object) : object_(std::move(object)) {}
    ~Function();
    Function(const Function&) = delete;
    Function& operator=(const Function&) = delete;
    nb::handle get() const { return object_; }
    /// For the garbage collector, with the GIL: whoever calls it now gets a TypeError.
    void clear() { object_ = nb::none(); }

  private:
    nb::object object_;
};

/// Keeps what a state of Python lies in while work looks at it; null: there is none.
inline std::shared_ptr<Function> owner_of(const State* state) {
    return state ? std::make_shared<Function>(nb::find(*state)) : nullptr;
}

/// What a problem calls.
struct Functions {
    std::shared_ptr<Function> loss = {};      ///< None: that of the options
    std::shared_ptr<Function> exchange = {};  ///< None: one process
};
/// Others that call the same, with the GIL: what the garbage collector visits has one owner that it
/// knows.
Functions copy_of(const Functions& functions);

/// A problem as Python has it.
struct PythonProblem {
    Problem problem;  ///< without its loss and without Ranks::exchange
    Functions functions = {};
};
/// With its loss and its exchange, which throw Abandoned once nobody waits; null: they go on. A
/// problem that is moved in is not copied.
Problem with_functions(PythonProblem problem, const Flag& is_abandoned);

/// An iteration, and what has made it.
struct PythonIteration {
    Iteration values;
    nb::object solver = nb::none();  ///< of Python, or None
    /// Of a callback of solve: it is there while the callback runs.
    std::shared_ptr<const Solver*> current = {};
};
/// Of a Solver of Python that rests, or of a callback that runs. Throws Error: there is none.
const Solver& solver_of(const PythonIteration& iteration);

/// Where the callback of solve is a viewer: what solve has found.
void show_result(nb::handle callback, const Problem& problem, const Summary& summary);

/// What a run found; the names are those that the problem gives.
struct PythonSummary {
    Summary values;
    std::vector<std::string> names;  ///< of the unknowns
    std::vector<std::string> views;
};

std::vector<std::string> names_of(const Problem& problem);

}  // namespace burnish::python
