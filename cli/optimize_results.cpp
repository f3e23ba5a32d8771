#include "cli/optimize_results.h"

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/deliverables.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/summary.h"
#include "cli/texture_files.h"
#include "image/files.h"
#include "image/image.h"
#include "render/renderer.h"

namespace burnish {

void log_result(const RunResult& run, const EvaluatedRun& evaluated) {
    const Summary& s = evaluated.summary;
    std::string text = fmt::format("{}: loss {:.4g} -> {:.4g} in {} iterations, {}{}",
                                   name_of(evaluated), s.initial_loss, loss_without_noise(s.result),
                                   s.iterations.size(), duration_text(s.seconds),
                                   s.ending == Ending::kCancelled  ? " (ended by a signal)"
                                   : s.ending == Ending::kPatience ? " (the loss fell no longer)"
                                                                   : "");
    if (is_too_noisy(s.result))
        text +=
            fmt::format("; the evaluation is too noisy to tell how low, try --evaluation-spp {}",
                        4 * s.result.samples_per_pixel);
    for (std::size_t i = 0; i < evaluated.texture_errors.size(); ++i)
        text += fmt::format("; {} error {:.4f} -> {:.4f}", run.textures[i].name,
                            run.initial_errors[i].seen, evaluated.texture_errors[i].seen);
    for (std::size_t i = 0; i < run.textures.size(); ++i)
        if (const Image& texels = s.textures[i].values; is_one_value(texels))
            text += fmt::format("; {} = {}", run.textures[i].name, values_text(texels));
    log_info(text);
    const RunCounts counts = counts_of(s);
    if (const std::size_t rejected = counts.rejected_derivatives + counts.rejected_image)
        log_warning(fmt::format("{} contributions were not finite and were left out",
                                count_text(rejected)));
}

void write_results(const Renderer& renderer, RunResult& run, OutputFolder& output) {
    const WholeStep whole;
    const TickingLine line("writing the results");
    const auto& folder = output.unfinished;
    std::filesystem::create_directories(folder / "textures");
    for (std::size_t i = 0; i < run.textures.size(); ++i) {
        const TargetTexture& t = run.textures[i];
        const RecoveredTexture& recovered = run.result.summary.textures[i];
        const auto& bitmap = std::get<Bitmap>(renderer.data().scene()[t.texture]);
        write_texels(folder / "textures", t.file, bitmap, recovered.values);
        for (const auto& [name, map] : evidence_maps(recovered))
            write_image(folder / "textures" / (t.file + "_" + name + ".exr"), *map);
    }
    const std::vector<std::string> names = folder_names(run.views);
    for (std::size_t i = 0; i < run.views.size(); ++i) {
        const auto place = run.views.size() == 1 ? folder : folder / "views" / names[i];
        std::filesystem::create_directories(place);
        write_image(place / "render.exr", run.result.summary.result.views[i].image);
        write_image(place / "target.exr", run.views[i].image);
    }
    write_deliverables(*renderer.data().loaded, folder, run);
    std::filesystem::remove_all(folder / kBuiltIn);
    write_bytes(folder / "history.csv", history_csv(run.result.summary.iterations));
    if (run.compared)
        write_bytes(folder / "history_compared.csv", history_csv(run.compared->summary.iterations));
    write_bytes(folder / "report.html", report_html(run));
    std::vector<std::string> files = unfinished_files(output);
    files.push_back("summary.json");
    const bool can_go_on = run.result.summary.ending == Ending::kCancelled ||
                           (run.compared && run.compared->summary.ending == Ending::kCancelled);
    if (can_go_on)
        for (const std::string& file : checkpoint_files(output)) files.push_back(file);
    write_bytes(folder / "summary.json", summary_json(run, files));
    move_into_place(output);
    if (!can_go_on) clear_checkpoints(output);
}

}  // namespace burnish
