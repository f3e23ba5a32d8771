#include "experiments/target_scene.h"

#include <algorithm>
#include <cmath>

#include "burnish/error.h"
#include "texture/coverage.h"

namespace burnish {

namespace {

/// Averages of blocks; the sides need not divide.
Image averaged(const Image& image, int width, int height) {
    Image small = make_image(width, height, image.channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int x0 = x * image.width / width, x1 = (x + 1) * image.width / width;
            const int y0 = y * image.height / height, y1 = (y + 1) * image.height / height;
            for (int c = 0; c < image.channels; ++c) {
                double sum = 0;
                for (int v = y0; v < y1; ++v)
                    for (int u = x0; u < x1; ++u) sum += double{image.at(u, v, c)};
                small.at(x, y, c) = static_cast<float>(sum / ((x1 - x0) * (y1 - y0)));
            }
        }
    return small;
}

/// Unlike find_texture, takes full names only.
TextureId target_texture(const Scene& scene, const TargetSource& source) {
    for (const Parameter& p : scene.parameters)
        if (p.name == source.parameter) return p.texture;
    throw InputError(source.file.string() + ": the scene has no parameter " + source.parameter);
}

/// Averages the texture down to `side`, where it is larger; 0: leaves it.
Image bring_to_size(Bitmap& bitmap, int side) {
    const Image texels = linear_image(bitmap);
    const int larger = std::max(bitmap.width, bitmap.height);
    if (side <= 0 || larger <= side) return texels;
    const auto scaled = [&](int size) {
        return std::max(1, static_cast<int>(std::lround(double(size) * side / larger)));
    };
    Image small = averaged(texels, scaled(bitmap.width), scaled(bitmap.height));
    replace_texels(bitmap, small);
    return small;
}

}  // namespace

TargetScene load_target_scene(const TargetSource& source, const ReproduceOptions& options) {
    LoadOptions load;
    load.width = options.width, load.height = options.height;
    LoadedScene loaded = load_scene(source.file, load);
    const TextureId texture = target_texture(loaded.scene, source);
    Image truth = bring_to_size(std::get<Bitmap>(loaded.scene[texture]), options.texture_side);
    TargetScene scene{source, make_renderer(std::move(loaded)), texture, std::move(truth), {}};
    scene.visited = visited_texels(scene, options.seed);
    return scene;
}

std::vector<char> visited_texels(const TargetScene& scene, std::uint32_t seed) {
    constexpr std::uint32_t kPasses = 16;
    const Theta truth{{{scene.texture, scene.truth}}};
    const Film& film = scene.traced().film;
    const Image ones = make_image(film.crop_width, film.crop_height, 3, 1.0f);
    return texel_evidence(scene.traced(), truth, ones, seed, kPasses)[0].visited;
}

Image render_target(const TargetScene& scene, const ReproduceOptions& options,
                    const Progress& progress) {
    const TextureTable textures{scene.scene().textures, {}};
    const TraceInput input{
        .scene = &scene.traced(), .textures = &textures, .key = {options.seed, Stream::kTarget}};
    return render(input, 0, options.target_samples, nullptr, progress);
}

Reservoirs paper_estimator(const TargetScene& scene, const ReproduceOptions& options) {
    Reservoirs pgris;
    pgris.image_samples = options.image_samples, pgris.image_window = options.image_window;
    pgris.adaptive_sampling = false;
    pgris.confidence_cap = scene.source.confidence_cap;
    return pgris;
}

MonteCarlo baseline_estimator(std::uint32_t samples) {
    MonteCarlo mc;
    mc.samples = samples;
    mc.adaptive_sampling = false;
    return mc;
}

MonteCarlo baseline_estimator(const ReproduceOptions& options) {
    MonteCarlo mc = baseline_estimator();
    mc.image_samples = options.image_samples, mc.image_window = options.image_window;
    return mc;
}

Options paper_options(const TargetScene& scene, const ReproduceOptions& options) {
    Options paper;
    paper.estimator = paper_estimator(scene, options);
    paper.loss = Loss::kRelMse;
    paper.parameterization = Parameterization::kTexels;
    paper.learning_rate = double{scene.source.learning_rate};
    paper.seed = options.seed;
    return paper;
}

Problem problem_of(const TargetScene& scene, Start start) {
    return {scene.renderer, {{scene.target, {}}}, {{scene.source.parameter, std::move(start)}}};
}

void step_for(Solver& solver, double seconds,
              const std::function<void(double spent, const Iteration&)>& after) {
    double spent = 0;
    while (spent < seconds) {
        const Iteration i = solver.step();
        spent += stage_seconds(i);
        if (after) after(spent, i);
    }
}

std::string title_of(const TargetScene& scene) {
    std::string parameter = scene.source.parameter;  // mat-tire.brdf_0.roughness.data
    if (const auto end = parameter.rfind(".data"); end != std::string::npos) parameter.resize(end);
    return scene.source.name + ": " + parameter.substr(parameter.rfind('.') + 1);
}

}  // namespace burnish
