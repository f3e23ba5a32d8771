// burnish reproduce: what it keeps of which machine, and what it says of one run.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "cli/program.h"
#include "cli/reproduce_machine.h"
#include "cli/reproduce_parts.h"
#include "cli/reproduce_report.h"

namespace burnish {
namespace {

using namespace testing;

struct Reproduce : Program {
    std::ptrdiff_t count_kept(const std::string& name) const {
        return std::count_if(fs::directory_iterator(folder / "r.kept"), fs::directory_iterator(),
                             [&](const fs::directory_entry& entry) {
                                 return entry.path().filename().string().starts_with(name + "-");
                             });
    }
};

TEST(Machine, HasTheNameOfItsProcessor) {
    EXPECT_EQ(processor_name("processor\t: 0\nmodel name\t: AMD EPYC 7B13\nmodel name\t: other\n"),
              "AMD EPYC 7B13");
    EXPECT_EQ(processor_name("processor\t: 0\nCPU part\t: 0xd0c\n"), "");
    EXPECT_FALSE(machine_of(0).processor.empty());
    EXPECT_GE(machine_of(0).threads, 1u);
    EXPECT_EQ(machine_of(3).threads, 3u);
}

// Targets and converged derivatives are the same for any number of threads; times are not.
TEST_F(Reproduce, TimesOfAnotherNumberOfThreadsAreMadeAgain) {
    const std::string command =
        "reproduce derivatives -o r --scene goblet --size 16 16 --time-scale 0.05 --threads ";
    ASSERT_EQ(run(command + "1").code, 0);
    const auto settings =
        nlohmann::json::parse(read_text(folder / "r/results.json")).at("settings");
    EXPECT_EQ(settings.at("threads"), "1");
    EXPECT_EQ(settings.at("scenes"), "goblet");
    EXPECT_TRUE(settings.at("budget of an optimisation run")
                    .get<std::string>()
                    .starts_with("1 iteration, "))
        << settings;
    EXPECT_EQ(settings.at("processor"), machine_of(1).processor);
    const Outcome again = run(command + "1");
    EXPECT_TRUE(contains(again.err, "1 of 1 parts are kept")) << again.err;
    const Outcome other = run(command + "2");
    EXPECT_FALSE(contains(other.err, "are kept from an earlier run")) << other.err;
    EXPECT_EQ(count_kept("goblet-derivatives"), 2);
    EXPECT_EQ(count_kept("goblet-target"), 1);
    EXPECT_EQ(count_kept("goblet-derivative"), 1);
}

TEST_F(Reproduce, RunsOfAnotherNumberOfThreadsAreMadeAgain) {
    const std::string command =
        "reproduce inverse -o r --scene goblet --size 16 16 --time-scale 0.01 --threads ";
    ASSERT_EQ(run(command + "1").code, 0);
    EXPECT_EQ(count_kept("goblet-run"), 25);
    ASSERT_EQ(run(command + "2").code, 0);
    EXPECT_EQ(count_kept("goblet-run"), 50);
}

TEST_F(Reproduce, AReportBelowItsSceneIsNoFileOfTheScene) {
    ASSERT_EQ(run("scene goblet -o scenes/tire --texture-size 16").code, 0);
    const fs::path scene = folder / "scenes/tire/scene.xml";
    write_text(scene, std::regex_replace(read_text(scene), std::regex("mat-goblet"), "mat-tire"));
    const std::string command =
        "reproduce derivatives -o scenes/tire/r --scenes scenes --scene tire --size 16 16 "
        "--time-scale 0.01";
    ASSERT_EQ(run(command).code, 0);
    const Outcome again = run(command);
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_TRUE(contains(again.err, "1 of 1 parts are kept")) << again.err;
}

TEST_F(Reproduce, ImagesAreOfFreshSamplesWhereThatIsAsked) {
    const std::string command =
        "reproduce derivatives -o r --scene goblet --size 16 16 --time-scale 0.01";
    struct Result {
        std::string image;
        double error_of_mc;  // of its derivative, whose adjoint is that of the image
    };
    const auto reproduce = [&](const std::string& option) {
        const Outcome outcome = run(command + option);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_FALSE(contains(outcome.err, "are kept from an earlier run")) << outcome.err;
        const auto results = nlohmann::json::parse(read_text(folder / "r/results.json"));
        const auto first = results.at("measurements").at(0);
        EXPECT_EQ(first.at("variant"), "mc, 1 spp, run 0");
        EXPECT_EQ(first.at("metric"), "paper_error");
        return Result{results.at("settings").at("samples per pixel of an iteration's image"),
                      first.at("value")};
    };
    const Result kept = reproduce(""), fresh = reproduce(" --fresh-image");
    EXPECT_EQ(kept.image, "2 fresh ones, and those of the last 32 passes, shaded again");
    EXPECT_EQ(fresh.image, "32, fresh");
    EXPECT_NE(kept.error_of_mc, fresh.error_of_mc);
    fs::remove_all(folder / "r.kept");
    EXPECT_EQ(reproduce("").error_of_mc, kept.error_of_mc) << "of the same image";
}

TEST_F(Reproduce, ScenesThatAreNamedAreNotLimited) {
    const std::vector<std::string> scenes{"goblet", "tyre", "bowl", "tree"};
    std::string command = "reproduce -o r --size 16 16 --time-scale 0.01";
    for (const std::string& scene : scenes) command += " --only " + scene + "/adam";
    const Outcome outcome = run(command);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const std::string& scene : scenes) EXPECT_EQ(count_kept(scene + "-adam"), 1) << scene;
}

// Seconds without a scene tell nothing of those with one.
TEST(Parts, TakeAsLongAsWhatIsLikeThem) {
    const auto named = [](const std::string& name) {
        const auto all = experiments();
        return &*std::find_if(all.begin(), all.end(),
                              [&](const Experiment& e) { return e.name == name; });
    };
    const KnownTarget bowl{}, tree{};
    std::vector<Part> parts{{named("positivization"), nullptr},
                            {named("derivatives"), &bowl},
                            {named("derivatives"), &tree},
                            {named("inverse"), &bowl}};
    const auto finish = [&](std::size_t k, double seconds) {
        parts[k].result.emplace();
        parts[k].result->seconds = seconds;
    };
    EXPECT_EQ(seconds_left(parts), std::nullopt);
    finish(0, 1);
    EXPECT_EQ(seconds_left(parts), std::nullopt);
    finish(1, 10);
    EXPECT_EQ(seconds_left(parts), 20.0);
    finish(2, 20);
    EXPECT_EQ(seconds_left(parts), 15.0);
    finish(3, 100);
    EXPECT_EQ(seconds_left(parts), 0.0);
    parts[0].result.reset();
    EXPECT_EQ(seconds_left(parts), std::nullopt);
}

TEST(ReproductionReport, CurvesKeepTheirStylesByTheirPlace) {
    Plot plot{"seconds", "loss", {}};
    for (const char* name : {"one", "two", "three", "four", "five"})
        plot.curves.push_back({name, {{1, 1}, {2, 0.5}}});
    plot.curves[1].points.clear();
    Figure figure;
    figure.plots.push_back(plot);
    ExperimentResult inverse;
    inverse.figures.push_back(figure);
    Reproduction run;
    run.experiments.push_back(inverse);
    const std::string page = reproduction_html(run);
    for (const char* style : {"first", "third", "fourth", "fifth"}) {
        EXPECT_TRUE(contains(page, std::string("class=\"line ") + style + '"')) << style;
        EXPECT_TRUE(contains(page, std::string(".line.") + style + " {")) << style;
    }
    EXPECT_FALSE(contains(page, "class=\"line second\"")) << "it has no points";
    EXPECT_FALSE(contains(page, ">two</text>")) << "nor a place in the legend";
}

TEST(ReproductionReport, LogarithmicAxesHaveTicksAtPowersOfTwo) {
    const auto numbers_of = [](const std::vector<double>& samples) {
        Plot plot{"samples", "NMSE", {{"mc", {}}}, true};
        for (const double x : samples) plot.curves[0].points.push_back({x, 1000 / x});
        Figure figure;
        figure.plots.push_back(plot);
        Reproduction run;
        run.experiments.push_back({"equal-error", "", {figure}, {}, 0});
        const std::string page = reproduction_html(run);
        const std::regex tick("text-anchor=\"middle\">([0-9.]+)<");
        std::vector<std::string> numbers;
        for (auto i = std::sregex_iterator(page.begin(), page.end(), tick);
             i != std::sregex_iterator(); ++i)
            numbers.push_back((*i)[1]);
        return numbers;
    };
    using Numbers = std::vector<std::string>;
    EXPECT_EQ(numbers_of({1}), (Numbers{"1", "2"}));
    EXPECT_EQ(numbers_of({1, 2}), (Numbers{"1", "2"}));
    EXPECT_EQ(numbers_of({1, 2, 4, 8}), (Numbers{"1", "2", "4", "8"}));
    EXPECT_EQ(numbers_of({1, 512}), (Numbers{"1", "4", "16", "64", "256"}));
}

TEST(ReproductionReport, WrapsTheNamesOfSettings) {
    Reproduction run;
    run.settings = {{"samples per pixel of the converged derivative", "512"}};
    run.experiments.push_back({"adam", "Adam", {}, {}, 2});
    const std::string page = reproduction_html(run);
    EXPECT_TRUE(contains(page, "<tr><th>samples per pixel of the converged derivative</th>"))
        << "headers of rows; first cells of measurements do not wrap";
    EXPECT_TRUE(contains(page, "<h2>Adam <small>adam, 2.0 s</small></h2>"));
}

TEST(ReproductionReport, SaysWhetherTheRunWasStopped) {
    Reproduction run;
    EXPECT_FALSE(contains(reproduction_html(run), "stopped"));
    EXPECT_FALSE(contains(reproduction_json(run), "stopped"));
    run.stopped = "stopped with 1 of 2 parts done: the same command goes on";
    EXPECT_TRUE(contains(reproduction_html(run), "; " + run.stopped + "</p></header>"));
    EXPECT_EQ(nlohmann::json::parse(reproduction_json(run)).at("stopped"), run.stopped);
}

TEST_F(Reproduce, AtThePapersSizeThereIsOneRun) {
    const Outcome outcome =
        run("reproduce derivatives --scene goblet -o r --full --size 16 16 --time-scale 0.01");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto settings =
        nlohmann::json::parse(read_text(folder / "r/results.json")).at("settings");
    EXPECT_EQ(settings.at("runs with seeds of their own behind an interval"),
              "one run, no interval");
    const std::string help =
        std::regex_replace(run("reproduce --help").out, std::regex("\\s+"), " ");
    EXPECT_TRUE(contains(help, "no interval and no verdict, but in adam and positivization"))
        << help;
}

TEST_F(Reproduce, AnExperimentWithoutScenesSaysSo) {
    ASSERT_EQ(run("reproduce positivization -o r").code, 0);
    const auto settings =
        nlohmann::json::parse(read_text(folder / "r/results.json")).at("settings");
    EXPECT_EQ(settings.at("scenes"), "none");
}

}  // namespace
}  // namespace burnish
