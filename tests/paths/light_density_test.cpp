// The directions that lights are sampled in against the density that is stated of a direction
// (chi-square), from random positions. The cells are halves of rings about the mean direction of a
// pilot run; the mass of the density in a cell is its mean over uniform directions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ledger_entries.h"
#include "paths/one_light.h"
#include "shading/sphere_integral.h"

namespace burnish::test {
namespace {

using ledger::kLateLightDensity;
using ledger::kLightDensity;

/// Directions of samples that bring light; those of the point light and failures are left out.
template <class Add>
void direct_sample(const Scene& scene, const Vec3f& origin, std::uint32_t seed, int count,
                   Add add) {
    const TracedScene traced = prepare(scene);
    RandomSource random{seed};
    for (int i = 0; i < count; ++i) {
        const std::array<float, 4> u{random.next(), random.next(), random.next(), random.next()};
        const LightSample s = sample_light(*traced.lights, origin, u);
        if (s.delta || !(s.pdf > 0) || is_black(s.radiance)) continue;
        const Vec3f d = s.direction_world;
        add(normalize(Direction{double{d.x}, double{d.y}, double{d.z}}));
    }
}

/// Half a ring: so large that uniform directions meet a light there a thousand times, and the error
/// of the mean is normal.
constexpr std::size_t kBinsPerCell = detail::kSectors / 2;
std::size_t cell_of(const detail::Bins& bins, const Direction& d) {
    return bins.index(d) / kBinsPerCell;
}
std::size_t cell_count(const detail::Bins& bins) { return bins.count() / kBinsPerCell; }

/// Estimates of the probability of each cell, with their variances.
struct Masses {
    std::vector<double> mean, variance;
};

Masses masses_of(const std::vector<double>& sum, const std::vector<double>& squares, double count) {
    Masses m;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        m.mean.push_back(sum[i] / count);
        m.variance.push_back((squares[i] / count - m.mean[i] * m.mean[i]) / count);
    }
    return m;
}

Masses by_draws(const Scene& scene, const Vec3f& origin, const detail::Bins& bins,
                std::uint32_t seed) {
    const int count = scaled(kLightDensity, 200000);
    std::vector<double> sum(cell_count(bins));
    direct_sample(scene, origin, seed, count, [&](const Direction& d) { ++sum[cell_of(bins, d)]; });
    return masses_of(sum, sum, count);
}

Masses by_density(const Scene& scene, const Vec3f& origin, const detail::Bins& bins,
                  std::uint32_t seed) {
    const TracedScene traced = prepare(scene);
    const int count = scaled(kLightDensity, 800000);
    RandomSource random{seed};
    std::vector<double> sum(cell_count(bins)), squares(cell_count(bins));
    for (int i = 0; i < count; ++i) {
        const float z = random.next(-1, 1), phi = 2 * std::numbers::pi_v<float> * random.next();
        const float r = std::sqrt(1 - z * z);
        const Vec3f d{r * std::cos(phi), r * std::sin(phi), z};
        const double mass = double{emission_along(traced, origin, d).pdf} * 4 * std::numbers::pi;
        const std::size_t cell = cell_of(bins, {double{d.x}, double{d.y}, double{d.z}});
        sum[cell] += mass, squares[cell] += mass * mass;
    }
    return masses_of(sum, squares, count);
}

/// p-value of "the samples from `origin` in `drawn` have the density that `stated` states".
double density_p_value(const LedgerEntry& entry, const Scene& drawn, const Scene& stated,
                       const Vec3f& origin, std::uint32_t seed) {
    std::vector<Direction> pilot;
    Direction mean{};
    direct_sample(drawn, origin, seed_of(entry, seed + 2), 20000, [&](const Direction& d) {
        pilot.push_back(d);
        mean = mean + d;
    });
    const detail::Bins bins = detail::make_bins(Polar(normalize(mean)), pilot, false);
    std::vector<double> pilots(cell_count(bins));
    for (const Direction& d : pilot) ++pilots[cell_of(bins, d)];

    const Masses a = by_draws(drawn, origin, bins, seed_of(entry, seed)),
                 b = by_density(stated, origin, bins, seed_of(entry, seed + 1));
    double statistic = 0, degrees = 0, rest = 0, rest_variance = 0;
    const auto add = [&](double difference, double variance) {
        if (variance == 0 && difference == 0) return;  // nothing is there
        statistic += std::isfinite(variance) ? difference * difference / variance : std::nan("");
        ++degrees;
    };
    for (std::size_t i = 0; i < cell_count(bins); ++i) {
        const double difference = a.mean[i] - b.mean[i], variance = a.variance[i] + b.variance[i];
        if (pilots[i] >= 100)
            add(difference, variance);
        else
            rest += difference, rest_variance += variance;  // too few to be normal alone
    }
    add(rest, rest_variance);
    return chi_square_p_value(statistic, degrees);
}

class LightDensity : public testing::TestWithParam<LightKind> {};

TEST_P(LightDensity, OfRandomPositionsIsThatOfTheDraws) {
    const LightKind kind = GetParam();
    const auto index = static_cast<std::uint32_t>(kind);
    const Scene scene = make_light(kind);
    const LedgerEntry& entry = is_late(kind) ? kLateLightDensity : kLightDensity;
    for (std::uint32_t i = 0; i < 2; ++i) {
        RandomSource random{seed_of(entry, 500000 + 2 * index + i)};
        const Vec3f origin{random.next(-0.4f, 0.4f), random.next(-0.4f, 0.4f),
                           random.next(-0.4f, 0.3f)};
        const std::uint32_t seed = 100 * index + 10 * i;
        EXPECT_TRUE(accepted(entry, fmt::format("kind {}, position {}", index, i),
                             density_p_value(entry, scene, scene, origin, seed)));
        if (kind == LightKind::kConstant || kind == LightKind::kFlippedSphere ||
            kind == LightKind::kFlippedCylinder)
            continue;
        Scene other = make_light(kind, 1.1f);
        if (auto* sky = std::get_if<EnvironmentEmitter>(&other.emitters[1]))
            sky->to_world = sky->to_world * rotation({0, 1, 0}, 10);
        EXPECT_TRUE(rejected(entry, "density of a light 10 % larger or turned",
                             density_p_value(entry, scene, other, origin, seed + 5)));
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, LightDensity,
                         testing::Values(LightKind::kQuad, LightKind::kSphere,
                                         LightKind::kFlippedSphere, LightKind::kDisk,
                                         LightKind::kConstant, LightKind::kEnvironment,
                                         LightKind::kCylinder, LightKind::kFlippedCylinder,
                                         LightKind::kTexturedQuad));

}  // namespace
}  // namespace burnish::test
