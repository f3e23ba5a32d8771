// What the lobes of `principled` (principled.h) share: its parameters, the geometry of a pair of
// directions, and the distribution of its facets.
#pragma once

#include "shading/fresnel.h"
#include "shading/microfacet.h"

namespace burnish {

/// All in [0, 1] except eta. A has_ flag that is false promises that the parameter is 0 in every
/// lane; its terms are skipped. Without has_spec_trans the back is black.
template <class C, class S = C, class W = C>
struct PrincipledParameters {
    Rgb<C> base_color{C(0.5f), C(0.5f), C(0.5f)};
    S roughness{S(0.5f)};  ///< alpha = max(0.001, roughness^2) before anisotropy
    S anisotropic{};
    W metallic{}, spec_trans{}, spec_tint{}, sheen{}, sheen_tint{}, flatness{}, clearcoat{},
        clearcoat_gloss{};
    Plain<C> eta{1.5f};  ///< index of refraction inside / outside
    /// Relative rates at which the lobes are sampled.
    Plain<C> specular_rate{1.0f}, clearcoat_rate{1.0f}, diffuse_rate{1.0f};
    Plain<C> min_transmission{0.0f}, min_diffuse{0.0f}, min_clearcoat{0.0f};  ///< of lobes
    bool has_spec_trans = true, has_clearcoat = true, has_sheen = true, has_flatness = true,
         has_spec_tint = true, has_anisotropic = true;
};

/// What every lobe needs of a pair of directions: functions of the geometry and eta alone.
template <class U>
struct PrincipledGeometry {
    Vec3<U> h{};            ///< facet normal, h.z >= 0
    U wi_h{}, wo_h{};       ///< cosines to h
    U cos_i{}, cos_o{};     ///< absolute cosines to the normal
    U eta_path{};           ///< eta from the front, 1 / eta from the back
    U fresnel{};            ///< dielectric reflectance at h
    MaskOf<U> front{};      ///< wi on the front
    MaskOf<U> reflects{};   ///< same side, and h seen from the proper sides
    MaskOf<U> same_side{};  ///< same side, whatever h
    MaskOf<U> refracts{};   ///< opposite sides, and h seen from the proper sides
};

template <class U>
PrincipledGeometry<U> principled_geometry(const Vec3<U>& wi, const Vec3<U>& wo, const U& eta) {
    const U zero(0.0f), one(1.0f);
    PrincipledGeometry<U> g;
    g.front = wi.z > zero;
    g.same_side = wi.z * wo.z > zero;
    g.eta_path = select(g.front, eta, one / eta);
    const Vec3<U> sum = wi + wo * select(g.same_side, one, g.eta_path);
    const U squared = length_squared(sum);
    const auto proper = squared > zero;
    const U scale = mulsign(one / sqrt(select(proper, squared, one)), sum.z);
    g.h = sum * scale;
    g.wi_h = dot(wi, g.h);
    g.wo_h = dot(wo, g.h);
    g.cos_i = abs(wi.z);
    g.cos_o = abs(wo.z);
    g.fresnel = fresnel_dielectric(g.wi_h, eta).reflectance;
    const auto seen = proper && g.wi_h * wi.z > zero && g.wo_h * wo.z > zero;
    g.reflects = g.same_side && seen;
    g.refracts = wi.z * wo.z < zero && seen;
    return g;
}

/// alpha_x = max(0.001, r^2 / aspect), alpha_y = max(0.001, r^2 aspect), aspect = sqrt(1 - 0.9
/// anisotropic).
template <class C, class S, class W>
Ggx<S> principled_ggx(const PrincipledParameters<C, S, W>& p) {
    using U = Plain<S>;
    const S r2 = sqr(p.roughness), min_alpha(U(0.001f));
    if (!p.has_anisotropic) return {max(r2, min_alpha), max(r2, min_alpha)};
    const S aspect = sqrt(U(1.0f) - U(0.9f) * p.anisotropic);
    return {max(r2 * reciprocal(aspect), min_alpha), max(r2 * aspect, min_alpha)};
}

}  // namespace burnish
