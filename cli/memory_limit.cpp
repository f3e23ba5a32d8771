#include "cli/memory_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/picture_memory.h"
#include "cli/process_memory.h"
#include "cli/progress.h"
#include "cli/unseeing_views.h"
#include "core/parallel.h"
#include "gradient/binding.h"
#include "gradient/path_cache/path_cache.h"
#include "optimize/ranks.h"

namespace burnish {

namespace {

constexpr double kBytesPerGib = 0x1p30;

/// Where nothing is said, by the machine of the first process.
double memory_limit(const RunResult& run) {
    const auto& asked = run.settings.run.max_memory;
    return agree(run.ranks, asked ? *asked * kBytesPerGib : physical_memory() / 2);
}

Theta initial_theta(const RunResult& run) {
    Theta theta;
    for (const TargetTexture& t : run.textures) theta.textures.push_back({t.texture, t.initial});
    return theta;
}

/// Of a run, while another one follows: what it started from and what it found, images of each view
/// and maps of each texture.
double bytes_of_results(const RunViews& views, const Theta& theta) {
    constexpr double kImages = 2, kMaps = 4;  // coverage, confidence, visited, sensitivity
    double floats = 0;
    for (const auto& some : {views.fitted, views.held_out})
        for (const TracedScene& view : some) floats += kImages * 3 * pixels_of(view.film);
    for (const auto& [texture, texels] : theta.textures)
        floats += (texels.channels + kMaps) * double{1} * texels.width * texels.height;
    return floats * sizeof(float);
}

/// What the windows that were asked for take at most: a limit above it decides nothing.
std::size_t bytes_of_windows(const PathCache& cache, std::span<const PathCachePlan> plans) {
    return std::max<std::size_t>(1, 2 * plans.size() * cache.window * max_bytes_per_pass(plans));
}

/// "--max-memory 0.062", which admits at least so many bytes.
std::string limit_text(double bytes) {
    constexpr double kSteps = 1000;  // of a GiB
    return fmt::format("--max-memory {:.3f}", std::ceil(bytes / kBytesPerGib * kSteps) / kSteps);
}

/// What the limit leaves for the records goes to the options, so far as it decides on them: a run
/// goes on under another limit that leaves as many. Where it leaves fewer than the options name,
/// the results may have other bytes: a warning, or ResourceError for a run that goes on.
MemoryEstimate plan_cache(const RunViews& views, std::span<const PathCachePlan> plans,
                          const Theta& theta, double limit, bool goes_on, Options& options) {
    auto& cache = std::get<PathCache>(options.estimator);
    const std::size_t asked = std::exchange(cache.max_bytes, 0);
    const double fixed =
        without_records(estimate_memory(cache, views, {}, theta, options.seed, options.batch));
    const double fresh = fresh_bytes(cache, plans, options.batch);
    // No more is traced than is kept: half of what is left is enough.
    const double others = fixed + std::min(fresh, std::max(limit - fixed, 0.0) / 2);
    const double pass = 2.0 * static_cast<double>(max_bytes_per_pass(plans));
    const double left = limit - others;
    const std::size_t all = bytes_of_windows(cache, plans);
    const std::size_t wanted = asked > 0 ? std::min(asked, all) : all;
    const bool are_fewer = asked > 0 && left < static_cast<double>(wanted);
    const std::string enough = limit_text(fixed + fresh + static_cast<double>(wanted));
    if (are_fewer && goes_on)
        throw ResourceError(fmt::format(
            "the run keeps up to {} of records, the limit of the memory, {}, leaves {} for them: "
            "expected {} or more",
            bytes_text(static_cast<double>(wanted)), bytes_text(limit),
            bytes_text(std::max(left, 0.0)), enough));
    if (left < std::max(pass, 1.0))
        throw ResourceError(fmt::format(
            "the scene, its images, textures and fresh samples take about {}, one pass in each "
            "half of the path cache up to {}: expected {} or more, found {}",
            bytes_text(others), bytes_text(pass),
            limit_text(fixed + std::min(fresh + pass, 2 * pass)), bytes_text(limit)));
    if (are_fewer)
        log_warning(
            fmt::format("path_cache.max_bytes is {}, of which the run can use {}, the limit of the "
                        "memory leaves {}: the bytes of the results may be others, {} keeps them",
                        bytes_text(static_cast<double>(asked)),
                        bytes_text(static_cast<double>(wanted)), bytes_text(left), enough));
    cache.max_bytes = std::min(static_cast<std::size_t>(left), wanted);
    return estimate_memory(cache, views, plans, theta, options.seed, options.batch);
}

std::string kept_text(const PathCache& cache, std::span<const PathCachePlan> plans) {
    const ViewShare share = share_memory(cache, plans);
    if (!share.keeps_records) return "the records of one view at a time";
    std::uint32_t window = cache.window;
    for (const PathCachePlan& plan : plans)
        window =
            std::min(window, within(plan, std::get<PathCache>(share.estimator).max_bytes).window);
    return halves_text(window);
}

/// What the first path cache keeps goes to the run, too.
MemoryEstimate plan_run(const RunViews& views, const Theta& theta, double limit, Options& options,
                        RunResult& run) {
    const std::vector<PathCachePlan> plans =
        plan_caches(options.estimator, views.fitted, views.reaching, theta);
    if (const auto* cache = std::get_if<PathCache>(&options.estimator)) {
        const MemoryEstimate memory = plan_cache(views, plans, theta, limit, run.goes_on, options);
        if (!run.kept_text.empty()) return memory;
        run.kept_text = kept_text(*cache, plans);
        for (const PathCachePlan& plan : plans) run.seeing_pixels += plan.pixels;
        return memory;
    }
    const MemoryEstimate memory =
        estimate_memory(options.estimator, views, plans, theta, options.seed, options.batch);
    if (run.settings.run.max_memory && maximum(memory) > limit)
        throw ResourceError(fmt::format("the run takes {}: expected {} or more, found {}",
                                        memory_text(memory), limit_text(maximum(memory)),
                                        bytes_text(limit)));
    return memory;
}

/// What the program takes besides is left out, but not of the limit that is named: one below that
/// is refused once all is known.
void require_memory(double bytes, double limit, const std::string& what) {
    if (bytes > limit)
        throw ResourceError(
            fmt::format("{}: expected {} or more, or smaller meshes and textures, found {}", what,
                        limit_text(scene_memory({}) + bytes), bytes_text(limit)));
}

}  // namespace

BeforeReading limit_of_files(const RunSettings& settings) {
    if (!settings.max_memory) return {};
    const double limit = *settings.max_memory * kBytesPerGib;
    return [limit](const std::filesystem::path& file, double bytes, double before) {
        require_memory(before + bytes, limit,
                       fmt::format("{}: reading it takes at least {} beside the {} read before it",
                                   file.string(), bytes_text(bytes), bytes_text(before)));
    };
}

void require_scene_memory(const Scene& scene, const RunSettings& settings) {
    if (!settings.max_memory) return;
    const double bytes = scene_memory(scene) - scene_memory({});
    require_memory(
        bytes, *settings.max_memory * kBytesPerGib,
        fmt::format("the scene and what rays need of it take about {}", bytes_text(bytes)));
}

std::size_t plan_pictures(const Scene& scene, RunResult& run) {
    const RunSettings& settings = run.settings.run;
    const std::vector<PictureBytes> pictures = bytes_of_pictures(run.sources, settings.scale);
    std::vector<double> reading;
    double kept = 0;
    for (const PictureBytes& bytes : pictures) reading.push_back(bytes.reading), kept += bytes.kept;
    const double limit = memory_limit(run), others = scene_memory(scene) + kept + run.state_bytes;
    const auto largest = std::ranges::max_element(reading);
    const CapturedView& view = run.sources[static_cast<std::size_t>(largest - reading.begin())];
    if (settings.max_memory && *largest > 0 && others + *largest > limit)
        throw ResourceError(fmt::format(
            "{}: reading it takes up to {}, the scene{} and what is kept of all pictures "
            "{}: expected {} or more, a lower --scale or smaller pictures, found {}",
            view.image.empty() ? view.mask : view.image, bytes_text(*largest),
            run.goes_on ? ", the state of the run" : "", bytes_text(others),
            limit_text(others + *largest), bytes_text(limit)));
    const AtOnce fit = fitting(reading, limit - others, threads_of(settings.threads));
    run.memory.pictures = kept + run.state_bytes + fit.bytes;
    return fit.count;
}

void plan_memory(RunViews views, RunResult& run) {
    const TickingLine line("estimating the memory");
    const Theta theta = initial_theta(run);
    const std::vector<std::vector<char>> reaching = reaching_pixels(views.fitted, theta);
    find_unseeing_views(theta, reaching, run);
    views.reaching = reaching;
    const double limit = memory_limit(run);
    const auto plan = [&](Options& options) {
        MemoryEstimate memory = plan_run(views, theta, limit, options, run);
        memory.pictures = run.memory.pictures;
        return memory;
    };
    run.memory = plan(run.settings.options);
    if (!run.settings.compared) return;
    views.results = bytes_of_results(views, theta);
    const MemoryEstimate other = plan(*run.settings.compared);
    const double larger = std::max(maximum(run.memory), maximum(other));
    if (expected(other) > expected(run.memory)) run.memory = other;
    if (larger > maximum(run.memory)) run.memory.max_records = larger - without_records(run.memory);
}

}  // namespace burnish
