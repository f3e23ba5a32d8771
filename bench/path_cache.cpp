// The stages of the path cache on one scene: nanoseconds of processor time on one core for each
// record or sample, beside what bounds them, as one line of JSON.
//
//   burnish_path_cache SCENE.xml PARAMETER... [--size W H] [--window 16] [--repeats 5] [-D
//   name=value]...
#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "core/median.h"
#include "core/parallel.h"
#include "gradient/path_cache/path_cache.h"

using namespace burnish;

namespace {

/// Processor time: other work on the machine does not count.
double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median_seconds(int repeats, const std::function<void()>& work) {
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) {
        const double start = cpu_seconds();
        work();
        seconds.push_back(cpu_seconds() - start);
    }
    return median(seconds);
}

/// Seconds to read memory once from end to end, one core.
double read_seconds(std::size_t bytes, int repeats) {
    const std::vector<std::uint64_t> memory(bytes / sizeof(std::uint64_t) + 1, 1);
    volatile std::uint64_t sink = 0;
    return median_seconds(repeats, [&] {
        std::uint64_t sum = 0;
        for (const std::uint64_t word : memory) sum += word;
        sink = sum;
    });
}

struct CommandLine {
    BenchScene scene;
    std::vector<std::string> more;
    std::uint32_t window = 16;
    int repeats = 5;
};

Theta half_everywhere(const TargetScene& scene, const CommandLine& line) {
    std::vector<std::string> names = line.more;
    names.insert(names.begin(), line.scene.parameter);
    Theta theta;
    for (const std::string& name : names) {
        const Image texels = scene.renderer.texture(name);
        theta.textures.push_back({find_texture(scene.scene(), name),
                                  make_image(texels.width, texels.height, texels.channels, 0.5f)});
    }
    return theta;
}

nlohmann::json measure(const CommandLine& line) {
    const TargetScene scene = load_target_scene(line.scene);
    const Theta theta = half_everywhere(scene, line);
    const ThreadLimit one(1);
    const Binding binding(scene.traced(), theta);
    const PathCacheInput input{binding, 1};
    PathCache options;
    options.window = line.window;
    PathCacheWorkspace workspace = make_workspace(options, binding);
    PathCacheState state;
    std::size_t samples = 0;
    for (const CacheTile& tile : workspace.tiles) samples += tile.pixels.size();
    const double trace = median_seconds(
        static_cast<int>(2 * line.window),
        [&, half = 0u]() mutable { trace_pass(input, half++ % 2, workspace, state); });
    HalfImages halves;
    const double shading =
        median_seconds(line.repeats, [&] { halves = shade(input, state, workspace); });
    const double gradient = median_seconds(line.repeats, [&] {
        accumulate(input, state, {&halves.images[0], &halves.images[1]}, workspace);
    });
    const PathCacheSize kept = size_of(state, workspace);
    const auto each = [](double seconds, std::size_t count) {
        return 1e9 * seconds / static_cast<double>(count);
    };
    return {
        {"scene", line.scene.file},
        {"width", line.scene.size[0]},
        {"height", line.scene.size[1]},
        {"window", line.window},
        {"samples_per_pass", samples},
        {"records", kept.records},
        {"bytes_per_record", static_cast<double>(kept.bytes) / static_cast<double>(kept.records)},
        {"trace_ns_per_sample", each(trace, samples)},
        {"shade_ns_per_record", each(shading, kept.records)},
        {"gradient_ns_per_record", each(gradient, kept.records)},
        {"memory_ns_per_record", each(read_seconds(kept.bytes, line.repeats), kept.records)}};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"The stages of the path cache on one scene"};
    CommandLine line;
    add_scene_options(app, line.scene);
    app.add_option("more", line.more, "names of further parameters");
    app.add_option("--window", line.window);
    app.add_option("--repeats", line.repeats);
    CLI11_PARSE(app, argc, argv)
    std::cout << measure(line).dump() << "\n";
} catch (const Error& e) {
    std::cerr << "burnish_path_cache: " << e.what() << "\n";
    return 1;
}
