#include "shading/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace burnish {

namespace {

/// The least eigenvalue of the Jacobian in the field. Where it is smaller, a pixel stands for a
/// stretch a hundred times as long as in the middle: that is no part of a picture.
constexpr double kMinSlope = 0.01;
/// Newton's steps double the digits: after one as small as this, nothing is left to gain.
constexpr double kLastStep = 1e-9;

struct Slope {
    double value, derivative;
};

/// Horner's rule: c[0] + c[1] t + ...
template <std::size_t N>
Slope polynomial(const std::array<double, N>& c, double t) {
    Slope s{0, 0};
    for (std::size_t i = N; i-- > 0;)
        s.derivative = s.derivative * t + s.value, s.value = s.value * t + c[i];
    return s;
}

/// Brown and Conrady's radial factor g(t), t = |p|^2.
Slope radial_factor(const Lens& lens, double t) {
    const auto& c = lens.coefficients;
    const Slope n = polynomial(std::array{1.0, c[0], c[1], c[4]}, t),
                d = polynomial(std::array{1.0, c[5], c[6], c[7]}, t);
    const double g = n.value / d.value;
    return {g, (n.derivative - g * d.derivative) / d.value};
}

/// |u| / radius of a squared radius t, without the tangential part.
Slope profile_factor(const Lens& lens, double t) {
    const auto& c = lens.coefficients;
    switch (lens.kind) {
        case LensKind::kPinhole:
            return {1, 0};
        case LensKind::kBrownConrady:
            return radial_factor(lens, t);
        case LensKind::kFisheye:
            return polynomial(std::array{1.0, c[0], c[1], c[2], c[3]}, t);
    }
    return {};
}

/// |u| of the radius |p| or the angle, without the tangential part.
Slope profile(const Lens& lens, double radius) {
    const double t = radius * radius;
    const Slope g = profile_factor(lens, t);
    return {radius * g.value, g.value + 2 * t * g.derivative};
}

/// (p2, p1): the direction of the tangential part.
Vec2<double> tangential(const Lens& lens) { return {lens.coefficients[3], lens.coefficients[2]}; }

double inner(const Vec2<double>& a, const Vec2<double>& b) { return a.x * b.x + a.y * b.y; }
double norm(const Vec2<double>& a) { return std::sqrt(inner(a, a)); }

/// A symmetric matrix.
struct Symmetric {
    double xx, xy, yy;
    double min_eigenvalue() const {
        return (xx + yy) / 2 - std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy);
    }
};

struct Distorted {
    Vec2<double> u;
    Symmetric jacobian;  ///< du/dp
};

Distorted brown_conrady(const Lens& lens, const Vec2<double>& p) {
    const double t = inner(p, p);
    const Slope g = radial_factor(lens, t);
    const Vec2<double> q = tangential(lens);
    const double along = 2 * inner(q, p), diagonal = g.value + along, outer = 2 * g.derivative;
    return {{p.x * diagonal + t * q.x, p.y * diagonal + t * q.y},
            {diagonal + outer * p.x * p.x + 4 * p.x * q.x,
             outer * p.x * p.y + 2 * (p.x * q.y + p.y * q.x),
             diagonal + outer * p.y * p.y + 4 * p.y * q.y}};
}

bool grows_around(const Lens& lens, double radius) {
    const int steps = norm(tangential(lens)) > 0 ? 64 : 1;
    for (int i = 0; i < steps; ++i) {
        const double angle = 2 * std::numbers::pi * i / steps;
        const Vec2<double> p{radius * std::cos(angle), radius * std::sin(angle)};
        if (!(brown_conrady(lens, p).jacobian.min_eigenvalue() > kMinSlope)) return false;
    }
    return true;
}

/// Whether the Jacobian is positive definite on a circle around the axis. Written so that numbers
/// that are not finite, as beyond a pole, mean no.
bool grows(const Lens& lens, double radius) {
    switch (lens.kind) {
        case LensKind::kPinhole:
            return true;
        case LensKind::kBrownConrady:
            return grows_around(lens, radius);
        case LensKind::kFisheye:
            return profile(lens, radius).derivative > kMinSlope;
    }
    return false;
}

/// |p| or the angle at an angle to the axis.
double radius_at(LensKind kind, double angle) {
    return sees_by_plane(kind) ? std::tan(angle) : angle;
}

double field_radius(const Lens& lens) {
    constexpr int kSteps = 2048;
    const double widest = sees_by_plane(lens.kind) ? 89 * std::numbers::pi / 180 : std::numbers::pi;
    const auto outside = [&](double angle) { return !grows(lens, radius_at(lens.kind, angle)); };
    for (int i = 1; i <= kSteps; ++i) {
        if (!outside(widest * i / kSteps)) continue;
        double low = widest * (i - 1) / kSteps, high = widest * i / kSteps;
        for (int k = 0; k < 50; ++k) (outside((low + high) / 2) ? high : low) = (low + high) / 2;
        return radius_at(lens.kind, low);
    }
    return radius_at(lens.kind, widest);
}

/// The radius from low to high whose profile is `wanted`. The profile grows, so a step of Newton's
/// that leaves the interval is replaced by halving it.
double invert_profile(const Lens& lens, double wanted, double low, double high, double start) {
    double radius = start;
    for (int i = 0; i < 100; ++i) {
        const Slope s = profile(lens, radius);
        (s.value > wanted ? high : low) = radius;
        double next = radius - (s.value - wanted) / s.derivative;
        if (!(next >= low && next <= high)) next = (low + high) / 2;
        const double step = std::abs(next - radius);
        radius = next;
        if (step <= kLastStep * radius) break;
    }
    return radius;
}

