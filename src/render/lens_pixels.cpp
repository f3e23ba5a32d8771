// Pixels are looked at in square blocks, whose inner directions follow from those at the corners: a
// block that is wholly seen, or not at all, takes one question. Blocks in which directions bend too
// much for that, or that the end of the field cuts, are looked at pixel by pixel.
#include "render/lens_pixels.h"

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

using Direction = std::optional<Vec3<double>>;
/// Unit directions at the corners of a rectangle of the film: above left, right, below left, right.
using Corners = std::array<Vec3<double>, 4>;

/// Between the corners, by shares of the way across and down.
Vec3<double> between(const Corners& c, double x, double y) {
    return (c[0] * (1 - x) + c[1] * x) * (1 - y) + (c[2] * (1 - x) + c[3] * x) * y;
}

/// Pixels of the crop window.
struct Block {
    int x = 0, y = 0, width = 0, height = 0;
};

class LensView {
  public:
    explicit LensView(const TracedScene& view) : view_(view) {
        // Directions that are interpolated in a block are wrong by 1/80 of a pixel, and by that
        // times how much more the lens bends than a sphere.
        side_ = static_cast<int>(std::clamp(std::sqrt(0.1 * focal()), 1.0, 32.0));
    }

    double focal() const { return view_.film.width / view_.camera.bent.size.x; }
    int side() const { return side_; }

    /// At the upper left corner of a pixel.
    Direction at(double x, double y) const {
        const Film& film = view_.film;
        return bent_direction(view_.camera.bent,
                              {(film.crop_x + x) / film.width, (film.crop_y + y) / film.height});
    }

    /// How many of the corners and the middle lie in the field, of 5; their directions there.
    int look(const Block& b, Corners& corners) const {
        int inside = 0;
        for (int i = 0; i < 4; ++i)
            if (const Direction d = at(b.x + i % 2 * b.width, b.y + i / 2 * b.height))
                corners[static_cast<std::size_t>(i)] = *d, ++inside;
        return inside + at(b.x + 0.5 * b.width, b.y + 0.5 * b.height).has_value();
    }

    /// Whether directions within a block may be interpolated: within 1/20 of a pixel in its middle.
    bool is_flat(const Block& b, const Corners& corners) const {
        if (b.width == 1 && b.height == 1) return true;
        const Vec3<double> off = between(corners, 0.5, 0.5) -
                                 *at(b.x + 0.5 * b.width, b.y + 0.5 * b.height),
                           across = (corners[1] - corners[0]) * (1.0 / b.width);
        return dot(off, off) < dot(across, across) / 400;
    }

    /// Calls body(block) for blocks that cover a part of the film.
    template <class Body>
    void for_blocks(const Block& part, int side, const Body& body) const {
        for (int y = part.y; y < part.y + part.height; y += side)
            for (int x = part.x; x < part.x + part.width; x += side)
                body(Block{x, y, std::min(side, part.x + part.width - x),
                           std::min(side, part.y + part.height - y)});
    }
    template <class Body>
    void for_blocks(const Body& body) const {
        for_blocks({0, 0, view_.film.crop_width, view_.film.crop_height}, side_, body);
    }

    void mark(const Block& b, std::vector<char>& marks) const {
        const auto width = static_cast<std::size_t>(view_.film.crop_width);
        for (int y = b.y; y < b.y + b.height; ++y)
            std::fill_n(
                marks.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * width +
                                                            static_cast<std::size_t>(b.x)),
                b.width, 1);
    }

    /// A pixel and those around it.
    Block around(const Block& pixel) const {
        const int x = std::max(0, pixel.x - 1), y = std::max(0, pixel.y - 1);
        return {x, y, std::min(view_.film.crop_width, pixel.x + 2) - x,
                std::min(view_.film.crop_height, pixel.y + 2) - y};
    }

  private:
    const TracedScene& view_;
    int side_ = 1;
};

enum class Share { kNone, kSome, kAll };

/// The side of a cube around the camera: a square pinhole camera of 90 degrees.
class Face {
  public:
    /// number: 0 to 5. focal: pixels, of the lens.
    Face(const TracedScene& view, int number, double focal) : view_(view) {
        const int axis = number / 2;
        axes_[2][axis] = number % 2 ? -1 : 1;
        axes_[0][(axis + 1) % 3] = 1;
        axes_[1] = cross(axes_[2], axes_[0]);
        // As fine as the picture is in its middle; coarser marks are wrong on the safe side alone.
        size_ = static_cast<int>(std::clamp(std::ceil(2 * focal), 256.0, 2048.0));
    }

    /// How much of what lies among these directions, near to one another, is marked; kSome where
    /// it is not known.
    Share marked(const Corners& corners, const auto& project) {
        double low_x = 2, low_y = 2, high_x = -2, high_y = -2;
        for (const Vec3<double>& d : corners) {
            const double z = dot(axes_[2], d);
            if (!(z > 0.1)) return Share::kNone;  // so far aside that all of them miss the face
            const double x = dot(axes_[0], d) / z, y = dot(axes_[1], d) / z;
            low_x = std::min(low_x, x), high_x = std::max(high_x, x);
            low_y = std::min(low_y, y), high_y = std::max(high_y, y);
        }
        // The sides are curved, and may be interpolated.
        const double reach = 0.125 * std::max(high_x - low_x, high_y - low_y) + 1e-6;
        const int x0 = texel(low_x - reach), x1 = texel(high_x + reach) + 1;
        const int y0 = texel(low_y - reach), y1 = texel(high_y + reach) + 1;
        if (x1 <= 0 || y1 <= 0 || x0 >= size_ || y0 >= size_) return Share::kNone;
        if (sums_.empty()) sum_up(project(pinhole()));
        const auto clip = [&](int t) { return std::clamp(t, 0, size_); };
        const auto count = sum(clip(x1), clip(y1)) - sum(clip(x0), clip(y1)) -
                           sum(clip(x1), clip(y0)) + sum(clip(x0), clip(y0));
        if (count == 0) return Share::kNone;
        const bool within = x0 >= 0 && y0 >= 0 && x1 <= size_ && y1 <= size_;
        return within && count == static_cast<std::uint32_t>((x1 - x0) * (y1 - y0)) ? Share::kAll
                                                                                    : Share::kSome;
    }

