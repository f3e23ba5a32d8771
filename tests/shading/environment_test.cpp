// Environment maps: radiance against the reference table, sampling against its density.
#include "burnish/shading/environment.h"

#include <gtest/gtest.h>

#include <numbers>

#include "burnish/core/random.h"
#include "csv.h"
#include "ledger_entries.h"
#include "statistics.h"

namespace burnish::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// rotate z * rotate y * rotate x.
Transform rotation_of(const CsvRow& row) {
    return rotation({0, 0, 1}, row["rotate_z_deg"]) * rotation({0, 1, 0}, row["rotate_y_deg"]) *
           rotation({1, 0, 0}, row["rotate_x_deg"]);
}

/// The largest difference to the table, relative to 1 plus the radiance, when our map is turned by
/// `degrees` more.
double worst_difference(double degrees) {
    const Image image = read_image_file(reference_folder() / "tables" / "environment.exr").image;
    double worst = 0;
    for (const CsvRow& row : reference_table("environment.csv")) {
        const Transform to_world = rotation_of(row) * rotation({0, 1, 0}, degrees);
        const EnvironmentEmitter e{image, static_cast<float>(row["scale"]), to_world};
        const Vec3f d{static_cast<float>(row["d_x"]), static_cast<float>(row["d_y"]),
                      static_cast<float>(row["d_z"])};
        const Rgbf ours = radiance(e, d);
        const std::array<double, 3> theirs{row["r"], row["g"], row["b"]};
        for (int c = 0; c < 3; ++c) {
            const double t = theirs[static_cast<std::size_t>(c)];
            worst = std::max(worst, std::abs(static_cast<double>(ours[c]) - t) / (1 + t));
        }
    }
    return worst;
}

/// 3e-5: seven digits of the direction and single precision angles, times slopes of up to a few
/// units per texel.
TEST(Environment, RadianceAgreesWithTheTable) {
    EXPECT_LT(worst_difference(0), 3e-5);
    EXPECT_GT(worst_difference(0.05), 1e-3);  // the comparison sees a twentieth of a degree
}

/// A map with a black half, a bright texel and bright poles.
EnvironmentEmitter uneven_map(int width, int height) {
    EnvironmentEmitter e{make_image(width, height, 3), 2.0f, rotation({1, 2, 3}, 40)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto u =
                uniforms({5, Stream::kTest}, static_cast<std::uint32_t>(y * width + x), 0, 0);
            for (int c = 0; c < 3; ++c)
                e.image.at(x, y, c) =
                    2 * x < width || y == 0 ? u[static_cast<std::size_t>(c)] : 0.0f;
        }
    }
    e.image.at(1, height / 2, 1) = 30;
    return e;
}

/// Cell of a local direction, by the definition of the map.
std::size_t cell_of(const EnvironmentTable& t, const Vec3f& local) {
    const double x = static_cast<double>(local.x), y = static_cast<double>(local.y),
                 z = static_cast<double>(local.z);
    double u = std::atan2(x, -z) / (2 * kPi) * t.columns - 0.5;
    if (u < 0) u += t.columns;
    const double v = std::acos(std::clamp(y, -1.0, 1.0)) / kPi * t.rows;
    const auto row = static_cast<std::size_t>(std::min(v, t.rows - 1.0));
    return row * static_cast<std::size_t>(t.columns) +
           static_cast<std::size_t>(std::min(u, t.columns - 1.0));
}

/// p-value of "half of the samples' cells and halves of cells follow `weight` (solid_angle -> share
/// of the cell)".
double sampling_p_value(const EnvironmentEmitter& e, bool with_solid_angle) {
    const EnvironmentTable t = make_environment_table(e);
    const auto cells = static_cast<std::size_t>(t.columns * t.rows);
    const std::uint32_t samples = scaled(ledger::kEnvironmentWeights, 200000u);
    std::vector<double> observed(cells, 0.0), expected(cells, 0.0);
    for (std::uint32_t i = 0; i < samples; ++i) {
        const auto s = sample_environment(
            t, uniforms({seed_of(ledger::kEnvironmentWeights), Stream::kTest}, i, 0, 0));
        ++observed[cell_of(t, rotate(t.to_local, s.direction_world))];
    }
    double total = 0;
    for (int y = 0; y < t.rows; ++y) {
        const double solid_angle =
            2 * kPi / t.columns * (std::cos(kPi * y / t.rows) - std::cos(kPi * (y + 1) / t.rows));
        for (int x = 0; x < t.columns; ++x) {
            double mean = 0;
            for (const int j : {y, y + 1}) {
                for (const int i : {x, (x + 1) % t.columns}) {
                    mean += luminance(Vec3<double>{static_cast<double>(e.image.at(i, j, 0)),
                                                   static_cast<double>(e.image.at(i, j, 1)),
                                                   static_cast<double>(e.image.at(i, j, 2))}) /
                            4;
                }
            }
            const auto at = static_cast<std::size_t>(y * t.columns + x);
            total += expected[at] = mean * (with_solid_angle ? solid_angle : 1.0);
        }
    }
    for (double& x : expected) x *= samples / total;
    return goodness_of_fit_p_value(observed, expected);
}

