// Tables of numbers in CSV files whose first line names the columns.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace burnish::test {

/// The folder of the reference data, with tables/, scenes/ and gradients/: the environment variable
/// BURNISH_REFERENCE_DIR, or the data that comes with the tests.
inline std::filesystem::path reference_folder() {
    const char* given = std::getenv("BURNISH_REFERENCE_DIR");
    return given ? given : BURNISH_TEST_DATA;
}

/// One row, by column name.
struct CsvRow {
    std::size_t line = 0;  ///< in the file, the first is 1
    std::map<std::string, double, std::less<>> cells;

    double operator[](const std::string& column) const {
        const auto found = cells.find(column);
        if (found == cells.end()) throw std::runtime_error("no column '" + column + "'");
        return found->second;
    }
};

inline std::vector<std::string> split_csv(const std::string& line) {
    std::vector<std::string> parts;
    std::istringstream stream(line);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

/// All rows. Throws std::runtime_error where the file is missing, empty or a row has not a number
/// for each column.
inline std::vector<CsvRow> read_csv(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line)) throw std::runtime_error(file.string() + ": missing or empty");
    const std::vector<std::string> names = split_csv(line);
    std::vector<CsvRow> rows;
    for (std::size_t number = 2; std::getline(stream, line); ++number) {
        const std::vector<std::string> parts = split_csv(line);
        if (parts.size() != names.size())
            throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": expected " +
                                     std::to_string(names.size()) + " cells");
        CsvRow row{number, {}};
        for (std::size_t i = 0; i < names.size(); ++i) row.cells[names[i]] = std::stod(parts[i]);
        rows.push_back(std::move(row));
    }
    if (rows.empty()) throw std::runtime_error(file.string() + ": no rows");
    return rows;
}

/// A table of the reference data, e.g. "filter.csv".
inline std::vector<CsvRow> reference_table(const std::string& name) {
    return read_csv(reference_folder() / "tables" / name);
}

}  // namespace burnish::test
