// The choice of an emitter: its probability is that of the samples, is the one that is stated, and
// is positive wherever light can come from; images do not depend on it.
#include "paths/light_selection.h"

#include <gtest/gtest.h>

#include "gradient/room.h"
#include "ledger_entries.h"
#include "paths/lamps.h"
#include "paths/light_resampling.h"
#include "paths/one_light.h"
#include "student.h"

namespace burnish::test {
namespace {

using ledger::kSelectionChoices;
using ledger::kSelectionImages;

std::string name_of(LightSelection selection) {
    const std::array<const char*, 4> names{"uniform", "power", "tree", "resampled"};
    return names[static_cast<std::size_t>(selection)];
}

std::array<float, 4> four(RandomSource& random) {
    return {random.next(), random.next(), random.next(), random.next()};
}

/// That a candidate is this emitter, whichever it is.
double probability(const LightSelector& selector, const Vec3f& position, std::size_t emitter) {
    return 1 /
           (double{1} * candidates_of(selector) *
            double{inverse_probability(selector, position, static_cast<std::uint32_t>(emitter))});
}

class Selection : public testing::TestWithParam<LightSelection> {};

/// Positions where bounds touch: at a point light, in the middle of a sphere, on a panel.
std::vector<Vec3f> positions(const Scene& scene) {
    std::vector<Vec3f> result{{0.8f, -0.9f, 0.7f}, {-0.9f, 0.2f, 0.8f}, {}};
    for (const Shape& shape : scene.shapes)
        if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
            result.push_back(mesh->positions[0]);
    RandomSource random{16001};
    while (result.size() < 200) result.push_back(random_position(random));
    return result;
}

TEST_P(Selection, ProbabilitiesAreThoseOfOneChoice) {
    Scene black = make_lamps();
    for (Emitter& emitter : black.emitters) {
        if (auto* area = std::get_if<AreaEmitter>(&emitter)) area->radiance = {};
        if (auto* point = std::get_if<PointEmitter>(&emitter)) point->intensity = {};
        if (auto* sky = std::get_if<ConstantEmitter>(&emitter)) sky->radiance = {};
    }
    Scene no_sky = make_lamps();
    no_sky.emitters[2] = PointEmitter{{0, 0, 1}, {1, 0, 0}};
    Scene only_sky = make_small_scene();
    only_sky.emitters = {ConstantEmitter{}};
    for (Shape& shape : only_sky.shapes) shape.emitter = {};
    Scene only_directions = only_sky;
    only_directions.emitters = {DirectionalEmitter{}, DirectionalEmitter{{1, 0, 0}, {0, 0, 0}}};
    for (const Scene& scene :
         {make_lamps(), black, no_sky, only_sky, make_beams(), only_directions}) {
        const TracedScene traced = prepare(scene, GetParam());
        for (const Vec3f& position : positions(scene)) {
            double sum = 0;
            for (std::size_t e = 0; e < scene.emitters.size(); ++e) {
                const double p = probability(traced.lights->selector, position, e);
                EXPECT_TRUE(p >= 0 && p <= 1) << p;
                sum += p;
            }
            EXPECT_NEAR(sum, 1, 1e-6);
        }
    }
}

TEST_P(Selection, EveryLampHasAChanceEverywhere) {
    const Scene scene = make_beams();
    const TracedScene traced = prepare(scene, GetParam());
    for (const Vec3f& position : positions(scene))
        for (std::size_t e = 0; e < scene.emitters.size(); ++e)
            EXPECT_GT(probability(traced.lights->selector, position, e), 0);
}

/// And sixteen choices at a time are those of one at a time, bit by bit.
void expect_stated_probabilities(const Scene& scene, LightSelection selection) {
    const TracedScene traced = prepare(scene, selection);
    const LightSelector& selector = traced.lights->selector;
    RandomSource random{16002};
    for (int i = 0; i < 500; ++i) {
        Vec3<Packet> packet;
        std::array<Packet, 4> u_packet;
        std::array<SelectedEmitter, kLanes> one;
        for (int k = 0; k < kLanes; ++k) {
            const Vec3f p = random_position(random);
            const std::array<float, 4> u = four(random);
            set(packet.x, k, p.x), set(packet.y, k, p.y), set(packet.z, k, p.z);
            for (std::size_t j = 0; j < 4; ++j) set(u_packet[j], k, u[j]);
            const SelectedEmitter s = one[static_cast<std::size_t>(k)] =
                select_emitter(selector, p, u);
            ASSERT_LT(s.emitter, scene.emitters.size());
            EXPECT_TRUE(s.rest >= 0 && s.rest < 1) << s.rest;
            EXPECT_EQ(s.inverse_probability, inverse_probability(selector, p, s.emitter));
            if (static_cast<std::int32_t>(s.emitter) == traced.lights->infinite.value) {
                EXPECT_FLOAT_EQ(s.inverse_probability,
                                inverse_probability_at_infinity(selector, p));
            }
        }
        const auto many = select_emitters(selector, packet, u_packet);
        const Packet infinite = inverse_probability_at_infinity(selector, packet);
        for (std::size_t k = 0; k < kLanes; ++k) {
            EXPECT_EQ(many[k].emitter, one[k].emitter);
            EXPECT_EQ(many[k].inverse_probability, one[k].inverse_probability);
            EXPECT_EQ(many[k].rest, one[k].rest);
            const int lane = static_cast<int>(k);
            EXPECT_EQ(get(infinite, lane),
                      inverse_probability_at_infinity(
                          selector,
                          Vec3f{get(packet.x, lane), get(packet.y, lane), get(packet.z, lane)}));
        }
    }
}

TEST_P(Selection, StatesTheProbabilityOfItsChoice) {
    expect_stated_probabilities(make_lamps(), GetParam());
    expect_stated_probabilities(make_beams(), GetParam());
}

/// Evenly spaced numbers: no chance is involved, and what is left of them is evenly spaced again.
TEST_P(Selection, TakesItsShareOfTheUniformNumbers) {
    constexpr int kCount = 1 << 16;
    const Scene scene = make_beams();
    const TracedScene traced = prepare(scene, GetParam());
    RandomSource random{16003};
    for (int i = 0; i < 8; ++i) {
        const Vec3f position = random_position(random);
        std::vector<double> count(scene.emitters.size()), rest(scene.emitters.size());
        for (int k = 0; k < kCount; ++k) {
            const std::uint32_t candidates = candidates_of(traced.lights->selector);
            const double scaled = (k + 0.5) / kCount * candidates;
            const auto candidate = static_cast<std::uint32_t>(scaled);
            const auto s =
                select_emitter(traced.lights->selector, position,
                               {static_cast<float>(scaled - candidate), 0, 0, 0}, candidate);
            ++count[s.emitter], rest[s.emitter] += double{s.rest};
        }
        for (std::size_t e = 0; e < count.size(); ++e) {
            const double p = probability(traced.lights->selector, position, e);
            EXPECT_NEAR(count[e], p * kCount, static_cast<double>(count.size()));
            if (count[e] > 1000) {
                EXPECT_NEAR(rest[e] / count[e], 0.5, 0.02);
            }
        }
    }
}

/// p-value of "emitters are chosen as often as `stated` states".
double choices_p_value(const LightSelector& drawn, const LightSelector& stated,
                       std::uint32_t offset) {
    std::vector<double> p;
    RandomSource random{seed_of(kSelectionChoices, offset)};
    const int direct_samples = scaled(kSelectionChoices, 100000);
    for (int i = 0; i < 4; ++i) {
        const Vec3f position = random_position(random);
        std::vector<double> count(drawn.emitters), expected(drawn.emitters);
        for (int k = 0; k < direct_samples; ++k) {
            const auto candidate = static_cast<std::uint32_t>(
                random.next() * static_cast<float>(candidates_of(drawn)));
            ++count[select_emitter(drawn, position, four(random), candidate).emitter];
        }
        for (std::size_t e = 0; e < count.size(); ++e)
            expected[e] = direct_samples * probability(stated, position, e);
        p.push_back(goodness_of_fit_p_value(count, expected));
    }
    return holm_minimum(p);
}

/// The share of samples that bring light from an area or from infinity, and the integral of the
/// density that is stated of directions: p-value of "they are equal".
double integral_p_value(const TracedScene& drawn, const TracedScene& stated, std::uint32_t offset) {
    RandomSource random{seed_of(kSelectionChoices, offset)};
    const int direct_samples = scaled(kSelectionChoices, 1000000);
    const Vec3f origin{0.1f, 0.2f, 0.5f};
    RunningMean found, integral;
    for (int i = 0; i < direct_samples; ++i) {
        const auto infinity = std::numeric_limits<float>::infinity();
        const auto u = four(random);
        int lit = 0;
        for (std::uint32_t c = 0; c < candidates_of(drawn.lights->selector); ++c) {
            const LightSample s = sample_light(*drawn.lights, origin, u, c);
            lit += !s.delta && s.pdf > 0 && !is_black(s.radiance) &&
                   !is_occluded(drawn.geometry->accel, origin, s.direction_world,
                                s.distance < infinity ? s.distance * 0.999f : infinity);
        }
        found.add(lit);
        const Vec3f d = uniform_direction(random.next(), random.next());
        integral.add(double{emission_along(stated, origin, d).pdf} * 4 * std::numbers::pi);
    }
    return welch_p_value(estimate_of(found), estimate_of(integral));
}

TEST_P(Selection, FollowsTheProbabilityThatItStates) {
    const Scene scene = make_lamps();
    const TracedScene traced = prepare(scene, GetParam());
    const auto offset = 10 * static_cast<std::uint32_t>(GetParam());
    const std::string name = name_of(GetParam());
    EXPECT_TRUE(
        accepted(kSelectionChoices, name + ", choices",
                 choices_p_value(traced.lights->selector, traced.lights->selector, offset)));
    EXPECT_TRUE(accepted(kSelectionChoices, name + ", integral",
                         integral_p_value(traced, traced, offset + 1)));
    if (GetParam() == LightSelection::kUniform) return;
    const TracedScene uniform = prepare(scene, LightSelection::kUniform);
    EXPECT_TRUE(
        rejected(kSelectionChoices, "frequencies of the uniform choice",
                 choices_p_value(traced.lights->selector, uniform.lights->selector, offset + 2)));
    EXPECT_TRUE(rejected(kSelectionChoices, "density of the uniform choice",
                         integral_p_value(traced, uniform, offset + 3)));
}

INSTANTIATE_TEST_SUITE_P(Ways, Selection, testing::ValuesIn(kSelections),
                         [](const auto& test) { return name_of(test.param); });

// ---- Resampling

/// Probabilities add up to one, none is below its share of the uniform choices, and numbers are
/// shared out as stated. Without a candidate that shines all are alike.
TEST(LightResampling, ChoosesByWeight) {
    constexpr int kCount = 1 << 16;
    const std::vector<float> weights{0.5f, 0, 3, 1.5f}, none(4);
    for (const auto& [own, expected] : {std::pair{weights, std::array{0.115, 0.025, 0.565, 0.295}},
                                        std::pair{none, std::array{0.25, 0.25, 0.25, 0.25}}}) {
        std::array<double, 4> count{}, stated{};
        for (int k = 0; k < kCount; ++k) {
            const auto choice = choose_candidate(own, (static_cast<float>(k) + 0.5f) / kCount);
            ++count[choice.candidate];
            stated[choice.candidate] = 1 / double{choice.inverse_probability};
        }
        for (std::size_t c = 0; c < 4; ++c) {
            EXPECT_NEAR(stated[c], expected[c], 1e-6);
            EXPECT_NEAR(count[c], expected[c] * kCount, 2);
        }
    }
    EXPECT_EQ(choose_candidate(weights, 0x1.fffffep-1f).candidate, 3u);
    const std::vector<float> huge(4, 3e38f);
    EXPECT_EQ(choose_candidate(huge, 0.5f).inverse_probability, 4) << "their sum is infinite";
}

// ---- Large trees

TEST(LightTree, OfManyEmittersIsShallow) {
    constexpr std::size_t kCount = 200000;
    RandomSource random{16004};
    std::vector<LightBounds> bounds(kCount);
    std::vector<std::uint32_t> emitter(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
        // Each thousandfold nearer the origin than the last, and many at one place.
        const float scale = i % 3 ? std::pow(10.0f, -random.next(0, 12)) : 0.0f;
        const Vec3f p = Vec3f{random.next(), random.next(), random.next()} * scale;
        bounds[i] = {{p, p}, {0, 0, 1}, -1, random.next()};
        emitter[i] = static_cast<std::uint32_t>(i);
    }
    const LightTree tree = build_light_tree(bounds, emitter, kCount);
    EXPECT_EQ(tree.splits.size(), kCount - 1);
    double sum = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
        const double p = interval_in_tree(tree, {0.1f, 0.2f, 0.3f}, emitter[i], {}).width;
        EXPECT_GT(p, 0);
        sum += p;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
}

// ---- Images

/// Mean radiance of pixels, batch by batch: samples of emitters under one selection, and of BSDFs
/// under another.
std::vector<RunningMean> pixels(const Scene& scene, LightSelection emitters, LightSelection bsdfs,
                                std::uint32_t offset) {
    const TextureTable textures{scene.textures, {}};
    constexpr std::uint32_t kPixels = 256;
    const std::uint32_t batches = scaled(kSelectionImages, 3000u);
    std::vector<RunningMean> means(kPixels);
    std::vector<BatchSample> samples(kPixels);
    std::vector<Rgbf> radiance(kPixels);
    std::vector<std::vector<double>> sum(batches, std::vector<double>(kPixels));
    for (const bool emitter : {true, false}) {
        const TracedScene traced = prepare(scene, emitter ? emitters : bsdfs);
        const TraceInput input{
            &traced, &textures,           {seed_of(kSelectionImages, offset), Stream::kTest},
            1,       SurfaceChoice::kAll, {}};
        for (std::uint32_t b = 0; b < batches; ++b) {
            for (std::uint32_t i = 0; i < kPixels; ++i) samples[i] = {{i, b, 0}, emitter, !emitter};
            EXPECT_EQ(trace_radiance(input, samples, radiance), 0u);
            for (std::size_t i = 0; i < kPixels; ++i) sum[b][i] += double{luminance(radiance[i])};
        }
    }
    for (const auto& batch : sum)
        for (std::size_t i = 0; i < kPixels; ++i) means[i].add(batch[i]);
    return means;
}

double images_p_value(const std::vector<RunningMean>& a, const std::vector<RunningMean>& b) {
    std::vector<double> p;
    for (std::size_t i = 0; i < a.size(); ++i)
        p.push_back(welch_p_value(estimate_of(a[i]), estimate_of(b[i])));
    return holm_minimum(p);
}

TEST(SelectionImages, AreTheSame) {
    Scene scene = make_lamps();
    scene.hide_emitters = true;  // only what is lit
    const auto uniform = LightSelection::kUniform;
    const auto expected = pixels(scene, uniform, uniform, 0);
    for (const auto selection :
         {LightSelection::kPower, LightSelection::kTree, LightSelection::kResampled}) {
        const auto number = static_cast<std::uint32_t>(selection);
        const std::uint32_t offset = number < 3 ? number : number + 1;
        EXPECT_TRUE(
            accepted(kSelectionImages, name_of(selection),
                     images_p_value(pixels(scene, selection, selection, offset), expected)));
    }
    Scene few = make_small_scene();
    few.hide_emitters = true;
    const auto resampled = LightSelection::kResampled;
    EXPECT_TRUE(accepted(
        kSelectionImages, "a candidate of each light",
        images_p_value(pixels(few, resampled, resampled, 5), pixels(few, uniform, uniform, 6))));
    Scene room = make_room();
    room.hide_emitters = true;
    add_lamp(room, make_quad({0.9f, 0.2f, 0.8f}, {0, 0, 0.4f}, {0, 0.4f, 0}), {6, 7, 9});
    EXPECT_TRUE(accepted(
        kSelectionImages, "where light bounces",
        images_p_value(pixels(room, resampled, resampled, 7), pixels(room, uniform, uniform, 8))));
    EXPECT_TRUE(
        rejected(kSelectionImages, "density of the uniform choice for BSDF samples",
                 images_p_value(pixels(scene, LightSelection::kTree, uniform, 3), expected)));
}

}  // namespace
}  // namespace burnish::test
