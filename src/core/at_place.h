// Errors of input with the place where it stands.
#pragma once

#include <string>

#include "burnish/error.h"

namespace burnish {

/// Returns body(). Its InputErrors begin with the place, unless that is empty.
template <class Body>
auto at_place(const std::string& place, const Body& body) {
    try {
        return body();
    } catch (const InputError& e) {
        if (place.empty()) throw;
        throw InputError(place + ": " + e.what());
    }
}

}  // namespace burnish
