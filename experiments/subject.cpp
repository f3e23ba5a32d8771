#include "experiments/subject.h"

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

TextureId find_texture(const Scene& scene, const SubjectSource& source) {
    for (const Parameter& p : scene.parameters)
        if (p.name == source.parameter) return p.texture;
    throw InputError(source.file.string() + ": the scene has no parameter " + source.parameter);
}

}  // namespace

std::unique_ptr<Subject> prepare_subject(const SubjectSource& source,
                                         const ReproduceOptions& options,
                                         const Progress& progress) {
    auto subject = std::make_unique<Subject>();
    subject->source = source;
    LoadOptions load;
    load.width = options.width, load.height = options.height;
    subject->loaded = load_scene(source.file, load);
    Scene& scene = subject->loaded.scene;
    subject->texture = find_texture(scene, source);
    auto& bitmap = std::get<Bitmap>(scene[subject->texture]);
    subject->truth = linear_image(bitmap);
    const int side = std::max(bitmap.width, bitmap.height);
    if (options.texture_side > 0 && side > options.texture_side) {
        const auto scaled = [&](int size) {
            return std::max(
                1, static_cast<int>(std::lround(double(size) * options.texture_side / side)));
        };
        subject->truth = averaged(subject->truth, scaled(bitmap.width), scaled(bitmap.height));
        replace_texels(bitmap, subject->truth);
    }
    subject->traced = std::make_unique<TracedScene>(prepare(scene));
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{
        subject->traced.get(),  &textures,           {options.seed, Stream::kTarget},
        options.target_samples, SurfaceChoice::kAll, {}};
    subject->problem = {
        subject->traced.get(), render(input, 0, 0, options.target_samples, nullptr, progress), {}};
    Theta truth;
    truth.textures.push_back({subject->texture, subject->truth});
    subject->reached = visited_texels(*subject->traced, truth, options.seed, 16)[0];
    return subject;
}

SolveOptions paper_options(const Subject& subject, const ReproduceOptions& options) {
    SolveOptions solve;
    solve.samples_per_pixel = options.primal_samples;
    solve.gradient.confidence_cap = subject.source.confidence_cap;
    solve.seed = solve.gradient.seed = options.seed;
    solve.optimizer.learning_rate = subject.source.learning_rate;
    return solve;
}

SolveState start_gray(const Subject& subject, const SolveOptions& options) {
    const Image& t = subject.truth;
    return start(options,
                 {initial_texture(*subject.traced->scene, options.parameterization.kind,
                                  subject.texture, make_image(t.width, t.height, t.channels, 0.5f),
                                  options.optimizer.learning_rate)});
}

void descend_for(const Subject& subject, const SolveOptions& options, double seconds,
                 SolveState& state,
                 const std::function<void(double spent, const IterationReport&)>& after) {
    double spent = 0;
    while (spent < seconds) {
        const IterationReport r = iterate(subject.problem, options, state);
        spent += r.image_seconds + r.derivative_seconds + r.step_seconds;
        if (after) after(spent, r);
    }
}

std::string title_of(const Subject& subject) {
    std::string parameter = subject.source.parameter;  // mat-tire.brdf_0.roughness.data
    if (const auto end = parameter.rfind(".data"); end != std::string::npos) parameter.resize(end);
    return subject.source.name + ": " + parameter.substr(parameter.rfind('.') + 1);
}

}  // namespace burnish
