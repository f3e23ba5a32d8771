// Packed records + textures -> values and derivatives: no rays, no random numbers, sixteen records
// at a time. The leaf maths is that of shading/; the plain twin of this file is
// gradient/differentiate.h.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/records.h"
#include "scene/scene.h"
#include "shading/bsdf_row.h"
#include "shading/texture_packet.h"

namespace burnish {

/// An input of a BSDF that reads an unknown, or a share of it that does.
struct UnknownInput {
    TextureId texture;
    int slot = 0;  ///< index into the optimised textures
    bool is_color = false;
};

/// One BSDF, ready to shade runs of its records under given textures.
struct RecordShader {
    const Bsdf* bsdf = nullptr;
    const TextureTable* textures = nullptr;
    std::array<float, kBsdfInputs> constants{};
    std::vector<UnknownInput> unknowns;  ///< in order of unknown_inputs, then of shares
    std::vector<int> unknown_inputs;  ///< places that read optimised textures; a colour has three
    /// Places that read other textures: looked up once, kept with records.
    std::vector<int> constant_inputs;
    /// Shares whose weights are optimised textures: the value is multiplied with each.
    std::vector<BlendShare> shares;
    /// No other input is optimised, but shares are: the BSDF's value is within the records' light.
    bool is_within_light = false;
    /// What derivatives are taken by: a scalar, one channel of a colour, or (kAllChannels minus the
    /// number of the colour) each channel of the value by its own channel of the colour, where no
    /// other depends on it.
    std::vector<int> seeds;
    bool has_derivatives = true;  ///< by the shares, too
    /// Which inputs the seeds belong to, so that the others' maths does without derivatives.
    enum class Seeds { kNone, kSeveral, kColor, kShape, kWeight } kind = Seeds::kNone;
    bool mixes_channels = false;  ///< a channel of the value depends on more than one of the colour
    static constexpr int kAllChannels = -1;

    /// Derivatives of the value: by each seed, then by the weight of each share.
    std::size_t derivatives() const { return seeds.size() + (has_derivatives ? shares.size() : 0); }
    /// Values of a block that read optimised textures: unknown_inputs, then shares.
    std::size_t unknown_values() const { return unknown_inputs.size() + shares.size(); }
};

/// Shaders of all BSDFs, indexed by BsdfId. slots: index into the optimised textures of each
/// texture of the scene, -1 for the others. scene and textures must outlive the result.
std::vector<RecordShader> make_record_shaders(const Scene& scene, const TextureTable& textures,
                                              std::span<const int> slots);

/// The same shaders without seeds: they give values alone.
std::vector<RecordShader> without_derivatives(std::vector<RecordShader> shaders);

/// What a record of this BSDF takes, its derivatives included.
std::size_t bytes_per_record(const RecordShader& shader);
/// And what a vertex of a chain takes.
std::size_t bytes_per_vertex(const RecordShader& shader);

/// What lies beside a tile's records and follows from them and the textures.
struct RecordMemory {
    std::vector<LaneValues> constant_inputs;  ///< per block, what its BSDF reads of other textures
    /// Per block, what the last shading found: RecordShader::derivatives of the value's three
    /// channels.
    std::vector<LaneValues> derivatives;
};

/// Looks up the constant inputs of packed records, and makes room for their derivatives.
RecordMemory make_record_memory(std::span<const RecordShader> shaders, const TileRecords& records);

/// The inputs of consecutive blocks that read optimised textures: sets `values` to
/// RecordShader::unknown_values of each, block by block. Ahead of the maths, so that the cache
/// misses of several blocks overlap.
void look_up_unknown(const RecordShader& shader, std::span<const RecordBlock> blocks,
                     std::vector<LaneValues>& values);
void look_up_unknown(const RecordShader& shader, std::span<const VertexBlock> blocks,
                     std::vector<LaneValues>& values);

/// f(x) Le(x) / pdf of sixteen records: what they add to the image. constant_inputs,
/// unknown_inputs: the block's, in the order of the shader's. derivatives: set to those of the
/// three channels of that value: RecordShader::derivatives of each.
Rgb<Packet> shade(const RecordShader& shader, const RecordBlock& block,
                  const LaneValues* constant_inputs, const LaneValues* unknown_inputs,
                  LaneValues* derivatives);

}  // namespace burnish
