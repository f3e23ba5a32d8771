// Mitsuba's `principledthin` [Burley 2015]: a sheet without thickness, alike from both sides. With
// the side of wi turned up, a sum of lobes
//
//   f |cos_o| = spec_trans F D G / (4 cos_i)                                      the same side
//             + spec_trans base_color (1 - F) D' G' / (4 cos_i)                   the other side
//             + (1 - spec_trans) (1 - diff_trans) (diffuse with retro-reflection, flattened, +
//               sheen)                                                            the same side
//             + (1 - spec_trans) diff_trans base_color |cos_o| / pi               the other side
//
// where transmission mirrors the direction through the sheet, of facets whose roughness is scaled
// by 0.65 eta - 0.35. Directions as in principled.h, whose formulas the lobes share.
// What eval_bsdf, pdf_bsdf and sample_bsdf return: bsdf.h.
#pragma once

#include "shading/bsdf_row.h"
#include "shading/principled.h"

namespace burnish {

template <class T>
struct PrincipledThinParameters {
    Rgb<T> base_color{};
    T roughness{}, anisotropic{}, spec_trans{}, spec_tint{}, sheen{}, sheen_tint{}, flatness{};
    T diff_trans{};  ///< in [0, 1]: half of the scene's number
    Plain<T> eta{1.5f};
    /// Relative rates at which the lobes are sampled: mirrored, passing, diffuse on either side.
    Plain<T> specular_reflection{1.0f}, specular_transmission{1.0f}, diffuse_reflection{1.0f},
        diffuse_transmission{1.0f};
    /// Bounds for sampling of spec_trans and 1 - spec_trans, diff_trans and 1 - diff_trans: see
    /// min_share.
    Plain<T> min_specular{0.0f}, min_side{0.0f};
};

/// eta, the rates, the bounds.
inline BsdfConstants<float> bsdf_constants(const PrincipledThin& b) {
    const auto bound_of = [&](ThinScalar s) {
        return min_share({b.scalars[static_cast<std::size_t>(s)].texture});
    };
    return {{b.eta, b.rates[0], b.rates[1], b.rates[2], b.rates[3],
             bound_of(ThinScalar::kSpecTrans), bound_of(ThinScalar::kDiffTrans)},
            {}};
}

/// Both directions with the side of wi up, and the facet that mirrors wi into wo or its image.
template <class U>
struct SheetGeometry {
    Vec3<U> wi{}, wo{}, h{};
    U wi_h{}, wo_h{}, fresnel{};  ///< cosines to h of wi and of the mirrored direction
    U schlick{};                  ///< Schlick's weight, of the cosine on the side of lower index
    MaskOf<U> same_side{};
    MaskOf<U> proper{};  ///< wo sees the side of the facet that it should
};

template <class U>
SheetGeometry<U> sheet_geometry(const Vec3<U>& wi, const Vec3<U>& wo, const U& eta) {
    const U zero(0.0f), one(1.0f);
    const auto front = wi.z > zero;
    SheetGeometry<U> g;
    g.wi = select(front, wi, -wi), g.wo = select(front, wo, -wo);
    g.same_side = g.wo.z > zero;
    const Vec3<U> mirrored{g.wo.x, g.wo.y, abs(g.wo.z)}, sum = g.wi + mirrored;
    const U squared = length_squared(sum);
    const auto some = squared > zero;
    g.h = sum * (one / sqrt(select(some, squared, one)));
    g.wi_h = dot(g.wi, g.h), g.wo_h = dot(mirrored, g.h);
    const auto fresnel = fresnel_dielectric(g.wi_h, eta);
    g.fresnel = fresnel.reflectance;
    g.schlick = schlick_weight(select(eta < one, U(abs(fresnel.cos_t)), g.wi_h));
    const U seen = dot(g.wo, g.h);
    g.proper = some && g.wi.z > zero && g.wi_h > zero &&
               ((g.same_side && seen > zero) || (!g.same_side && seen < zero && g.wo.z < zero));
    return g;
}

/// The facets of the lobe on the side of wo.
template <class T>
Ggx<T> sheet_ggx(const PrincipledThinParameters<T>& p, const MaskOf<T>& same_side) {
    using U = Plain<T>;
    const U scale = select(same_side, U(1.0f), U(U(0.65f) * p.eta - U(0.35f)));
    PrincipledParameters<T> q;
    q.roughness = p.roughness * scale;
    q.anisotropic = p.anisotropic;
    return principled_ggx(q);
}

/// The diffuse lobe and the sheen, without the share (1 - spec_trans)(1 - diff_trans).
template <class T>
Rgb<T> eval_sheet_diffuse(const PrincipledThinParameters<T>& p, const SheetGeometry<Plain<T>>& g) {
    using U = Plain<T>;
    PrincipledParameters<T> q;
    q.base_color = p.base_color, q.roughness = p.roughness, q.flatness = p.flatness;
    PrincipledGeometry<U> geometry;
    geometry.wo_h = g.wo_h, geometry.cos_i = g.wi.z, geometry.cos_o = abs(g.wo.z);
    const T shape = principled_diffuse_shape(q, geometry);
    const T sheen = p.sheen * (schlick_weight(abs(g.wo_h)) * abs(g.wo.z));
    const Rgb<T> tint = principled_tint(p.base_color);
    const auto channel = [&](const T& base, const T& t) {
        return T(base * shape + sheen * lerp(T(U(1.0f)), t, p.sheen_tint));
    };
    return {channel(p.base_color.x, tint.x), channel(p.base_color.y, tint.y),
            channel(p.base_color.z, tint.z)};
}

/// The specular lobe of the side of wo, without the share spec_trans.
template <class T>
Rgb<T> eval_sheet_specular(const PrincipledThinParameters<T>& p, const SheetGeometry<Plain<T>>& g) {
    using U = Plain<T>;
    const U zero(0.0f), one(1.0f);
    const Ggx<T> ggx = sheet_ggx(p, g.same_side);
    const T d_v = ggx_d(ggx, g.h) * ggx_visibility(ggx, g.wi, g.wo) * abs(g.wo.z);
    const T lobe = select(g.proper, d_v, T(zero));
    const Rgb<T> tint = principled_tint(p.base_color);
    const U r0 = schlick_r0(p.eta);
    const auto channel = [&](const T& base, const T& t) {
        const T mirrored = lerp(T(g.fresnel), schlick(T(t * r0), g.schlick), p.spec_tint);
        return T(select(g.same_side, mirrored, T(base * (one - g.fresnel))) * lobe);
    };
    return {channel(p.base_color.x, tint.x), channel(p.base_color.y, tint.y),
            channel(p.base_color.z, tint.z)};
}

template <class T>
Rgb<T> eval_bsdf(const PrincipledThinParameters<T>& p, const Vec3<Plain<T>>& wi,
                 const Vec3<Plain<T>>& wo) {
    using U = Plain<T>;
    const U one(1.0f);
    const auto g = sheet_geometry(wi, wo, p.eta);
    const Rgb<T> specular = eval_sheet_specular(p, g), diffuse = eval_sheet_diffuse(p, g);
    const T matt = one - p.spec_trans;
    const U lambert = abs(g.wo.z) * U(std::numbers::inv_pi);
    const auto lit = g.wi.z > U(0.0f) && abs(g.wo.z) > U(0.0f);
    const auto channel = [&](const T& s, const T& d, const T& base) {
        const T below = p.diff_trans * base * lambert;
        const T sum =
            p.spec_trans * s + matt * select(g.same_side, T((one - p.diff_trans) * d), below);
        return T(select(lit, sum, T(U(0.0f))));
    };
    return {channel(specular.x, diffuse.x, p.base_color.x),
            channel(specular.y, diffuse.y, p.base_color.y),
            channel(specular.z, diffuse.z, p.base_color.z)};
}

/// Probabilities of the lobes, which add up to 1, or are all 0.
template <class U>
struct SheetLobes {
    U mirror{}, pass{}, matt{}, matt_below{};
};

template <class U>
SheetLobes<U> sheet_lobes(const PrincipledThinParameters<U>& p) {
    const U one(1.0f), half(0.5f);
    const U specular = max(p.spec_trans, p.min_specular),
            matt = max(U(one - p.spec_trans), p.min_specular);
    const U mirror = specular * p.specular_reflection * half,
            pass = specular * p.specular_transmission * half,
            above = p.diffuse_reflection * matt * max(U(one - p.diff_trans), p.min_side),
            below = p.diffuse_transmission * matt * max(p.diff_trans, p.min_side);
    const U scale = safe_divide(one, U(mirror + pass + above + below));
    return {mirror * scale, pass * scale, above * scale, below * scale};
}

template <class U>
U pdf_bsdf(const PrincipledThinParameters<U>& p, const Vec3<U>& wi, const Vec3<U>& wo) {
    const U zero(0.0f);
    const auto g = sheet_geometry(wi, wo, p.eta);
    const auto lobes = sheet_lobes(p);
    const U facet = pdf_ggx_visible(sheet_ggx(p, g.same_side), g.wi, g.h) *
                    safe_divide(U(0.25f), U(abs(g.wo_h)));
    const U specular =
        select(g.same_side, lobes.mirror, lobes.pass) * select(g.proper, facet, zero);
    const U cosine = abs(g.wo.z) * U(std::numbers::inv_pi);
    const U diffuse = select(g.same_side, lobes.matt, lobes.matt_below) * cosine;
    return select(g.wi.z > zero, specular + diffuse, zero);
}

template <class U>
SampledDirection<U> sample_bsdf(const PrincipledThinParameters<U>& p, const Vec3<U>& wi,
                                const Vec2<U>& u, const U& u_lobe) {
    const U zero(0.0f), one(1.0f);
    const auto lobes = sheet_lobes(p);
    const auto front = wi.z > zero;
    const Vec3<U> up = select(front, wi, -wi);
    const U a = lobes.mirror, b = a + lobes.pass, c = b + lobes.matt;
    const auto mirror = u_lobe < a, specular = u_lobe < b, matt = !specular && u_lobe < c;
    const Vec3<U> h = sample_ggx_visible(sheet_ggx(p, mirror), up, u);
    Vec3<U> wo = select(specular, reflect(up, h), square_to_cosine_hemisphere(u));
    const auto above = mirror || matt;
    const auto open = wo.z > zero && up.z > zero;
    wo.z = wo.z * select(above, one, -one);
    // What passes sees the back of the facet, as in Mitsuba: some steep facets are left out.
    const auto seen = !specular || above || dot(wo, h) < zero;
    return {select(front, wo, -wo), open && seen};
}

}  // namespace burnish
