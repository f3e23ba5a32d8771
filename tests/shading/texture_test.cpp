// Texture look-ups against the reference table, and footprints against look-ups.
#include "shading/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "core/random.h"
#include "csv.h"
#include "random_source.h"
#include "shading/texture_packet.h"
#include "worst.h"

namespace burnish::test {
namespace {

/// A picture of the reference data; `as_codes` keeps 8-bit codes with a decoding table.
Bitmap read_bitmap(const std::string& name, bool raw, bool as_codes) {
    const Image image = read_image_file(reference_folder() / "tables" / name).image;
    const auto decoded = [&](float x) { return raw ? x : srgb_to_linear(x); };
    Bitmap b;
    b.width = image.width;
    b.height = image.height;
    b.channels = image.channels;
    if (as_codes) {
        for (std::size_t i = 0; i < 256; ++i) b.decode[i] = decoded(static_cast<float>(i) / 255.0f);
        for (const float x : image.values)
            b.codes.push_back(static_cast<std::uint8_t>(std::lround(x * 255)));
    } else {
        for (const float x : image.values) b.values.push_back(decoded(x));
    }
    return b;
}

/// scale * rotate * translate, as 2x3.
UvTransform transform_of(const CsvRow& row) {
    const double angle = row["rotate_deg"] * std::numbers::pi / 180, c = std::cos(angle),
                 s = std::sin(angle);
    const double tx = row["translate_x"], ty = row["translate_y"], sx = row["scale_x"],
                 sy = row["scale_y"];
    const auto f = [](double x) { return static_cast<float>(x); };
    return {{f(sx * c), f(-sx * s), f(sx * (c * tx - s * ty)), f(sy * s), f(sy * c),
             f(sy * (s * tx + c * ty))}};
}

Bitmap bitmap_of(const CsvRow& row, bool as_codes) {
    const bool gray = row["file"] == 1;
    Bitmap b = read_bitmap(gray ? "texture_gray16.png" : "texture_rgb8.png", row["raw"] != 0,
                           as_codes && !gray);
    b.filter = row["filter"] == 0 ? TextureFilter::kNearest : TextureFilter::kBilinear;
    b.wrap = static_cast<TextureWrap>(static_cast<int>(row["wrap"]));
    b.to_uv = transform_of(row);
    return b;
}

/// Colour and scalar reading.
struct Reading {
    Rgbf color;
    float scalar;
};

Reading read(const Texture& texture, const Vec2f& uv) {
    const TextureTable table{{&texture, 1}, {}};
    return {eval_color(table, ColorInput{{}, TextureId{0}}, uv),
            eval_scalar(table, ScalarInput{0, TextureId{0}}, uv)};
}

double difference(const Reading& a, const CsvRow& row) {
    const std::array<double, 4> ours{a.color.x, a.color.y, a.color.z, a.scalar};
    const std::array<double, 4> theirs{row["r"], row["g"], row["b"], row["scalar"]};
    double worst = 0;
    for (std::size_t i = 0; i < 4; ++i) worst = test::worse(worst, std::abs(ours[i] - theirs[i]));
    return worst;
}

/// Values agree to 1e-6 at uv itself or, because a nearest look-up jumps and a bilinear one has a
/// slope, differ by no more than ours moves when uv moves by four ulps of the largest intermediate.
double worst_excess(bool as_codes, float offset) {
    double worst = 0;
    for (const CsvRow& row : reference_table("texture.csv")) {
        const Texture texture = bitmap_of(row, as_codes);
        const Vec2f uv{static_cast<float>(row["u"]), static_cast<float>(row["v"])};
        const Reading here = read(texture, {uv.x + offset, uv.y});
        const float step =
            4 * 0x1p-23f *
            (1 + std::abs(uv.x) + std::abs(uv.y) +
             static_cast<float>(std::abs(row["translate_x"]) + std::abs(row["translate_y"])));
        double spread = 0;
        for (const auto& [dx, dy] :
             {std::pair{step, 0.0f}, {-step, 0.0f}, {0.0f, step}, {0.0f, -step}}) {
            const Reading near = read(texture, {uv.x + dx, uv.y + dy});
            const Reading center = read(texture, uv);
            for (int c = 0; c < 3; ++c)
                spread = std::max(spread,
                                  static_cast<double>(std::abs(near.color[c] - center.color[c])));
        }
        worst = test::worse(worst, difference(here, row) - spread);
    }
    return worst;
}

TEST(TextureLookup, AgreesWithTheTable) {
    EXPECT_LT(worst_excess(false, 0), 1e-6);
    EXPECT_LT(worst_excess(true, 0), 1e-6);
    EXPECT_GT(worst_excess(false, 1e-4f), 1e-5);  // the comparison sees a shift of 1e-4
}

Bitmap pattern(int width, int height, int channels, TextureFilter filter, TextureWrap wrap) {
    Bitmap b;
    b.width = width;
    b.height = height;
    b.channels = channels;
    b.filter = filter;
    b.wrap = wrap;
    for (int i = 0; i < width * height * channels; ++i)
        b.values.push_back(uniforms({3, Stream::kTest}, static_cast<std::uint32_t>(i), 0, 0)[0]);
    return b;
}

/// Every kind at ordinary, huge and non-finite coordinates: texels exist, are distinct, and weights
/// add up to 1.
TEST(TextureLookup, FootprintsAreSound) {
    const std::array<float, 14> coordinates{0.0f,
                                            1.0f,
                                            0.5f,
                                            -0.25f,
                                            -1e-9f,
                                            3.75f,
                                            1e6f,
                                            -1e20f,
                                            3e38f,
                                            std::numeric_limits<float>::infinity(),
                                            -std::numeric_limits<float>::infinity(),
                                            std::numeric_limits<float>::quiet_NaN(),
                                            0.99999994f,
                                            -2.0f};
    for (const auto filter : {TextureFilter::kNearest, TextureFilter::kBilinear}) {
        for (const auto wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp}) {
            for (const auto& [w, h] : {std::pair{1, 1}, {1, 3}, {2, 2}, {5, 7}}) {
                const Bitmap b = pattern(w, h, 1, filter, wrap);
                for (const float u : coordinates) {
                    for (const float v : coordinates) {
                        const TexelFootprint f = footprint(b, {u, v});
                        ASSERT_TRUE(f.count >= 1 && f.count <= 4);
                        std::set<std::uint32_t> distinct;
                        float sum = 0;
                        for (std::size_t k = 0; k < static_cast<std::size_t>(f.count); ++k) {
                            ASSERT_LT(f.texel[k], static_cast<std::uint32_t>(w * h));
                            EXPECT_GT(f.weight[k], 0.0f);
                            distinct.insert(f.texel[k]);
                            sum += f.weight[k];
                        }
                        EXPECT_EQ(distinct.size(), static_cast<std::size_t>(f.count));
                        EXPECT_NEAR(sum, 1.0f, 3e-7f);
                    }
                }
            }
        }
    }
}

/// Packets against floats, bit by bit, at ordinary, huge and non-finite coordinates.
TEST(TextureLookup, PacketsAgreeWithFloats) {
    const std::array<float, 16> coordinates{0.0f,
                                            1.0f,
                                            0.5f,
                                            -0.25f,
                                            -1e-9f,
                                            3.75f,
                                            1e6f,
                                            -1e20f,
                                            3e38f,
                                            std::numeric_limits<float>::infinity(),
                                            -std::numeric_limits<float>::infinity(),
                                            std::numeric_limits<float>::quiet_NaN(),
                                            0.99999994f,
                                            -2.0f,
                                            0.3f,
                                            -0.77f};
    for (const auto filter : {TextureFilter::kNearest, TextureFilter::kBilinear})
        for (const auto wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp})
            for (const auto& [w, h, channels] : {std::array{1, 1, 1}, {1, 3, 3}, {5, 7, 1}}) {
                Bitmap b = pattern(w, h, channels, filter, wrap);
                b.to_uv = {{1.7f, 0.2f, 0.13f, -0.1f, 1.3f, 0.4f}};
                const Texture texture = b;
                const TextureTable table{{&texture, 1}, {}};
                for (std::size_t j = 0; j < coordinates.size(); ++j) {
                    const Vec2<Packet> uv{load(coordinates.data()), Packet(coordinates[j])};
                    const auto color = eval_color(table, ColorInput{{}, TextureId{0}}, uv);
                    const auto scalar = eval_scalar(table, ScalarInput{0, TextureId{0}}, uv);
                    for (int k = 0; k < kLanes; ++k) {
                        const Reading one = read(
                            texture, {coordinates[static_cast<std::size_t>(k)], coordinates[j]});
                        EXPECT_EQ(get(color.x, k), one.color.x);
                        EXPECT_EQ(get(color.y, k), one.color.y);
                        EXPECT_EQ(get(color.z, k), one.color.z);
                        EXPECT_EQ(get(scalar, k), one.scalar);
                    }
                }
            }
}

