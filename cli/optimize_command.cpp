// burnish optimize: recovers textures from an image.

#include <fmt/format.h>

#include <algorithm>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/optimize_options.h"
#include "cli/output_folder.h"
#include "scene/parameter_names.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/run_result.h"
#include "cli/summary.h"
#include "cli/texture_files.h"
#include "burnish/error.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "texture/coverage.h"
#include "optimize/memory.h"
#include "gradient/path_cache/iteration.h"
#include "scenes/procedural.h"

namespace burnish {

namespace {

/// Seconds of each phase, by the name of the phase.
class Phases {
  public:
    explicit Phases(RunResult& run) : run_(run) {}
    void end(const std::string& name) { run_.phases.emplace_back(name, watch_.lap()); }

  private:
    RunResult& run_;
    Stopwatch watch_;
};

template <class T>
const T& one_or_each(const std::vector<T>& values, std::size_t i) {
    return values.size() == 1 ? values[0] : values[i];
}

Image initial_texels(const Bitmap& bitmap, const std::string& text, const std::string& name) {
    if (text == "scene") return linear_image(bitmap);
    Image texels = read_texels(bitmap, text, "the start of " + name);
    for (const float v : texels.values)
        if (v < 0 || v > 1)
            throw InputError(
                fmt::format("the start of {} holds {}, expected values from 0 to 1", name, v));
    return texels;
}

/// Takes the colours from textures whose numbers alone are read: there is nothing to recover them
/// from.
std::vector<TextureSubject> make_subjects(const OptimizeOptions& options, Scene& scene) {
    std::vector<TextureSubject> subjects;
    for (std::size_t i = 0; i < options.parameters.size(); ++i) {
        const RatedName rated = split_rate(scene.parameters, options.parameters[i]);
        const Parameter& p = scene.parameters[find_parameter(scene.parameters, rated.name)];
        for (const TextureSubject& other : subjects)
            if (other.texture == p.texture)
                throw InputError(
                    fmt::format("the parameters {} and {} are one texture", other.name, p.name));
        auto& bitmap = std::get<Bitmap>(scene[p.texture]);
        if (!read_as_color(scene, p.texture)) keep_luminance(bitmap);
        TextureSubject subject;
        subject.name = p.name;
        subject.file = file_name_of(p.name);
        for (const TextureSubject& other : subjects)
            if (other.file == subject.file) subject.file += fmt::format("_{}", i);
        subject.texture = p.texture;
        subject.raw = bitmap.raw;
        if (rated.learning_rate > 0)
            subject.learning_rate = rated.learning_rate;
        else if (!options.learning_rates.empty())
            subject.learning_rate = one_or_each(options.learning_rates, i);
        subject.initial = initial_texels(bitmap, one_or_each(options.initial, i), p.name);
        if (options.target.empty()) subject.truth = linear_image(bitmap);
        subjects.push_back(std::move(subject));
    }
    return subjects;
}

/// Gives a rate to those that have none: the textures of a material then move the picture together
/// about as far as one of them alone.
void share_default_rate(const Scene& scene, double rate, std::vector<TextureSubject>& subjects) {
    std::vector<TextureId> recovered;
    for (const TextureSubject& s : subjects) recovered.push_back(s.texture);
    for (TextureSubject& s : subjects)
        if (s.learning_rate == 0)
            s.learning_rate = rate / static_cast<double>(std::max<std::size_t>(
                                         1, read_together(scene, recovered, s.texture)));
}

std::vector<InitialTexture> initial_textures(const Scene& scene, const RunResult& run) {
    std::vector<InitialTexture> textures;
    for (const TextureSubject& s : run.subjects)
        textures.push_back(initial_texture(scene, run.options.solve.parameterization.kind,
                                           s.texture, s.initial,
                                           static_cast<float>(s.learning_rate)));
    return textures;
}

Image make_target(const OptimizeOptions& options, const TracedScene& traced) {
    const Film& film = traced.scene->film;
    if (!options.target.empty())
        return as_rgb(
            read_radiance(options.target, film.crop_width, film.crop_height, "the target"));
    return render_with_progress(traced, {options.scene.seed, Stream::kTarget}, options.target_samples,
                        "rendering the target");
}

void mark_visited(const TracedScene& traced, const Theta& theta, std::uint32_t seed,
                  std::vector<TextureSubject>& subjects) {
    constexpr std::uint32_t kPasses = 16;
    ProgressLine line("finding the texels that light reaches");
    const auto reached = visited_texels(traced, theta, seed, kPasses, progress_of(line));
    for (std::size_t i = 0; i < subjects.size(); ++i) subjects[i].reached = reached[i];
}

std::vector<double> texture_errors(const std::vector<TextureSubject>& subjects,
                                   const Theta& theta) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < subjects.size(); ++i)
        if (subjects[i].truth)
            errors.push_back(
                texture_error(theta.textures[i].values, *subjects[i].truth, subjects[i].reached));
    return errors;
}

