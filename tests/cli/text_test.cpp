#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/chart.h"
#include "cli/console.h"
#include "cli/help.h"
#include "cli/pictures.h"
#include "cli/progress.h"
#include "image/quality.h"
#include "optimize/option_value.h"

namespace burnish {
namespace {

TEST(OptionValue, NumbersAreWholeTexts) {
    EXPECT_EQ(parse_number("0.25"), 0.25);
    EXPECT_EQ(parse_number("-1e-3"), -1e-3);
    for (const char* bad : {"", "x", "1x", "1 ", " 1", "nan", "inf", "1e999", "0.5.png"})
        EXPECT_FALSE(parse_number(bad)) << bad;
}

TEST(OptionValue, RangesSayWhatTheyExpect) {
    EXPECT_EQ(range_complaint({1, 64, true}, "64"), "");
    EXPECT_EQ(range_complaint({1, 64, true}, "65"),
              "expected a whole number from 1 to 64, found '65'");
    EXPECT_NE(range_complaint({1, 64, true}, "1.5"), "");
    EXPECT_EQ(range_complaint({0, 1, false, true}, "0"),
              "expected a number above 0 and at most 1, found '0'");
}

TEST(Numbers, HaveNoExponents) {
    EXPECT_EQ(short_duration_text(3.46e-5), "0.035 ms");
    EXPECT_EQ(short_duration_text(0.00994), "9.9 ms");
    EXPECT_EQ(short_duration_text(0.00996), "0.01 s");
    EXPECT_EQ(short_duration_text(0.1234), "0.12 s");
    EXPECT_EQ(short_duration_text(0.996), "1.0 s");
    EXPECT_EQ(short_duration_text(124), "2 min 04 s");
    EXPECT_EQ(digits_text(1.2345), "1.23");
    EXPECT_EQ(digits_text(999.4), "999");
    EXPECT_EQ(digits_text(999.6), "1 000");
    EXPECT_EQ(digits_text(1234.5), "1 235");
    EXPECT_EQ(percent_text(1e-6), "less than 0.01 %");
    EXPECT_EQ(percent_text(0.00012), "0.012 %");
    EXPECT_EQ(percent_text(0.0996), "10 %");
    EXPECT_EQ(percent_text(1), "100 %");
}

TEST(Numbers, HaveTheirDigitsToTheLast) {
    EXPECT_EQ(significant_text(0.058, 3), "0.0580");
    EXPECT_EQ(significant_text(0.0454, 3), "0.0454");
    EXPECT_EQ(significant_text(0.0013, 4), "0.001300");
    EXPECT_EQ(significant_text(100, 3), "100");
    EXPECT_EQ(significant_text(1.5, 4), "1.500");
    EXPECT_EQ(significant_text(1e-7, 3), "1.00e-07");
    EXPECT_EQ(significant_text(2e9, 1), "2e+09");
    EXPECT_EQ(significant_text(0, 3), "0");
}

TEST(Chart, LinearTicksAreRound) {
    EXPECT_EQ(linear_ticks(0, 20, 8), (std::vector<double>{0, 5, 10, 15, 20}));
    EXPECT_EQ(linear_ticks(0, 7, 8), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(Chart, LogTicks) {
    EXPECT_EQ(log_ticks(1, 1e4), (std::vector<double>{1, 10, 100, 1e3, 1e4}));
    EXPECT_EQ(log_ticks(0.9, 11), (std::vector<double>{1, 2, 5, 10}));
    EXPECT_GE(log_ticks(0.031, 0.039).size(), 3u) << "a narrow range has ticks as well";
    for (const auto& [low, high] : {std::pair{0.00156, 0.624}, {0.0012, 0.9}, {0.011, 5.0}})
        EXPECT_LE(log_ticks(low, high).front(), 5 * low) << low << " to " << high;
}

TEST(Chart, DrawsPointsWhereTheyBelongAndEscapesText) {
    const Chart chart{
        "x < y",
        "loss",
        {{"a&b", "first", {{0, 1}, {10, 0.1}, {20, 0}}, {}}, {"c", "second", {}, {}}}};
    const std::string svg = chart_svg(chart);
    EXPECT_NE(svg.find("x &lt; y"), std::string::npos);
    EXPECT_NE(svg.find("a&amp;b"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_NE(svg.find("d=\"M76.0 "), std::string::npos) << "x = 0 lies on the left axis";
}

TEST(Chart, CountsHaveNoTicksAtFractions) {
    const auto ticks = [](double last, bool whole) {
        Chart chart{"iteration", "loss", {{"a", "first", {{0, 1}, {last, 0.5}}, {}}}};
        chart.whole_x = whole;
        const std::string svg = chart_svg(chart);
        const std::regex tick("text-anchor=\"middle\">([0-9.]+)<");
        std::vector<std::string> texts;
        for (std::sregex_iterator i(svg.begin(), svg.end(), tick), end; i != end; ++i)
            texts.push_back((*i)[1]);
        return texts;
    };
    using Texts = std::vector<std::string>;
    EXPECT_EQ(ticks(1, true), (Texts{"0", "1"}));
    EXPECT_EQ(ticks(3, true), (Texts{"0", "1", "2", "3"}));
    EXPECT_EQ(ticks(3, false), (Texts{"0", "0.5", "1", "1.5", "2", "2.5", "3"}));
    EXPECT_EQ(ticks(20, true), (Texts{"0", "5", "10", "15", "20"}));
}

TEST(Chart, NamesItsSeriesAboveThePlot) {
    Chart chart{"x", "y", {}};
    const std::vector<std::string> names{"mc", "pgris, identity shift", "pgris, replay shift",
                                         "path cache, its image included", "gris"};
    for (const std::string& name : names) chart.series.push_back({name, "first", {{0, 1}}, {}});
    const std::string svg = chart_svg(chart);
    const auto number = [&](const std::string& pattern) {
        std::smatch found;
        EXPECT_TRUE(std::regex_search(svg, found, std::regex(pattern))) << pattern << svg;
        return found.empty() ? NAN : std::stod(found[1]);
    };
    const double top = number("viewBox=\"0 ([-0-9.]+) ");
    const double plot = number("class=\"axis\" d=\"M[0-9.]+ ([-0-9.]+)V");
    for (const std::string& name : names) {
        const std::string text = "\">" + name + "<";
        EXPECT_LT(number("y=\"([-0-9.]+)" + text), plot) << name;
        EXPECT_GT(number("y=\"([-0-9.]+)" + text), top) << name;
        EXPECT_LT(
            number("x=\"([-0-9.]+)\" y=\"[-0-9.]+" + text) + 6 * static_cast<double>(name.size()),
            640)
            << name;
    }
}

TEST(Chart, LeavesOutWhatIsNotFinite) {
    const auto svg = [](std::vector<ChartPoint> points) {
        return chart_svg({"x", "y", {{"a", "first", std::move(points), {}}}});
    };
    const double inf = INFINITY;
    EXPECT_EQ(svg({{0, 1}, {5, inf}, {7, -inf}, {8, NAN}, {10, 0.1}}), svg({{0, 1}, {10, 0.1}}));
}

TEST(Chart, AnEmptyChartIsStillAChart) {
    const std::string svg = chart_svg({"x", "y", {{"a", "first", {}, {}}}});
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Pictures, Base64AgreesWithTheStandard) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xff\x80"), "/4A=");
}

TEST(Pictures, ExposureBringsTheBrightPartToWhite) {
    Image image = make_image(10, 10, 3, 4.0f);
    EXPECT_FLOAT_EQ(display_scale(image), 0.25f);
    image.at(3, 3, 1) = 1000.0f;  // one bright pixel of a hundred does not darken the rest
    EXPECT_FLOAT_EQ(display_scale(image), 0.25f);
    EXPECT_FLOAT_EQ(display_scale(make_image(2, 2, 3)), 1.0f);
    EXPECT_FLOAT_EQ(display_scale(make_image(2, 2, 3, INFINITY)), 1.0f);
    EXPECT_FLOAT_EQ(display_scale(make_image(2, 2, 3, 1e-40f)), 1.0f);
}

TEST(Pictures, ExposureIsThatOfThePixelsThatCount) {
    Image image = make_image(10, 10, 3, 4.0f), mask = make_image(10, 10, 1);
    for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 5; ++x) {
            mask.at(x, y, 0) = 1;
            for (int c = 0; c < 3; ++c) image.at(5 + x, y, c) = 4000;
        }
    EXPECT_FLOAT_EQ(display_scale(image), 1 / 4000.0f);
    EXPECT_FLOAT_EQ(display_scale(image, counted_pixels(mask)), 0.25f);
}

TEST(Pictures, RelativeErrorIsThatOfTheLoss) {
    const Image image = make_image(2, 1, 3, 1.0f), target = make_image(2, 1, 3, 0.0f);
    EXPECT_EQ(relative_error(image, target).values, (std::vector<float>{10, 10}));
}

TEST(Pictures, ShrinkAverages) {
    Image image = make_image(4, 2, 1);
    for (int x = 0; x < 4; ++x) image.at(x, 0, 0) = image.at(x, 1, 0) = static_cast<float>(x);
    const Image small = shrink(image, 2);
    ASSERT_EQ(small.width, 2);
    ASSERT_EQ(small.height, 1);
    EXPECT_FLOAT_EQ(small.at(0, 0, 0), 0.5f);
    EXPECT_FLOAT_EQ(small.at(1, 0, 0), 2.5f);
}

/// Values of few pixels are not thinned by those around them that do not count.
TEST(Pictures, ShrinkAveragesWhatCounts) {
    Image image = make_image(1024, 1024, 1, 7.0f);
    std::vector<char> counting(image.values.size());
    for (int y = 0; y < 1024; y += 2)
        for (int x = 0; x < 1024; x += 2) {
            image.at(x, y, 0) = 0.4f;
            counting[static_cast<std::size_t>(y) * 1024 + static_cast<std::size_t>(x)] = 1;
        }
    const Image small = shrink(image, 512, counting);
    EXPECT_EQ(small.width, 512);
    EXPECT_EQ(small.values, std::vector<float>(512 * 512, 0.4f));
    const Image whole = shrink(image, 1024, counting);
    EXPECT_EQ(whole.width, 1024);
    EXPECT_EQ(whole.at(2, 0, 0), 0.4f);
    EXPECT_EQ(whole.at(1, 0, 0), 0) << "it does not count";
}

/// What UTF-8 takes of a terminal: a column for each letter, two from U+3000 on.
std::size_t columns_of(const std::string& text) {
    std::size_t columns = 0;
    for (const char c : text)
        columns += ((c & 0xc0) != 0x80) + (static_cast<unsigned char>(c) >= 0xe3);
    return columns;
}

TEST(ProgressLine, KeepsItsNumbersInTheWidthOfTheTerminal) {
    const std::string numbers = " 56 %  2 min 04 s left";
    const std::string wide = progress_line("rendering", numbers, 0.5, 80);
    EXPECT_EQ(wide, "rendering  [============            ]  56 %  2 min 04 s left");
    for (std::size_t columns = 30; columns <= 100; ++columns)
        for (const char* title : {"finding the texels that light reaches",
                                  "goblet/inverse: goblet: pgris, replay shift, run 3 of 5",
                                  "loading /data/m\xc3\xb6\xc3\xb6\xc3\xb6"
                                  "bel/\xe6\x9d\xb1\xe4\xba\xac.xml"}) {
            const std::string line = progress_line(title, numbers, 0.56, columns);
            EXPECT_LT(columns_of(line), columns) << line;
            EXPECT_TRUE(line.ends_with(numbers)) << line;
            EXPECT_TRUE(line.starts_with("f") || line.starts_with("g") || line.starts_with("l"));
        }
    const std::string narrow =
        progress_line("finding the texels that light reaches", numbers, 0.56, 50);
    EXPECT_EQ(narrow, "finding the texels that\xe2\x80\xa6  " + numbers);
    EXPECT_EQ(progress_line("iteration", "3/6  loss 0.1", {}, 80), "iteration  3/6  loss 0.1");
}

TEST(ProgressLine, CutsNoLetterInTwo) {
    const std::string umlauts = "\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc";
    EXPECT_EQ(progress_line(umlauts, "1 s", {}, 12), umlauts + "  1 s");
    EXPECT_EQ(progress_line(umlauts, "1 s", {}, 11), "\xc3\xa4\xc3\xb6\xc3\xbc\xe2\x80\xa6  1 s");
}

TEST(Help, IsAsWideAsItsTerminal) {
    CLI::App app(
        "What a program does for those that call it, and how they call it, in many words.");
    const char* text = "What a command does, in more words than a line of a terminal has room for";
    bool flag = false;
    app.add_subcommand("act", text)->add_flag("--flag", flag, text);
    arrange_help(app, 60);
    for (const std::string& help : {app.help(), app.get_subcommand("act")->help()}) {
        std::istringstream lines(help);
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 60u) << line;
        EXPECT_NE(help.find("\n" + std::string(34, ' ') + "more words than a line of\n"),
                  std::string::npos)
            << help;
    }
}

TEST(Console, WordsOfAShellAreQuotedWhereTheyHaveToBe) {
    for (const char* plain : {"out/a_1.x", "m\xc3\xb6", "--x=1"})
        EXPECT_EQ(shell_word(plain), plain);
    EXPECT_EQ(shell_word("out/my run"), "'out/my run'");
    EXPECT_EQ(shell_word("it's $5"), "'it'\\''s $5'");
    EXPECT_EQ(shell_word(""), "''");
}

TEST(Console, Units) {
    EXPECT_EQ(count_text(1234567), "1 234 567");
    EXPECT_EQ(count_text(12), "12");
    EXPECT_EQ(bytes_text(3.5 * 1024 * 1024), "3.5 MiB");
    EXPECT_EQ(duration_text(9.96), "10 s");
    EXPECT_EQ(duration_text(125), "2 min 05 s");
    EXPECT_EQ(one_line(" a\n  b \n"), "a b");
}

}  // namespace
}  // namespace burnish
