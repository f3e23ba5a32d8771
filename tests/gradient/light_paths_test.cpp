// Paths to one light each, which reservoirs keep where light bounces: against the samples that they
// stand for, against finite differences, and against paths that are traced again.
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "gradient/candidates.h"
#include "gradient/estimators.h"
#include "gradient/room.h"
#include "random_source.h"

namespace burnish {
namespace {

using test::one_of_each_pixel;

/// The room under its own textures, moved by numbers of so much: 0: not at all.
struct RoomOfPaths {
    Scene scene = test::make_room();
    TracedScene traced = prepare(scene);
    Theta theta = test::theta_of(scene);
    Binding binding{traced, theta};

    RoomOfPaths() = default;
    Theta moved(std::uint32_t seed, float max) const {
        test::RandomSource random{seed};
        Theta theta_moved = theta;
        for (ThetaTexture& t : theta_moved.textures)
            for (float& v : t.values.values) v += random.next(-max, max);
        return theta_moved;
    }
};

constexpr RandomKey kKey{7, Stream::kTest};
constexpr std::uint32_t kPasses = 16;

/// Weights, filter taps and what differentiation reads.
struct Adjoint {
    Image weights;
    PassTaps taps;

    explicit Adjoint(const Scene& scene)
        : weights(normalized_adjoint(test::make_adjoint(scene, 71, true),
                                     film_normalization(scene.film))),
          taps(pass_taps(scene.film.filter, kKey, 0, kPasses)) {}
    DerivativeInput input(const Binding& binding, TargetFunction target) const {
        return {&binding, &weights, &taps, target};
    }
};

TracedPaths trace_kept(const RoomOfPaths& room) {
    std::vector<BatchSample> samples;
    for (std::uint32_t pass = 0; pass < kPasses; ++pass)
        for (const BatchSample& s : one_of_each_pixel(room.scene, pass)) samples.push_back(s);
    return trace_paths(unknown_derivatives(room.binding, kKey, 1), samples, &room.binding);
}

using Name = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t, Technique>;
Name name_of(const PathSample& p) {
    return {p.camera.iteration, p.camera.pixel, p.vertex, p.technique};
}

double sum(const Rgbf& v) { return double{v.x} + double{v.y} + double{v.z}; }

TEST(LightPaths, BringTheLightOfTheSamplesThatTheyStandFor) {
    const RoomOfPaths room;
    const TracedPaths kept = trace_kept(room);
    std::map<Name, Rgbf> all;  // of samples that hold the rest of their path
    for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
        const auto traced = trace_paths(unknown_derivatives(room.binding, kKey, 1),
                                        one_of_each_pixel(room.scene, pass));
        for (const TracedPath& p : traced.paths) all[name_of(p.path)] = p.record.radiance_over_pdf;
    }
    EXPECT_EQ(kept.rejected, 0u);
    ASSERT_EQ(kept.paths.size(), all.size());
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < kept.paths.size(); ++i) {
        const TracedPath& p = kept.paths[i];
        const ChainPlace& place = kept.places[i];
        const Rgbf light = p.record.radiance_over_pdf * scattered_by_others(kept.chains, place);
        const auto found = all.find(name_of(p.path));
        ASSERT_NE(found, all.end());
        // One that is chosen in proportion to a sum stands for it with that sum.
        EXPECT_NEAR(sum(light), sum(found->second), 2e-5 * sum(found->second));
        if (p.path.technique == Technique::kEmitter) {
            EXPECT_EQ(place.last, place.vertex);
            EXPECT_LE(double{length(light - found->second)}, 2e-5 * sum(found->second));
        }
        beyond += place.last > place.vertex + 1;
    }
    EXPECT_GT(beyond, 50u) << "paths that end beyond the next vertex";
}

/// Three vertices that light reaches whose channels are negative on the whole, in part, or cancel.
ChainOutput chain_in_negative_light() {
    ChainVertex v;
    v.f_light = v.f_next = {0.5f, 0.6f, 0.7f};
    v.onward = {1, 1, 1};
    ChainOutput out;
    out.chains = {{0, 0, 3}};
    out.vertices = {v, v, v};
    out.vertices[0].gathered = {1, 1, 1}, out.vertices[1].gathered = {1, -1, 0};
    out.vertices[1].emitted = {-1, 0.4f, 0}, out.vertices[2].emitted = {0.2f, 0.3f, 0.4f};
    out.vertices[2].gathered = {-0.5f, 0.9f, -0.3f};
    return out;
}

