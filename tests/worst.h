// The largest of many differences, as tests bound it.
#pragma once

#include <cmath>

namespace burnish::test {

/// The larger one; not a number where either is not. std::max would leave such a difference out.
template <typename T>
T worse(T worst, T difference) {
    return worst >= difference || std::isnan(worst) ? worst : difference;
}

}  // namespace burnish::test
