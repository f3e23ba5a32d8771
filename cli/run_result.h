// All that a run of `burnish optimize` found out: what the summary and the report are made of.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burnish/checkpoint.h"
#include "cli/settings.h"
#include "cli/traffic.h"
#include "cli/view_pictures.h"
#include "core/parsed.h"
#include "optimize/memory.h"
#include "optimize/setup.h"
#include "scene/scene.h"
#include "texture/coverage.h"

namespace burnish {

/// A texture to recover.
struct TargetTexture {
    std::string name;  ///< of the parameter
    std::string file;  ///< of the results, without extension
    TextureId texture;
    bool raw = false;         ///< how its PNG is encoded
    bool is_color = false;    ///< see read_as_color; a search finds it without trying values
    double own_rate = 0;      ///< a learning rate of its own; 0: none
    float learning_rate = 0;  ///< that it has
    StartKind start_kind = StartKind::kSearched;
    Image initial;  ///< [height, width, channels], in [0, 1]; searched: once it is known
    std::optional<Image> truth;  ///< where the target was rendered from it
    TexelEvidence evidence;      ///< of the fitted pictures; with truth only
};

/// Of the results' folder: "textures/NAME.exr", or of a map of it "textures/NAME_coverage.exr".
inline std::string texture_file(const TargetTexture& texture, const std::string& extension,
                                const std::string& map = "") {
    return "textures/" + texture.file + (map.empty() ? "" : "_" + map) + extension;
}

/// Root mean squared differences to the truth.
struct TextureErrors {
    double seen = 0;      ///< over the texels that the fitted pictures see
    double weighted = 0;  ///< each weighted with how much it moves them, see TexelEvidence
};
/// texels: of a texture with truth and evidence.
TextureErrors errors_of(const TargetTexture& texture, const Image& texels);

/// A number with so many decimals, or that there is none: light reaches no texel.
std::string error_text(double error, int decimals);

/// Whether texels are those of a constant.
inline bool is_one_value(const Image& texels) { return texels.width == 1 && texels.height == 1; }

/// The double whose decimal digits are the few of a float, for JSON.
inline double few_digits(float x) { return *parsed<double>(fmt::format("{}", x)); }

/// What a window of passes keeps: "two halves of up to 32 passes".
std::string halves_text(std::uint32_t window);

/// "0.9", or "0.7, 0.4, 0.2".
std::string values_text(const Image& texels);

/// An optimisation run with its evaluation.
struct EvaluatedRun {
    Options options;
    Summary summary;
    std::vector<TextureErrors> texture_errors;  ///< per texture; empty without truth
};
inline const char* name_of(const EvaluatedRun& run) { return name_of(run.options.estimator); }

/// Whether the noise of an evaluation, which is known to a few per cent, hides how low the loss is.
bool is_too_noisy(const Evaluation& result);

struct RunResult {
    Settings settings;                  ///< with what follows from them: the path cache's memory
    Settings asked;                     ///< as they were given
    bool goes_on = false;               ///< from a checkpoint, with `settings` as it records them
    double state_bytes = 0;             ///< of what this process has of its checkpoint, about
    Ranks ranks;                        ///< that share out the work
    Traffic traffic;                    ///< of this one
    std::vector<std::string> warnings;  ///< of the loader
    std::vector<Input> files;           ///< that it has read
    MemoryEstimate memory;              ///< of the run that takes more; at most: what either may
    std::string kept_text;              ///< what the first path cache keeps; empty: there is none
    std::size_t seeing_pixels = 0;      ///< of its views: those that can see an unknown
    std::vector<TargetTexture> textures;
    std::vector<CapturedView> sources;        ///< of the views
    Pictures pictures;                        ///< of the views, without their pixels
    std::vector<std::size_t> unseeing_views;  ///< that no light from an unknown reaches
    std::vector<std::string> picture_warnings;
    std::vector<View> views;
    std::vector<Renderer> renderers;            ///< of the views
    std::vector<TextureErrors> initial_errors;  ///< per texture; empty without truth
    EvaluatedRun result;
    std::vector<double> similarities;  ///< of the result's views: see similarity_of
    std::optional<EvaluatedRun> compared;
    std::vector<std::pair<std::string, double>> phases;  ///< name, seconds
    /// For other programs: what it is ("scene", "model", "blender_script"), and its file in the
    /// output folder.
    std::vector<std::pair<std::string, std::string>> deliverables;
};

/// How many views are fitted: not held out.
inline std::size_t fitted_count(const RunResult& run) {
    return static_cast<std::size_t>(
        std::ranges::count_if(run.sources, [](const CapturedView& v) { return !v.view.held_out; }));
}

/// How like its picture a view of the result came out: SSIM, 1 where equal, over the pixels that
/// see an unknown and count in the mask, with the picture's 99th percentile there for white. The
/// render's noise counts.
double similarity_of(const RunResult& run, std::size_t view);

/// The settings that repeat the run to the byte: with the iterations and evaluation samples that it
/// had, where time decided on them, and without patience where it went on: it may have had another
/// before.
Settings repeatable_settings(const RunResult& run);

/// "iterations", "time", "patience" or "signal".
std::string ended_by(const Summary& summary);

/// How many texels of a texture no view decides, and what they hold, as a sentence; empty: none.
std::string unvisited_text(const RunResult& run, std::size_t texture);

inline constexpr const char *kCoverage = "coverage", *kConfidence = "confidence";
/// What is known of a texture's texels, by name: coverage; confidence, where there is one.
std::vector<std::pair<std::string, const Image*>> evidence_maps(const RecoveredTexture& texture);

}  // namespace burnish
