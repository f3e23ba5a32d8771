// The reference table of `principled`: its rows as inputs and outputs, and how far an output can
// move when the inputs move by what single precision and seven printed digits leave open.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

#include "core/dual.h"
#include "csv.h"
#include "shading/principled.h"

namespace burnish::test {

inline constexpr int kParameters = 13, kInputs = 20, kOutputs = 3 + 3 * kParameters;
inline constexpr std::array<const char*, kInputs> kInputNames{"base_r",
                                                              "base_g",
                                                              "base_b",
                                                              "roughness",
                                                              "anisotropic",
                                                              "metallic",
                                                              "spec_trans",
                                                              "spec_tint",
                                                              "sheen",
                                                              "sheen_tint",
                                                              "flatness",
                                                              "clearcoat",
                                                              "clearcoat_gloss",
                                                              "wi_x",
                                                              "wi_y",
                                                              "wi_z",
                                                              "wo_x",
                                                              "wo_y",
                                                              "wo_z",
                                                              "eta"};

/// In the order of kInputNames; eta as the BSDF uses it.
using PrincipledInputs = std::array<double, kInputs>;
/// f (RGB), then the derivative of each channel to parameter k at 3 + 3 k + channel.
using PrincipledOutputs = std::array<double, kOutputs>;

/// Whether group 0-6 of the table gives parameter k (the first three are the base colour).
inline bool is_given(int group, int k) {
    static const std::array<std::string, 7> kGiven{
        "bbbr.m.......", "bbbram.......", "bbbram.tsSfcg", "bbbr.mT......",
        "bbbramTtsS.cg", "bbbr.......cg", "bbbr....s.f.."};
    return kGiven[static_cast<std::size_t>(group)][static_cast<std::size_t>(k)] != '.';
}

inline double eta_of_row(const CsvRow& row) {
    if (row["eta"] > 0) return row["eta"];
    const double specular = row["specular"] < 0 ? 0.5 : row["specular"];
    return 2 / (1 - std::sqrt(0.08 * specular)) - 1;
}

inline PrincipledInputs inputs_of_row(const CsvRow& row) {
    PrincipledInputs in;
    for (std::size_t i = 0; i + 1 < kInputs; ++i) in[i] = row[kInputNames[i]];
    in[kInputs - 1] = eta_of_row(row);
    return in;
}

inline PrincipledOutputs outputs_of_row(const CsvRow& row) {
    PrincipledOutputs out;
    const std::array<std::string, 3> channels{"r", "g", "b"};
    for (std::size_t c = 0; c < 3; ++c) {
        out[c] = row["f_" + channels[c]];
        for (std::size_t k = 0; k < kParameters; ++k)
            out[3 + 3 * k + c] = row["df_" + channels[c] + "_d" + kInputNames[k]];
    }
    return out;
}

template <class U>
Vec3<U> direction_at(const PrincipledInputs& in, std::size_t first) {
    return {static_cast<U>(in[first]), static_cast<U>(in[first + 1]),
            static_cast<U>(in[first + 2])};
}

/// parameter(k): parameter k as T. The flags say that exactly the given lobes exist.
template <class T, class F>
PrincipledParameters<T> make_parameters(const PrincipledInputs& in, int group, F parameter) {
    PrincipledParameters<T> p;
    p.base_color = {parameter(0), parameter(1), parameter(2)};
    p.roughness = parameter(3);
    p.anisotropic = parameter(4);
    p.metallic = parameter(5);
    p.spec_trans = parameter(6);
    p.spec_tint = parameter(7);
    p.sheen = parameter(8);
    p.sheen_tint = parameter(9);
    p.flatness = parameter(10);
    p.clearcoat = parameter(11);
    p.clearcoat_gloss = parameter(12);
    p.eta = static_cast<Plain<T>>(in[kInputs - 1]);
    p.has_anisotropic = is_given(group, 4);
    p.has_spec_trans = is_given(group, 6);
    p.has_spec_tint = is_given(group, 7);
    p.has_sheen = is_given(group, 8);
    p.has_flatness = is_given(group, 10);
    p.has_clearcoat = is_given(group, 11);
    return p;
}

template <class S>
PrincipledParameters<Dual<S, kParameters>> dual_parameters(const PrincipledInputs& in, int group) {
    return make_parameters<Dual<S, kParameters>>(in, group, [&](int k) {
        return variable<kParameters>(static_cast<S>(in[static_cast<std::size_t>(k)]), k);
    });
}

/// Value and derivatives; those to parameters that are not given are 0.
template <class S>
PrincipledOutputs outputs_of(const Rgb<Dual<S, kParameters>>& f, int group) {
    PrincipledOutputs out{};
    for (int c = 0; c < 3; ++c) {
        out[static_cast<std::size_t>(c)] = static_cast<double>(f[c].v);
        for (int k = 0; k < kParameters; ++k) {
            const auto at = static_cast<std::size_t>(3 + 3 * k + c);
            if (is_given(group, k))
                out[at] = static_cast<double>(f[c].d[static_cast<std::size_t>(k)]);
        }
    }
    return out;
}

/// Ours, in precision S.
template <class S>
PrincipledOutputs evaluate(const PrincipledInputs& in, int group) {
    return outputs_of<S>(eval_principled(dual_parameters<S>(in, group), direction_at<S>(in, 13),
                                         direction_at<S>(in, 16)),
                         group);
}

/// How much each output moves, at first order and added over the inputs in absolute value, when
/// every input moves by step(x) either way.
template <class F>
PrincipledOutputs spread_of_inputs(const PrincipledInputs& in, int group, F step) {
    PrincipledOutputs spread{};
    const PrincipledOutputs center = evaluate<double>(in, group);
    for (std::size_t i = 0; i < kInputs; ++i) {
        if (in[i] == 0) continue;
        PrincipledInputs up = in, down = in;
        up[i] += step(in[i]);
        down[i] -= step(in[i]);
        const PrincipledOutputs a = evaluate<double>(up, group), b = evaluate<double>(down, group);
        for (std::size_t q = 0; q < kOutputs; ++q)
            spread[q] += std::max(std::abs(a[q] - center[q]), std::abs(b[q] - center[q]));
    }
    return spread;
}

/// How much the clearcoat moves when 1 + (a^2 - 1) cos^2 of GTR1, which cancels where the facet
/// looks along the normal, moves by `error`: the one intermediate of single precision that
/// amplifies more than the inputs do.
inline PrincipledOutputs spread_of_clearcoat(const PrincipledInputs& in, int group, double error) {
    if (!is_given(group, 11)) return {};
    using T = Dual<double, kParameters>;
    const auto p = dual_parameters<double>(in, group);
    const auto wi = direction_at<double>(in, 13), wo = direction_at<double>(in, 16);
    auto g = principled_geometry(wi, wo, p.eta);
    const T exact = eval_principled_clearcoat(p, g, wi, wo);
    g.h.x = std::sqrt(g.h.x * g.h.x + error);
    const T moved = eval_principled_clearcoat(p, g, wi, wo) - exact;
    PrincipledOutputs spread = outputs_of<double>({moved, moved, moved}, group);
    for (double& s : spread) s = std::abs(s);
    return spread;
}

}  // namespace burnish::test
