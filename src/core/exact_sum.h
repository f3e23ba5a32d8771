// A sum of floats that is the same in whatever order they are added.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace burnish {

/// A sum in fixed point: limb k counts units of 2^(24 k - 96). Exact for up to 2^29 values; what
/// they have below 2^-96 or above 2^72 is lost. Sums of parts are added limb by limb.
struct ExactSum {
    static constexpr std::size_t kLimbs = 7;
    std::array<double, kLimbs> limbs{};
};

/// How many units of a limb make one of the next.
inline constexpr double kUnitsOfNextLimb = 0x1p24;
/// The unit of the last limb.
inline constexpr double kLastUnit = 0x1p48;

/// value: >= 0.
inline void add(float value, ExactSum& sum) {
    double rest = std::min(double{value} / kLastUnit, kUnitsOfNextLimb);  // in units of the limb
    for (std::size_t k = ExactSum::kLimbs; k-- > 0 && rest > 0; rest *= kUnitsOfNextLimb) {
        const double units = std::floor(rest);
        sum.limbs[k] += units;
        rest -= units;
    }
}

inline double value_of(const ExactSum& sum) {
    double value = 0, unit = kLastUnit;
    for (std::size_t k = ExactSum::kLimbs; k-- > 0; unit /= kUnitsOfNextLimb)
        value += sum.limbs[k] * unit;
    return value;
}

}  // namespace burnish
