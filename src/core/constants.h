// Constants in the precision of light transport; std::numbers has them in double.
#pragma once

#include <limits>
#include <numbers>

namespace burnish {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace burnish
