// A target scene that the experiments work on within a second.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "experiments/experiments.h"
#include "scenes/procedural.h"
#include "temporary_folder.h"

namespace burnish::test {

inline ReproduceOptions small_options() {
    ReproduceOptions options;
    options.width = options.height = 24;
    options.texture_side = 32;
    options.image_samples = 4, options.image_window = 0;
    options.target_samples = 16;
    options.reference_samples = 512;  // whose noise hides no error
    options.iterations = 5;
    options.sweep_seconds = 0.2;
    options.budget = {8, 8, 0.05, 0.1};
    options.runs = 3;
    return options;
}

inline TargetScene small_target_scene(const ReproduceOptions& options) {
    const TemporaryFolder folder;
    write_procedural_scene("goblet", folder.path, {.texture_size = 64});
    TargetScene scene = load_target_scene(
        {"goblet", folder.path / "scene.xml", "mat-goblet.brdf_0.roughness.data", 0.02f, 16},
        options);
    scene.target = render_target(scene, options);
    return scene;
}

/// Its study with a reference that is noise for the most part, as it says.
inline std::shared_ptr<const Study> study_of_noise(const TargetScene& scene,
                                                   const ReproduceOptions& options) {
    auto study =
        std::make_shared<Study>(*make_study(scene, options, {[](const std::string&) {}, {}}));
    study->reference.squared_error = 1e30, study->reference.nmse = INFINITY;
    return study;
}

}  // namespace burnish::test
