#include "shading/environment.h"

#include <algorithm>
#include <numbers>

#include "core/angle.h"
#include "core/random.h"

namespace burnish {
namespace {

Rotation rotation_part(const Transform& t) {
    Rotation r;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            r.m[static_cast<std::size_t>(3 * i + j)] = static_cast<float>(t(i, j));
    }
    return r;
}

/// A direction in texel coordinates: x in [-1/2, width - 1/2], y in [0, height - 1].
template <class T>
Vec2<T> texel_position(const Image& image, const Vec3<T>& local) {
    const T turn = atan2_turns(local.x, -local.z);
    // The tangent is accurate near the poles, where the arc cosine is not.
    const T polar = atan2_turns(sqrt(local.x * local.x + local.z * local.z), local.y);
    const T around = select(turn < T(0.0f), turn + T(1.0f), turn);
    return {around * T(static_cast<float>(image.width)) - T(0.5f),
            polar * T(2.0f * static_cast<float>(image.height - 1))};
}

/// The cell of a texel position (whole numbers) and the place in it, in [0, 1]^2.
template <class T>
struct Cell {
    T column, row, x, y;
};

template <class T>
Cell<T> find_cell(const Image& image, const Vec2<T>& p) {
    const T width(static_cast<float>(image.width));
    const T last_row(static_cast<float>(std::max(image.height - 2, 0)));
    const T left = floor(p.x);
    const T around = select(left < T(0.0f), left + width, left);
    const T row = min(floor(p.y), last_row);
    return {min(around, width - T(1.0f)), row, p.x - left, clamp01(p.y - row)};
}

/// Radiance without scale at the corners of a cell: (column, row), its right neighbour, and the two
/// below; and the density of the cell.
template <class T>
struct Corners {
    std::array<Rgb<T>, 4> radiance;
    T density;
};

/// Indices of the corners' texels.
std::array<std::size_t, 4> corner_indices(int columns, int height, std::size_t column,
                                          std::size_t row) {
    const auto n = static_cast<std::size_t>(columns);
    const std::size_t right = column + 1 < n ? column + 1 : 0;
    const std::size_t here = row * n;
    const std::size_t below = std::min(row + 1, static_cast<std::size_t>(height - 1)) * n;
    return {here + column, here + right, below + column, below + right};
}

Corners<float> load_corners(const SkyTable& t, float column, float row) {
    Corners<float> result;
    const auto at = corner_indices(t.columns, t.image->height, static_cast<std::size_t>(column),
                                   static_cast<std::size_t>(row));
    for (std::size_t k = 0; k < 4; ++k) {
        const SkyTable::Texel& texel = t.texels[at[k]];
        result.radiance[k] = {texel.r, texel.g, texel.b};
    }
    result.density = t.texels[at[0]].density;
    return result;
}

Corners<Packet> load_corners(const SkyTable& t, const Packet& column, const Packet& row) {
    // Rows of their own: a lane that is stored in parts and loaded at once waits for its stores.
    std::array<std::array<SkyTable::Texel, 4>, kLanes> corners;
    for (int lane = 0; lane < kLanes; ++lane) {
        const auto at =
            corner_indices(t.columns, t.image->height, static_cast<std::size_t>(get(column, lane)),
                           static_cast<std::size_t>(get(row, lane)));
        for (std::size_t k = 0; k < 4; ++k)
            corners[static_cast<std::size_t>(lane)][k] = t.texels[at[k]];
    }
    PacketBlock fields;
    for (std::size_t lane = 0; lane < kLanes; ++lane) fields[lane] = load(&corners[lane][0].r);
    transpose(fields);
    Corners<Packet> result;
    for (std::size_t k = 0; k < 4; ++k)
        result.radiance[k] = {fields[4 * k], fields[4 * k + 1], fields[4 * k + 2]};
    result.density = fields[3];
    return result;
}

template <class T>
Rgb<T> interpolate(const std::array<Rgb<T>, 4>& corner, const T& x, const T& y, float scale) {
    const T one(1.0f);
    const Rgb<T> top = corner[0] * (one - x) + corner[1] * x,
                 bottom = corner[2] * (one - x) + corner[3] * x;
    return (top * (one - y) + bottom * y) * T(scale);
}

Rgbf texel(const Image& image, std::size_t i) {
    return {image.values[3 * i], image.values[3 * i + 1], image.values[3 * i + 2]};
}

/// Weight of a cell: 0 for corners that are negative or not finite on the whole.
double mean_luminance(const Image& image, int column, int row) {
    double sum = 0;
    for (const std::size_t i :
         corner_indices(image.width, image.height, static_cast<std::size_t>(column),
                        static_cast<std::size_t>(row)))
        sum += luminance(texel(image, i));
    return std::isfinite(sum) ? std::max(0.25 * sum, 0.0) : 0.0;
}

/// Where two uniforms fall among the columns of a table.
struct DrawnColumn {
    double scaled;
    std::size_t index;
};
DrawnColumn draw_column(const AliasTable& cells, float u0, float u1) {
    const auto n = cells.columns.size();
    const double scaled = fine_uniform(u0, u1) * static_cast<double>(n);
    return {scaled, std::min(static_cast<std::size_t>(scaled), n - 1)};
}

/// Index of a cell.
std::size_t cell_of(const AliasTable& cells, const DrawnColumn& drawn) {
    const AliasTable::Column& c = cells.columns[drawn.index];
    const double within = drawn.scaled - static_cast<double>(drawn.index);
    return within < static_cast<double>(c.keep) ? drawn.index : c.alias;
}

/// The chosen cell as whole numbers, and its bounds.
template <class T>
struct SampledCell {
    T column, row;
    T sin2_begin, sin2_end, cos2_begin, cos2_end;
};

SampledCell<float> sampled_cell(const SkyTable& t, std::size_t index) {
    const auto columns = static_cast<std::size_t>(t.columns);
    const std::size_t row = index / columns;
    const auto &begin = t.row_starts[row], &end = t.row_starts[row + 1];
    return {static_cast<float>(index % columns),
            static_cast<float>(row),
            begin.sin2,
            end.sin2,
            begin.cos2,
            end.cos2};
}

SampledCell<float> sampled_cell(const SkyTable& t, float u0, float u1) {
    return sampled_cell(t, cell_of(t.cells, draw_column(t.cells, u0, u1)));
}

/// Asks for the memory of all lanes before any of them waits for its own.
SampledCell<Packet> sampled_cell(const SkyTable& t, const Packet& u0, const Packet& u1) {
    std::array<DrawnColumn, kLanes> drawn;
    for (int lane = 0; lane < kLanes; ++lane) {
        DrawnColumn& d = drawn[static_cast<std::size_t>(lane)];
        d = draw_column(t.cells, get(u0, lane), get(u1, lane));
        __builtin_prefetch(&t.cells.columns[d.index]);
    }
    SampledCell<Packet> result;
    for (int lane = 0; lane < kLanes; ++lane) {
        const std::size_t index = cell_of(t.cells, drawn[static_cast<std::size_t>(lane)]);
        const std::size_t below = index + static_cast<std::size_t>(t.columns);
        __builtin_prefetch(&t.texels[index]);
        __builtin_prefetch(&t.texels[std::min(below, t.texels.size() - 1)]);
        const SampledCell<float> c = sampled_cell(t, index);
        set(result.column, lane, c.column), set(result.row, lane, c.row);
        set(result.sin2_begin, lane, c.sin2_begin), set(result.sin2_end, lane, c.sin2_end);
        set(result.cos2_begin, lane, c.cos2_begin), set(result.cos2_end, lane, c.cos2_end);
    }
    return result;
}

SkyTable make_sky_table(const SharedImage& image) {
    SkyTable t;
    t.image = image;
    t.columns = image->width;
    t.rows = std::max(image->height - 1, 1);
    for (int y = 0; y <= t.rows; ++y) {
        const double half = std::numbers::pi / 2 * y / t.rows;
        t.row_starts.push_back({static_cast<float>(std::sin(half) * std::sin(half)),
                                static_cast<float>(std::cos(half) * std::cos(half))});
    }

    const std::size_t count =
        static_cast<std::size_t>(t.columns) * static_cast<std::size_t>(t.rows);
    std::vector<double> weight(count), solid_angle(count);
    std::size_t i = 0;
    for (int y = 0; y < t.rows; ++y) {
        const double area = 2 * std::numbers::pi / t.columns *
                            (std::cos(std::numbers::pi * y / t.rows) -
                             std::cos(std::numbers::pi * (y + 1) / t.rows));
        for (int x = 0; x < t.columns; ++x, ++i) {
            solid_angle[i] = area;
            weight[i] = area * mean_luminance(*image, x, y);
        }
    }
    const bool black = std::all_of(weight.begin(), weight.end(), [](double w) { return w == 0; });
    t.cells = make_alias_table(black ? solid_angle : weight);
    t.texels.resize(image->values.size() / 3);
    for (i = 0; i < t.texels.size(); ++i) {
        const Rgbf c = texel(*image, i);
        // The last row, where there is another, begins no cell.
        const double density =
            i < count ? static_cast<double>(t.cells.probability[i]) / solid_angle[i] : 0.0;
        t.texels[i] = {c.x, c.y, c.z, static_cast<float>(density)};
    }
    return t;
}

}  // namespace

