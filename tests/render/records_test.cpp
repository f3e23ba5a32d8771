// Packed records: what packing loses, and that shading packets of them gives what plain floats do.
#include "render/records.h"

#include <gtest/gtest.h>

#include "random_source.h"
#include "render/unpacked_record.h"

namespace burnish {
namespace {

/// The bound of records.h.
constexpr float kDirectionError = 8e-5f;

Vec3f random_direction(test::RandomSource& random) {
    for (;;) {
        const Vec3f v{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)};
        const float squared = length_squared(v);
        if (squared > 1e-4f && squared < 1) return v * (1 / std::sqrt(squared));
    }
}

Vec3f there_and_back(const Vec3f& direction) {
    std::array<std::uint32_t, kLanes> packed{};
    packed[5] = pack_direction(direction);
    const Vec3<Packet> d = unpack_directions(packed);
    return {get(d.x, 5), get(d.y, 5), get(d.z, 5)};
}

void expect_close(const Vec3f& direction) {
    const Vec3f d = there_and_back(direction);
    EXPECT_LT(length(d - direction), kDirectionError) << direction.x << " " << direction.y;
    EXPECT_NEAR(length(d), 1.0f, 1e-6f);
    EXPECT_NE(d.z, 0.0f);
    EXPECT_EQ(d.z < 0, direction.z < 0);
}

TEST(Records, DirectionsKeepTheirSideAndFourDigits) {
    test::RandomSource random{21};
    for (int i = 0; i < 20000; ++i) expect_close(random_direction(random));
    for (const float z : {1.0f, -1.0f}) expect_close({0, 0, z});
    for (const float s : {1.0f, -1.0f}) {  // grazing, along the axes and the diagonals
        for (const float z : {1e-7f, -1e-7f, 1e-4f}) {
            expect_close(normalize(Vec3f{s, 0, z}));
            expect_close(normalize(Vec3f{0, s, z}));
            expect_close(normalize(Vec3f{s, s, z}));
            expect_close(normalize(Vec3f{s, -s, z}));
        }
    }
}

DirectSample make_sample(test::RandomSource& random, int bsdf, Technique technique, bool unknowns,
                         const Tile& tile, int width) {
    DirectSample direct_sample;
    direct_sample.has_unknowns = unknowns;
    PathRecord& r = direct_sample.record;
    const int x = tile.x0 + static_cast<int>(random.next() * static_cast<float>(tile.width));
    const int y = tile.y0 + static_cast<int>(random.next() * static_cast<float>(tile.height));
    r.pixel = static_cast<std::uint32_t>(y * width + x);
    r.bsdf = {bsdf};
    r.uv = {random.next(-3, 3), random.next(-3, 3)};
    r.technique = technique;
    r.wi_local = random_direction(random), r.wo_local = random_direction(random);
    r.radiance_over_pdf = {random.next(), random.next(), random.next(0, 1e4f)};
    return direct_sample;
}

TEST(Records, EverySampleOfUnknownsIsKeptOnceInItsBsdfsRun) {
    const Tile tile{64, 32, 29, 17};
    constexpr int kWidth = 100;
    test::RandomSource random{22};
    std::vector<DirectSample> direct_samples;
    for (int i = 0; i < 300; ++i)
        direct_samples.push_back(make_sample(random, 7 - i % 3,
                                             i < 130 ? Technique::kEmitter : Technique::kBsdf,
                                             i % 4 > 0, tile, kWidth));
    const TileRecords packed = pack_records(direct_samples, tile, kWidth);
    EXPECT_EQ(packed.count, 225u);
    ASSERT_EQ(packed.runs.size(), 3u);
    std::array<std::size_t, 8> next{};  // samples of a BSDF keep their order
    for (const RecordRun& run : packed.runs) {
        std::size_t lane = 0;
        for (const DirectSample& direct_sample : direct_samples) {
            if (!direct_sample.has_unknowns || direct_sample.record.bsdf != run.bsdf) continue;
            const RecordBlock& block = packed.blocks[run.begin + lane / kLanes];
            const PathRecord r = test::unpack_record(block, lane % kLanes, run.bsdf, tile, kWidth);
            EXPECT_EQ(r.pixel, direct_sample.record.pixel);
            EXPECT_EQ(r.uv.x, direct_sample.record.uv.x);
            EXPECT_EQ(r.uv.y, direct_sample.record.uv.y);
            EXPECT_LT(length(r.wi_local - direct_sample.record.wi_local), kDirectionError);
            EXPECT_LT(length(r.wo_local - direct_sample.record.wo_local), kDirectionError);
            EXPECT_EQ(r.radiance_over_pdf.z, direct_sample.record.radiance_over_pdf.z);
            ++lane;
        }
        for (; lane < kLanes * std::size_t{run.end - run.begin}; ++lane)
            EXPECT_TRUE(is_black(test::unpack_record(packed.blocks[run.begin + lane / kLanes],
                                                     lane % kLanes, run.bsdf, tile, kWidth)
                                     .radiance_over_pdf));
        next[static_cast<std::size_t>(run.bsdf.value)] = lane;
    }
    EXPECT_EQ(next[5], 80u);  // 75 samples and 5 empty lanes
}

}  // namespace
}  // namespace burnish
