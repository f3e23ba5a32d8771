// The rows of the ablation: each option has one, and stands beside the default.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "experiments/experiments.h"
#include "experiments/small_subject.h"

namespace burnish {
namespace {

TEST(Ablation, EveryOptionHasARowBesideTheDefault) {
    const ReproduceOptions options = test::small_options();
    std::vector<std::unique_ptr<Subject>> subjects;
    subjects.push_back(test::small_subject(options));
    const Subject& subject = *subjects[0];
    const ExperimentResult result =
        run_ablation(subjects, options, {[](const std::string&) {}, {}});

    std::map<std::string, double> nmse, seconds;
    for (const Measurement& m : result.measurements) {
        if (m.metric == "nmse") nmse[m.variant] = m.value;
        if (m.metric == "derivative_seconds") seconds[m.variant] = m.value;
    }
    const auto has_row = [&](const std::string& name) {
        return std::any_of(result.figures.at(0).tables.at(0).rows.begin(),
                           result.figures.at(0).tables.at(0).rows.end(),
                           [&](const auto& row) { return row.at(1) == name; });
    };
    const double paper = nmse.at("pgris: positivized, reuse"),
                 standard = nmse.at("pool: Sobol numbers, lights uniformly");
    std::set<double> different{paper, standard};
    for (const char* name :
         {"mc: no resampling, no reuse", "identity shift", "target: the integrand",
          "defensive weights", "mc, pixels by their part", "pgris, pixels by their part",
          "pool: independent numbers", "pool: lights by power", "pool: lights by a tree"}) {
        EXPECT_TRUE(has_row(name)) << name;
        EXPECT_GT(nmse.at(name), 0) << name;
        EXPECT_TRUE(different.insert(nmse.at(name)).second) << name << " is another variant";
        EXPECT_GT(seconds.at(name), 0) << name;
    }

    // The rows are what they are called.
    const Study& study = *subject.study;
    const auto error_of = [&](const DerivativeEstimate& e) {
        return derivative_error(e.gradient, study.reference.gradient).nmse;
    };
    const auto pool_error = [&](LightSelection selection, Sequence sequence) {
        PoolOptions pool;
        pool.sequence = sequence;
        return error_of(estimate_pool_along(prepare(subject.loaded.scene, selection),
                                            study.trajectory, pool, options.seed + 1));
    };
    for (const Estimator e : {Estimator::kMc, Estimator::kPgris}) {
        GradientOptions adaptive = paper_options(subject, options).gradient;
        adaptive.estimator = e;
        adaptive.pixels = PixelChoice::kAdaptive;
        EXPECT_EQ(nmse.at(std::string(name_of(e)) + ", pixels by their part"),
                  error_of(estimate_along(*subject.traced, study.trajectory, adaptive)));
    }
    const PoolOptions pool;
    EXPECT_EQ(standard, pool_error(kDefaultLightSelection, pool.sequence));
    EXPECT_EQ(nmse.at("pool: independent numbers"),
              pool_error(kDefaultLightSelection, Sequence::kIndependent));
    EXPECT_EQ(nmse.at("pool: lights by power"), pool_error(LightSelection::kPower, pool.sequence));
    EXPECT_EQ(nmse.at("pool: lights by a tree"), pool_error(LightSelection::kTree, pool.sequence));
    EXPECT_EQ(paper, error_of(estimate_along(*subject.traced, study.trajectory,
                                             paper_options(subject, options).gradient)));
}

TEST(Ablation, HasARowForEachParameterization) {
    const ReproduceOptions options = test::small_options();
    std::vector<std::unique_ptr<Subject>> subjects;
    subjects.push_back(test::small_subject(options));
    const ExperimentResult result =
        run_ablation(subjects, options, {[](const std::string&) {}, {}});
    const Table& table = result.figures.at(0).tables.at(1);
    std::set<std::string> names, errors;
    for (const auto& row : table.rows) {
        ASSERT_EQ(row.size(), table.head.size());
        names.insert(row[0]);
        errors.insert(row[4]);
    }
    EXPECT_EQ(names, (std::set<std::string>{"start", "texels", "pyramid", "smooth"}));
    EXPECT_EQ(errors.size(), 4u) << "each moves the texture in its own way";
    for (const char* metric : {"loss", "iterations"})
        EXPECT_EQ(std::count_if(result.measurements.begin(), result.measurements.end(),
                                [&](const Measurement& m) {
                                    return m.metric == metric && m.value > 0 &&
                                           m.variant.starts_with("parameterization: ");
                                }),
                  3)
            << metric;
}

/// Caps that no history of so few iterations reaches are not run again.
TEST(Ablation, CapsEndWhereNoneIsReached) {
    ReproduceOptions options = test::small_options();
    std::vector<std::unique_ptr<Subject>> subjects;
    subjects.push_back(test::small_subject(options));
    const ExperimentResult result =
        run_ablation(subjects, options, {[](const std::string&) {}, {}});
    std::set<std::string> variants;
    for (const Measurement& m : result.measurements) variants.insert(m.variant);
    EXPECT_TRUE(variants.contains("M_cap 4"));
    EXPECT_TRUE(variants.contains("M_cap 8, defensive")) << "the first above 5 iterations";
    EXPECT_FALSE(variants.contains("M_cap 16"));

    const GradientOptions paper = paper_options(*subjects[0], options).gradient;
    const auto gradient = [&](float cap) {
        GradientOptions o = paper;
        o.confidence_cap = cap;
        return estimate_along(*subjects[0]->traced, subjects[0]->study->trajectory, o)
            .gradient.values;
    };
    EXPECT_EQ(gradient(8), gradient(64));
    EXPECT_NE(gradient(8), gradient(4));
}

/// With one emitter every way to choose is the same, and has no row.
TEST(Ablation, OneLightIsNotChosen) {
    const ReproduceOptions options = test::small_options();
    std::vector<std::unique_ptr<Subject>> subjects;
    subjects.push_back(test::small_subject(options));
    Subject& subject = *subjects[0];
    Scene& scene = subject.loaded.scene;
    ASSERT_GT(scene.emitters.size(), 1u);
    scene.emitters = {ConstantEmitter{}};
    for (Shape& shape : scene.shapes) shape.emitter = {};
    *subject.traced = prepare(scene);
    const ExperimentResult result =
        run_ablation(subjects, options, {[](const std::string&) {}, {}});
    for (const Measurement& m : result.measurements)
        EXPECT_EQ(m.variant.find("lights by"), std::string::npos) << m.variant;
}

}  // namespace
}  // namespace burnish
