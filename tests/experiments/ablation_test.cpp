// The rows of the ablation: each option has one, and stands beside the default.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "experiments/ablation.h"
#include "experiments/experiments.h"
#include "experiments/parameterizations.h"
#include "experiments/small_target_scene.h"
#include "experiments/unique_rows.h"

namespace burnish {
namespace {

/// The ablation of one scene, which keeps its study.
struct AblationRun {
    ReproduceOptions options = test::small_options();
    std::vector<TargetScene> scenes;
    ExperimentResult result;

    explicit AblationRun(TargetScene scene, std::uint32_t runs = test::small_options().runs) {
        options.runs = runs;
        scenes.push_back(std::move(scene));
        result = run_ablation(scenes, options, {[](const std::string&) {}, {}});
    }
    const TargetScene& scene() const { return scenes[0]; }
    std::map<std::string, double> values(const std::string& metric) const {
        std::map<std::string, double> by_variant;
        for (const Measurement& m : result.measurements)
            if (m.metric == metric) by_variant[m.variant] = m.value;
        return by_variant;
    }
    DerivativeEstimate estimate(const Estimator& estimator, std::uint32_t seed) const {
        return estimate_along(scene().traced(), scene().study->trajectory, estimator, seed);
    }
    double nmse(const DerivativeEstimate& e) const {
        return derivative_error(e.gradient, scene().study->reference).nmse;
    }
    double nmse(const Estimator& estimator) const {
        return nmse(estimate(estimator, estimate_seed(options)));
    }
    double cache_nmse(LightSelection selection, Sequence sequence) const {
        PathCache cache;
        cache.sequence = sequence;
        return nmse(estimate_along(prepare(scene().scene(), selection), scene().study->trajectory,
                                   cache, estimate_seed(options)));
    }
};

AblationRun small_run() { return AblationRun(test::small_target_scene(test::small_options())); }

TEST(Ablation, EveryOptionHasARowBesideTheDefault) {
    const AblationRun run = small_run();
    test::expect_unique_rows(run.result);
    const auto nmse = run.values("nmse"), seconds = run.values("derivative_seconds");
    const auto& rows = run.result.figures.at(0).tables.at(0).rows;
    const auto has_row = [&](const std::string& name) {
        return std::any_of(rows.begin(), rows.end(),
                           [&](const auto& row) { return row.at(1) == name; });
    };
    std::set<double> different{nmse.at("pgris: positivized, reuse, run 0"),
                               nmse.at("path cache: Sobol numbers, lights uniformly")};
    for (const char* name : {"mc: no resampling, no reuse", "identity shift",
                             "target: the integrand", "defensive weights", "mc, adaptive sampling",
                             "pgris, adaptive sampling", "path cache: independent numbers",
                             "path cache: lights by power", "path cache: lights by a tree"}) {
        EXPECT_TRUE(has_row(name)) << name;
        EXPECT_GT(nmse.at(name), 0) << name;
        EXPECT_TRUE(different.insert(nmse.at(name)).second) << name << " is another variant";
        EXPECT_GT(seconds.at(name), 0) << name;
    }
}

TEST(Ablation, RowsAreWhatTheyAreCalled) {
    const AblationRun run = small_run();
    const auto nmse = run.values("nmse");
    const Reservoirs paper = paper_estimator(run.scene(), run.options);
    EXPECT_EQ(nmse.at("pgris: positivized, reuse, run 0"), run.nmse(paper));
    Reservoirs adaptive = paper;
    adaptive.adaptive_sampling = true;
    EXPECT_EQ(nmse.at("pgris, adaptive sampling"), run.nmse(adaptive));
    MonteCarlo mc = baseline_estimator();
    EXPECT_EQ(nmse.at("mc: no resampling, no reuse"), run.nmse(mc));
    mc.adaptive_sampling = true;
    EXPECT_EQ(nmse.at("mc, adaptive sampling"), run.nmse(mc));
    EXPECT_EQ(nmse.at("path cache: Sobol numbers, lights uniformly"),
              run.cache_nmse(LightSelection::kUniform, PathCache{}.sequence));
    EXPECT_EQ(nmse.at("path cache: independent numbers"),
              run.cache_nmse(LightSelection::kUniform, Sequence::kIndependent));
    EXPECT_EQ(nmse.at("path cache: lights resampled"),
              run.cache_nmse(LightSelection::kResampled, PathCache{}.sequence));
    EXPECT_EQ(nmse.at("path cache: lights by power"),
              run.cache_nmse(LightSelection::kPower, PathCache{}.sequence));
    EXPECT_EQ(nmse.at("path cache: lights by a tree"),
              run.cache_nmse(LightSelection::kTree, PathCache{}.sequence));
    for (const auto& [name, positivization, reuse] :
         {std::tuple{"ris: |q|, no reuse", false, false},
          {"pris: positivized, no reuse, run 0", true, false},
          {"gris: |q|, reuse, run 0", false, true}}) {
        Reservoirs part = paper;
        part.positivization = positivization, part.reuse = reuse;
        EXPECT_EQ(nmse.at(name), run.nmse(part)) << name;
    }
}

// Runs with seeds of their own, whose ratios decide.
TEST(Ablation, ItsVerdictIsThatOfIntervals) {
    const AblationRun run = small_run();
    const auto nmse = run.values("nmse");
    const auto ratio = [&](const std::string& other) {
        std::vector<double> ratios;
        for (const char* of_run : {", run 0", ", run 1", ", run 2"})
            ratios.push_back(nmse.at(std::string("pgris: positivized, reuse") + of_run) /
                             nmse.at(other + of_run));
        return ratio_interval(ratios);
    };
    const RatioInterval reuse = ratio("pris: positivized, no reuse"),
                        positivization = ratio("gris: |q|, reuse");
    EXPECT_LT(reuse.high, INFINITY);
    const Figure& f = run.result.figures.at(0);
    EXPECT_EQ(f.verdict,
              verdict_of_parts(verdict_below_one(positivization), verdict_below_one(reuse)));
    for (const std::string& text :
         {"over that of pris, by reuse: " + text_of(reuse),
          "over that of gris, by positivization: " + text_of(positivization), interval_text(3)})
        EXPECT_NE(f.measured.find(text), std::string::npos) << text << "\n" << f.measured;
}

TEST(Ablation, OneRunDecidesNothing) {
    const AblationRun run(test::small_target_scene(test::small_options()), 1);
    const Figure& f = run.result.figures.at(0);
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    EXPECT_NE(f.measured.find("one run, no interval"), std::string::npos) << f.measured;
    // Its ratios are explained where they are against the claim.
    const auto nmse = run.values("nmse");
    const double pgris = nmse.at("pgris: positivized, reuse, run 0");
    const bool is_against = pgris > nmse.at("pris: positivized, no reuse, run 0") ||
                            pgris > nmse.at("gris: |q|, reuse, run 0");
    EXPECT_EQ(f.why.empty(), !is_against) << f.measured << f.why;
}

TEST(Ablation, SaysWhyOfWhatDoesNotHoldOrNotAllOfIt) {
    const RatioInterval below{0.6, 0.5, 0.9}, around{0.8, 0.6, 1.1}, above{1.6, 1.1, 1.9};
    EXPECT_EQ(ablation_reason(below, below), "");
    EXPECT_EQ(ablation_reason(around, around), "") << "undecided";
    EXPECT_EQ(ablation_reason(around, below),
              "The interval of positivization holds 1: more runs or larger pictures would decide.");
    EXPECT_EQ(ablation_reason(below, around),
              "The interval of reuse holds 1: more runs or larger pictures would decide.");
    EXPECT_EQ(ablation_reason({std::nan("")}, below),
              "The noise of the converged derivative hides what positivization does.");
    EXPECT_TRUE(ablation_reason(above, below).starts_with("A second reservoir"));
    EXPECT_TRUE(ablation_reason(below, above).starts_with("The textures move"));
    EXPECT_NE(ablation_reason(above, above).find("as well. The textures"), std::string::npos);
}

TEST(Ablation, HasARowForEachParameterization) {
    const AblationRun run = small_run();
    const Table& table = run.result.figures.at(0).tables.at(1);
    std::set<std::string> names, errors;
    for (const auto& row : table.rows) {
        ASSERT_EQ(row.size(), table.head.size());
        names.insert(row[0]);
        errors.insert(row[4]);
    }
    EXPECT_EQ(names, (std::set<std::string>{"start", "texels", "pyramid"}));
    EXPECT_EQ(errors.size(), 3u) << "each moves the texture in its own way";
    const auto& measurements = run.result.measurements;
    for (const char* metric : {"loss", "iterations"})
        EXPECT_EQ(std::count_if(measurements.begin(), measurements.end(),
                                [&](const Measurement& m) {
                                    return m.metric == metric && m.value > 0 &&
                                           m.variant.starts_with("parameterization: ");
                                }),
                  2)
            << metric;
}

TEST(Ablation, SaysWhatParameterizationsLeaveOfTheLoss) {
    ParameterizationStudy study{.loss = 0.5, .texture_error = 0.25, .truth_loss = 0.1, .ends = {}};
    study.ends = {{"texels", 3, 0.5, 0.25}, {"pyramid", 4, 0.11, 0.125}};
    EXPECT_EQ(parameterization_text(study, 0.005),
              "After 0.005 s of the path cache texels leaves 100 % of the loss (texture error "
              "0.250), pyramid leaves 2.5 % of the loss (texture error 0.125); the texture error "
              "at the start was 0.250.");
    EXPECT_EQ(parameterization_table(study).rows[1][3], "100 %");
    study.ends[1].loss = 0.05;  // below that of the truth
    EXPECT_EQ(left_of(study, study.ends[1]), 0);
    study.ends[1].loss = NAN;
    EXPECT_TRUE(std::isnan(left_of(study, study.ends[1])));
    study.truth_loss = 0.6;
    EXPECT_TRUE(std::isnan(left_of(study, study.ends[0])));
    EXPECT_EQ(parameterization_table(study).rows[1][3], "too noisy to tell");
    EXPECT_NE(parameterization_text(study, 1).find("texels leaves a loss too noisy to tell (te"),
              std::string::npos);
}

// The noise of an image depends on its texture: that of the truth is not that of the others.
TEST(Ablation, LossesOfParameterizationsAreWithoutNoise) {
    ReproduceOptions options = test::small_options();
    options.sweep_seconds = 0;
    const TargetScene scene = test::small_target_scene(options);
    const ParameterizationStudy study =
        study_parameterizations(scene, options, {[](const std::string&) {}, {}});
    Options run;
    run.parameterization = Parameterization::kTexels;
    run.seed = options.seed;
    const auto evaluation_of = [&](Start start) {
        return Solver(problem_of(scene, std::move(start)), run)
            .evaluate(options.evaluation_samples);
    };
    const Evaluation start = evaluation_of(0.5f), truth = evaluation_of(scene.truth);
    ASSERT_GT(start.noise_floor, 0);
    EXPECT_EQ(study.loss, start.loss - start.noise_floor);
    EXPECT_EQ(study.truth_loss, truth.loss - truth.noise_floor);
    EXPECT_EQ(study.ends.at(0).loss, study.loss) << "no step was made";
}

TEST(Ablation, ErrorsThatTheReferenceHidesTellNothing) {
    ReproduceOptions options = test::small_options();
    options.runs = 2;
    TargetScene scene = test::small_target_scene(options);
    scene.study = test::study_of_noise(scene, options);
    const Figure f = AblationRun(std::move(scene), options.runs).result.figures.at(0);
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    EXPECT_NE(f.measured.find("mc too noisy to tell, ris too noisy to tell"), std::string::npos)
        << f.measured;
    EXPECT_EQ(f.measured.find("nan"), std::string::npos) << f.measured;
    EXPECT_EQ(f.measured.find("too noisy to tell times"), std::string::npos) << f.measured;
    EXPECT_EQ(f.measured.find("too noisy to tell of"), std::string::npos) << f.measured;
    EXPECT_EQ(f.why, "");
}

/// Caps that no history of so few iterations reaches are not run again.
TEST(Ablation, CapsEndWhereNoneIsReached) {
    const AblationRun run = small_run();
    const auto nmse = run.values("nmse");
    EXPECT_TRUE(nmse.contains("M_cap 4"));
    EXPECT_TRUE(nmse.contains("M_cap 8, defensive")) << "the first above 5 iterations";
    EXPECT_FALSE(nmse.contains("M_cap 16"));

    const auto gradient = [&](float cap) {
        Reservoirs o = paper_estimator(run.scene(), run.options);
        o.confidence_cap = cap;
        return run.estimate(o, estimate_seed(run.options)).gradient;
    };
    EXPECT_EQ(gradient(8), gradient(64));
    EXPECT_NE(gradient(8), gradient(4));
}

/// With one emitter every way to choose is the same, and has no row.
TEST(Ablation, OneLightIsNotChosen) {
    TargetScene scene = test::small_target_scene(test::small_options());
    Scene one_light = scene.scene();
    ASSERT_GT(one_light.emitters.size(), 1u);
    one_light.emitters = {ConstantEmitter{}};
    for (Shape& shape : one_light.shapes) shape.emitter = {};
    scene.renderer = make_renderer(std::move(one_light));
    const AblationRun run(std::move(scene));
    for (const Measurement& m : run.result.measurements)
        EXPECT_EQ(m.variant.find("lights by"), std::string::npos) << m.variant;
}

}  // namespace
}  // namespace burnish