/// What tells evaluations of one run apart.
enum Salt : std::uint32_t { kStart, kResult, kCompared, kTruth };

Evaluation evaluate_with_progress(const Problem& problem, const OptimizeOptions& options,
                          const Theta& theta, Salt salt) {
    ProgressLine line(salt == kStart   ? "judging the start"
                      : salt == kTruth ? "judging the truth"
                                       : "judging the result");
    return evaluate(problem, options.solve, theta, options.evaluation_samples, salt,
                    progress_of(line));
}

void judge(const Problem& problem, const RunResult& run, Salt salt, JudgedDescent& judged) {
    judged.evaluation = evaluate_with_progress(problem, run.options, judged.descent.theta, salt);
    judged.texture_errors = texture_errors(run.subjects, judged.descent.theta);
}

/// A descent, after which the texels that no sample reached are what the user asked for.
Descent descend_and_complete(const Problem& problem, const RunResult& run,
                             const SolveOptions& options, const Budget& budget) {
    Descent descent =
        descend_with_progress(problem, options, initial_textures(*problem.scene->scene, run), budget);
    for (std::size_t i = 0; i < run.subjects.size(); ++i) {
        const auto& visits = descent.evidence[i].visits;
        Image& texels = descent.theta.textures[i].values;
        if (run.options.unseen == Unvisited::kFill)
            fill_unvisited(visits, texels);
        else
            keep_unvisited(visits, run.subjects[i].initial, texels);
    }
    return descent;
}

/// The second descent, as long as the first one was.
JudgedDescent compare(const Problem& problem, const RunResult& run) {
    SolveOptions options = run.options.solve;
    options.gradient.estimator = *run.options.compare;
    const Descent& first = run.result.descent;
    Budget budget;
    if (first.ending == Ending::kTime)
        budget.seconds = first.seconds;
    else
        budget.iterations = static_cast<std::uint32_t>(first.rows.size());
    JudgedDescent judged;
    judged.estimator = *run.options.compare;
    judged.descent = descend_and_complete(problem, run, options, budget);
    return judged;
}

void write_results(const RunResult& run, OutputFolder& output) {
    const auto& folder = output.unfinished;
    std::filesystem::create_directories(folder / "textures");
    for (std::size_t i = 0; i < run.subjects.size(); ++i) {
        const auto& bitmap = std::get<Bitmap>((*run.scene)[run.subjects[i].texture]);
        write_texels(folder / "textures", run.subjects[i].file, bitmap,
                     run.result.descent.theta.textures[i].values);
        for (const auto& [name, map] : evidence_maps(run.result.descent, i))
            write_image(folder / "textures" / (run.subjects[i].file + "_" + name + ".exr"), map);
    }
    write_image(folder / "render.exr", run.result.evaluation.image);
    write_image(folder / "target.exr", run.target);
    write_bytes(folder / "history.csv", history_csv(run.result.descent.rows));
    if (run.compared)
        write_bytes(folder / "history_compared.csv", history_csv(run.compared->descent.rows));
    write_bytes(folder / "report.html", report_html(run));
    std::vector<std::string> files = unfinished_files(output);
    files.push_back("summary.json");
    write_bytes(folder / "summary.json", summary_json(run, files));
    move_into_place(output);
}

