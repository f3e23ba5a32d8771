#include "gradient/differentiate.h"

#include <cmath>

#include "core/dual.h"
#include "shading/bsdf.h"

namespace burnish {

namespace {

constexpr std::size_t kMaxInputs = kBsdfInputs + kMaxShares;

/// The inputs of a BSDF that read an unknown, and df / d(input) times |cos| for each. Shares follow
/// kBsdfInputs.
struct InputDerivatives {
    int count = 0;
    std::array<int, kMaxInputs> input{};
    std::array<Rgbf, kMaxInputs> df{};
};

template <int N>
Rgb<Dual<float, N>> eval_seeded(const auto& bsdf, const BsdfInputs<float>& values,
                                std::span<const int> seeds, const PathRecord& record) {
    using T = Dual<float, N>;
    BsdfInputs<T> v;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = T(values[i]);
    for (std::size_t k = 0; k < seeds.size(); ++k)
        v[static_cast<std::size_t>(seeds[k])].d[k] = 1.0f;
    return eval_bsdf(bsdf_parameters(bsdf, v), record.wi_local, record.wo_local);
}

template <int N>
void add_derivatives(const auto& bsdf, const BsdfInputs<float>& values, std::span<const int> seeds,
                     const PathRecord& record, InputDerivatives& out) {
    const auto f = eval_seeded<N>(bsdf, values, seeds, record);
    for (std::size_t k = 0; k < seeds.size(); ++k) {
        const auto i = static_cast<std::size_t>(out.count++);
        out.input[i] = seeds[k];
        out.df[i] = {f.x.d[k], f.y.d[k], f.z.d[k]};
    }
}

/// The places in the row that read an unknown, in order.
struct Seeds {
    std::array<int, kBsdfInputs> place;
    std::size_t count = 0;
};

Seeds find_seeds(const Binding& binding, const auto& bsdf) {
    Seeds seeds;
    int place = 0;
    const auto add = [&](TextureId id, int channels) {
        for (int c = 0; c < channels; ++c, ++place)
            if (binding.slot_of(id) >= 0) seeds.place[seeds.count++] = place;
    };
    for (const ColorInput& color : colors_of(bsdf)) add(color.texture, 3);
    for (const ScalarInput& scalar : scalars_of(bsdf)) add(scalar.texture, 1);
    return seeds;
}

InputDerivatives input_derivatives(const DerivativeInput& in, const auto& bsdf,
                                   const PathRecord& record) {
    const BsdfInputs<float> values = bsdf_inputs(in.binding->textures, bsdf, record.uv);
    const Seeds seeds = find_seeds(*in.binding, bsdf);
    // Derivatives are carried forward four at a time: one vector register; a single one costs less
    // alone.
    InputDerivatives out;
    const std::span<const int> all(seeds.place.data(), seeds.count);
    if (all.size() == 1) {
        add_derivatives<1>(bsdf, values, all, record, out);
    } else {
        for (std::size_t first = 0; first < all.size(); first += 4)
            add_derivatives<4>(bsdf, values,
                               all.subspan(first, std::min<std::size_t>(4, all.size() - first)),
                               record, out);
    }
    return out;
}

/// f is linear in the reflectance, and each channel depends on its own alone.
InputDerivatives input_derivatives(const DerivativeInput& in, const Diffuse& bsdf,
                                   const PathRecord& record) {
    if (in.binding->slot_of(bsdf.reflectance.texture) < 0) return {};
    const DiffuseParameters<float> white{{1, 1, 1}};
    const float f = eval_diffuse(white, record.wi_local, record.wo_local).x;
    InputDerivatives out;
    out.count = 3;
    out.input = {0, 1, 2};
    out.df = {{{f, 0, 0}, {0, f, 0}, {0, 0, f}}};
    return out;
}

/// The BSDF's value times |cos|; one where it is within the record's light.
Rgbf value_of(const DerivativeInput& in, const RecordShader& shader, const PathRecord& record) {
    if (shader.is_within_light) return {1, 1, 1};
    const Bsdf& bsdf = *shader.bsdf;
    return eval_bsdf(bsdf, bsdf_inputs(in.binding->textures, bsdf, record.uv), record.wi_local,
                     record.wo_local);
}

/// The product rule for the shares, whose derivatives are added.
void share_out(const DerivativeInput& in, const RecordShader& shader, const PathRecord& record,
               InputDerivatives& inputs) {
    std::array<float, kMaxShares> share{};
    const std::size_t count = shader.shares.size();
    for (std::size_t k = 0; k < count; ++k) {
        const float w = eval_scalar(in.binding->textures, {0, shader.shares[k].weight}, record.uv);
        share[k] = shader.shares[k].second ? w : 1 - w;
    }
    const auto others = [&](std::size_t left_out) {
        float product = 1;
        for (std::size_t k = 0; k < count; ++k)
            if (k != left_out) product *= share[k];
        return product;
    };
    for (std::size_t i = 0; i < static_cast<std::size_t>(inputs.count); ++i)
        inputs.df[i] = inputs.df[i] * others(count);
    const Rgbf value = value_of(in, shader, record);
    for (std::size_t k = 0; k < count; ++k) {
        const auto i = static_cast<std::size_t>(inputs.count++);
        inputs.input[i] = static_cast<int>(kBsdfInputs + k);
        inputs.df[i] = value * (shader.shares[k].second ? others(k) : -others(k));
    }
}

/// Derivative of the loss by one input, and the same per colour channel of the light (for the
/// luminance).
struct InputGradient {
    float g = 0;
    float luminance = 0;
};

InputGradient input_gradient(const Rgbf& weight, const Rgbf& df) {
    const Rgbf v = weight * df;
    return {v.x + v.y + v.z, luminance(v)};
}

float sign_of(float x) { return x < 0 ? -1.0f : 1.0f; }

/// q of a texel from the derivatives by its channels.
float target_value(TargetFunction target, bool scalar, const Rgbf& g, float scalar_luminance) {
    switch (target) {
        case TargetFunction::kLuminance:
            return scalar ? scalar_luminance : luminance(g);
        case TargetFunction::kIntegrand:
            if (scalar)
                return g.x + g.y + g.z;  // one channel, or a luminance: all channels of one sign
            return sign_of(luminance(g)) * (std::fabs(g.x) + std::fabs(g.y) + std::fabs(g.z));
    }
    return 0;
}

void touch(TexelDerivatives& out, TexelKey key, float q, const Rgbf& g) {
    if (q == 0 && is_black(g)) return;
    for (int i = 0; i < out.count; ++i) {
        TexelDerivative& item = out.items[static_cast<std::size_t>(i)];
        if (item.key == key) {  // two inputs share a texture, or two corners a texel: one integrand
            item.q += q;
            item.g += g;
            return;
        }
    }
    out.items[static_cast<std::size_t>(out.count++)] = {key, q, g};
}

/// Spreads an input's gradient over the texels of its texture.
void scatter(const DerivativeInput& in, const PathRecord& record, TextureId texture, bool scalar,
             Rgbf g, float scalar_luminance, TexelDerivatives& out) {
    const auto& bitmap = in.binding->bitmap(texture);
    g = scalar ? scalar_to_texel(bitmap.channels, g.x) : color_to_texel(bitmap.channels, g);
    const float q = target_value(in.target, scalar, g, scalar_luminance);
    const auto slot = static_cast<std::uint32_t>(in.binding->slot_of(texture));
    const TexelFootprint foot = footprint(bitmap, record.uv);
    for (std::size_t k = 0; k < static_cast<std::size_t>(foot.count); ++k)
        touch(out, {slot, foot.texel[k]}, q * foot.weight[k], g * foot.weight[k]);
}

void scatter_color(const DerivativeInput& in, const PathRecord& record, TextureId texture,
                   const InputDerivatives& inputs, std::size_t first, const Rgbf& weight,
                   TexelDerivatives& out) {
    Rgbf g;
    for (int c = 0; c < 3; ++c)
        g[c] = input_gradient(weight, inputs.df[first + static_cast<std::size_t>(c)]).g;
    scatter(in, record, texture, false, g, 0, out);
}

}  // namespace

void differentiate(const DerivativeInput& in, const PathRecord& record, TexelDerivatives& out) {
    out.count = 0, out.adjoint = {};
    if (is_black(record.radiance_over_pdf)) return;
    const int width = in.normalized_adjoint->width, pixel = static_cast<int>(record.pixel);
    const auto& [taps_x, taps_y] = (*in.taps)[record.film_pass];
    out.adjoint =
        adjoint_weight(*in.normalized_adjoint, pixel % width, pixel / width, taps_x, taps_y);
    const Rgbf weight = out.adjoint * record.radiance_over_pdf;
    if (is_black(weight)) return;

    const Bsdf& bsdf = in.binding->scene()[record.bsdf];
    const RecordShader& shader = in.binding->shader(record.bsdf);
    InputDerivatives inputs =
        std::visit([&](const auto& b) { return input_derivatives(in, b, record); }, bsdf);
    if (!shader.shares.empty()) share_out(in, shader, record, inputs);
    for (std::size_t i = 0; i < static_cast<std::size_t>(inputs.count); ++i) {
        const auto place = static_cast<std::size_t>(inputs.input[i]);
        const bool is_share = place >= kBsdfInputs;
        const TextureId texture = is_share ? shader.shares[place - kBsdfInputs].weight
                                           : texture_at(bsdf, inputs.input[i]);
        if (is_share || scalar_at(bsdf, inputs.input[i])) {
            const InputGradient d = input_gradient(weight, inputs.df[i]);
            scatter(in, record, texture, true, {d.g, 0, 0}, d.luminance, out);
        } else if (inputs.input[i] % 3 == 0) {
            scatter_color(in, record, texture, inputs, i, weight, out);
        }
    }
}

TexelDerivative differentiate_at(const DerivativeInput& in, const PathRecord& record,
                                 TexelKey key) {
    TexelDerivatives all;
    differentiate(in, record, all);
    for (int i = 0; i < all.count; ++i)
        if (all.items[static_cast<std::size_t>(i)].key == key)
            return all.items[static_cast<std::size_t>(i)];
    return {key, 0, {}};
}

}  // namespace burnish
