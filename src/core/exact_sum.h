// A sum of floats that is the same in whatever order they are added.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace burnish {

/// A sum in fixed point: limb k counts units of 2^(24 k - 96). Exact for up to 2^29 values; what
/// they have below 2^-96 or above 2^24 is lost. Sums of parts are added limb by limb.
struct ExactSum {
    static constexpr std::size_t kLimbs = 5;
    std::array<double, kLimbs> limbs{};
};

/// 2^(24 k - 96)
inline double unit_of_limb(std::size_t k) { return std::ldexp(1.0, 24 * static_cast<int>(k) - 96); }

/// value: >= 0.
inline void add(float value, ExactSum& sum) {
    double rest = std::min(double{value}, std::ldexp(1.0, 24));
    for (std::size_t k = ExactSum::kLimbs; k-- > 0;) {
        const double units = std::floor(rest / unit_of_limb(k));
        sum.limbs[k] += units;
        rest -= units * unit_of_limb(k);
    }
}

inline double value_of(const ExactSum& sum) {
    double value = 0;
    for (std::size_t k = ExactSum::kLimbs; k-- > 0;) value += sum.limbs[k] * unit_of_limb(k);
    return value;
}

}  // namespace burnish
