#include "core/contract.h"

#include <cstdio>
#include <cstdlib>

namespace burnish {

void contract_broken(const char* file, int line, const char* condition,
                     const std::string& operands) {
    std::fprintf(stderr, "%s:%d: contract broken: %s (%s)\n", file, line, condition,
                 operands.c_str());
    std::abort();
}

}  // namespace burnish
