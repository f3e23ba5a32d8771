// A viewer beside a run.
#include "burnish/live.h"

#include <nanobind/stl/string.h>
#include <unistd.h>

#include <optional>
#include <utility>

#include "burnish/error.h"
#include "core/note.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace burnish::python {

namespace {

/// Warns with the GIL of what the viewer's thread has said.
class PythonLive {
  public:
    PythonLive(const std::string& address, const std::string& title)
        : live_(std::in_place, address, title, note_.hear()) {}
    /// Says what the last images have met with, once they are sent or given up.
    ~PythonLive() {
        {
            const nb::gil_scoped_release without;
            live_.reset();
        }
        const nb::error_scope kept;  // of a collection while an exception goes on
        try {
            warn();
        } catch (nb::python_error& e) {
            e.discard_as_unraisable(nb::handle());
        }
    }
    PythonLive(const PythonLive&) = delete;
    PythonLive& operator=(const PythonLive&) = delete;

    Live& get() {
        if (process_ != getpid())
            throw Error(
                "this process was forked after burnish.live, and threads are not forked: call it "
                "in this process, too");
        return *live_;
    }
    /// Where there is anything to say.
    void warn() const {
        if (const std::string text = note_.take(); !text.empty())
            python::warn(PyExc_RuntimeWarning, text);
    }

  private:
    pid_t process_ = getpid();  ///< which has the thread
    Note note_;
    std::optional<Live> live_;
};

void update(PythonLive& live, const PythonIteration& iteration) {
    live.get().update(solver_of(iteration));
    live.warn();
}

void show(PythonLive& live, const std::string& name, nb::handle image) {
    live.get().show(name, to_image(image, "image"));
    live.warn();
}

}  // namespace

void show_result(nb::handle callback, const Problem& problem, const Summary& summary) {
    if (nb::isinstance<PythonLive>(callback))
        nb::cast<PythonLive&>(callback).get().show(problem, summary);
}

void bind_live(nb::module_& m) {
    nb::class_<PythonLive>(
        m, "Live",
        "A running tev that images are sent to; see live. As the callback of solve, or called with "
        "an iteration of a Solver, it shows the present textures and, beside the pictures, the "
        "images of views, in 2 % of the time at most.")
        .def("__call__", update, nb::arg("iteration"),
             nb::sig("def __call__(self, iteration: Iteration, /) -> None"))
        .def("show", show, nb::arg("name"), nb::arg("image"),
             nb::sig("def show(self, name: str, image: numpy.typing.ArrayLike) -> None"),
             "Shows an image, in the place of the one of that name.")
        .def(
            "close", [](PythonLive& l, const std::string& name) { l.get().close(name); },
            nb::arg("name"), "What show has shown goes away.")
        .def(
            "open", [](PythonLive& l, nb::object path) { l.get().open(to_path(path)); },
            nb::arg("path"), nb::sig("def open(self, path: str | os.PathLike[str]) -> None"),
            "Shows an image file of the machine on which the viewer runs.");
    m.def(
        "live",
        [](const std::string& address, const std::string& title) {
            return std::make_unique<PythonLive>(address, title).release();
        },
        nb::rv_policy::take_ownership, nb::arg("address") = Live::kAddress,
        nb::arg("title") = "burnish",
        "Sends images to a running tev at 'HOST:PORT', named 'title/name', from a thread of its "
        "own: no call waits for the\nviewer. What it does not take is left out. Where there is "
        "none, or it is too slow for the last images, a warning says so\nonce; it is looked for "
        "again every second.");
}

}  // namespace burnish::python