/// The weight of a texel is the derivative of the value to it.
TEST(TextureLookup, FootprintIsTheDerivativeOfTheValue) {
    Bitmap b = pattern(4, 3, 1, TextureFilter::kBilinear, TextureWrap::kMirror);
    const Vec2f uv{1.1f, -0.3f};
    const TexelFootprint f = footprint(b, uv);
    const float before = read(b, uv).scalar;
    for (std::size_t t = 0; t < b.values.size(); ++t) {
        Bitmap changed = b;
        changed.values[t] += 0.5f;
        float weight = 0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(f.count); ++k)
            weight += f.texel[k] == t ? f.weight[k] : 0.0f;
        EXPECT_NEAR(read(changed, uv).scalar - before, 0.5f * weight, 1e-6f);
    }
}

/// Whoever reads numbers finds the same in the luminance as in the colours.
TEST(TextureLookup, GradientsAreThoseOfTheValue) {
    Bitmap bitmap = read_bitmap("texture_rgb8.png", true, true);
    bitmap.to_uv = {{1.2f, 0.5f, 0.1f, -0.3f, 0.9f, 0.2f}};
    for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp})
        for (const bool clips : {false, true}) {
            bitmap.wrap = wrap;
            bitmap.filter = clips ? TextureFilter::kNearest : TextureFilter::kBilinear;
            const std::vector<Texture> textures{bitmap};
            const TextureTable table{textures, {}};
            RandomSource random{17};
            int compared = 0;
            for (int i = 0; i < 200; ++i) {
                const Vec2f at{random.next(-1, 2), random.next(-1, 2)};
                const Vec2f g = scalar_gradient(table, {0}, at);
                for (const Vec2f axis : {Vec2f{1, 0}, Vec2f{0, 1}}) {
                    const float h = 5e-4f;
                    const Vec2f before = at - axis * h, after = at + axis * h;
                    if (footprint(bitmap, before).texel != footprint(bitmap, after).texel) continue;
                    const auto value = [&](const Vec2f& uv) {
                        return eval_scalar(table, ScalarInput{0, {0}}, uv);
                    };
                    EXPECT_NEAR((value(after) - value(before)) / (2 * h),
                                g.x * axis.x + g.y * axis.y, 0.01f);
                    ++compared;
                }
            }
            EXPECT_GT(compared, 300);
        }
}