TEST(Environment, SamplesFollowTheWeights) {
    const auto a = uneven_map(8, 5), b = uneven_map(3, 2), c = uneven_map(32, 17);
    const LedgerEntry& entry = ledger::kEnvironmentWeights;
    EXPECT_TRUE(accepted(entry, "8 x 5", sampling_p_value(a, true)));
    EXPECT_TRUE(accepted(entry, "3 x 2", sampling_p_value(b, true)));
    EXPECT_TRUE(accepted(entry, "32 x 17", sampling_p_value(c, true)));
    EXPECT_TRUE(rejected(entry, "weights without the solid angle", sampling_p_value(a, false)));
    EXPECT_TRUE(rejected(entry, "weights without the solid angle", sampling_p_value(c, false)));
}

/// The mean of cos^2 to an axis, times 4 pi pdf / weight: an estimate of an integral
/// that is known, which sees where in its cell a direction lies.
TEST(Environment, EstimatesAKnownIntegral) {
    const LedgerEntry& entry = ledger::kEnvironmentIntegral;
    EnvironmentEmitter e = uneven_map(8, 5);
    for (float& x : e.image.values) x += 1.0f;  // a moderate variance, and no cell without density
    const EnvironmentTable t = make_environment_table(e);
    RunningMean mean;
    for (std::uint32_t i = 0; i < scaled(entry, 2000000u); ++i) {
        const auto s = sample_environment(t, uniforms({seed_of(entry), Stream::kTest}, i, 0, 0));
        const double c = static_cast<double>(s.direction_world.y);
        mean.add(c * c / static_cast<double>(s.pdf));
    }
    const double exact = 4 * kPi / 3;
    EXPECT_TRUE(accepted(entry, "cos^2", mean_p_value(mean.mean, mean.standard_error(), exact)));
    EXPECT_TRUE(rejected(entry, "density 1 % too high",
                         mean_p_value(mean.mean / 1.01, mean.standard_error(), exact)));
}

/// What a sample says is what the look-ups say of its direction, but where rounding puts it into
/// the next cell.
TEST(Environment, SamplesAgreeWithLookups) {
    for (const auto& e : {uneven_map(8, 5), uneven_map(64, 33)}) {
        const EnvironmentTable t = make_environment_table(e);
        int other_cell = 0;
        for (std::uint32_t i = 0; i < 20000; ++i) {
            const auto s = sample_environment(t, uniforms({12, Stream::kTest}, i, 0, 0));
            const auto again = lookup_environment(t, s.direction_world);
            EXPECT_NEAR(length(s.direction_world), 1.0f, 1e-6f);
            EXPECT_EQ(again.radiance, radiance(e, s.direction_world));
            other_cell += again.pdf != s.pdf;
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(again.radiance[c], s.radiance[c], 2e-3f);
        }
        EXPECT_LT(other_cell, 20);
    }
}

/// Sixteen at a time, the bits of one at a time.
TEST(Environment, PacketsAgreeWithFloats) {
    const EnvironmentEmitter e = uneven_map(64, 33);
    const EnvironmentTable t = make_environment_table(e);
    for (std::uint32_t i = 0; i < 2000; i += kLanes) {
        std::array<std::array<float, 4>, kLanes> u;
        std::array<Packet, 4> packed;
        for (std::uint32_t k = 0; k < kLanes; ++k) {
            u[k] = uniforms({13, Stream::kTest}, i + k, 0, 0);
            for (std::size_t c = 0; c < 4; ++c) set(packed[c], static_cast<int>(k), u[k][c]);
        }
        const auto sampled = sample_environment(t, packed);
        const auto found = lookup_environment(t, sampled.direction_world);
        for (int k = 0; k < kLanes; ++k) {
            const auto one = sample_environment(t, u[static_cast<std::size_t>(k)]);
            const auto again = lookup_environment(t, one.direction_world);
            EXPECT_EQ(get(sampled.pdf, k), one.pdf);
            EXPECT_EQ(get(found.pdf, k), again.pdf);
            for (int c = 0; c < 3; ++c) {
                EXPECT_EQ(get(sampled.direction_world[c], k), one.direction_world[c]);
                EXPECT_EQ(get(sampled.radiance[c], k), one.radiance[c]);
                EXPECT_EQ(get(found.radiance[c], k), again.radiance[c]);
            }
        }
    }
}

TEST(Environment, BlackMapsAreSampledUniformly) {
    const EnvironmentEmitter e{make_image(4, 3, 3), 1.0f, {}};
    const EnvironmentTable t = make_environment_table(e);
    for (std::uint32_t i = 0; i < 100; ++i)
        EXPECT_NEAR(sample_environment(t, uniforms({2, Stream::kTest}, i, 0, 0)).pdf, 1 / (4 * kPi),
                    1e-6);
}

TEST(Environment, OnePixelAndThePolesWork) {
    EnvironmentEmitter e{make_image(1, 1, 3, 0.5f), 2.0f, {}};
    const EnvironmentTable t = make_environment_table(e);
    for (const Vec3f d :
         {Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}, Vec3f{-1, 0, 0}}) {
        EXPECT_NEAR(lookup_environment(t, d).radiance.x, 1.0f, 1e-6f);
        EXPECT_NEAR(lookup_environment(t, d).pdf, 1 / (4 * kPi), 1e-6);
    }
}

}  // namespace
}  // namespace burnish::test
