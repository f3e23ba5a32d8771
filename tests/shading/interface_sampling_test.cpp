// BSDFs of interfaces: samplers against their densities (chi-square), and the light that they send
// on. Where a delta lobe is sampled there is no density: these samples count as failures, whose
// probability is what the density lacks to 1.
#include <gtest/gtest.h>

#include "ledger_entries.h"
#include "shading/bsdf.h"
#include "shading/rough_plastic.h"
#include "sphere_integral.h"
#include "student.h"

namespace burnish::test {
namespace {

using ledger::kInterfaceEnergy;
using ledger::kInterfaceSampling;

struct InterfaceCase {
    const char* name;
    Bsdf bsdf;
    BsdfInputs<double> inputs;
    double degrees = 0;   ///< of wi to the normal; above 90 from behind
    bool smooth = false;  ///< next to no light is lost between facets that hide each other
};

RoughConductor metal(FacetShape shape, bool anisotropic = false) {
    return {kWhite, {{0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.2f}}, {shape, anisotropic, {}}};
}
/// Colours, then alpha.
BsdfInputs<double> metal_inputs(double alpha_u, double alpha_v = 0) {
    return {1, 1, 1, alpha_u, alpha_v};
}
Plastic smooth_plastic(bool nonlinear = false) {
    Plastic b;
    b.eta = 1.5f, b.nonlinear = nonlinear;
    return b;
}
RoughPlastic plastic(FacetShape shape, float alpha) {
    RoughPlastic b;
    b.eta = 1.5f, b.shape = shape, b.alpha = alpha;
    return make_rough_plastic(b);
}

RoughDielectric glass(FacetShape shape, bool anisotropic = false) {
    return {{kWhite, kWhite}, 1.5f, {shape, anisotropic, {}}};
}
BsdfInputs<double> glass_inputs(double alpha_u, double alpha_v = 0) {
    return {1, 1, 1, 1, 1, 1, alpha_u, alpha_v};
}

/// A rough, anisotropic sheet.
BsdfInputs<double> sheet_inputs(double spec_trans, double diff_trans) {
    return {0.8, 0.5, 0.3, 0.5, 0.4, spec_trans, 0.3, 0.2, 0.5, 0.2, diff_trans};
}
PrincipledThin sheet_with_rates() {
    PrincipledThin b;
    b.rates = {0.5f, 2.0f, 1.0f, 3.0f};
    return b;
}

PrincipledThin textured_sheet() {
    PrincipledThin b;
    for (const ThinScalar s : {ThinScalar::kSpecTrans, ThinScalar::kDiffTrans})
        b.scalars[static_cast<std::size_t>(s)].texture = {0};
    return b;
}
RoughPlastic textured_plastic() {
    RoughPlastic b = plastic(FacetShape::kBeckmann, 0.1f);
    b.colors[0].texture = b.colors[1].texture = {0};
    return b;
}

std::vector<InterfaceCase> interface_cases() {
    using enum FacetShape;
    const BsdfInputs<double> colors{0.7, 0.4, 0.2, 1, 1, 1};
    return {
        {"metal, GGX", metal(kGgx), metal_inputs(0.3), 40},
        {"metal, Beckmann", metal(kBeckmann), metal_inputs(0.3), 40},
        {"smooth metal, Beckmann", metal(kBeckmann), metal_inputs(0.02), 60, true},
        {"anisotropic metal, GGX", metal(kGgx, true), metal_inputs(0.1, 0.4), 50},
        {"anisotropic metal, Beckmann", metal(kBeckmann, true), metal_inputs(0.5, 0.1), 30},
        {"grazing metal, Beckmann", metal(kBeckmann), metal_inputs(0.4), 85},
        {"smooth metal, grazing, Beckmann", metal(kBeckmann), metal_inputs(0.1), 85},
        {"smooth plastic", smooth_plastic(), colors, 60, true},
        {"plastic, GGX", plastic(kGgx, 0.2f), colors, 45},
        {"plastic, Beckmann", plastic(kBeckmann, 0.1f), colors, 70},
        {"glass, GGX", glass(kGgx), glass_inputs(0.3), 40},
        {"glass, Beckmann", glass(kBeckmann), glass_inputs(0.2), 55},
        {"glass from inside", glass(kGgx), glass_inputs(0.2), 150},
        {"glass from inside, Beckmann", glass(kBeckmann), glass_inputs(0.3), 120},
        {"smooth glass from inside, Beckmann", glass(kBeckmann), glass_inputs(0.05), 134, true},
        {"anisotropic glass", glass(kGgx, true), glass_inputs(0.4, 0.1), 20},
        {"sheet", PrincipledThin{}, sheet_inputs(0.5, 0.6), 40},
        {"sheet from behind", PrincipledThin{}, sheet_inputs(0.4, 1.4), 130},
        {"specular sheet", PrincipledThin{}, sheet_inputs(1, 0), 60},
        {"matt sheet", sheet_with_rates(), sheet_inputs(0.2, 0.8), 75},
        {"sheet of textures", textured_sheet(), sheet_inputs(0, 0), 40},
        {"sheet of textures, all light through", textured_sheet(), sheet_inputs(1, 2), 50},
        {"plastic of textures, black base", textured_plastic(), {0, 0, 0, 1, 1, 1}, 45},
        {"plastic of textures, black interface", textured_plastic(), {1, 1, 1, 0, 0, 0}, 45},
    };
}

Direction wi_of(double degrees) {
    const double t = degrees * std::numbers::pi / 180;
    return {std::sin(t) * std::cos(0.4), std::sin(t) * std::sin(0.4), std::cos(t)};
}

SampledDirection<double> drawn_of(const InterfaceCase& c, const std::array<double, 4>& u) {
    return std::visit(
        [&](const auto& b) {
            return sample_bsdf(bsdf_parameters(b, c.inputs), wi_of(c.degrees), {u[0], u[1]}, u[2]);
        },
        c.bsdf);
}

double pdf_of(const InterfaceCase& c, const Direction& wo) {
    return std::visit(
        [&](const auto& b) { return pdf_bsdf(bsdf_parameters(b, c.inputs), wi_of(c.degrees), wo); },
        c.bsdf);
}

Direction value_of(const InterfaceCase& c, const Direction& wo) {
    return std::visit(
        [&](const auto& b) {
            return eval_bsdf(bsdf_parameters(b, c.inputs), wi_of(c.degrees), wo);
        },
        c.bsdf);
}

DrawnDirections draw(const InterfaceCase& c, std::uint32_t seed) {
    const Sampler sampler = [&](const std::array<double, 4>& u) -> std::optional<Direction> {
        const auto drawn = drawn_of(c, u);
        if (!drawn.proper || drawn.delta) return std::nullopt;
        return drawn.wo_local;
    };
    const Direction wi = wi_of(c.degrees), mirror{-wi.x, -wi.y, wi.z};
    Axes axes{mirror, -mirror};
    if (const auto* b = std::get_if<RoughDielectric>(&c.bsdf)) {
        const auto eta = static_cast<double>(b->eta);
        axes.second = normalize(refract(wi, Direction{0, 0, 1}, fresnel_dielectric(wi.z, eta)));
    }
    if (std::holds_alternative<PrincipledThin>(c.bsdf)) axes.second = -wi;
    if (std::abs(mirror.z) < 0.1)  // the lobe is cut by the horizon
        axes = {{0, 0, 1}, {0, 0, -1}, Direction{-wi.x, -wi.y, 0}};
    return draw_directions(sampler, axes, seed_of(kInterfaceSampling, seed),
                           scaled(kInterfaceSampling, 200000u));
}

TEST(InterfaceSampling, FollowsItsDensity) {
    std::uint32_t seed = 0;
    for (const InterfaceCase& c : interface_cases()) {
        const Density density = [&](const Direction& wo) { return pdf_of(c, wo); };
        const DrawnDirections drawn = draw(c, seed += 10);
        const FitResult fit = fit_of(drawn, density);
        EXPECT_LE(fit.total, 1 + 1e-4) << c.name;
        EXPECT_TRUE(accepted(kInterfaceSampling, c.name, fit.p_value)) << fit.total;
        const Density higher = [&](const Direction& wo) { return 1.03 * pdf_of(c, wo); };
        EXPECT_TRUE(
            rejected(kInterfaceSampling, "density times 1.03", fit_of(drawn, higher).p_value))
            << c.name;
        InterfaceCase other = c;
        other.degrees += 4;
        const Density turned = [&](const Direction& wo) { return pdf_of(other, wo); };
        EXPECT_TRUE(rejected(kInterfaceSampling, "density of another direction",
                             fit_of(drawn, turned).p_value))
            << c.name;
    }
}

/// Where a texture holds the value that takes a lobe away, its derivative needs samples still.
TEST(InterfaceSampling, LobesThatTexturesBringBackAreDrawn) {
    Principled principled, glassy, metallic, coated;
    principled.has_spec_trans = glassy.has_spec_trans = coated.has_clearcoat = true;
    glassy[PrincipledScalar::kSpecTrans].texture = {0};
    metallic[PrincipledScalar::kMetallic].texture = {0};
    coated[PrincipledScalar::kClearcoat].texture = {0};
    const BsdfInputs<double> opaque{0.8, 0.5, 0.3, 0.5}, black{0, 0, 0, 1, 1, 1},
        smooth_metal{0.8, 0.5, 0.3, 0, 0, 1}, smooth_glass{0.8, 0.5, 0.3, 0, 0, 0, 1};
    struct Expected {
        Bsdf without, with;
        BsdfInputs<double> inputs;
        double degrees;  ///< of a direction that this lobe has, others about never, to the normal
    };
    for (const Expected& e :
         {Expected{principled, glassy, opaque, 170},
          {principled, metallic, smooth_metal, 60},
          {principled, glassy, smooth_glass, 60},
          {principled, coated, smooth_metal, 60},
          {PrincipledThin{}, textured_sheet(), sheet_inputs(0, 0), 170},
          {plastic(FacetShape::kBeckmann, 0.1f), textured_plastic(), black, 80}}) {
        const Direction wo = wi_of(e.degrees);
        EXPECT_LT(pdf_of({"", e.without, e.inputs, 10}, wo), 1e-5) << e.with.index();
        EXPECT_GT(pdf_of({"", e.with, e.inputs, 10}, wo), 1e-4) << e.with.index();
    }
}

/// Whatever a texture holds: a delta lobe that is not drawn would be left out.
TEST(InterfaceSampling, LobesOfNegativeColorsAreDrawn) {
    for (const double color : {-0.5, 0.5}) {
        const BsdfInputs<double> inputs{0.5, 0.5, 0.5, color, color, color};
        const auto mirrored = drawn_of({"", smooth_plastic(), inputs, 50}, {0.3, 0.6, 1e-4, 0});
        ASSERT_TRUE(mirrored.delta) << color;
        EXPECT_GT(mirrored.lobe.pdf, 0.01) << color;
        EXPECT_LT(mirrored.lobe.pdf, 1) << color;
        EXPECT_GT(mirrored.lobe.f.x * color, 0);
    }
}

TEST(InterfaceSampling, NothingComesFromBehind) {
    for (InterfaceCase c : interface_cases()) {
        if (transmits(c.bsdf)) continue;
        c.degrees = 130;
        for (const double x : {0.1, 0.5, 0.9}) EXPECT_FALSE(drawn_of(c, {x, x, x, x}).proper);
        EXPECT_EQ(pdf_of(c, {0, 0, 1}), 0);
        EXPECT_EQ(pdf_of(c, {0, 0, -1}), 0);
        EXPECT_EQ(value_of(c, {0, 0, 1}).x, 0);
    }
}

/// A delta lobe as the reference samples it: degrees of wi, u_lobe, wo, probability, eta, share.
struct DeltaCase {
    InterfaceCase of;
    double u_lobe = 0;
    Direction wo;
    double pdf = 0, eta = 0;
    Direction share;
};

std::vector<DeltaCase> delta_cases() {
    const BsdfInputs<double> white{1, 1, 1, 1, 1, 1}, glassy{0.9, 0.8, 0.7, 0.6, 0.5, 0.4},
        plain{0.3, 0.5, 0.1, 0.9, 0.8, 0.7};
    const Dielectric solid{{kWhite, kWhite}, 1.5f, false}, pane{{kWhite, kWhite}, 1.5f, true},
        nothing{{kWhite, kWhite}, 1, true};
    const Conductor mirror{kWhite, metal(FacetShape::kGgx).index};
    const Direction up{-0.7055737, -0.2983118, 0.6427876}, down{up.x, up.y, -up.z};
    const double low = 1e-4, high = 1 - 1e-4;
    return {
        {{"glass", solid, glassy, 0.5},
         low,
         {-0.008037671, -0.003398273, 0.9999619},
         0.04,
         1,
         {0.036, 0.032, 0.028}},
        {{"glass", solid, glassy, 0.5},
         high,
         {-0.005358448, -0.002265515, -0.9999831},
         0.96,
         1.5,
         {0.256, 0.2133333, 0.1706667}},
        {{"glass", solid, glassy, 50},
         low,
         up,
         0.05766294,
         1,
         {0.05189664, 0.04613035, 0.04036406}},
        {{"glass", solid, glassy, 50},
         high,
         {-0.4703825, -0.1988745, -0.8597612},
         0.942337,
         1.5,
         {0.2512899, 0.2094082, 0.1675266}},
        {{"total reflection", solid, glassy, 130}, high, down, 1, 1, {0.9, 0.8, 0.7}},
        {{"glass from inside", solid, glassy, 160},
         low,
         {-0.3150214, -0.1331889, -0.9396926},
         0.04172851,
         1,
         {0.03755566, 0.03338281, 0.02920996}},
        {{"glass from inside", solid, glassy, 160},
         high,
         {-0.4725322, -0.1997834, 0.8583705},
         0.9582715,
         1 / 1.5,
         {1.293667, 1.078055, 0.8624444}},
        {{"pane", pane, glassy, 50}, low, up, 0.1090384, 1, {0.09813456, 0.08723072, 0.07632688}},
        {{"pane", pane, glassy, 50}, high, down, 0.8909616, 1, {0.534577, 0.4454808, 0.3563846}},
        {{"pane", pane, glassy, 130},
         low,
         down,
         0.1090384,
         1,
         {0.09813456, 0.08723072, 0.07632688}},
        {{"pane", pane, glassy, 130}, high, up, 0.8909616, 1, {0.534577, 0.4454808, 0.3563846}},
        {{"mirror", mirror, glassy, 50}, low, up, 1, 1, {0.8541114, 0.4936079, 0.3711089}},
        {{"plastic", smooth_plastic(), plain, 50},
         low,
         up,
         0.1402857,
         1,
         {0.05189664, 0.04613035, 0.04036405}},
        {{"nothing", nothing, white, 50}, low, down, 1, 1, {1, 1, 1}},
        {{"nothing", nothing, white, 130}, high, up, 1, 1, {1, 1, 1}},
    };
}

TEST(InterfaceSampling, DeltaLobesAreThoseOfTheReference) {
    const auto expect_near = [](const Direction& a, const Direction& b, const char* name) {
        EXPECT_NEAR(a.x, b.x, 2e-6) << name;
        EXPECT_NEAR(a.y, b.y, 2e-6) << name;
        EXPECT_NEAR(a.z, b.z, 2e-6) << name;
    };
    for (const DeltaCase& c : delta_cases()) {
        const auto drawn = drawn_of(c.of, {0.3, 0.6, c.u_lobe, 0});
        EXPECT_TRUE(drawn.proper && drawn.delta) << c.of.name;
        expect_near(drawn.wo_local, c.wo, c.of.name);
        expect_near(drawn.lobe.f, c.share, c.of.name);
        EXPECT_NEAR(drawn.lobe.pdf, c.pdf, 2e-6) << c.of.name;
        EXPECT_NEAR(drawn.eta, c.eta, 2e-6) << c.of.name;
        if (std::holds_alternative<Plastic>(c.of.bsdf)) continue;  // has another lobe
        EXPECT_EQ(pdf_of(c.of, drawn.wo_local), 0);
        EXPECT_EQ(value_of(c.of, drawn.wo_local).x, 0);
    }
}

/// What leaves towards the camera of even light, in the brightest channel; and the largest value
/// over density.
struct MeanEnergy {
    RunningMean mean;
    RunningMean radiance;  ///< of the same light, as refraction compresses it
    double largest = 0;
};

MeanEnergy energy_of(const InterfaceCase& c, std::uint32_t seed) {
    MeanEnergy energy;
    for (std::uint32_t i = 0; i < scaled(kInterfaceEnergy, 40000u); ++i) {
        const auto u = detail::uniforms_double(seed_of(kInterfaceEnergy, seed), i);
        const auto drawn = drawn_of(c, u);
        double radiance = 0;
        if (drawn.proper) {
            const Direction f = drawn.delta ? drawn.lobe.f : value_of(c, drawn.wo_local);
            const double pdf = drawn.delta ? drawn.lobe.pdf : pdf_of(c, drawn.wo_local);
            radiance = pdf > 0 ? std::max({f.x, f.y, f.z}) / pdf : 0;
        }
        const double weight = radiance * drawn.eta * drawn.eta;
        energy.mean.add(weight);
        energy.radiance.add(radiance);
        energy.largest = std::max(energy.largest, weight);
    }
    return energy;
}

/// Facets of metal and glass are drawn as they are seen: what a sample carries is masking, at most
/// 1 and the error of Beckmann's fit. Larger weights multiply where light bounces many times.
TEST(InterfaceSampling, NoSampleOfFacetsCarriesMoreThanArrives) {
    for (InterfaceCase c : interface_cases()) {
        if (!std::holds_alternative<RoughConductor>(c.bsdf) &&
            !std::holds_alternative<RoughDielectric>(c.bsdf))
            continue;
        for (std::size_t i = 0; i < first_scalar(c.bsdf); ++i) c.inputs[i] = 1;
        for (const double degrees : {0.0, 30.0, 60.0, 80.0, 88.0, 92.0, 120.0, 150.0}) {
            if (degrees > 90 && !transmits(c.bsdf)) continue;
            c.degrees = degrees;
            EXPECT_LE(energy_of(c, 5000).largest, 1.005) << c.name << ", " << degrees << " degrees";
        }
    }
}

bool refracts(const Bsdf& bsdf) {
    const auto* plain = std::get_if<Dielectric>(&bsdf);
    return std::holds_alternative<RoughDielectric>(bsdf) || (plain && !plain->thin);
}

TEST(InterfaceSampling, NoMoreLeavesThanArrives) {
    std::uint32_t seed = 0;
    auto cases = interface_cases();
    cases.push_back({"mirror", Conductor{}, {}, 0, true});
    cases.push_back({"glass", Dielectric{{kWhite, kWhite}, 1.5f, false}, {}, 0, true});
    cases.push_back({"pane", Dielectric{{kWhite, kWhite}, 1.5f, true}, {}, 0, true});
    for (InterfaceCase c : cases) {
        for (std::size_t i = 0; i < first_scalar(c.bsdf); ++i) c.inputs[i] = 1;
        if (std::holds_alternative<PrincipledThin>(c.bsdf))
            continue;  // retro-reflection adds light
        const auto at_most = [](const RunningMean& mean, double bound) {
            return not_above_p_value(estimate_of(mean), {bound, 0});
        };
        std::vector<double> p_values, brighter, compressed;
        for (const double degrees : {0.0, 30.0, 60.0, 80.0, 88.0, 92.0, 120.0, 150.0}) {
            if (degrees > 90 && !transmits(c.bsdf)) continue;
            c.degrees = degrees;
            const MeanEnergy energy = energy_of(c, seed += 10);
            // The fits of what a smooth interface reflects inside err by 0.3 %.
            p_values.push_back(at_most(energy.mean, 1.003));
            brighter.push_back(at_most(larger_by(1.1, energy.mean), 1.003));
            compressed.push_back(at_most(energy.radiance, 1.003));
            EXPECT_LE(energy.largest, 4) << c.name << ", " << degrees << " degrees";
        }
        EXPECT_TRUE(accepted(kInterfaceEnergy, c.name, holm_minimum(p_values)));
        const auto expect_rejected = [&](const char* defect, const std::vector<double>& p) {
            EXPECT_TRUE(rejected(kInterfaceEnergy, defect, holm_minimum(p))) << c.name;
        };
        if (c.smooth) expect_rejected("a tenth more leaves", brighter);
        if (refracts(c.bsdf)) expect_rejected("radiance taken for energy", compressed);
    }
}

}  // namespace
}  // namespace burnish::test
