// The ledger of statistical tests as a program, for ./test:
//
//   ledger table              the list of docs/testing.md
//   ledger tests              the tests to run, as a regular expression for ctest -R
//   ledger defect-tests       those that carry seeded defects
//   ledger check REPORT       every entry made its comparisons; exit status 1 where one did not
//   ledger mutants REPORT     every seeded defect and its verdict; exit status 1 where one survived
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "ledger_entries.h"
#include "worst.h"

namespace burnish::test {
namespace {

/// The comparisons of one entry under one name: of several, the least favourable.
struct Row {
    int count = 0;
    double p_value = 0;  ///< the largest; not a number where one is not
    bool rejected = true;
};

Row row_of(const std::vector<ReportLine>& lines, const LedgerEntry& entry, const Defect& defect) {
    Row row;
    for (const ReportLine& line : lines) {
        const bool of_defect =
            line.verdict == Verdict::kRejected || line.verdict == Verdict::kSurvived;
        if (!of_defect || line.entry != entry.name || line.what != defect.name) continue;
        ++row.count;
        row.p_value = worse(row.p_value, line.p_value);
        row.rejected = row.rejected && line.verdict == Verdict::kRejected;
    }
    return row;
}

int show_mutants(const std::vector<ReportLine>& lines) {
    fmt::print("{:<44} {:<58} {:>5} {:>9} {:>9}  {}\n", "seeded defect", "must be rejected by",
               "times", "worst p", "alpha", "verdict");
    int defects = 0, survivors = 0;
    for (const LedgerEntry* entry : kLedger)
        for (const Defect& defect : entry->defects) {
            if (defect.name.empty()) continue;
            const Row row = row_of(lines, *entry, defect);
            const bool good = row.count > 0 && row.rejected;
            ++defects, survivors += !good;
            fmt::print("{:<44} {:<58} {:>5} {:>9.1e} {:>9.1e}  {}\n", defect.name, defect.test,
                       row.count, row.p_value, threshold(*entry),
                       row.count == 0 ? "NOT RUN"
                       : good         ? "REJECTED"
                                      : "SURVIVED");
        }
    fmt::print("{} seeded defects, {} survived\n", defects, survivors);
    return survivors > 0;
}

/// Problems of one entry in a run of all tests, for people; empty where there are none.
std::string problem_of(const LedgerEntry& entry, const std::vector<ReportLine>& lines) {
    const auto comparisons = std::count_if(lines.begin(), lines.end(), [&](const ReportLine& l) {
        return l.entry == entry.name &&
               (l.verdict == Verdict::kAccepted || l.verdict == Verdict::kFailed);
    });
    if (comparisons != entry.comparisons && (comparisons > 0 || !entry.needs_data))
        return fmt::format("{} comparisons were made: expected {}, which share its alpha",
                           comparisons, entry.comparisons);
    for (const Defect& defect : entry.defects)
        if (!defect.name.empty() && row_of(lines, entry, defect).count == 0)
            return fmt::format("no test injected '{}'", defect.name);
    return "";
}

int check(const std::vector<ReportLine>& lines) {
    int problems = 0;
    double alpha = is_thorough() ? 0 : kPythonAlpha;
    for (const LedgerEntry* entry : kLedger) {
        alpha += is_thorough() ? kThoroughAlpha : entry->alpha;
        const std::string problem = problem_of(*entry, lines);
        if (problem.empty()) continue;
        ++problems;
        fmt::print("ledger: {}: {}\n", entry->name, problem);
    }
    const auto rejections = std::count_if(lines.begin(), lines.end(), [](const ReportLine& l) {
        return l.verdict == Verdict::kRejected;
    });
    fmt::print(
        "ledger: {} entries, {} comparisons, {} of them with a seeded defect that was "
        "rejected; false alarms of the suite at most {:.2g}\n",
        std::size(kLedger), lines.size(), rejections, alpha);
    return problems > 0;
}

int run(const std::vector<std::string>& arguments) {
    const std::string command = arguments.empty() ? "" : arguments[0];
    const bool reads = command == "check" || command == "mutants";
    if (arguments.size() == (reads ? 2u : 1u)) {
        if (command == "table") return fmt::print("{}", ledger_table()), 0;
        if (command == "tests") return fmt::print("{}\n", tests_of_ledger(false)), 0;
        if (command == "defect-tests") return fmt::print("{}\n", tests_of_ledger(true)), 0;
        if (command == "check") return check(read_report(arguments[1]));
        if (command == "mutants") return show_mutants(read_report(arguments[1]));
    }
    fmt::print(stderr, "usage: ledger table|tests|defect-tests, or ledger check|mutants REPORT\n");
    return 2;
}

}  // namespace
}  // namespace burnish::test

int main(int count, char** values) {
    try {
        return burnish::test::run({values + 1, values + count});
    } catch (const std::exception& error) {
        fmt::print(stderr, "ledger: {}\n", error.what());
        return 2;
    }
}
