// Samplers against their densities (chi-square), over materials, sides, grazing angles and
// transmission.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ledger_entries.h"
#include "random_source.h"
#include "shading/bsdf.h"
#include "sphere_integral.h"

namespace burnish::test {
namespace {

using namespace ledger;

/// With the samples and a seed of an entry.
DrawnDirections draw(const LedgerEntry& entry, const Sampler& sampler, const Axes& axes,
                     std::uint32_t seed) {
    return draw_directions(sampler, axes, seed_of(entry, seed), scaled(entry, 300000u));
}

Direction from_angles(double theta_degrees, double phi_degrees) {
    const double t = theta_degrees * std::numbers::pi / 180,
                 p = phi_degrees * std::numbers::pi / 180;
    return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

/// A material and the direction to the camera.
struct Case {
    const char* name;
    PrincipledParameters<double> p;
    Direction wi;
};

struct Look {
    double roughness = 0.5, anisotropic = 0, metallic = 0, spec_trans = 0, clearcoat = 0, gloss = 0,
           eta = 1.5, min_transmission = 0, min_diffuse = 0;
};

PrincipledParameters<double> material(const Look& look) {
    PrincipledParameters<double> p;
    p.base_color = {0.8, 0.5, 0.3};
    p.roughness = look.roughness;
    p.anisotropic = look.anisotropic;
    p.metallic = look.metallic;
    p.spec_trans = look.spec_trans;
    p.clearcoat = look.clearcoat;
    p.clearcoat_gloss = look.gloss;
    p.eta = look.eta;
    p.min_transmission = look.min_transmission, p.min_diffuse = look.min_diffuse;
    p.has_spec_trans = look.spec_trans > 0 || look.min_transmission > 0;
    return p;
}

std::vector<Case> cases() {
    const auto at = from_angles;
    return {
        {"rough", material({.roughness = 0.8}), at(30, 20)},
        {"default", material({}), at(50, 100)},
        {"smooth", material({.roughness = 0.05}), at(40, 250)},
        {"smooth metal", material({.roughness = 0.05, .metallic = 1}), at(60, 10)},
        {"least alpha", material({.roughness = 0, .metallic = 0.5}), at(20, 10)},
        {"metal, normal", material({.roughness = 0.3, .metallic = 1}), at(0, 0)},
        {"metal, grazing", material({.roughness = 0.4, .metallic = 1}), at(88, 45)},
        {"dielectric, grazing", material({.roughness = 0.2}), at(89, 300)},
        {"smooth, grazing", material({.roughness = 0.05}), at(85, 300)},
        {"anisotropic metal", material({.roughness = 0.5, .anisotropic = 1, .metallic = 1}),
         at(45, 30)},
        {"anisotropic, grazing", material({.roughness = 0.6, .anisotropic = 0.7, .metallic = 0.6}),
         at(80, 75)},
        {"clearcoat", material({.roughness = 0.6, .clearcoat = 1}), at(35, 120)},
        {"glossy clearcoat", material({.roughness = 0.6, .clearcoat = 1, .gloss = 1}), at(35, 120)},
        {"clearcoat, grazing",
         material({.roughness = 0.3, .metallic = 1, .clearcoat = 1, .gloss = 0.5}), at(85, 0)},
        {"glass from the front", material({.roughness = 0.3, .spec_trans = 1}), at(30, 60)},
        {"glass from the back", material({.roughness = 0.3, .spec_trans = 1}), at(150, 60)},
        {"smooth glass", material({.roughness = 0.05, .spec_trans = 1, .eta = 1.33}), at(45, 60)},
        {"smooth glass, back", material({.roughness = 0.05, .spec_trans = 1, .eta = 1.33}),
         at(150, 200)},
        {"total reflection", material({.roughness = 0.3, .spec_trans = 1}), at(120, 60)},
        {"glass, grazing", material({.roughness = 0.4, .spec_trans = 1, .eta = 1.7}), at(86, 10)},
        {"glass, grazing, back", material({.roughness = 0.4, .spec_trans = 1, .eta = 1.7}),
         at(94, 10)},
        {"half glass",
         material({.roughness = 0.5, .metallic = 0.2, .spec_trans = 0.5, .clearcoat = 0.7}),
         at(40, 0)},
        {"anisotropic glass", material({.roughness = 0.6, .anisotropic = 0.9, .spec_trans = 0.8}),
         at(50, 140)},
        {"everything, back",
         material({.roughness = 0.5, .anisotropic = 0.5, .metallic = 0.3, .spec_trans = 0.6}),
         at(140, 70)},
        {"glass to come", material({.roughness = 0.4, .min_transmission = 0.05}), at(35, 60)},
        {"metal to come", material({.roughness = 0.4, .metallic = 1, .min_diffuse = 0.05}),
         at(35, 60)},
    };
}

/// Mirror direction, and the refracted one (or straight through).
Axes axes_of(const Case& c) {
    const Direction z{0, 0, 1};
    const auto f = fresnel_dielectric(c.wi.z, c.p.eta);
    return {reflect(c.wi, z), normalize(refract(c.wi, z, f))};
}

/// In precision S.
template <class S>
PrincipledParameters<S> in_precision(const PrincipledParameters<double>& d) {
    const auto s = [](double x) { return static_cast<S>(x); };
    PrincipledParameters<S> p;
    p.base_color = {s(d.base_color.x), s(d.base_color.y), s(d.base_color.z)};
    p.roughness = s(d.roughness);
    p.anisotropic = s(d.anisotropic);
    p.metallic = s(d.metallic);
    p.spec_trans = s(d.spec_trans);
    p.clearcoat = s(d.clearcoat);
    p.clearcoat_gloss = s(d.clearcoat_gloss);
    p.eta = s(d.eta);
    p.min_transmission = s(d.min_transmission), p.min_diffuse = s(d.min_diffuse);
    p.has_spec_trans = d.has_spec_trans;
    return p;
}

template <class S>
Vec3<S> in_precision(const Direction& d) {
    return {static_cast<S>(d.x), static_cast<S>(d.y), static_cast<S>(d.z)};
}

template <class S>
Sampler principled_sampler(const Case& c) {
    const auto p = in_precision<S>(c.p);
    const auto wi = in_precision<S>(c.wi);
    return [p, wi](const std::array<double, 4>& u) -> std::optional<Direction> {
        constexpr S below_one = S(1) - std::numeric_limits<S>::epsilon() / 2;
        const auto at = [&](std::size_t i) { return std::min(static_cast<S>(u[i]), below_one); };
        const auto s = sample_principled(p, wi, Vec2<S>{at(0), at(1)}, at(2));
        if (!s.proper || !(pdf_principled(p, wi, s.wo_local) > 0)) return std::nullopt;
        return normalize(in_precision<double>(Direction{static_cast<double>(s.wo_local.x),
                                                        static_cast<double>(s.wo_local.y),
                                                        static_cast<double>(s.wo_local.z)}));
    };
}

Density principled_density(const Case& c) {
    return [c](const Direction& wo) { return pdf_principled(c.p, c.wi, wo); };
}

TEST(Sampling, PrincipledFollowsItsDensity) {
    std::uint32_t seed = 0;
    for (const Case& c : cases()) {
        const FitResult fit =
            fit_of(draw(kPrincipledSampling, principled_sampler<double>(c), axes_of(c), seed += 10),
                   principled_density(c));
        EXPECT_LE(fit.total, 1 + 1e-4) << c.name;
        EXPECT_TRUE(accepted(kPrincipledSampling, c.name, fit.p_value)) << fit.total;
    }
}

/// As textures may hold values beyond [0, 1], whose lobes have these bounds.
TEST(Sampling, PrincipledHasProbabilitiesBeyondItsRange) {
    constexpr std::array kValues{-0.3, 0.0, 0.5, 1.0, 1.3};
    PrincipledParameters<double> p = material({.min_transmission = 0.05, .min_diffuse = 0.05});
    p.min_clearcoat = 0.05;
    for (const double metallic : kValues)
        for (const double spec_trans : kValues)
            for (const double clearcoat : kValues)
                for (const double fresnel : {0.0, 0.04, 1.0}) {
                    p.metallic = metallic, p.spec_trans = spec_trans, p.clearcoat = clearcoat;
                    const auto l = principled_lobes(p, true, fresnel);
                    EXPECT_GE(std::min({l.reflection, l.transmission, l.clearcoat, l.diffuse}), 0)
                        << metallic << ", " << spec_trans << ", " << clearcoat;
                    EXPECT_NEAR(l.reflection + l.transmission + l.clearcoat + l.diffuse, 1, 1e-12);
                }
}

TEST(Sampling, SheenIsDrawnWhereAllLightPasses) {
    Principled bsdf;
    bsdf.has_spec_trans = bsdf.has_sheen = true;
    BsdfInputs<double> inputs{};
    const auto input = [&](PrincipledScalar s) -> double& {
        return inputs[3 + static_cast<std::size_t>(s)];
    };
    input(PrincipledScalar::kRoughness) = 0.01;
    input(PrincipledScalar::kSpecTrans) = input(PrincipledScalar::kSheen) = 1;
    const auto p = bsdf_parameters(bsdf, inputs);
    const Direction wi = from_angles(60, 0);
    for (int theta = 5; theta < 90; theta += 5) {
        const Direction wo = from_angles(theta, 100);
        EXPECT_GT(eval_principled(p, wi, wo).x, 0) << theta;
        EXPECT_GE(pdf_principled(p, wi, wo), 0.04 * wo.z / std::numbers::pi) << theta;
    }
}

TEST(Sampling, PrincipledTellsTheIndexOfRefractionOnItsWay) {
    int refracted = 0;
    for (const Case& c : cases())
        for (const double u_lobe : {0.1, 0.3, 0.5, 0.7, 0.9}) {
            const auto s = sample_principled(c.p, c.wi, {0.3, 0.6}, u_lobe);
            const bool passes = s.wo_local.z * c.wi.z < 0;
            if (!s.proper) continue;
            EXPECT_NEAR(s.eta, passes ? (c.wi.z > 0 ? c.p.eta : 1 / c.p.eta) : 1, 1e-12) << c.name;
            refracted += passes;
        }
    EXPECT_GT(refracted, 5);
}

/// In single precision, where roundings of the facet do not outgrow the lobe: alpha >= 0.0025.
TEST(Sampling, PrincipledInFloatFollowsTheDensity) {
    std::uint32_t seed = 0;
    for (const Case& c : cases()) {
        if (c.p.roughness < 0.05) continue;
        EXPECT_TRUE(accepted(kPrincipledFloatSampling, c.name,
                             fit_of(draw(kPrincipledFloatSampling, principled_sampler<float>(c),
                                         axes_of(c), seed += 10),
                                    principled_density(c))
                                 .p_value));
    }
    const Case rough = cases()[0];
    Case metal = rough;
    metal.p.metallic = 0.1;
    EXPECT_TRUE(rejected(kPrincipledFloatSampling, "lobes chosen for another metallic",
                         fit_of(draw(kPrincipledFloatSampling, principled_sampler<float>(rough),
                                     axes_of(rough), seed += 10),
                                principled_density(metal))
                             .p_value));
}

TEST(Sampling, PrincipledRejectsDefects) {
    std::uint32_t seed = 1900;
    for (const Case& c : cases()) {
        const DrawnDirections drawn =
            draw(kPrincipledSampling, principled_sampler<double>(c), axes_of(c), seed += 10);
        const auto expect_rejected = [&](const char* defect, const Density& density) {
            EXPECT_TRUE(rejected(kPrincipledSampling, defect, fit_of(drawn, density).p_value))
                << c.name;
        };
        Case rougher = c;
        rougher.p.roughness =
            1.05 * std::max(c.p.roughness, std::sqrt(0.001));  // from where alpha begins
        const Density density = principled_density(c);
        const Density higher = [&](const Direction& d) { return 1.03 * density(d); };
        expect_rejected("density times 1.03", higher);
        expect_rejected("roughness 5 % larger", principled_density(rougher));
        if (c.p.anisotropic == 0) continue;
        const Density swapped = [&](const Direction& d) {
            return pdf_principled(c.p, Direction{c.wi.y, c.wi.x, c.wi.z}, Direction{d.y, d.x, d.z});
        };
        expect_rejected("alpha_x and alpha_y exchanged", swapped);
    }
}

/// Any material from alpha = 0.001, from any side; every third direction grazes.
Case random_case(std::uint32_t i) {
    RandomSource random{seed_of(kRandomSampling, 500000 + i)};
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random.next());
    };
    Look look;
    look.roughness = std::sqrt(std::pow(10.0, uniform(-3, 0)));
    look.metallic = uniform(0, 1);
    look.gloss = uniform(0, 1);
    look.eta = uniform(1.1, 2);
    if (i % 2 == 1) look.anisotropic = uniform(0, 1);
    if (i % 3 == 0) look.spec_trans = uniform(0.2, 1);
    if (i % 4 == 1) look.clearcoat = uniform(0, 1);
    const double theta = i % 3 == 1 ? uniform(85, 89.5) : uniform(0, 85);
    const bool back = look.spec_trans > 0 && i % 2 == 1;
    return {"random", material(look), from_angles(back ? 180 - theta : theta, uniform(0, 360))};
}

/// The index of refraction of the side of wo / that of the side of wi, where wo is refracted.
double eta_path(const Case& c) { return c.wi.z > 0 ? c.p.eta : 1 / c.p.eta; }

/// The angle to the normal of directions refracted by a facet that stands upright: there |wi.z| =
/// eta_path |wo.z|. Facets face the normal's side, so wo lies on one side of this angle only, and
/// the density jumps there. Nothing without transmission and where no angle is.
std::optional<double> refraction_limit(const Case& c) {
    const double cosine = std::abs(c.wi.z) / eta_path(c);
    if (!c.p.has_spec_trans || cosine >= 1) return std::nullopt;
    return std::acos(cosine);
}

/// Rings about the normal where a lobe may be cut by the horizon: quadrature over rings about the
/// mirror direction would straddle the jump there. A lobe that grazes is narrow in azimuth, by
/// alpha times the cosine.
Axes axes_of_random(const Case& c) {
    const Direction z{0, 0, 1};
    Axes axes = axes_of(c);
    const double cosine = std::min(std::abs(axes.first.z), std::abs(axes.second.z));
    if (cosine >= 0.1) return axes;
    axes = {z, -z, Direction{-c.wi.x, -c.wi.y, 0}, refraction_limit(c)};
    return axes;
}

TEST(Sampling, PrincipledOfAnyConfigurationFollowsItsDensity) {
    std::uint32_t seed = 0;
    for (std::uint32_t i = 0; i < 24; ++i) {
        const Case c = random_case(i);
        const DrawnDirections drawn =
            draw(kRandomSampling, principled_sampler<double>(c), axes_of_random(c), seed += 10);
        EXPECT_TRUE(accepted(kRandomSampling, fmt::format("configuration {}", i),
                             fit_of(drawn, principled_density(c)).p_value))
            << "roughness " << c.p.roughness << ", cosine " << c.wi.z;
        if (c.p.has_spec_trans) continue;
        const Density reversed = [&](const Direction& wo) { return pdf_principled(c.p, wo, c.wi); };
        EXPECT_TRUE(rejected(kRandomSampling, "density of the reversed pair",
                             fit_of(drawn, reversed).p_value))
            << "configuration " << i;
    }
}

constexpr std::uint32_t kGrazingCases = 24;

/// Rough glass, met at 85 to 89.5 degrees: the first half of the cases from outside, the others
/// from inside.
Case random_grazing_glass(std::uint32_t i) {
    RandomSource random{seed_of(kGrazingGlass, 500000 + i)};
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random.next());
    };
    Look look;
    look.roughness = std::sqrt(std::pow(10.0, uniform(-1.5, 0)));
    look.spec_trans = uniform(0.5, 1);
    look.eta = uniform(1.1, 2);
    if (i % 2 == 1) look.anisotropic = uniform(0, 1);
    const double theta = uniform(85, 89.5);
    const bool back = i >= kGrazingCases / 2;
    return {"grazing glass", material(look),
            from_angles(back ? 180 - theta : theta, uniform(0, 360))};
}

