// BSDFs of interfaces against the reference tables.
//
// The tables were made in single precision and printed with seven digits. The allowed difference of
// a value is 1e-4 of the row's largest channel, and how far our own double evaluation moves when
// the numbers of the row move by the printed half unit and two ulps. The reference has no facets
// whose density is below 1e-20. The transmittance of `roughplastic` comes from another quadrature
// than the reference's with facets of Beckmann: up to 3e-4 there.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "interface_table.h"
#include "shading/printed_step.h"
#include "worst.h"

namespace burnish::test {
namespace {

struct Table {
    const char* file;
    RowBsdf bsdf_of;
    double tolerance;  ///< of the row's largest channel
};
const Table kTables[] = {
    {"roughconductor.csv", rough_conductor_of, 1e-4},
    {"plastic.csv", plastic_of, 1e-4},
    {"roughplastic.csv", rough_plastic_of, 3e-4},
    {"roughdielectric.csv", rough_dielectric_of, 1e-4},
    {"principledthin.csv", principled_thin_of, 1e-4},
};

/// How far the channels move at most when any number of the row moves by its rounding.
double spread_of(const InterfaceRow& row, const std::function<double(double)>& step) {
    double spread = 0;
    const auto at = evaluate<double>(row.bsdf, row.numbers);
    for (std::size_t i = 0; i < kRowNumbers; ++i)
        for (const double sign : {-1.0, 1.0}) {
            RowNumbers moved = row.numbers;
            moved[i] += sign * step(moved[i]);
            const auto there = evaluate<double>(row.bsdf, moved);
            double worst = 0;
            for (std::size_t c = 0; c < 3; ++c)
                worst = test::worse(worst, std::abs(there.f[c] - at.f[c]));
            spread += 0.5 * worst;
        }
    return spread;
}

/// The row's largest difference over what is allowed.
double ratio_of(const InterfaceRow& row, const Bsdf& bsdf, const RowNumbers& numbers,
                double tolerance) {
    const auto ours = evaluate<double>(bsdf, numbers);
    const double largest = std::max({row.f[0], row.f[1], row.f[2]});
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) worst = test::worse(worst, std::abs(ours.f[c] - row.f[c]));
    if (!std::isfinite(worst)) return HUGE_VAL;
    return worst / (tolerance * largest + spread_of(row, printed_step) + 1e-18);
}

TEST(Interfaces, AgreeWithTheTables) {
    for (const Table& table : kTables) {
        const auto rows = interface_rows(table.file, table.bsdf_of);
        double worst = 0;
        for (const InterfaceRow& row : rows) {
            const double ratio = ratio_of(row, row.bsdf, row.numbers, table.tolerance);
            worst = test::worse(worst, ratio);
            EXPECT_LE(ratio, 1) << table.file << ":" << row.line;
        }
        RecordProperty(table.file, std::to_string(worst));
    }
}

/// Rows outside of what is allowed when the BSDF or its inputs change.
std::size_t rows_outside(const Table& table,
                         const std::function<void(Bsdf&, RowNumbers&)>& change) {
    std::size_t outside = 0;
    for (const InterfaceRow& row : interface_rows(table.file, table.bsdf_of)) {
        Bsdf bsdf = row.bsdf;
        RowNumbers numbers = row.numbers;
        change(bsdf, numbers);
        outside += ratio_of(row, bsdf, numbers, table.tolerance) > 1;
    }
    return outside;
}

TEST(Interfaces, TheTablesRejectDefects) {
    const Table &metal = kTables[0], &plastic = kTables[1], &rough_plastic = kTables[2];
    const auto swap_shape = [](FacetShape& s) {
        s = s == FacetShape::kGgx ? FacetShape::kBeckmann : FacetShape::kGgx;
    };
    EXPECT_GT(rows_outside(metal, [](Bsdf&, RowNumbers& n) { n[3] *= 1.003; }), 500u);
    EXPECT_GT(rows_outside(metal, [](Bsdf&, RowNumbers& n) { std::swap(n[3], n[4]); }), 500u);
    EXPECT_GT(rows_outside(metal,
                           [&](Bsdf& b, RowNumbers&) {
                               swap_shape(std::get<RoughConductor>(b).roughness.shape);
                           }),
              500u);
    EXPECT_GT(
        rows_outside(metal,
                     [](Bsdf& b, RowNumbers&) { std::get<RoughConductor>(b).index.k.y *= 1.003f; }),
        200u);
    EXPECT_GT(
        rows_outside(plastic, [](Bsdf& b, RowNumbers&) { std::get<Plastic>(b).eta *= 1.003f; }),
        100u);
    EXPECT_GT(
        rows_outside(plastic, [](Bsdf& b, RowNumbers&) { std::get<Plastic>(b).nonlinear ^= true; }),
        100u);
    EXPECT_GT(rows_outside(rough_plastic,
                           [](Bsdf& b, RowNumbers&) { std::get<RoughPlastic>(b).alpha *= 1.02f; }),
              200u);
    EXPECT_GT(rows_outside(rough_plastic,
                           [](Bsdf& b, RowNumbers&) {
                               std::get<RoughPlastic>(b).internal_reflectance *= 1.02f;
                           }),
              200u);
    EXPECT_GT(rows_outside(rough_plastic,
                           [](Bsdf& b, RowNumbers&) {
                               for (float& t : std::get<RoughPlastic>(b).transmittance) t *= 1.01f;
                           }),
              200u);
}

TEST(Interfaces, TheTableOfGlassRejectsDefects) {
    const Table& glass = kTables[3];
    EXPECT_GT(rows_outside(glass, [](Bsdf&, RowNumbers& n) { n[6] *= 1.003; }), 500u);
    EXPECT_GT(rows_outside(glass, [](Bsdf&, RowNumbers& n) { std::swap(n[0], n[3]); }), 500u);
    EXPECT_GT(rows_outside(
                  glass, [](Bsdf& b, RowNumbers&) { std::get<RoughDielectric>(b).eta *= 1.001f; }),
              500u);
}

TEST(Interfaces, TheTableOfSheetsRejectsDefects) {
    const Table& sheet = kTables[4];
    for (std::size_t k = 0; k < kThinScalars; ++k)
        EXPECT_GT(rows_outside(sheet, [k](Bsdf&, RowNumbers& n) { n[kBsdfColor + k] += 0.01; }),
                  50u)
            << k;
    EXPECT_GT(rows_outside(sheet,
                           [](Bsdf& b, RowNumbers&) { std::get<PrincipledThin>(b).eta *= 1.003f; }),
              50u);
}

/// Where facets are sampled as the reference does, GGX, the density is the reference's.
TEST(Interfaces, DensitiesOfGgxAreThoseOfTheTables) {
    for (const Table& table : kTables) {
        std::size_t compared = 0;
        for (const InterfaceRow& row : interface_rows(table.file, table.bsdf_of)) {
            const auto* metal = std::get_if<RoughConductor>(&row.bsdf);
            const auto* plastic = std::get_if<RoughPlastic>(&row.bsdf);
            if (metal && metal->roughness.shape != FacetShape::kGgx) continue;
            if (plastic && plastic->shape != FacetShape::kGgx) continue;
            const auto* glass = std::get_if<RoughDielectric>(&row.bsdf);
            if (glass && glass->roughness.shape != FacetShape::kGgx) continue;
            if (row.f[1] == 0) continue;  // the reference has densities of what it never samples
            const double ours = evaluate<double>(row.bsdf, row.numbers).pdf;
            EXPECT_NEAR(ours, row.pdf, 3e-3 * row.pdf + 1e-12) << table.file << ":" << row.line;
            ++compared;
        }
        EXPECT_GT(compared, 100u) << table.file;
    }
}

/// Float against double on the same inputs: 2e-5 of the row's largest, and the inputs moved by two
/// ulps.
TEST(Interfaces, FloatAgreesWithDouble) {
    for (const Table& table : kTables)
        for (InterfaceRow row : interface_rows(table.file, table.bsdf_of)) {
            for (double& x : row.numbers) x = static_cast<double>(static_cast<float>(x));
            const auto slow = evaluate<double>(row.bsdf, row.numbers);
            const auto fast = evaluate<float>(row.bsdf, row.numbers);
            const double spread =
                spread_of(row, [](double x) { return 4 * kHalfUlp * std::abs(x); });
            const double largest = std::max({slow.f[0], slow.f[1], slow.f[2]});
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(double{fast.f[c]}, slow.f[c], 2e-5 * largest + spread + 1e-30)
                    << table.file << ":" << row.line;
        }
}

/// Of each input that a kind has, by central differences in double.
TEST(Interfaces, DerivativesAreSlopes) {
    using T = Dual<double, kBsdfInputs>;
    for (const Table& table : kTables) {
        const auto rows = interface_rows(table.file, table.bsdf_of);
        for (std::size_t r = 0; r < rows.size(); r += 7) {
            const InterfaceRow& row = rows[r];
            BsdfInputs<T> inputs;
            for (std::size_t i = 0; i < kBsdfInputs; ++i)
                inputs[i] = variable<kBsdfInputs>(row.numbers[i], static_cast<int>(i));
            const Rgb<T> f = std::visit(
                [&](const auto& b) -> Rgb<T> {
                    return eval_bsdf(bsdf_parameters(b, inputs),
                                     direction_of<double>(row.numbers, kBsdfInputs),
                                     direction_of<double>(row.numbers, kBsdfInputs + 3));
                },
                row.bsdf);
            const double largest = std::max({f.x.v, f.y.v, f.z.v});
            for (std::size_t i = 0; i < kBsdfInputs; ++i) {
                const double h = 1e-5 * std::max(0.05, row.numbers[i]);
                RowNumbers low = row.numbers, high = row.numbers;
                low[i] -= h, high[i] += h;
                const auto below = evaluate<double>(row.bsdf, low),
                           above = evaluate<double>(row.bsdf, high);
                const double d[] = {f.x.d[i], f.y.d[i], f.z.d[i]};
                for (std::size_t c = 0; c < 3; ++c) {
                    const double slope = (above.f[c] - below.f[c]) / (2 * h);
                    EXPECT_NEAR(d[c], slope, 1e-4 * std::abs(slope) + 1e-4 * largest)
                        << table.file << ":" << row.line << " input " << i;
                }
            }
        }
    }
}

}  // namespace
}  // namespace burnish::test
