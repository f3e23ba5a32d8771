#include "bench_scene.h"

#include "cli/option_text.h"
#include "cli/run_result.h"
#include "burnish/error.h"

namespace burnish {

void add_scene_options(CLI::App& app, BenchScene& scene) {
    app.add_option("scene", scene.file)->required();
    app.add_option("parameter", scene.parameter, "full name")->required();
    app.add_option("--size", scene.size)->expected(2);
    app.add_option("-D", scene.definitions)->allow_extra_args(false);
}

std::unique_ptr<Subject> load_subject(const BenchScene& scene) {
    auto subject = std::make_unique<Subject>();
    subject->source = {scene.file, scene.file, scene.parameter};
    LoadOptions load;
    load.width = scene.size[0], load.height = scene.size[1];
    for (const std::string& d : scene.definitions)
        load.definitions[d.substr(0, d.find('='))] = d.substr(d.find('=') + 1);
    subject->loaded = load_scene(scene.file, load);
    for (const Parameter& p : subject->loaded.scene.parameters)
        if (p.name == scene.parameter) subject->texture = p.texture;
    if (!subject->texture)
        throw InputError(scene.file + ": the scene has no parameter " + scene.parameter);
    subject->truth = linear_image(std::get<Bitmap>(subject->loaded.scene[subject->texture]));
    subject->traced = std::make_unique<TracedScene>(prepare(subject->loaded.scene));
    subject->problem.scene = subject->traced.get();
    return subject;
}

GradientOptions variant_of(const std::string& text, GradientOptions options) {
    const auto choose = [&](const std::string& name, const auto& choices, auto& value) {
        for (const auto& c : choices)
            if (name == c.name) return void(value = c.value);
        throw InputError("--variants: found '" + name + "', expected one of " +
                         choice_list(choices, ", "));
    };
    const auto colon = text.find(':');
    choose(text.substr(0, colon), kEstimatorNames, options.estimator);
    if (colon != std::string::npos) choose(text.substr(colon + 1), kShiftNames, options.shift);
    return options;
}

double peak_memory_gb() { return peak_memory() / 0x1p30; }

}  // namespace burnish
