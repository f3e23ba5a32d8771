// A subject that the experiments work on within a second.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

#include "experiments/subject.h"
#include "scenes/procedural.h"

namespace burnish::test {

inline ReproduceOptions small_options() {
    ReproduceOptions options;
    options.width = options.height = 24;
    options.texture_side = 32;
    options.primal_samples = 4;
    options.target_samples = 16;
    options.reference_samples = 64;
    options.iterations = 5;
    options.sweep_seconds = 0.2;
    return options;
}

inline std::unique_ptr<Subject> small_subject(const ReproduceOptions& options) {
    // Of this process alone: tests run beside each other.
    const auto folder = std::filesystem::temp_directory_path() /
                        ("burnish_reproduce_test_" + std::to_string(getpid()));
    write_procedural_scene("goblet", folder, {.texture_size = 64});
    auto subject = prepare_subject(
        {"goblet", folder / "scene.xml", "mat-goblet.brdf_0.roughness.data", 0.02f, 16}, options);
    std::filesystem::remove_all(folder);
    return subject;
}

}  // namespace burnish::test
