#include "render/shade.h"

#include <utility>

#include "core/dual.h"
#include "shading/bsdf.h"

namespace burnish {

namespace {

using InputValues = BsdfInputs<Packet>;

/// Calls f with the indices of all inputs as template arguments, which keeps arrays of packets out
/// of memory.
template <class F>
auto with_inputs(const F& f) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
        return f.template operator()<I...>();
    }
    (std::make_index_sequence<kBsdfInputs>());
}

InputValues input_values(const RecordShader& shader, const LaneValues* constant_inputs,
                         const LaneValues* unknown_inputs) {
    InputValues values = with_inputs([&]<std::size_t... I>() {
        return InputValues{Packet(shader.constants[I])...};
    });
    for (const int input : shader.constant_inputs)
        values[static_cast<std::size_t>(input)] = load((constant_inputs++)->data());
    for (const int input : shader.unknown_inputs)
        values[static_cast<std::size_t>(input)] = load((unknown_inputs++)->data());
    return values;
}

/// The derivative of an input by a seed: 1 or 0.
float seeded(std::span<const int> seeds, std::size_t k, std::size_t input) {
    if (k >= seeds.size()) return 0;
    return seeds[k] == static_cast<int>(input) ||
           seeds[k] == RecordShader::kAllChannels - static_cast<int>(input / 3);
}

/// An input with its derivatives by N seeds.
template <int N>
Dual<Packet, N> seeded(const Packet& value, std::span<const int> seeds, std::size_t input) {
    Dual<Packet, N> v(value);
    for (std::size_t k = 0; k < N; ++k) v.d[k] = Packet(seeded(seeds, k, input));
    return v;
}

/// All inputs with their derivatives by N seeds.
template <int N>
BsdfInputs<Dual<Packet, N>> seeded(const InputValues& values, std::span<const int> seeds) {
    return with_inputs([&]<std::size_t... I>() {
        return BsdfInputs<Dual<Packet, N>>{seeded<N>(values[I], seeds, I)...};
    });
}

/// The value, and its derivatives by N seeds at once, which belong to inputs whose type (see
/// principled.h) is a Dual. One function, so that neither packets nor branches on the lobes that
/// the material does not have cost a detour through memory.
template <int N, class C, class S, class W>
[[gnu::flatten]] Rgb<Packet> shade_group(const Principled& bsdf, const InputValues& values,
                                         std::span<const int> seeds, const RecordBlock& block,
                                         LaneValues* derivatives) {
    const RecordPacket r = unpack_records(block);
    const auto f = eval_principled(principled_parameters<C, S, W>(bsdf, seeded<N>(values, seeds)),
                                   r.wi_local, r.wo_local);
    for (std::size_t k = 0; k < seeds.size(); ++k)
        store(derivatives + 3 * k, Rgb<Packet>{f.x.d[k], f.y.d[k], f.z.d[k]} * r.radiance_over_pdf);
    return Rgb<Packet>{f.x.v, f.y.v, f.z.v} * r.radiance_over_pdf;
}

/// The value alone.
[[gnu::flatten]] Rgb<Packet> shade_value(const Principled& bsdf, const InputValues& values,
                                         const RecordBlock& block) {
    const RecordPacket r = unpack_records(block);
    const auto p = principled_parameters<Packet, Packet, Packet>(bsdf, values);
    return eval_principled(p, r.wi_local, r.wo_local) * r.radiance_over_pdf;
}

Rgb<Packet> shade_kind(const Diffuse&, const RecordShader& shader, const InputValues& v,
                       const RecordBlock& block, LaneValues* derivatives) {
    const RecordPacket r = unpack_records(block);
    const Packet one(1.0f);  // linear in the reflectance
    const Rgb<Packet> white =
        eval_diffuse(DiffuseParameters<Packet>{{one, one, one}}, r.wi_local, r.wo_local) *
        r.radiance_over_pdf;
    if (!shader.seeds.empty()) store(derivatives, white);
    return white * Rgb<Packet>{v[0], v[1], v[2]};
}

