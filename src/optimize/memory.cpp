#include "optimize/memory.h"

#include <algorithm>

#include "core/parallel.h"
#include "gradient/estimator.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

/// The program with its libraries, and the work memory of its threads.
constexpr double kProgram = 60e6;
/// Embree's structure over a triangle, its copy of the vertices included.
constexpr double kBytesPerTriangle = 100;
/// Images of the film's size, three channels, that an iteration holds at once: the target (twice:
/// for the result, too), the start, the background, one for each half, their mean, two adjoints, a
/// weighted adjoint, and a sum of tiles with their borders.
constexpr double kFilms = 13;
/// Arrays of a texture's size: start, truth and present; four for each level of a pyramid (a third
/// more in all), which are the parameters and three moments; where a texture starts that is not the
/// same everywhere, once more; the halves of the gradient, those of
/// the coarser levels and the sum of these; what bands of tiles add up, which overlap; coverage;
/// charts with their borders.
constexpr double kTextureArrays = 3 + 4 * 4.0 / 3 + 1 + 2 + 1 + 2 + 1 + 1;

double bytes_of(const Mesh& mesh, bool emits) {
    const auto triangles = static_cast<double>(mesh.triangles.size());
    return static_cast<double>(mesh.positions.size() + mesh.normals.size()) * sizeof(Vec3f) +
           static_cast<double>(mesh.uvs.size()) * sizeof(Vec2f) +
           triangles * (sizeof(Triangle) + sizeof(TriangleRecord) + kBytesPerTriangle) +
           (emits ? triangles * kBytesPerTriangle : 0);
}

double texture_bytes(const Theta& theta) {
    double floats = 0;
    for (const ThetaTexture& t : theta.textures)
        floats += static_cast<double>(t.values.values.size());
    return kTextureArrays * floats * sizeof(float);
}

double pixels_of(const Scene& scene) {
    return double{static_cast<double>(scene.film.crop_width)} * scene.film.crop_height;
}

/// Both samples of every camera sample, as traced, with a candidate at each of four texels, all of
/// them twice while parts are joined.
double path_bytes(const Binding& binding, std::uint32_t samples_per_pixel) {
    const double samples = kTechniques * pixels_of(binding.scene()) * samples_per_pixel;
    return 2 * samples * (sizeof(TracedPath) + 4 * sizeof(Candidate));
}

double sample_bytes(const MonteCarlo& o, const Binding& binding) {
    return path_bytes(binding, o.samples);
}

/// Two reservoirs for each texel, but never more than there were candidates in as many iterations
/// as confidence reaches back.
double sample_bytes(const Reservoirs& o, const Binding& binding) {
    const double paths = path_bytes(binding, o.samples);
    if (!o.reuse) return paths;
    double texels = 0;
    for (const ThetaTexture& t : binding.theta.textures)
        texels += static_cast<double>(t.values.width) * t.values.height;
    const double candidates = 4 * kTechniques * pixels_of(binding.scene()) * o.samples;
    const double reservoirs = std::min(2 * texels, candidates * double{1 + o.confidence_cap});
    return paths + 4 * reservoirs * sizeof(HistorySample);
}

double sample_bytes(const PathCache&, const Binding&) { return 0; }

}  // namespace

double scene_memory(const Scene& scene) {
    double bytes = kProgram;
    for (const Shape& shape : scene.shapes)
        if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
            bytes += bytes_of(*mesh, static_cast<bool>(shape.emitter));
    for (const Texture& texture : scene.textures)
        if (const auto* bitmap = std::get_if<Bitmap>(&texture))
            bytes += static_cast<double>(bitmap->codes.size()) +
                     static_cast<double>(bitmap->values.size() * sizeof(float));
    for (const Emitter& emitter : scene.emitters)
        if (const auto* sky = std::get_if<EnvironmentEmitter>(&emitter)) {
            const auto pixels = static_cast<double>(sky->image.values.size()) / 3;
            bytes += pixels * (sizeof(Rgbf) + sizeof(EnvironmentTable::Texel) +
                               sizeof(AliasTable::Column) + sizeof(float));
        }
    return bytes;
}

double record_share(const Binding& binding, std::uint32_t seed) {
    constexpr std::size_t kMaxTried = 1 << 16;  // camera samples
    const std::vector<char> seen = visible_pixels(binding.traced, binding.unknown_bsdfs);
    const auto all = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1));
    if (all == 0) return 0;
    const std::size_t every = (all + kMaxTried - 1) / kMaxTried;
    std::vector<BatchSample> samples;
    std::size_t count = 0;
    for (std::uint32_t pixel = 0; pixel < seen.size(); ++pixel)
        if (seen[pixel] && count++ % every == 0) samples.push_back({{pixel, 0, 0}});
    std::size_t rejected = 0;
    const auto paths =
        trace_paths(unknown_derivatives(binding, {seed, Stream::kTrial}, 1), samples, rejected);
    return static_cast<double>(paths.size()) / static_cast<double>(kTechniques * samples.size());
}

MemoryEstimate estimate_memory(const Estimator& estimator, const Binding& binding,
                               std::uint32_t seed) {
    MemoryEstimate estimate;
    estimate.scene = scene_memory(binding.scene());
    estimate.textures = texture_bytes(binding.theta);
    estimate.images = kFilms * pixels_of(binding.scene()) * sizeof(Rgbf);
    estimate.samples =
        std::visit([&](const auto& o) { return sample_bytes(o, binding); }, estimator);
    if (const auto cache = kept_cache(estimator)) {
        const PathCachePlan cache_plan = plan(cache->options, binding, cache->use);
        estimate.max_records =
            2.0 * cache_plan.window * static_cast<double>(cache_plan.bytes_per_pass);
        estimate.records = estimate.max_records * record_share(binding, seed);
    }
    return estimate;
}

}  // namespace burnish
