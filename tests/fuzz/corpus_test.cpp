// The corpus of the fuzzers, read again: what once made a reader fail stays mended.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "burnish/error.h"
#include "file_bytes.h"
#include "fuzz/readers.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> corpus_of(const fuzz::Reader& reader) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(BURNISH_FUZZ_CORPUS) / reader.name))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

namespace fuzz {
/// What GoogleTest calls a reader in the names of tests.
void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }
}  // namespace fuzz

namespace {

class Corpus : public ::testing::TestWithParam<fuzz::Reader> {};

/// Seconds of the processor.
double clock_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST_P(Corpus, IsReadOrRefused) {
    constexpr double kMaxSeconds = 2;
    const fuzz::Folder folder(GetParam());
    std::size_t read = 0, refused = 0;
    for (const fs::path& file : corpus_of(GetParam())) {
        SCOPED_TRACE(file);
        const std::string bytes = test::bytes_of(file);
        const double start = clock_seconds();
        try {
            folder.read(bytes);
            ++read;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()), "");
            ++refused;
        } catch (const std::exception& error) {
            ADD_FAILURE() << "a defect of the reader: " << error.what();
        }
        EXPECT_LT(clock_seconds() - start, kMaxSeconds);
    }
    EXPECT_GT(read, 0u) << "nothing that can be read shows what a reader does with its content";
    EXPECT_GT(refused, 0u);
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus,
                         ::testing::ValuesIn(fuzz::readers().begin(), fuzz::readers().end()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(CorpusFolders, HoldFilesThatNameOthersOfAReader) {
    const fuzz::Folder folder(*fuzz::find_reader("jobs"));
    const auto read = [&](const std::string& name) {
        folder.read(R"({"jobs": [{"output": "a", "arguments": ["scene.xml", "--parameter", )"
                    R"("color", "--options", ")" +
                    name + R"("]}]})");
    };
    const fs::path before = fs::current_path();
    EXPECT_NO_THROW(read("options.json"));
    EXPECT_THROW(read("none.json"), Error);
    EXPECT_NO_THROW(read("/dev/zero")) << "left out";
    EXPECT_EQ(fs::current_path(), before);
}

TEST(CorpusFolders, HaveADictionary) {
    for (const fuzz::Reader& reader : fuzz::readers()) {
        const fs::path file =
            fs::path(BURNISH_FUZZ_CORPUS) / ".." / (std::string(reader.name) + ".dict");
        EXPECT_TRUE(fs::exists(file)) << reader.name;
    }
}

TEST(CorpusFolders, HaveAReader) {
    for (const auto& entry : fs::directory_iterator(BURNISH_FUZZ_CORPUS))
        EXPECT_NE(fuzz::find_reader(entry.path().filename().string()), nullptr) << entry.path();
}

}  // namespace
}  // namespace burnish
