#include "render/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burnish/error.h"
#include "core/parallel.h"
#include "shading/filter.h"

namespace burnish {

int filter_halo(const ReconstructionFilter& filter) {
    const int halo = std::max(0, static_cast<int>(std::ceil(filter.radius - 0.5f)));
    static_assert(kMaxTaps == 2 * kMaxFilterRadius);
    if (2 * halo + 1 > kMaxTaps)
        throw InputError(
            fmt::format("the reconstruction filter's radius is {} pixels: expected at most {}",
                        filter.radius, kMaxFilterRadius));
    return halo;
}

FilterTaps filter_taps(const ReconstructionFilter& filter, float offset) {
    FilterTaps taps;
    taps.halo = filter_halo(filter);
    for (int k = 0; k <= 2 * taps.halo; ++k)
        taps.weight[static_cast<std::size_t>(k)] =
            eval_filter(filter, offset - 0.5f - static_cast<float>(k - taps.halo));
    return taps;
}

PassTaps pass_taps(const ReconstructionFilter& filter, RandomKey key, std::uint32_t first,
                   std::uint32_t count, Sequence sequence) {
    PassTaps result{first, {}};
    result.taps.reserve(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        const Vec2f offset = film_offset(key, first + k, sequence);
        result.taps.push_back({filter_taps(filter, offset.x), filter_taps(filter, offset.y)});
    }
    return result;
}

FilmNormalization film_normalization(const Film& film) {
    const auto axis = [&](int size) {
        const float radius = film.filter.radius;
        const float whole = filter_integral(film.filter, -radius, radius);
        std::vector<float> inverse(static_cast<std::size_t>(size));
        for (int j = 0; j < size; ++j) {
            const float center = static_cast<float>(j) + 0.5f,
                        right = static_cast<float>(size) - center;
            const bool is_inside = center >= radius && right >= radius;
            const float integral = is_inside
                                       ? whole
                                       : filter_integral(film.filter, std::max(-center, -radius),
                                                         std::min(right, radius));
            inverse[static_cast<std::size_t>(j)] = 1 / integral;
        }
        return inverse;
    };
    FilmNormalization n{axis(film.crop_width), {}};
    n.y = film.crop_height == film.crop_width ? n.x : axis(film.crop_height);
    return n;
}

void normalize_film(const FilmNormalization& n, float scale, Image& image) {
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) *= n.x[static_cast<std::size_t>(x)] * n.y[row] * scale;
    });
}

Image normalized_adjoint(const Image& adjoint, const FilmNormalization& normalization,
                         float scale) {
    Image result = make_image(adjoint.width, adjoint.height, 3);
    parallel_for(static_cast<std::size_t>(adjoint.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < adjoint.width; ++x) {
            const float inverse_integral =
                normalization.x[static_cast<std::size_t>(x)] * normalization.y[row];
            for (int c = 0; c < 3; ++c)
                result.at(x, y, c) = adjoint.at(x, y, c) * inverse_integral * scale;
        }
    });
    return result;
}

Rgbf adjoint_weight(const Image& adjoint, int pixel_x, int pixel_y, const FilterTaps& taps_x,
                    const FilterTaps& taps_y) {
    Rgbf sum;
    const int halo = taps_x.halo;
    const int x0 = std::max(0, pixel_x - halo), x1 = std::min(adjoint.width - 1, pixel_x + halo);
    const int y0 = std::max(0, pixel_y - halo), y1 = std::min(adjoint.height - 1, pixel_y + halo);
    for (int y = y0; y <= y1; ++y) {
        Rgbf row;
        const float* p = &adjoint.values[adjoint.index(x0, y)];
        for (int x = x0; x <= x1; ++x, p += 3) {
            const float weight = taps_x.weight[static_cast<std::size_t>(x - pixel_x + halo)];
            row += Rgbf{p[0], p[1], p[2]} * weight;
        }
        sum += row * taps_y.weight[static_cast<std::size_t>(y - pixel_y + halo)];
    }
    return sum;
}

}  // namespace burnish
