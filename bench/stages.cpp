// Seconds of the stages of one scene, and of its rays alone, as one line of JSON.
//
//   burnish_stages SCENE.xml PARAMETER [--size W H] [--spp 32] [--repeats 5] [-D name=value]...
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "burnish/core/parallel.h"
#include "burnish/inverse/solve.h"
#include "burnish/mitsuba/load.h"

using namespace burnish;

namespace {

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

nlohmann::json repeated(int repeats, const std::function<void()>& work) {
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) seconds.push_back(seconds_of(work));
    std::sort(seconds.begin(), seconds.end());
    return {
        {"median", seconds[seconds.size() / 2]}, {"min", seconds.front()}, {"max", seconds.back()}};
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
    std::sort(seconds.begin(), seconds.end());
    const double scale = static_cast<double>(passes) / kRecorded;
    result.seconds = seconds[seconds.size() / 2] * scale;
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
    const auto median = [](std::vector<double> v) {
        std::sort(v.begin(), v.end());
        return v[v.size() / 2];
    };
    return {{"image", median(image)},
            {"derivative", median(derivative)},
            {"step", median(step)},
            {"whole", median(whole)}};
}

double peak_memory_gb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Seconds of the stages of one scene"};
    std::string file, parameter;
    std::vector<int> size{350, 350};
    std::vector<std::string> definitions;
    std::uint32_t spp = 32;
    int repeats = 5;
    app.add_option("scene", file)->required();
    app.add_option("parameter", parameter, "full name")->required();
    app.add_option("--size", size)->expected(2);
    app.add_option("--spp", spp);
    app.add_option("--repeats", repeats);
    app.add_option("-D", definitions);
    CLI11_PARSE(app, argc, argv)

    LoadOptions load;
    load.width = size[0], load.height = size[1];
    for (const auto& d : definitions)
        load.definitions[d.substr(0, d.find('='))] = d.substr(d.find('=') + 1);
    LoadedScene loaded = load_scene(file, load);
    const Scene& scene = loaded.scene;
    TracedScene traced = prepare(scene);
    TextureId texture;
    for (const Parameter& p : scene.parameters)
        if (p.name == parameter) texture = p.texture;
    if (!texture) {
        std::cerr << "burnish_stages: the scene has no parameter \"" << parameter << "\"\n";
        return 1;
    }

    nlohmann::json out{{"scene", file}, {"width", size[0]}, {"height", size[1]}, {"spp", spp}};
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
    for (const auto& [name, estimator, shift] :
         {std::tuple{"mc", Estimator::kMc, Shift::kReplay},
          {"pgris_replay", Estimator::kPgris, Shift::kReplay},
          {"pgris_identity", Estimator::kPgris, Shift::kIdentity}}) {
        options.gradient.estimator = estimator;
        options.gradient.shift = shift;
        out["iteration_s"][name] = iterations(traced, problem, texture, options, 2 * repeats + 1);
    }
    out["peak_memory_gb"] = peak_memory_gb();  // before the recorded rays take theirs
    const RaysAlone rays = rays_alone(traced, input, spp, repeats);
    out["rays_alone_s"] = rays.seconds;
    out["rays"] = rays.rays;
    out["image_to_rays"] = out["image_s"]["median"].get<double>() / rays.seconds;
    std::cout << out.dump() << std::endl;
}
