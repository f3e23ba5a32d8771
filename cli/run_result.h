// All that a run of `burnish optimize` found out: what the summary and the report are made of.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/descent.h"
#include "cli/optimize_options.h"
#include "optimize/memory.h"

namespace burnish {

/// A recovered texture.
struct TextureSubject {
    std::string name;  ///< of the parameter
    std::string file;  ///< of the results, without extension
    TextureId texture;
    bool raw = false;  ///< how its PNG is encoded
    double learning_rate = 0;
    Image initial;
    std::optional<Image> truth;  ///< where the target was rendered from it
    std::vector<char> reached;   ///< texels that light paths meet; with truth only
};

/// A descent with its judgement.
struct JudgedDescent {
    Estimator estimator = Estimator::kPgris;
    Descent descent;
    Evaluation evaluation;               ///< with fresh samples
    std::vector<double> texture_errors;  ///< per subject; empty without truth
};

struct RunResult {
    const Scene* scene = nullptr;
    OptimizeOptions options;
    std::vector<std::string> warnings;  ///< of the loader
    MemoryPlan memory;                  ///< of the descent that takes more
    std::vector<TextureSubject> subjects;
    Image target;
    Evaluation initial;
    /// Of the true textures, where the target was rendered from them: the noise of judging.
    std::optional<double> noise_floor;
    std::vector<double> initial_errors;  ///< per subject; empty without truth
    JudgedDescent result;
    std::optional<JudgedDescent> compared;
    std::vector<std::pair<std::string, double>> phases;  ///< name, seconds
};

/// The machine's memory, bytes.
double physical_memory();

/// The most memory that the process has held so far, bytes.
double peak_memory();

/// "about 1.2 GiB, of which records 0.5 GiB; at most 2.1 GiB"
std::string memory_text(const MemoryPlan& plan);

/// The run's settings as (name of the option, value), those that do nothing left out.
std::vector<std::pair<std::string, std::string>> settings_of(const RunResult& run);

}  // namespace burnish
