// The options of burnish::Options as keyword arguments, from the table of options.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "burnish/options.h"

namespace burnish::python {

namespace nb = nanobind;

struct PythonProblem;

/// Options of a problem from keyword arguments; those that are None keep their defaults. Throws
/// TypeError where there is no such option, InputError where a value is none of the option's, or
/// has no effect. Warns where only the scene and the views tell that.
Options options_of(const nb::kwargs& given, const std::string& function,
                   const PythonProblem& problem);

/// For a signature: ", *, estimator: Literal['path_cache', ...] | None = None, spp: int | None =
/// None, ..."
std::string options_signature();
/// A line for each: its name, what it is, its values and its default.
std::string options_text();
/// [(name, sentence, values, default), ...]
nb::list options_list();

}  // namespace burnish::python
