// Nanoseconds of the leaf maths and of the small stages that run per record.
#include <benchmark/benchmark.h>

#include <random>

#include "core/dual.h"
#include "core/packet.h"
#include "core/random.h"
#include "core/sobol.h"
#include "gradient/reservoirs/merge.h"
#include "shading/environment.h"
#include "shading/principled.h"
#include "shading/texture.h"

using namespace burnish;

namespace {

constexpr std::size_t kConfigurations = 1024;

struct Directions {
    std::vector<Vec3f> wi, wo;
};

Directions random_directions() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> u(0, 1);
    const auto direction = [&] { return square_to_cosine_hemisphere(Vec2f{u(random), u(random)}); };
    Directions d;
    for (std::size_t i = 0; i < kConfigurations; ++i)
        d.wi.push_back(direction()), d.wo.push_back(direction());
    return d;
}

template <class C, class S = C, class W = C>
PrincipledParameters<C, S, W> usual_parameters() {
    PrincipledParameters<C, S, W> p;
    p.base_color = {C(0.8f), C(0.5f), C(0.3f)};
    p.roughness = S(0.4f), p.metallic = W(0.6f), p.anisotropic = S(0.3f);
    p.has_spec_trans = p.has_clearcoat = p.has_sheen = p.has_flatness = p.has_spec_tint = false;
    return p;
}

void eval_principled_float(benchmark::State& state) {
    const Directions d = random_directions();
    const auto p = usual_parameters<float>();
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % kConfigurations;
        benchmark::DoNotOptimize(eval_principled(p, d.wi[i], d.wo[i]));
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(eval_principled_float);

template <int N>
void eval_principled_dual(benchmark::State& state) {
    using T = Dual<float, N>;
    const Directions d = random_directions();
    auto p = usual_parameters<T>();
    p.roughness.d[0] = 1;
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % kConfigurations;
        benchmark::DoNotOptimize(eval_principled(p, d.wi[i], d.wo[i]));
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(eval_principled_dual<1>);
BENCHMARK(eval_principled_dual<4>);

Vec3<Packet> gather(const std::vector<Vec3f>& v, std::size_t first) {
    Vec3<Packet> p;
    for (int k = 0; k < kLanes; ++k) {
        const Vec3f& d = v[first + static_cast<std::size_t>(k)];
        set(p.x, k, d.x), set(p.y, k, d.y), set(p.z, k, d.z);
    }
    return p;
}

/// Per lane: compare with eval_principled_float. S: Packet, or a dual number for the derivative by
/// the roughness. In one function, as in render/shade.cpp.
template <class S>
[[gnu::flatten]] void eval_principled_packet(benchmark::State& state) {
    const Directions d = random_directions();
    auto p = usual_parameters<Packet, S, Packet>();
    if constexpr (!std::is_same_v<S, Packet>) p.roughness.d[0] = Packet(1.0f);
    std::vector<Vec3<Packet>> wi, wo;
    for (std::size_t i = 0; i < kConfigurations; i += kLanes)
        wi.push_back(gather(d.wi, i)), wo.push_back(gather(d.wo, i));
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % wi.size();
        benchmark::DoNotOptimize(eval_principled(p, wi[i], wo[i]));
    }
    state.SetItemsProcessed(state.iterations() * kLanes);
}
BENCHMARK(eval_principled_packet<Packet>);
BENCHMARK(eval_principled_packet<Dual<Packet, 1>>);

void sample_principled_packet(benchmark::State& state) {
    const Directions d = random_directions();
    const auto p = usual_parameters<Packet>();
    const Vec3<Packet> wi = gather(d.wi, 0), u = gather(d.wo, 0);
    const Vec2<Packet> square{abs(u.x), abs(u.y)};
    for (auto _ : state) {
        const auto sample = sample_principled(p, wi, square, abs(u.z));
        benchmark::DoNotOptimize(sample);
        benchmark::DoNotOptimize(pdf_principled(p, wi, sample.wo_local));
    }
    state.SetItemsProcessed(state.iterations() * kLanes);
}
BENCHMARK(sample_principled_packet);

void texture_lookup(benchmark::State& state) {
    Bitmap bitmap;
    bitmap.width = bitmap.height = 2048, bitmap.channels = 1;
    bitmap.values.resize(std::size_t{2048} * 2048, 0.5f);
    bitmap.filter = state.range(0) ? TextureFilter::kBilinear : TextureFilter::kNearest;
    const Directions d = random_directions();
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % kConfigurations;
        benchmark::DoNotOptimize(eval_bitmap(bitmap, nullptr, {d.wi[i].x, d.wi[i].y}));
    }
}
BENCHMARK(texture_lookup)->Arg(0)->Arg(1);

