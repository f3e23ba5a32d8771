// The loop over a solver.
#include <nanobind/stl/string.h>

#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>

#include "burnish/checkpoint.h"
#include "burnish/error.h"
#include "image/files.h"
#include "optimize/checkpoint.h"
#include "optimize/ranks.h"
#include "optimize/setup.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/options.h"
#include "python/work.h"

namespace burnish::python {

namespace {

/// Is none any more once this goes.
struct Cleared {
    const Solver*& solver;
    ~Cleared() { solver = nullptr; }
};

Control call_callback(const Function& callback, const Iteration& i, const Solver& solver) {
    const CallFromWork call;
    PythonIteration iteration{i};
    iteration.current = std::make_shared<const Solver*>(&solver);
    const Cleared cleared{*iteration.current};
    const nb::object answer = callback.get()(iteration);
    const int ends = PyObject_IsTrue(answer.ptr());
    if (ends < 0) nb::raise_python_error();
    return ends ? Cancel : Continue;
}

void call_progress(const Function& progress, const char* stage, double share) {
    const CallFromWork call;
    progress.get()(stage, share);
}

void warn_of_damage(const Checkpoint& from) {
    const CallFromWork call;
    for (const std::string& text : warnings_of(from, "the run")) warn(PyExc_RuntimeWarning, text);
}

std::shared_ptr<Function> to_function(nb::handle function, const char* name) {
    if (function.is_none()) return {};
    if (!PyCallable_Check(function.ptr()))
        throw type_error(std::string(name) + ": expected a function, found " + repr_of(function));
    return std::make_shared<Function>(nb::borrow(function));
}

/// The folders that runs write into, each with whether nobody waits for its run any more.
struct Folders {
    std::mutex mutex;
    std::condition_variable changed;
    std::map<std::filesystem::path, Flag> writers;
};
Folders& folders() {
    static Folders& only = *new Folders;  // for threads at exit
    return only;
}

/// A folder for one run. Waits for a run that nobody waits for any more and that still ends; throws
/// Error where another one goes on.
class FolderClaim {
  public:
    FolderClaim(const std::string& folder, const Flag& is_abandoned) : folder_(real_path(folder)) {
        std::unique_lock lock(folders().mutex);
        while (!folders().writers.try_emplace(folder_, is_abandoned).second) {
            if (!*folders().writers[folder_])
                throw Error(folder + " is the folder of checkpoints of a run that goes on");
            folders().changed.wait_for(lock, kPatience);
            check_abandoned(is_abandoned);
        }
    }
    ~FolderClaim() {
        const std::lock_guard lock(folders().mutex);
        folders().writers.erase(folder_);
        folders().changed.notify_all();
    }
    FolderClaim(const FolderClaim&) = delete;
    FolderClaim& operator=(const FolderClaim&) = delete;

  private:
    std::filesystem::path folder_;
};

/// Goes on from the newest checkpoint of the folder where there is one. Once nobody waits the run
/// is written and ends.
Summary solve_with_checkpoints(Problem problem, const Options& options, const std::string& folder,
                               const Callback& callback, const StageProgress& progress,
                               const Flag& is_abandoned) {
    const FolderClaim claim(folder, is_abandoned);
    Checkpoints checkpoints;
    checkpoints.folder = folder;
    checkpoints.stop = [is_abandoned] { return is_over(is_abandoned); };
    if (checkpoints_in(folder).empty())
        return solve(std::move(problem), options, checkpoints, callback, progress);
    Checkpoint from = load_checkpoint(folder, problem.ranks);
    if (is_first(problem.ranks)) warn_of_damage(from);
    return solve(std::move(problem), options, std::move(from), checkpoints, callback, progress);
}

/// The line that shows the progress of a run, until this goes.
class Bar {
  public:
    /// done: iterations behind the state from which it goes on.
    Bar(const Options& options, std::uint32_t done) {
        const std::uint32_t iterations = effective_stop(options).iterations;
        nb::object total = nb::none();
        if (iterations != Stop{}.iterations) total = nb::int_(std::uint64_t{iterations} + done);
        bar_ = nb::module_::import_("burnish._bar").attr("Bar")(total);
    }
    std::shared_ptr<Function> stage() const { return function("stage"); }
    std::shared_ptr<Function> iteration() const { return function("iteration"); }
    Bar(const Bar&) = delete;
    Bar& operator=(const Bar&) = delete;
    ~Bar() {
        try {
            bar_.attr("close")();
        } catch (const nb::python_error&) {  // a run is worth more than its line
        }
    }