/// Where the radius of a length |u| below the field's end lies, and a guess within.
struct Bracket {
    double low, high, guess;
};

Bracket bracket_of(const FieldLens& lens, double length) {
    if (!(length < lens.reach)) return {lens.radii.back(), lens.radius, lens.radii.back()};
    const double at = length / lens.reach * FieldLens::kSteps;
    const auto i = std::min(static_cast<std::size_t>(at), FieldLens::kSteps - 1);
    const double low = lens.radii[i], high = lens.radii[i + 1];
    return {low, high, low + (at - static_cast<double>(i)) * (high - low)};
}

/// The radius of a length |u| up to the field's end.
double radius_of(const FieldLens& lens, double length) {
    const Bracket b = bracket_of(lens, length);
    return invert_profile(lens.lens, length, b.low, b.high, b.guess);
}

Vec2<double> within(const Vec2<double>& p, double radius) {
    const double length = norm(p);
    return length > radius ? p * (radius / length) : p;
}

Vec2<double> solve(const Symmetric& m, const Vec2<double>& b) {
    const double scale = 1 / (m.xx * m.yy - m.xy * m.xy);
    return {scale * (m.yy * b.x - m.xy * b.y), scale * (m.xx * b.y - m.xy * b.x)};
}

/// Newton's iteration in the plane, with steps that are shortened until they come nearer.
std::optional<Vec2<double>> invert_brown_conrady(const FieldLens& lens,
                                                 const Vec2<double>& distorted) {
    const double length = norm(distorted), tolerance = 1e-12 * (1 + length);
    const double aside = 3 * norm(tangential(lens.lens)) * lens.radius * lens.radius;
    if (length > lens.end + aside) return {};  // the tangential part is no longer than this
    const double guess = length < lens.reach ? bracket_of(lens, length).guess
                         : length < lens.end ? radius_of(lens, length)
                                             : lens.radius;
    Vec2<double> p = distorted * (length > 0 ? guess / length : 0);
    Distorted d = brown_conrady(lens.lens, p);
    double distance = norm(d.u - distorted);
    for (int i = 0; i < 50; ++i) {
        Vec2<double> step = solve(d.jacobian, d.u - distorted);
        const bool is_last = norm(step) <= kLastStep * (1 + norm(p));
        for (int k = 0; k < 10; ++k, step = step * 0.5) {
            const Vec2<double> next = within(p - step, lens.radius);
            const Distorted at_next = brown_conrady(lens.lens, next);
            const double left = norm(at_next.u - distorted);
            if (!(left < distance) && !is_last) continue;
            p = next, d = at_next, distance = left;
            break;
        }
        if (is_last) break;
    }
    if (!(distance <= tolerance)) return {};
    return p;
}

Vec3<double> unit(const Vec3<double>& v) {
    return v * (1 / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z));
}

std::optional<Vec3<double>> undistort_fisheye(const FieldLens& lens,
                                              const Vec2<double>& distorted) {
    const double length = norm(distorted);
    if (!(length <= lens.end)) return {};
    const double angle = radius_of(lens, length);
    const double outwards = length > 0 ? std::sin(angle) / length : 0;
    return Vec3<double>{distorted.x * outwards, distorted.y * outwards, std::cos(angle)};
}

std::optional<Vec3<double>> undistort_brown_conrady(const FieldLens& lens,
                                                    const Vec2<double>& distorted) {
    if (norm(tangential(lens.lens)) > 0) {
        const auto p = invert_brown_conrady(lens, distorted);
        if (!p) return {};
        return unit({p->x, p->y, 1});
    }
    const double length = norm(distorted);
    if (!(length <= lens.end)) return {};
    const double share = length > 0 ? radius_of(lens, length) / length : 1;
    return unit({distorted.x * share, distorted.y * share, 1});
}

}  // namespace

bool sees_by_plane(LensKind kind) {
    switch (kind) {
        case LensKind::kPinhole:
        case LensKind::kBrownConrady:
            return true;
        case LensKind::kFisheye:
            return false;
    }
    return true;
}

FieldLens with_field(const Lens& lens, double reach) {
    FieldLens field{lens};
    if (lens.kind == LensKind::kPinhole) {
        field.radius = field.end = std::numeric_limits<double>::infinity();
        return field;
    }
    field.radius = field_radius(lens);
    field.end = profile(lens, field.radius).value;
    field.reach = std::min(reach, field.end);
    for (std::size_t i = 1; i < field.radii.size(); ++i) {
        const double length = field.reach * static_cast<double>(i) / FieldLens::kSteps,
                     before = field.radii[i - 1];
        field.radii[i] = invert_profile(lens, length, before, field.radius, before);
    }
    return field;
}

Vec2<double> distort(const Lens& lens, const Vec3<double>& d) {
    const Vec2<double> p{d.x / d.z, d.y / d.z};
    switch (lens.kind) {
        case LensKind::kPinhole:
            return p;
        case LensKind::kBrownConrady:
            return brown_conrady(lens, p).u;
        case LensKind::kFisheye: {
            const double aside = norm({d.x, d.y});
            const double length = profile(lens, std::atan2(aside, d.z)).value;
            return aside > 0 ? Vec2<double>{d.x, d.y} * (length / aside) : Vec2<double>{};
        }
    }
    return {};
}

std::optional<Vec3<double>> undistort(const FieldLens& lens, const Vec2<double>& distorted) {
    switch (lens.lens.kind) {
        case LensKind::kPinhole:
            return unit({distorted.x, distorted.y, 1});
        case LensKind::kBrownConrady:
            return undistort_brown_conrady(lens, distorted);
        case LensKind::kFisheye:
            return undistort_fisheye(lens, distorted);
    }
    return {};
}

}  // namespace burnish
