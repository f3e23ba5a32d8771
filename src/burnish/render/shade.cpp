#include "burnish/render/shade.h"

#include "burnish/core/dual.h"
#include "burnish/shading/diffuse.h"
#include "burnish/shading/principled_inputs.h"

namespace burnish {

namespace {

using InputValues = std::array<Packet, kBsdfInputs>;

const ColorInput& color_of(const Bsdf& bsdf) {
    const auto* diffuse = std::get_if<Diffuse>(&bsdf);
    return diffuse ? diffuse->reflectance : std::get<Principled>(bsdf).base_color;
}

const ScalarInput& scalar_of(const Bsdf& bsdf, int input) {
    return std::get<Principled>(bsdf).scalars[static_cast<std::size_t>(input) - kBsdfColor];
}

InputValues input_values(const RecordShader& shader, const LaneValues* fixed,
                         const Vec2<Packet>& uv) {
    InputValues values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = Packet(shader.constants[i]);
    for (std::size_t i = 0; i < shader.fixed.size(); ++i)
        values[static_cast<std::size_t>(shader.fixed[i])] = load(fixed[i].data());
    for (const DynamicInput& d : shader.dynamic) {
        if (d.input > 0) {
            values[static_cast<std::size_t>(d.input)] =
                eval_scalar(*shader.textures, scalar_of(*shader.bsdf, d.input), uv);
        } else {
            const Rgb<Packet> c = eval_color(*shader.textures, color_of(*shader.bsdf), uv);
            values[0] = c.x, values[1] = c.y, values[2] = c.z;
        }
    }
    return values;
}

/// The value, and its derivatives by N seeds at once.
template <int N>
Rgb<Packet> shade_group(const Principled& bsdf, const InputValues& values,
                        std::span<const int> seeds, const RecordPacket& r,
                        LaneValues* derivatives) {
    using T = Dual<Packet, N>;
    std::array<T, kBsdfInputs> v;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = T(values[i]);
    for (std::size_t k = 0; k < seeds.size(); ++k) {
        const Packet one(1.0f);
        if (seeds[k] == RecordShader::kAllChannels)
            for (std::size_t c = 0; c < kBsdfColor; ++c) v[c].d[k] = one;
        else
            v[static_cast<std::size_t>(seeds[k])].d[k] = one;
    }
    const auto f = eval_principled(principled_parameters(bsdf, v), r.wi_local, r.wo_local);
    for (std::size_t k = 0; k < seeds.size(); ++k)
        store(derivatives + 3 * k, Rgb<Packet>{f.x.d[k], f.y.d[k], f.z.d[k]} * r.radiance_over_pdf);
    return Rgb<Packet>{f.x.v, f.y.v, f.z.v} * r.radiance_over_pdf;
}

Rgb<Packet> shade_diffuse(const InputValues& v, const RecordPacket& r, LaneValues* derivatives) {
    const Packet one(1.0f);  // linear in the reflectance
    const Rgb<Packet> white =
        eval_diffuse(DiffuseParameters<Packet>{{one, one, one}}, r.wi_local, r.wo_local) *
        r.radiance_over_pdf;
    store(derivatives, white);
    return white * Rgb<Packet>{v[0], v[1], v[2]};
}

/// Sorts an input into what is constant, fixed and dynamic.
void add_input(const TextureId& texture, int input, std::span<const int> slots,
               RecordShader& shader) {
    if (!texture) return;
    const int slot = slots[static_cast<std::size_t>(texture.value)];
    if (slot < 0) {
        shader.fixed.push_back(input);
        if (input == 0) shader.fixed.insert(shader.fixed.end(), {1, 2});
        return;
    }
    shader.dynamic.push_back({texture, slot, input});
    const auto* principled = std::get_if<Principled>(shader.bsdf);
    shader.mixes_channels = principled && (principled->has_spec_tint || principled->has_sheen);
    if (input > 0)
        shader.seeds.push_back(input);
    else if (shader.mixes_channels)
        shader.seeds.insert(shader.seeds.end(), {0, 1, 2});
    else
        shader.seeds.push_back(RecordShader::kAllChannels);
}

RecordShader make_shader(const Bsdf& bsdf, const TextureTable& textures,
                         std::span<const int> slots) {
    RecordShader shader;
    shader.bsdf = &bsdf;
    shader.textures = &textures;
    const ColorInput& color = color_of(bsdf);
    for (int c = 0; c < 3; ++c) shader.constants[static_cast<std::size_t>(c)] = color.constant[c];
    add_input(color.texture, 0, slots, shader);
    if (std::holds_alternative<Diffuse>(bsdf)) return shader;
    for (std::size_t i = kBsdfColor; i < kBsdfInputs; ++i) {
        const ScalarInput& scalar = scalar_of(bsdf, static_cast<int>(i));
        shader.constants[i] = scalar.constant;
        add_input(scalar.texture, static_cast<int>(i), slots, shader);
    }
    return shader;
}

/// The fixed inputs of a block, appended.
void look_up_fixed(const RecordShader& shader, const RecordBlock& block,
                   std::vector<LaneValues>& out) {
    const Vec2<Packet> uv{load(block.u.data()), load(block.v.data())};
    const auto put = [&](const Packet& p) { store(out.emplace_back().data(), p); };
    for (std::size_t i = 0; i < shader.fixed.size(); ++i) {
        if (shader.fixed[i] > 0) {
            put(eval_scalar(*shader.textures, scalar_of(*shader.bsdf, shader.fixed[i]), uv));
            continue;
        }
        const Rgb<Packet> c = eval_color(*shader.textures, color_of(*shader.bsdf), uv);
        put(c.x), put(c.y), put(c.z);
        i += 2;
    }
}

}  // namespace

std::vector<RecordShader> make_record_shaders(const Scene& scene, const TextureTable& textures,
                                              std::span<const int> slots) {
    std::vector<RecordShader> shaders;
    for (const Bsdf& bsdf : scene.bsdfs) shaders.push_back(make_shader(bsdf, textures, slots));
    return shaders;
}

std::size_t bytes_per_record(const RecordShader& shader) {
    return sizeof(RecordBlock) / kLanes +
           sizeof(float) * (shader.fixed.size() + 3 * shader.seeds.size());
}

void add_inputs(std::span<const RecordShader> shaders, TileRecords& records) {
    records.fixed.clear();
    std::size_t derivatives = 0;
    for (RecordRun& run : records.runs) {
        run.fixed = static_cast<std::uint32_t>(records.fixed.size());
        const RecordShader& shader = shaders[static_cast<std::size_t>(run.bsdf.value)];
        run.derivatives = static_cast<std::uint32_t>(derivatives);
        derivatives += 3 * shader.seeds.size() * (run.end - run.begin);
        for (std::uint32_t i = run.begin; i < run.end; ++i)
            look_up_fixed(shader, records.blocks[i], records.fixed);
    }
    records.fixed.shrink_to_fit();
    records.derivatives.resize(derivatives);
}

Rgb<Packet> shade(const RecordShader& shader, const RecordBlock& block, const LaneValues* fixed,
                  LaneValues* derivatives) {
    const RecordPacket r = unpack_records(block);
    const InputValues values = input_values(shader, fixed, r.uv);
    const auto* principled = std::get_if<Principled>(shader.bsdf);
    if (!principled) return shade_diffuse(values, r, derivatives);
    // Most descents move one input; more are carried three at a time.
    const std::span<const int> seeds(shader.seeds);
    if (seeds.size() == 1) return shade_group<1>(*principled, values, seeds, r, derivatives);
    Rgb<Packet> value;
    for (std::size_t first = 0; first < seeds.size(); first += 3)
        value = shade_group<3>(*principled, values,
                               seeds.subspan(first, std::min<std::size_t>(3, seeds.size() - first)),
                               r, derivatives + 3 * first);
    return value;
}

}  // namespace burnish