/// Camera samples: the numbers by which they choose behind vertex k lie one in each of so many
/// equal parts of [0, 1).
std::vector<BatchSample> with_all_choices(std::uint32_t k, std::uint32_t parts) {
    std::map<std::uint32_t, BatchSample> by_part;
    for (std::uint32_t pixel = 0; by_part.size() < parts; ++pixel) {
        const float u = uniforms(kKey, pixel, 0, 0, kLightChoiceNumbers | k)[0];
        by_part[static_cast<std::uint32_t>(u * static_cast<float>(parts))] = {{pixel}};
    }
    std::vector<BatchSample> samples;
    for (const auto& [part, sample] : by_part) samples.push_back(sample);
    return samples;
}

TEST(LightPaths, StandForLightWithNegativeChannels) {
    constexpr std::uint32_t kParts = 4096;
    const ChainOutput chains = chain_in_negative_light();
    TraceInput input;
    input.key = kKey;
    const BatchSample any{};
    std::vector<DirectSample> expected;
    append_samples(input, {&any, 1}, chains, expected);
    EXPECT_EQ(expected.size(), 5u);
    for (const DirectSample& e : expected) {
        Rgbf mean;
        double largest = 0;
        for (const BatchSample& sample : with_all_choices(e.vertex, kParts)) {
            std::vector<LightPath> paths;
            append_light_paths(input, {&sample, 1}, chains, paths);
            for (const auto& [index, record, place] : paths) {
                if (place.vertex != e.vertex || record.technique != e.record.technique) continue;
                const Rgbf light =
                    record.radiance_over_pdf * scattered_by_others(chains.vertices, place);
                mean += light * (1.0f / kParts);
                largest = std::max(largest, double{length(light)});
            }
        }
        // Of each of five ends less than two parts more or less than its share.
        const double difference = double{length(mean - e.record.radiance_over_pdf)};
        EXPECT_LE(difference, 2.0 * 5 / kParts * largest) << e.vertex;
    }
}

/// The vertices of a path, its record's among them, and which is which.
std::vector<PathVertex> all_vertices(const TracedPaths& kept, std::size_t i) {
    std::vector<PathVertex> vertices;
    append_others(kept.chains, kept.places[i], vertices);
    const PathRecord& r = kept.paths[i].record;
    vertices.insert(vertices.begin() + kept.paths[i].path.vertex,
                    {r.bsdf, r.uv, r.wi_local, r.wo_local});
    return vertices;
}

TEST(LightPaths, DerivativesAreFiniteDifferences) {
    const RoomOfPaths room;
    const Adjoint adjoint(room.scene);
    const TracedPaths kept = trace_kept(room);
    for (std::size_t moved = 0; moved < room.theta.textures.size(); ++moved) {
        test::RandomSource random{75};
        std::vector<float> direction(room.theta.textures[moved].values.values.size());
        for (float& d : direction) d = random.next(-1, 1);
        const auto moved_by = [&](float step) {
            Theta theta = room.theta;
            for (std::size_t i = 0; i < direction.size(); ++i)
                theta.textures[moved].values.values[i] += step * direction[i];
            return theta;
        };
        constexpr float kStep = 4e-3f;  // differences of fourth order
        const std::array<Theta, 4> thetas{moved_by(kStep), moved_by(-kStep), moved_by(2 * kStep),
                                          moved_by(-2 * kStep)};
        const std::array<Binding, 4> bindings{
            Binding(room.traced, thetas[0]), Binding(room.traced, thetas[1]),
            Binding(room.traced, thetas[2]), Binding(room.traced, thetas[3])};
        constexpr std::array<double, 4> kWeights{8, -8, -1, 1};
        const int channels = room.theta.textures[moved].values.channels;
        double along = 0, difference = 0;
        for (std::size_t i = 0; i < kept.paths.size(); ++i) {
            const std::vector<PathVertex> vertices = all_vertices(kept, i);
            PathRecord record = kept.paths[i].record;
            TexelDerivatives texels;
            for (std::size_t k = 0; k < vertices.size(); ++k) {
                Rgbf others{1, 1, 1};
                for (std::size_t j = 0; j < vertices.size(); ++j)
                    if (j != k) others = others * scattered(room.binding, vertices[j]);
                record.bsdf = vertices[k].bsdf, record.uv = vertices[k].uv;
                record.wi_local = vertices[k].wi_local, record.wo_local = vertices[k].wo_local;
                differentiate(adjoint.input(room.binding, TargetFunction::kIntegrand), record,
                              others, texels);
                for (int t = 0; t < texels.count; ++t) {
                    const TexelDerivative& d = texels.items[static_cast<std::size_t>(t)];
                    if (d.key.slot != moved) continue;
                    for (int c = 0; c < channels; ++c)
                        along += double{d.g[c]} *
                                 double{direction[d.key.texel * static_cast<std::size_t>(channels) +
                                                  static_cast<std::size_t>(c)]};
                }
            }
            for (std::size_t at = 0; at < bindings.size(); ++at) {
                Rgbf value = texels.adjoint * record.radiance_over_pdf;
                for (const PathVertex& v : vertices) value = value * scattered(bindings[at], v);
                difference += kWeights[at] * sum(value) / (12 * double{kStep});
            }
        }
        EXPECT_GT(std::abs(difference), 0.01) << moved;
        EXPECT_NEAR(along, difference, 2e-3 * (0.01 + std::abs(difference))) << moved;
    }
}

