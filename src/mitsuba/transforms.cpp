#include "mitsuba/transforms.h"

#include <fmt/format.h>

#include <cmath>

#include "core/frame.h"
#include "mitsuba/numbers.h"

namespace burnish::mitsuba {

namespace {

Vec3<double> three_numbers(const Node& node, const char* name) {
    const std::vector<double> v = parse_numbers(attribute(node, name), node.place);
    if (v.size() != 3)
        fail(node.place,
             fmt::format("\"{}\" of <{}> has {} numbers, expected 3", name, node.tag, v.size()));
    return {v[0], v[1], v[2]};
}

Transform read_matrix(const Node& node) {
    const std::vector<double> v = parse_numbers(attribute(node, "value"), node.place);
    if (v.size() != 16 && v.size() != 9)
        fail(node.place, fmt::format("<matrix> has {} numbers, expected 16 or 9", v.size()));
    const int n = v.size() == 16 ? 4 : 3;
    Transform matrix;
    for (int row = 0; row < n; ++row)
        for (int column = 0; column < n; ++column)
            matrix(row, column) = v[static_cast<std::size_t>(n * row + column)];
    if (matrix(3, 0) != 0 || matrix(3, 1) != 0 || matrix(3, 2) != 0 || matrix(3, 3) != 1)
        fail(node.place, "<matrix> is projective, expected the last row 0 0 0 1");
    return matrix;
}

bool is_unit(const Vec3<double>& axis) { return std::abs(length_squared(axis) - 1) < 1e-5; }

Transform read_rotation(const Node& node) {
    const Vec3<double> axis = read_vector(node, 0);
    const std::vector<double> angle = parse_numbers(attribute(node, "angle"), node.place);
    if (angle.size() != 1)
        fail(node.place, fmt::format("\"angle\" has {} numbers, expected 1", angle.size()));
    if (!(length_squared(axis) > 0))
        fail(node.place, "<rotate> has no axis, expected x, y, z or value");
    return is_unit(axis) ? rotation(axis, angle[0]) : rodrigues(axis, angle[0]);
}

/// Without an `up`, or with one of 0, the roll is that of Mitsuba.
Transform read_look_at(const Node& node) {
    const Vec3<double> origin = three_numbers(node, "origin"),
                       target = three_numbers(node, "target");
    const Vec3<double> up =
        attribute(node, "up").empty() ? Vec3<double>{} : three_numbers(node, "up");
    if (!(length_squared(target - origin) > 0))
        fail(node.place, "<lookat> has its target at its origin");
    const Vec3<double> view = normalize(target - origin);
    if (!(length_squared(up) > 0)) return look_at(origin, target, frame_from_normal(view).s);
    constexpr double kRounding = 1e-12;  // the sine of a smaller angle holds nothing else
    if (!(length(cross(normalize(up), view)) > kRounding))
        fail(
            node.place,
            "\"up\" of <lookat> is parallel to the view, expected another direction, or no \"up\"");
    return look_at(origin, target, up);
}

Transform read_step(const Node& node) {
    if (node.tag == "translate") return translation(read_vector(node, 0));
    if (node.tag == "scale") return scaling(read_vector(node, 1));
    if (node.tag == "rotate") return read_rotation(node);
    if (node.tag == "lookat" || node.tag == "lookAt") return read_look_at(node);
    if (node.tag == "matrix") return read_matrix(node);
    fail(node.place,
         fmt::format(
             "found <{}> inside <transform>, expected translate, scale, rotate, lookat or matrix",
             node.tag));
}

Transform transposed(const Transform& a) {
    Transform t;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) t(i, j) = a(j, i);
    return t;
}

}  // namespace

Vec3<double> read_vector(const Node& node, double missing) {
    const bool has_value = !attribute(node, "value").empty();
    const auto component = [&](const char* name) {
        if (attribute(node, name).empty()) return missing;
        if (has_value)
            fail(node.place,
                 fmt::format("<{}> has both value and {}, expected one", node.tag, name));
        const std::vector<double> v = parse_numbers(attribute(node, name), node.place);
        if (v.size() != 1)
            fail(node.place, fmt::format("\"{}\" has {} numbers, expected 1", name, v.size()));
        return v[0];
    };
    const Vec3<double> components{component("x"), component("y"), component("z")};
    if (!has_value) return components;
    const std::vector<double> v = parse_numbers(attribute(node, "value"), node.place);
    if (v.size() == 1) return {v[0], v[0], v[0]};
    return three_numbers(node, "value");
}

Transform read_transform(const Node& node) {
    Transform transform;
    for (const Node& step : node.children) transform = read_step(step) * transform;
    return transform;
}

std::optional<Transform> read_skewed_inverse(const Node& node) {
    Transform skewed;
    bool any = false;
    for (const Node& step : node.children) {
        const bool is_skewed = step.tag == "rotate" && !is_unit(read_vector(step, 0));
        any |= is_skewed;
        const Transform matrix = read_step(step);
        skewed = skewed * (is_skewed ? transposed(matrix) : inverse(matrix));
    }
    if (!any) return {};
    return skewed;
}

UniformScale uniform_scale(const Transform& a, double tolerance) {
    UniformScale result;
    const Vec3<double> x = column_of(a, 0), y = column_of(a, 1), z = column_of(a, 2);
    result.scale = (length(x) + length(y) + length(z)) / 3;
    const double square = result.scale * result.scale;
    const auto off = [&](const Vec3<double>& u, const Vec3<double>& v, double expected) {
        return !(std::abs(dot(u, v) / square - expected) <= 2 * tolerance);
    };
    result.uniform = square > 0 && !off(x, x, 1) && !off(y, y, 1) && !off(z, z, 1) &&
                     !off(x, y, 0) && !off(y, z, 0) && !off(z, x, 0);
    result.mirrored = determinant3(a) < 0;
    return result;
}

}  // namespace burnish::mitsuba
