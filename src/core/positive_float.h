// Numbers above 0 that single precision holds with all of its bits.
#pragma once

#include <limits>

namespace burnish {

inline bool is_positive_float(double value) {
    return value >= double{std::numeric_limits<float>::min()} &&
           value <= double{std::numeric_limits<float>::max()};
}
/// In messages.
inline constexpr const char* kPositiveFloat = "a number from 1.2e-38 to 3.4e38";

}  // namespace burnish