/// No history holds such a path: a target above zero would count on it.
TEST(LightPaths, TargetsAreZeroWhereTheOthersLetNoneOfTheLightThrough) {
    const RoomOfPaths room;
    const Adjoint adjoint(room.scene);
    const DerivativeInput input = adjoint.input(room.binding, TargetFunction::kLuminance);
    const TracedPaths kept = trace_kept(room);
    int reached = 0;
    for (const TracedPath& p : kept.paths) {
        PathRecord record = p.record;
        record.radiance_over_pdf = {2, 0, 0};
        TexelDerivatives texels;
        differentiate(input, record, Rgbf{0, 1, 1}, texels);
        EXPECT_EQ(texels.count, 0);
        differentiate(input, record, Rgbf{1, 0, 0}, texels);
        reached += texels.count;
    }
    EXPECT_GT(reached, 100);
}

TEST(LightPaths, TargetsBoundDerivativesWhereChannelsOfLightCancel) {
    const RoomOfPaths room;
    const Adjoint adjoint(room.scene);
    const DerivativeInput input = adjoint.input(room.binding, TargetFunction::kIntegrand);
    const TracedPaths kept = trace_kept(room);
    for (const Rgbf& light : {Rgbf{1, -1, 0}, Rgbf{-1, 0.4f, 0}}) {
        int reached = 0;
        for (const TracedPath& p : kept.paths) {
            PathRecord record = p.record;
            record.radiance_over_pdf = light;
            TexelDerivatives texels;
            differentiate(input, record, Rgbf{1, 1, 1}, texels);
            reached += texels.count;
            for (int t = 0; t < texels.count; ++t) {
                const TexelDerivative& d = texels.items[static_cast<std::size_t>(t)];
                for (int c = 0; c < 3; ++c)
                    EXPECT_LE(std::abs(d.g[c]), 3.0001f * std::abs(d.q)) << light.x;
            }
        }
        EXPECT_GT(reached, 100) << light.x;
    }
}