/// The plan of a pool. What the memory limit leaves for its records goes to the options.
MemoryPlan plan_pool_run(const TracedScene& traced, const Theta& initial, OptimizeOptions& o) {
    SolveOptions solve = o.solve;
    solve.gradient.estimator = Estimator::kPool;
    solve.pool.memory = 0;
    MemoryPlan plan = plan_memory(traced, initial, solve);
    const PoolPlan uncut = plan_pool(*traced.scene, initial, solve.pool);
    const double least = 2.0 * static_cast<double>(uncut.bytes_per_pass);
    const double left = memory_limit(o) - without_records(plan);
    if (left < std::max(least, 1.0))
        throw InputError(fmt::format(
            "the scene, its images and textures take about {}, one pass in each bank up to {}: "
            "expected --max-memory above both together, found {}",
            bytes_text(without_records(plan)), bytes_text(least), bytes_text(memory_limit(o))));
    o.solve.pool.memory = static_cast<std::size_t>(left);
    const double kept =
        static_cast<double>(plan_pool(*traced.scene, initial, o.solve.pool).window) /
        static_cast<double>(uncut.window);
    plan.records *= kept, plan.max_records *= kept;
    return plan;
}

/// What the descents will take. Throws InputError where that is more than the limit.
void plan_run(const TracedScene& traced, const Theta& initial, RunResult& run) {
    OptimizeOptions& o = run.options;
    if (uses(o, Estimator::kPool)) run.memory = plan_pool_run(traced, initial, o);
    SolveOptions other = o.solve;
    if (o.compare && other.gradient.estimator == Estimator::kPool)
        other.gradient.estimator = *o.compare;
    if (other.gradient.estimator == Estimator::kPool) return;
    const MemoryPlan plan = plan_memory(traced, initial, other);
    if (expected(plan) > expected(run.memory)) run.memory = plan;
}

void say_start(const RunResult& run, const Theta& initial) {
    for (const TextureSubject& s : run.subjects)
        log_info(fmt::format("recovering {} ({} x {}, {} channel{}), learning rate {:g}", s.name,
                        s.initial.width, s.initial.height, s.initial.channels,
                        s.initial.channels == 1 ? "" : "s", s.learning_rate));
    if (uses(run.options, Estimator::kPool)) {
        const PoolPlan plan = plan_pool(*run.scene, initial, run.options.solve.pool);
        log_info(fmt::format("pool: {} pixels can see it; two banks of up to {} passes",
                        count_text(plan.pixels), plan.window));
    }
    log_info("memory: " + memory_text(run.memory));
    log_info(
        fmt::format("the start has a loss of {:.4g}; descending with {}, Ctrl-C ends early and "
                    "keeps the results",
                    run.initial.loss, name_of(run.options.solve.gradient.estimator)));
}

void say_descent(const RunResult& run, const JudgedDescent& judged) {
    const Descent& d = judged.descent;
    std::string text = fmt::format("{}: loss {:.4g} -> {:.4g} in {} iterations, {}{}",
                                   name_of(judged.estimator), run.initial.loss,
                                   judged.evaluation.loss, d.rows.size(), duration_text(d.seconds),
                                   d.ending == Ending::kSignal     ? " (ended by a signal)"
                                   : d.ending == Ending::kPatience ? " (the loss fell no longer)"
                                                                   : "");
    if (run.noise_floor)
        text += fmt::format("; {:.2g} of it is the noise of judging", *run.noise_floor);
    for (std::size_t i = 0; i < judged.texture_errors.size(); ++i)
        text += fmt::format("; {} error {:.4f} -> {:.4f}", run.subjects[i].name,
                            run.initial_errors[i], judged.texture_errors[i]);
    log_info(text);
    const std::size_t rejected = d.counts.rejected + d.rejected_image;
    if (rejected > 0)
        log_warning(fmt::format("{} contributions were not finite and were left out",
                         count_text(rejected)));
}

