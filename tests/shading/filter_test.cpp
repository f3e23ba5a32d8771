// Reconstruction filters against the reference table, and their integrals against closed forms.
#include "shading/filter.h"

#include <gtest/gtest.h>

#include "csv.h"
#include "worst.h"

namespace burnish::test {
namespace {

/// Filters 0-6 of the table.
ReconstructionFilter filter_of(int id) {
    const std::array<FilterKind, 7> kinds{FilterKind::kBox,      FilterKind::kTent,
                                          FilterKind::kGaussian, FilterKind::kGaussian,
                                          FilterKind::kMitchell, FilterKind::kCatmullRom,
                                          FilterKind::kLanczos};
    const std::array<float, 7> radii{0.5f, 1, 2, 3.2f, 2, 2, 3};
    ReconstructionFilter f;
    f.kind = kinds[static_cast<std::size_t>(id)];
    f.radius = radii[static_cast<std::size_t>(id)];
    if (id == 3) f.stddev = 0.8f;
    return f;
}

/// Single precision noise of the table. The Gaussian is there an alternating polynomial of degree 9
/// in t^2 <= 16, whose absolute coefficients add up to 716 at t = 4: half an ulp of each term is
/// 4e-5; the terms' errors are independent, and a quarter is allowed.
double tolerance(int id) { return id == 2 || id == 3 ? 1e-5 : 1e-6; }

TEST(Filter, AgreesWithTheTable) {
    for (const CsvRow& row : reference_table("filter.csv")) {
        const int id = static_cast<int>(row["filter"]);
        const ReconstructionFilter f = filter_of(id);
        EXPECT_NEAR(f.radius, row["radius"], 1e-6);
        EXPECT_NEAR(eval_filter(f, static_cast<float>(row["x"])), row["weight"], tolerance(id))
            << "line " << row.line;
    }
}

/// The exact Gaussian is not what Mitsuba evaluates: the table rejects it.
TEST(Filter, TheTableRejectsTheExactGaussian) {
    double worst = 0;
    for (const CsvRow& row : reference_table("filter.csv")) {
        if (row["filter"] != 2) continue;
        const double exact = std::exp(-2 * row["x"] * row["x"]) - std::exp(-8.0);
        worst = test::worse(worst, std::abs(exact - row["weight"]));
    }
    EXPECT_GT(worst, 10 * tolerance(2));
    EXPECT_LT(worst, 5e-4);
}

TEST(Filter, VanishesOutsideItsRadiusAndIsEven) {
    for (int id = 0; id < 7; ++id) {
        const ReconstructionFilter f = filter_of(id);
        EXPECT_EQ(eval_filter(f, f.radius * 1.0001f), 0.0f);
        EXPECT_EQ(eval_filter(f, -f.radius * 1.0001f), 0.0f);
        EXPECT_EQ(eval_filter(f, NAN), 0.0f);
        EXPECT_EQ(eval_filter(f, 0.37f), eval_filter(f, -0.37f));
    }
}

TEST(Filter, WholeIntegralsHaveTheirClosedForms) {
    const auto whole = [](int id) { return filter_integral_exact(filter_of(id), -100, 100); };
    EXPECT_NEAR(whole(0), 1, 1e-12);
    EXPECT_NEAR(whole(1), 1, 1e-12);
    EXPECT_NEAR(whole(4), 1, 1e-7);  // b = c = 1/3 in single precision
    EXPECT_NEAR(whole(5), 1, 1e-12);
    // The polynomial is within 4e-4 of the Gaussian, alternating.
    EXPECT_NEAR(
        whole(2),
        0.5 * std::sqrt(2 * std::numbers::pi) * std::erf(4 / std::sqrt(2.0)) - 4 * std::exp(-8.0),
        2e-4);
}

/// Against the midpoint rule on a million points, for parts that begin and end anywhere.
TEST(Filter, PartialIntegralsAgreeWithTheMidpointRule) {
    for (int id = 0; id < 7; ++id) {
        const ReconstructionFilter f = filter_of(id);
        for (const auto& [a, b] :
             {std::pair{-0.31, 0.27}, {-5.0, 0.4}, {0.21, 1.9}, {1.2, 9.0}, {0.3, 0.3}}) {
            constexpr int kPoints = 1000000;
            double sum = 0;
            for (int i = 0; i < kPoints; ++i)
                sum += eval_filter_exact(f, a + (b - a) * (i + 0.5) / kPoints) * (b - a) / kPoints;
            EXPECT_NEAR(filter_integral_exact(f, a, b), sum, 1e-6 + (id == 0 ? 1e-5 : 0))
                << id << " " << a;
        }
    }
}

}  // namespace
}  // namespace burnish::test
