// What a run of the tests writes down about its comparisons, and the ledger as text.
#include "ledger.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "core/random.h"
#include "ledger_entries.h"

namespace burnish::test {

namespace {

constexpr std::string_view kVerdicts[] = {"accepted", "FAILED", "REJECTED", "SURVIVED"};

/// The seed of a thorough run; nullptr otherwise.
const char* thorough_seed() { return std::getenv("BURNISH_TEST_SEED"); }

std::string current_test() {
    const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
    return info ? std::string(info->test_suite_name()) + "." + info->name() : "";
}

void write_down(const ReportLine& line) {
    const char* file = std::getenv("BURNISH_LEDGER_REPORT");
    if (!file) return;
    // One short write in append mode: lines of concurrent tests do not mix.
    std::ofstream(file, std::ios::app) << to_text(line) + "\n" << std::flush;
}

bool lists(const LedgerEntry& entry, std::string_view defect) {
    for (const Defect& d : entry.defects)
        if (d.name == defect && current_test().find(d.test) != std::string::npos) return true;
    return false;
}

/// Whether the running test is one of "Suite.Name|Suite.Name" (a suite alone stands for its tests).
bool is_one_of(std::string_view tests) {
    std::istringstream stream{std::string(tests)};
    for (std::string one; std::getline(stream, one, '|');)
        if (current_test().find(one) != std::string::npos) return true;
    return false;
}

testing::AssertionResult write_comparison(const LedgerEntry& entry, std::string_view what,
                                          double p_value, Verdict verdict) {
    write_down({verdict, std::string(entry.name), std::string(what), current_test(), p_value,
                threshold(entry)});
    const bool good = verdict == Verdict::kAccepted || verdict == Verdict::kRejected;
    if (good) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << entry.name << ": " << what << " " << kVerdicts[static_cast<int>(verdict)]
           << ": p-value " << p_value << ", threshold " << threshold(entry)
           << (is_thorough() ? std::string(", --seed ") + thorough_seed() : "");
}

}  // namespace

bool is_thorough() { return thorough_seed() != nullptr; }

double threshold(const LedgerEntry& entry) {
    return (is_thorough() ? kThoroughAlpha : entry.alpha) / entry.comparisons;
}

std::uint32_t seed_of(const LedgerEntry& entry, std::uint32_t offset) {
    if (!is_thorough()) return entry.seed + offset;
    const auto run = static_cast<std::uint32_t>(std::strtoul(thorough_seed(), nullptr, 10));
    return philox4x32({entry.seed, 0, 0, 0}, {run, static_cast<std::uint32_t>(Stream::kTest)})[0] +
           offset;
}

testing::AssertionResult accepted(const LedgerEntry& entry, std::string_view what, double p_value) {
    if (!is_one_of(entry.tests))
        return testing::AssertionFailure()
               << entry.name << " does not list the test " << current_test();
    const bool good = p_value > threshold(entry);
    return write_comparison(entry, what, p_value, good ? Verdict::kAccepted : Verdict::kFailed);
}

testing::AssertionResult rejected(const LedgerEntry& entry, std::string_view defect,
                                  double p_value) {
    if (!lists(entry, defect))
        return testing::AssertionFailure() << entry.name << " does not list the defect '" << defect
                                           << "' in " << current_test();
    const bool good = p_value < threshold(entry);
    return write_comparison(entry, defect, p_value, good ? Verdict::kRejected : Verdict::kSurvived);
}

std::string to_text(const ReportLine& line) {
    return fmt::format("{}\t{}\t{}\t{}\t{:.6g}\t{:.6g}",
                       kVerdicts[static_cast<std::size_t>(line.verdict)], line.entry, line.what,
                       line.test, line.p_value, line.threshold);
}

std::vector<ReportLine> read_report(const std::string& file) {
    std::ifstream stream(file);
    if (!stream) throw std::runtime_error(file + ": cannot be read: no test wrote a comparison");
    std::vector<ReportLine> lines;
    for (std::string text; std::getline(stream, text);) {
        std::vector<std::string> cells;
        std::istringstream row(text);
        for (std::string cell; std::getline(row, cell, '\t');) cells.push_back(cell);
        std::size_t verdict = 0;
        while (verdict < std::size(kVerdicts) && (cells.empty() || kVerdicts[verdict] != cells[0]))
            ++verdict;
        if (cells.size() != 6 || verdict == std::size(kVerdicts))
            throw std::runtime_error(
                file + ": expected six cells that begin with a verdict, found '" + text + "'");
        lines.push_back({static_cast<Verdict>(verdict), cells[1], cells[2], cells[3],
                         std::strtod(cells[4].c_str(), nullptr),
                         std::strtod(cells[5].c_str(), nullptr)});
    }
    return lines;
}

namespace {

/// Words in lines of at most 118 characters, the first behind "- ", as an item of a Markdown list.
std::string list_item(const std::string& words) {
    constexpr std::size_t kMaxLine = 118;
    std::string item = "-";
    std::size_t line = item.size();
    std::istringstream stream(words);
    for (std::string word; stream >> word;) {
        if (line + 1 + word.size() > kMaxLine) item.append("\n "), line = 1;
        item.append(" ").append(word);
        line += 1 + word.size();
    }
    return item.append("\n");
}

}  // namespace

std::string ledger_table() {
    std::string list;
    for (const LedgerEntry* e : kLedger) {
        std::string defects;
        for (const Defect& d : e->defects) {
            if (d.name.empty()) continue;
            defects += defects.empty() ? " Seeded defects: " : "; ";
            defects += d.name;
        }
        if (!defects.empty()) defects += '.';
        list +=
            list_item(fmt::format("**{}**: alpha {:g}, comparisons {}, seed {}. Catches {}.{}",
                                  e->name, e->alpha, e->comparisons, e->seed, e->catches, defects));
    }
    return list;
}

std::string tests_of_ledger(bool defects_only) {
    std::string names;
    const auto add = [&](std::string_view name) {
        if (name.empty()) return;
        if (!names.empty()) names += '|';
        names += name;
    };
    for (const LedgerEntry* e : kLedger) {
        if (!defects_only) add(e->tests);
        for (const Defect& d : e->defects)
            if (names.find(d.test) == std::string::npos) add(d.test);
    }
    return names;
}

}  // namespace burnish::test
