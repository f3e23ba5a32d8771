#include "bench_scene.h"

#include <sys/resource.h>

#include "burnish/error.h"

namespace burnish {

namespace {

template <class T>
struct Named {
    const char* name;
    T value;
};

template <class T, std::size_t N>
T find(const Named<T> (&choices)[N], const std::string& name) {
    std::string all;
    for (const Named<T>& c : choices) {
        if (name == c.name) return c.value;
        all += (all.empty() ? "" : ", ") + std::string(c.name);
    }
    throw InputError("found '" + name + "', expected one of " + all);
}

Reservoirs reservoirs(bool positivization, bool reuse) {
    Reservoirs o;
    o.positivization = positivization, o.reuse = reuse;
    return o;
}

}  // namespace

void add_scene_options(CLI::App& app, BenchScene& scene) {
    app.add_option("scene", scene.file)->required();
    app.add_option("parameter", scene.parameter, "full name")->required();
    app.add_option("--size", scene.size)->expected(2);
    app.add_option("-D", scene.definitions)->allow_extra_args(false);
}

TargetScene load_target_scene(const BenchScene& scene) {
    SceneSettings settings;
    settings.width = scene.size[0], settings.height = scene.size[1];
    for (const std::string& d : scene.definitions)
        settings.definitions[d.substr(0, d.find('='))] = d.substr(d.find('=') + 1);
    // Not within the braces: where it throws there, GCC 12 destroys what stands before it twice.
    Renderer renderer = Renderer::load(scene.file, settings);
    TargetScene target{{scene.file, scene.file, scene.parameter}, std::move(renderer), {}, {}, {}};
    target.texture = find_texture(target.scene(), scene.parameter);
    target.truth = target.renderer.texture(scene.parameter);
    return target;
}

Estimator estimator_of(const std::string& text) {
    static const Named<Estimator> kEstimators[] = {{"mc", MonteCarlo{}},
                                                   {"ris", reservoirs(false, false)},
                                                   {"pris", reservoirs(true, false)},
                                                   {"gris", reservoirs(false, true)},
                                                   {"pgris", reservoirs(true, true)},
                                                   {"path-cache", PathCache{}}};
    static constexpr Named<Shift> kShifts[] = {{"replay", Shift::kReplay},
                                               {"identity", Shift::kIdentity}};
    const auto colon = text.find(':');
    Estimator estimator = find(kEstimators, text.substr(0, colon));
    if (colon == std::string::npos) return estimator;
    const Shift shift = find(kShifts, text.substr(colon + 1));
    auto* o = std::get_if<Reservoirs>(&estimator);
    if (o == nullptr || !o->reuse) throw InputError("'" + text + "' has no history to shift");
    o->shift = shift;
    return estimator;
}

Parameterization parameterization_of(const std::string& text) {
    static constexpr Named<Parameterization> kNames[] = {{"texels", Parameterization::kTexels},
                                                         {"pyramid", Parameterization::kPyramid}};
    return find(kNames, text);
}

double peak_memory_gb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 0x1p20;  // kilobytes
}

}  // namespace burnish