TEST(Sampling, GlassAtGrazingAnglesFollowsItsDensity) {
    for (std::uint32_t i = 0; i < kGrazingCases; ++i) {
        const Case c = random_grazing_glass(i);
        const DrawnDirections drawn =
            draw(kGrazingGlass, principled_sampler<double>(c), axes_of_random(c), 20 * i + 10);
        EXPECT_TRUE(accepted(kGrazingGlass, fmt::format("configuration {}", i),
                             fit_of(drawn, principled_density(c)).p_value))
            << "roughness " << c.p.roughness << ", cosine " << c.wi.z << ", eta " << c.p.eta;
        Case smoother = c;
        smoother.p.roughness *= 0.9;
        EXPECT_TRUE(rejected(kGrazingGlass, "roughness 10 % smaller",
                             fit_of(drawn, principled_density(smoother)).p_value))
            << "configuration " << i;
        const Density inverse = [&](const Direction& wo) {
            const double eta4 = std::pow(eta_path(c), wo.z * c.wi.z < 0 ? 4 : 0);
            return pdf_principled(c.p, c.wi, wo) / eta4;
        };
        EXPECT_TRUE(rejected(kGrazingGlass, "1 / eta in the Jacobian of refraction",
                             fit_of(drawn, inverse).p_value))
            << "configuration " << i;
    }
}

