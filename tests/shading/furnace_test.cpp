// White furnace: of the light that arrives evenly from everywhere, a colourless material sends no
// more to the camera than arrives, and nearly all of it when smooth. Glass, metal and what lies
// between, both sides, any roughness, grazing too.
//
// What the sampler draws, divided by its density (which tests of its own hold against the sampler),
// is an estimate of the albedo
//
//   R + eta'^2 T,    R = integral of f |cos_o| over the side of wi,    T = over the other side,
//
// eta' the index behind the surface over that before it: f is of radiance, which refraction
// compresses by 1 / eta'^2, while energy is kept. Facets hide each other (single scattering), so
// that a rough material loses some.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ledger_entries.h"
#include "shading/principled.h"
#include "sphere_integral.h"
#include "student.h"

namespace burnish::test {
namespace {

using namespace ledger;

struct Material {
    const char* name;
    double eta = 1.5, metallic = 0, spec_trans = 1, anisotropic = 0;
};
constexpr Material kMaterials[] = {
    {"glass 1.5", 1.5},
    {"glass 1.33", 1.33},
    {"glass 1.7", 1.7},
    {"bubble 1 / 1.5", 1 / 1.5},
    {"anisotropic glass", 1.5, 0, 1, 1},
    {"half metal, half glass", 1.5, 0.5, 1},
    {"metal", 1.5, 1, 0},
};
/// alpha = max(0.001, roughness^2).
constexpr double kRoughness[] = {0.02, 0.1, 0.3, 0.6, 1};
constexpr double kDegrees[] = {0, 25, 50, 75, 88};

/// What `kSmooth` and less may lose under 50 degrees and less: masking takes about
/// alpha^2 tan^2 / 4 from each direction.
constexpr double kSmooth = 0.1, kSmoothLoss = 0.01;

PrincipledParameters<double> parameters_of(const Material& material, double roughness) {
    PrincipledParameters<double> p;
    p.base_color = {1, 1, 1};
    p.roughness = roughness;
    p.eta = material.eta;
    p.metallic = material.metallic;
    p.spec_trans = material.spec_trans;
    p.anisotropic = material.anisotropic;
    p.has_spec_trans = material.spec_trans > 0;
    return p;
}

/// wi, the degrees counted from the normal of its own side.
Direction direction(double degrees, bool front) {
    const double theta = degrees * std::numbers::pi / 180, phi = 0.7;
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
            front ? std::cos(theta) : -std::cos(theta)};
}

/// f |cos_o| scaled to energy.
using Energy = double (*)(const PrincipledParameters<double>&, const Direction& wi,
                          const Direction& wo);

double index_behind(const PrincipledParameters<double>& p, const Direction& wi) {
    return wi.z > 0 ? p.eta : 1 / p.eta;
}

double energy(const PrincipledParameters<double>& p, const Direction& wi, const Direction& wo) {
    const double f = eval_principled(p, wi, wo).y;
    const double eta = index_behind(p, wi);
    return wi.z * wo.z > 0 ? f : f * eta * eta;
}

RunningMean albedo(const PrincipledParameters<double>& p, const Direction& wi, std::uint32_t seed,
                   Energy energy_of = energy) {
    RunningMean mean;
    for (std::uint32_t i = 0; i < scaled(kFurnace, 20000u); ++i) {
        const auto u = detail::uniforms_double(seed_of(kFurnace, seed), i);
        const auto s = sample_principled(p, wi, Vec2<double>{u[0], u[1]}, u[2]);
        const double pdf = s.proper ? pdf_principled(p, wi, s.wo_local) : 0;
        mean.add(pdf > 0 ? energy_of(p, wi, s.wo_local) / pdf : 0);
    }
    return mean;
}

/// Of a sum in double.
constexpr double kRounding = 1e-9;

/// All directions of a material together.
struct PValues {
    std::vector<double> at_most_all, nearly_all;
};

PValues p_values(const Material& material, double roughness, std::uint32_t seed,
                 Energy energy_of = energy) {
    const auto p = parameters_of(material, roughness);
    PValues result;
    for (const bool front : {true, false})
        for (const double degrees : kDegrees) {
            const MeanEstimate m =
                estimate_of(albedo(p, direction(degrees, front), seed++, energy_of));
            result.at_most_all.push_back(not_above_p_value(m, {1 + kRounding, 0}));
            // Metal is black on the back.
            if (roughness <= kSmooth && degrees <= 50 && (front || material.metallic == 0))
                result.nearly_all.push_back(not_above_p_value({1 - kSmoothLoss, 0}, m));
        }
    return result;
}

TEST(Furnace, NoMoreLeavesThanArrivesAndNearlyAllWhenSmooth) {
    std::uint32_t seed = 0;
    for (const Material& material : kMaterials) {
        std::vector<double> nearly_all;
        for (const double roughness : kRoughness) {
            const PValues p = p_values(material, roughness, seed += 10);
            EXPECT_TRUE(accepted(
                kFurnace, fmt::format("{}, roughness {}: at most all", material.name, roughness),
                holm_minimum(p.at_most_all)));
            nearly_all.insert(nearly_all.end(), p.nearly_all.begin(), p.nearly_all.end());
        }
        EXPECT_TRUE(accepted(kFurnace, fmt::format("{}, smooth: nearly all", material.name),
                             holm_minimum(nearly_all)));
    }
}

/// Radiance where energy is meant: the scale by the squared index is missing.
double radiance(const PrincipledParameters<double>& p, const Direction& wi, const Direction& wo) {
    return eval_principled(p, wi, wo).y;
}

/// Refraction without its 1 - F.
double refracts_all(const PrincipledParameters<double>& p, const Direction& wi,
                    const Direction& wo) {
    const auto g = principled_geometry(wi, wo, p.eta);
    return energy(p, wi, wo) / (wi.z * wo.z > 0 ? 1 : 1 - g.fresnel);
}

/// Reflection without its F.
double reflects_all(const PrincipledParameters<double>& p, const Direction& wi,
                    const Direction& wo) {
    const auto g = principled_geometry(wi, wo, p.eta);
    return energy(p, wi, wo) / (wi.z * wo.z > 0 ? g.fresnel : 1);
}

TEST(Furnace, DefectsAreRejected) {
    std::uint32_t seed = 5000;
    const auto expect_rejected = [&](const char* defect, double p_value, double roughness) {
        EXPECT_TRUE(rejected(kFurnace, defect, p_value)) << "roughness " << roughness;
    };
    const Material& glass = kMaterials[0];
    // Rougher glass loses more light than these defects add.
    for (const double roughness : {0.02, 0.1, 0.3}) {
        const auto at_most_all = [&](Energy defect) {
            return holm_minimum(p_values(glass, roughness, seed += 10, defect).at_most_all);
        };
        expect_rejected("radiance taken for energy", at_most_all(radiance), roughness);
        expect_rejected("refraction without 1 - F", at_most_all(refracts_all), roughness);
        expect_rejected("reflection without F", at_most_all(reflects_all), roughness);
    }
    for (const double roughness : {0.02, 0.1}) {
        expect_rejected("radiance taken for energy",
                        holm_minimum(p_values(glass, roughness, seed += 10, radiance).nearly_all),
                        roughness);
    }
}

}  // namespace
}  // namespace burnish::test