/// One unknown input has a variant of its own; more are carried three at a time.
Rgb<Packet> shade_kind(const Principled& bsdf, const RecordShader& shader,
                       const InputValues& values, const RecordBlock& block,
                       LaneValues* derivatives) {
    using P = Packet;
    using D1 = Dual<Packet, 1>;
    using D3 = Dual<Packet, 3>;
    const std::span<const int> seeds(shader.seeds);
    switch (shader.kind) {
        case RecordShader::Seeds::kNone:
            return shade_value(bsdf, values, block);
        case RecordShader::Seeds::kColor:
            return shade_group<1, D1, P, P>(bsdf, values, seeds, block, derivatives);
        case RecordShader::Seeds::kShape:
            return shade_group<1, P, D1, P>(bsdf, values, seeds, block, derivatives);
        case RecordShader::Seeds::kWeight:
            return shade_group<1, P, P, D1>(bsdf, values, seeds, block, derivatives);
        case RecordShader::Seeds::kSeveral:
            break;
    }
    Rgb<Packet> value;
    for (std::size_t first = 0; first < seeds.size(); first += 3)
        value = shade_group<3, D3, D3, D3>(
            bsdf, values, seeds.subspan(first, std::min<std::size_t>(3, seeds.size() - first)),
            block, derivatives + 3 * first);
    return value;
}

/// Any other kind: the derivatives three at a time.
template <class Kind>
[[gnu::flatten]] Rgb<Packet> shade_kind(const Kind& bsdf, const RecordShader& shader,
                                        const InputValues& values, const RecordBlock& block,
                                        LaneValues* derivatives) {
    const RecordPacket r = unpack_records(block);
    const std::span<const int> seeds(shader.seeds);
    if (seeds.empty())
        return eval_bsdf(bsdf_parameters(bsdf, values), r.wi_local, r.wo_local) *
               r.radiance_over_pdf;
    Rgb<Packet> value;
    for (std::size_t first = 0; first < seeds.size(); first += 3) {
        const auto some = seeds.subspan(first, std::min<std::size_t>(3, seeds.size() - first));
        const auto f =
            eval_bsdf(bsdf_parameters(bsdf, seeded<3>(values, some)), r.wi_local, r.wo_local);
        for (std::size_t k = 0; k < some.size(); ++k)
            store(derivatives + 3 * (first + k),
                  Rgb<Packet>{f.x.d[k], f.y.d[k], f.z.d[k]} * r.radiance_over_pdf);
        value = Rgb<Packet>{f.x.v, f.y.v, f.z.v} * r.radiance_over_pdf;
    }
    return value;
}

Rgb<Packet> shade_bsdf(const RecordShader& shader, const RecordBlock& block,
                       const LaneValues* constant_inputs, const LaneValues* unknown_inputs,
                       LaneValues* derivatives) {
    const InputValues values = input_values(shader, constant_inputs, unknown_inputs);
    return std::visit(
        [&](const auto& bsdf) { return shade_kind(bsdf, shader, values, block, derivatives); },
        *shader.bsdf);
}

/// Multiplies a BSDF's value and derivatives with its shares, and adds the derivatives by these.
/// weights: one for each share.
Rgb<Packet> share_out(const RecordShader& shader, const Rgb<Packet>& value,
                      const LaneValues* weights, LaneValues* derivatives) {
    const Packet one(1.0f);
    const auto share_at = [&](std::size_t k) {
        const Packet w = load(weights[k].data());
        return shader.shares[k].second ? w : one - w;
    };
    const std::size_t count = shader.shares.size();
    /// Of all shares but one.
    const auto others = [&](std::size_t left_out) {
        Packet product = one;
        for (std::size_t k = 0; k < count; ++k)
            if (k != left_out) product = product * share_at(k);
        return product;
    };
    const Packet all = others(count);
    if (shader.has_derivatives) {
        for (std::size_t k = 0; k < shader.seeds.size(); ++k, derivatives += 3)
            store(derivatives, load(derivatives) * all);
        for (std::size_t k = 0; k < count; ++k, derivatives += 3)
            store(derivatives,
                  value * (shader.shares[k].second ? others(k) : Packet(0.0f) - others(k)));
    }
    return value * all;
}

