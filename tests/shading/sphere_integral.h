// Densities over directions: their integrals over parts of the sphere, and chi-square tests of
// samplers against them.
//
// Bins are rings around an axis, cut into sectors. The rings' edges are quantiles of a pilot run,
// so that the bins resolve any lobe, however narrow; the expected counts come from adaptive
// quadrature of the density. The sectors are alike, unless a lobe is known to be narrow in azimuth:
// then their edges are quantiles too, on both sides of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "core/random.h"
#include "core/vec.h"
#include "statistics.h"

namespace burnish::test {

using Direction = Vec3<double>;
using Density = std::function<double(const Direction&)>;
/// A direction for four independent uniforms, or nothing where the sampler fails.
using Sampler = std::function<std::optional<Direction>(const std::array<double, 4>&)>;

/// Spherical coordinates about an axis.
struct Polar {
    Direction axis, s, t;

    explicit Polar(const Direction& unit_axis) : axis(unit_axis) {
        const Direction other = std::abs(axis.x) < 0.5 ? Direction{1, 0, 0} : Direction{0, 1, 0};
        s = normalize(cross(other, axis));
        t = cross(axis, s);
    }
    /// phi = 0 towards a direction that is not parallel to the axis.
    Polar(const Direction& unit_axis, const Direction& zero) : axis(unit_axis) {
        t = normalize(cross(axis, zero));
        s = cross(t, axis);
    }
    Direction at(double theta, double phi) const {
        return axis * std::cos(theta) + s * (std::sin(theta) * std::cos(phi)) +
               t * (std::sin(theta) * std::sin(phi));
    }
    double theta(const Direction& d) const {
        return std::atan2(std::hypot(dot(d, s), dot(d, t)), dot(d, axis));
    }
    /// In [-pi, pi].
    double phi(const Direction& d) const { return std::atan2(dot(d, t), dot(d, s)); }
};

/// Splits before and in all, at most.
inline constexpr int kMaxDepth = 11, kSureDepth = kMaxDepth - 2;

/// a to b in theta, c to d in phi.
using Rectangle = std::array<double, 4>;

/// Integral of f(theta, phi) over a rectangle by 3x3 Gauss-Legendre points.
template <class F>
double gauss_legendre(const F& f, const Rectangle& r) {
    constexpr std::array<double, 3> kNode{-0.7745966692414834, 0, 0.7745966692414834};
    constexpr std::array<double, 3> kWeight{5.0 / 18, 8.0 / 18, 5.0 / 18};
    const auto [a, b, c, d] = r;
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            sum += kWeight[i] * kWeight[j] *
                   f(0.5 * (a + b + (b - a) * kNode[i]), 0.5 * (c + d + (d - c) * kNode[j]));
        }
    }
    return sum * (b - a) * (d - c);
}

inline std::array<Rectangle, 4> quarters(const Rectangle& r) {
    const auto [a, b, c, d] = r;
    const double x = 0.5 * (a + b), y = 0.5 * (c + d);
    return {{{a, x, c, y}, {x, b, c, y}, {a, x, y, d}, {x, b, y, d}}};
}

/// Splits in four until the parts agree with the whole, of which `whole` is the rule's result, to
/// `tolerance`, or `depth` is 0.
template <class F>
double refine(const F& f, const Rectangle& r, double whole, double tolerance, int depth) {
    const std::array<Rectangle, 4> parts = quarters(r);
    std::array<double, 4> of_parts;
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += of_parts[k] = gauss_legendre(f, parts[k]);
    if (depth == 0 || std::abs(sum - whole) < tolerance) return sum;
    sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
        sum += refine(f, parts[k], of_parts[k], tolerance / 2, depth - 1);
    return sum;
}

/// The same, split a few times in any case.
template <class F>
double integrate_rectangle(const F& f, const Rectangle& r, double tolerance, int depth) {
    if (depth < kSureDepth) return refine(f, r, gauss_legendre(f, r), tolerance, depth);
    double sum = 0;
    for (const Rectangle& part : quarters(r))
        sum += integrate_rectangle(f, part, tolerance / 2, depth - 1);
    return sum;
}

