#include "shading/rough_plastic.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "shading/facets.h"
#include "shading/fresnel.h"

namespace burnish {

namespace {

struct Node {
    double x, weight;
};

/// Gauss-Legendre nodes in [0, 1]: the roots of the Legendre polynomial by Newton's method.
std::vector<Node> gauss_legendre(int nodes) {
    std::vector<Node> all;
    for (int i = 0; i < nodes; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (nodes + 0.5)), slope = 1;
        for (int step = 0; step < 8; ++step) {
            double p = 1, before = 0;
            for (int n = 0; n < nodes; ++n) {
                const double next = ((2 * n + 1) * x * p - n * before) / (n + 1);
                before = std::exchange(p, next);
            }
            slope = nodes * (x * p - before) / (x * x - 1);
            x -= p / slope;
        }
        all.push_back({0.5 * (1 - x), 1 / ((1 - x * x) * slope * slope)});
    }
    return all;
}

/// A point of the unit disk and its share of the integral over it.
struct DiskNode {
    Vec2<double> point;
    double weight;
};

/// Nodes of a square, mapped to the disk ring by ring [Shirley and Chiu 1997]. Half of them: the
/// others are their mirror images.
std::vector<DiskNode> concentric_nodes(int side) {
    std::vector<DiskNode> all;
    for (const Node& a : gauss_legendre(side))
        for (const Node& b : gauss_legendre(side)) {
            const double x = 2 * a.x - 1, y = 2 * b.x - 1;
            const bool flat = std::abs(x) > std::abs(y);
            const double r = flat ? x : y, turn = std::numbers::pi / 4 * (flat ? y / x : x / y);
            const Vec2<double> p = flat ? Vec2<double>{r * std::cos(turn), r * std::sin(turn)}
                                        : Vec2<double>{r * std::sin(turn), r * std::cos(turn)};
            if (p.x < 0) all.push_back({p, 2 * a.weight * b.weight});
        }
    return all;
}

/// The same in polar coordinates: smooth in azimuth, where few nodes do.
std::vector<DiskNode> polar_nodes(int distances, int turns) {
    std::vector<DiskNode> all;
    for (const Node& r : gauss_legendre(distances))
        for (const Node& turn : gauss_legendre(turns)) {
            const double phi = std::numbers::pi * (0.5 + turn.x);
            all.push_back(
                {{r.x * std::cos(phi), r.x * std::sin(phi)}, 2 * r.x * r.weight * turn.weight});
        }
    return all;
}

/// GGX by the nodes of the reference, whose error is 1e-3 where light from inside is reflected
/// totally; Beckmann's, whose nodes are less simple, up to 5e-5 from the reference.
const std::vector<DiskNode>& disk_nodes(bool beckmann, bool outside) {
    static const std::array<std::vector<DiskNode>, 4> all{
        concentric_nodes(128), concentric_nodes(32), polar_nodes(96, 48), polar_nodes(48, 24)};
    return all[(beckmann ? 2 : 0) + (outside ? 1 : 0)];
}

/// Shares of light from outside or inside that facets send on once and others do not hide.
struct Passed {
    double reflected = 0, transmitted = 0;
};

/// eta: of the other side, over that of the light.
Passed pass(const Facets<double>& facets, double cosine, double eta) {
    const double mu = std::max(1e-6, cosine);
    const Vec3<double> wi{std::sqrt(1 - mu * mu), 0, mu};
    Passed sum;
    double weights = 0;  // 1, but for the fit of Beckmann's masking
    for (const DiskNode& node : disk_nodes(facets.beckmann, eta > 1)) {
        const Vec3<double> h = ggx_visible_normal(facets.ggx, wi, node.point);
        double weight = node.weight;
        if (facets.beckmann)
            weight *= facet_d(facets, h) * facet_g1(facets, wi) /
                      (ggx_d(facets.ggx, h) * ggx_g1(facets.ggx, wi, h));
        weights += weight;
        const auto fresnel = fresnel_dielectric(dot(wi, h), eta);
        const Vec3<double> mirrored = reflect(wi, h), refracted = refract(wi, h, fresnel);
        if (mirrored.z > 0)
            sum.reflected += weight * fresnel.reflectance * facet_g1(facets, mirrored);
        if (refracted.z < 0)
            sum.transmitted += weight * (1 - fresnel.reflectance) * facet_g1(facets, refracted);
    }
    return {sum.reflected / weights, sum.transmitted / weights};
}

}  // namespace

RoughPlastic make_rough_plastic(RoughPlastic bsdf) {
    const double beckmann = bsdf.shape == FacetShape::kBeckmann ? 1 : 0,
                 alpha = static_cast<double>(bsdf.alpha), eta = static_cast<double>(bsdf.eta);
    const Facets<double> facets = make_facets(alpha, alpha, beckmann);
    double inside = 0;
    for (std::size_t i = 0; i < kTransmittances; ++i) {
        const double cosine = static_cast<double>(i) / (kTransmittances - 1);
        bsdf.transmittance[i] = static_cast<float>(pass(facets, cosine, eta).transmitted);
        inside += 2 * cosine * pass(facets, cosine, 1 / eta).reflected / kTransmittances;
    }
    bsdf.internal_reflectance = static_cast<float>(inside);
    return bsdf;
}

}  // namespace burnish
