// A pass of a tile and the film: splatting and gathering are transposes of each other, gathering
// agrees with adjoint_weight sample by sample, for every filter and at the film's border.
#include "render/pass_convolution.h"
#include "render/filters.h"

#include <gtest/gtest.h>

#include "random_source.h"

namespace burnish {
namespace {

constexpr int kFilmWidth = 45, kFilmHeight = 38;

std::vector<float> random_floats(std::size_t count, std::uint32_t seed) {
    test::RandomSource random{seed};
    std::vector<float> values(count);
    for (float& v : values) v = random.next(-1, 1);
    return values;
}

std::vector<Tile> all_tiles(int side) {
    Film film;
    film.crop_width = kFilmWidth, film.crop_height = kFilmHeight;
    return make_tiles(film, side);
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += double{a[i]} * double{b[i]};
    return sum;
}

TEST(PassConvolution, TilesCoverTheFilmOnce) {
    std::vector<int> covered(kFilmWidth * kFilmHeight, 0);
    for (const Tile& t : all_tiles(16))
        for (int y = t.y0; y < t.y0 + t.height; ++y)
            for (int x = t.x0; x < t.x0 + t.width; ++x)
                ++covered[static_cast<std::size_t>(y * kFilmWidth + x)];
    for (const int n : covered) EXPECT_EQ(n, 1);
}

TEST(PassConvolution, GatheringIsTheTransposeOfSplatting) {
    Image adjoint = make_image(kFilmWidth, kFilmHeight, 3);
    adjoint.values = random_floats(adjoint.values.size(), 31);
    for (const ReconstructionFilter& filter : test::kFilters) {
        const std::array<FilterTaps, 2> taps{filter_taps(filter, 0.3f), filter_taps(filter, 0.85f)};
        const int halo = taps[0].halo;
        double direct = 0, transposed = 0;
        Image image = make_image(kFilmWidth, kFilmHeight, 3);
        std::vector<float> scratch;
        std::vector<std::vector<float>> sums;
        for (const Tile& tile : all_tiles(16)) {
            const auto pixels = static_cast<std::size_t>(tile.width * tile.height);
            const auto pass = random_floats(3 * pixels, 32);
            std::vector<float>& sum = sums.emplace_back(
                static_cast<std::size_t>(3 * (tile.width + 2 * halo) * (tile.height + 2 * halo)));
            splat_pass(tile, taps, pass.data(), scratch, sum.data());
            std::vector<float> weights(3 * pixels, 9.0f);  // must be overwritten
            gather_pass(tile, taps, adjoint, scratch, weights.data());
            transposed += dot(weights, pass);
            for (int y = 0; y < tile.height; ++y)
                for (int x = 0; x < tile.width; ++x) {
                    const Rgbf w =
                        adjoint_weight(adjoint, tile.x0 + x, tile.y0 + y, taps[0], taps[1]);
                    for (int c = 0; c < 3; ++c)
                        EXPECT_NEAR(weights[static_cast<std::size_t>(3 * (y * tile.width + x) + c)],
                                    w[c], 2e-5f);
                }
        }
        add_tiles(all_tiles(16), halo, sums, image);
        direct = dot(image.values, adjoint.values);
        EXPECT_NEAR(direct, transposed, 1e-4 * std::abs(direct) + 1e-3)
            << static_cast<int>(filter.kind);
    }
}

TEST(PassConvolution, SplattingAddsToWhatIsThere) {
    const Tile tile{0, 0, 8, 8};
    const std::array<FilterTaps, 2> taps{filter_taps({FilterKind::kBox, 0.5f}, 0.5f),
                                         filter_taps({FilterKind::kBox, 0.5f}, 0.5f)};
    const std::vector<float> pass(3 * 64, 2.0f);
    std::vector<float> sum(3 * 64, 1.0f), scratch;
    splat_pass(tile, taps, pass.data(), scratch, sum.data());
    const float weight = taps[0].weight[0] * taps[1].weight[0];
    for (const float v : sum) EXPECT_FLOAT_EQ(v, 1 + 2 * weight);
}

}  // namespace
}  // namespace burnish
