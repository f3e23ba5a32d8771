// What the records of each BSDF read, of constant textures and of unknowns.
#include "core/contract.h"
#include "render/shade.h"

namespace burnish {

namespace {

/// Sorts an input by what it reads: nothing, a constant texture, or an unknown one.
void add_input(const TextureId& texture, int input, std::span<const int> slots,
               RecordShader& shader) {
    if (!texture) return;
    const bool is_color = color_at(*shader.bsdf, input) != nullptr;
    const int slot = slots[static_cast<std::size_t>(texture.value)];
    std::vector<int>& list = slot < 0 ? shader.constant_inputs : shader.unknown_inputs;
    list.push_back(input);
    if (is_color) list.insert(list.end(), {input + 1, input + 2});
    if (slot < 0) return;
    shader.unknowns.push_back({texture, slot, is_color});
    shader.mixes_channels = mixes_channels(*shader.bsdf);
    if (!is_color)
        shader.seeds.push_back(input);
    else if (shader.mixes_channels)
        shader.seeds.insert(shader.seeds.end(), {input, input + 1, input + 2});
    else
        shader.seeds.push_back(RecordShader::kAllChannels - input / 3);
}

RecordShader::Seeds kind_of(std::span<const int> seeds) {
    using enum RecordShader::Seeds;
    if (seeds.empty()) return kNone;
    if (seeds.size() != 1) return kSeveral;
    if (seeds[0] < static_cast<int>(kBsdfColor)) return kColor;
    const auto scalar = static_cast<PrincipledScalar>(seeds[0] - static_cast<int>(kBsdfColor));
    return scalar <= PrincipledScalar::kAnisotropic ? kShape : kWeight;
}

/// The shares that are optimised.
void add_shares(std::span<const BlendShare> shares, std::span<const int> slots,
                RecordShader& shader) {
    shader.is_within_light = shader.unknowns.empty();
    for (const BlendShare& share : shares) {
        const int slot = slots[static_cast<std::size_t>(share.weight.value)];
        if (slot < 0) continue;
        shader.unknowns.push_back({share.weight, slot, false});
        shader.shares.push_back(share);
    }
    BURNISH_REQUIRE(shader.shares.size(), <=, kMaxShares);
    if (shader.shares.empty()) shader.is_within_light = false;
    if (shader.is_within_light) shader.constant_inputs.clear();
}

RecordShader make_shader(const Scene& scene, BsdfId id, const TextureTable& textures,
                         std::span<const int> slots) {
    const Bsdf& bsdf = scene[id];
    RecordShader shader;
    shader.bsdf = &bsdf;
    shader.textures = &textures;
    std::size_t input = 0;
    for (const ColorInput& color : colors_of(bsdf)) {
        add_input(color.texture, static_cast<int>(input), slots, shader);
        for (int c = 0; c < 3; ++c) shader.constants[input++] = color.constant[c];
    }
    for (const ScalarInput& scalar : scalars_of(bsdf)) {
        shader.constants[input] = scalar.constant;
        add_input(scalar.texture, static_cast<int>(input), slots, shader);
        ++input;
    }
    shader.kind = kind_of(shader.seeds);
    add_shares(shares_of(scene, id), slots, shader);
    return shader;
}

}  // namespace

std::vector<RecordShader> make_record_shaders(const Scene& scene, const TextureTable& textures,
                                              std::span<const int> slots) {
    BURNISH_REQUIRE(slots.size(), ==, scene.textures.size());
    BURNISH_REQUIRE(textures.textures.size(), ==, scene.textures.size());
    std::vector<RecordShader> shaders;
    for (std::size_t i = 0; i < scene.bsdfs.size(); ++i)
        shaders.push_back(make_shader(scene, {static_cast<std::int32_t>(i)}, textures, slots));
    return shaders;
}

std::vector<RecordShader> without_derivatives(std::vector<RecordShader> shaders) {
    for (RecordShader& shader : shaders) {
        shader.seeds.clear();
        shader.has_derivatives = false;
        shader.kind = RecordShader::Seeds::kNone;
    }
    return shaders;
}

std::size_t bytes_per_record(const RecordShader& shader) {
    return sizeof(RecordBlock) / kLanes +
           sizeof(float) * (shader.constant_inputs.size() + 3 * shader.derivatives());
}

std::size_t bytes_per_vertex(const RecordShader& shader) {
    return bytes_per_record(shader) + (sizeof(VertexBlock) - sizeof(RecordBlock)) / kLanes +
           sizeof(ChainLink);
}

}  // namespace burnish
