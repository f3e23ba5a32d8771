// What a run's report says of the search for the start.
#include "cli/report_search.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "cli/run_evidence.h"

namespace burnish {
namespace {

bool says(const std::string& html, const std::string& text) {
    return html.find(text) != std::string::npos;
}

/// A run that searched two unknowns together.
RunResult searched_run(SearchedGroup group) {
    RunResult run;
    run.textures.resize(2);
    run.textures[0].name = "first", run.textures[1].name = "second";
    group.unknowns = {0, 1};
    run.result.summary.searched = {std::move(group)};
    return run;
}

TEST(ReportSearch, ShowsOfManyValuesThoseThatStartMostRegionsOrLoseLeast) {
    SearchedGroup group;
    for (int k = 0; k < 30; ++k)
        group.tried.push_back({{static_cast<float>(k) / 100, 0.75f}, 1.0 + k, k == 29 ? 9u : 0u});
    const std::string html = search_section(searched_run(group));
    for (const char* shown : {"<th>0, 0.75<", "<th>0.1, 0.75<", "<th>0.29, 0.75<"})
        EXPECT_TRUE(says(html, shown)) << shown;
    for (const char* other : {"<th>0.11, 0.75<", "<th>0.28, 0.75<"})
        EXPECT_FALSE(says(html, other)) << other;
    EXPECT_TRUE(says(html, "18 others of 30"));
}

TEST(ReportSearch, ShowsAllOfFewValuesAndNoneOfAColor) {
    SearchedGroup group;
    group.tried = {{{0.5f, 0.1f}, 2, 3}, {{0.5f, 0.9f}, 1, 4}};
    RunResult run = searched_run(group);
    run.textures[0].is_color = true;
    const std::string html = search_section(run);
    EXPECT_TRUE(says(html, "<th>colour, 0.1<") && says(html, "<th>colour, 0.9<")) << html;
    EXPECT_FALSE(says(html, "others of"));
    EXPECT_TRUE(says(html, "loss 2.000 everywhere; 3 regions start here")) << html;
}

TEST(ReportSearch, CountsInTheSingular) {
    SearchedGroup group;
    for (std::size_t k = 0; k < 13; ++k)
        group.tried.push_back({{static_cast<float>(k) / 100, 0.75f}, 1, k == 0 ? 0u : 1u});
    RunResult run = searched_run(group);
    run.result.summary.searched_again = {{8, 1}};
    const std::string html = search_section(run);
    EXPECT_TRUE(says(html, "1 region starts here")) << html;
    EXPECT_TRUE(says(html, "1 other of 13")) << html;
    EXPECT_TRUE(says(html, "before iteration 8: 1 texel took other")) << html;
}

TEST(ReportSearch, SaysWhatTexelsHoldThatNoSampleVisited) {
    RunResult run = searched_run({});
    RecoveredTexture texture;
    texture.coverage = make_image(2, 2, 1, 1.0f);
    run.result.summary.textures = {texture};
    const auto text = [&](std::size_t unvisited, bool filled) {
        run.result.summary.textures[0].unvisited = unvisited;
        run.result.summary.textures[0].filled = filled;
        return unvisited_text(run, 0);
    };
    EXPECT_EQ(text(1, false),
              "No sample of any view came to 1 texel that surfaces read, of 4 in all: it holds the "
              "start.");
    EXPECT_TRUE(
        says(text(3, false), "3 texels that surfaces read, of 4 in all: they hold the start."));
    run.result.summary.searched_again = {{8, 1}};
    EXPECT_TRUE(says(text(2, false), "they hold the start, or what a later search chose."));
    EXPECT_TRUE(says(text(2, true), "they are filled from those around them."));
    EXPECT_TRUE(says(text(1, true), "it is filled from those around it."));
    EXPECT_EQ(text(0, false), "");
}

/// Of one searched texture no other one is at fault.
TEST(ReportSearch, WarnsOfOthersWhereThereAreOthers) {
    SearchedGroup group;
    group.tried = {{{0.5f}, 1, 0}};
    RunResult run = searched_run(group);
    RecoveredTexture seen;
    seen.coverage = make_image(2, 2, 1, 1.0f);
    run.result.summary.textures = {seen, seen};
    warn_of_unseen(run);
    run.result.summary.searched[0].unknowns = {0};
    warn_of_unseen(run);
    EXPECT_EQ(run.picture_warnings,
              (std::vector<std::string>{"no part of a picture shows first, second without other "
                                        "textures that are searched: the start is 0.5",
                                        "no part of a picture tells where first starts: the start "
                                        "is 0.5"}));
}

}  // namespace
}  // namespace burnish
