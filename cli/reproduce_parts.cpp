#include "cli/reproduce_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/pictures.h"
#include "cli/progress.h"
#include "core/hash.h"
#include "core/stopwatch.h"
#include "image/files.h"
#include "scenes/procedural.h"

namespace burnish {

namespace {

/// The line that is rewritten while an experiment works: the seconds of what is being done, or the
/// time left once it says how far it is.
class NoteLine {
  public:
    explicit NoteLine(std::string title) : title_(std::move(title)) {}
    void begin(const std::string& text) {
        ticking_.reset();
        bar_ = std::make_unique<ProgressLine>(title_ + ": " + text);
        ticking_ = std::make_unique<TickingLine>(title_ + ": " + text);
    }
    void share(double done) {
        ticking_.reset();
        if (bar_) bar_->show_share(done);
    }

  private:
    std::string title_;
    std::unique_ptr<ProgressLine> bar_;
    std::unique_ptr<TickingLine> ticking_;
};

constexpr int kOwnTextureSide = 2048;

/// All that the target of a scene is made of.
nlohmann::json made_of(const KnownTarget& target, const ReproduceOptions& options) {
    const TargetSource& s = target.source;
    return {{"scene", s.name},
            {"files", target.files},
            {"parameter", s.parameter},
            {"learning_rate", s.learning_rate},
            {"confidence_cap", s.confidence_cap},
            {"options", options}};
}

/// All that a part is made of, which holds times.
nlohmann::json made_of(const Part& part, const ReproduceOptions& options, const Machine& machine) {
    nlohmann::json all =
        part.target ? made_of(*part.target, options) : nlohmann::json{{"options", options}};
    all["experiment"] = part.experiment->name;
    all["machine"] = machine;
    return all;
}

std::string name_of(const Part& part) {
    return part.target ? fmt::format("{}-{}", part.target->source.name, part.experiment->name)
                       : part.experiment->name;
}

/// "tire-inverse (part 3 of 31, 12 min left)"
std::string title_of(const Part& part, const std::vector<Part>& parts) {
    const std::optional<double> left = seconds_left(parts);
    return fmt::format("{} (part {} of {}{})", name_of(part), count_done(parts) + 1, parts.size(),
                       left ? ", " + duration_text(*left) + " left" : "");
}

WorkNote note_on(NoteLine& line) {
    return {[&](const std::string& text) { line.begin(text); },
            [&](double done) { line.share(done); }};
}

/// The scene with its target, which is kept.
TargetScene prepare(const KnownTarget& target, const ReproduceOptions& options,
                    const KeptResults& kept, const std::filesystem::path& own_folder) {
    NoteLine line("preparing");
    const WorkNote note = note_on(line);
    note(target.source.name);
    TargetSource source = target.source;
    if (target.own) {
        source.file = own_folder / source.name / "scene.xml";
        const int side = options.texture_side > 0 ? options.texture_side : kOwnTextureSide;
        write_procedural_scene(source.name, source.file.parent_path(), {.texture_size = side});
    }
    TargetScene scene = load_target_scene(source, options);
    std::filesystem::remove_all(own_folder);
    const std::string name = source.name + "-target";
    const nlohmann::json made = made_of(target, options);
    if (const auto found = find_kept(kept, name, made)) {
        scene.target = found->get<Image>();
    } else {
        scene.target = render_target(scene, options, note.share);
        keep(kept, name, made, scene.target);
    }
    set_kept(kept);
    return scene;
}

/// The scene's study, of which the converged derivative is kept.
void prepare_study(const KnownTarget& target, const ReproduceOptions& options,
                   const KeptResults& kept, const WorkNote& note, TargetScene& scene) {
    if (scene.study) return;
    const std::string name = target.source.name + "-derivative";
    const nlohmann::json made = made_of(target, options);
    std::optional<DerivativeReference> reference;
    if (const auto found = find_kept(kept, name, made))
        reference = found->get<DerivativeReference>();
    scene.study = make_study(scene, options, note, reference);
    if (!reference) keep(kept, name, made, scene.study->reference);
}

/// A run of which nothing is kept but, perhaps, how far it came.
RunKeeper keep_run(const KeptResults& kept) {
    RunKeeper keeper;
    Checkpoints& checkpoints = keeper.checkpoints;
    checkpoints.folder = kept.folder.string();
    checkpoints.stop = interrupted;
    checkpoints.note = [](const CheckpointNote& note) {
        if (!note.error.empty())
            log_warning(fmt::format("{}; the run {} without it", note.error,
                                    note.is_last ? "ends" : "goes on"));
    };
    keeper.keep = [&kept](std::size_t at, const Moment& moment) { keep(kept, "at", at, moment); };
    if (!std::filesystem::exists(kept.folder)) return keeper;
    try {
        keeper.from = load_checkpoint(checkpoints.folder);
    } catch (const InputError& error) {
        log_info(fmt::format("{}: the run begins again", error.what()));
    }
    for (std::size_t at = 0; at < kMoments; ++at)
        if (const auto found = find_kept(kept, "at", at)) keeper.moments[at] = found->get<Moment>();
    return keeper;
}

/// The scene's runs, each of which is kept, also before its end. False: a signal came before the
/// last one.
bool prepare_runs(const KnownTarget& target, const ReproduceOptions& options,
                  const Machine& machine, const KeptResults& kept, const WorkNote& note,
                  TargetScene& scene) {
    const std::string name = target.source.name + "-run",
                      unfinished = target.source.name + "-unfinished";
    nlohmann::json made = made_of(target, options);
    made["machine"] = machine;
    const auto get = [&](const Method& method, std::uint32_t k) -> std::optional<Run> {
        made["method"] = method.name, made["run"] = k;
        if (const auto found = find_kept(kept, name, made)) return found->get<Run>();
        if (interrupted()) return {};
        const KeptResults part{kept_path(kept, unfinished, made), kept.program};
        RunKeeper keeper = keep_run(part);
        std::optional<Run> run = run_method(scene, method, options, k, note, &keeper);
        if (!run) return {};
        keep(kept, name, made, *run);
        std::filesystem::remove_all(part.folder);
        return run;
    };
    if (!scene.runs) scene.runs = make_runs(scene, options, get);
    return scene.runs != nullptr;
}

double seconds_of(const InverseRuns& runs) {
    double seconds = 0;
    for (const Method& method : runs.methods)
        for (const Run& run : method.runs) seconds += run.seconds;
    return seconds;
}

/// Ends a part before the next of its estimates.
struct StoppedBetweenEstimates {};

/// Keeps what a part estimates until all of it is, in files called `kind`. took: the seconds of
/// what earlier runs have made are added.
template <class T>
Get<T> keep_estimates(const KeptResults& kept, const char* kind, double& took) {
    return [&kept, kind, &took](const std::string& name, const std::function<T()>& make) {
        if (const auto found = find_kept(kept, kind, name)) {
            took += found->at(1).get<double>();
            return found->at(0).get<T>();
        }
        if (interrupted()) throw StoppedBetweenEstimates{};
        const Stopwatch watch;
        const T made = make();
        keep(kept, kind, name, {made, watch.total()});
        return made;
    };
}

/// Sets the part's result, unless a signal came before it could be made. seconds: of what was made
/// for it before.
void run_part(const ReproduceOptions& options, const Machine& machine, const KeptResults& kept,
              TargetScenes scene, const std::vector<Part>& parts, double seconds, Part& part) {
    NoteLine line(title_of(part, parts));
    WorkNote note = note_on(line);
    const Experiment& e = *part.experiment;
    const nlohmann::json made = made_of(part, options, machine);
    const KeptResults unfinished{kept_path(kept, name_of(part) + "-unfinished", made),
                                 kept.program};
    note.numbers = keep_estimates<EstimateNumbers>(unfinished, "estimate", seconds);
    note.reference = keep_estimates<DerivativeReference>(unfinished, "derivative", seconds);
    if (e.needs == Needs::kRuns &&
        !prepare_runs(*part.target, options, machine, kept, note, scene[0]))
        return;
    const Stopwatch watch;
    if (e.needs == Needs::kStudy) {
        prepare_study(*part.target, options, kept, note, scene[0]);
        if (interrupted()) return;
    }
    ExperimentResult result;
    try {
        result = e.run(scene, options, note);
    } catch (const StoppedBetweenEstimates&) {
        return;
    }
    result.title = e.title;
    result.seconds = seconds + watch.total();
    if (e.needs == Needs::kRuns) result.seconds += seconds_of(*scene[0].runs);
    for (Figure& f : result.figures)
        for (auto& row : f.pictures)
            for (Picture& p : row) p.image = shrink(p.image, kPictureSide);
    keep(kept, name_of(part), made, result);
    std::filesystem::remove_all(unfinished.folder);
    set_kept(kept);
    part.result = std::move(result);
}

void log_part(const Part& part) {
    log_info(fmt::format("{} ({}):", name_of(part), duration_text(part.result->seconds)));
    for (const Figure& f : part.result->figures)
        log_info(fmt::format("  {}: {}. {}", f.title, name_of(f.verdict), f.measured));
}

}  // namespace

void set_kept(const KeptResults& kept) {
    set_on_disk(OnDisk::kAll,
                fmt::format("stopped: the same command goes on with what is kept in {}",
                            kept.folder.string()));
}

nlohmann::json files_of(const std::filesystem::path& folder,
                        const std::vector<std::filesystem::path>& left_out) {
    const auto is_left_out = [&](const std::filesystem::path& path) {
        std::error_code ignored;  // of a folder that is not there
        return std::ranges::any_of(left_out, [&](const std::filesystem::path& f) {
            return std::filesystem::equivalent(path, f, ignored);
        });
    };
    nlohmann::json files = nlohmann::json::array();
    for (auto at = std::filesystem::recursive_directory_iterator(folder); at != end(at); ++at) {
        if (at->is_directory() && is_left_out(at->path())) at.disable_recursion_pending();
        if (at->is_regular_file())
            files.push_back(
                {at->path().lexically_relative(folder).string(), hash_of(read_bytes(at->path()))});
    }
    std::sort(files.begin(), files.end());
    return files;
}

std::size_t count_done(const std::vector<Part>& parts) {
    return static_cast<std::size_t>(std::count_if(
        parts.begin(), parts.end(), [](const Part& p) { return p.result.has_value(); }));
}

std::optional<double> seconds_left(const std::vector<Part>& parts) {
    const auto mean = [&](const auto& is_like) -> std::optional<double> {
        double sum = 0, count = 0;
        for (const Part& p : parts)
            if (p.result && is_like(p)) sum += p.result->seconds, ++count;
        if (!(count > 0)) return {};
        return sum / count;
    };
    const std::optional<double> of_any = mean([](const Part& p) { return p.target != nullptr; });
    double left = 0;
    for (const Part& missing : parts) {
        if (missing.result) continue;
        const std::optional<double> same =
            mean([&](const Part& p) { return p.experiment == missing.experiment; });
        const std::optional<double> seconds = same || !missing.target ? same : of_any;
        if (!seconds) return {};
        left += *seconds;
    }
    return left;
}

void run_parts(const ReproduceOptions& options, const Machine& machine, const KeptResults& kept,
               const std::filesystem::path& own_folder, std::vector<Part>& parts) {
    std::vector<Part*> missing;
    for (Part& part : parts) {
        if (const auto found = find_kept(kept, name_of(part), made_of(part, options, machine)))
            part.result = found->get<ExperimentResult>();
        else
            missing.push_back(&part);
    }
    if (missing.size() < parts.size())
        log_info(fmt::format("{} of {} parts are kept from an earlier run",
                             parts.size() - missing.size(), parts.size()));
    // Scene by scene: only one has to be in memory.
    std::stable_sort(missing.begin(), missing.end(),
                     [](const Part* a, const Part* b) { return a->target < b->target; });
    std::vector<TargetScene> scene;
    double preparing = 0;  // seconds: the first part of a scene counts them
    const KnownTarget* of = nullptr;
    for (Part* part : missing) {
        if (interrupted()) return;
        if (part->target && part->target != of) {
            scene.clear();
            const Stopwatch watch;
            scene.push_back(prepare(*part->target, options, kept, own_folder));
            of = part->target, preparing = watch.total();
            if (interrupted()) return;
        }
        const bool has_scene = part->target != nullptr;
        run_part(options, machine, kept, has_scene ? TargetScenes(scene) : TargetScenes(), parts,
                 has_scene ? std::exchange(preparing, 0.0) : 0.0, *part);
        if (part->result) log_part(*part);
    }
}

Reproduction reproduction_of(const std::vector<Part>& parts) {
    Reproduction run;
    for (const Part& part : parts) {
        if (!part.result) continue;
        const ExperimentResult& r = *part.result;
        if (run.experiments.empty() || run.experiments.back().name != r.name)
            run.experiments.push_back({r.name, r.title, {}, {}, 0});
        ExperimentResult& all = run.experiments.back();
        all.figures.insert(all.figures.end(), r.figures.begin(), r.figures.end());
        all.measurements.insert(all.measurements.end(), r.measurements.begin(),
                                r.measurements.end());
        all.seconds += r.seconds, run.seconds += r.seconds;
    }
    return run;
}

}  // namespace burnish
