#include "experiments/parameterizations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/interval.h"
#include "texture/coverage.h"

namespace burnish {

namespace {

/// The library's defaults, at the paper's learning rate.
Options run_options(const TargetScene& scene, const ReproduceOptions& options,
                    Parameterization kind) {
    Options run;
    run.estimator = PathCache{};
    run.parameterization = kind;
    run.learning_rate = double{scene.source.learning_rate};
    run.seed = options.seed;
    return run;
}

double error_of(const TargetScene& scene, const Solver& solver) {
    return texture_error(solver.texture(0), scene.truth, scene.visited);
}

}  // namespace

ParameterizationStudy study_parameterizations(const TargetScene& scene,
                                              const ReproduceOptions& options,
                                              const WorkNote& note) {
    ParameterizationStudy study;
    const auto loss_of = [&](const Solver& solver) {
        return loss_without_noise(solver.evaluate(options.evaluation_samples));
    };
    for (const auto& [name, kind] : {std::pair{"texels", Parameterization::kTexels},
                                     {"pyramid", Parameterization::kPyramid}}) {
        note(scene.source.name + ": a run of the path cache with the parameterization " + name);
        const Options run = run_options(scene, options, kind);
        Solver solver(problem_of(scene), run);
        if (study.ends.empty()) {
            study.loss = loss_of(solver);
            study.texture_error = error_of(scene, solver);
            study.truth_loss = loss_of(Solver(problem_of(scene, scene.truth), run));
        }
        const double seconds = options.sweep_seconds;
        step_for(solver, seconds, [&](double spent, const Iteration&) {
            if (note.share) note.share(std::min(1.0, spent / seconds));
        });
        study.ends.push_back({name, solver.iterations(), loss_of(solver), error_of(scene, solver)});
    }
    return study;
}

double left_of(const ParameterizationStudy& s, const ParameterizationEnd& end) {
    const double start = s.loss - s.truth_loss;
    return start > 0 ? std::max(end.loss - s.truth_loss, 0.0) / start  // keeps NaN
                     : std::numeric_limits<double>::quiet_NaN();
}

Table parameterization_table(const ParameterizationStudy& s) {
    Table table{{"parameterization, path cache", "iterations", "loss", "left", "texture error"},
                {}};
    table.rows.push_back({"start", "0", fmt::format("{:.4g}", s.loss), share_text(1),
                          fmt::format("{:.4g}", s.texture_error)});
    for (const ParameterizationEnd& end : s.ends)
        table.rows.push_back({end.name, std::to_string(end.iterations),
                              fmt::format("{:.4g}", end.loss), share_text(left_of(s, end)),
                              fmt::format("{:.4g}", end.texture_error)});
    return table;
}

std::string parameterization_text(const ParameterizationStudy& s, double seconds) {
    std::string text = fmt::format("After {:g} s of the path cache", seconds);
    for (const ParameterizationEnd& end : s.ends) {
        const double left = left_of(s, end);
        text += fmt::format(
            "{} {} leaves {} (texture error {:.3f})", &end == &s.ends.front() ? "" : ",", end.name,
            std::isnan(left) ? "a loss too noisy to tell" : share_text(left) + " of the loss",
            end.texture_error);
    }
    return text + fmt::format("; the texture error at the start was {:.3f}.", s.texture_error);
}

void measure(ExperimentResult& result, const std::string& scene, const ParameterizationStudy& s) {
    for (const ParameterizationEnd& end : s.ends) {
        const auto add = [&](const char* metric, double value) {
            result.measurements.push_back(
                {result.name, scene, fmt::format("parameterization: {}", end.name), metric, value});
        };
        add("loss", end.loss), add("loss_left", left_of(s, end));
        add("texture_error", end.texture_error), add("iterations", end.iterations);
    }
}

}  // namespace burnish
