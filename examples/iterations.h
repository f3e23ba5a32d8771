// The number of iterations on the command line of an example.
#pragma once

#include <burnish/burnish.h>

#include <charconv>
#include <cstdint>
#include <string>

/// Throws burnish::InputError: the text is no whole number from 1.
inline std::uint32_t iterations_of(const std::string& text) {
    std::uint32_t iterations = 0;
    const char* end = text.data() + text.size();
    const auto [read, error] = std::from_chars(text.data(), end, iterations);
    if (error != std::errc() || read != end || iterations == 0)
        throw burnish::InputError(
            "ITERATIONS: expected a whole number from 1 to 4294967295, found '" + text + "'");
    return iterations;
}
