#include "optimize/evaluation.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/random.h"
#include "core/require.h"
#include "image/quality.h"
#include "optimize/batch.h"
#include "optimize/ranks.h"
#include "optimize/search_plan.h"
#include "optimize/state_fields.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"
#include "render/visible_pixels.h"

namespace burnish {

/// What all processes get of a view: all but its image.
void fields(auto& archive, Is<ViewEvaluation> auto& v) {
    archive(v.exposure, v.loss, v.noise_floor, v.psnr);
}

namespace {

/// What tells the evaluations of one run apart.
enum Salt : std::uint32_t { kResult = 1, kStart = 2, kPatience = 100 };

/// The share of all views that is done.
Progress progress_of_view(const Setup& setup, std::size_t view, const Progress& progress) {
    if (!progress) return {};
    return [&progress, view, count = static_cast<double>(setup.views.size())](double done) {
        progress((static_cast<double>(view) + done) / count);
    };
}

/// The first process gets all images, all get the numbers.
void share_evaluations(const Setup& setup, std::vector<ViewEvaluation>& views) {
    const Ranks& ranks = setup.problem.ranks;
    if (ranks.count == 1) return;
    std::vector<Image> images;
    for (ViewEvaluation& v : views) images.push_back(std::move(v.image));
    share(ranks, setup.owners, Recipient::kAll, views);
    share(ranks, setup.owners, Recipient::kFirst, images);
    for (std::size_t i = 0; i < views.size(); ++i) views[i].image = std::move(images[i]);
}

double psnr_of(const Setup& setup, std::size_t view, const Theta& theta,
               const ExposureFactors& exposure, const Image& a, const Image& b) {
    const View& v = setup.problem.views[view];
    const auto values = compared_in(scene_of(setup, view), theta, v.mask).values;
    return psnr_without_noise(exposed(exposure, a), exposed(exposure, b), v.image,
                              white_of(v.image, values), values);
}

ViewEvaluation evaluate_view(const Setup& setup, std::size_t view, const Theta& theta,
                             std::uint32_t half_samples, std::uint32_t salt, RenderCounts& counts,
                             const Progress& progress) {
    const auto image = [&](std::uint32_t which) {
        const Progress share = [&](double done) { progress((which + done) / 2); };
        return evaluation_image(setup, view, theta, {salt, which}, half_samples, &counts,
                                progress ? share : Progress{});
    };
    const Image a = image(0), b = image(1);
    const ExposureFactors exposure = exposure_of(setup, view, a, b);
    ViewEvaluation own{mean_of(a, b), exposure, 0, noise_floor(setup, view, exposure, a, b)};
    own.loss = loss_value_of(setup, view, exposure, own.image);
    own.psnr = psnr_of(setup, view, theta, exposure, a, b);
    return own;
}

}  // namespace

Compared compared_in(const TracedScene& scene, const Theta& theta, const Image& mask) {
    const std::vector<char> seen = visible_pixels(scene, unknown_bsdfs(*scene.scene, theta));
    const std::vector<char> counted = counted_values(mask);
    Compared compared{std::vector<char>(seen.size()), std::vector<char>(3 * seen.size())};
    for (std::size_t k = 0; k < compared.values.size(); ++k)
        if (seen[k / 3] && (counted.empty() || counted[k]))
            compared.values[k] = compared.pixels[k / 3] = 1;
    return compared;
}

Image evaluation_image(const Setup& setup, std::size_t view, const Theta& theta, EvaluationKey key,
                       std::uint32_t passes, RenderCounts* counts, const Progress& progress) {
    const TextureTable textures = texture_table(scene_of(setup), theta);
    // A seed for each half: the passes of one seed share a sequence of film offsets that fills the
    // pixel evenly, so that parts of it are not independent.
    const auto seed = philox4x32({key.salt, key.half, 0, 0},
                                 {seed_of_view(setup.options.seed, view),
                                  static_cast<std::uint32_t>(Stream::kEvaluation)})[0];
    const TraceInput input{
        .scene = &scene_of(setup, view), .textures = &textures, .key = {seed, Stream::kEvaluation}};
    if (!renders_together(setup)) return render(input, 0, passes, counts, progress);
    const Ranks& ranks = setup.problem.ranks;
    const Film& film = input.scene->film;
    const std::size_t count = tile_count(film);
    TileImages sums =
        render_tiles(input, {0, 0, passes}, run_of(ranks, ranks.rank, count), counts, progress);
    share(ranks, shared_out(ranks, count), Recipient::kAll, sums);
    return image_of_tiles(film, passes, sums);
}

Evaluation evaluate(const Setup& setup, const Theta& theta, std::uint32_t samples_per_pixel,
                    std::uint32_t salt, const Progress& progress) {
    require(
        samples_per_pixel >= 2 && samples_per_pixel <= kMaxSamplesPerPixel,
        fmt::format("samples per pixel of an evaluation are {}: expected at least 2, at most {}",
                    samples_per_pixel, kMaxSamplesPerPixel));
    const std::uint32_t half = samples_per_pixel / 2;
    Evaluation result;
    result.samples_per_pixel = 2 * half;
    result.views.resize(setup.views.size());
    RenderCounts counts;
    for (std::size_t view = 0; view < setup.views.size(); ++view)
        if (is_mine(setup, view))
            result.views[view] = evaluate_view(setup, view, theta, half, salt, counts,
                                               progress_of_view(setup, view, progress));
    share_evaluations(setup, result.views);
    result.rejected = sum_over(setup.problem.ranks, counts.rejected);
    for (const std::size_t view : setup.fitted) {
        const double share = 1 / static_cast<double>(setup.fitted.size());
        result.loss += share * result.views[view].loss;
        result.noise_floor += share * result.views[view].noise_floor;
    }
    return result;
}

std::uint32_t result_samples(double visited, double pixels) {
    constexpr double kOfVisit = 0.2, kMinOfAll = 1 << 22, kMaxSamples = 256;
    return static_cast<std::uint32_t>(
        std::clamp(std::max(kOfVisit * visited, kMinOfAll) / pixels, 2.0, kMaxSamples));
}

namespace {

double pixels_of_views(const Setup& setup) {
    double all = 0;
    for (const Renderer& view : setup.views) all += pixels_of(view);
    return all;
}

}  // namespace

std::uint32_t result_samples(const Setup& setup, std::size_t iterations) {
    const std::uint32_t asked = setup.options.evaluation_samples;
    if (asked > 0) return std::max(2u, asked);
    return result_samples(static_cast<double>(iterations) * pixels_of_iteration(setup),
                          pixels_of_views(setup));
}

Evaluation evaluate_result(const Setup& setup, const Theta& theta, std::uint32_t samples,
                           const Progress& progress) {
    return evaluate(setup, theta, samples, kResult, progress);
}

double check_loss(const Setup& setup, const Theta& theta) {
    constexpr std::uint32_t kSamples = 8;
    const std::vector<std::size_t> checked = searched_views(setup.fitted.size());
    std::vector<double> losses(checked.size());
    std::vector<int> owners;
    for (std::size_t i = 0; i < losses.size(); ++i) {
        const std::size_t view = setup.fitted[checked[i]];
        owners.push_back(setup.owners[view]);
        if (!is_mine(setup, view)) continue;
        const auto image = [&](std::uint32_t half) {
            return evaluation_image(setup, view, theta, {kPatience, half}, kSamples);
        };
        losses[i] = held_out_loss(setup, view, image(0), image(1));
    }
    share(setup.problem.ranks, owners, Recipient::kAll, losses);
    double sum = 0;
    for (const double loss : losses) sum += loss;
    return sum / static_cast<double>(losses.size());
}

std::uint32_t start_samples(std::size_t views, double pixels) {
    constexpr double kSamples = 8, kViews = 8, kMinOfAll = 1 << 20, kMaxSamples = 64;
    const double of_views =
        std::clamp(kSamples * kViews / static_cast<double>(views), 2.0, kSamples);
    return static_cast<std::uint32_t>(
        std::max(of_views, std::clamp(kMinOfAll / pixels, 2.0, kMaxSamples)));
}

Evaluation evaluate_start(const Setup& setup, const Theta& start, std::uint32_t of_result,
                          const Progress& progress) {
    const std::uint32_t samples = is_noise_known(setup)
                                      ? start_samples(setup.views.size(), pixels_of_views(setup))
                                      : of_result;
    return evaluate(setup, start, samples, kStart, progress);
}

}  // namespace burnish
