// How far a number of a printed table may be from the one that made its row.
#pragma once

#include <cmath>

namespace burnish::test {

inline constexpr double kHalfUlp = 0x1p-24;

/// Half a unit in the seventh digit, and two ulps.
inline double printed_step(double x) {
    return 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(x))) - 6) +
           4 * kHalfUlp * std::abs(x);
}

}  // namespace burnish::test
