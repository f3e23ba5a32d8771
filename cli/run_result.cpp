#include "cli/run_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>

#include "cli/console.h"
#include "cli/option_text.h"

namespace burnish {

namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

std::string number_text(double x) { return fmt::format("{:.6g}", x); }

void add_history_settings(const GradientOptions& g, Settings& settings) {
    settings.emplace_back("--shift", name_of(g.shift));
    settings.emplace_back("--merge", choice_name(kMergeNames, g.merge));
    settings.emplace_back("--confidence-cap", number_text(double{g.confidence_cap}));
}

void add_pool_settings(const OptimizeOptions& o, Settings& settings) {
    const PoolOptions& p = o.solve.pool;
    settings.emplace_back("--pool-spp", std::to_string(p.samples_per_pixel));
    settings.emplace_back("--pool-window", std::to_string(p.window));
    settings.emplace_back("--pool-sequence", choice_name(kSequenceNames, p.sequence));
    settings.emplace_back("--max-memory", number_text(memory_limit(o) / 0x1p30));
}

/// Of estimators that trace an image and a derivative in each iteration.
void add_sample_settings(const SolveOptions& solve, Settings& settings) {
    const GradientOptions& g = solve.gradient;
    if (has_history(g.estimator)) add_history_settings(g, settings);
    settings.emplace_back("--target-function", choice_name(kTargetNames, g.target));
    settings.emplace_back("--gradient-spp", std::to_string(g.samples_per_pixel));
    settings.emplace_back("--pixel-choice", choice_name(kPixelChoiceNames, g.pixels));
    settings.emplace_back("--spp", std::to_string(solve.samples_per_pixel));
}

void add_optimizer_settings(const OptimizerOptions& o, Settings& settings) {
    settings.emplace_back("--optimizer", choice_name(kOptimizerNames, o.kind));
    settings.emplace_back("--initial-rate", number_text(double{o.initial_rate}));
    if (o.falls_after > 0)
        settings.emplace_back("--rate-falls-after", std::to_string(o.falls_after));
    if (o.kind != Optimizer::kSgd) {
        settings.emplace_back("--beta1", number_text(double{o.beta1}));
        settings.emplace_back("--beta2", number_text(double{o.beta2}));
    } else {
        settings.emplace_back("--momentum", number_text(double{o.momentum}));
    }
}

}  // namespace

double physical_memory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<double>(sysconf(_SC_PAGESIZE));
}

double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

std::string memory_text(const MemoryPlan& plan) {
    if (plan.max_records == 0)
        return fmt::format("at most about {}, of which samples and reservoirs {}",
                           bytes_text(most(plan)), bytes_text(plan.samples));
    return fmt::format("about {}, of which records {}; at most {}", bytes_text(expected(plan)),
                       bytes_text(plan.records), bytes_text(most(plan)));
}

Settings settings_of(const RunResult& run) {
    const OptimizeOptions& o = run.options;
    const GradientOptions& g = o.solve.gradient;
    Settings settings{{"scene", o.demo ? "built-in: goblet" : o.scene.file}};
    for (const std::string& d : o.scene.definitions) settings.emplace_back("-D", d);
    if (!o.scene.size.empty())
        settings.emplace_back("--size", fmt::format("{}", fmt::join(o.scene.size, " ")));
    settings.emplace_back("--parameter", fmt::format("{}", fmt::join(o.parameters, ", ")));
    if (o.target.empty())
        settings.emplace_back("--target-spp", std::to_string(o.target_samples));
    else
        settings.emplace_back("--target", o.target);
    if (!o.mask.empty()) settings.emplace_back("--mask", o.mask);
    settings.emplace_back("--init", fmt::format("{}", fmt::join(o.initial, ", ")));
    settings.emplace_back("--loss", choice_name(kLossNames, o.solve.loss));
    settings.emplace_back("--estimator", name_of(g.estimator));
    if (uses(o, Estimator::kPool)) add_pool_settings(o, settings);
    if (g.estimator != Estimator::kPool || o.compare) add_sample_settings(o.solve, settings);
    if (o.iterations) settings.emplace_back("--iterations", std::to_string(*o.iterations));
    if (o.seconds) settings.emplace_back("--time", number_text(*o.seconds));
    if (o.patience > 0) settings.emplace_back("--patience", std::to_string(o.patience));
    std::vector<double> rates;
    for (const TextureSubject& s : run.subjects) rates.push_back(s.learning_rate);
    settings.emplace_back("--learning-rate", fmt::format("{:.6g}", fmt::join(rates, ", ")));
    add_optimizer_settings(o.solve.optimizer, settings);
    const ParameterizationOptions& parameterization = o.solve.parameterization;
    settings.emplace_back("--parameterization",
                          choice_name(kParameterizationNames, parameterization.kind));
    if (parameterization.kind == Parameterization::kPyramid) {
        settings.emplace_back("--pyramid-levels", std::to_string(parameterization.pyramid_levels));
        settings.emplace_back("--pyramid-upsampling",
                              choice_name(kUpsamplingNames, parameterization.upsampling));
        settings.emplace_back("--detail-decay", number_text(double{parameterization.weight_decay}));
        settings.emplace_back("--detail-agreement",
                              number_text(double{parameterization.snr_prior}));
    }
    if (parameterization.kind == Parameterization::kSmooth)
        settings.emplace_back("--smoothing-length", number_text(parameterization.smoothing_length));
    settings.emplace_back("--unseen", choice_name(kUnvisitedNames, o.unseen));
    if (o.compare) settings.emplace_back("--compare", name_of(*o.compare));
    settings.emplace_back("--evaluation-spp", std::to_string(o.evaluation_samples));
    settings.emplace_back("--light-selection",
                          choice_name(kLightSelectionNames, o.scene.light_selection));
    settings.emplace_back("--seed", std::to_string(o.scene.seed));
    settings.emplace_back("--threads", std::to_string(o.scene.threads));
    return settings;
}

}  // namespace burnish
