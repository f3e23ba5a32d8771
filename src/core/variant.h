// Exhaustive dispatch over closed sets of kinds.
#pragma once

#include <utility>
#include <variant>

namespace burnish {

/// One function object out of several, chosen by overload resolution.
template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

/// Calls the function for the alternative that the variant holds. One function for each
/// alternative, none of them generic: an alternative without a function does not compile.
template <class Variant, class... F>
constexpr decltype(auto) match(Variant&& variant, F&&... functions) {
    return std::visit(Overloaded{std::forward<F>(functions)...}, std::forward<Variant>(variant));
}

}  // namespace burnish
