// The report of `burnish reproduce`: one page with every figure, and the numbers as JSON and CSV.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/reproduce_machine.h"
#include "experiments/experiments.h"

namespace burnish {

/// What a run of `burnish reproduce` found out, and how it was set up.
struct Reproduction {
    std::vector<ExperimentResult> experiments;
    std::vector<std::pair<std::string, std::string>> settings;
    double seconds = 0;
    std::string stopped = {};  ///< how many parts are done of a run that was stopped; else empty
};

/// Reproduction::settings. scenes: their names, or empty where there are none.
std::vector<std::pair<std::string, std::string>> settings_text(const ReproduceOptions& options,
                                                               double time_scale,
                                                               const Machine& machine,
                                                               const std::string& scenes);

/// The longest side of a picture in the report.
inline constexpr int kPictureSide = 512;

/// A self-contained page: figures as SVG, pictures as PNG data URIs.
std::string reproduction_html(const Reproduction& run);
/// Settings, verdicts and measurements, and whether the run was stopped.
std::string reproduction_json(const Reproduction& run);
/// experiment,scene,variant,metric,value
std::string reproduction_csv(const Reproduction& run);

/// "holds", "holds in part", "does not hold", "undecided", "shown".
const char* name_of(Verdict verdict);

}  // namespace burnish
