#include "optimize/memory.h"

#include <algorithm>

#include "core/parallel.h"
#include "gradient/candidates.h"
#include "gradient/path_cache/iteration.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

/// The program with its libraries, and the work memory of its threads.
constexpr double kProgram = 60e6;
/// Embree's structure over a triangle, its copy of the vertices included.
constexpr double kBytesPerTriangle = 100;
/// Images of the film's size, three channels, that an iteration holds at once: the target (twice:
/// for the result, too), the start, the static part, one for each bank, their mean, two adjoints, a
/// weighted adjoint, and a sum of tiles with their borders.
constexpr double kFilms = 13;
/// Arrays of a texture's size: start, truth and present; four for each level of a pyramid (a third
/// more in all), which are the parameters and three moments; where a texture starts that is not the
/// same everywhere, once more; the halves of the gradient, those of
/// the coarser levels and the sum of these; what bands of tiles add up, which overlap; coverage;
/// charts with their borders or links.
constexpr double kTextureArrays = 3 + 4 * 4.0 / 3 + 1 + 2 + 1 + 2 + 1 + 1;

double bytes_of(const Mesh& mesh, bool emits) {
    const auto triangles = static_cast<double>(mesh.triangles.size());
    return static_cast<double>(mesh.positions.size() + mesh.normals.size()) * sizeof(Vec3f) +
           static_cast<double>(mesh.uvs.size()) * sizeof(Vec2f) +
           triangles * (sizeof(Triangle) + sizeof(TriangleRecord) + kBytesPerTriangle) +
           (emits ? triangles * kBytesPerTriangle : 0);
}

double scene_bytes(const Scene& scene) {
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

double texture_bytes(const Theta& theta) {
    double floats = 0;
    for (const ThetaTexture& t : theta.textures)
        floats += static_cast<double>(t.values.values.size());
    return kTextureArrays * floats * sizeof(float);
}

double pixels_of(const Scene& scene) {
    return double{static_cast<double>(scene.film.crop_width)} * scene.film.crop_height;
}

/// Both draws of every sample, as traced, with a candidate at each of four texels, all of them
/// twice while parts are joined; of reservoirs, two for each texel, but never more than there were
/// candidates in as many iterations as confidence reaches back.
double sample_bytes(const Scene& scene, const Theta& theta, const GradientOptions& options) {
    const double direct_samples = 2 * pixels_of(scene) * options.samples_per_pixel;
    const double paths = 2 * direct_samples * (sizeof(TracedPath) + 4 * sizeof(Candidate));
    if (!has_history(options.estimator)) return paths;
    double texels = 0;
    for (const ThetaTexture& t : theta.textures)
        texels += static_cast<double>(t.values.width) * t.values.height;
    const double reservoirs = std::min(2 * texels, 4 * direct_samples * double{1 + options.confidence_cap});
    return paths + 4 * reservoirs * sizeof(HistorySample);
}

}  // namespace

double record_share(const TracedScene& traced, const Theta& theta, std::uint32_t seed) {
    constexpr std::size_t kTried = 1 << 16;  // camera samples, at most
    const Scene& scene = *traced.scene;
    const std::vector<char> unknowns = unknown_bsdfs(scene, theta);
    const std::vector<char> seen = visible_pixels(scene, unknowns);
    const auto all = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1));
    if (all == 0) return 0;
    const std::size_t every = (all + kTried - 1) / kTried;
    std::vector<BatchSample> samples;
    std::size_t count = 0;
    for (std::uint32_t pixel = 0; pixel < seen.size(); ++pixel)
        if (seen[pixel] && count++ % every == 0) samples.push_back({{pixel, 0, 0}});
    const TextureTable textures = texture_table(scene, theta);
    std::size_t rejected = 0;
    const auto paths = trace_paths(
        {&traced, &textures, {seed, Stream::kTrial}, 1, SurfaceChoice::kUnknown, unknowns, true},
        samples, rejected);
    return static_cast<double>(paths.size()) / static_cast<double>(kTechniques * samples.size());
}

MemoryPlan plan_memory(const TracedScene& traced, const Theta& theta, const SolveOptions& options) {
    const Scene& scene = *traced.scene;
    MemoryPlan plan;
    plan.scene = scene_bytes(scene);
    plan.textures = texture_bytes(theta);
    plan.images = kFilms * pixels_of(scene) * sizeof(Rgbf);
    if (options.gradient.estimator != Estimator::kPool) {
        plan.samples = sample_bytes(scene, theta, options.gradient);
        return plan;
    }
    const PoolPlan pool = plan_pool(scene, theta, options.pool);
    plan.max_records = 2.0 * pool.window * static_cast<double>(pool.bytes_per_pass);
    plan.records = plan.max_records * record_share(traced, theta, options.seed);
    return plan;
}

}  // namespace burnish
