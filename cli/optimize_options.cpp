#include "cli/optimize_options.h"

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/option_text.h"
#include "cli/run_result.h"

namespace burnish {

namespace {

constexpr std::uint32_t kDefaultIterations = 200;
constexpr double kDefaultLearningRate = 0.01;

// What the built-in demo uses where nothing else is asked for: about half a minute on two
// cores. Its texture has about as many texels as the picture has pixels, and neighbouring texels
// share evidence: plain texels of a large texture would need far more time to leave the noise.
constexpr const char* kDemoParameter = "mat-goblet.roughness";
constexpr int kDemoSize = 256;
constexpr double kDemoSeconds = 20, kDemoLearningRate = 0.004;
constexpr std::uint32_t kDemoSamples = 16, kDemoPoolSamples = 8;

void add_what(CLI::App& command, OptimizeOptions& o) {
    command.add_option("-o,--output", o.output, "The folder for the results")
        ->type_name("DIR")
        ->capture_default_str();
    command.add_flag("--force", o.force, "Write into a folder that holds other things, too");
    const char* group = "Problem";
    command
        .add_option("--parameter", o.parameters,
                    "Texture to recover, Mitsuba's name or a short form; @RATE gives it a learning "
                    "rate; repeatable")
        ->type_name("NAME[@RATE]")
        ->allow_extra_args(false)
        ->group(group);
    command
        .add_option("--target", o.target,
                    "The image to match, linear, of the film's size; without it, one rendered from "
                    "the scene's own textures")
        ->type_name("IMAGE")
        ->group(group);
    command.add_option("--target-spp", o.target_samples, "Samples per pixel of a rendered target")
        ->type_name("N")
        ->check(in_range({1, 1 << 20, true}))
        ->capture_default_str()
        ->group(group);
    command.add_option("--mask", o.mask, "Weights of the pixels")->type_name("IMAGE")->group(group);
    command
        .add_option("--init", o.initial,
                    "Where a texture starts, once or once per parameter; 'scene' is its own "
                    "texels [0.5]")
        ->type_name("VALUE|FILE|scene")
        ->allow_extra_args(false)
        ->group(group);
    add_choice(command, "--loss", o.solve.loss, kLossNames, "What is minimised")->group(group);
}

void add_estimation(CLI::App& command, OptimizeOptions& o) {
    const char* group = "Gradient";
    GradientOptions& g = o.solve.gradient;
    add_choice(command, "--estimator", g.estimator, kEstimatorNames,
               "How the gradient is estimated")
        ->group(group);
    command
        .add_option("--pool-spp", o.solve.pool.samples_per_pixel,
                    "pool: fresh samples per pixel in an iteration")
        ->type_name("N")
        ->check(in_range({1, 4096, true}))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--pool-window", o.solve.pool.window,
                    "pool: the most passes that each of the two banks keeps")
        ->type_name("K")
        ->check(in_range({1, 1 << 20, true}))
        ->capture_default_str()
        ->group(group);
    add_choice(command, "--pool-sequence", o.solve.pool.sequence, kSequenceNames,
               "pool: how a pixel's random numbers depend on each other from pass to pass")
        ->group(group);
    command
        .add_option("--max-memory", o.max_memory,
                    "pool: what the process may take, in GiB; fewer passes are kept where it is "
                    "short [half of the machine's memory]")
        ->type_name("GIB")
        ->check(in_range({0, 1e6, false, true}))
        ->group(group);
    add_choice(command, "--shift", g.shift, kShiftNames,
               "How a kept sample is carried to the new textures")
        ->group(group);
    add_choice(command, "--target-function", g.target, kTargetNames, "By what samples are kept")
        ->group(group);
    add_choice(command, "--merge", g.merge, kMergeNames, "How history is weighed")->group(group);
    command
        .add_option("--confidence-cap", g.confidence_cap,
                    "The most candidates per pixel that history counts for")
        ->type_name("M")
        ->check(in_range({0, 1e6, false, true}))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--gradient-spp", g.samples_per_pixel,
                    "Samples per pixel of the derivative in an iteration")
        ->type_name("N")
        ->check(in_range({1, 4096, true}))
        ->capture_default_str()
        ->group(group);
    add_choice(command, "--pixel-choice", g.pixels, kPixelChoiceNames,
               "Where the derivative's samples are spent: evenly, or where pixels matter most to "
               "the gradient")
        ->group(group);
    command
        .add_option("--spp", o.solve.samples_per_pixel,
                    "Samples per pixel of the image in an iteration")
        ->type_name("N")
        ->check(in_range({1, 1 << 20, true}))
        ->capture_default_str()
        ->group(group);
}

void add_number(CLI::App& command, const char* name, float& value, const Range& range,
                const char* help) {
    command.add_option(name, value, help)
        ->type_name("X")
        ->check(in_range(range))
        ->capture_default_str()
        ->group("Descent");
}