void environment_sample(benchmark::State& state) {
    EnvironmentEmitter emitter;
    emitter.image = share(make_image(1024, 512, 3, 1.0f));
    const EnvironmentTable table = make_environment_table(emitter);
    std::uint32_t i = 0;
    for (auto _ : state)
        benchmark::DoNotOptimize(
            sample_environment(table, uniforms({1, Stream::kTest}, i++, 0, 0)));
}
BENCHMARK(environment_sample);

/// 0, 1, ...
LaneIntegers counted_lanes() {
    LaneIntegers n;
    for (int k = 0; k < kLanes; ++k) set(n, k, static_cast<std::uint32_t>(k));
    return n;
}

/// Time of sixteen.
void environment_sample_packet(benchmark::State& state) {
    EnvironmentEmitter emitter;
    emitter.image = share(make_image(1024, 512, 3, 1.0f));
    const EnvironmentTable table = make_environment_table(emitter);
    LaneIntegers i = counted_lanes();
    for (auto _ : state) {
        i += kLanes;
        benchmark::DoNotOptimize(sample_environment(
            table, uniforms({1, Stream::kTest}, i, LaneIntegers{}, LaneIntegers{})));
    }
}
BENCHMARK(environment_sample_packet);

void philox(benchmark::State& state) {
    std::uint32_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(uniforms({1, Stream::kTest}, i++, 0, 0));
}
BENCHMARK(philox);

/// Time of sixteen.
void philox_packet(benchmark::State& state) {
    LaneIntegers i = counted_lanes();
    for (auto _ : state) {
        i += kLanes;
        benchmark::DoNotOptimize(uniforms({1, Stream::kTest}, i, LaneIntegers{}, LaneIntegers{}));
    }
}
BENCHMARK(philox_packet);

/// Time of sixteen, of passes below 1000; the argument: the block.
void sobol_packet(benchmark::State& state) {
    const auto block = static_cast<std::uint32_t>(state.range(0));
    LaneIntegers i = counted_lanes();
    for (auto _ : state) {
        i += kLanes;
        benchmark::DoNotOptimize(sobol_uniforms({1, Stream::kTest}, i, i % 1000, block));
    }
}
BENCHMARK(sobol_packet)->Arg(0)->Arg(2);

void merge_reservoirs(benchmark::State& state) {
    const std::array<MergeInput<std::uint32_t>, 4> inputs{
        {{0, 0.5f, 0.4f, 1}, {1, -0.2f, -0.3f, 1}, {2, 0.1f, 0.2f, 3}, {3, 0.2f, -0.1f, 2}}};
    const std::array<float, 4> u{0.1f, 0.7f, 0.3f, 0.9f};
    const std::span<const MergeInput<std::uint32_t>> all(inputs);
    for (auto _ : state)
        benchmark::DoNotOptimize(merge(all.first(2), all.subspan(2), {1, 16}, Signs::kPositivized,
                                       BalanceWeights{}, std::span<const float>(u)));
}
BENCHMARK(merge_reservoirs);

}  // namespace