EnvironmentTable make_environment_table(const EnvironmentEmitter& emitter,
                                        std::shared_ptr<const SkyTable> sky) {
    if (!sky || sky->image != emitter.image)
        sky = std::make_shared<const SkyTable>(make_sky_table(emitter.image));
    return {std::move(sky), emitter.scale, rotation_part(inverse(emitter.to_world)),
            rotation_part(emitter.to_world)};
}

template <class T>
EnvironmentSampleOf<T> sample_environment(const EnvironmentTable& table,
                                          const std::array<T, 4>& u) {
    const SkyTable& sky = *table.sky;
    const SampledCell<T> cell = sampled_cell(sky, u[0], u[1]);
    const T sin2 = lerp(cell.sin2_begin, cell.sin2_end, u[3]);
    const T cos2 = lerp(cell.cos2_begin, cell.cos2_end, u[3]);
    const T sine = T(2.0f) * safe_sqrt(T(sin2 * cos2)), cosine = cos2 - sin2;
    const T turn = (cell.column + T(0.5f) + u[2]) * T(1.0f / static_cast<float>(sky.columns));
    const SinCos<T> around = sin_cos_turns(turn);
    const Vec3<T> local{sine * around.sin, cosine, -sine * around.cos};

    const float rows = static_cast<float>(sky.image->height - 1);
    const T y = clamp01(T(atan2_turns(sine, cosine) * T(2.0f * rows) - cell.row));
    const Corners<T> corners = load_corners(sky, cell.column, cell.row);
    return {normalize(rotate(table.to_world, local)), corners.density,
            interpolate(corners.radiance, u[2], y, table.scale)};
}

