// What the search for the start finds: the texture error over the texels that light reaches, of the
// search and of 0.5 everywhere, and the seconds that it takes. One line of JSON for each seed.
//
//   burnish_start_search SCENE.xml PARAMETER [--size W H] [--runs 3] [--target-spp 256]
//                        [-D name=value]...
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "core/stopwatch.h"
#include "optimize/start_search.h"
#include "texture/coverage.h"

using namespace burnish;

int main(int argc, char** argv) {
    BenchScene where;
    std::uint32_t runs = 3, target_samples = 256;
    std::string file;
    CLI::App app;
    add_scene_options(app, where);
    app.add_option("--runs", runs);
    app.add_option("--target-spp", target_samples);
    app.add_option("--target", file);
    CLI11_PARSE(app, argc, argv);
    try {
        TargetScene scene = load_target_scene(where);
        ReproduceOptions options;
        options.target_samples = target_samples;
        std::error_code none;
        if (!file.empty() && std::filesystem::exists(file, none)) {
            scene.target = read_image(file);
        } else {
            scene.target = render_target(scene, options);
            if (!file.empty()) write_image(file, scene.target);
        }
        const Theta theta{{{scene.texture, scene.truth}}};
        const auto visited = visited_texels(scene.traced(), theta, 1, 16).front();
        const auto error = [&](const Image& texels) {
            return texture_error(texels, scene.truth, visited);
        };
        Image half = scene.truth;
        std::fill(half.values.begin(), half.values.end(), 0.5f);
        const SearchUnknown unknown{scene.texture, texture_charts(scene.scene(), scene.texture)};
        const Image mask;
        const SearchView view{scene.traced(), scene.target, mask};
        for (std::uint32_t seed = 0; seed < runs; ++seed) {
            const Stopwatch watch;
            const FoundStarts found = search_starts({&view, 1}, {&unknown, 1}, seed);
            nlohmann::ordered_json line{{"scene", where.file},
                                        {"seed", seed},
                                        {"seconds", watch.total()},
                                        {"error", error(found.textures[0])},
                                        {"error_of_half", error(half)}};
            std::cout << line.dump() << std::endl;
            if (const char* out = getenv("S_OUT")) write_image(out, found.textures[0]);
        }
    } catch (const Error& e) {
        std::cerr << e.what() << "\n";
        return 1;
    }
}
