// The stages of a pool on one scene: nanoseconds of processor time on one core for each record or
// sample, beside what bounds them, as one line of JSON.
//
//   burnish_pool SCENE.xml PARAMETER... [--size W H] [--window 16] [--repeats 5] [-D name=value]...
#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "core/median.h"
#include "core/parallel.h"
#include "gradient/path_cache/path_cache.h"
#include "bench_scene.h"

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

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"The stages of a pool on one scene"};
    BenchScene bench;
    std::vector<std::string> more;
    std::size_t window = 16;
    int repeats = 5;
    add_scene_options(app, bench);
    app.add_option("more", more, "full names of further parameters");
    app.add_option("--window", window);
    app.add_option("--repeats", repeats);
    CLI11_PARSE(app, argc, argv)

    const auto subject = load_subject(bench);
    const Scene& scene = subject->loaded.scene;
    const TracedScene& traced = *subject->traced;
    more.insert(more.begin(), bench.parameter);
    Theta theta;
    for (const std::string& name : more)
        for (const Parameter& p : scene.parameters)
            if (p.name == name) {
                Image half = linear_image(std::get<Bitmap>(scene[p.texture]));
                std::fill(half.values.begin(), half.values.end(), 0.5f);
                theta.textures.push_back({p.texture, std::move(half)});
            }
    if (theta.textures.size() != more.size())
        throw InputError(bench.file + ": the scene does not have all of these parameters");

    const ThreadLimit one(1);
    const PoolInput input{&traced, &theta, 1};
    Pool pool = make_pool(scene, theta);
    std::size_t samples = 0;
    for (const PoolTile& tile : pool.tiles) samples += tile.pixels.size();
    const double trace = median_seconds(static_cast<int>(2 * window), [&, bank = 0u]() mutable {
        trace_pass(input, pool, bank++ % 2);
    });
    const PoolSize kept = pool_size(pool);
    std::array<Image, 2> images;
    const double shade = median_seconds(repeats, [&] { images = pool_images(input, pool).images; });
    const double gradient = median_seconds(repeats, [&] { pool_gradient(input, pool, images); });
    const auto each = [](double seconds, std::size_t count) {
        return 1e9 * seconds / static_cast<double>(count);
    };
    const nlohmann::json out{
        {"scene", bench.file},
        {"width", bench.size[0]},
        {"height", bench.size[1]},
        {"window", window},
        {"samples_per_pass", samples},
        {"records", kept.records},
        {"bytes_per_record", static_cast<double>(kept.bytes) / static_cast<double>(kept.records)},
        {"trace_ns_per_sample", each(trace, samples)},
        {"shade_ns_per_record", each(shade, kept.records)},
        {"gradient_ns_per_record", each(gradient, kept.records)},
        {"memory_ns_per_record", each(read_seconds(kept.bytes, repeats), kept.records)}};
    std::cout << out.dump() << "\n";
} catch (const InputError& e) {
    std::cerr << "burnish_pool: " << e.what() << "\n";
    return 1;
}
