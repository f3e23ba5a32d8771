// The ledger of statistical tests: its alphas bound the false alarms of the suite, its names tell
// its entries apart, and docs/testing.md shows it as it is.
#include "ledger.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "file_bytes.h"
#include "ledger_entries.h"
#include "temporary_folder.h"

namespace burnish::test {
namespace {

/// The most that the false alarms of the whole suite may add up to.
constexpr double kFamilyAlpha = 1e-4;

double sum_of_alphas() {
    double sum = 0;
    for (const LedgerEntry* e : kLedger) sum += e->alpha;
    return sum;
}

TEST(Ledger, FalseAlarmsOfTheSuiteAreBounded) {
    EXPECT_LE(sum_of_alphas() + kPythonAlpha, kFamilyAlpha);
    EXPECT_LE(kThoroughAlpha * static_cast<double>(std::size(kLedger)), kFamilyAlpha);
    for (const LedgerEntry* e : kLedger) {
        EXPECT_GT(e->alpha, 0) << e->name;
        EXPECT_GT(e->comparisons, 0) << e->name;
        EXPECT_GT(e->thorough, 1) << e->name;
    }
}

TEST(Ledger, EntriesAreToldApart) {
    std::set<std::string_view> names;
    std::set<std::pair<std::string_view, std::string_view>> defects;
    for (const LedgerEntry* e : kLedger) {
        EXPECT_TRUE(names.insert(e->name).second) << e->name << " twice";
        EXPECT_FALSE(e->catches.empty()) << e->name;
        EXPECT_FALSE(e->tests.empty()) << e->name;
        for (const Defect& d : e->defects)
            if (!d.name.empty()) {
                EXPECT_TRUE(defects.insert({e->name, d.name}).second) << d.name << " twice";
            }
    }
    EXPECT_GE(defects.size(), 20u);
}

TEST(Ledger, DocumentationShowsItAsItIs) {
    const auto file = std::filesystem::path(BURNISH_TEST_DATA) / "../../docs/testing.md";
    EXPECT_NE(bytes_of(file).find(ledger_table()), std::string::npos)
        << "docs/testing.md: expected the list that `build/release/tests/ledger table` prints";
}

/// The environment of a thorough run, for the life of one object.
struct ThoroughRun {
    explicit ThoroughRun(const char* seed) { setenv("BURNISH_TEST_SEED", seed, 1); }
    ~ThoroughRun() {
        if (before.empty())
            unsetenv("BURNISH_TEST_SEED");
        else
            setenv("BURNISH_TEST_SEED", before.c_str(), 1);
    }
    ThoroughRun(const ThoroughRun&) = delete;
    ThoroughRun& operator=(const ThoroughRun&) = delete;

    std::string before =
        std::getenv("BURNISH_TEST_SEED") ? std::getenv("BURNISH_TEST_SEED") : std::string();
};

constexpr LedgerEntry kExample{.name = "example", .alpha = 4e-6, .comparisons = 4, .seed = 7};

TEST(Ledger, ThoroughRunsHaveOtherSeedsAndMoreSamples) {
    if (!is_thorough()) {
        EXPECT_EQ(seed_of(kExample, 3), 10u);
        EXPECT_EQ(scaled(kExample, 100), 100);
        EXPECT_DOUBLE_EQ(threshold(kExample), 1e-6);
    }
    std::set<std::uint32_t> seeds{7};
    for (const char* seed : {"1", "2", "4000000000"}) {
        const ThoroughRun run(seed);
        EXPECT_TRUE(seeds.insert(seed_of(kExample)).second);
        EXPECT_EQ(seed_of(kExample, 3), seed_of(kExample) + 3);
        EXPECT_EQ(scaled(kExample, 100), 400);
        EXPECT_DOUBLE_EQ(threshold(kExample), 0.25e-6);
    }
}

TEST(Ledger, RefusesWhatItDoesNotList) {
    EXPECT_FALSE(rejected(kExample, "a defect of nobody", 0));
    EXPECT_FALSE(accepted(kExample, "a test of nobody", 1)) << "no test is listed";
}

constexpr LedgerEntry kOwn{.name = "own",
                           .alpha = 1e-6,
                           .tests = "Ledger.JudgesByTheThreshold",
                           .defects = {{{"defect", "Ledger.JudgesByTheThreshold"}}}};

TEST(Ledger, JudgesByTheThreshold) {
    const char* report = std::getenv("BURNISH_LEDGER_REPORT");
    const std::string kept = report ? report : "";
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path / "report.tsv";
    setenv("BURNISH_LEDGER_REPORT", file.c_str(), 1);
    EXPECT_TRUE(accepted(kOwn, "a", 1e-3));
    EXPECT_FALSE(accepted(kOwn, "b", 1e-9));
    EXPECT_FALSE(accepted(kOwn, "c", std::nan("")));
    EXPECT_TRUE(rejected(kOwn, "defect", 1e-9));
    EXPECT_FALSE(rejected(kOwn, "defect", 1e-3));
    EXPECT_FALSE(rejected(kOwn, "defect", std::nan("")));
    if (kept.empty())
        unsetenv("BURNISH_LEDGER_REPORT");
    else
        setenv("BURNISH_LEDGER_REPORT", kept.c_str(), 1);

    const std::vector<ReportLine> lines = read_report(file.string());
    ASSERT_EQ(lines.size(), 6u);
    EXPECT_EQ(lines[0].verdict, Verdict::kAccepted);
    EXPECT_EQ(lines[1].verdict, Verdict::kFailed);
    EXPECT_EQ(lines[2].verdict, Verdict::kFailed);
    EXPECT_EQ(lines[3].verdict, Verdict::kRejected);
    EXPECT_EQ(lines[4].verdict, Verdict::kSurvived);
    EXPECT_EQ(lines[5].verdict, Verdict::kSurvived);
    EXPECT_EQ(lines[3].entry, "own");
    EXPECT_EQ(lines[3].what, "defect");
    EXPECT_EQ(lines[3].test, "Ledger.JudgesByTheThreshold");
    EXPECT_DOUBLE_EQ(lines[3].p_value, 1e-9);
}

}  // namespace
}  // namespace burnish::test
