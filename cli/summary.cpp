#include "cli/summary.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/version.h"

namespace burnish {

namespace {

using Json = nlohmann::ordered_json;

Json settings_json(const RunResult& run) {
    Json settings;
    for (const auto& [name, value] : settings_of(run)) {
        const std::string key = name.substr(name.find_first_not_of('-'));
        if (key == "D")
            settings["definitions"].push_back(value);
        else
            settings[key] = value;
    }
    return settings;
}

Json outlier_json(const RunResult& run, const NamedOutlier& outlier) {
    const Outlier& e = outlier.contribution;
    const auto film_width = static_cast<std::uint32_t>(run.scene->film.crop_width);
    const TextureSubject& subject = run.subjects[e.slot];
    const auto width = static_cast<std::uint32_t>(subject.initial.width);
    return {{"value", e.value},
            {"iteration", outlier.iteration},
            {"pixel", {e.pixel % film_width, e.pixel / film_width}},
            {"parameter", subject.name},
            {"texel", {e.texel % width, e.texel / width}},
            {"technique", name_of(e.technique)}};
}

Json counts_json(const RunResult& run, const Descent& descent) {
    Json outliers = Json::array();
    for (const NamedOutlier& e : descent.counts.outliers) outliers.push_back(outlier_json(run, e));
    return {{"paths", descent.counts.records},
            {"derivatives", descent.counts.candidates},
            {"non_finite_derivatives", descent.counts.rejected},
            {"non_finite_image_draws", descent.rejected_image},
            {"largest_contributions", outliers}};
}

Json descent_json(const RunResult& run, const JudgedDescent& judged) {
    const Descent& d = judged.descent;
    Json json{{"estimator", name_of(judged.estimator)},
              {"iterations", d.rows.size()},
              {"seconds", d.seconds},
              {"ended_by", name_of(d.ending)},
              {"initial_loss", run.initial.loss},
              {"final_loss", judged.evaluation.loss}};
    if (run.noise_floor) json["least_loss"] = *run.noise_floor;
    Json errors;
    for (std::size_t i = 0; i < judged.texture_errors.size(); ++i)
        errors[run.subjects[i].name] = {{"initial", run.initial_errors[i]},
                                        {"final", judged.texture_errors[i]}};
    json["texture_rmse"] = errors;
    json["counts"] = counts_json(run, d);
    return json;
}

Json parameters_json(const RunResult& run) {
    Json parameters = Json::array();
    for (std::size_t i = 0; i < run.subjects.size(); ++i) {
        const TextureSubject& s = run.subjects[i];
        Json json{{"name", s.name},
                  {"size", {s.initial.width, s.initial.height, s.initial.channels}},
                  {"learning_rate", s.learning_rate},
                  {"png_encoding", s.raw ? "linear" : "srgb"},
                  {"files", {"textures/" + s.file + ".exr", "textures/" + s.file + ".png"}}};
        for (const auto& [name, map] : evidence_maps(run.result.descent, i))
            json[name] = "textures/" + s.file + "_" + name + ".exr";
        if (s.truth) json["texels_reached"] = std::count(s.reached.begin(), s.reached.end(), 1);
        parameters.push_back(json);
    }
    return parameters;
}

}  // namespace

std::string summary_json(const RunResult& run, const std::vector<std::string>& files) {
    Json json{{"burnish", version()}, {"compiler", compiler()}};
    json["settings"] = settings_json(run);
    json["image"] = {run.target.width, run.target.height};
    json["parameters"] = parameters_json(run);
    json["result"] = descent_json(run, run.result);
    if (run.compared) json["compared"] = descent_json(run, *run.compared);
    for (const auto& [name, seconds] : run.phases) json["seconds"][name] = seconds;
    json["peak_memory_bytes"] = peak_memory();
    json["predicted_memory_bytes"] = {{"expected", std::round(expected(run.memory))},
                                      {"most", std::round(most(run.memory))}};
    json["scene_warnings"] = run.warnings;
    json["files"] = files;
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace burnish
