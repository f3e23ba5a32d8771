// Mitsuba's `plastic` and `roughplastic`: a diffuse base under a dielectric, smooth or of facets,
// one-sided.
//
//   f |cos_o| = specular F(wi . h) D(h) G1(wi) G1(wo) / (4 cos_i)
//             + base / (1 - [base] R) T(cos_i) T(cos_o) cos_o / (pi eta^2)
//
// T: share of light that passes the interface; R: share of diffuse light that it reflects back
// inside; [base] where the plastic is nonlinear. A smooth interface has T = 1 - F, and its specular
// lobe is a delta lobe. wi points to the camera, wo to the light; both local.
// What eval_bsdf, pdf_bsdf and sample_bsdf return: bsdf.h.
#pragma once

#include "shading/conductor.h"
#include "shading/principled_geometry.h"

namespace burnish {

template <class T>
struct PlasticParameters {
    using U = Plain<T>;
    Rgb<T> diffuse{}, specular{};
    U eta{1.5f};               ///< index of refraction inside / outside
    U internal_reflectance{};  ///< R
    MaskOf<T> nonlinear{};
    U min_specular{}, min_diffuse{};  ///< see min_share
};

template <class T>
struct RoughPlasticParameters {
    PlasticParameters<T> plastic;
    Facets<Plain<T>> facets;
    TransmittanceTable<Plain<T>> transmittance;
};

/// Share of diffuse light that a smooth interface reflects: fits of [Egan and Hilgeman 1973] for
/// eta < 1 and [d'Eon and Irving 2011] else, as in Mitsuba.
inline float fresnel_diffuse_reflectance(float eta) {
    const float i = 1 / eta;
    if (eta < 1) return -1.4399f * eta * eta + 0.7099f * eta + 0.6681f + 0.0636f * i;
    return 0.919317f +
           i * (-3.4793f + i * (6.75335f + i * (-7.80989f + i * (4.98554f - 1.36881f * i))));
}

/// eta, internal reflectance, nonlinear.
inline BsdfConstants<float> bsdf_constants(const Plastic& b) {
    return {{b.eta, fresnel_diffuse_reflectance(1 / b.eta), b.nonlinear ? 1.0f : 0.0f}, {}};
}
/// The same; the distribution, alpha, the least shares of the lobes; the table.
inline BsdfConstants<float> bsdf_constants(const RoughPlastic& b) {
    return {{b.eta, b.internal_reflectance, b.nonlinear ? 1.0f : 0.0f,
             b.shape == FacetShape::kBeckmann ? 1.0f : 0.0f, b.alpha,
             min_share({b.colors[1].texture}), min_share({b.colors[0].texture})},
            {{b.transmittance.data()}}};
}

/// T at a cosine in [0, 1]: linear between entries.
inline float eval_transmittance(const float* table, float cosine) {
    const float x = cosine * (kTransmittances - 1);
    const auto i = std::min(static_cast<std::size_t>(x), kTransmittances - 2);
    const float t = x - static_cast<float>(i);
    return (1 - t) * table[i] + t * table[i + 1];
}
template <class U>
U eval_transmittance(const TransmittanceTable<U>& table, const U& cosine) {
    return U(eval_transmittance(table.of_lane[0], static_cast<float>(cosine)));
}
template <>
inline Packet eval_transmittance(const TransmittanceTable<Packet>& table, const Packet& cosine) {
    float lanes[kLanes];
    store(lanes, cosine);
    for (std::size_t k = 0; k < kLanes; ++k)
        lanes[k] = eval_transmittance(table.of_lane[k], lanes[k]);
    return load(lanes);
}

/// The base's share of f |cos_o|. passed: T(cos_i) T(cos_o).
template <class T>
Rgb<T> eval_plastic_base(const PlasticParameters<T>& p, const Plain<T>& passed,
                         const Plain<T>& cos_o) {
    using U = Plain<T>;
    const U one(1.0f), r = p.internal_reflectance;
    const U scale = passed * cos_o * U(std::numbers::inv_pi) / sqr(p.eta);
    const auto channel = [&](const T& base) {
        const T inside = select(p.nonlinear, T(base * r), T(r));
        return T(base / (one - inside) * scale);
    };
    return {channel(p.diffuse.x), channel(p.diffuse.y), channel(p.diffuse.z)};
}

/// Probability of the specular lobe. reflected: share of light that the interface reflects.
template <class U>
U specular_probability(const PlasticParameters<U>& p, const U& reflected) {
    const U specular = abs(p.specular.x + p.specular.y + p.specular.z) * reflected;
    const U base = abs(p.diffuse.x + p.diffuse.y + p.diffuse.z) * (U(1.0f) - reflected);
    const U sum = specular + base;
    const U share = select(sum > U(0.0f), safe_divide(specular, sum), reflected);
    return max(p.min_specular, min(U(U(1.0f) - p.min_diffuse), share));
}

template <class T>
Rgb<T> eval_bsdf(const PlasticParameters<T>& p, const Vec3<Plain<T>>& wi,
                 const Vec3<Plain<T>>& wo) {
    using U = Plain<T>;
    const U zero(0.0f), one(1.0f);
    const auto front = wi.z > zero && wo.z > zero;
    const U passed = (one - fresnel_dielectric(wi.z, p.eta).reflectance) *
                     (one - fresnel_dielectric(wo.z, p.eta).reflectance);
    return eval_plastic_base(p, select(front, passed, zero), wo.z);
}

template <class U>
U pdf_bsdf(const PlasticParameters<U>& p, const Vec3<U>& wi, const Vec3<U>& wo) {
    const U zero(0.0f), one(1.0f);
    const U mirror = specular_probability(p, fresnel_dielectric(wi.z, p.eta).reflectance);
    return select(wi.z > zero && wo.z > zero, (one - mirror) * wo.z * U(std::numbers::inv_pi),
                  zero);
}

template <class U>
SampledDirection<U> sample_bsdf(const PlasticParameters<U>& p, const Vec3<U>& wi, const Vec2<U>& u,
                                const U& u_lobe) {
    const U zero(0.0f), one(1.0f), reflected = fresnel_dielectric(wi.z, p.eta).reflectance;
    const U mirror = specular_probability(p, reflected);
    const auto front = wi.z > zero, delta = front && u_lobe < mirror;
    const Vec3<U> wo = select(delta, Vec3<U>{-wi.x, -wi.y, wi.z}, square_to_cosine_hemisphere(u));
    return {wo, front, delta, {p.specular * reflected, mirror}, one};
}

template <class T>
Rgb<T> eval_bsdf(const RoughPlasticParameters<T>& p, const Vec3<Plain<T>>& wi,
                 const Vec3<Plain<T>>& wo) {
    using U = Plain<T>;
    const U zero(0.0f);
    const auto m = mirror_facet(wi, wo);
    if (!any(m.front)) return {};
    const U fresnel = fresnel_dielectric(m.wi_h, p.plastic.eta).reflectance;
    const U d_v = facet_d(p.facets, m.h) * facet_visibility(p.facets, wi, wo);
    const U mirror = select(m.front, fresnel * d_v * wo.z, zero);
    const U passed = eval_transmittance(p.transmittance, clamp01(wi.z)) *
                     eval_transmittance(p.transmittance, clamp01(wo.z));
    const Rgb<T> base = eval_plastic_base(p.plastic, select(m.front, passed, zero), wo.z);
    const Rgb<T>& s = p.plastic.specular;
    return {base.x + s.x * mirror, base.y + s.y * mirror, base.z + s.z * mirror};
}

template <class U>
U pdf_bsdf(const RoughPlasticParameters<U>& p, const Vec3<U>& wi, const Vec3<U>& wo) {
    const U zero(0.0f), one(1.0f);
    const auto m = mirror_facet(wi, wo);
    const U mirror = specular_probability(
        p.plastic, U(one - eval_transmittance(p.transmittance, clamp01(wi.z))));
    const U facet = pdf_facet(p.facets, wi, m.h) * safe_divide(U(0.25f), m.wi_h);
    const U cosine = wo.z * U(std::numbers::inv_pi);
    return select(m.front, mirror * facet + (one - mirror) * cosine, zero);
}

template <class U>
SampledDirection<U> sample_bsdf(const RoughPlasticParameters<U>& p, const Vec3<U>& wi,
                                const Vec2<U>& u, const U& u_lobe) {
    const U zero(0.0f), one(1.0f);
    const auto front = wi.z > zero;
    const U mirror = specular_probability(
        p.plastic, U(one - eval_transmittance(p.transmittance, clamp01(wi.z))));
    const Vec3<U> h = sample_facet(p.facets, select(front, wi, -wi), u);
    const Vec3<U> wo = select(u_lobe < mirror, reflect(wi, h), square_to_cosine_hemisphere(u));
    return {wo, front && wo.z > zero};
}

}  // namespace burnish
