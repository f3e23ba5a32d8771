// Results that a program keeps in files between its runs, each by what it was made of: a run that
// was stopped goes on, and another one does not make the same again.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "experiments/figure.h"
#include "experiments/inverse_runs.h"
#include "experiments/trajectory.h"

namespace burnish {

struct KeptResults {
    std::filesystem::path folder;
    std::string program;  ///< a hash of the code: other code makes other results
};

/// That of the results behind a folder of a report, which it lies beside.
std::filesystem::path kept_folder(const std::filesystem::path& report);

/// Keeps results in `folder`, which is made with the first of them. Throws OutputError where they
/// cannot be written: before long work.
KeptResults keep_results(std::filesystem::path folder);

/// What was kept under this name and was made by this program of the same things; none: nothing, or
/// a damaged file.
std::optional<nlohmann::json> find_kept(const KeptResults& kept, const std::string& name,
                                        const nlohmann::json& made_of);
/// Where that lies, if it does.
std::filesystem::path kept_path(const KeptResults& kept, const std::string& name,
                                const nlohmann::json& made_of);
/// Replaces what is kept under this name and made of this. Throws OutputError.
void keep(const KeptResults& kept, const std::string& name, const nlohmann::json& made_of,
          const nlohmann::json& result);

/// What is kept, to the byte; from_json throws nlohmann::json::exception.
void to_json(nlohmann::json& json, const Image& image);
void from_json(const nlohmann::json& json, Image& image);
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CurvePoint, x, y)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Curve, name, points)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Plot, x_label, y_label, curves, log_x)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Table, head, rows)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Picture, name, caption, image, kind, white)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Measurement, experiment, scene, variant, metric, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Figure, title, claim, measured, why, verdict, tables, plots,
                                   pictures)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExperimentResult, name, title, figures, measurements, seconds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DerivativeError, paper, nmse, median_relative)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EstimateNumbers, seconds, error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DerivativeReference, gradient, squared_error, nmse)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Moment, iteration, seconds, derivative_seconds, loss,
                                   noise_floor, texture_error, step_length, image, texture)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Run, at, losses, seconds)
/// Every option that changes a result.
void to_json(nlohmann::json& json, const ReproduceOptions& options);

}  // namespace burnish
