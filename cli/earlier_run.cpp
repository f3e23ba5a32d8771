#include "cli/earlier_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/folder_content.h"
#include "cli/options_file.h"
#include "optimize/checkpoint.h"

namespace burnish {

namespace {

/// Of a folder's summary.json; null where there is none of a whole run.
nlohmann::json summary_in(const std::filesystem::path& folder) {
    nlohmann::json json = read_summary(folder);
    const bool whole = json.is_object() && json.contains("asked") && json.contains("result") &&
                       json["result"].is_object() && json["result"].contains("ended_by");
    return whole ? json : nlohmann::json();
}

/// Whether a run has met one of its rules.
bool has_ended(const nlohmann::json& result) {
    return result.is_object() && result.contains("ended_by") && result["ended_by"] != "signal";
}

double number_in(const nlohmann::json& result, const char* name) {
    return result.contains(name) && result[name].is_number() ? result[name].get<double>() : NAN;
}

}  // namespace

EarlierRun earlier_run(const Settings& asked) {
    const std::filesystem::path folder = asked.run.output;
    const nlohmann::json summary = summary_in(folder);
    if (!summary.is_null() &&
        summary["asked"].dump() == nlohmann::json(settings_json(asked)).dump() &&
        has_ended(summary["result"]) &&
        (!asked.compared || (summary.contains("compared") && has_ended(summary["compared"]))))
        return EarlierRun::kDone;
    return checkpoints_in(folder / kCheckpoints).empty() ? EarlierRun::kNone : EarlierRun::kStopped;
}

std::string result_text(const std::string& folder) {
    const nlohmann::json summary = summary_in(folder);
    if (summary.is_null()) return {};
    const nlohmann::json& result = summary["result"];
    const double floor = number_in(result, "noise_floor");
    return fmt::format("loss {:.4g} -> {:.4g}, {:.0f} iterations",
                       number_in(result, "initial_loss"),
                       number_in(result, "final_loss") - (std::isfinite(floor) ? floor : 0),
                       number_in(result, "iterations"));
}

}  // namespace burnish