TEST(Sampling, DiffuseFollowsItsDensity) {
    const DiffuseParameters<double> p{{0.5, 0.5, 0.5}};
    const Direction wi = from_angles(70, 30), z{0, 0, 1};
    const Sampler sampler = [&](const std::array<double, 4>& u) -> std::optional<Direction> {
        const auto s = sample_diffuse(p, wi, {u[0], u[1]});
        return s.proper ? std::optional(s.wo_local) : std::nullopt;
    };
    const Density density = [&](const Direction& wo) { return pdf_diffuse(p, wi, wo); };
    const DrawnDirections drawn = draw(kDiffuseSampling, sampler, {z, -z}, 0);
    const FitResult fit = fit_of(drawn, density);
    EXPECT_TRUE(accepted(kDiffuseSampling, "cosine", fit.p_value));
    EXPECT_NEAR(fit.total, 1, 1e-4);
    const Density uniform = [](const Direction& wo) {
        return wo.z > 0 ? 0.5 / std::numbers::pi : 0.0;
    };
    EXPECT_TRUE(
        rejected(kDiffuseSampling, "density without its cosine", fit_of(drawn, uniform).p_value));
    EXPECT_FALSE(sample_diffuse(p, -wi, {0.5, 0.5}).proper);
}

/// As the BSDF draws them: from behind, those that the opposite direction sees.
Sampler visible_sampler(const Ggx<double>& ggx, const Direction& v) {
    return [ggx, up = v.z > 0 ? v : -v](const std::array<double, 4>& u) {
        return std::optional(sample_ggx_visible(ggx, up, {u[0], u[1]}));
    };
}

