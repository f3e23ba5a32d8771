// The film: reconstruction and its adjoint are transposes of each other, and an image of a constant
// is that constant in expectation, with every filter, at the border too.
#include "render/film.h"

#include <gtest/gtest.h>

#include "burnish/error.h"
#include "gradient/small_scene.h"
#include "ledger_entries.h"
#include "render/filters.h"
#include "render/render.h"
#include "shading/filter.h"
#include "student.h"

namespace burnish {
namespace {

using test::ledger::kFilmConstant;

/// 21 x 13 pixels cut out of 25 x 19: no multiple of a tile.
Film odd_film(const ReconstructionFilter& filter) { return {25, 19, 3, 5, 21, 13, filter}; }

/// |<A, image> - sum over samples of w(x) value(x)| / |<A, image>| for one pass. `offset_error` is
/// added to the offset that the adjoint side assumes.
double transpose_error(const ReconstructionFilter& filter, float offset_error) {
    Scene scene = test::make_small_scene();
    scene.film = odd_film(filter);
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const RandomKey key{6000, Stream::kTest};
    const TraceInput input{&traced, &textures, key, 1, SurfaceChoice::kAll, {}};
    const Image image = render(input, 0, 1), adjoint = test::make_adjoint(scene, 6001, true);
    double direct = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i)
        direct += double{adjoint.values[i]} * double{image.values[i]};

    const Image normalized = normalized_adjoint(adjoint, film_normalization(scene.film));
    const Vec2f offset = film_offset(key, 0);
    const FilterTaps tx = filter_taps(filter, offset.x + offset_error),
                     ty = filter_taps(filter, offset.y);
    double transposed = 0;
    for (std::uint32_t pixel = 0; pixel < 21 * 13; ++pixel) {
        const BatchSample sample{{pixel, 0, 0}};
        BatchOutput out;
        trace_batch(input, {&sample, 1}, out);
        Rgbf value = out.emitted[0];
        for (const DirectSample& direct_sample : out.direct_samples) value += direct_sample.value;
        const Rgbf w = adjoint_weight(normalized, static_cast<int>(pixel) % 21,
                                      static_cast<int>(pixel) / 21, tx, ty);
        for (int c = 0; c < 3; ++c) transposed += double{w[c]} * double{value[c]};
    }
    return std::abs(direct - transposed) / std::abs(direct);
}

TEST(Film, TheWidestFilterHasTheRadiusThatTheMessageSays) {
    EXPECT_EQ(filter_halo({FilterKind::kBox, 7.5f}), 7);
    try {
        filter_halo({FilterKind::kBox, 7.75f});
        ADD_FAILURE() << "it is too wide";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "the reconstruction filter's radius is 7.75 pixels: expected at most 7.5");
    }
}

TEST(Film, AdjointWeightIsTheTransposeOfReconstruction) {
    for (const ReconstructionFilter& filter : test::kFilters) {
        EXPECT_LT(transpose_error(filter, 0), 2e-5) << static_cast<int>(filter.kind);
        if (filter.kind != FilterKind::kBox) {
            EXPECT_GT(transpose_error(filter, 0.05f), 2e-5) << static_cast<int>(filter.kind);
        }
    }
}

/// A sum of floats over so many passes would be wrong by 1e-4.
TEST(Film, AddsUpThousandsOfPasses) {
    Scene scene;
    scene.film = {2, 2, 0, 0, 2, 2, {FilterKind::kBox, 0.5f}};
    scene.emitters = {ConstantEmitter{{0.3f, 0.7f, 1.9f}}};
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures,           {6003, Stream::kTest},
                           1 << 16, SurfaceChoice::kAll, {}};
    const Image image = render(input, 0, 1 << 16), of_one_pass = render(input, 0, 1);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        EXPECT_NEAR(image.values[i] / of_one_pass.values[i], 1, 1e-6);
}

/// p-value of "every pixel of the image of a constant light is that constant". `tamper` multiplies
/// the pixels of an image.
template <class Tamper>
double constant_p_value(const ReconstructionFilter& filter, Tamper&& tamper) {
    Scene scene;
    scene.film = odd_film(filter);
    scene.emitters = {ConstantEmitter{{0.5f, 1.0f, 2.0f}}};
    const TracedScene traced = prepare(scene);
    const TextureTable textures;
    std::vector<test::RunningMean> means;
    const std::uint32_t batches = test::scaled(kFilmConstant, 400u);
    for (std::uint32_t b = 0; b < batches; ++b) {
        const TraceInput input{
            &traced, &textures,           {test::seed_of(kFilmConstant, b), Stream::kTest},
            3,       SurfaceChoice::kAll, {}};
        Image image = render(input, 0, 3);
        tamper(scene.film, image);
        means.resize(image.values.size());
        for (std::size_t i = 0; i < means.size(); ++i) means[i].add(double{image.values[i]});
    }
    std::vector<double> p;
    for (std::size_t i = 0; i < means.size(); ++i) {
        // Where the filter adds up exactly, only rounding is left.
        const double expected = std::array{0.5, 1.0, 2.0}[i % 3];
        const double error = std::hypot(means[i].standard_error(), 1e-6 * expected);
        p.push_back(test::welch_p_value({means[i].mean, error, batches - 1.0}, {expected, 0}));
    }
    return test::holm_minimum(p);
}

/// Normalises as if the filter were not clipped at the film's border.
void forget_the_border(const Film& film, Image& image) {
    const FilmNormalization n = film_normalization(film);
    const float inner_x = n.x[n.x.size() / 2], inner_y = n.y[n.y.size() / 2];
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) *= inner_x / n.x[static_cast<std::size_t>(x)] * inner_y /
                                     n.y[static_cast<std::size_t>(y)];
}

TEST(Film, ConstantImageStaysConstantAtTheBorderToo) {
    for (const ReconstructionFilter& filter : test::kFilters) {
        EXPECT_TRUE(test::accepted(kFilmConstant,
                                   "filter " + std::to_string(static_cast<int>(filter.kind)),
                                   constant_p_value(filter, [](const Film&, Image&) {})));
        if (filter.kind != FilterKind::kBox) {
            EXPECT_TRUE(test::rejected(kFilmConstant, "normalisation that forgets the border",
                                       constant_p_value(filter, forget_the_border)))
                << static_cast<int>(filter.kind);
        }
    }
}

/// The integral of the filter at pixel j over the film, by a fine midpoint sum.
double slow_integral(const ReconstructionFilter& filter, int j, int size) {
    constexpr int kSteps = 20000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        sum += eval_filter_exact(filter, (i + 0.5) / kSteps * size - (j + 0.5));
    return sum * size / kSteps;
}

TEST(Film, NormalisationIsTheExactIntegral) {
    for (const ReconstructionFilter& filter : test::kFilters) {
        const FilmNormalization n = film_normalization(odd_film(filter));
        for (int j = 0; j < 21; ++j)
            EXPECT_NEAR(n.x[static_cast<std::size_t>(j)] * slow_integral(filter, j, 21), 1, 2e-3)
                << static_cast<int>(filter.kind) << ", pixel " << j;
        EXPECT_EQ(n.x.size(), 21u);
        EXPECT_EQ(n.y.size(), 13u);
    }
}

}  // namespace
}  // namespace burnish
