#include "optimize/memory.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <set>

#include "core/parallel.h"
#include "gradient/estimator.h"
#include "optimize/band_memory.h"
#include "optimize/views.h"

namespace burnish {

namespace {

/// The program with its libraries, and the work memory of its threads.
constexpr double kProgram = 60e6;
/// Embree's structure over a triangle, its copy of the vertices included.
constexpr double kBytesPerTriangle = 100;
/// Two backgrounds, with counts: see make_view_state. In images of a film's size, three channels.
constexpr double kFilmsOfBackgrounds = 8.0 / 3;
/// Such images that a view holds: the target (twice: for the result, too), the backgrounds, the
/// last image, in whose places the start and the result come, and maps of its pixels that together
/// are as large as one; and that an iteration holds at once besides: one for each half, their mean,
/// an exposed one, two adjoints, a weighted adjoint, and a sum of tiles with their borders.
constexpr double kFilmsOfView = 4 + kFilmsOfBackgrounds, kFilmsOfVisit = 8;
/// Arrays of a texture's size: start, truth and present; four for each level of a pyramid (a third
/// more in all), which are the parameters and three moments; where a texture starts that is not the
/// same everywhere, once more; the halves of the gradient, those of
/// the coarser levels and the sum of these; coverage; charts with their borders. Not what bands of
/// tiles add up.
constexpr double kTextureArrays = 3 + 4 * 4.0 / 3 + 1 + 2 + 1 + 1 + 1;

double bytes_of(const Mesh& mesh, bool emits) {
    const auto triangles = static_cast<double>(mesh.triangles.size());
    return static_cast<double>(bytes_of(mesh)) +
           triangles * (sizeof(TriangleRecord) + kBytesPerTriangle) +
           (emits ? triangles * kBytesPerTriangle : 0);
}

/// Of all unknowns, once.
double bytes_of(const Theta& theta) {
    double floats = 0;
    for (const ThetaTexture& t : theta.textures)
        floats += static_cast<double>(t.values.values.size());
    return floats * sizeof(float);
}

/// And the sums of the gradients of several views: two halves at each level of a tree.
double texture_bytes(const Theta& theta, std::size_t batch) {
    const double sums = batch > 1 ? 2.0 * static_cast<double>(std::bit_width(batch)) : 0;
    return (kTextureArrays + sums) * bytes_of(theta);
}

double pixels_of(const Image& image) { return double{1} * image.width * image.height; }

/// Of a pixel of an environment map, the tables by which it is sampled; and with it.
constexpr double kBytesOfSkyTable =
    sizeof(SkyTable::Texel) + sizeof(AliasTable::Column) + sizeof(float);
constexpr double kBytesOfSkyPixel = sizeof(Rgbf) + kBytesOfSkyTable;
/// Skies that views have of their own are prepared twice, for the pictures and for the run.
constexpr double kBytesOfOwnSkyPixel = kBytesOfSkyPixel + kBytesOfSkyTable;

/// Of skies that views do not share with the scene or with each other; and what preparing the
/// largest of them takes besides.
double own_sky_bytes(const RunViews& views) {
    std::set<const Image*> own;
    for (const auto& some : {views.fitted, views.held_out})
        for (const TracedScene& view : some)
            if (const auto& environment = view.lights->environment)
                own.insert(environment->sky->image.get());
    own.erase(sky_of(*views.fitted.front().scene).get());
    double all = 0, max = 0;
    for (const Image* image : own) {
        const double pixels = pixels_of(*image);
        all += pixels, max = std::max(max, pixels);
    }
    return kBytesOfOwnSkyPixel * all + kBytesOfSkyPixel * max;
}

/// What a view keeps, what a visit takes besides, and what a visit replaces, which each view of a
/// batch keeps until the iteration is done.
struct SampleBytes {
    double kept = 0, visit = 0, replaced = 0;
};

/// Samples of light in so many camera samples for each pixel: both techniques; where light bounces,
/// at each vertex of a path, with kTrialMargin above what a trial finds.
double light_samples(const TracedScene& view, const std::vector<char>& reaching, const Theta& theta,
                     std::uint32_t samples_per_pixel) {
    const double share = has_bounces(*view.scene)
                             ? kTrialMargin * record_share(Binding(view, theta), reaching, 0)
                             : 1.0;
    return share * kTechniques * pixels_of(view.film) * samples_per_pixel;
}

/// As traced, with a candidate at each of four texels, all of them twice while parts are joined.
double path_bytes(double samples) {
    return 2 * samples * (sizeof(TracedPath) + 4 * sizeof(Candidate));
}

SampleBytes sample_bytes(const MonteCarlo& o, const TracedScene& view,
                         const std::vector<char>& reaching, const Theta& theta) {
    return {0, path_bytes(light_samples(view, reaching, theta, o.samples))};
}

std::vector<BatchSample> trial_of_records(const std::vector<char>& reaching) {
    constexpr std::size_t kMaxTried = 1 << 16;  // camera samples
    return trial_samples(reaching, kMaxTried);
}

/// Bytes of kept vertices by one path: of its chain while it is a candidate, and of its other
/// vertices in a reservoir. Of a trial, with kTrialMargin.
struct VertexBytes {
    double candidate = 0, reservoir = 0;
};
VertexBytes vertex_bytes(const Reservoirs& o, const TracedScene& view,
                         const std::vector<char>& reaching, const Theta& theta) {
    if (!keeps_vertices(o, *view.scene)) return {};
    const Binding binding(view, theta);
    const TracedPaths trial = trace_paths(unknown_derivatives(binding, {0, Stream::kTrial}, 1),
                                          trial_of_records(reaching), &binding);
    double others = 0;
    for (const ChainPlace& place : trial.places) others += place.last - place.begin;
    const double each = kTrialMargin / std::max(1.0, static_cast<double>(trial.places.size()));
    return {
        sizeof(ChainPlace) + each * static_cast<double>(trial.chains.size()) * sizeof(ChainVertex),
        sizeof(std::uint32_t) + each * others * sizeof(PathVertex)};
}

/// Two reservoirs for each texel: one that no candidate reaches any more keeps its sample for
/// hundreds of iterations. And the unknowns and the adjoint under which they were made.
SampleBytes sample_bytes(const Reservoirs& o, const TracedScene& view,
                         const std::vector<char>& reaching, const Theta& theta) {
    const double samples = light_samples(view, reaching, theta, o.samples);
    const VertexBytes vertices = vertex_bytes(o, view, reaching, theta);
    const double paths = path_bytes(samples) + 2 * samples * vertices.candidate;
    if (!o.reuse) return {0, paths};
    double texels = 0;
    for (const ThetaTexture& t : theta.textures)
        texels += static_cast<double>(t.values.width) * t.values.height;
    const double all = 2 * texels * (sizeof(HistorySample) + vertices.reservoir);
    const double history = all + bytes_of(theta) + pixels_of(view.film) * sizeof(Rgbf);
    return {history, paths + 2 * all, history};
}

SampleBytes sample_bytes(const PathCache&, const TracedScene&, const std::vector<char>&,
                         const Theta&) {
    return {};
}

}  // namespace

double scene_memory(const Scene& scene) {
    double bytes = kProgram;
    for (const Shape& shape : scene.shapes)
        if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
            bytes += bytes_of(*mesh, static_cast<bool>(shape.emitter));
    for (const Shape& prototype : scene.prototypes)
        if (const auto* mesh = std::get_if<Mesh>(&prototype.geometry))
            bytes += bytes_of(*mesh, false);
    bytes += static_cast<double>(scene.shapes.size() * sizeof(Shape));
    for (const Texture& texture : scene.textures)
        if (const auto* bitmap = std::get_if<Bitmap>(&texture))
            bytes += static_cast<double>(bitmap->codes.size()) +
                     static_cast<double>(bitmap->values.size() * sizeof(float));
    const SharedImage sky = sky_of(scene);
    return sky ? bytes + kBytesOfSkyPixel * pixels_of(*sky) : bytes;
}

double record_share(const Binding& binding, const std::vector<char>& reaching, std::uint32_t seed) {
    const std::vector<BatchSample> samples = trial_of_records(reaching);
    if (samples.empty()) return 0;
    const std::size_t paths =
        trace_paths(unknown_derivatives(binding, {seed, Stream::kTrial}, 1), samples).paths.size();
    return static_cast<double>(paths) / static_cast<double>(kTechniques * samples.size());
}

std::vector<std::vector<char>> reaching_pixels(std::span<const TracedScene> views,
                                               const Theta& theta) {
    std::vector<std::vector<char>> reaching(views.size());
    parallel_tasks(views.size(),
                   [&](std::size_t i) { reaching[i] = reaching_pixels(Binding(views[i], theta)); });
    return reaching;
}

std::vector<PathCachePlan> plan_caches(const Estimator& estimator,
                                       std::span<const TracedScene> views,
                                       std::span<const std::vector<char>> reaching,
                                       const Theta& theta) {
    auto cache = kept_cache(estimator);
    if (!cache) return {};
    cache->options.max_bytes = 0;
    std::vector<PathCachePlan> plans(views.size());
    parallel_for(views.size(), [&](std::size_t i) {
        plans[i] = plan(cache->options, Binding(views[i], theta), cache->use, reaching[i]);
    });
    return plans;
}

std::size_t max_bytes_per_pass(std::span<const PathCachePlan> plans) {
    std::size_t max = 0;
    for (const PathCachePlan& p : plans) max = std::max(max, p.bytes_per_pass);
    return max;
}

double fresh_bytes(const PathCache& cache, std::span<const PathCachePlan> plans,
                   std::size_t batch) {
    double max = 0;
    for (const PathCachePlan& plan : plans)
        max = std::max(max, fresh_passes(cache.samples, within(plan, cache.max_bytes).window) *
                                static_cast<double>(plan.bytes_per_pass));
    return static_cast<double>(std::min(batch, plans.size())) * max;
}

namespace {

bool shares_limit(const Estimator& estimator, std::size_t views) {
    const auto* cache = std::get_if<PathCache>(&estimator);
    return cache && cache->max_bytes > 0 && views > 1;
}

}  // namespace

ViewShare share_memory(const Estimator& estimator, std::span<const PathCachePlan> plans) {
    ViewShare share{estimator};
    if (!shares_limit(estimator, plans.size())) return share;
    auto& cache = std::get<PathCache>(share.estimator);
    const std::size_t each = cache.max_bytes / plans.size();
    share.keeps_records = each >= 2 * max_bytes_per_pass(plans);
    if (share.keeps_records) cache.max_bytes = each;
    return share;
}

ViewShare share_memory(const Estimator& estimator, std::span<const TracedScene> views,
                       std::span<const std::vector<char>> reaching, const Theta& theta) {
    if (!shares_limit(estimator, views.size())) return {estimator};
    return share_memory(estimator, plan_caches(estimator, views, reaching, theta));
}

namespace {

/// Bytes of the records of one view.
struct RecordBytes {
    double expected = 0, max = 0;
};

/// The share of the samples that become records, from trials of some of the views. Where light
/// bounces a plan is already that of a trial.
std::vector<double> record_shares(const RunViews& views, const Theta& theta, std::uint32_t seed) {
    constexpr std::size_t kMaxTrials = 8;
    if (has_bounces(*views.fitted.front().scene)) return {1};
    const std::size_t count = views.fitted.size();
    std::vector<double> shares(std::min(kMaxTrials, count));
    parallel_for(shares.size(), [&](std::size_t i) {
        const std::size_t view = i * count / shares.size();
        shares[i] = record_share(Binding(views.fitted[view], theta), views.reaching[view], seed);
    });
    return shares;
}

std::vector<RecordBytes> record_bytes(const PathCache& cache, std::span<const PathCachePlan> plans,
                                      std::span<const double> shares) {
    std::vector<RecordBytes> bytes;
    for (const PathCachePlan& plan : plans) {
        const PathCachePlan p = within(plan, cache.max_bytes);
        const double max = 2.0 * p.window * static_cast<double>(p.bytes_per_pass);
        bytes.push_back({shares[bytes.size() * shares.size() / plans.size()] * max, max});
    }
    return bytes;
}

}  // namespace

MemoryEstimate estimate_memory(const Estimator& estimator, const RunViews& views,
                               std::span<const PathCachePlan> plans, const Theta& theta,
                               std::uint32_t seed, std::size_t batch) {
    MemoryEstimate estimate;
    const std::size_t visited = std::min(batch, views.fitted.size());
    estimate.scene = scene_memory(*views.fitted.front().scene) + own_sky_bytes(views);
    estimate.textures = texture_bytes(theta, visited);
    const std::optional<KeptCache> kept = kept_cache(estimator);
    if (kept && kept->use == CacheUse::kImageAndGradient)
        estimate.textures += band_bytes(views.fitted, views.reaching, theta, seed);
    double visit_images = 0, visit_samples = 0;
    double replaced = 0, backgrounds = 0;  // of each view of a batch, until the iteration ends
    const auto add_view = [&](const TracedScene& view) {
        const double film = pixels_of(view.film) * sizeof(Rgbf);
        estimate.images += kFilmsOfView * film;
        visit_images = std::max(visit_images, kFilmsOfVisit * film);
    };
    for (const TracedScene& view : views.held_out) add_view(view);
    for (std::size_t i = 0; i < views.fitted.size(); ++i) {
        const TracedScene& view = views.fitted[i];
        add_view(view);
        const SampleBytes samples = std::visit(
            [&](const auto& o) { return sample_bytes(o, view, views.reaching[i], theta); },
            estimator);
        estimate.samples += samples.kept;
        visit_samples = std::max(visit_samples, samples.visit);
        replaced = std::max(replaced, samples.replaced);
        backgrounds =
            std::max(backgrounds, kFilmsOfBackgrounds * pixels_of(view.film) * sizeof(Rgbf));
    }
    estimate.images += views.results + visit_images + static_cast<double>(visited) * backgrounds;
    estimate.samples += visit_samples + static_cast<double>(visited) * replaced;
    if (plans.empty()) return estimate;
    const ViewShare share = share_memory(estimator, plans);
    const PathCache cache = kept_cache(share.estimator)->options;
    estimate.samples += fresh_bytes(cache, plans, batch);
    const std::vector<double> shares = record_shares(views, theta, seed);
    for (const RecordBytes& view : record_bytes(cache, plans, shares)) {
        const auto take_in = [&](double& sum, double bytes) {
            sum = share.keeps_records ? sum + bytes : std::max(sum, bytes);
        };
        take_in(estimate.max_records, view.max);
        take_in(estimate.records, view.expected);
    }
    return estimate;
}

}  // namespace burnish
