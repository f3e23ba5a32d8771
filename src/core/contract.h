// Contracts: conditions that only a defect of the program can break. A broken one prints the
// condition, its operands and its place, and ends the program; bad input is an InputError instead.
#pragma once

#include <string>
#include <type_traits>

namespace burnish {

/// Prints "file:line: contract broken: condition (operands)" and aborts.
[[noreturn]] void contract_broken(const char* file, int line, const char* condition,
                                  const std::string& operands);

namespace detail {

template <class T>
std::string operand_text(const T& x) {
    if constexpr (std::is_enum_v<T>)
        return std::to_string(static_cast<std::underlying_type_t<T>>(x));
    else if constexpr (std::is_pointer_v<T>)
        return x ? "an object" : "null";
    else
        return std::to_string(x);
}
inline std::string operand_text(std::nullptr_t) { return "null"; }

}  // namespace detail

}  // namespace burnish

/// BURNISH_REQUIRE(count, <=, kMax): in every build. For conditions per batch, run or call, whose
/// cost does not show.
#define BURNISH_REQUIRE(left, op, right)                                                      \
    do {                                                                                      \
        const auto& left_operand = (left);                                                    \
        const auto& right_operand = (right);                                                  \
        if (!(left_operand op right_operand)) [[unlikely]]                                    \
            ::burnish::contract_broken(__FILE__, __LINE__, #left " " #op " " #right,          \
                                       ::burnish::detail::operand_text(left_operand) + ", " + \
                                           ::burnish::detail::operand_text(right_operand));   \
    } while (false)