void add_descent(CLI::App& command, OptimizeOptions& o) {
    const char* group = "Descent";
    command
        .add_option("--iterations", o.iterations,
                    "Ends after N iterations [200 where neither --time nor --patience is given]")
        ->type_name("N")
        ->check(in_range({1, 1e9, true}))
        ->group(group);
    command.add_option("--time", o.seconds, "Ends after so many seconds of descent")
        ->type_name("SECONDS")
        ->check(in_range({0, 1e9, false, true}))
        ->group(group);
    command
        .add_option("--patience", o.patience,
                    "Ends when N checks in a row, 20 iterations apart, found the loss with fresh "
                    "samples no lower than before [no checks]")
        ->type_name("N")
        ->check(in_range({1, 1e6, true}))
        ->group(group);
    command
        .add_option("--learning-rate", o.learning_rates,
                    "Step of the optimiser, once or once per parameter [0.01, shared out among the "
                    "parameters of a material]")
        ->type_name("R")
        ->check(in_range({0, 1e6, false, true}))
        ->allow_extra_args(false)
        ->group(group);
    OptimizerOptions& optimizer = o.solve.optimizer;
    add_choice(command, "--optimizer", optimizer.kind, kOptimizerNames,
               "How a step is made: Adam, or Adam whose steps are shortened where the halves of a "
               "pool disagree on the gradient")
        ->group(group);
    command
        .add_option("--initial-rate", o.initial_rate,
                    "The learning rate of the first ten steps, at most four times that of the "
                    "others, to which it falls [0.02 with agreement, 0 otherwise]")
        ->type_name("R")
        ->check(in_range({0, 1e6}))
        ->group(group);
    command
        .add_option("--rate-falls-after", optimizer.falls_after,
                    "From the N-th iteration on the learning rate falls as 1 / iteration [never]")
        ->type_name("N")
        ->check(in_range({1, 1e9, true}))
        ->group(group);
    add_number(command, "--beta1", optimizer.beta1, {0, 0.999999},
               "Adam: decay of the mean of gradients");
    add_number(command, "--beta2", optimizer.beta2, {0, 0.999999},
               "Adam: decay of the mean of squares");
    add_number(command, "--momentum", optimizer.momentum, {0, 0.999999}, "SGD: momentum");
    add_choice(command, "--parameterization", o.solve.parameterization.kind, kParameterizationNames,
               "What the optimiser moves")
        ->group(group);
    command
        .add_option("--pyramid-levels", o.solve.parameterization.pyramid_levels,
                    "Levels of the pyramid: a coarsest texel spans 2^(N-1) texels a side")
        ->type_name("N")
        ->check(in_range({1, 30, true}))
        ->capture_default_str()
        ->group(group);
    add_choice(command, "--pyramid-upsampling", o.solve.parameterization.upsampling,
               kUpsamplingNames, "How a level of the pyramid reads the next coarser one")
        ->group(group);
    add_number(command, "--detail-decay", o.solve.parameterization.weight_decay, {0, 1000},
               "pyramid: how fast levels but the coarsest go back to where they started, in units "
               "of the learning rate: detail that is not asked for again goes away");
    add_number(command, "--detail-agreement", o.solve.parameterization.snr_prior, {0, 1},
               "pyramid, agreement: levels but the coarsest that agree less than this on the mean "
               "make steps that are shorter in proportion; 0: none do");
    command
        .add_option("--smoothing-length", o.solve.parameterization.smoothing_length,
                    "smooth: texels over which evidence is shared at first")
        ->type_name("TEXELS")
        ->check(in_range({0, 1e4}))
        ->capture_default_str()
        ->group(group);
    add_choice(command, "--unseen", o.unseen, kUnvisitedNames,
               "What becomes of texels that no sample reached: filled from their surroundings, or "
               "kept as they were at the start")
        ->group(group);
}

void add_judgement(CLI::App& command, OptimizeOptions& o) {
    const char* group = "Judgement";
    add_choice_option(
        command, "--compare", kEstimatorNames, [&o](Estimator e) { o.compare = e; },
        "A second descent with this estimator, from the same start, for the same time or number of "
        "iterations; the report shows both")
        ->group(group);
    command
        .add_option("--evaluation-spp", o.evaluation_samples,
                    "Fresh samples per pixel that judge the start and the result")
        ->type_name("N")
        ->check(in_range({1, 1 << 20, true}))
        ->capture_default_str()
        ->group(group);
}

bool given(const CLI::App& command, const char* option) { return command.count(option) > 0; }

void set_up_demo(const CLI::App& command, OptimizeOptions& o) {
    o.demo = true;
    if (o.parameters.empty()) o.parameters = {kDemoParameter};
    if (o.scene.size.empty()) o.scene.size = {kDemoSize, kDemoSize};
    if (!given(command, "--time") && !given(command, "--iterations") &&
        !given(command, "--patience"))
        o.seconds = kDemoSeconds;
    if (!given(command, "--spp")) o.solve.samples_per_pixel = kDemoSamples;
    if (!given(command, "--pool-spp")) o.solve.pool.samples_per_pixel = kDemoPoolSamples;
}

