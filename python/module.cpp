// The module burnish._core: include/burnish for Python.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cstdlib>

#include "burnish/error.h"
#include "core/version.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/options.h"

namespace burnish::python {

namespace {

PyObject* exception_type(nb::module_& m, const char* name, nb::handle base, nb::handle second,
                         const char* doc) {
    const nb::object bases =
        second.is_valid() ? nb::object(nb::make_tuple(base, second)) : nb::borrow(base);
    const std::string full = std::string("burnish._core.") + name;
    PyObject* type = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
    if (!type) nb::raise_python_error();
    m.attr(name) = nb::steal(type);
    return nb::object(m.attr(name)).release().ptr();  // kept for the translator
}

struct Exceptions {
    PyObject *error, *input, *resource, *output;
};

/// Messages hold paths, which need not be UTF-8.
void set_error(PyObject* type, const std::exception& e) {
    PyErr_SetObject(type, to_text(e.what()).ptr());
}

void bind_errors(nb::module_& m) {
    static Exceptions types;
    types.error = exception_type(m, "Error", PyExc_Exception, {},
                                 "The family of all exceptions that Burnish raises on purpose.");
    types.input = exception_type(m, "InputError", types.error, PyExc_ValueError,
                                 "Input that cannot be used.");
    types.resource = exception_type(m, "ResourceError", types.error, PyExc_RuntimeError,
                                    "A resource that is not there.");
    types.output =
        exception_type(m, "OutputError", types.error, PyExc_OSError,
                       "A file or folder that cannot be written, or a folder of checkpoints that "
                       "cannot be read.");
    nb::register_exception_translator([](const std::exception_ptr& p, void*) {
        try {
            std::rethrow_exception(p);
        } catch (const InputError& e) {
            set_error(types.input, e);
        } catch (const ResourceError& e) {
            set_error(types.resource, e);
        } catch (const OutputError& e) {
            set_error(types.output, e);
        } catch (const Error& e) {
            set_error(types.error, e);
        }
    });
}

}  // namespace

}  // namespace burnish::python

NB_MODULE(_core, m) {
    using namespace burnish::python;
    m.doc() = "Burnish: recovers the textures of materials from images.";
    m.attr("version") = burnish::version();
    // Of what a daemon's thread holds at exit they would say that it is a bug; for tests of leaks.
    if (!std::getenv("BURNISH_LEAK_WARNINGS")) nb::set_leak_warnings(false);
    bind_errors(m);
    bind_cameras(m);
    bind_images(m);
    bind_renderer(m);
    bind_view(m);
    bind_problem(m);
    bind_captures(m);
    bind_results(m);
    bind_solver(m);
    bind_solve(m);
    bind_live(m);
    bind_models(m);
    m.def("options", options_list, nb::sig("def options() -> list[tuple[str, str, str, str]]"),
          "The options of solve and Solver: (name, sentence, values, default) of each.");
    nb::module_::import_("atexit").attr("register")(nb::cpp_function(end_all_work));
}
