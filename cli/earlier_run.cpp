#include "cli/earlier_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "cli/console.h"
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

std::size_t count_in(const nlohmann::json& result, const char* name) {
    return result.contains(name) && result[name].is_number_unsigned()
               ? result[name].get<std::size_t>()
               : 0;
}

std::string first_difference(const Settings& before, const Settings& now) {
    const std::vector<std::string> old = setting_texts(before), anew = setting_texts(now);
    for (std::size_t i = 0; i < old.size(); ++i)
        if (const std::string name = all_settings()[i].info.name;
            name != "run.max_memory" && old[i] != anew[i])
            return fmt::format("{}: {}, now {}", name, old[i], anew[i]);
    return {};
}

}  // namespace

std::string changed_setting(const std::string& recorded, const Settings& asked) {
    try {
        return first_difference(assemble(read_options_text(recorded, "its record")), asked);
    } catch (const InputError& error) {
        return error.what();
    }
}

std::string changed_since_results(const Settings& asked) {
    const nlohmann::json summary = summary_in(asked.run.output);
    return summary.is_null() ? "" : changed_setting(summary["asked"].dump(), asked);
}

EarlierRun earlier_run(const Settings& asked) {
    const std::filesystem::path folder = asked.run.output;
    const nlohmann::json summary = summary_in(folder);
    if (!summary.is_null() && changed_setting(summary["asked"].dump(), asked).empty() &&
        has_ended(summary["result"]) &&
        (!asked.compared || (summary.contains("compared") && has_ended(summary["compared"]))))
        return EarlierRun::kDone;
    return checkpoints_in(folder / kCheckpoints).empty() ? EarlierRun::kNone : EarlierRun::kStopped;
}

bool holds_ended_run(const std::string& folder) {
    const nlohmann::json summary = summary_in(folder);
    return !summary.is_null() && has_ended(summary["result"]) &&
           (!summary.contains("compared") || has_ended(summary["compared"]));
}

std::string result_text(const std::string& folder) {
    const nlohmann::json summary = summary_in(folder);
    if (summary.is_null()) return {};
    const nlohmann::json& result = summary["result"];
    return fmt::format("loss {:.4g} -> {:.4g}, {}", number_in(result, "initial_loss"),
                       number_in(result, "final_loss_without_noise"),
                       count_text(count_in(result, "iterations"), "iteration"));
}

}  // namespace burnish
