#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>

#include "experiments/ablation.h"
#include "experiments/close_up.h"
#include "experiments/interval.h"
#include "experiments/inverse_runs.h"

namespace burnish {

namespace {

/// The loss of a method over that of another one, run by run.
RatioInterval loss_ratio(const Method& a, const Method& b, At at) {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < a.runs.size(); ++k)
        ratios.push_back(positive_ratio(a.runs[k].at[at].loss, b.runs[k].at[at].loss));
    return ratio_interval(ratios);
}

template <class Value>
double mean_of_runs(const Method& method, At at, Value value) {
    double sum = 0;
    for (const Run& run : method.runs) sum += value(run.at[at]);
    return sum / static_cast<double>(method.runs.size());
}

double mean_loss(const Method& method, At at) {
    return mean_of_runs(method, at, [](const Moment& m) { return m.loss; });
}

/// Means over at most so many pieces of a curve: single iterations are noisy.
Curve smoothed(const Curve& curve, std::size_t pieces) {
    Curve result{curve.name, {}};
    const std::size_t n = curve.points.size(), count = std::min(n, pieces);
    for (std::size_t p = 0; p < count; ++p) {
        const std::size_t begin = p * n / count, end = (p + 1) * n / count;
        CurvePoint mean;
        for (std::size_t i = begin; i < end; ++i)
            mean.x += curve.points[i].x, mean.y += curve.points[i].y;
        const double size = static_cast<double>(end - begin);
        result.points.push_back({mean.x / size, mean.y / size});
    }
    return result;
}

/// Of the first runs, until so many seconds. Each method has a curve; one that has nothing to show
/// has no points.
Plot loss_plot(const std::vector<Method>& methods, double seconds) {
    Plot plot{
        "seconds of the derivative stage", "loss of an iteration, with noise that falls, too", {}};
    for (const Method& m : methods) {
        Curve curve = m.runs.front().losses;
        std::erase_if(curve.points, [&](const CurvePoint& p) { return p.x > seconds; });
        if (curve.points.size() < 2) curve.points.clear();
        plot.curves.push_back(smoothed(curve, 40));
    }
    return plot;
}

/// The whole of the long runs.
Plot long_plot(const std::vector<Method>& methods) {
    Plot plot = loss_plot(methods, std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < methods.size(); ++k)
        if (!methods[k].is_long) plot.curves[k].points.clear();
    return plot;
}

/// What is shown of an image and of a texture.
using Shown = std::function<Image(const Image&)>;

/// Of the first runs of some methods after the time of the derivatives, beside what they are to
/// become, `start` being the loss at the start.
std::vector<std::vector<Picture>> pictures_of(const TargetScene& scene, double start,
                                              const std::vector<Method>& methods,
                                              std::initializer_list<std::size_t> which,
                                              const Shown& of_image, const Shown& of_texture) {
    std::vector<Picture> images, textures;
    const bool raw = std::get<Bitmap>(scene.scene()[scene.texture]).raw;
    const PictureKind kind = raw ? PictureKind::kTexture : PictureKind::kColor;
    textures.push_back({"truth", "texture", of_texture(scene.truth), kind});
    for (const std::size_t k : which) {
        const Moment& m = methods[k].runs.front().at[kDerivative];
        images.push_back(
            {fmt::format("{}, {:.4g} s of derivatives", methods[k].name, m.derivative_seconds),
             fmt::format("loss {:.4g} of {:.4g}", m.loss, start), of_image(m.image)});
        textures.push_back({methods[k].name, fmt::format("error {:.4f}", m.texture_error),
                            of_texture(m.texture), kind});
    }
    images.push_back({"target", "", of_image(scene.target)});
    return {std::move(images), std::move(textures)};
}

/// With and without positivisation, the parts in which these differ most.
std::vector<std::vector<Picture>> close_ups_of(const TargetScene& scene, double start,
                                               const std::vector<Method>& methods) {
    const auto part = [&](const Image Moment::*picture) -> Shown {
        const auto of = [&](std::size_t k) -> const Image& {
            return methods[k].runs.front().at[kDerivative].*picture;
        };
        return [square = most_different(of(kGris), of(kReplay))](const Image& whole) {
            return close_up(whole, square);
        };
    };
    return pictures_of(scene, start, methods, {kGris, kReplay}, part(&Moment::image),
                       part(&Moment::texture));
}

std::string iterations_text(std::uint32_t count) {
    return fmt::format("{} iteration{}", count, count == 1 ? "" : "s");
}

/// "25 iterations"; not of kLate.
std::string text_of(At at, const Budget& budget) {
    switch (at) {
        case kIterations:
            return iterations_text(budget.iterations);
        case kLong:
            return iterations_text(budget.long_iterations);
        case kDerivative:
            return fmt::format("{:g} s of derivatives", budget.derivative_seconds);
        default:
            return fmt::format("{:g} s", budget.seconds);
    }
}

Table table_of(const std::vector<Method>& methods, const Budget& budget) {
    const std::string end = " after " + text_of(kClock, budget);
    Table table{{"method", "iterations" + end, "texture error" + end}, {}};
    for (const Method& m : methods) {
        const auto mean = [&](auto value) { return mean_of_runs(m, kClock, value); };
        table.rows.push_back(
            {m.name, fmt::format("{:.0f}", mean([](const Moment& x) { return x.iteration; })),
             fmt::format("{:.3f}", mean([](const Moment& x) { return x.texture_error; }))});
    }
    const auto floor_text = [](const Method& method, At at) {
        return fmt::format("{:.2g}",
                           mean_of_runs(method, at, [](const Moment& m) { return m.noise_floor; }));
    };
    for (const At at : {kIterations, kLong, kDerivative, kClock}) {
        if (at == kLong && !has_long(budget)) continue;
        table.head.push_back("loss after " + text_of(at, budget));
        table.head.push_back("its noise floor");
        table.head.push_back("loss over that of mc");
        for (std::size_t k = 0; k < methods.size(); ++k) {
            const bool is_missing = at == kLong && !methods[k].is_long;
            const auto add = [&](const std::string& text) {
                table.rows[k].push_back(is_missing ? "" : text);
            };
            add(fmt::format("{:.4g}", mean_loss(methods[k], at)));
            add(floor_text(methods[k], at));
            add(k == kMc ? "" : text_of(loss_ratio(methods[k], methods[kMc], at)));
        }
    }
    return table;
}

std::string sentences(const std::string& first, const std::string& second) {
    return first.empty() || second.empty() ? first + second : first + " " + second;
}

/// Where reused samples lengthen steps; empty where they do not.
std::string reason_of_steps(const std::vector<Method>& methods, const Budget& budget) {
    const auto length = [&](std::size_t k) {
        return mean_of_runs(methods[k], kIterations, [](const Moment& m) { return m.step_length; });
    };
    if (!(length(kReplay) > length(kMc))) return {};
    return fmt::format(
        "Steps of Adam are the longer, the longer a gradient and its errors stay as they are, and "
        "reused samples keep theirs: the step of iteration {} moves a texel by {:.2f} of the "
        "learning rate with mc and by {:.2f} with pgris and replay.",
        budget.iterations, length(kMc), length(kReplay));
}

/// Where a step with replay takes longer; empty where it does not.
std::string reason_of_costs(const std::vector<Method>& methods) {
    const auto iteration = [&](std::size_t k) {
        return mean_of_runs(methods[k], kClock, [](const Moment& m) {
            return 1000 * m.derivative_seconds / m.iteration;
        });
    };
    if (!(iteration(kReplay) > iteration(kMc))) return {};
    return fmt::format(
        "On a CPU a fresh sample is cheap beside a replayed one: a derivative takes {:.1f} ms with "
        "mc, {:.1f} ms with pgris and replay, {:.1f} ms with the identity shift, so that mc makes "
        "{:.1f} steps in the time of one of pgris with replay.",
        iteration(kMc), iteration(kReplay), iteration(kIdentity),
        iteration(kReplay) / iteration(kMc));
}

/// Why the loss of pgris with replay is not below that of mc, where the verdict at equal time or a
/// single run is against it, and why it is above that late in the long runs. Else empty.
std::string reason_of(const std::vector<Method>& methods, const Budget& budget, Verdict verdict) {
    const auto ratio = [&](At at) { return loss_ratio(methods[kReplay], methods[kMc], at); };
    const RatioInterval replay = ratio(kDerivative);
    const bool is_behind = stands_above_one(replay);
    std::string why;
    if (is_behind && stands_above_one(ratio(kIterations)))
        why = "At equal iterations, too.";
    else if (has_long(budget) && stands_above_one(ratio(kLong)))
        why = fmt::format("After {} the loss of pgris with replay is the higher one.",
                          iterations_text(budget.long_iterations));
    if (!why.empty()) why = sentences(why, reason_of_steps(methods, budget));
    if (is_behind) return sentences(why, reason_of_costs(methods));
    const bool is_open = falls_short(verdict);  // it holds of the identity shift
    return is_open ? sentences(reason_of_doubt(replay, "replay", "the evaluation"), why) : why;
}

/// The paper's figures 1 and 4 to 6, (c) and (d).
Figure equal_time_figure(const TargetScene& scene, double start, const std::vector<Method>& methods,
                         const ReproduceOptions& options) {
    const auto ratio = [&](std::size_t k, At at) {
        return loss_ratio(methods[k], methods[kMc], at);
    };
    const RatioInterval replay = ratio(kReplay, kDerivative),
                        identity = ratio(kIdentity, kDerivative);
    Figure f;
    f.title = title_of(scene);
    f.claim =
        "At equal time of the derivatives the loss falls further than with detached sampling, at "
        "the same learning rate and 1 sample per pixel of the derivative.";
    f.measured = fmt::format(
        "Losses as ratios to that of mc, {}, from {:.4g} at the start. After {:g} s of the "
        "derivative stage: pgris with replay {}, with the identity "
        "shift {}. After {}: {} and {}. After {:g} s of whole iterations: {} and {}; "
        "beyond the paper, the path cache {}, whose seconds of derivatives hold its image, too.",
        interval_text(options.runs), start, options.budget.derivative_seconds, text_of(replay),
        text_of(identity), iterations_text(options.budget.iterations),
        text_of(ratio(kReplay, kIterations)), text_of(ratio(kIdentity, kIterations)),
        options.budget.seconds, text_of(ratio(kReplay, kClock)), text_of(ratio(kIdentity, kClock)),
        text_of(ratio(kCache, kClock)));
    if (has_long(options.budget))
        f.measured += fmt::format(
            " After {} mc has {:.4g} and pgris with replay {:.4g}, {} of it.",
            iterations_text(options.budget.long_iterations), mean_loss(methods[kMc], kLong),
            mean_loss(methods[kReplay], kLong), text_of(ratio(kReplay, kLong)));
    f.verdict = verdict_below_one(replay, identity);
    f.why = reason_of(methods, options.budget, f.verdict);
    f.tables.push_back(table_of(methods, options.budget));
    f.plots.push_back(loss_plot(methods, 1.05 * options.budget.derivative_seconds));
    const auto whole = [](const Image& picture) { return picture; };
    f.pictures = pictures_of(scene, start, methods, {kMc, kReplay, kCache}, whole, whole);
    return f;
}

/// The paper's figure 7.
Figure positivization_figure(const TargetScene& scene, double start,
                             const std::vector<Method>& methods, const ReproduceOptions& options) {
    const auto ratio = [&](At at) { return loss_ratio(methods[kReplay], methods[kGris], at); };
    Figure f;
    f.title = title_of(scene) + ", with and without positivisation";
    f.claim = "Inverse rendering with positivisation ends at a lower loss than without.";
    f.measured = fmt::format(
        "The loss of pgris over that of gris, both with replay, {}: {} after {}, {} after {:g} s "
        "of the derivative stage, {} after {:g} s.",
        interval_text(options.runs), text_of(ratio(kIterations)),
        iterations_text(options.budget.iterations), text_of(ratio(kDerivative)),
        options.budget.derivative_seconds, text_of(ratio(kClock)), options.budget.seconds);
    f.measured +=
        " Shown are the parts that differ most; losses and errors below are of the whole.";
    f.verdict = verdict_below_one(ratio(kIterations));
    if (stands_above_one(ratio(kIterations))) f.why = kPositivizationReason;
    f.pictures = close_ups_of(scene, start, methods);
    return f;
}

/// The paper's figures 4 and 6 (d): where the baseline has converged, pgris goes on.
Figure late_figure(const TargetScene& scene, const std::vector<Method>& methods,
                   const ReproduceOptions& options) {
    const auto changes = [&](std::size_t k) { return late_changes(methods[k]); };
    const std::vector<double> of_mc = changes(kMc), of_replay = changes(kReplay);
    std::vector<double> paired;
    for (std::size_t k = 0; k < of_mc.size(); ++k) paired.push_back(of_replay[k] / of_mc[k]);
    const RatioInterval mc = ratio_interval(of_mc), replay = ratio_interval(of_replay),
                        beside_mc = ratio_interval(paired);
    const auto text = [](const RatioInterval& i) {
        return std::isnan(i.ratio) ? "too few iterations or too much noise to tell" : text_of(i);
    };
    Figure f;
    f.title = title_of(scene) + ", late in the run";
    f.claim = "The loss goes on falling where that of detached sampling has converged.";
    f.measured = fmt::format(
        "The loss after {} over that after two thirds of them, {}: mc {}, pgris with replay {}, "
        "with the identity shift {}. That of pgris with replay over that of mc, run by run: {}. "
        "A ratio of mc above {:g} counts as converged.",
        text_of(kDerivative, options.budget), interval_text(options.runs), text(mc), text(replay),
        text(ratio_interval(changes(kIdentity))), text(beside_mc), kConverged);
    f.verdict = late_verdict(mc, replay, beside_mc);
    if (stands_below_one(in_units_of(mc, kConverged)))
        f.why = fmt::format(
            "mc has not converged within this budget: its loss falls, too, to {} of that after two "
            "thirds of it.",
            text_of(mc));
    f.plots.push_back(long_plot(methods));
    return f;
}

void measure_method(const TargetScene& scene, const Method& method, ExperimentResult& result) {
    constexpr const char* kNames[kMoments] = {"iterations", "long_iterations", "derivative_seconds",
                                              "seconds", "two thirds of derivative_seconds"};
    for (std::size_t k = 0; k < method.runs.size(); ++k)
        for (std::size_t b = 0; b < kMoments; ++b) {
            if ((b == kLong && !method.is_long) || (b == kLate && !method.is_late)) continue;
            const Moment& at = method.runs[k].at[b];
            const auto add = [&](const char* metric, double value) {
                result.measurements.push_back(
                    {result.name, scene.source.name,
                     fmt::format("{}, run {}, budget of {}", method.name, k, kNames[b]), metric,
                     value});
            };
            add("iterations", at.iteration);
            add("seconds", at.seconds);
            add("derivative_seconds", at.derivative_seconds);
            add("loss", at.loss);
            add("noise_floor", at.noise_floor);
            add("texture_error", at.texture_error);
            if (b == kIterations) add("step_length", at.step_length);
        }
}

}  // namespace

ExperimentResult run_inverse(TargetScenes scenes, const ReproduceOptions& options,
                             const WorkNote& note) {
    ExperimentResult result{"inverse", "", {}, {}, 0};
    for (TargetScene& scene : scenes) {
        const Solver fresh(problem_of(scene), paper_options(scene, options));
        const double start = evaluate_moment(scene, options, fresh).loss;
        const std::vector<Method>& methods = runs_of(scene, options, note).methods;
        for (const Method& method : methods) measure_method(scene, method, result);
        result.figures.push_back(equal_time_figure(scene, start, methods, options));
        result.figures.push_back(positivization_figure(scene, start, methods, options));
        result.figures.push_back(late_figure(scene, methods, options));
    }
    return result;
}

}  // namespace burnish