TEST(TextureLookup, TheLuminanceServesForNumbers) {
    for (const auto filter : {TextureFilter::kNearest, TextureFilter::kBilinear})
        for (const bool coded : {false, true}) {
            Bitmap colors = pattern(7, 5, 3, filter, TextureWrap::kMirror);
            if (coded) {
                for (std::size_t i = 0; i < 256; ++i)
                    colors.decode[i] = srgb_to_linear(static_cast<float>(i) / 255);
                for (const float v : colors.values)
                    colors.codes.push_back(static_cast<std::uint8_t>(v * 255));
                colors.values.clear();
            }
            Bitmap numbers = colors;
            keep_luminance(numbers);
            EXPECT_EQ(numbers.channels, 1);
            for (std::uint32_t i = 0; i < 100; ++i) {
                const auto u = uniforms({4, Stream::kTest}, i, 0, 0);
                const Vec2f uv{4 * u[0] - 2, 4 * u[1] - 2};
                EXPECT_NEAR(read(numbers, uv).scalar, read(colors, uv).scalar, 1e-6f);
            }
            const Bitmap once = numbers;
            keep_luminance(numbers);
            EXPECT_EQ(numbers.values, once.values);
        }
}

TEST(TextureLookup, OptimisedValuesReplaceTheBitmap) {
    const Texture texture = pattern(4, 3, 3, TextureFilter::kBilinear, TextureWrap::kRepeat);
    const std::vector<float> values(36, 0.25f);
    const TextureTable table{{&texture, 1}, {values.data()}};
    EXPECT_NEAR(eval_color(table, ColorInput{{}, TextureId{0}}, Vec2f{0.3f, 0.4f}).y, 0.25f, 1e-7f);
    EXPECT_NEAR(eval_scalar(table, ScalarInput{0, TextureId{0}}, Vec2f{0.3f, 0.4f}), 0.25f, 1e-7f);
    EXPECT_EQ(eval_scalar(table, ScalarInput{0.75f, {}}, Vec2f{0.3f, 0.4f}), 0.75f);
}

TEST(TextureLookup, NumbersReadTheMeanOfACheckerboardsOtherColour) {
    const Texture board =
        Checkerboard{{0.1f, 0.5f, 0.3f}, {0.9f, 0.9f, 0.9f}, {{2, 0, 0, 0, 1, 0}}};
    EXPECT_EQ(read(board, {0.1f, 0.1f}).scalar, 0.9f);
    EXPECT_NEAR(read(board, {0.3f, 0.1f}).scalar, 0.3f, 1e-7f);
}

TEST(TextureLookup, CheckerboardAlternates) {
    const Texture board = Checkerboard{{1, 1, 1}, {0, 0, 0}, {{2, 0, 0, 0, 1, 0}}};
    EXPECT_EQ(read(board, {0.1f, 0.1f}).color.x, 1.0f);
    EXPECT_EQ(read(board, {0.3f, 0.1f}).color.x, 0.0f);
    EXPECT_EQ(read(board, {0.3f, 0.6f}).color.x, 1.0f);
    EXPECT_EQ(read(board, {-0.1f, 0.1f}).color.x, 0.0f);
}

}  // namespace
}  // namespace burnish::test
