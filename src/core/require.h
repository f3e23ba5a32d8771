// What bad input must meet.
#pragma once

#include <string>

#include "burnish/error.h"

namespace burnish {

/// Throws InputError with the message where it does not hold.
inline void require(bool holds, const std::string& message) {
    if (!holds) throw InputError(message);
}

}  // namespace burnish
