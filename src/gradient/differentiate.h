// Path records -> derivatives by the texels that they touch: no rays, no random numbers, a pure
// function of (record, theta, adjoint).
#pragma once

#include <array>
#include <span>

#include "gradient/binding.h"
#include "paths/light_paths.h"
#include "render/film.h"

namespace burnish {

/// One texel of one unknown: the parameters pi_i of its channels share reservoirs.
struct TexelKey {
    std::uint32_t slot = 0;   ///< index into Theta::textures
    std::uint32_t texel = 0;  ///< y * width + x
    friend auto operator<=>(const TexelKey&, const TexelKey&) = default;
};

/// g(x) / pdf of one path at one texel [PR eq. 5, 14].
struct TexelDerivative {
    TexelKey key;
    float q = 0;  ///< signed target value / pdf
    Rgbf g;  ///< derivative of the loss by each channel of the texel / pdf; one-channel textures
             ///< use x
};

/// The most texels that one path reaches: four corners for each input of a BSDF, one of which at
/// least is a colour and takes three places, and for each of its shares.
inline constexpr int kMaxTexelsPerPath = 4 * int{kBsdfInputs - kBsdfColor + 1 + kMaxShares};

struct TexelDerivatives {
    Rgbf adjoint;  ///< w(x); black where nothing is differentiated
    int count = 0;
    std::array<TexelDerivative, kMaxTexelsPerPath> items;
};

/// What differentiation reads, besides the record.
struct DerivativeInput {
    const Binding* binding = nullptr;
    const Image* normalized_adjoint = nullptr;
    const PassTaps* taps = nullptr;  ///< of every film pass that a record names
    TargetFunction target = TargetFunction::kLuminance;
};

/// Each texel that a path reaches once, in order of its first appearance. Entries with q = 0 and
/// g = 0 are left out.
void differentiate(const DerivativeInput& input, const PathRecord& record, TexelDerivatives& out);

/// At one vertex of a path that others scatter, too. others: what they make of its light, the
/// product of their f. The record's radiance is in the target as the mean of its channels'
/// magnitudes, which is positive: its color may depend on densities of birth, and must not enter
/// the ratio of two targets of a path (paths/light_paths.h). TargetFunction::kIntegrand: the sum of
/// the magnitudes of the terms of g, so that g / q is bounded.
void differentiate(const DerivativeInput& input, const PathRecord& record, const Rgbf& others,
                   TexelDerivatives& out);

/// f of a vertex under the textures, shares of blends included.
Rgbf scattered(const Binding& binding, const PathVertex& vertex);

/// The entry of one texel, zero where the record does not touch it. others: the other vertices that
/// scatter its path; empty for direct light.
TexelDerivative differentiate_at(const DerivativeInput& input, const PathRecord& record,
                                 TexelKey key);
TexelDerivative differentiate_at(const DerivativeInput& input, const PathRecord& record,
                                 std::span<const PathVertex> others, TexelKey key);

}  // namespace burnish
