// Seconds of the stages of one scene, and of its rays alone, as one line of JSON.
//
//   burnish_stages SCENE.xml PARAMETER [--size W H] [--spp 32] [--repeats 5] [-D name=value]...
//   [--variants V...]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "bench_scene.h"

using namespace burnish;

namespace {

double seconds_of(const std::function<void()>& work) {
    const Stopwatch watch;
    work();
    return watch.total();
}

nlohmann::json repeated(int repeats, const std::function<void()>& work) {
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) seconds.push_back(seconds_of(work));
    const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
    return {{"median", median(seconds)}, {"min", *least}, {"max", *most}};
}

/// The same packets through Embree with nothing else, on all cores.
double trace_alone(const RayRecorder& rays) {
    std::vector<std::int32_t> sink((rays.size() + 1023) / 1024);
    const double seconds = seconds_of([&] {
        parallel_chunks(rays.size(), 1024, [&](std::size_t begin, std::size_t end) {
            std::int32_t sum = 0;
            for (std::size_t i = begin; i < end; ++i)
                sum += rays[i].occlusion
                           ? rays[i].accel->occluded(rays[i].rays, rays[i].coherence)[0]
                           : rays[i].accel->intersect(rays[i].rays, rays[i].coherence).shape[0];
            sink[begin / 1024] = sum;
        });
    });
    return seconds;
}

struct RaysAlone {
    double seconds = 0;
    std::size_t rays = 0;
};

/// Rays of `recorded` passes, timed alone and scaled to `passes`.
RaysAlone rays_alone(TracedScene& scene, const TraceInput& input, std::uint32_t passes,
                     int repeats) {
    constexpr std::uint32_t kRecorded = 16;
    RayRecorder recorder;
    scene.accel.recorder = scene.emitting.recorder = &recorder;
    {
        const ThreadLimit one(1);
        render(input, 0, 0, kRecorded);
    }
    scene.accel.recorder = scene.emitting.recorder = nullptr;
    RaysAlone result;
    for (const RecordedRays& packet : recorder)
        for (const auto valid : packet.rays.valid) result.rays += valid != 0;
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) seconds.push_back(trace_alone(recorder));
    const double scale = static_cast<double>(passes) / kRecorded;
    result.seconds = median(seconds) * scale;
    result.rays = static_cast<std::size_t>(static_cast<double>(result.rays) * scale);
    return result;
}

/// Milliseconds of each iteration stage, averaged over the later iterations of a short descent.
nlohmann::json iterations(const TracedScene& scene, const Problem& problem, TextureId texture,
                          SolveOptions options, int count) {
    const Image initial = linear_image(std::get<Bitmap>((*scene.scene)[texture]));
    Image half = initial;
    std::fill(half.values.begin(), half.values.end(), 0.5f);
    SolveState state = start(options, {{texture, half, 0.01f}});
    std::vector<double> image, derivative, step, whole;
    for (int i = 0; i < count; ++i) {
        IterationReport r;
        const double seconds = seconds_of([&] { r = iterate(problem, options, state); });
        if (i == 0) continue;  // the first gathers the static image
        image.push_back(r.image_seconds), derivative.push_back(r.derivative_seconds),
            step.push_back(r.step_seconds);
        whole.push_back(seconds);
    }
    return {{"image", median(image)},
            {"derivative", median(derivative)},
            {"step", median(step)},
            {"whole", median(whole)}};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Seconds of the stages of one scene"};
    BenchScene bench;
    std::uint32_t spp = 32;
    int repeats = 5;
    std::vector<std::string> variants{"mc", "pgris:replay", "pgris:identity"};
    add_scene_options(app, bench);
    app.add_option("--spp", spp);
    app.add_option("--repeats", repeats);
    app.add_option("--variants", variants, "ESTIMATOR[:SHIFT]...");
    CLI11_PARSE(app, argc, argv)

    const auto subject = load_subject(bench);
    const Scene& scene = subject->loaded.scene;
    TracedScene& traced = *subject->traced;
    const TextureId texture = subject->texture;

    nlohmann::json out{
        {"scene", bench.file}, {"width", bench.size[0]}, {"height", bench.size[1]}, {"spp", spp}};
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {1, Stream::kImage}, spp, SurfaceChoice::kAll, {}};
    Image image;
    out["image_s"] = repeated(repeats, [&] { image = render(input, 0, 0, spp); });
    Theta theta;
    Image half = linear_image(std::get<Bitmap>(scene[texture]));
    std::fill(half.values.begin(), half.values.end(), 0.5f);
    theta.textures.push_back({texture, half});
    const Image adjoint = make_image(scene.film.crop_width, scene.film.crop_height, 3, 1e-4f);
    GradientOptions gradient;
    gradient.estimator = Estimator::kMc;
    std::uint32_t iteration = 0;
    out["derivative_s"] = repeated(
        repeats, [&] { estimate_gradient(traced, theta, adjoint, iteration++, gradient, {}); });

    const Problem problem{&traced, image, {}};
    SolveOptions options;
    options.samples_per_pixel = spp;
    for (const std::string& name : variants) {
        options.gradient = variant_of(name, {});
        out["iteration_s"][name] = iterations(traced, problem, texture, options, 2 * repeats + 1);
    }
    out["peak_memory_gb"] = peak_memory_gb();  // before the recorded rays take theirs
    const RaysAlone rays = rays_alone(traced, input, spp, repeats);
    out["rays_alone_s"] = rays.seconds;
    out["rays"] = rays.rays;
    out["image_to_rays"] = out["image_s"]["median"].get<double>() / rays.seconds;
    std::cout << out.dump() << std::endl;
} catch (const InputError& e) {
    std::cerr << "burnish_stages: " << e.what() << "\n";
    return 1;
}