/// The values of some inputs in a block, one after the other, to `out`. The channels of a colour
/// follow one another.
template <class Block>
void look_up(const RecordShader& shader, std::span<const int> inputs, const Block& block,
             LaneValues* out) {
    const Vec2<Packet> uv{load(block.u.data()), load(block.v.data())};
    for (std::size_t i = 0; i < inputs.size();) {
        if (const ColorInput* color = color_at(*shader.bsdf, inputs[i])) {
            store(out + i, eval_color(*shader.textures, *color, uv));
            i += 3;
        } else {
            const ScalarInput& scalar = *scalar_at(*shader.bsdf, inputs[i]);
            store(out[i].data(), eval_scalar(*shader.textures, scalar, uv));
            ++i;
        }
    }
}

/// What look_up gives of consecutive blocks, to `out`.
template <class Block>
void look_up_all(const RecordShader& shader, std::span<const int> inputs,
                 std::span<const Block> blocks, LaneValues* out) {
    for (const Block& block : blocks) {
        look_up(shader, inputs, block, out);
        out += inputs.size();
    }
}

template <class Block>
void look_up_unknown_of(const RecordShader& shader, std::span<const Block> blocks,
                        std::vector<LaneValues>& values) {
    values.resize(shader.unknown_values() * blocks.size());
    if (shader.shares.empty())
        return look_up_all(shader, shader.unknown_inputs, blocks, values.data());
    LaneValues* out = values.data();
    for (const Block& block : blocks) {
        look_up(shader, shader.unknown_inputs, block, out);
        out += shader.unknown_inputs.size();
        const Vec2<Packet> uv{load(block.u.data()), load(block.v.data())};
        for (const BlendShare& share : shader.shares)
            store((out++)->data(), eval_scalar(*shader.textures, {0, share.weight}, uv));
    }
}

}  // namespace

RecordMemory make_record_memory(std::span<const RecordShader> shaders, const TileRecords& records) {
    const auto shader_of = [&](const RecordRun& run) -> const RecordShader& {
        return shaders[static_cast<std::size_t>(run.bsdf.value)];
    };
    std::size_t constant_inputs = 0, derivatives = 0;
    for (const RecordRun& run : records.runs) {
        constant_inputs += shader_of(run).constant_inputs.size() * (run.end - run.begin);
        derivatives += 3 * shader_of(run).derivatives() * (run.end - run.begin);
    }
    RecordMemory memory;
    memory.constant_inputs.resize(constant_inputs);
    memory.derivatives.resize(derivatives);
    LaneValues* out = memory.constant_inputs.data();
    for (const RecordRun& run : records.runs) {
        const RecordShader& shader = shader_of(run);
        if (records.vertices.empty())
            look_up_all(shader, shader.constant_inputs, blocks_of(run, records), out);
        else
            look_up_all(shader, shader.constant_inputs, vertices_of(run, records), out);
        out += shader.constant_inputs.size() * (run.end - run.begin);
    }
    return memory;
}

void look_up_unknown(const RecordShader& shader, std::span<const RecordBlock> blocks,
                     std::vector<LaneValues>& values) {
    look_up_unknown_of(shader, blocks, values);
}

void look_up_unknown(const RecordShader& shader, std::span<const VertexBlock> blocks,
                     std::vector<LaneValues>& values) {
    look_up_unknown_of(shader, blocks, values);
}

Rgb<Packet> shade(const RecordShader& shader, const RecordBlock& block,
                  const LaneValues* constant_inputs, const LaneValues* unknown_inputs,
                  LaneValues* derivatives) {
    if (shader.shares.empty())
        return shade_bsdf(shader, block, constant_inputs, unknown_inputs, derivatives);
    const Rgb<Packet> value = shader.is_within_light ? load(block.radiance_over_pdf.data())
                                                     : shade_bsdf(shader, block, constant_inputs,
                                                                  unknown_inputs, derivatives);
    return share_out(shader, value, unknown_inputs + shader.unknown_inputs.size(), derivatives);
}

}  // namespace burnish
