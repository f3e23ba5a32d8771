// What functions say where they fail.
#pragma once

#include <string>

#include "burnish/error.h"

namespace burnish::test {

/// The message of the E that a function throws; empty where it throws nothing.
template <class E = InputError, class Body>
std::string error_of(const Body& body) {
    try {
        body();
    } catch (const E& error) {
        return error.what();
    }
    return {};
}

}  // namespace burnish::test
