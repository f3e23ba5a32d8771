#include "core/contract.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

TEST(ContractDeathTest, ABrokenContractPrintsItsOperands) {
    const int size = 3;
    BURNISH_REQUIRE(size, <=, 3);
    EXPECT_DEATH(BURNISH_REQUIRE(size, >, 4),
                 "contract_test.cpp:[0-9]+: contract broken: size > 4 \\(3, 4\\)");
    const float* none = nullptr;
    EXPECT_DEATH(BURNISH_REQUIRE(none, !=, nullptr), "none != nullptr \\(null, null\\)");
}

}  // namespace
}  // namespace burnish
