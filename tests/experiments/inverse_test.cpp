// The runs of `inverse`: each goes on until it has passed its budgets, and is evaluated as it does.
#include "experiments/inverse_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "experiments/ablation.h"
#include "experiments/interval.h"
#include "experiments/small_target_scene.h"
#include "experiments/unique_rows.h"
#include "temporary_folder.h"

namespace burnish {
namespace {

double value_of(const ExperimentResult& result, const std::string& variant,
                const std::string& metric) {
    for (const Measurement& m : result.measurements)
        if (m.variant == variant && m.metric == metric) return m.value;
    ADD_FAILURE() << variant << ": " << metric;
    return 0;
}

bool has_rows(const ExperimentResult& result, const std::string& variant) {
    return std::ranges::any_of(result.measurements,
                               [&](const Measurement& m) { return m.variant == variant; });
}

TEST(Inverse, RunsPassEachOfTheirBudgets) {
    ReproduceOptions options = test::small_options();
    options.runs = 2;
    options.budget = {
        .iterations = 6, .long_iterations = 40, .derivative_seconds = 1e-3, .seconds = 2e-3};
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    const WorkNote silent{[](const std::string&) {}, {}};
    const ExperimentResult result = run_inverse(scenes, options, silent);
    test::expect_unique_rows(result);

    for (const Method& m : planned_runs(scenes[0], options).methods)
        for (const std::string run : {"run 0", "run 1"}) {
            const auto at = [&](const char* budget, const char* metric) {
                return value_of(result, m.name + ", " + run + ", budget of " + budget, metric);
            };
            EXPECT_EQ(at("iterations", "iterations"), 6) << m.name;
            const std::string of_long = m.name + ", " + run + ", budget of long_iterations";
            EXPECT_EQ(has_rows(result, of_long), m.is_long) << "others stop before";
            if (m.is_long) {
                EXPECT_EQ(at("long_iterations", "iterations"), 40) << m.name;
            }
            EXPECT_GE(at("derivative_seconds", "derivative_seconds"), 1e-3) << m.name;
            EXPECT_GE(at("seconds", "seconds"), 2e-3) << m.name;
            if (!m.is_late) continue;
            EXPECT_GE(at("two thirds of derivative_seconds", "derivative_seconds"), 2e-3 / 3)
                << m.name;
        }
    for (const Figure& f : result.figures)
        EXPECT_NE(f.measured.find("with 95 % intervals over 2 runs"), std::string::npos)
            << f.measured;
    EXPECT_NE(value_of(result, "mc, run 0, budget of long_iterations", "loss"),
              value_of(result, "mc, run 0, budget of iterations", "loss"));

    const Table& table = result.figures.at(0).tables.at(0);
    const auto head = std::find(table.head.begin(), table.head.end(), "loss after 40 iterations");
    ASSERT_NE(head, table.head.end());
    const auto column = static_cast<std::size_t>(head - table.head.begin());
    for (const auto& row : table.rows) {
        const bool is_long = row[0] == "mc" || row[0] == "pgris, replay";
        ASSERT_EQ(row.size(), table.head.size()) << row[0];
        EXPECT_EQ(row[column].empty(), !is_long) << row[0];
    }

    // Figure 7: a third of the image's sides, and of the texture's.
    const auto& rows = result.figures.at(1).pictures;
    ASSERT_EQ(rows.size(), 2u);
    for (const auto& [row, side] : {std::pair{&rows[0], 8}, std::pair{&rows[1], 10}}) {
        ASSERT_EQ(row->size(), 3u);
        for (const Picture& picture : *row) {
            EXPECT_EQ(picture.image.width, side) << picture.name;
            EXPECT_EQ(picture.image.height, side) << picture.name;
        }
        EXPECT_NE((*row)[0].image, (*row)[1].image);
        EXPECT_NE((*row)[1].image, (*row)[2].image);
    }
    EXPECT_EQ(rows[0][0].name.find("gris, replay"), 0u);
    EXPECT_EQ(rows[0][2].name, "target");
    EXPECT_EQ(rows[1][0].name, "truth");
}

// A run that is stopped goes on to what it would have become: the budgets here are of iterations,
// since those of seconds have a clock.
TEST(Inverse, AStoppedRunGoesOn) {
    ReproduceOptions options = test::small_options();
    options.budget = {
        .iterations = 6, .long_iterations = 20, .derivative_seconds = 0, .seconds = 0};
    const TargetScene scene = test::small_target_scene(options);
    const WorkNote silent{[](const std::string&) {}, {}};
    for (const Method& method : planned_runs(scene, options).methods) {
        SCOPED_TRACE(method.name);
        const test::TemporaryFolder temporary;
        const std::filesystem::path folder = temporary.path / "checkpoints";
        const std::uint32_t all = method.is_long ? 20 : 6;
        const burnish::Run whole = run_method(scene, method, options, 1, silent).value();
        ASSERT_EQ(whole.losses.points.size(), all);

        RunKeeper keeper;
        bool stops = false;
        keeper.checkpoints.folder = folder.string();
        keeper.checkpoints.stop = [&] { return stops; };
        std::array<std::optional<Moment>, kMoments> moments;
        std::vector<std::uint32_t> passed_at;
        keeper.keep = [&](std::size_t at, const Moment& m) {
            moments[at] = m, passed_at.push_back(m.iteration);
        };
        // At the first budgets, then at the end of some iterations of a later one.
        const WorkNote stopping{[](const std::string&) {},
                                [&, count = 0u](double) mutable { stops = ++count % 4 == 0; }};
        std::optional<burnish::Run> run;
        std::uint32_t parts = 0;
        for (; !run && parts < 20; ++parts) {
            stops = false;
            if (parts > 0) keeper.from = load_checkpoint(folder.string());
            keeper.moments = moments;
            run = run_method(scene, method, options, 1, stopping, &keeper);
        }
        ASSERT_TRUE(run);
        EXPECT_GE(parts, method.is_long ? 3u : 2u);
        EXPECT_EQ(passed_at, (std::vector<std::uint32_t>{1, 1, 1, 6, all}));
        ASSERT_EQ(run->losses.points.size(), all);
        for (std::size_t i = 0; i < all; ++i)
            EXPECT_EQ(run->losses.points[i].y, whole.losses.points[i].y) << i;
        for (const At at : {kIterations, kLong}) {
            EXPECT_EQ(run->at[at].iteration, whole.at[at].iteration);
            EXPECT_EQ(run->at[at].loss, whole.at[at].loss);
            EXPECT_EQ(run->at[at].texture_error, whole.at[at].texture_error);
            EXPECT_EQ(run->at[at].step_length, whole.at[at].step_length);
        }
        EXPECT_EQ(run->at[kClock].iteration, 1u);

        // Without a moment that it has passed it begins again.
        keeper.from = load_checkpoint(folder.string());
        double seconds = 0;  // the path cache differentiates the paths of its image
        for (const Iteration& i : keeper.from->run.iterations)
            seconds += i.derivative_seconds + (method.name == "path cache" ? i.image_seconds : 0);
        EXPECT_EQ(run->losses.points.back().x, seconds);
        keeper.moments = {};
        stops = false;
        const burnish::Run again = run_method(scene, method, options, 1, silent, &keeper).value();
        EXPECT_EQ(again.losses.points.size(), all);
        EXPECT_EQ(again.at[kLong].loss, whole.at[kLong].loss);
    }
}

// What slows the machine down for a while slows both runs of a ratio.
TEST(Inverse, RunsOfOneSeedAreMadeOneAfterTheOther) {
    ReproduceOptions options = test::small_options();
    options.runs = 2;
    const TargetScene scene = test::small_target_scene(options);
    std::vector<std::pair<std::uint32_t, std::string>> order, expected;
    const auto runs = make_runs(scene, options, [&](const Method& method, std::uint32_t k) {
        order.emplace_back(k, method.name);
        burnish::Run run;
        run.seconds = k + 1.0;
        return std::optional(run);
    });
    for (const std::uint32_t k : {0u, 1u})
        for (const Method& m : planned_runs(scene, options).methods)
            expected.emplace_back(k, m.name);
    EXPECT_EQ(order, expected);
    for (const Method& m : runs->methods) {
        ASSERT_EQ(m.runs.size(), 2u) << m.name;
        EXPECT_EQ(m.runs[0].seconds, 1) << m.name;
        EXPECT_EQ(m.runs[1].seconds, 2) << m.name;
    }
}

TEST(Inverse, GoingOnIsDecidedByWholeIntervals) {
    const RatioInterval below{0.8, 0.7, 0.89}, around{1, 0.91, 1.1}, above{1.2, 1.1, 1.3},
        noise{NAN, 0, INFINITY};
    EXPECT_EQ(late_verdict(around, below, below), Verdict::kHolds);
    EXPECT_EQ(late_verdict(above, below, below), Verdict::kHolds);
    EXPECT_EQ(late_verdict(around, below, around), Verdict::kUndecided);
    EXPECT_EQ(late_verdict(noise, below, noise), Verdict::kUndecided);
    EXPECT_EQ(late_verdict(around, around, below), Verdict::kUndecided);
    EXPECT_EQ(late_verdict(around, above, around), Verdict::kFails);
    EXPECT_EQ(late_verdict(around, below, above), Verdict::kFails);
    EXPECT_EQ(late_verdict(below, below, below), Verdict::kFails) << "mc has not converged";
    EXPECT_EQ(late_verdict(below, around, below), Verdict::kUndecided);
    // mc has converged where its loss falls by less than a tenth, and where the interval says so.
    const RatioInterval hardly{0.95, 0.91, 0.99}, wide{0.95, 0.8, 1.1};
    EXPECT_EQ(late_verdict(hardly, below, below), Verdict::kHolds);
    EXPECT_EQ(late_verdict(wide, below, below), Verdict::kUndecided);
    EXPECT_EQ(late_verdict(noise, below, below), Verdict::kUndecided);
    EXPECT_EQ(late_verdict({.ratio = 1}, below, below), Verdict::kUndecided) << "a single run";
}

/// A run that was evaluated after 8 iterations at kLate and after so many at kDerivative.
burnish::Run run_of_losses(double late, double end, std::uint32_t iterations) {
    burnish::Run run;
    run.at[kLate].loss = late, run.at[kLate].iteration = 8;
    run.at[kDerivative].loss = end, run.at[kDerivative].iteration = iterations;
    return run;
}

TEST(Inverse, LateChangesAreThoseOfTheEvaluatedTextures) {
    Method method{"mc", baseline_estimator()};
    method.runs = {run_of_losses(0.4, 0.1, 10), run_of_losses(0.4, 0.4, 9)};
    EXPECT_EQ(late_changes(method), (std::vector<double>{0.25, 1}));
    method.runs = {run_of_losses(0.4, 0.1, 8), run_of_losses(0.4, -0.1, 10),
                   run_of_losses(-0.4, 0.1, 10)};
    for (const double change : late_changes(method)) EXPECT_TRUE(std::isnan(change)) << change;
}

/// The losses of pgris as it passes its budgets.
using PgrisLosses = std::array<double, 4>;

/// A run that nobody made. mc has losses of 1, and its iterations take half of the time. At kLate
/// mc has `late_of_mc`, all others what they have at kDerivative. The losses of iterations fall in
/// any case. Two methods go on to twice the time of the derivative; the path cache has one
/// iteration.
burnish::Run invented_run(const Method& method, const ReproduceOptions& options,
                          const PgrisLosses& losses, double late_of_mc) {
    const bool is_pgris = method.name.starts_with("pgris");
    burnish::Run run;
    for (std::size_t at = 0; at < kMoments; ++at) {
        Moment& m = run.at[at];
        m.iteration = at == kLate ? 7 : 10, m.derivative_seconds = is_pgris ? 0.02 : 0.01;
        m.loss = is_pgris ? losses[at == kLate ? kDerivative : at] : 1;
        if (at == kLate && method.name == "mc") m.loss = late_of_mc;
        m.noise_floor = 0.5 * static_cast<double>(at + 1);
        m.step_length = is_pgris ? 0.5 : 0.25;
    }
    run.losses.name = method.name;
    const int count = method.name == "path cache" ? 1 : method.is_long ? 100 : 50;
    const double step = options.budget.derivative_seconds / 50;
    for (int i = 1; i <= count; ++i) run.losses.points.push_back({i * step, 1.0 / i});
    return run;
}

/// What is said of invented runs, one for each of the losses. of_identity: the loss of pgris with
/// the identity shift at kDerivative, if it is another.
std::vector<Figure> figures_of_runs(const std::vector<PgrisLosses>& losses,
                                    const Budget& budget = {8, 40, 0.05, 0.1},
                                    double late_of_mc = 1, std::optional<double> of_identity = {}) {
    ReproduceOptions options = test::small_options();
    options.runs = static_cast<std::uint32_t>(losses.size());
    options.budget = budget;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    scenes[0].runs = make_runs(scenes[0], options, [&](const Method& method, std::uint32_t k) {
        burnish::Run run = invented_run(method, options, losses[k], late_of_mc);
        if (of_identity && method.name == "pgris, identity")
            run.at[kDerivative].loss = *of_identity;
        return std::optional(run);
    });
    return run_inverse(scenes, options, {[](const std::string&) {}, {}}).figures;
}

/// The same of one run.
std::vector<Figure> figures_of(const PgrisLosses& losses,
                               const Budget& budget = {8, 40, 0.05, 0.1}) {
    return figures_of_runs({losses}, budget);
}

// At the paper's size there is one run, and no verdict.
TEST(Inverse, ASingleRunThatIsBehindHasAReason) {
    const auto why = [](const PgrisLosses& losses) { return figures_of(losses).at(0).why; };
    const auto has = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    const char* steps = "moves a texel by 0.25 of the learning rate with mc and by 0.50 with pgris";
    const char* costs = "mc makes 2.0 steps in the time of one of pgris with replay.";
    EXPECT_EQ(why({0.5, 0.5, 0.5, 0.5}), "");

    const std::string always = why({2, 2, 2, 2}), in_time = why({0.5, 0.5, 2, 2}),
                      late = why({0.5, 2, 0.5, 0.5});
    EXPECT_TRUE(always.starts_with("At equal iterations, too. Steps of Adam")) << always;
    EXPECT_TRUE(has(always, steps) && has(always, costs)) << always;
    EXPECT_TRUE(in_time.starts_with("On a CPU")) << in_time;
    EXPECT_TRUE(has(in_time, costs)) << in_time;
    EXPECT_TRUE(late.starts_with("After 40 iterations the loss of pgris with replay is the higher"))
        << late;
    EXPECT_TRUE(has(late, steps) && !has(late, "On a CPU")) << late;

    // gris has losses of 1.
    const auto of_positivization = [](double loss) {
        return figures_of({loss, 1, 1, 1}).at(1).why;
    };
    EXPECT_EQ(of_positivization(2), kPositivizationReason);
    EXPECT_EQ(of_positivization(0.5), "");
}

// Single runs: mc falls to half of its loss, or stays as it is.
TEST(Inverse, TexturesThatStayDoNotGoOnThoughTheNoiseOfIterationsFalls) {
    const auto late = [](double loss_of_mc) {
        return figures_of_runs({{1, 1, 1, 1}}, {8, 40, 0.05, 0.1}, loss_of_mc).at(2);
    };
    EXPECT_EQ(late(1).measured,
              "The loss after 0.05 s of derivatives over that after two thirds of them, one run, "
              "no interval: mc 1.00, pgris with replay 1.00, with the identity shift 1.00. That of "
              "pgris with replay over that of mc, run by run: 1.00. A ratio of mc above 0.9 "
              "counts as converged.");
    EXPECT_EQ(late(1).why, "");
    EXPECT_EQ(late(1.08).why, "") << "it falls by less than a tenth";
    EXPECT_EQ(late(2).why,
              "mc has not converged within this budget: its loss falls, too, to 0.50 of that after "
              "two thirds of it.");
    EXPECT_NE(late(-1).measured.find("mc too few iterations or too much noise to tell, pgris"),
              std::string::npos)
        << late(-1).measured;
}

// Of several runs the interval decides, as for the verdict.
TEST(Inverse, RunsThatDifferSayNothingOfEqualIterations) {
    const auto why = [](double first, double second) {
        return figures_of_runs({{first, 2, 2, 2}, {second, 2, 2, 2}}).at(0).why;
    };
    EXPECT_TRUE(why(2, 2.1).starts_with("At equal iterations, too.")) << why(2, 2.1);
    EXPECT_TRUE(why(0.9, 1.3).starts_with("After 40 iterations the loss of pgris with replay"))
        << why(0.9, 1.3);
}

TEST(Inverse, WhatIsOpenOfReplayIsNoMatterOfCosts) {
    const auto figure = [](const PgrisLosses& first, const PgrisLosses& second) {
        return figures_of_runs({first, second}, {8, 40, 0.05, 0.1}, 1, 0.01).at(0);
    };
    const Figure open = figure({2, 0.5, 0.9, 1}, {2, 0.5, 1.3, 1});
    EXPECT_EQ(open.verdict, Verdict::kPartly);
    EXPECT_EQ(open.why, "The interval of replay holds 1: more runs would decide.");
    const Figure noisy = figure({2, 0.5, -1, 1}, {2, 0.5, 1.3, 1});
    EXPECT_EQ(noisy.verdict, Verdict::kPartly);
    EXPECT_EQ(noisy.why, "The noise of the evaluation hides what replay does.");
    const std::string late = figure({2, 2, 0.9, 1}, {2, 2, 1.3, 1}).why;
    EXPECT_TRUE(
        late.starts_with("The interval of replay holds 1: more runs would decide. After 40 "
                         "iterations the loss of pgris with replay is the higher one."))
        << late;
}

TEST(Inverse, ItsPlotsHaveACurveForEachMethod) {
    const std::vector<Figure> figures = figures_of({1, 1, 1, 1});
    const Plot &equal_time = figures.at(0).plots.at(0), &late = figures.at(2).plots.at(0);
    for (const Plot* plot : {&equal_time, &late}) {
        ASSERT_EQ(plot->curves.size(), 5u);
        EXPECT_EQ(plot->curves[kReplay].name, "pgris, replay");
        EXPECT_TRUE(plot->curves[kCache].points.empty()) << "one iteration is no curve";
    }
    for (const std::size_t k : {kMc, kGris, kReplay, kIdentity}) {
        ASSERT_FALSE(equal_time.curves[k].points.empty()) << k;
        EXPECT_LT(equal_time.curves[k].points.back().x, 0.0525) << k;
        const bool is_long = k == kMc || k == kReplay;
        ASSERT_EQ(late.curves[k].points.empty(), !is_long) << k;
        if (!is_long) continue;
        EXPECT_GT(late.curves[k].points.back().x, 0.09) << k;
    }
}

TEST(Inverse, EachLossStandsBesideItsNoiseFloor) {
    const Table table = figures_of({1, 1, 1, 1}).at(0).tables.at(0);
    EXPECT_EQ(table.head.at(1), "iterations after 0.1 s");
    EXPECT_EQ(table.head.at(2), "texture error after 0.1 s");
    const std::vector<const char*> losses{"loss after 8 iterations", "loss after 40 iterations",
                                          "loss after 0.05 s of derivatives", "loss after 0.1 s"};
    const std::vector<const char*> floors{"0.5", "1", "1.5", "2"};
    ASSERT_EQ(table.head.size(), 3 + 3 * losses.size());
    for (const auto& row : table.rows) ASSERT_EQ(row.size(), table.head.size()) << row[0];
    for (std::size_t at = 0; at < losses.size(); ++at) {
        const std::size_t column = 3 + 3 * at;
        EXPECT_EQ(table.head[column], losses[at]);
        EXPECT_EQ(table.head[column + 1], "its noise floor");
        EXPECT_EQ(table.rows[kMc][column + 1], floors[at]);
        EXPECT_EQ(table.rows[kGris][column + 1], at == kLong ? "" : floors[at]);
    }
}

TEST(Inverse, OneIterationAndShortTimesAreSaidAsTheyAre) {
    const std::vector<Figure> figures = figures_of({1, 1, 1, 1}, {1, 2, 0.05, 0.1});
    const Figure &equal_time = figures.at(0), &positivization = figures.at(1);
    EXPECT_NE(equal_time.measured.find("After 1 iteration: "), std::string::npos)
        << equal_time.measured;
    EXPECT_NE(equal_time.measured.find("After 2 iterations mc has "), std::string::npos);
    EXPECT_NE(positivization.measured.find(" after 1 iteration, "), std::string::npos)
        << positivization.measured;
    EXPECT_EQ(equal_time.tables.at(0).head.at(3), "loss after 1 iteration");
    EXPECT_EQ(equal_time.pictures.at(0).at(0).name, "mc, 0.01 s of derivatives");
}

// The first step of Adam has the length of the rate; later ones average gradients that differ.
TEST(Inverse, StepsAreMeasuredInRates) {
    ReproduceOptions options = test::small_options();
    options.budget = {.iterations = 1, .long_iterations = 1, .derivative_seconds = 0, .seconds = 0};
    const TargetScene scene = test::small_target_scene(options);
    const WorkNote silent{[](const std::string&) {}, {}};
    const auto length = [&](std::size_t method) {
        const Method m = planned_runs(scene, options).methods[method];
        return run_method(scene, m, options, 0, silent)->at[kIterations].step_length;
    };
    EXPECT_NEAR(length(kMc), 1, 1e-4);
    options.budget.iterations = options.budget.long_iterations = 30;
    EXPECT_GT(length(kMc), 0);
    EXPECT_LT(length(kMc), 0.5);
    EXPECT_GT(length(kReplay), length(kMc));
}

}  // namespace
}  // namespace burnish
