#include "cli/summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/options_file.h"
#include "cli/process_memory.h"
#include "cli/view_pictures.h"
#include "core/version.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"

namespace burnish {

namespace {

using Json = nlohmann::ordered_json;

Json counts_json(const Summary& summary) {
    const RunCounts& counts = summary.counts;
    return {{"paths", counts.paths},
            {"derivatives", counts.derivatives},
            {"non_finite_derivatives", counts.rejected_derivatives},
            {"non_finite_image_samples", counts.rejected_image}};
}

/// What the search for the start tried.
Json search_json(const RunResult& run, const Summary& summary) {
    Json groups = Json::array();
    for (const SearchedGroup& g : summary.searched) {
        Json group{{"parameters", Json::array()}, {"tried", Json::array()}};
        for (const std::size_t u : g.unknowns) group["parameters"].push_back(run.textures[u].name);
        for (const SearchedValues& v : g.tried) {
            Json values = Json::array();
            for (const float x : v.values) values.push_back(few_digits(x));
            group["tried"].push_back(
                {{"values", values}, {"loss", v.loss}, {"regions", v.regions}});
        }
        group["guides"] = g.guides;
        groups.push_back(group);
    }
    Json again = Json::array();
    for (const SearchedAgain& s : summary.searched_again)
        again.push_back({{"iteration", s.iteration}, {"texels", s.texels}});
    return {{"seconds", summary.search_seconds}, {"groups", groups}, {"again", again}};
}

Json run_json(const RunResult& run, const EvaluatedRun& evaluated) {
    const Summary& s = evaluated.summary;
    Json json{{"estimator", name_of(evaluated)},
              {"iterations", s.counts.iterations},
              {"seconds", s.seconds},
              {"ended_by", ended_by(s)},
              {"initial_loss", loss_without_noise(s.start)},
              {"final_loss", s.result.loss},
              {"final_loss_without_noise", loss_without_noise(s.result)}};
    if (std::isfinite(s.start.noise_floor)) json["initial_noise_floor"] = s.start.noise_floor;
    if (std::isfinite(s.result.noise_floor)) json["noise_floor"] = s.result.noise_floor;
    json["evaluation_samples"] = s.result.samples_per_pixel;
    if (!s.searched.empty()) json["search"] = search_json(run, s);
    Json errors;
    for (std::size_t i = 0; i < evaluated.texture_errors.size(); ++i)
        errors[run.textures[i].name] = {{"initial", run.initial_errors[i].seen},
                                        {"final", evaluated.texture_errors[i].seen},
                                        {"initial_weighted", run.initial_errors[i].weighted},
                                        {"final_weighted", evaluated.texture_errors[i].weighted}};
    json["texture_rmse"] = errors;
    json["counts"] = counts_json(s);
    return json;
}

Json values_json(const RecoveredTexture& texture) {
    Json values = Json::array();
    for (const float v : texture.values.values) values.push_back(few_digits(v));
    return values;
}

Json parameters_json(const RunResult& run) {
    Json parameters = Json::array();
    for (std::size_t i = 0; i < run.textures.size(); ++i) {
        const TargetTexture& t = run.textures[i];
        Json json{{"name", t.name},
                  {"size", {t.initial.width, t.initial.height, t.initial.channels}},
                  {"learning_rate", few_digits(t.learning_rate)},
                  {"png_encoding", t.raw ? "linear" : "srgb"},
                  {"files", {texture_file(t, ".exr"), texture_file(t, ".png")}}};
        for (const auto& [name, map] : evidence_maps(run.result.summary.textures[i]))
            json[name] = texture_file(t, ".exr", name);
        json["texels_unvisited"] = run.result.summary.textures[i].unvisited;
        if (is_one_value(t.initial)) json["value"] = values_json(run.result.summary.textures[i]);
        if (t.truth)
            json["texels_visited"] =
                std::count(t.evidence.visited.begin(), t.evidence.visited.end(), 1);
        parameters.push_back(json);
    }
    return parameters;
}

Json exposure_json(const ExposureFactors& e) {
    return {few_digits(e[0]), few_digits(e[1]), few_digits(e[2])};
}

/// How a file was read.
Json picture_json(const std::string& file, const Photograph& p) {
    return {{"file", file},
            {"type", p.type},
            {"bits", p.bits},
            {"encoding", encoding_text(p.encoding)},
            {"orientation", p.orientation},
            {"turned", p.orientation != 1 && p.turning == Turning::kUpright},
            {"profile", p.profile},
            {"alpha", p.has_alpha},
            {"gray", p.is_gray},
            {"clipped_pixels", p.clipped_pixels},
            {"negative_pixels", p.negative_pixels}};
}

Json views_json(const RunResult& run) {
    Json views = Json::array();
    for (std::size_t i = 0; i < run.views.size(); ++i) {
        const View& view = run.views[i];
        const ViewEvaluation& start = run.result.summary.start.views[i];
        const ViewEvaluation& result = run.result.summary.result.views[i];
        Json json{{"name", name_of(view, i)},
                  {"split", view.held_out ? "test" : "train"},
                  {"size", {view.image.width, view.image.height}},
                  {"initial_loss", loss_without_noise(start)},
                  {"loss", result.loss},
                  {"exposure", exposure_json(result.exposure)},
                  {"exposure_fitted", fits_exposure(view.exposure)}};
        if (const Photograph& p = run.pictures.photographs[i]; !p.type.empty())
            json["picture"] = picture_json(run.sources[i].image, p);
        if (const std::string& file = run.sources[i].mask; !file.empty())
            json["mask"] = {{"file", file}, {"from", name_of(run.pictures.masks[i].source)}};
        if (std::isfinite(start.noise_floor)) json["initial_noise_floor"] = start.noise_floor;
        if (std::isfinite(result.noise_floor)) json["noise_floor"] = result.noise_floor;
        if (std::isfinite(result.psnr)) json["psnr"] = result.psnr;
        if (const double ssim = run.similarities[i]; std::isfinite(ssim)) json["ssim"] = ssim;
        views.push_back(json);
    }
    return views;
}

std::string text_of(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string summary_json(const RunResult& run, const std::vector<std::string>& files) {
    Json json{{"burnish", version()}, {"compiler", compiler()}};
    json["settings"] = settings_json(repeatable_settings(run));
    json["asked"] = settings_json(run.asked);
    json["image"] = {run.views[0].image.width, run.views[0].image.height};
    json["views"] = views_json(run);
    json["parameters"] = parameters_json(run);
    json["result"] = run_json(run, run.result);
    if (run.compared) json["compared"] = run_json(run, *run.compared);
    for (const auto& [name, seconds] : run.phases) json["seconds"][name] = seconds;
    if (run.ranks.count > 1)
        json["processes"] = {{"count", run.ranks.count},
                             {"exchanges", run.traffic.exchanges},
                             {"sent_bytes", run.traffic.bytes},
                             {"exchange_seconds", run.traffic.seconds}};
    json["peak_memory_bytes"] = peak_memory();
    json["memory_estimate_bytes"] = {{"expected", std::round(expected(run.memory))},
                                     {"maximum", std::round(maximum(run.memory))}};
    json["scene_warnings"] = run.warnings;
    json["picture_warnings"] = run.picture_warnings;
    for (const auto& [name, file] : run.deliverables) json["deliverables"][name] = file;
    json["files"] = files;
    return text_of(json);
}

std::string list_json(const std::vector<std::string>& files) {
    return text_of({{"burnish", version()}, {"files", files}});
}

}  // namespace burnish
