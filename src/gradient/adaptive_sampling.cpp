#include "gradient/adaptive_sampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "render/pass_convolution.h"

namespace burnish {

namespace {

constexpr int kTile = 32;      // pixels on a side of what is worked on and traced together
constexpr float kKept = 0.9f;  // share of the old samples in what is known, per iteration
/// Pixels away whose samples count for a pixel, too: its own are few, and their sizes vary widely.
constexpr int kReach = 2;
/// Samples of the mean size that every pixel is given besides its own.
constexpr float kPriorSamples = 1;

/// The mean of |w(x)|^2 over four positions within each pixel.
std::vector<float> adjoint_squares(const Film& film, const Image& normalized_adjoint) {
    const auto width = static_cast<std::size_t>(film.crop_width);
    std::vector<float> squares(width * static_cast<std::size_t>(film.crop_height), 0.0f);
    const std::vector<Tile> tiles = make_tiles(film, kTile);
    parallel_for(tiles.size(), [&](std::size_t i) {
        const Tile& tile = tiles[i];
        std::vector<float> scratch, w(3 * static_cast<std::size_t>(tile.width * tile.height));
        for (const float at : {0.25f, 0.75f})
            for (const float across : {0.25f, 0.75f}) {
                gather_pass(tile, {filter_taps(film.filter, across), filter_taps(film.filter, at)},
                            normalized_adjoint, scratch, w.data());
                const float* v = w.data();
                for (int y = tile.y0; y < tile.y0 + tile.height; ++y)
                    for (int x = tile.x0; x < tile.x0 + tile.width; ++x, v += 3)
                        squares[static_cast<std::size_t>(y) * width +
                                static_cast<std::size_t>(x)] +=
                            0.25f * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            }
    });
    return squares;
}

/// The sum over the pixels at most kReach away on each axis.
std::vector<float> box_sums(const std::vector<float>& values, int width, int height) {
    std::vector<float> rows(values.size()), sums(values.size());
    const auto sum_along = [](const std::vector<float>& from, std::size_t at, int x, int size,
                              std::size_t stride) {
        float sum = 0;
        for (int k = std::max(-kReach, -x); k <= std::min(kReach, size - 1 - x); ++k)
            sum += from[at + static_cast<std::size_t>(k) * stride];
        return sum;
    };
    const auto stride = static_cast<std::size_t>(width);
    for (const bool along_x : {true, false})
        parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
            for (int x = 0; x < width; ++x) {
                const std::size_t at = y * stride + static_cast<std::size_t>(x);
                if (along_x)
                    rows[at] = sum_along(values, at, x, width, 1);
                else
                    sums[at] = sum_along(rows, at, static_cast<int>(y), height, stride);
            }
        });
    return sums;
}

double sum_of(const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// The mean of |g|^2 / |w|^2 about each pixel, as far as it is known; 1 where nothing is.
std::vector<float> mean_squares(const Film& film, const PixelStatistics& statistics) {
    const double count = sum_of(statistics.counts), all = sum_of(statistics.squares);
    if (!(count > 0 && all > 0)) return std::vector<float>(statistics.seen.size(), 1.0f);
    std::vector<float> squares = box_sums(statistics.squares, film.crop_width, film.crop_height);
    const std::vector<float> counts =
        box_sums(statistics.counts, film.crop_width, film.crop_height);
    const float mean = static_cast<float>(all / count);
    for (std::size_t i = 0; i < squares.size(); ++i)
        squares[i] = (squares[i] + kPriorSamples * mean) / (counts[i] + kPriorSamples);
    return squares;
}

/// The factor for which min(room, factor * size) adds up to `budget`, or to as much as there is
/// room for. sizes: not all 0.
double factor_for(const std::vector<float>& sizes, double budget, double room) {
    double factor = budget / sum_of(sizes);
    for (int round = 0; round < 16; ++round) {
        double full = 0, rest = 0;
        for (const float s : sizes)
            if (factor * double{s} >= room)
                full += room;
            else
                rest += double{s};
        const double next = rest > 0 ? std::max(0.0, budget - full) / rest : factor;
        if (!(next > factor * (1 + 1e-6))) break;
        factor = next;
    }
    return factor;
}

}  // namespace

PixelStatistics make_pixel_statistics(const Binding& binding) {
    PixelStatistics statistics;
    statistics.seen = reaching_pixels(binding);
    statistics.squares.assign(statistics.seen.size(), 0.0f);
    statistics.counts.assign(statistics.seen.size(), 0.0f);
    return statistics;
}

std::vector<float> expected_samples(const Film& film, const Image& normalized_adjoint, float mean,
                                    const PixelStatistics& statistics) {
    std::vector<float> e = adjoint_squares(film, normalized_adjoint);
    const std::vector<float> squares = mean_squares(film, statistics);
    for (std::size_t i = 0; i < e.size(); ++i)
        e[i] = statistics.seen[i] ? std::sqrt(e[i] * squares[i]) : 0.0f;
    const auto seen = static_cast<double>(std::count_if(
        statistics.seen.begin(), statistics.seen.end(), [](char s) { return s != 0; }));
    const double sum = sum_of(e);
    const bool known = sum > 0 && std::isfinite(sum);
    const float floor = known ? kUniformShare * mean : mean;
    const double room = double{mean} * kMaxOfMean - double{floor};
    const double factor = known ? factor_for(e, double{mean - floor} * seen, room) : 0.0;
    for (std::size_t i = 0; i < e.size(); ++i)
        e[i] = !statistics.seen[i] ? 0.0f
               : !known            ? mean
                        : floor + static_cast<float>(std::min(room, factor * double{e[i]}));
    return e;
}

std::vector<BatchSample> choose_samples(const Film& film, std::span<const float> expected,
                                        std::uint32_t seed, std::uint32_t iteration,
                                        std::uint32_t passes) {
    const std::vector<Tile> tiles = make_tiles(film, kTile);
    std::vector<std::vector<BatchSample>> parts(tiles.size());
    parallel_for(tiles.size(), [&](std::size_t i) {
        for (const std::uint32_t pixel : marked_pixels(tiles[i], {}, film.crop_width)) {
            if (!(expected[pixel] > 0)) continue;
            const auto u = uniforms({seed, Stream::kAdaptive}, pixel, iteration, 0);
            const auto count = std::min(
                passes, static_cast<std::uint32_t>(double{expected[pixel]} + double{u[0]}));
            const auto first = static_cast<std::uint32_t>(u[1] * static_cast<float>(passes));
            for (std::uint32_t k = 0; k < count; ++k)
                parts[i].push_back({{pixel, iteration, (first + k) % passes}});
        }
    });
    std::vector<BatchSample> samples;
    for (const auto& part : parts) samples.insert(samples.end(), part.begin(), part.end());
    return samples;
}

void update_statistics(std::span<const BatchSample> samples, std::span<const PixelSquare> squares,
                       PixelStatistics& statistics) {
    for (float& s : statistics.squares) s *= kKept;
    for (float& c : statistics.counts) c *= kKept;
    for (const BatchSample& s : samples) statistics.counts[s.camera.pixel] += 1;
    for (const PixelSquare& s : squares) statistics.squares[s.pixel] += s.square;
}

}  // namespace burnish
