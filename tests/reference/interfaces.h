// The small scene with a floor of each kind of interface, all of whose inputs may be unknown.
#pragma once

#include "gradient/small_scene.h"
#include "shading/rough_plastic.h"

namespace burnish::test {

struct FloorKind {
    const char* name;
    Bsdf bsdf;
    int unknown_inputs = 0;  ///< places that textures of unknowns can have: colours and scalars
};

inline PrincipledThin sheet() {
    PrincipledThin b;
    const float constants[kThinScalars]{0.5f, 0.4f, 0.4f, 0.3f, 0.5f, 0.6f, 0.3f, 0.7f};
    for (std::size_t k = 0; k < kThinScalars; ++k) b.scalars[k].constant = constants[k];
    b.base_color.constant = {0.8f, 0.5f, 0.4f};
    b.rates = {1.0f, 0.7f, 1.2f, 0.9f};
    return b;
}

inline std::vector<FloorKind> interface_floors() {
    const MetalIndex gold{{0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.2f}};
    const ColorInput reddish{{0.8f, 0.5f, 0.4f}, {}}, bright{{0.7f, 0.9f, 0.8f}, {}};
    const std::array<ScalarInput, 2> alpha{{{0.4f, {}}, {0.3f, {}}}};
    using enum FacetShape;
    const RoughPlastic rough_plastic{{reddish, bright}, 1.5f, false, kGgx, 0.3f, {}, 0};
    RoughPlastic nonlinear = rough_plastic;
    nonlinear.nonlinear = true, nonlinear.shape = kBeckmann;
    return {
        {"rough metal, GGX", RoughConductor{bright, gold, {kGgx, false, alpha}}, 2},
        {"rough metal, Beckmann", RoughConductor{bright, gold, {kBeckmann, false, alpha}}, 2},
        {"anisotropic metal", RoughConductor{bright, gold, {kBeckmann, true, alpha}}, 3},
        {"rough plastic", make_rough_plastic(rough_plastic), 2},
        {"nonlinear rough plastic", make_rough_plastic(nonlinear), 2},
        {"rough glass", RoughDielectric{{bright, reddish}, 1.5f, {kGgx, false, alpha}}, 3},
        {"rough glass, Beckmann",
         RoughDielectric{{bright, reddish}, 1.3f, {kBeckmann, true, alpha}}, 4},
        {"sheet", sheet(), 9},
    };
}

/// Kinds with delta lobes: none of their inputs can be unknown.
inline std::vector<FloorKind> smooth_floors() {
    const MetalIndex gold{{0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.2f}};
    const ColorInput reddish{{0.8f, 0.5f, 0.4f}, {}}, bright{{0.7f, 0.9f, 0.8f}, {}};
    return {
        {"mirror", Conductor{bright, gold}},
        {"plastic", Plastic{{reddish, bright}, 1.5f, false}},
        {"nonlinear plastic", Plastic{{reddish, bright}, 1.3f, true}},
        {"glass", Dielectric{{bright, reddish}, 1.5f, false}},
        {"pane", Dielectric{{bright, reddish}, 1.5f, true}},
    };
}

/// The place of the input with that number.
inline int place_of(const Bsdf& bsdf, int input) {
    const auto colors = static_cast<int>(colors_of(bsdf).size());
    return input < colors ? 3 * input : 3 * colors + input - colors;
}

}  // namespace burnish::test
