#include "cli/run_result.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "cli/console.h"
#include "image/quality.h"
#include "optimize/evaluation.h"
#include "optimize/view_loss.h"

namespace burnish {

TextureErrors errors_of(const TargetTexture& texture, const Image& texels) {
    const Image& truth = *texture.truth;
    return {texture_error(texels, truth, texture.evidence.visited),
            weighted_texture_error(texels, truth, texture.evidence.sensitivity)};
}

std::string error_text(double error, int decimals) {
    return std::isfinite(error) ? fmt::format("{:.{}f}", error, decimals) : "not known";
}

std::string values_text(const Image& texels) {
    std::string text;
    for (const float v : texels.values)
        text += fmt::format("{}{:.4g}", text.empty() ? "" : ", ", v);
    return text;
}

bool is_too_noisy(const Evaluation& result) {
    constexpr double kUncertainty = 0.05;
    return std::isfinite(result.noise_floor) &&
           loss_without_noise(result) < kUncertainty * result.noise_floor;
}

double similarity_of(const RunResult& run, std::size_t view) {
    const View& v = run.views[view];
    Theta theta;
    for (const TargetTexture& t : run.textures) theta.textures.push_back({t.texture, {}});
    const Compared compared = compared_in(run.renderers[view].data().traced, theta, v.mask);
    const ViewEvaluation& result = run.result.summary.result.views[view];
    const Image image = exposed(result.exposure, result.image);
    return ssim(image, alike_where_uncounted(v.image, image, v.mask),
                white_of(v.image, compared.values), compared.pixels);
}

Settings repeatable_settings(const RunResult& run) {
    Settings settings = run.settings;
    settings.options.stop.iterations = run.result.summary.counts.iterations;
    settings.options.stop.seconds = Stop{}.seconds;
    settings.options.evaluation_samples = run.result.summary.result.samples_per_pixel;
    if (!run.result.summary.searched.empty())
        settings.options.search_effort = run.result.summary.search_effort;
    if (run.compared) settings.run.compare_iterations = run.compared->summary.counts.iterations;
    return settings;
}

std::string ended_by(const Summary& summary) {
    return summary.ending == Ending::kCancelled ? "signal" : name_of(summary.ending);
}

std::string unvisited_text(const RunResult& run, std::size_t texture) {
    const RecoveredTexture& t = run.result.summary.textures[texture];
    if (t.unvisited == 0) return "";
    const std::size_t all = t.coverage.values.size();
    return fmt::format(
        "No sample of any view came to {} texels that surfaces read, of {} in all: {}.",
        count_text(t.unvisited), count_text(all),
        t.filled ? "they are filled from those around them in their chart" : "they hold the start");
}

std::vector<std::pair<std::string, const Image*>> evidence_maps(const RecoveredTexture& texture) {
    std::vector<std::pair<std::string, const Image*>> maps{{"coverage", &texture.coverage}};
    if (texture.confidence.width > 0) maps.emplace_back("confidence", &texture.confidence);
    return maps;
}

namespace {

/// The number that a file of the system begins with; infinity where there is none ("max").
double number_in(const std::string& file) {
    double number = 0;
    std::ifstream stream(file);
    return stream >> number ? number : std::numeric_limits<double>::infinity();
}

/// Of version 2 and 1, of the process's group and those above it.
double control_group_limit() {
    double limit = number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes");
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        if (!line.starts_with("0::/")) continue;
        for (std::string group = line.substr(3);; group.resize(group.rfind('/'))) {
            limit = std::min(limit, number_in("/sys/fs/cgroup" + group + "/memory.max"));
            if (group.empty() || group.find('/') == std::string::npos) break;
        }
    }
    return limit;
}

}  // namespace

double physical_memory() {
    return std::min(
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)),
        control_group_limit());
}

double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

std::string memory_text(const MemoryEstimate& memory) {
    if (memory.max_records == 0)
        return fmt::format("at most about {}, of which samples and reservoirs {}",
                           bytes_text(maximum(memory)), bytes_text(memory.samples));
    return fmt::format("about {}, of which records {}; at most {}", bytes_text(expected(memory)),
                       bytes_text(memory.records), bytes_text(maximum(memory)));
}

}  // namespace burnish