  private:
    int texel(double tangent) const {
        return static_cast<int>(std::floor(std::clamp((tangent + 1) / 2, -1.0, 2.0) * size_));
    }
    std::uint32_t& sum(int x, int y) {
        return sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_ + 1) +
                     static_cast<std::size_t>(x)];
    }
    void sum_up(const std::vector<char>& marks) {
        sums_.assign(static_cast<std::size_t>(size_ + 1) * static_cast<std::size_t>(size_ + 1), 0);
        auto mark = marks.begin();
        for (int y = 1; y <= size_; ++y)
            for (int x = 1; x <= size_; ++x)
                sum(x, y) = sum(x - 1, y) + sum(x, y - 1) - sum(x - 1, y - 1) + (*mark++ ? 1 : 0);
    }
    /// Its near plane is that of the lens: a ray of a face starts, along the face's axis, at no
    /// less than 1 / sqrt(3) of its distance from the eye, and projections are clipped at half of
    /// it.
    TracedScene pinhole() const {
        const double half = size_ / 2.0;
        Camera camera{size_, size_, half, half, half, half};
        const auto& to_world = view_.camera.bent.axes;
        for (int column = 0; column < 3; ++column) {
            const Vec3<double>& axis = axes_[static_cast<std::size_t>(column)];
            const Vec3<double> world =
                to_world[0] * axis.x + to_world[1] * axis.y + to_world[2] * axis.z;
            for (int row = 0; row < 3; ++row)
                camera.camera_to_world[static_cast<std::size_t>(4 * row + column)] = world[row];
        }
        CameraRays rays = make_camera_rays(camera, view_.camera.near_clip, view_.camera.far_clip);
        rays.eye = view_.camera.eye;
        return with_camera(view_, rays, {size_, size_, 0, 0, size_, size_, view_.film.filter});
    }

    const TracedScene& view_;
    std::array<Vec3<double>, 3> axes_{};  ///< x, y, z in those of the camera
    int size_ = 0;                        ///< pixels a side
    std::vector<std::uint32_t> sums_;  ///< of marks above and to the left; empty: not asked for yet
};

std::vector<char> unmarked(const Film& film) {
    return std::vector<char>(static_cast<std::size_t>(pixels_of(film)));
}

/// Whether all corners are near to one another, as those of most pixels are: faces ask for it.
bool is_small(const Corners& corners) {
    return std::all_of(corners.begin(), corners.end(),
                       [&](const Vec3<double>& d) { return dot(d, corners[0]) > 0.95; });
}

}  // namespace

std::vector<char> blind_pixels(const TracedScene& view) {
    std::vector<char> blind = unmarked(view.film);
    if (!has_lens(view.camera)) return blind;
    const LensView lens(view);
    Corners corners;
    lens.for_blocks([&](const Block& block) {
        if (lens.look(block, corners) == 5) return;
        lens.for_blocks(block, 1, [&](const Block& pixel) {
            if (lens.look(pixel, corners) < 5) lens.mark(pixel, blind);
        });
    });
    return blind;
}

std::vector<char> visible_through_lens(
    const TracedScene& view, const std::function<std::vector<char>(const TracedScene&)>& project) {
    const LensView lens(view);
    std::vector<char> marks = unmarked(view.film);
    std::vector<Face> faces;
    for (int i = 0; i < 6; ++i) faces.emplace_back(view, i, lens.focal());
    const auto marked = [&](const Corners& corners) {
        Share share = Share::kNone;
        for (Face& f : faces) share = std::max(share, f.marked(corners, project));
        return share;
    };
    const auto look_at_pixel = [&](const Block& pixel) {
        Corners corners;
        const int inside = lens.look(pixel, corners);
        if (inside == 5 && is_small(corners)) {
            if (marked(corners) != Share::kNone) lens.mark(pixel, marks);
        } else if (inside >
                   0) {  // the field may bulge into a neighbour of which it holds no corner
            lens.mark(lens.around(pixel), marks);
        }
    };
    const auto look_between = [&](const Block& block, const Corners& all) {
        lens.for_blocks(block, 1, [&](const Block& pixel) {
            Corners corners;
            for (int i = 0; i < 4; ++i)
                corners[static_cast<std::size_t>(i)] =
                    between(all, static_cast<double>(pixel.x + i % 2 - block.x) / block.width,
                            static_cast<double>(pixel.y + i / 2 - block.y) / block.height);
            if (marked(corners) != Share::kNone) lens.mark(pixel, marks);
        });
    };
    lens.for_blocks([&](const Block& block) {
        Corners corners;
        const int inside = lens.look(block, corners);
        if (inside < 5 || !is_small(corners) || !lens.is_flat(block, corners)) {
            lens.for_blocks(block, 1, look_at_pixel);
            return;
        }
        const Share share = marked(corners);
        if (share == Share::kAll) lens.mark(block, marks);
        if (share == Share::kSome) look_between(block, corners);
    });
    return marks;
}

}  // namespace burnish