/// Integral of the density over the ring section theta in [a, b], phi in [c, d]. In the logarithm
/// of theta where the ring does not begin at the axis: the tail of a narrow lobe may span decades.
inline double integrate_section(const Density& density, const Polar& polar, double a, double b,
                                double c, double d) {
    const auto f = [&](double theta, double phi) {
        return density(polar.at(theta, phi)) * std::sin(theta);
    };
    constexpr double kTolerance = 1e-6;
    if (a == 0) return integrate_rectangle(f, {a, b, c, d}, kTolerance, kMaxDepth);
    const auto g = [&](double log_theta, double phi) {
        const double theta = std::exp(log_theta);
        return f(theta, phi) * theta;
    };
    return integrate_rectangle(g, {std::log(a), std::log(b), c, d}, kTolerance, kMaxDepth);
}

/// The same where the density is narrow about phi = 0, which is not inside of [c, d]: in the fifth
/// root of phi, which resolves every scale from 1e-5 on alike.
inline double integrate_narrow_section(const Density& density, const Polar& polar, double a,
                                       double b, double c, double d) {
    const auto root = [](double phi) { return std::copysign(std::pow(std::abs(phi), 0.2), phi); };
    const auto f = [&](double theta, double u) {
        const double u4 = u * u * u * u;
        return density(polar.at(theta, u4 * u)) * std::sin(theta) * 5 * u4;
    };
    return integrate_rectangle(f, {a, b, root(c), root(d)}, 1e-6, kMaxDepth);
}

/// Two families of bins: directions with z on the side of the first axis go to the rings about it,
/// the others to the second's. So a reflected and a refracted lobe are both resolved.
struct Axes {
    Direction first, second;
    /// The azimuth about which lobes are narrow, where both axes are normals.
    std::optional<Direction> narrow{};
    /// An angle to either axis at which the density jumps: an edge of their rings.
    std::optional<double> jump{};
};

struct FitResult {
    double p_value = 0;
    double total = 0;  ///< integral of the density over the sphere
};

namespace detail {

inline std::array<double, 4> uniforms_double(std::uint32_t seed, std::uint32_t i) {
    const auto a = uniforms({seed, Stream::kTest}, i, 0, 0),
               b = uniforms({seed, Stream::kTest}, i, 0, 1);
    std::array<double, 4> u;
    for (std::size_t k = 0; k < 4; ++k)
        u[k] = static_cast<double>(a[k]) + 0x1p-24 * static_cast<double>(b[k]);
    return u;
}

/// Ring edges from 0 to pi: quantiles of theta of the samples on one side, and where the density
/// jumps, because quadrature must not straddle a jump.
inline std::vector<double> ring_edges(std::vector<double> thetas, std::optional<double> jump) {
    constexpr std::size_t kRings = 16;
    std::sort(thetas.begin(), thetas.end());
    std::vector<double> edges{0};
    for (std::size_t i = 1; i < kRings && !thetas.empty(); ++i) {
        const double edge = thetas[i * thetas.size() / kRings];
        if (edge > edges.back()) edges.push_back(edge);
    }
    edges.push_back(std::numbers::pi / 2);  // the horizon, about the normal
    if (jump) edges.push_back(*jump);
    std::sort(edges.begin(), edges.end());
    edges.push_back(std::numbers::pi);
    return edges;
}

constexpr int kSectors = 8;

/// Sector edges from -pi to pi: alike, or quantiles of |phi| of the samples on one side.
inline std::vector<double> sector_edges(std::vector<double> phis, bool narrow) {
    constexpr int kHalf = kSectors / 2;
    std::sort(phis.begin(), phis.end());
    std::vector<double> edges;
    for (int k = -kHalf; k <= kHalf; ++k) {
        const std::size_t i = static_cast<std::size_t>(std::abs(k)) * phis.size() / kHalf;
        const double quantile = k == 0 ? 0 : i < phis.size() ? phis[i] : std::numbers::pi;
        edges.push_back(narrow ? std::copysign(quantile, k) : k * std::numbers::pi / kHalf);
    }
    return edges;
}

/// The bins on one side, and the mass of the density in each: ring after ring.
struct Bins {
    Polar polar;
    bool narrow = false;
    std::vector<double> rings, sectors;