void run_descents(const Problem& problem, Phases& phases, RunResult& run) {
    run.result.estimator = run.options.solve.gradient.estimator;
    Budget budget;
    if (run.options.iterations) budget.iterations = *run.options.iterations;
    if (run.options.seconds) budget.seconds = *run.options.seconds;
    budget.patience = run.options.patience;
    run.result.descent = descend_and_complete(problem, run, run.options.solve, budget);
    phases.end("descent");
    if (run.options.target.empty()) {
        mark_visited(*problem.scene, run.result.descent.theta, run.options.scene.seed,
                     run.subjects);
        for (const TextureSubject& s : run.subjects)
            run.initial_errors.push_back(texture_error(s.initial, *s.truth, s.reached));
        phases.end("reached texels");
    }
    judge(problem, run, kResult, run.result);
    phases.end("final evaluation");
    say_descent(run, run.result);
    if (!run.options.compare || interrupted()) return;
    run.compared = compare(problem, run);
    phases.end("compared descent");
    judge(problem, run, kCompared, *run.compared);
    phases.end("compared evaluation");
    say_descent(run, *run.compared);
}

constexpr ProceduralOptions kDemoScene{.texture_size = 256};

void optimize(OptimizeOptions options) {
    OutputFolder output = open_output_folder(options.output, options.force);
    if (output.replaces)
        log_info(options.output + " exists from an earlier run: replacing it when this run is done");
    const ThreadLimit threads(options.scene.threads);
    RunResult run;
    Phases phases(run);
    if (options.demo) {
        const auto folder = output.unfinished / "scene";
        write_procedural_scene("goblet", folder, kDemoScene);
        options.scene.file = (folder / "scene.xml").string();
    }
    LoadedScene loaded = load_scene_with_progress(options.scene);
    run.scene = &loaded.scene;
    run.options = options;
    run.warnings = loaded.warnings;
    run.subjects = make_subjects(options, loaded.scene);
    share_default_rate(loaded.scene, default_learning_rate(options), run.subjects);
    const TracedScene traced = prepare_with_progress(loaded.scene, options.scene.light_selection);
    phases.end("scene");

    Problem problem{&traced, {}, {}};
    const Film& film = loaded.scene.film;
    if (!options.mask.empty())
        problem.mask = read_mask(options.mask, film.crop_width, film.crop_height);
    problem.target = make_target(options, traced);
    validate(problem, options.solve);
    run.target = problem.target;
    phases.end("target");

    Theta initial;
    for (const TextureSubject& s : run.subjects) initial.textures.push_back({s.texture, s.initial});
    run.initial = evaluate_with_progress(problem, options, initial, kStart);
    if (options.target.empty()) run.noise_floor = evaluate_with_progress(problem, options, {}, kTruth).loss;
    phases.end("initial evaluation");
    plan_run(traced, initial, run);
    say_start(run, initial);
    const InterruptGuard guard;
    run_descents(problem, phases, run);
    write_results(run, output);
    log_info(fmt::format("the report is {}",
                    (std::filesystem::path(options.output) / "report.html").string()));
}

}  // namespace

void add_optimize_command(CLI::App& app) {
    auto options = std::make_shared<OptimizeOptions>();
    CLI::App* command = app.add_subcommand(
        "optimize", "Recovers textures from an image; without a scene, those of a built-in demo");
    add_optimize_options(*command, *options);
    command->callback([command, options] {
        complete_optimize_options(*command, *options);
        optimize(*options);
    });
}

}  // namespace burnish