Density visible_density(const Ggx<double>& ggx, const Direction& v) {
    return [ggx, v](const Direction& h) { return h.z > 0 ? pdf_ggx_visible(ggx, v, h) : 0.0; };
}

Sampler gtr1_sampler(double alpha) {
    return [alpha](const std::array<double, 4>& u) {
        return std::optional(sample_gtr1(alpha, Vec2<double>{u[0], u[1]}));
    };
}

Density gtr1_density(double alpha) {
    return [alpha](const Direction& h) { return pdf_gtr1(alpha, h); };
}

/// Facet normals; that the visible ones add up to 1 is the weak white furnace: the integral of D G1
/// |v.h| is |v.z|.
TEST(Sampling, FacetNormalsFollowTheirDensities) {
    const Direction z{0, 0, 1};
    std::uint32_t seed = 0;
    const auto draw_facets = [&](const Sampler& sampler) {
        return draw(kFacetSampling, sampler, {z, -z}, seed += 10);
    };
    for (const auto& [ax, ay] : {std::pair{0.5, 0.5}, {0.0025, 0.0025}, {0.8, 0.1}, {0.03, 0.3}}) {
        for (const double theta : {0.0, 40.0, 75.0, 89.0}) {
            const Ggx<double> ggx{ax, ay};
            const Direction v = from_angles(theta, 65);
            const DrawnDirections drawn = draw_facets(visible_sampler(ggx, v));
            const FitResult result = fit_of(drawn, visible_density(ggx, v));
            EXPECT_TRUE(accepted(kFacetSampling, fmt::format("GGX {} {} {}", ax, ay, theta),
                                 result.p_value));
            EXPECT_NEAR(result.total, 1, 1e-3) << ax << " " << ay << " " << theta;
            const Density plain = [&](const Direction& h) {
                return h.z > 0 ? ggx_d(ggx, h) * h.z : 0.0;
            };
            // The two densities differ by the order of alpha.
            if (theta == 0 || ay < 0.1) continue;
            EXPECT_TRUE(rejected(kFacetSampling, "all normals in place of the visible",
                                 fit_of(drawn, plain).p_value));
        }
    }
    for (const double alpha : {0.1, 0.01, 0.001}) {
        const DrawnDirections drawn = draw_facets(gtr1_sampler(alpha));
        EXPECT_TRUE(accepted(kFacetSampling, fmt::format("GTR1 {}", alpha),
                             fit_of(drawn, gtr1_density(alpha)).p_value));
        EXPECT_TRUE(rejected(kFacetSampling, "alpha of GTR1 20 % larger",
                             fit_of(drawn, gtr1_density(1.2 * alpha)).p_value));
    }
}