    std::size_t count() const { return (rings.size() - 1) * kSectors; }
    std::size_t index(const Direction& d) const {
        const auto interval = [](const std::vector<double>& edges, double x) {
            const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, x);
            return static_cast<std::size_t>(above - edges.begin()) - 1;
        };
        return interval(rings, polar.theta(d)) * kSectors + interval(sectors, polar.phi(d));
    }
    double mass(const Density& density, std::size_t bin) const {
        const std::size_t r = bin / kSectors, k = bin % kSectors;
        return (narrow ? integrate_narrow_section : integrate_section)(
            density, polar, rings[r], rings[r + 1], sectors[k], sectors[k + 1]);
    }
};

/// Bins for the samples on one side.
inline Bins make_bins(const Polar& polar, const std::vector<Direction>& pilot, bool narrow,
                      std::optional<double> jump = {}) {
    std::vector<double> thetas, phis;
    for (const Direction& d : pilot) {
        thetas.push_back(polar.theta(d));
        phis.push_back(std::abs(polar.phi(d)));
    }
    return {polar, narrow, ring_edges(std::move(thetas), jump),
            sector_edges(std::move(phis), narrow)};
}

}  // namespace detail

/// What a sampler draws, counted in bins.
struct DrawnDirections {
    std::array<detail::Bins, 2> sides;  ///< of Axes::first, and the other
    bool first_up = true;
    std::vector<double> counts;  ///< of the bins of both sides; the last: failures
    std::uint32_t samples = 0;

    std::size_t side_of(const Direction& d) const {
        return static_cast<std::size_t>((d.z > 0) != first_up);
    }
};

/// The pilot that chooses the bins and the samples that are counted use independent numbers.
inline DrawnDirections draw_directions(const Sampler& sampler, const Axes& axes, std::uint32_t seed,
                                       std::uint32_t samples) {
    const bool first_up = axes.first.z > 0;
    const auto side_of = [&](const Direction& d) {
        return static_cast<std::size_t>((d.z > 0) != first_up);
    };
    std::array<std::vector<Direction>, 2> pilot;
    for (std::uint32_t i = 0; i < 20000; ++i)
        if (const auto d = sampler(detail::uniforms_double(seed + 1, i)))
            pilot[side_of(*d)].push_back(*d);
    const auto bins_about = [&](const Direction& axis, const std::vector<Direction>& directions) {
        const Polar polar = axes.narrow ? Polar(axis, *axes.narrow) : Polar(axis);
        return detail::make_bins(polar, directions, axes.narrow.has_value(), axes.jump);
    };
    DrawnDirections drawn{{bins_about(axes.first, pilot[0]), bins_about(axes.second, pilot[1])},
                          first_up,
                          {},
                          samples};
    const std::array<std::size_t, 2> offset{0, drawn.sides[0].count()};
    drawn.counts.assign(offset[1] + drawn.sides[1].count() + 1, 0.0);
    for (std::uint32_t i = 0; i < samples; ++i) {
        if (const auto d = sampler(detail::uniforms_double(seed, i))) {
            const std::size_t side = drawn.side_of(*d);
            ++drawn.counts[offset[side] + drawn.sides[side].index(*d)];
        } else {
            ++drawn.counts.back();
        }
    }
    return drawn;
}

/// Tests "the directions have the density, and the sampler fails with the probability that the
/// density lacks to 1".
inline FitResult fit_of(const DrawnDirections& drawn, const Density& density) {
    double total = 0;
    std::vector<double> expected;
    for (std::size_t side = 0; side < 2; ++side) {
        const Density part = [&](const Direction& d) {
            return drawn.side_of(d) == side ? density(d) : 0.0;
        };
        for (std::size_t bin = 0; bin < drawn.sides[side].count(); ++bin) {
            expected.push_back(drawn.sides[side].mass(part, bin) * drawn.samples);
            total += expected.back() / drawn.samples;
        }
    }
    // Never exactly impossible: quadrature leaves 1e-6 per bin.
    for (double& e : expected) e = std::max(e, 1e-6);
    expected.push_back(std::max((1 - total) * drawn.samples, 1e-6));
    return {goodness_of_fit_p_value(drawn.counts, expected), total};
}

}  // namespace burnish::test
