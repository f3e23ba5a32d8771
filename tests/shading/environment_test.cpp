// Environment maps: radiance against the reference table, sampling against its density.
#include "shading/environment.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "core/random.h"
#include "csv.h"
#include "ledger_entries.h"
#include "random_source.h"
#include "statistics.h"
#include "worst.h"

namespace burnish::test {
namespace {

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
        const EnvironmentEmitter e{share(image), static_cast<float>(row["scale"]), to_world};
        const Vec3f d{static_cast<float>(row["d_x"]), static_cast<float>(row["d_y"]),
                      static_cast<float>(row["d_z"])};
        const Rgbf ours = radiance(e, d);
        const std::array<double, 3> theirs{row["r"], row["g"], row["b"]};
        for (int c = 0; c < 3; ++c) {
            const double t = theirs[static_cast<std::size_t>(c)];
            worst = test::worse(worst, std::abs(static_cast<double>(ours[c]) - t) / (1 + t));
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
    Image image = make_image(width, height, 3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto u =
                uniforms({5, Stream::kTest}, static_cast<std::uint32_t>(y * width + x), 0, 0);
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = 2 * x < width || y == 0 ? u[static_cast<std::size_t>(c)] : 0.0f;
        }
    }
    image.at(1, height / 2, 1) = 30;
    return {share(std::move(image)), 2.0f, rotation({1, 2, 3}, 40)};
}

/// Cell of a local direction, by the definition of the map.
std::size_t cell_of(const SkyTable& t, const Vec3f& local) {
    const double x = static_cast<double>(local.x), y = static_cast<double>(local.y),
                 z = static_cast<double>(local.z);
    double u = std::atan2(x, -z) / (2 * std::numbers::pi) * t.columns - 0.5;
    if (u < 0) u += t.columns;
    const double v = std::acos(std::clamp(y, -1.0, 1.0)) / std::numbers::pi * t.rows;
    const auto row = static_cast<std::size_t>(std::min(v, t.rows - 1.0));
    return row * static_cast<std::size_t>(t.columns) +
           static_cast<std::size_t>(std::min(u, t.columns - 1.0));
}

/// p-value of "half of the samples' cells and halves of cells follow `weight` (solid_angle -> share
/// of the cell)".
double sampling_p_value(const EnvironmentEmitter& e, bool with_solid_angle) {
    const EnvironmentTable table = make_environment_table(e);
    const SkyTable& t = *table.sky;
    const auto cells = static_cast<std::size_t>(t.columns * t.rows);
    const std::uint32_t samples = scaled(ledger::kEnvironmentWeights, 200000u);
    std::vector<double> observed(cells, 0.0), expected(cells, 0.0);
    for (std::uint32_t i = 0; i < samples; ++i) {
        const auto s = sample_environment(
            table, uniforms({seed_of(ledger::kEnvironmentWeights), Stream::kTest}, i, 0, 0));
        ++observed[cell_of(t, rotate(table.to_local, s.direction_world))];
    }
    double total = 0;
    for (int y = 0; y < t.rows; ++y) {
        const double solid_angle = 2 * std::numbers::pi / t.columns *
                                   (std::cos(std::numbers::pi * y / t.rows) -
                                    std::cos(std::numbers::pi * (y + 1) / t.rows));
        for (int x = 0; x < t.columns; ++x) {
            double mean = 0;
            for (const int j : {y, y + 1}) {
                for (const int i : {x, (x + 1) % t.columns}) {
                    mean += luminance(Vec3<double>{static_cast<double>(e.image->at(i, j, 0)),
                                                   static_cast<double>(e.image->at(i, j, 1)),
                                                   static_cast<double>(e.image->at(i, j, 2))}) /
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
    Image brighter = *e.image;  // a moderate variance, and no cell without density
    for (float& x : brighter.values) x += 1.0f;
    e.image = share(std::move(brighter));
    const EnvironmentTable t = make_environment_table(e);
    RunningMean mean;
    for (std::uint32_t i = 0; i < scaled(entry, 2000000u); ++i) {
        const auto s = sample_environment(t, uniforms({seed_of(entry), Stream::kTest}, i, 0, 0));
        const double c = static_cast<double>(s.direction_world.y);
        mean.add(c * c / static_cast<double>(s.pdf));
    }
    const double exact = 4 * std::numbers::pi / 3;
    EXPECT_TRUE(accepted(entry, "cos^2", mean_p_value(mean.mean, mean.standard_error(), exact)));
    EXPECT_TRUE(rejected(entry, "density 1 % too high",
                         mean_p_value(mean.mean / 1.01, mean.standard_error(), exact)));
}

/// Any small map, every sixth of at most 3 x 3 texels: texels and every other time a whole row that
/// are black, most with one texel that outshines the others; turned, enlarged, every fourth
/// mirrored.
EnvironmentEmitter random_map(std::uint32_t i) {
    RandomSource random{seed_of(ledger::kRandomEnvironment, 500000 + i)};
    const auto below = [&](int count) {
        return std::min(static_cast<int>(random.next(0, static_cast<float>(count))), count - 1);
    };
    const auto power_of_ten = [&](float low, float high) {
        return std::pow(10.0f, random.next(low, high));
    };
    const bool tiny = i % 6 == 5;
    Image image =
        make_image(tiny ? 1 + below(3) : 4 + below(13), tiny ? 1 + below(3) : 3 + below(10), 3);
    const int black_row = i % 2 == 0 ? below(image.height) : -1;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const bool black = y == black_row || random.next() < 0.2f;
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = black ? 0.0f : random.next();
        }
    if (i % 3 != 0)
        image.at(below(image.width), below(image.height), below(3)) = power_of_ten(1, 5);
    const Vec3<double> axis{random.next(-1, 1), random.next(-1, 1), random.next(0.1f, 1)};
    const double size = power_of_ten(-2, 2);
    return {
        share(image), power_of_ten(-2, 2),
        rotation(axis, random.next(20, 160)) * scaling({i % 4 == 3 ? -size : size, size, size})};
}

/// The quarters of the cells between four texels, of equal solid angle in each cell, by the
/// definition of the map and in double.
struct QuarterCells {
    int columns = 0, rows = 0;  ///< quarters: two a cell
    Transform to_local, to_world;

    explicit QuarterCells(const EnvironmentEmitter& e)
        : columns(2 * e.image->width),
          rows(2 * std::max(e.image->height - 1, 1)),
          to_local(inverse(e.to_world)),
          to_world(e.to_world) {}

    std::size_t count() const { return static_cast<std::size_t>(columns * rows); }
    /// Cosine of the polar angle where a row of quarters begins.
    double cosine(int row) const {
        const auto of_cell = [&](int cell) { return std::cos(2 * std::numbers::pi * cell / rows); };
        return 0.5 * (of_cell(row / 2) + of_cell((row + 1) / 2));
    }
    std::size_t index(const Vec3<double>& world) const {
        const Vec3<double> d = normalize(linear(to_local, world));
        double u = std::atan2(d.x, -d.z) / (2 * std::numbers::pi) * columns - 1;
        if (u < 0) u += columns;
        int row = 0;
        while (row + 1 < rows && d.y < cosine(row + 1)) ++row;
        return static_cast<std::size_t>(row * columns + std::min(static_cast<int>(u), columns - 1));
    }
    Vec3<double> middle(std::size_t i) const {
        const auto n = static_cast<std::size_t>(columns);
        const int row = static_cast<int>(i / n);
        const double phi = 2 * std::numbers::pi * (static_cast<double>(i % n) + 1.5) / columns,
                     y = 0.5 * (cosine(row) + cosine(row + 1)), sine = std::sqrt(1 - y * y);
        return normalize(linear(to_world, {std::sin(phi) * sine, y, -std::cos(phi) * sine}));
    }
    double solid_angle(std::size_t i) const {
        const int row = static_cast<int>(i / static_cast<std::size_t>(columns));
        return 2 * std::numbers::pi / columns * (cosine(row) - cosine(row + 1));
    }

  private:
    static Vec3<double> linear(const Transform& t, const Vec3<double>& v) {
        const auto row = [&](int i) { return t(i, 0) * v.x + t(i, 1) * v.y + t(i, 2) * v.z; };
        return {row(0), row(1), row(2)};
    }
};

/// p-value of "the samples of `drawn` have the density that look-ups in `stated` state".
double density_p_value(const EnvironmentEmitter& drawn, const EnvironmentEmitter& stated,
                       std::uint32_t seed) {
    const EnvironmentTable table = make_environment_table(drawn),
                           other = make_environment_table(stated);
    const QuarterCells quarters(stated);
    const LedgerEntry& entry = ledger::kRandomEnvironment;
    const std::uint32_t samples = scaled(entry, 200000u);
    std::vector<double> observed(quarters.count(), 0.0), expected;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const Vec3f d =
            sample_environment(table, uniforms({seed_of(entry, seed), Stream::kTest}, i, 0, 0))
                .direction_world;
        ++observed[quarters.index({double{d.x}, double{d.y}, double{d.z}})];
    }
    for (std::size_t i = 0; i < quarters.count(); ++i) {
        const Vec3<double> d = quarters.middle(i);
        const float pdf =
            lookup_environment(other, Vec3f{static_cast<float>(d.x), static_cast<float>(d.y),
                                            static_cast<float>(d.z)})
                .pdf;
        // Never exactly impossible: rounding may take a direction across the border of its cell.
        expected.push_back(std::max(double{pdf} * quarters.solid_angle(i) * samples, 1e-6));
    }
    const double total = std::accumulate(expected.begin(), expected.end(), 0.0) / samples;
    EXPECT_NEAR(total, 1, 1e-5);
    return goodness_of_fit_p_value(observed, expected);
}

TEST(Environment, SamplesOfAnyMapFollowTheDensityOfLookups) {
    const LedgerEntry& entry = ledger::kRandomEnvironment;
    std::uint32_t seed = 0;
    for (std::uint32_t i = 0; i < 24; ++i) {
        const EnvironmentEmitter map = random_map(i);
        const std::string text =
            fmt::format("map {}: {} x {}", i, map.image->width, map.image->height);
        EXPECT_TRUE(accepted(entry, text, density_p_value(map, map, seed += 10)));
        if (map.image->width < 4) continue;  // may look the same from all sides
        EnvironmentEmitter other = map;
        other.to_world = inverse(map.to_world);
        EXPECT_TRUE(rejected(entry, "rotation inverted", density_p_value(map, other, seed += 10)))
            << text;
        other.to_world = map.to_world * rotation({0, 1, 0}, 180.0 / map.image->width);
        EXPECT_TRUE(
            rejected(entry, "turned by half a texel", density_p_value(map, other, seed += 10)))
            << text;
    }
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

TEST(Environment, OfOneImageShareATable) {
    const EnvironmentEmitter e = uneven_map(8, 5);
    const EnvironmentTable t = make_environment_table(e);
    const EnvironmentEmitter turned{e.image, 3.0f, rotation({0, 1, 0}, 70)},
        same_values{share(*e.image), e.scale, e.to_world};
    const EnvironmentTable shared = make_environment_table(turned, t.sky),
                           own = make_environment_table(turned);
    EXPECT_EQ(shared.sky, t.sky);
    EXPECT_NE(own.sky, t.sky);
    EXPECT_NE(make_environment_table(same_values, t.sky).sky, t.sky);
    for (std::uint32_t i = 0; i < 100; ++i) {
        const auto u = uniforms({14, Stream::kTest}, i, 0, 0);
        const EnvironmentSample a = sample_environment(shared, u), b = sample_environment(own, u);
        EXPECT_EQ(a.direction_world, b.direction_world);
        EXPECT_EQ(a.pdf, b.pdf);
        EXPECT_EQ(a.radiance, b.radiance);
    }
}

TEST(Environment, BlackMapsAreSampledUniformly) {
    const EnvironmentEmitter e{share(make_image(4, 3, 3)), 1.0f, {}};
    const EnvironmentTable t = make_environment_table(e);
    for (std::uint32_t i = 0; i < 100; ++i)
        EXPECT_NEAR(sample_environment(t, uniforms({2, Stream::kTest}, i, 0, 0)).pdf,
                    1 / (4 * std::numbers::pi), 1e-6);
}

TEST(Environment, OnePixelAndThePolesWork) {
    EnvironmentEmitter e{share(make_image(1, 1, 3, 0.5f)), 2.0f, {}};
    const EnvironmentTable t = make_environment_table(e);
    for (const Vec3f d :
         {Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}, Vec3f{-1, 0, 0}}) {
        EXPECT_NEAR(lookup_environment(t, d).radiance.x, 1.0f, 1e-6f);
        EXPECT_NEAR(lookup_environment(t, d).pdf, 1 / (4 * std::numbers::pi), 1e-6);
    }
}

}  // namespace
}  // namespace burnish::test
