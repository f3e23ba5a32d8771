#include "burnish/shading/environment.h"

#include <algorithm>
#include <numbers>

namespace burnish {
namespace {

constexpr double kPi = std::numbers::pi;

Rotation rotation_part(const Transform& t) {
    Rotation r;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            r.m[static_cast<std::size_t>(3 * i + j)] = static_cast<float>(t(i, j));
    }
    return r;
}

/// A direction in texel coordinates: x in (-1, width), y in [0, height - 1].
struct TexelPosition {
    float x, y;
};

TexelPosition texel_position(const EnvironmentEmitter& e, const Vec3f& local) {
    constexpr auto kInversePi = static_cast<float>(1 / kPi);
    const float turn = std::atan2(local.x, -local.z) * (0.5f * kInversePi);
    // The tangent is accurate near the poles, where the arc cosine is not.
    const float polar =
        std::atan2(std::sqrt(local.x * local.x + local.z * local.z), local.y) * kInversePi;
    return {(turn < 0 ? turn + 1.0f : turn) * static_cast<float>(e.image.width) - 0.5f,
            polar * static_cast<float>(e.image.height - 1)};
}

/// The cell of a texel position and the place in it. column -1 wraps.
struct Cell {
    int column, row;
    float x, y;  ///< in [0, 1]
};

Cell find_cell(const EnvironmentEmitter& e, const TexelPosition& p) {
    const float fx = std::floor(p.x);
    int column = static_cast<int>(fx);
    if (column < 0) column += e.image.width;
    column = std::clamp(column, 0, e.image.width - 1);
    const int row = std::clamp(static_cast<int>(p.y), 0, std::max(e.image.height - 2, 0));
    return {column, row, p.x - fx, std::clamp(p.y - static_cast<float>(row), 0.0f, 1.0f)};
}

Rgbf texel(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

/// The four corners of a cell: (column, row), its right neighbour, and the two below.
std::array<Rgbf, 4> corners(const Image& image, int column, int row) {
    const int right = column + 1 < image.width ? column + 1 : 0;
    const int below = std::min(row + 1, image.height - 1);
    return {texel(image, column, row), texel(image, right, row), texel(image, column, below),
            texel(image, right, below)};
}

Rgbf interpolate(const EnvironmentEmitter& e, const Cell& c) {
    const auto k = corners(e.image, c.column, c.row);
    const Rgbf top = k[0] * (1.0f - c.x) + k[1] * c.x, bottom = k[2] * (1.0f - c.x) + k[3] * c.x;
    return (top * (1.0f - c.y) + bottom * c.y) * e.scale;
}

Vec3f unit_local(const EnvironmentTable& t, const Vec3f& direction_world) {
    return normalize(rotate(t.to_local, direction_world));
}

std::size_t cell_index(const EnvironmentTable& t, const Cell& c) {
    return static_cast<std::size_t>(c.row) * static_cast<std::size_t>(t.columns) +
           static_cast<std::size_t>(c.column);
}

/// Weight of a cell: 0 for corners that are negative or not finite on the whole.
double mean_luminance(const Image& image, int column, int row) {
    double sum = 0;
    for (const Rgbf& c : corners(image, column, row)) sum += luminance(c);
    return std::isfinite(sum) ? std::max(0.25 * sum, 0.0) : 0.0;
}

/// Index of a cell with its probability. 48 random bits: 24 cannot reach every cell of a large map.
std::size_t sample_cell(const AliasTable& cells, float u0, float u1) {
    const auto n = cells.columns.size();
    const double scaled =
        (static_cast<double>(u0) + 0x1p-24 * static_cast<double>(u1)) * static_cast<double>(n);
    const std::size_t i = std::min(static_cast<std::size_t>(scaled), n - 1);
    const AliasTable::Column& c = cells.columns[i];
    return scaled - static_cast<double>(i) < static_cast<double>(c.keep) ? i : c.alias;
}

}  // namespace

EnvironmentTable make_environment_table(const EnvironmentEmitter& emitter) {
    EnvironmentTable t;
    t.emitter = &emitter;
    t.to_local = rotation_part(inverse(emitter.to_world));
    t.to_world = rotation_part(emitter.to_world);
    t.columns = emitter.image.width;
    t.rows = std::max(emitter.image.height - 1, 1);
    for (int y = 0; y <= t.rows; ++y) t.row_cosine.push_back(std::cos(kPi * y / t.rows));

    const std::size_t count =
        static_cast<std::size_t>(t.columns) * static_cast<std::size_t>(t.rows);
    std::vector<double> weight(count), solid_angle(count);
    std::size_t i = 0;
    for (int y = 0; y < t.rows; ++y) {
        const auto row = static_cast<std::size_t>(y);
        for (int x = 0; x < t.columns; ++x, ++i) {
            solid_angle[i] = 2 * kPi / t.columns * (t.row_cosine[row] - t.row_cosine[row + 1]);
            weight[i] = solid_angle[i] * mean_luminance(emitter.image, x, y);
        }
    }
    const bool black = std::all_of(weight.begin(), weight.end(), [](double w) { return w == 0; });
    t.cells = make_alias_table(black ? solid_angle : weight);
    t.density.resize(count);
    for (i = 0; i < count; ++i)
        t.density[i] =
            static_cast<float>(static_cast<double>(t.cells.probability[i]) / solid_angle[i]);
    return t;
}

EnvironmentSample sample_environment(const EnvironmentTable& table, const std::array<float, 4>& u) {
    const std::size_t index = sample_cell(table.cells, u[0], u[1]);
    const std::size_t row = index / static_cast<std::size_t>(table.columns);
    const std::size_t column = index % static_cast<std::size_t>(table.columns);

    const double top = table.row_cosine[row], bottom = table.row_cosine[row + 1];
    const double cosine = top + (bottom - top) * static_cast<double>(u[3]);
    const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
    const double turn =
        (static_cast<double>(column) + 0.5 + static_cast<double>(u[2])) / table.columns;
    const double phi = 2 * kPi * turn;
    const Vec3f local{static_cast<float>(sine * std::sin(phi)), static_cast<float>(cosine),
                      static_cast<float>(-sine * std::cos(phi))};

    const double y = std::atan2(sine, cosine) / kPi * (table.emitter->image.height - 1);
    const Cell cell{static_cast<int>(column), static_cast<int>(row), u[2],
                    static_cast<float>(std::clamp(y - static_cast<double>(row), 0.0, 1.0))};
    return {normalize(rotate(table.to_world, local)), table.density[index],
            interpolate(*table.emitter, cell)};
}

EnvironmentSample lookup_environment(const EnvironmentTable& table, const Vec3f& direction_world) {
    const EnvironmentEmitter& e = *table.emitter;
    const Cell cell = find_cell(e, texel_position(e, unit_local(table, direction_world)));
    // A map of one row has cells that span all of v.
    return {direction_world, table.density[cell_index(table, cell)], interpolate(e, cell)};
}

float pdf_environment(const EnvironmentTable& table, const Vec3f& direction_world) {
    const EnvironmentEmitter& e = *table.emitter;
    return table.density[cell_index(
        table, find_cell(e, texel_position(e, unit_local(table, direction_world))))];
}

Rgbf eval_environment(const EnvironmentTable& table, const Vec3f& direction_world) {
    const EnvironmentEmitter& e = *table.emitter;
    return interpolate(e, find_cell(e, texel_position(e, unit_local(table, direction_world))));
}

Rgbf radiance(const EnvironmentEmitter& emitter, const Vec3f& direction_world) {
    const Vec3f local = rotate(rotation_part(inverse(emitter.to_world)), direction_world);
    return interpolate(emitter, find_cell(emitter, texel_position(emitter, normalize(local))));
}

}  // namespace burnish
