// Lists in messages.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace burnish {

/// "a, b, c": what `of` says of each; a function, or a member that is a text.
template <class Range, class Of>
std::string joined(const Range& all, const Of& of, std::string_view separator = ", ") {
    std::string text;
    std::string_view before;
    for (const auto& each : all) {
        text += before;
        text += std::invoke(of, each);
        before = separator;
    }
    return text;
}

}  // namespace burnish
