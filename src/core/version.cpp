#include "core/version.h"

namespace burnish {

std::string version() { return BURNISH_VERSION; }

std::string compiler() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#else
    return "GCC " __VERSION__;
#endif
}

std::string instruction_set() {
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && \
    defined(__AVX512DQ__) && defined(__AVX512VL__)
    return "x86-64-v4";
#elif defined(__AVX2__) && defined(__FMA__) && defined(__BMI2__)
    return "x86-64-v3";
#elif defined(__SSE4_2__) && defined(__POPCNT__)
    return "x86-64-v2";
#elif defined(__x86_64__)
    return "x86-64";
#elif defined(__aarch64__)
    return "aarch64";
#else
    return "another processor";
#endif
}

std::string version_text() {
    return "burnish " + version() + " (" + compiler() + ", Embree " +
           std::to_string(BURNISH_EMBREE_MAJOR) + ", " + instruction_set() + ")";
}

}  // namespace burnish