void require_one_or_each(const char* option, std::size_t count, std::size_t parameters) {
    if (count > 1 && count != parameters)
        throw UsageError(
            fmt::format("{} is given {} times for {} parameters, expected once or "
                        "once per parameter",
                        option, count, parameters));
}

void say_without_effect(const CLI::App& command, const OptimizeOptions& o) {
    const auto idle = [&](const char* option, bool used, const std::string& why) {
        if (given(command, option) && !used)
            log_info(fmt::format("note: {} has no effect: {}", option, why));
    };
    const Estimator e = o.solve.gradient.estimator;
    const auto any = [&](auto holds) { return holds(e) || (o.compare && holds(*o.compare)); };
    const bool history = any(has_history);
    const std::string keeps_nothing = fmt::format("the estimator {} keeps no history", name_of(e));
    for (const char* option : {"--shift", "--merge", "--confidence-cap"})
        idle(option, history, keeps_nothing);
    idle("--target-function",
         any([](Estimator x) { return x != Estimator::kMc && x != Estimator::kPool; }),
         fmt::format("the estimator {} keeps every sample", name_of(e)));
    const bool pool = uses(o, Estimator::kPool);
    for (const char* option : {"--pool-spp", "--pool-window", "--pool-sequence", "--max-memory"})
        idle(option, pool, fmt::format("the estimator is {}", name_of(e)));
    const bool reservoirs = any([](Estimator x) { return x != Estimator::kPool; });
    for (const char* option : {"--spp", "--gradient-spp"})
        idle(option, reservoirs, "a pool shades the samples that it keeps (--pool-spp)");
    idle("--pixel-choice", reservoirs,
         "the records of a pool serve its image too, which wants every pixel");
    const bool adam = o.solve.optimizer.kind != Optimizer::kSgd;
    idle("--beta1", adam, "the optimizer is sgd");
    idle("--beta2", adam, "the optimizer is sgd");
    idle("--momentum", !adam, "the optimizer is Adam");
    idle("--optimizer", pool || o.solve.optimizer.kind != Optimizer::kGatedAdam,
         fmt::format("the estimator {} has no halves that could agree, so it takes adam",
                     name_of(e)));
    for (const char* option :
         {"--pyramid-levels", "--pyramid-upsampling", "--detail-decay", "--detail-agreement"})
        idle(option, o.solve.parameterization.kind == Parameterization::kPyramid,
             "the parameterization is not pyramid");
    if (o.solve.parameterization.kind == Parameterization::kPyramid) {
        idle("--detail-decay", adam, "the optimizer is sgd");
        idle("--detail-agreement", o.solve.optimizer.kind == Optimizer::kGatedAdam && pool,
             "steps are not by agreement");
    }
    idle("--smoothing-length", o.solve.parameterization.kind == Parameterization::kSmooth,
         "the parameterization is not smooth");
    idle("--target-spp", o.target.empty(), "the target is a file");
}

}  // namespace

double default_learning_rate(const OptimizeOptions& o) {
    return o.demo ? kDemoLearningRate : kDefaultLearningRate;
}

double memory_limit(const OptimizeOptions& o) {
    return o.max_memory ? *o.max_memory * 0x1p30 : physical_memory() / 2;
}

void add_optimize_options(CLI::App& command, OptimizeOptions& options) {
    add_scene_options(command, options.scene, false, true);
    add_what(command, options);
    add_estimation(command, options);
    add_descent(command, options);
    add_judgement(command, options);
}

void complete_optimize_options(const CLI::App& command, OptimizeOptions& o) {
    if (o.scene.file.empty()) set_up_demo(command, o);
    if (o.parameters.empty())
        throw UsageError("--parameter: expected the name of a texture to recover; `burnish info " +
                         o.scene.file + "` lists them");
    require_one_or_each("--init", o.initial.size(), o.parameters.size());
    require_one_or_each("--learning-rate", o.learning_rates.size(), o.parameters.size());
    if (o.compare == o.solve.gradient.estimator)
        throw UsageError(
            fmt::format("--compare {0}: the first descent uses {0} already", name_of(*o.compare)));
    if (!o.iterations && !o.seconds && o.patience == 0) o.iterations = kDefaultIterations;
    if (!given(command, "--output"))
        log_info("results go to ./" + o.output + " (-o names another folder)");
    if (!is_unbiased(o.solve.loss))
        log_warning("the derivative of the loss l1 is not affine in the image: noise biases its gradient");
    say_without_effect(command, o);
    const bool default_of_texels = !given(command, "--optimizer") &&
                                   o.solve.parameterization.kind == Parameterization::kTexels;
    if ((!uses(o, Estimator::kPool) || default_of_texels) &&
        o.solve.optimizer.kind == Optimizer::kGatedAdam)
        o.solve.optimizer.kind = Optimizer::kAdam;
    const bool snr_gate = o.solve.optimizer.kind == Optimizer::kGatedAdam;
    o.solve.optimizer.initial_rate =
        static_cast<float>(o.initial_rate.value_or(snr_gate ? double{kInitialRate} : 0));
    o.solve.seed = o.scene.seed;
    if (o.initial.empty()) o.initial = {"0.5"};
}

}  // namespace burnish
