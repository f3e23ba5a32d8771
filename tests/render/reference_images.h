// Comparison of images with stored means and standard errors, tile by tile: independent batches of
// ours against the reference, Welch's t, Holm over all tiles and channels. No tile is exempt.
#pragma once

#include <filesystem>
#include <string>

#include "render/film.h"
#include "render/render.h"
#include "shading/filter.h"
#include "student.h"

namespace burnish::test {

/// A stored image: the mean of `renders` independent ones, and the standard error of that mean.
struct ReferenceImage {
    Image mean, standard_error;
    double renders = 16;
};

inline ReferenceImage read_reference_image(const std::filesystem::path& folder,
                                           const std::string& name) {
    return {read_image(folder / (name + ".exr")), read_image(folder / (name + "_stderr.exr"))};
}

/// Mean and standard error of each tile and channel: [rows, columns, 3].
struct TileMeans {
    std::vector<MeanEstimate> tiles;
};

inline constexpr int kTileSize = 8;

inline int tiles_along(int size) { return (size + kTileSize - 1) / kTileSize; }

/// Calls body(tile index, x, y) for every pixel.
template <class Body>
void for_tile_pixels(const Image& image, Body&& body) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            body(static_cast<std::size_t>(y / kTileSize * tiles_along(image.width) + x / kTileSize),
                 x, y);
}

/// Means over the tiles of one image.
inline std::vector<double> tile_averages(const Image& image) {
    const auto count =
        static_cast<std::size_t>(tiles_along(image.width) * tiles_along(image.height));
    std::vector<double> sum(3 * count), pixels(count);
    for_tile_pixels(image, [&](std::size_t t, int x, int y) {
        ++pixels[t];
        for (int c = 0; c < 3; ++c)
            sum[3 * t + static_cast<std::size_t>(c)] += double{image.at(x, y, c)};
    });
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= pixels[i / 3];
    return sum;
}

/// The variance of a pixel over that of the average of many, per sample: neighbouring pixels share
/// samples, so the errors of a tile's pixels do not add like independent ones.
inline double filter_concentration(const ReconstructionFilter& filter) {
    constexpr int kSteps = 20000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double x = double{filter.radius} * (2 * (i + 0.5) / kSteps - 1);
        const double h = eval_filter_exact(filter, x);
        sum += h, squares += h * h;
    }
    const double axis = squares / (sum * sum) * kSteps / (2 * double{filter.radius});
    return axis * axis;
}

inline TileMeans tile_means(const ReferenceImage& reference, const ReconstructionFilter& filter) {
    const double concentration = filter_concentration(filter);
    const std::vector<double> mean = tile_averages(reference.mean);
    std::vector<double> pixels(mean.size()), second(mean.size()), fourth(mean.size());
    for_tile_pixels(reference.mean, [&](std::size_t t, int x, int y) {
        for (int c = 0; c < 3; ++c) {
            const std::size_t i = 3 * t + static_cast<std::size_t>(c);
            const double v = double{reference.standard_error.at(x, y, c)};
            ++pixels[i], second[i] += v * v, fourth[i] += v * v * v * v;
        }
    });
    TileMeans result;
    for (std::size_t i = 0; i < mean.size(); ++i) {
        const double own = reference.renders - 1;
        const double degrees =
            fourth[i] > 0 ? own * std::max(1.0, concentration * second[i] * second[i] / fourth[i])
                          : own;
        result.tiles.push_back(
            {mean[i], std::sqrt(second[i] / std::min(1.0, concentration)) / pixels[i], degrees});
    }
    return result;
}

struct Batches {
    std::uint32_t seed = 0, count = 64, samples_per_pixel = 16;
};

/// Our image: the mean of all batches, and the tiles' means with the error that the batches show.
struct RenderedImage {
    Image mean;
    TileMeans tiles;
    std::size_t rejected = 0;
};

inline RenderedImage render_batches(const Scene& scene, const Batches& batches) {
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    RenderedImage result;
    std::vector<RunningMean> tiles;
    for (std::uint32_t b = 0; b < batches.count; ++b) {
        const TraceInput input{&traced,
                               &textures,
                               {batches.seed + b, Stream::kTest},
                               batches.samples_per_pixel,
                               SurfaceChoice::kAll,
                               {}};
        RenderCounts counts;
        const Image image = render(input, 0, batches.samples_per_pixel, &counts);
        result.rejected += counts.rejected;
        if (b == 0) result.mean = make_image(image.width, image.height, 3);
        for (std::size_t i = 0; i < image.values.size(); ++i)
            result.mean.values[i] += image.values[i] / static_cast<float>(batches.count);
        const std::vector<double> averages = tile_averages(image);
        tiles.resize(averages.size());
        for (std::size_t i = 0; i < averages.size(); ++i) tiles[i].add(averages[i]);
    }
    for (const RunningMean& t : tiles) result.tiles.tiles.push_back(estimate_of(t));
    return result;
}

/// The worst tile of a comparison.
struct TileComparison {
    double p_value = 1;  ///< Holm-corrected
    std::size_t worst = 0;
    MeanEstimate ours, theirs;  ///< there
};

/// Sums in single precision err by some 1e-6 of the mean besides the noise of the samples.
inline TileComparison compare_tiles(const TileMeans& ours, const TileMeans& theirs) {
    constexpr double kRounding = 3e-6;
    std::vector<double> p;
    for (std::size_t i = 0; i < ours.tiles.size(); ++i) {
        MeanEstimate a = ours.tiles[i];
        a.standard_error = std::hypot(a.standard_error, kRounding * std::abs(a.mean));
        p.push_back(welch_p_value(a, theirs.tiles[i]));
    }
    TileComparison result;
    result.p_value = holm_minimum(p);
    result.worst = static_cast<std::size_t>(std::min_element(p.begin(), p.end()) - p.begin());
    result.ours = ours.tiles[result.worst], result.theirs = theirs.tiles[result.worst];
    return result;
}

/// By how much the mean of the whole image differs, relative, in the worst channel, and the
/// standard error of that difference (tiles taken as independent).
struct MeanDifference {
    double relative = 0, standard_error = 0;
};

inline MeanDifference image_mean_difference(const TileMeans& ours, const TileMeans& theirs) {
    MeanDifference worst;
    for (std::size_t c = 0; c < 3; ++c) {
        double a = 0, b = 0, variance = 0;
        for (std::size_t i = c; i < ours.tiles.size(); i += 3) {
            a += ours.tiles[i].mean, b += theirs.tiles[i].mean;
            variance += std::pow(ours.tiles[i].standard_error, 2) +
                        std::pow(theirs.tiles[i].standard_error, 2);
        }
        if (b == 0) continue;
        if (const double d = std::abs(a / b - 1); d > worst.relative)
            worst = {d, std::sqrt(variance) / b};
    }
    return worst;
}

}  // namespace burnish::test
