#include "render/lens_pixels.h"

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

using Direction = std::optional<Vec3<double>>;

/// Calls body(index of the pixel, the directions at its corners), row by row.
template <class Body>
void for_pixels(const TracedScene& view, const Body& body) {
    const Film& film = view.film;
    const auto width = static_cast<std::size_t>(film.crop_width);
    const auto row = [&](int y) {
        std::vector<Direction> directions;
        for (int x = 0; x <= film.crop_width; ++x)
            directions.push_back(bent_direction(
                view.camera.bent, {static_cast<double>(film.crop_x + x) / film.width,
                                   static_cast<double>(film.crop_y + y) / film.height}));
        return directions;
    };
    std::vector<Direction> above = row(0);
    for (int y = 0; y < film.crop_height; ++y) {
        std::vector<Direction> below = row(y + 1);
        for (std::size_t x = 0; x < width; ++x)
            body(static_cast<std::size_t>(y) * width + x,
                 std::array<Direction, 4>{above[x], above[x + 1], below[x], below[x + 1]});
        above = std::move(below);
    }
}

/// The side of a cube around the camera: a square pinhole camera of 90 degrees.
class Face {
  public:
    /// number: 0 to 5.
    Face(const TracedScene& view, int number) : view_(view) {
        const int axis = number / 2;
        axes_[2][axis] = number % 2 ? -1 : 1;
        axes_[0][(axis + 1) % 3] = 1;
        axes_[1] = cross(axes_[2], axes_[0]);
        const BentRays& bent = view.camera.bent;
        // As fine as the picture is in its middle; coarser marks are wrong on the safe side alone.
        const double focal = view.film.width / bent.size.x;
        size_ = static_cast<int>(std::clamp(std::ceil(2 * focal), 256.0, 4096.0));
    }

    /// Whether a marked pixel may lie among these directions, the corners of a small pixel.
    bool sees(const std::array<Direction, 4>& corners, const auto& project) {
        double low_x = 2, low_y = 2, high_x = -2, high_y = -2;
        for (const Direction& d : corners) {
            const double z = dot(axes_[2], *d);
            if (!(z > 0.1)) return false;  // a small pixel, so it misses the face
            const double x = dot(axes_[0], *d) / z, y = dot(axes_[1], *d) / z;
            low_x = std::min(low_x, x), high_x = std::max(high_x, x);
            low_y = std::min(low_y, y), high_y = std::max(high_y, y);
        }
        // The sides of the pixel are curved.
        const double reach = 0.125 * std::max(high_x - low_x, high_y - low_y) + 1e-6;
        const int x0 = texel(low_x - reach), x1 = texel(high_x + reach);
        const int y0 = texel(low_y - reach), y1 = texel(high_y + reach);
        if (x1 < 0 || y1 < 0 || x0 >= size_ || y0 >= size_) return false;
        if (marks_.empty()) marks_ = project(pinhole());
        for (int y = std::max(y0, 0); y <= std::min(y1, size_ - 1); ++y)
            for (int x = std::max(x0, 0); x <= std::min(x1, size_ - 1); ++x)
                if (marks_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                           static_cast<std::size_t>(x)])
                    return true;
        return false;
    }

  private:
    int texel(double tangent) const {
        return static_cast<int>(std::floor(std::clamp((tangent + 1) / 2, -1.0, 2.0) * size_));
    }
    /// Its near plane is that of the lens: a ray of a face starts, along the face's axis, at no
    /// less than 1 / sqrt(3) of its distance from the eye, and projections are clipped at half of
    /// it.
    TracedScene pinhole() const {
        Camera camera{size_, size_, size_ / 2.0, size_ / 2.0, size_ / 2.0, size_ / 2.0};
        const auto& to_world = view_.camera.bent.axes;
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 3; ++row)
                camera.camera_to_world[static_cast<std::size_t>(4 * row + column)] =
                    to_world[0][row] * axes_[static_cast<std::size_t>(column)].x +
                    to_world[1][row] * axes_[static_cast<std::size_t>(column)].y +
                    to_world[2][row] * axes_[static_cast<std::size_t>(column)].z;
        CameraRays rays = make_camera_rays(camera, view_.camera.near_clip, view_.camera.far_clip);
        rays.eye = view_.camera.eye;
        return with_camera(view_, rays, {size_, size_, 0, 0, size_, size_, view_.film.filter});
    }

    const TracedScene& view_;
    std::array<Vec3<double>, 3> axes_{};  ///< x, y, z in those of the camera
    int size_ = 0;                        ///< pixels a side
    std::vector<char> marks_;             ///< empty: not asked for yet
};

std::size_t inside(const std::array<Direction, 4>& corners) {
    return static_cast<std::size_t>(
        std::count_if(corners.begin(), corners.end(), [](const Direction& d) { return !!d; }));
}

/// Whether all corners are near to one another, as those of most pixels are: faces ask for it.
bool is_small(const std::array<Direction, 4>& corners) {
    return std::all_of(corners.begin(), corners.end(),
                       [&](const Direction& d) { return dot(*d, *corners[0]) > 0.95; });
}

std::vector<char> unmarked(const Film& film) {
    return std::vector<char>(static_cast<std::size_t>(film.crop_width) *
                             static_cast<std::size_t>(film.crop_height));
}

/// Marks a pixel and those around it.
void mark_around(const Film& film, std::size_t pixel, std::vector<char>& marks) {
    const auto width = static_cast<std::size_t>(film.crop_width);
    const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
    for (int j = std::max(0, y - 1); j <= std::min(film.crop_height - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(film.crop_width - 1, x + 1); ++i)
            marks[static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i)] = 1;
}

}  // namespace

std::vector<char> blind_pixels(const TracedScene& view) {
    std::vector<char> blind = unmarked(view.film);
    if (!has_lens(view.camera)) return blind;
    for_pixels(view, [&](std::size_t pixel, const std::array<Direction, 4>& corners) {
        blind[pixel] = inside(corners) < 4;
    });
    return blind;
}

std::vector<char> visible_through_lens(
    const TracedScene& view, const std::function<std::vector<char>(const TracedScene&)>& project) {
    std::vector<char> marks = unmarked(view.film);
    std::vector<Face> faces;
    for (int i = 0; i < 6; ++i) faces.emplace_back(view, i);
    for_pixels(view, [&](std::size_t pixel, const std::array<Direction, 4>& corners) {
        const std::size_t count = inside(corners);
        if (count == 4 && is_small(corners))
            marks[pixel] |= std::any_of(faces.begin(), faces.end(),
                                        [&](Face& f) { return f.sees(corners, project); });
        else if (count > 0)  // the field may bulge into a neighbour none of whose corners it holds
            mark_around(view.film, pixel, marks);
    });
    return marks;
}

}  // namespace burnish
