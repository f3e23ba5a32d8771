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
    for (const auto& each : all) {
        if (!text.empty()) text += separator;
        text += std::invoke(of, each);
    }
    return text;
}

}  // namespace burnish
