// What the search for the start finds: the texture error over the texels that the fitted pictures
// see, of the search, of 0.5 everywhere and of what the pictures can resolve, and the seconds that
// the search takes. One line of JSON for each number of views and seed.
//
//   burnish_start_search CAPTURE.json PARAMETER [--views 1 2 4 8] [--runs 3] [--seed 0]
//                        [--effort 1] [--judge FILE]...
//   burnish_start_search SCENE.xml PARAMETER [--size W H] [--runs 3] [--seed 0]
//                        [--effort 1] [--target-spp 256] [-D name=value]... [--judge FILE]...
//
// The pictures of a scene file are rendered from its own textures. Of a capture the error counts
// the texels that all of its fitted views see, also where fewer are searched.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "burnish/image.h"
#include "captures/pictures.h"
#include "core/stopwatch.h"
#include "footprints.h"
#include "optimize/search_guide.h"
#include "optimize/start_search.h"
#include "optimize/views.h"
#include "texture/coverage.h"

using namespace burnish;

namespace {

/// A scene, or a capture without the views that are held out.
struct Pictures {
    Renderer renderer;
    std::vector<Renderer> views;
    std::vector<Image> images;  ///< parallel to views
};

Pictures read_pictures(const std::string& file) {
    const Capture capture = read_capture(file);
    Problem problem{Renderer::load(capture.scene, {.definitions = capture.definitions}), {}, {}};
    for (const CapturedView& v : capture.views) {
        if (v.view.held_out) continue;
        problem.views.push_back(v.view);
        problem.views.back().image =
            read_picture(v, read_mask(v).weights, 1, "the target of " + v.view.name).image;
    }
    Pictures p{problem.renderer, make_views(problem), {}};
    for (View& v : problem.views) p.images.push_back(std::move(v.image));
    return p;
}

Pictures render_pictures(const BenchScene& where, std::uint32_t samples) {
    const TargetScene scene = load_target_scene(where);
    return {scene.renderer, {scene.renderer}, {scene.renderer.render(samples)}};
}

/// Texels that light reaches on the way to any view.
std::vector<char> visited_texels(const Pictures& p, const Theta& truth) {
    constexpr std::uint32_t kPasses = 16;
    std::vector<TexelEvidence> evidence;
    for (std::uint32_t v = 0; v < p.views.size(); ++v) {
        const Image ones = make_image(p.images[v].width, p.images[v].height, 3, 1.0f);
        add(texel_evidence(p.views[v].data().traced, truth, ones, v + 1, kPasses), evidence);
    }
    return evidence.front().visited;
}

/// Of `count` of the views, spread evenly.
std::vector<SearchView> some_views(const Pictures& p, std::size_t count) {
    static const Image no_mask;
    std::vector<SearchView> some;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t v = i * p.views.size() / count;
        some.push_back({p.views[v].data().traced, p.images[v], no_mask});
    }
    return some;
}

struct Searches {
    std::vector<std::size_t> counts;  ///< of views; none: as many as a run searches
    std::uint32_t runs = 3, first_seed = 0;
    double effort = 1;
};

void measure(const Pictures& p, const std::string& parameter, Searches searches,
             const std::vector<std::string>& judged) {
    const Scene& scene = p.renderer.data().scene();
    const TextureId texture = find_texture(scene, parameter);
    const Image truth = p.renderer.texture(parameter);
    const std::vector<char> visited = visited_texels(p, {{{texture, truth}}});
    const auto error = [&](const Image& texels) { return texture_error(texels, truth, visited); };
    Image half = truth;
    std::fill(half.values.begin(), half.values.end(), 0.5f);
    const double resolved = error(over_footprints(p.views, texture, truth));
    for (const std::string& file : judged)
        std::cout << nlohmann::ordered_json{{"file", file}, {"error", error(read_image(file))}}
                  << std::endl;
    const ChartMap charts = texture_charts(scene, texture);
    const SearchUnknown unknown{texture, charts, guides_of(scene, texture, {&texture, 1})};
    if (searches.counts.empty()) searches.counts = {std::min(p.views.size(), kMaxSearchViews)};
    for (const std::size_t count : searches.counts)
        for (std::uint32_t k = 0; k < searches.runs; ++k) {
            const std::uint32_t seed = searches.first_seed + k;
            const auto views = some_views(p, std::min(count, p.views.size()));
            const Stopwatch watch;
            const FoundStarts found = search_starts(views, {&unknown, 1}, seed, searches.effort);
            nlohmann::ordered_json line{
                {"views", views.size()},        {"seed", seed},
                {"seconds", watch.total()},     {"error", error(found.textures[0])},
                {"error_of_half", error(half)}, {"error_resolved", resolved}};
            std::cout << line.dump() << std::endl;
        }
}

}  // namespace

int main(int argc, char** argv) {
    BenchScene where;
    Searches searches;
    std::uint32_t target_samples = 256;
    CLI::App app;
    add_scene_options(app, where);
    app.add_option("--runs", searches.runs);
    app.add_option("--seed", searches.first_seed, "of the first run; of others the next ones");
    app.add_option("--effort", searches.effort,
                   "of the search: T / 60, from 1 to 4, in a run of T seconds");
    app.add_option("--target-spp", target_samples);
    std::vector<std::string> judged;
    app.add_option("--judge", judged, "textures whose errors to tell, too");
    app.add_option("--views", searches.counts, "of a capture; else as many as a run searches");
    CLI11_PARSE(app, argc, argv);
    try {
        measure(is_capture(where.file) ? read_pictures(where.file)
                                       : render_pictures(where, target_samples),
                where.parameter, searches, judged);
    } catch (const Error& e) {
        std::cerr << e.what() << "\n";
        return 1;
    }
}
