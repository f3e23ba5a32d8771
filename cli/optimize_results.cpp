#include "cli/optimize_results.h"

#include <fmt/format.h>

#include <system_error>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/deliverables.h"
#include "cli/demo_scene.h"
#include "cli/folder_content.h"
#include "cli/history.h"
#include "cli/inspect.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/summary.h"
#include "cli/texture_files.h"
#include "core/parallel.h"
#include "image/files.h"
#include "image/image.h"
#include "optimize/batch.h"
#include "optimize/evaluation.h"
#include "optimize/loss.h"
#include "optimize/ranks.h"
#include "render/renderer.h"

namespace burnish {

namespace {

void note_long(const char* what, double seconds, const char* option) {
    constexpr double kLong = 60;
    if (seconds > kLong)
        log_info(fmt::format("{} will take about {}; a smaller {} takes less", what,
                             duration_text(seconds), option));
}

}  // namespace

void log_long_phases(const RunResult& run) {
    constexpr double kFew = 4e6;  // samples, which no scene makes long
    const std::uint32_t target = run.settings.run.target_samples;
    const std::uint32_t evaluation = run.settings.options.evaluation_samples;
    double rendered = 0, all = 0;  // pixels
    for (std::size_t i = 0; i < run.renderers.size(); ++i) {
        const double pixels = pixels_of(run.renderers[i]);
        all += pixels;
        if (run.sources[i].image.empty()) rendered += pixels;
    }
    const std::uint32_t start = is_unbiased(run.settings.options.loss)
                                    ? start_samples(run.renderers.size(), all)
                                    : evaluation;
    const double of_evaluation = evaluation > 0 ? all * (start + evaluation) : 0;
    if (!is_first(run.ranks) || rendered * target + of_evaluation < kFew) return;
    const Renderer& first = run.renderers.front();
    const double seconds = seconds_of_a_pass(first.data().traced) / pixels_of(first);
    note_long("rendering the target", seconds * rendered * target, "--target-spp");
    if (evaluation > 0)
        note_long("evaluating the start and the result", seconds * of_evaluation,
                  "--evaluation-spp");
}

void log_result(const RunResult& run, const EvaluatedRun& evaluated) {
    const Summary& s = evaluated.summary;
    std::string text =
        fmt::format("{}: loss {:.4g} -> {:.4g} in {}, {}{}", name_of(evaluated),
                    loss_without_noise(s.start), loss_without_noise(s.result),
                    count_text(s.counts.iterations, "iteration"), duration_text(s.seconds),
                    s.ending == Ending::kCancelled  ? " (ended by a signal)"
                    : s.ending == Ending::kPatience ? " (the loss fell no longer)"
                                                    : "");
    if (is_too_noisy(s.result))
        text +=
            fmt::format("; the evaluation is too noisy to tell how low, try --evaluation-spp {}",
                        4 * s.result.samples_per_pixel);
    for (std::size_t i = 0; i < evaluated.texture_errors.size(); ++i)
        text += fmt::format("; {} error {} -> {}", run.textures[i].name,
                            error_text(run.initial_errors[i].seen, 4),
                            error_text(evaluated.texture_errors[i].seen, 4));
    for (std::size_t i = 0; i < run.textures.size(); ++i)
        if (const Image& texels = s.textures[i].values; is_one_value(texels))
            text += fmt::format("; {} = {}", run.textures[i].name, values_text(texels));
    log_info(text);
    const RunCounts& counts = s.counts;
    if (const std::size_t rejected = counts.rejected_derivatives + counts.rejected_image)
        log_warning(fmt::format("{} contributions were not finite and were left out",
                                count_text(rejected)));
}

namespace {

constexpr const char* kReport = "report.html";
constexpr const char* kComparedHistory = "history_compared.csv";
constexpr const char *kRender = "render.exr", *kTarget = "target.exr";  // of each view

/// Of each view the folder of its pictures, within that of the results.
std::vector<std::filesystem::path> folders_of(const std::vector<View>& views) {
    if (views.size() == 1) return {""};
    std::vector<std::filesystem::path> folders;
    for (const std::string& name : folder_names(views))
        folders.push_back(std::filesystem::path("views") / name);
    return folders;
}

/// All that write_all writes at most, by names in the folder of the results.
std::vector<std::string> result_names(const LoadedScene& loaded, const RunResult& run) {
    std::vector<std::string> names = deliverable_names(loaded, run);
    names.insert(names.end(), {kHistory, kComparedHistory, kReport, kSummary});
    for (const TargetTexture& t : run.textures)
        names.insert(names.end(),
                     {texture_file(t, ".exr"), texture_file(t, ".png"),
                      texture_file(t, ".exr", kCoverage), texture_file(t, ".exr", kConfidence)});
    std::vector<View> views;
    for (const CapturedView& source : run.sources) views.push_back(source.view);
    for (const std::filesystem::path& folder : folders_of(views))
        for (const char* file : {kRender, kTarget}) names.push_back((folder / file).string());
    return names;
}

double bytes_of_textures(const RunResult& run) {
    double bytes = 1 << 16;
    for (const TargetTexture& t : run.textures)
        bytes += static_cast<double>(t.initial.values.size() * sizeof(float));
    return bytes;
}

struct PictureFile {
    std::filesystem::path name;
    const Image* image;
    bool srgb;  ///< of 8-bit codes
};

/// Each recovered texture as EXR and as PNG, whose codes are linear where the scene reads such ones
/// and sRGB otherwise: read back in its place, both mean the same texels. Beside them what the
/// pictures say about each texel.
std::vector<PictureFile> texture_files(const RunResult& run, const std::filesystem::path& results) {
    std::vector<PictureFile> files;
    for (std::size_t i = 0; i < run.textures.size(); ++i) {
        const TargetTexture& t = run.textures[i];
        const RecoveredTexture& recovered = run.result.summary.textures[i];
        files.push_back({results / texture_file(t, ".exr"), &recovered.values, false});
        files.push_back({results / texture_file(t, ".png"), &recovered.values, !t.raw});
        for (const auto& [name, map] : evidence_maps(recovered))
            files.push_back({results / texture_file(t, ".exr", name), map, false});
    }
    return files;
}

/// Of each view the render of the result and the picture that it was to agree with.
std::vector<PictureFile> view_files(const RunResult& run, const std::filesystem::path& folder) {
    const std::vector<std::filesystem::path> places = folders_of(run.views);
    std::vector<PictureFile> files;
    for (std::size_t i = 0; i < run.views.size(); ++i) {
        const Image& render = run.result.summary.result.views[i].image;
        files.push_back({folder / places[i] / kRender, &render, false});
        files.push_back({folder / places[i] / kTarget, &run.views[i].image, false});
    }
    return files;
}

/// Compressed side by side.
void write_pictures(const std::vector<PictureFile>& files) {
    for (const PictureFile& f : files) make_folder(f.name.parent_path());
    parallel_tasks(files.size(), [&](std::size_t i) {
        write_image(files[i].name, *files[i].image, files[i].srgb);
    });
}

void write_all(const Renderer& renderer, RunResult& run, OutputFolder& output) {
    const auto& folder = output.unfinished;
    write_pictures(texture_files(run, folder));
    write_pictures(view_files(run, folder));
    write_deliverables(*renderer.data().loaded, folder, run);
    std::filesystem::remove_all(folder / kBuiltIn);
    write_bytes(folder / kHistory, history_csv(run.result.summary.iterations));
    if (run.compared)
        write_bytes(folder / kComparedHistory, history_csv(run.compared->summary.iterations));
    write_bytes(folder / kReport, report_html(run));
    std::vector<std::string> files = unfinished_files(output);
    files.push_back(kSummary);
    const auto was_ended = [](const EvaluatedRun& r) {
        return r.summary.ending == Ending::kCancelled;
    };
    const bool can_go_on = was_ended(run.result) ||
                           (run.settings.compared && (!run.compared || was_ended(*run.compared)));
    if (can_go_on && output.owns_checkpoints)
        for (const std::string& file : checkpoint_files(output)) files.push_back(file);
    write_bytes(folder / kSummary, summary_json(run, files));
    move_into_place(output);
    if (can_go_on) return;
    clear_checkpoints(output);
    set_on_disk(OnDisk::kResults);
}

/// Tells later runs that results of which not all could be written are those of a run. A disk that
/// is full may have no room for it.
void try_to_list(const OutputFolder& output) {
    std::error_code ignored;
    for (const std::filesystem::path& folder : {output.unfinished, output.folder})
        if (std::filesystem::exists(folder / kSummary, ignored)) return;  // lists all, or no run's
    std::vector<std::string> files = unfinished_files(output);
    files.push_back(kSummary);
    try {
        write_bytes(output.unfinished / kSummary, list_json(files));
    } catch (const OutputError&) {
    }
}

}  // namespace

void require_place(const OutputFolder& output, const Renderer& renderer, const RunResult& run,
                   const std::vector<Input>& read) {
    require_no_inputs(output, result_names(*renderer.data().loaded, run), read);
    require_room(output, bytes_of_textures(run));
}

void write_results(const Renderer& renderer, RunResult& run, OutputFolder& output) {
    const WholeStep whole;
    const TickingLine line("writing the results");
    try {
        write_all(renderer, run, output);
    } catch (const OutputError&) {
        if (output.replaces) throw;  // beside earlier results they would be a mixture
        try_to_list(output);
        move_into_place(output);
        throw;
    }
}

}  // namespace burnish