  private:
    std::shared_ptr<Function> function(const char* name) const {
        return std::make_shared<Function>(nb::borrow(bar_.attr(name)));
    }
    nb::object bar_;
};

PythonSummary run(const PythonProblem& problem, const State* state, nb::handle callback,
                  nb::handle progress, nb::handle checkpoints, const nb::kwargs& given) {
    const Options options = options_of(given, "solve", problem);
    std::optional<Bar> bar;
    const std::optional<bool> shows = as_bool(progress);
    if (shows.value_or(false)) bar.emplace(options, state ? state->values().iteration : 0);
    const auto hear = to_function(callback, "callback");
    const auto tell = bar ? bar->stage() : shows ? nullptr : to_function(progress, "progress");
    const auto count = bar ? bar->iteration() : nullptr;
    std::optional<std::string> folder;
    if (!checkpoints.is_none()) folder = to_path(checkpoints);
    if (state && folder)
        throw InputError("solve: found a state and a folder of checkpoints, expected one of them");
    Summary summary =
        compute([problem = PythonProblem(problem), options, state, owner = owner_of(state), hear,
                 tell, count, folder](const Flag& is_abandoned) mutable {
            const Callback after = [&](const Iteration& i, const Solver& solver) {
                if (folder && is_over(is_abandoned)) return Suspend;
                check_abandoned(is_abandoned);
                if (count) call_callback(*count, i, solver);
                return hear ? call_callback(*hear, i, solver) : Continue;
            };
            const StageProgress stages = [&](const char* stage, double share) {
                check_abandoned(is_abandoned);
                if (tell) call_progress(*tell, stage, share);
            };
            // With checkpoints they go on: the run stops as a whole, and is written.
            Problem own = with_functions(std::move(problem), folder ? nullptr : is_abandoned);
            if (folder)
                return solve_with_checkpoints(std::move(own), options, *folder, after, stages,
                                              is_abandoned);
            return state ? solve(std::move(own), options, *state, after, stages)
                         : solve(std::move(own), options, after, stages);
        });
    bar.reset();
    if (is_first(problem.problem.ranks)) show_result(callback, problem.problem, summary);
    std::vector<std::string> views;
    for (const View& view : problem.problem.views) views.push_back(view.name);
    return {std::move(summary), names_of(problem.problem), std::move(views)};
}

}  // namespace

void bind_solve(nb::module_& m) {
    static const std::string signature =
        "def solve(problem: Problem, state: State | None = None, callback: "
        "collections.abc.Callable[[Iteration], object] | None = None, progress: "
        "collections.abc.Callable[[str, float], object] | bool | None = None, checkpoints: "
        "str | os.PathLike[str] | None = None" +
        options_signature() + ") -> Summary";
    static const std::string doc =
        "Recovers the textures of a problem: iterates until a rule ends the run, evaluates the "
        "result.\n\nstate: from which the run goes on. callback: called after each iteration, of "
        "several processes by the first; one\nthat returns a true value ends the run. progress: "
        "told the name and the share that is done of what comes before and\nafter the "
        "iterations, in each process, by any thread, one call at a time; True: a bar shows it, and "
        "in the first\nprocess the iterations, tqdm's where it is installed; False: nothing. "
        "checkpoints: a folder, not beside a state: the\nrun goes on from the newest checkpoint "
        "there, to the bytes of an uninterrupted one, and writes one every minute, at\nits end, "
        "and after Ctrl-C; another one while the program ends leaves the checkpoint before." +
        options_text();
    m.def("solve", run, nb::arg("problem"), nb::arg("state") = nb::none(),
          nb::arg("callback") = nb::none(), nb::arg("progress") = nb::none(),
          nb::arg("checkpoints") = nb::none(), nb::arg("options"), nb::sig(signature.c_str()),
          doc.c_str());
}

}  // namespace burnish::python