/// Facets of any roughness that materials can have, and a direction that sees them: every other one
/// from behind, every third grazes.
struct RandomFacets {
    Ggx<double> ggx;
    Direction v;
    double gtr1_alpha = 0;
};

RandomFacets random_facets(std::uint32_t i) {
    RandomSource random{seed_of(kRandomFacetSampling, 500000 + i)};
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random.next());
    };
    PrincipledParameters<double> p;
    p.roughness = std::sqrt(std::pow(10.0, uniform(-3, 0)));
    p.anisotropic = i % 4 < 2 ? uniform(0.2, 1) : 0;
    const double theta = i % 3 == 1 ? uniform(85, 89.9) : uniform(0, 85);
    const Direction v = from_angles(i % 2 == 1 ? 180 - theta : theta, uniform(0, 360));
    return {principled_ggx(p), v, std::pow(10.0, uniform(-3, -0.3))};
}

TEST(Sampling, FacetNormalsOfAnyConfigurationFollowTheirDensities) {
    const LedgerEntry& entry = kRandomFacetSampling;
    const Direction z{0, 0, 1};
    std::uint32_t seed = 0;
    const auto draw_facets = [&](const Sampler& sampler) {
        return draw(entry, sampler, {z, -z}, seed += 10);
    };
    for (std::uint32_t i = 0; i < 24; ++i) {
        const auto [ggx, v, alpha] = random_facets(i);
        const std::string text = fmt::format("alpha {:.3g} {:.3g}, cosine {:.3g}, GTR1 {:.3g}",
                                             ggx.alpha_x, ggx.alpha_y, v.z, alpha);
        const DrawnDirections drawn = draw_facets(visible_sampler(ggx, v));
        EXPECT_TRUE(accepted(entry, fmt::format("GGX, configuration {}", i),
                             fit_of(drawn, visible_density(ggx, v)).p_value))
            << text;
        const Ggx<double> rougher{1.1 * ggx.alpha_x, 1.1 * ggx.alpha_y};
        EXPECT_TRUE(rejected(entry, "alpha of GGX 10 % larger",
                             fit_of(drawn, visible_density(rougher, v)).p_value))
            << text;
        if (ggx.alpha_x != ggx.alpha_y) {
            const Ggx<double> exchanged{ggx.alpha_y, ggx.alpha_x};
            EXPECT_TRUE(rejected(entry, "alpha_x and alpha_y exchanged",
                                 fit_of(drawn, visible_density(exchanged, v)).p_value))
                << text;
        }
        if (i % 3 != 0) continue;
        const DrawnDirections gtr1 = draw_facets(gtr1_sampler(alpha));
        EXPECT_TRUE(accepted(entry, fmt::format("GTR1, configuration {}", i),
                             fit_of(gtr1, gtr1_density(alpha)).p_value))
            << text;
        EXPECT_TRUE(rejected(entry, "alpha of GTR1 20 % larger",
                             fit_of(gtr1, gtr1_density(1.2 * alpha)).p_value))
            << text;
    }
}

}  // namespace
}  // namespace burnish::test
