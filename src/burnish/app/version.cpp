#include "burnish/app/version.h"

namespace burnish {

std::string version() { return BURNISH_VERSION; }

std::string compiler() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#else
    return "GCC " __VERSION__;
#endif
}

std::string version_text() {
    return "burnish " + version() + " (" + compiler() + ", Embree " +
           std::to_string(BURNISH_EMBREE_MAJOR) + ")";
}

}  // namespace burnish