/// What the balance heuristic compares [PR eq. 13] is a function of the path: whatever densities it
/// was born with, and whichever light of a stretch's random walk.
TEST(LightPaths, TargetsHaveARatioWithoutTheColorOfTheirLight) {
    const RoomOfPaths room;
    const Adjoint adjoint(room.scene);
    const Theta other = room.moved(76, 0.1f);
    const Binding binding(room.traced, other);
    const TracedPaths kept = trace_kept(room);
    std::size_t compared = 0;
    for (const TargetFunction target : {TargetFunction::kLuminance, TargetFunction::kIntegrand})
        for (std::size_t i = 0; i < kept.paths.size(); ++i) {
            std::vector<PathVertex> others;
            append_others(kept.chains, kept.places[i], others);
            const PathRecord& record = kept.paths[i].record;
            PathRecord born_otherwise = record;
            born_otherwise.radiance_over_pdf =
                record.radiance_over_pdf * Rgbf{3, 0.5f, 0} + Rgbf{0.1f, 0, 0};
            const auto q = [&](TargetFunction of, const Binding& under, const PathRecord& r,
                               TexelKey key) {
                return double{differentiate_at(adjoint.input(under, of), r, others, key).q};
            };
            const auto product = [&](TargetFunction of, const PathRecord& r,
                                     const PathRecord& under_other, TexelKey key) {
                return q(of, room.binding, r, key) * q(of, binding, under_other, key);
            };
            TexelDerivatives texels;
            differentiate(adjoint.input(room.binding, target), record,
                          scattered_by_others(kept.chains, kept.places[i]), texels);
            for (int t = 0; t < std::min(texels.count, 2); ++t) {
                const TexelKey key = texels.items[static_cast<std::size_t>(t)].key;
                // Luminances may cancel: rounding is relative to the sum of their magnitudes.
                const double scale =
                    std::abs(product(TargetFunction::kIntegrand, record, born_otherwise, key));
                EXPECT_NEAR(product(target, record, born_otherwise, key),
                            product(target, born_otherwise, record, key), 1e-5 * scale);
                ++compared;
            }
        }
    EXPECT_GT(compared, 1000u);
}

/// One path after the other, traced again under the textures of its birth.
TEST(LightPaths, AreKeptAsTheyWereTraced) {
    const RoomOfPaths room;
    constexpr std::uint32_t kSeed = 11, kIterations = 4;
    std::vector<Theta> script;
    for (std::uint32_t v = 0; v < kIterations; ++v) script.push_back(room.moved(77 + v, 0.05f));
    Reservoirs options = test::by_integrand(test::pgris());
    options.samples = 2;
    const Image adjoint = test::make_adjoint(room.scene, 72, true);
    const Image weights = normalized_adjoint(adjoint, film_normalization(room.scene.film));
    const RandomKey key{kSeed, Stream::kDerivative};
    const PassTaps taps = pass_taps(room.scene.film.filter, key, 0, kIterations * options.samples);
    ReservoirsState state;
    std::size_t old = 0, several = 0;
    for (std::uint32_t v = 0; v < kIterations; ++v) {
        const Binding now(room.traced, script[v]);
        estimate_gradient(options, now, adjoint, kSeed, v, state);
        const History& history = state.history;
        ASSERT_EQ(history.others.ends.size(), history.samples.size());
        ASSERT_EQ(history.others.ends.back(), history.others.vertices.size());
        for (std::size_t i = 0; i < history.samples.size(); ++i) {
            const HistorySample& s = history.samples[i];
            const auto others = vertices_of(history.others, i);
            const Binding birth(room.traced, script[s.path.camera.iteration]);
            const BatchSample sample{s.path.camera};
            const TracedPaths again =
                trace_paths(unknown_derivatives(birth, key, options.samples), {&sample, 1}, &birth);
            const auto found = std::find_if(again.paths.begin(), again.paths.end(),
                                            [&](const TracedPath& p) { return p.path == s.path; });
            ASSERT_NE(found, again.paths.end());
            EXPECT_EQ(found->record, s.record);
            std::vector<PathVertex> expected;
            append_others(again.chains,
                          again.places[static_cast<std::size_t>(found - again.paths.begin())],
                          expected);
            EXPECT_TRUE(std::equal(others.begin(), others.end(), expected.begin(), expected.end()));
            const DerivativeInput input{&now, &weights, &taps, options.target_function};
            EXPECT_FLOAT_EQ(s.q, differentiate_at(input, s.record, others, s.key).q);
            old += s.path.camera.iteration<v, several += others.size()> 1;
        }
    }
    EXPECT_GT(old, 100u);
    EXPECT_GT(several, 50u);
}

TEST(LightPaths, AreNotKeptWhereLightIsDirect) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    ReservoirsState state;
    estimate_gradient(test::by_integrand(test::pgris()), binding,
                      test::make_adjoint(scene, 72, true), 3, 0, state);
    EXPECT_GT(state.history.samples.size(), 0u);
    EXPECT_EQ(state.history.others, PathVertices{});
}

}  // namespace
}  // namespace burnish
