#include "gradient/differentiate.h"

#include <cmath>
#include <optional>

#include "core/dual.h"
#include "shading/bsdf.h"

namespace burnish {

namespace {

constexpr std::size_t kMaxInputs = kBsdfInputs + kMaxShares;

/// df / d(input) times |cos| by the inputs of a BSDF that read an unknown, then by its shares, in
/// the order of RecordShader's lists.
struct InputDerivatives {
    std::size_t count = 0;
    std::array<Rgbf, kMaxInputs> df{};
};

/// Inputs with their derivatives by some of them.
template <int N>
BsdfInputs<Dual<float, N>> seeded(const BsdfInputs<float>& values, std::span<const int> seeds) {
    BsdfInputs<Dual<float, N>> v;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = Dual<float, N>(values[i]);
    for (std::size_t k = 0; k < seeds.size(); ++k)
        v[static_cast<std::size_t>(seeds[k])].d[k] = 1.0f;
    return v;
}

template <int N>
Rgb<Dual<float, N>> eval_seeded(const auto& bsdf, const BsdfInputs<Dual<float, N>>& v,
                                RecordShader::Seeds, const PathRecord& record) {
    return eval_bsdf(bsdf_parameters(bsdf, v), record.wi_local, record.wo_local);
}

/// What does not depend on the seeds is computed without derivatives (shading/principled.h).
template <int N>
Rgb<Dual<float, N>> eval_seeded(const Principled& bsdf, const BsdfInputs<Dual<float, N>>& v,
                                RecordShader::Seeds kind, const PathRecord& record) {
    using T = Dual<float, N>;
    const auto eval = [&]<class C, class S, class W>(C, S, W) {
        return eval_principled(principled_parameters<C, S, W>(bsdf, v), record.wi_local,
                               record.wo_local);
    };
    switch (kind) {
        case RecordShader::Seeds::kColor:
            return eval(T(), 0.0f, 0.0f);
        case RecordShader::Seeds::kShape:
            return eval(0.0f, T(), 0.0f);
        case RecordShader::Seeds::kWeight:
            return eval(0.0f, 0.0f, T());
        default:
            return eval(T(), T(), T());
    }
}

template <int N>
void add_derivatives(const auto& bsdf, const BsdfInputs<float>& values, RecordShader::Seeds kind,
                     std::span<const int> seeds, const PathRecord& record, InputDerivatives& out) {
    const auto f = eval_seeded<N>(bsdf, seeded<N>(values, seeds), kind, record);
    for (std::size_t k = 0; k < seeds.size(); ++k)
        out.df[out.count++] = {f.x.d[k], f.y.d[k], f.z.d[k]};
}

InputDerivatives input_derivatives(const DerivativeInput& in, const auto& bsdf,
                                   const RecordShader& shader, const PathRecord& record) {
    const BsdfInputs<float> values = bsdf_inputs(in.binding->textures, bsdf, record.uv);
    // Derivatives are carried forward four at a time: one vector register; a single one costs less
    // alone.
    InputDerivatives out;
    const std::span<const int> all = shader.unknown_inputs;
    if (all.size() == 1) {
        add_derivatives<1>(bsdf, values, shader.kind, all, record, out);
    } else {
        for (std::size_t first = 0; first < all.size(); first += 4)
            add_derivatives<4>(bsdf, values, shader.kind,
                               all.subspan(first, std::min<std::size_t>(4, all.size() - first)),
                               record, out);
    }
    return out;
}

/// f is linear in the reflectance, and each channel depends on its own alone.
InputDerivatives input_derivatives(const DerivativeInput&, const Diffuse&,
                                   const RecordShader& shader, const PathRecord& record) {
    if (shader.unknown_inputs.empty()) return {};
    const DiffuseParameters<float> white{{1, 1, 1}};
    const float f = eval_diffuse(white, record.wi_local, record.wo_local).x;
    return {3, {{{f, 0, 0}, {0, f, 0}, {0, 0, f}}}};
}

/// The BSDF's value times |cos|; one where it is within the light of the path. at: a PathRecord or
/// a PathVertex.
Rgbf value_of(const Binding& binding, const RecordShader& shader, const auto& at) {
    if (shader.is_within_light) return {1, 1, 1};
    const Bsdf& bsdf = *shader.bsdf;
    return eval_bsdf(bsdf, bsdf_inputs(binding.textures, bsdf, at.uv), at.wi_local, at.wo_local);
}

/// What one weight of a blend leaves of the BSDF.
float share_of(const Binding& binding, const BlendShare& share, Vec2f uv) {
    const float w = eval_scalar(binding.textures, {0, share.weight}, uv);
    return share.second ? w : 1 - w;
}

/// The product rule for the shares, whose derivatives are added.
void share_out(const DerivativeInput& in, const RecordShader& shader, const PathRecord& record,
               InputDerivatives& inputs) {
    std::array<float, kMaxShares> share{};
    const std::size_t count = shader.shares.size();
    for (std::size_t k = 0; k < count; ++k)
        share[k] = share_of(*in.binding, shader.shares[k], record.uv);
    const auto others = [&](std::size_t left_out) {
        float product = 1;
        for (std::size_t k = 0; k < count; ++k)
            if (k != left_out) product *= share[k];
        return product;
    };
    for (std::size_t i = 0; i < inputs.count; ++i) inputs.df[i] = inputs.df[i] * others(count);
    const Rgbf value = value_of(*in.binding, shader, record);
    for (std::size_t k = 0; k < count; ++k)
        inputs.df[inputs.count++] = value * (shader.shares[k].second ? others(k) : -others(k));
}

/// Derivative of the loss by one input, and the luminance of its parts by the channels of the
/// light.
struct InputGradient {
    float g = 0;
    float luminance = 0;
};

InputGradient input_gradient(const Rgbf& weight, const Rgbf& df) {
    const Rgbf v = weight * df;
    return {v.x + v.y + v.z, luminance(v)};
}

float sign_of(float x) { return x < 0 ? -1.0f : 1.0f; }

/// What weighs the channels of a value.
struct Weights {
    Rgbf derivative;             ///< w(x) times the light
    std::optional<Rgbf> target;  ///< the same of light without color; none: as the derivative
};

/// q of a texel that is read as a number. kIntegrand: all channels of the texel have its sign.
float target_value(TargetFunction target, const InputGradient& d) {
    return target == TargetFunction::kLuminance ? d.luminance : d.g;
}

/// q of one that is read as a colour. g: by its channels.
float target_value(TargetFunction target, const Rgbf& g) {
    const float q = luminance(g);
    if (target == TargetFunction::kLuminance) return q;
    return sign_of(q) * (std::fabs(g.x) + std::fabs(g.y) + std::fabs(g.z));
}

/// The same of light without color. df: by a number, or by the three channels of a colour.
float target_value(TargetFunction target, const Rgbf& weight, std::span<const Rgbf> df) {
    Rgbf sums;  // by channel
    float magnitude = 0;
    for (std::size_t c = 0; c < df.size(); ++c) {
        const Rgbf v = weight * df[c];
        sums[static_cast<int>(c)] = v.x + v.y + v.z;
        magnitude += std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
    }
    const float q = df.size() == 1 ? luminance(weight * df[0]) : luminance(sums);
    return target == TargetFunction::kLuminance ? q : sign_of(q) * magnitude;
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
void scatter(const DerivativeInput& in, const PathRecord& record, TextureId texture, float q,
             const Rgbf& g, TexelDerivatives& out) {
    const auto slot = static_cast<std::uint32_t>(in.binding->slot_of(texture));
    const TexelFootprint foot = footprint(in.binding->bitmap(texture), record.uv);
    for (std::size_t k = 0; k < static_cast<std::size_t>(foot.count); ++k)
        touch(out, {slot, foot.texel[k]}, q * foot.weight[k], g * foot.weight[k]);
}

void scatter_scalar(const DerivativeInput& in, const PathRecord& record, TextureId texture,
                    const Weights& weights, const Rgbf& df, TexelDerivatives& out) {
    const InputGradient d = input_gradient(weights.derivative, df);
    const Rgbf g = scalar_to_texel(in.binding->bitmap(texture).channels, d.g);
    const float q = weights.target ? target_value(in.target, *weights.target, {&df, 1})
                                   : target_value(in.target, d);
    scatter(in, record, texture, q, g, out);
}

/// df: by the three channels.
void scatter_color(const DerivativeInput& in, const PathRecord& record, TextureId texture,
                   const Weights& weights, std::span<const Rgbf> df, TexelDerivatives& out) {
    Rgbf g;
    for (std::size_t c = 0; c < 3; ++c)
        g[static_cast<int>(c)] = input_gradient(weights.derivative, df[c]).g;
    g = color_to_texel(in.binding->bitmap(texture).channels, g);
    const float q =
        weights.target ? target_value(in.target, *weights.target, df) : target_value(in.target, g);
    scatter(in, record, texture, q, g, out);
}

/// w(x)
Rgbf adjoint_of(const DerivativeInput& in, const PathRecord& record) {
    const int width = in.normalized_adjoint->width, pixel = static_cast<int>(record.pixel);
    const auto& [taps_x, taps_y] = (*in.taps)[record.film_pass];
    return adjoint_weight(*in.normalized_adjoint, pixel % width, pixel / width, taps_x, taps_y);
}

/// The derivatives by the texels of all inputs.
void scatter_all(const DerivativeInput& in, const PathRecord& record, const Weights& weights,
                 TexelDerivatives& out) {
    if (is_black(weights.target.value_or(weights.derivative))) return;
    const RecordShader& shader = in.binding->shader(record.bsdf);
    InputDerivatives inputs = std::visit(
        [&](const auto& b) { return input_derivatives(in, b, shader, record); }, *shader.bsdf);
    if (!shader.shares.empty()) share_out(in, shader, record, inputs);
    const Rgbf* df = inputs.df.data();
    for (const UnknownInput& u : shader.unknowns) {
        if (u.is_color)
            scatter_color(in, record, u.texture, weights, {df, 3}, out);
        else
            scatter_scalar(in, record, u.texture, weights, *df, out);
        df += u.is_color ? 3 : 1;
    }
}

TexelDerivative entry_of(const TexelDerivatives& all, TexelKey key) {
    for (int i = 0; i < all.count; ++i)
        if (all.items[static_cast<std::size_t>(i)].key == key)
            return all.items[static_cast<std::size_t>(i)];
    return {key, 0, {}};
}

}  // namespace

void differentiate(const DerivativeInput& in, const PathRecord& record, TexelDerivatives& out) {
    out.count = 0, out.adjoint = {};
    if (is_black(record.radiance_over_pdf)) return;
    out.adjoint = adjoint_of(in, record);
    scatter_all(in, record, {out.adjoint * record.radiance_over_pdf, {}}, out);
}

void differentiate(const DerivativeInput& in, const PathRecord& record, const Rgbf& others,
                   TexelDerivatives& out) {
    out.count = 0, out.adjoint = {};
    const Rgbf& light = record.radiance_over_pdf;
    // Nobody keeps a path whose product is black: a target above zero would count on its history.
    if (is_black(others * light)) return;
    out.adjoint = adjoint_of(in, record);
    const Rgbf weight = out.adjoint * others;
    const float gray = (std::fabs(light.x) + std::fabs(light.y) + std::fabs(light.z)) / 3;
    scatter_all(in, record, {weight * light, weight * gray}, out);
}

Rgbf scattered(const Binding& binding, const PathVertex& vertex) {
    const RecordShader& shader = binding.shader(vertex.bsdf);
    Rgbf f = value_of(binding, shader, vertex);
    for (const BlendShare& share : shader.shares) f = f * share_of(binding, share, vertex.uv);
    return f;
}

TexelDerivative differentiate_at(const DerivativeInput& in, const PathRecord& record,
                                 TexelKey key) {
    TexelDerivatives all;
    differentiate(in, record, all);
    return entry_of(all, key);
}

TexelDerivative differentiate_at(const DerivativeInput& in, const PathRecord& record,
                                 std::span<const PathVertex> others, TexelKey key) {
    Rgbf product{1, 1, 1};
    for (const PathVertex& vertex : others) product = product * scattered(*in.binding, vertex);
    TexelDerivatives all;
    differentiate(in, record, product, all);
    return entry_of(all, key);
}

}  // namespace burnish
