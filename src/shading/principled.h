// Mitsuba's `principled` BSDF [Burley 2012, 2015]: a sum of lobes
//
//   f |cos_o| = specular F D G / (4 |cos_i|)            both sides
//             + transmission (rough dielectric, radiance scaled by 1 / eta'^2)   both sides
//             + clearcoat (GTR1)                        front
//             + diffuse with retro-reflection, flattened, + sheen   front
//
// on a scalar type T: float, double, Packet, or Dual for derivatives to the parameters. wi points
// to the camera, wo to the light; both in the shading frame (z = normal), both away from the
// surface, of the plain type U.
//
// The parameters are of three types, so that what does not depend on an optimised one is computed
// without derivatives: C, the colour; S, what shapes the specular lobe; W, what weighs the lobes.
#pragma once

#include "shading/principled_geometry.h"
#include "shading/warp.h"

namespace burnish {

/// base / luminance(base); white where the luminance is 0.
template <class T>
Rgb<T> principled_tint(const Rgb<T>& base) {
    using U = Plain<T>;
    const T y = luminance(base);
    const auto lit = value(y) > U(0.0f);
    const T inverse = U(1.0f) / select(lit, y, T(U(1.0f)));
    const T white(U(1.0f));
    return {select(lit, base.x * inverse, white), select(lit, base.y * inverse, white),
            select(lit, base.z * inverse, white)};
}

/// Roughness of the clearcoat.
template <class T>
T clearcoat_alpha(const T& gloss) {
    return lerp(T(Plain<T>(0.1f)), T(Plain<T>(0.001f)), gloss);
}

/// F of the specular reflection: dielectric, metallic and tinted parts on the front, bsdf
/// F_dielectric on the back.
template <class C, class S, class W>
Rgb<Joint<C, W>> principled_fresnel(const PrincipledParameters<C, S, W>& p,
                                    const PrincipledGeometry<Plain<C>>& g) {
    using T = Joint<C, W>;
    using U = Plain<T>;
    const U one(1.0f), weight = schlick_weight(abs(g.wi_h));
    const W dielectric = one - p.metallic;
    const W untinted = p.has_spec_tint ? dielectric * (one - p.spec_tint) : dielectric;
    const W gray = untinted * g.fresnel;
    const auto metallic = [&](const C& base) {
        return T(gray + p.metallic * schlick(base, weight));
    };
    Rgb<T> f{metallic(p.base_color.x), metallic(p.base_color.y), metallic(p.base_color.z)};
    if (p.has_spec_tint) {
        const Rgb<C> tint = principled_tint(p.base_color);
        const auto tinted = [&](const C& t) {
            return T(dielectric * p.spec_tint * schlick(C(t * schlick_r0(p.eta)), weight));
        };
        f += Rgb<T>{tinted(tint.x), tinted(tint.y), tinted(tint.z)};
    }
    if (all(g.front)) return f;
    const T back(p.has_spec_trans ? W(dielectric * p.spec_trans * g.fresnel) : W(U(0.0f)));
    return {select(g.front, f.x, back), select(g.front, f.y, back), select(g.front, f.z, back)};
}

/// Specular reflection. d_v: D G1(wi) G1(wo) / (4 |cos_i| |cos_o|).
template <class C, class S, class W>
Rgb<Joint<C, S, W>> eval_principled_reflection(const PrincipledParameters<C, S, W>& p,
                                               const PrincipledGeometry<Plain<C>>& g,
                                               const S& d_v) {
    using U = Plain<S>;
    // Masked by the dielectric reflectance, as in Mitsuba: matched indices extinguish metals too.
    const auto active = g.reflects && g.fresnel > U(0.0f);
    const S common = select(active, d_v * g.cos_o, S(U(0.0f)));
    const Rgb<Joint<C, W>> f = principled_fresnel(p, g);
    return {f.x * common, f.y * common, f.z * common};
}

/// Specular transmission, of radiance. d_v: as above.
template <class C, class S, class W>
Rgb<Joint<C, S, W>> eval_principled_transmission(const PrincipledParameters<C, S, W>& p,
                                                 const PrincipledGeometry<Plain<C>>& g,
                                                 const S& d_v) {
    using T = Joint<S, W>;
    using U = Plain<T>;
    const U one(1.0f), zero(0.0f);
    const U facets = U(4.0f) * g.cos_o * abs(g.wi_h * g.wo_h);
    const U jacobian = safe_divide(facets, U(sqr(g.wi_h + g.eta_path * g.wo_h)));
    const U factor = select(g.refracts, (one - g.fresnel) * jacobian, zero);
    const T common =
        select(g.refracts, T((one - p.metallic) * p.spec_trans * d_v * factor), T(zero));
    return {safe_sqrt(p.base_color.x) * common, safe_sqrt(p.base_color.y) * common,
            safe_sqrt(p.base_color.z) * common};
}

/// Clearcoat: 0.25 clearcoat Schlick(0.04) GTR1 G |cos_o|, without 1 / (4 cos_i cos_o).
template <class C, class S, class W>
W eval_principled_clearcoat(const PrincipledParameters<C, S, W>& p,
                            const PrincipledGeometry<Plain<C>>& g, const Vec3<Plain<C>>& wi,
                            const Vec3<Plain<C>>& wo) {
    using U = Plain<W>;
    const Ggx<U> masking{U(0.25f), U(0.25f)};
    const U f = schlick(U(0.04f), schlick_weight(abs(g.wi_h)));
    const U factor = U(0.25f) * f * ggx_g1(masking, wi, g.h) * ggx_g1(masking, wo, g.h) * g.cos_o;
    const W coat = p.clearcoat * gtr1_d(clearcoat_alpha(p.clearcoat_gloss), g.h) * factor;
    return select(g.reflects && g.front, coat, W(U(0.0f)));
}

/// Diffuse reflection with retro-reflection, blended to a flat subsurface look; BSDF / base_color *
/// cos_o, without the share (1 - metallic)(1 - spec_trans).
template <class C, class S, class W>
Joint<S, W> principled_diffuse_shape(const PrincipledParameters<C, S, W>& p,
                                     const PrincipledGeometry<Plain<C>>& g) {
    using T = Joint<S, W>;
    using U = Plain<T>;
    const U one(1.0f), half(0.5f);
    const U f_i = schlick_weight(g.cos_i), f_o = schlick_weight(g.cos_o);
    const S rr = p.roughness * (U(2.0f) * sqr(g.wo_h));
    const U lambert = (one - half * f_i) * (one - half * f_o);
    const S retro = rr * (f_o + f_i + f_o * f_i * (rr - one));
    T shape(retro + lambert);
    if (p.has_flatness) {
        const S bend = half * rr - one;
        const S ss = (bend * f_o + one) * (bend * f_i + one);
        const U inverse = safe_divide(one, U(g.cos_o + g.cos_i));
        const T flat(U(1.25f) * (ss * (inverse - half) + half));
        shape = lerp(shape, flat, T(p.flatness));
    }
    return shape * (g.cos_o * U(std::numbers::inv_pi));
}

/// The diffuse lobe and the sheen that rides on it.
template <class C, class S, class W>
Rgb<Joint<C, S, W>> eval_principled_diffuse(const PrincipledParameters<C, S, W>& p,
                                            const PrincipledGeometry<Plain<C>>& g) {
    using T = Joint<C, S, W>;
    using U = Plain<T>;
    const U one(1.0f);
    const auto active = g.same_side && g.front;
    const W dielectric = one - p.metallic;
    const W share = p.has_spec_trans ? W(dielectric * (one - p.spec_trans)) : dielectric;
    const Joint<S, W> zero(U(0.0f)),
        white = select(active, share * principled_diffuse_shape(p, g), zero);
    Rgb<T> f{p.base_color.x * white, p.base_color.y * white, p.base_color.z * white};
    if (p.has_sheen) {
        const U weight = select(active, schlick_weight(abs(g.wo_h)) * g.cos_o, U(0.0f));
        const W sheen = p.sheen * dielectric * weight;
        const Rgb<C> tint = principled_tint(p.base_color);
        const auto tinted = [&](const C& t) {
            return T(sheen * lerp(T(one), T(t), T(p.sheen_tint)));
        };
        f += Rgb<T>{tinted(tint.x), tinted(tint.y), tinted(tint.z)};
    }
    return f;
}

/// BSDF times |cos theta_o|, linear RGB, for directions whose geometry is g.
template <class C, class S, class W>
Rgb<Joint<C, S, W>> eval_principled(const PrincipledParameters<C, S, W>& p,
                                    const PrincipledGeometry<Plain<C>>& g,
                                    const Vec3<Plain<C>>& wi_local,
                                    const Vec3<Plain<C>>& wo_local) {
    using T = Joint<C, S, W>;
    Rgb<T> f{};
    if (any(g.reflects || g.refracts)) {
        const Ggx<S> ggx = principled_ggx(p);
        const S d_v = ggx_d(ggx, g.h) * ggx_visibility(ggx, wi_local, wo_local);
        if (any(g.reflects)) f += eval_principled_reflection(p, g, d_v);
        if (p.has_spec_trans && any(g.refracts)) f += eval_principled_transmission(p, g, d_v);
    }
    if (!any(g.same_side && g.front)) return f;
    if (p.has_clearcoat) {
        const T coat(eval_principled_clearcoat(p, g, wi_local, wo_local));
        f += Rgb<T>{coat, coat, coat};
    }
    f += eval_principled_diffuse(p, g);
    return f;
}

template <class C, class S, class W>
Rgb<Joint<C, S, W>> eval_principled(const PrincipledParameters<C, S, W>& p,
                                    const Vec3<Plain<C>>& wi_local,
                                    const Vec3<Plain<C>>& wo_local) {
    return eval_principled(p, principled_geometry(wi_local, wo_local, p.eta), wi_local, wo_local);
}

/// Probabilities of the lobes given wi and the dielectric reflectance F at the facet; they add up
/// to 1, or are all 0. Front: specular : transmission : clearcoat : diffuse = s (1 - bsdf (1 - F))
/// : s bsdf (1 - F) : clearcoat / 4 : brdf, with the rates, bsdf at least p.min_transmission and at
/// most 1 in the first two, clearcoat at least p.min_clearcoat, brdf at least p.min_diffuse; back:
/// F : 1 - F. The shares of clearcoat and diffuse do not depend on F, so the density is exact.
/// Metallic, spec_trans and clearcoat may be any finite number where they have these bounds.
template <class T>
struct PrincipledLobes {
    T reflection{}, transmission{}, clearcoat{}, diffuse{};
};

template <class T>
PrincipledLobes<T> principled_lobes(const PrincipledParameters<T>& p, const MaskOf<T>& front,
                                    const Plain<T>& fresnel) {
    using U = Plain<T>;
    const U one(1.0f);
    const T zero(U(0.0f)), dielectric = one - p.metallic;
    const T bsdf = p.has_spec_trans ? T(dielectric * p.spec_trans) : zero;
    const T drawn = min(max(bsdf, T(p.min_transmission)), T(one));
    const T passed = drawn * (one - fresnel);
    const T clearcoat = max(p.clearcoat, T(p.min_clearcoat));
    const T coat = p.has_clearcoat ? T(clearcoat * (U(0.25f) * p.clearcoat_rate)) : zero;
    const T matt = dielectric - bsdf;
    const T diffuse = max(matt, T(p.min_diffuse)) * p.diffuse_rate;
    const T total = coat + diffuse + p.specular_rate;
    const T scale = safe_divide(T(one), total);
    const U inside(p.has_spec_trans ? one : U(0.0f));
    return {select(front, (one - passed) * p.specular_rate * scale, T(inside * fresnel)),
            select(front, passed * p.specular_rate * scale, T(inside * (one - fresnel))),
            select(front, coat * scale, zero), select(front, diffuse * scale, zero)};
}

/// Density of sample_principled in solid angle, for directions whose geometry is g.
template <class T>
T pdf_principled(const PrincipledParameters<T>& p, const PrincipledGeometry<Plain<T>>& g,
                 const Vec3<Plain<T>>& wi_local) {
    using U = Plain<T>;
    const U quarter(0.25f);
    const auto lobes = principled_lobes(p, g.front, g.fresnel);
    const T zero(U(0.0f));
    const T visible = pdf_ggx_visible(principled_ggx(p), wi_local, g.h);
    const U dh_reflect = select(g.reflects, safe_divide(quarter, U(abs(g.wo_h))), U(0.0f));
    T pdf = select(g.reflects, lobes.reflection * visible * dh_reflect, zero);
    if (p.has_spec_trans && any(g.refracts)) {
        const U dh =
            safe_divide(U(sqr(g.eta_path) * abs(g.wo_h)), sqr(U(g.wi_h + g.eta_path * g.wo_h)));
        pdf = pdf + select(g.refracts, lobes.transmission * visible * dh, zero);
    }
    if (p.has_clearcoat) {
        const T coat =
            lobes.clearcoat * pdf_gtr1(clearcoat_alpha(p.clearcoat_gloss), g.h) * dh_reflect;
        pdf = pdf + select(g.reflects && g.front, coat, zero);
    }
    return pdf + select(g.same_side && g.front, lobes.diffuse * (g.cos_o * U(std::numbers::inv_pi)),
                        zero);
}

template <class T>
T pdf_principled(const PrincipledParameters<T>& p, const Vec3<Plain<T>>& wi_local,
                 const Vec3<Plain<T>>& wo_local) {
    return pdf_principled(p, principled_geometry(wi_local, wo_local, p.eta), wi_local);
}

/// BSDF times |cos theta_o| and the density of its sampling, which share their geometry.
template <class T>
BsdfValue<T> eval_pdf_principled(const PrincipledParameters<T>& p, const Vec3<T>& wi_local,
                                 const Vec3<T>& wo_local) {
    const auto g = principled_geometry(wi_local, wo_local, p.eta);
    return {eval_principled(p, g, wi_local, wo_local), pdf_principled(p, g, wi_local)};
}

/// Draws wo: u uniform in [0, 1)^2, u_lobe uniform in [0, 1) and independent of u. T without
/// derivatives.
template <class T>
SampledDirection<T> sample_principled(const PrincipledParameters<T>& p, const Vec3<T>& wi_local,
                                      const Vec2<T>& u, const T& u_lobe) {
    const T zero(0.0f);
    const auto front = wi_local.z > zero;
    const Vec3<T> up = select(front, wi_local, -wi_local);
    const Vec3<T> h = sample_ggx_visible(principled_ggx(p), up, u);
    const auto fresnel = fresnel_dielectric(T(dot(wi_local, h)), p.eta);
    const auto lobes = principled_lobes(p, front, fresnel.reflectance);

    // The lobes in turn take [0, a), [a, b), [b, c), and reflection the rest, where it exists.
    const T a = lobes.diffuse, b = a + lobes.clearcoat, c = b + lobes.transmission;
    const auto diffuse = u_lobe < a, coat = !diffuse && u_lobe < b,
               transmit = !diffuse && !coat && u_lobe < c;
    Vec3<T> wo = reflect(wi_local, h);
    auto proper = wo.z * wi_local.z > zero;
    if (any(transmit)) {
        wo = select(transmit, refract(wi_local, h, fresnel), wo);
        proper = (transmit && wo.z * wi_local.z < zero) || (!transmit && proper);
    }
    if (any(coat)) {
        const Vec3<T> facet = sample_gtr1(clearcoat_alpha(p.clearcoat_gloss), u);
        wo = select(coat, reflect(wi_local, facet), wo);
        proper = (coat && wo.z > zero) || (!coat && proper);
    }
    if (any(diffuse)) {
        wo = select(diffuse, square_to_cosine_hemisphere(u), wo);
        proper = diffuse || proper;
    }
    return {wo, proper, {}, {}, select(transmit, T(T(1.0f) / fresnel.eta_ti), T(1.0f))};
}

// Compiled with the library alone: whoever uses them may be compiled with less optimisation.
extern template Rgbf eval_principled_diffuse(const PrincipledParameters<float>&,
                                             const PrincipledGeometry<float>&);
extern template Rgbf eval_principled(const PrincipledParameters<float>&,
                                     const PrincipledGeometry<float>&, const Vec3f&, const Vec3f&);

}  // namespace burnish
