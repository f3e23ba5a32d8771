// Samples of a mixture: the densities are those of its components in equal parts, and so are the
// directions.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "gradient/small_scene.h"
#include "paths/trace.h"

namespace burnish {
namespace {

struct Samples {
    std::map<std::pair<int, Technique>, PathRecord> records;
};

/// The samples of all pixels with the unknowns at these values; none: at their texels.
Samples trace_with(const std::vector<ConstantTextures>& mixture) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const TextureTable textures = texture_table(scene, theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, theta);
    TraceInput input;
    input.scene = &traced, input.textures = &textures, input.key = {5, Stream::kTest};
    input.unknown_bsdfs = unknowns, input.keep_black = true, input.mixture = mixture;
    std::vector<BatchSample> batch(256);
    Samples all;
    BatchOutput out;
    for (std::uint32_t pass = 0; pass < 8; ++pass) {
        for (std::uint32_t i = 0; i < batch.size(); ++i) batch[i].camera = {i, pass, 0};
        trace_batch(input, batch, out);
        for (const DirectSample& d : out.direct_samples)
            if (d.has_unknowns)
                all.records[{static_cast<int>(pass) * 256 + d.sample, d.record.technique}] =
                    d.record;
    }
    return all;
}

const ConstantTextures kSmooth{0.5f, 0.15f}, kMatt{0.5f, 0.8f};

double luminance_of(const PathRecord& r) { return double{luminance(r.radiance_over_pdf)}; }

TEST(TraceMixture, OfEqualComponentsIsTheComponent) {
    const Samples one = trace_with({kSmooth}),
                  four = trace_with({kSmooth, kSmooth, kSmooth, kSmooth});
    ASSERT_EQ(one.records.size(), four.records.size());
    for (const auto& [key, a] : one.records) {
        const PathRecord& b = four.records.at(key);
        EXPECT_EQ(a.wo_local, b.wo_local);
        EXPECT_NEAR(luminance_of(a), luminance_of(b), 1e-5 * luminance_of(a));
    }
}

TEST(TraceMixture, ValuesInPlaceOfTexelsDoNotReadThem) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Samples read = trace_with({{nan, nan}}), plain = trace_with({});
    ASSERT_EQ(read.records.size(), plain.records.size());
    for (const auto& [key, r] : plain.records) EXPECT_EQ(read.records.at(key), r);
    EXPECT_NE(trace_with({kSmooth}).records, plain.records);
}

/// A light sample has L / (p_e + p_b), so its inverse is the mean of its inverses under either
/// component. A BSDF sample has the direction of one of them.
TEST(TraceMixture, HasTheMeanDensityAndTheDirectionsOfBoth) {
    const Samples a = trace_with({kSmooth}), b = trace_with({kMatt}),
                  both = trace_with({kSmooth, kMatt});
    std::size_t lights = 0, differ = 0, of_a = 0, of_b = 0;
    for (const auto& [key, r] : both.records) {
        const auto in_a = a.records.find(key), in_b = b.records.find(key);
        if (r.technique == Technique::kEmitter) {
            ASSERT_TRUE(in_a != a.records.end() && in_b != b.records.end());
            const double x = 1 / luminance_of(in_a->second), y = 1 / luminance_of(in_b->second);
            EXPECT_NEAR(1 / luminance_of(r), (x + y) / 2, 1e-4 * (x + y));
            ++lights, differ += std::abs(x - y) > 0.01 * (x + y);
            continue;
        }
        const bool is_a = in_a != a.records.end() && in_a->second.wo_local == r.wo_local;
        const bool is_b = in_b != b.records.end() && in_b->second.wo_local == r.wo_local;
        EXPECT_TRUE(is_a || is_b);
        of_a += is_a && !is_b, of_b += is_b && !is_a;
    }
    EXPECT_GT(lights, 500u);
    EXPECT_GT(differ, 200u) << "the components differ";
    EXPECT_GT(of_a, 200u);
    EXPECT_GT(of_b, 200u);
}

}  // namespace
}  // namespace burnish
