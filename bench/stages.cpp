// Seconds of the stages of one scene, and of its rays alone, as one line of JSON.
//
//   burnish_stages SCENE.xml PARAMETER [--size W H] [--spp 32] [--repeats 5] [-D name=value]...
//   [--variants V...]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "experiments/trajectory.h"

using namespace burnish;

namespace {

double seconds_of(const std::function<void()>& work) {
    const Stopwatch watch;
    work();
    return watch.total();
}

/// Without the first call, which prepares work memory and meets caches that other work used.
nlohmann::json repeated(int repeats, const std::function<void()>& work) {
    work();
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) seconds.push_back(seconds_of(work));
    const auto [min, max] = std::minmax_element(seconds.begin(), seconds.end());
    return {{"median", median(seconds)}, {"min", *min}, {"max", *max}};
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
    scene.geometry->accel.recorder = scene.geometry->emitting.recorder = &recorder;
    {
        const ThreadLimit one(1);
        render(input, 0, kRecorded);
    }
    scene.geometry->accel.recorder = scene.geometry->emitting.recorder = nullptr;
    RaysAlone result;
    for (const RecordedRays& packet : recorder)
        for (const auto valid : packet.rays.valid) result.rays += valid != 0;
    trace_alone(recorder);  // the first finds cold caches
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) seconds.push_back(trace_alone(recorder));
    const double scale = static_cast<double>(passes) / kRecorded;
    result.seconds = median(seconds) * scale;
    result.rays = static_cast<std::size_t>(static_cast<double>(result.rays) * scale);
    return result;
}

/// Seconds of each stage, the median over the later iterations of a short run.
nlohmann::json iterations(const TargetScene& scene, const Options& options, int count) {
    Solver solver(problem_of(scene), options);
    std::vector<double> image, derivative, step, whole;
    for (int i = 0; i < count; ++i) {
        Iteration r;
        const double seconds = seconds_of([&] { r = solver.step(); });
        if (i == 0) continue;  // the first gathers the background
        image.push_back(r.image_seconds), derivative.push_back(r.derivative_seconds),
            step.push_back(r.step_seconds);
        whole.push_back(seconds);
    }
    return {{"image", median(image)},
            {"derivative", median(derivative)},
            {"step", median(step)},
            {"whole", median(whole)}};
}

nlohmann::json derivatives(const TargetScene& scene, int repeats) {
    const Image& t = scene.truth;
    const Theta half{{{scene.texture, make_image(t.width, t.height, t.channels, 0.5f)}}};
    const Image adjoint = make_image(scene.renderer.width(), scene.renderer.height(), 3, 1e-4f);
    ScriptedEstimator mc(baseline_estimator(), 0);
    std::uint32_t iteration = 0;
    return repeated(repeats,
                    [&] { estimate_next(scene.traced(), half, adjoint, iteration++, mc); });
}

struct CommandLine {
    BenchScene scene;
    std::uint32_t spp = 32;
    int repeats = 5;
    std::vector<std::string> variants{"mc", "pgris:replay", "pgris:identity"};
};

/// Plain texels, as in Mitsuba.
Options options_of(const CommandLine& line, const std::string& variant) {
    Options options;
    options.estimator = estimator_of(variant);
    options.parameterization = Parameterization::kTexels;
    options.loss = Loss::kRelMse;
    if (auto* o = std::get_if<MonteCarlo>(&options.estimator)) o->image_samples = line.spp;
    if (auto* o = std::get_if<Reservoirs>(&options.estimator)) o->image_samples = line.spp;
    return options;
}

nlohmann::json measure(const CommandLine& line) {
    TargetScene scene = load_target_scene(line.scene);
    nlohmann::json out{{"scene", line.scene.file},
                       {"width", line.scene.size[0]},
                       {"height", line.scene.size[1]},
                       {"spp", line.spp}};
    const TextureTable textures{scene.scene().textures, {}};
    TraceInput input{.scene = &scene.traced(), .textures = &textures, .key = {1, Stream::kImage}};
    out["image_s"] = repeated(line.repeats, [&] { scene.target = render(input, 0, line.spp); });
    out["derivative_s"] = derivatives(scene, line.repeats);
    for (const std::string& name : line.variants)
        out["iteration_s"][name] = iterations(scene, options_of(line, name), 2 * line.repeats + 1);
    out["peak_memory_gb"] = peak_memory_gb();  // before the recorded rays take theirs
    TracedScene recorded = prepare(scene.scene());
    input.scene = &recorded;
    const RaysAlone rays = rays_alone(recorded, input, line.spp, line.repeats);
    out["rays_alone_s"] = rays.seconds;
    out["rays"] = rays.rays;
    out["image_to_rays"] = out["image_s"]["median"].get<double>() / rays.seconds;
    return out;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Seconds of the stages of one scene"};
    CommandLine line;
    add_scene_options(app, line.scene);
    app.add_option("--spp", line.spp);
    app.add_option("--repeats", line.repeats);
    app.add_option("--variants", line.variants, "NAME[:SHIFT]...");
    CLI11_PARSE(app, argc, argv)
    std::cout << measure(line).dump() << std::endl;
} catch (const Error& e) {
    std::cerr << "burnish_stages: " << e.what() << "\n";
    return 1;
}
