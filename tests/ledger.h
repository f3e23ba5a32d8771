// The ledger of statistical tests: each takes its alpha, its seed and the factor of its samples
// from one entry, and says what it compared. An entry's alpha is the probability with which any of
// its comparisons fails although nothing is wrong; the comparisons share it equally [Bonferroni],
// so the alphas of all entries and kPythonAlpha bound the false alarms of the whole suite.
//
// Where BURNISH_TEST_SEED is set the run is thorough: seeds are mixed with it, every entry has
// alpha 1e-6, and there are more samples. Otherwise a run is the same, bit for bit, each time.
// Where BURNISH_LEDGER_REPORT names a file, every comparison adds a line to it.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace burnish::test {

/// A wrong result that a test must reject, and the test (Suite.Name) that does.
struct Defect {
    std::string_view name{}, test{};
};

struct LedgerEntry {
    std::string_view name{};     ///< "layer/file: what"
    std::string_view catches{};  ///< the error it would see
    double alpha = 0;            ///< of all comparisons together
    int comparisons = 1;         ///< p-values that share alpha
    std::uint32_t seed = 0;
    int thorough = 4;          ///< factor of the samples of a thorough run
    std::string_view tests{};  ///< "Suite.Name|Suite.Name": the tests that make the comparisons
    std::array<Defect, 6> defects{};
    bool needs_data = false;  ///< skipped where the data of docs/testing.md is missing
};

/// alpha of a thorough run, for each entry.
inline constexpr double kThoroughAlpha = 1e-6;

/// Of the comparisons that Python programs make, which have no entries: seven of
/// tests/python/test_gradient.py, 1e-6 each, and two of it, 1e-7 each; those of
/// tests/scenes/agree_with_mitsuba.py, 1e-6 in all, and of tests/scenes/rewritten_in_mitsuba.py,
/// 2.5e-7. A thorough run does not make them.
inline constexpr double kPythonAlpha = 8.45e-6;

bool is_thorough();

/// A comparison is rejected where its p-value is not above this.
double threshold(const LedgerEntry& entry);

/// The seed number `offset` of an entry.
std::uint32_t seed_of(const LedgerEntry& entry, std::uint32_t offset = 0);

/// A number of samples, more of them in a thorough run.
template <class Integer>
Integer scaled(const LedgerEntry& entry, Integer samples) {
    return is_thorough() ? samples * static_cast<Integer>(entry.thorough) : samples;
}

/// "The p-value of comparison `what` is above the threshold."
testing::AssertionResult accepted(const LedgerEntry& entry, std::string_view what, double p_value);

/// "The p-value of a seeded defect, one of entry.defects, is below the threshold." One that is not
/// a number is not.
testing::AssertionResult rejected(const LedgerEntry& entry, std::string_view defect,
                                  double p_value);

// ---- The report

enum class Verdict { kAccepted, kFailed, kRejected, kSurvived };

/// One line: what a test compared. The lines of a defect have a verdict kRejected or kSurvived.
struct ReportLine {
    Verdict verdict = Verdict::kAccepted;
    std::string entry, what, test;
    double p_value = 0, threshold = 0;
};

std::string to_text(const ReportLine& line);
/// Throws std::runtime_error where a line is not to be understood.
std::vector<ReportLine> read_report(const std::string& file);

/// The ledger as the list of docs/testing.md.
std::string ledger_table();
/// The tests that ctest must run (a regular expression of their names): all in the ledger, or those
/// that carry defects.
std::string tests_of_ledger(bool defects_only);

}  // namespace burnish::test