template <class T>
EnvironmentSampleOf<T> lookup_environment(const EnvironmentTable& table,
                                          const Vec3<T>& direction_world) {
    const Image& image = *table.sky->image;
    const Vec3<T> local = normalize(rotate(table.to_local, direction_world));
    const Cell<T> cell = find_cell(image, texel_position(image, local));
    const Corners<T> corners = load_corners(*table.sky, cell.column, cell.row);
    return {direction_world, corners.density,
            interpolate(corners.radiance, cell.x, cell.y, table.scale)};
}

template EnvironmentSample sample_environment(const EnvironmentTable&, const std::array<float, 4>&);
template EnvironmentSample lookup_environment(const EnvironmentTable&, const Vec3f&);
template EnvironmentSampleOf<Packet> sample_environment(const EnvironmentTable&,
                                                        const std::array<Packet, 4>&);
template EnvironmentSampleOf<Packet> lookup_environment(const EnvironmentTable&,
                                                        const Vec3<Packet>&);

Rgbf radiance(const EnvironmentEmitter& emitter, const Vec3f& direction_world) {
    const Image& image = *emitter.image;
    const Vec3f local = rotate(rotation_part(inverse(emitter.to_world)), direction_world);
    const Cell<float> cell = find_cell(image, texel_position(image, normalize(local)));
    const auto at = corner_indices(image.width, image.height, static_cast<std::size_t>(cell.column),
                                   static_cast<std::size_t>(cell.row));
    std::array<Rgbf, 4> corner;
    for (std::size_t k = 0; k < 4; ++k) corner[k] = texel(image, at[k]);
    return interpolate(corner, cell.x, cell.y, emitter.scale);
}

}  // namespace burnish
