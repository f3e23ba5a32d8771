// Texts in UTF-8.
#pragma once

#include <cstddef>
#include <string_view>

namespace burnish {

/// The bytes of the character with which a text that is not empty begins; 0: it begins with none.
inline std::size_t character_size(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const unsigned first = byte(0), second = byte(1);
    const std::size_t size = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
    for (std::size_t i = 1; i < size; ++i)
        if ((byte(i) & 0xC0) != 0x80) return 0;
    const bool is_longer_than_needed =
        (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
    const bool is_surrogate = first == 0xED && second >= 0xA0;
    const bool is_beyond_unicode = first == 0xF4 && second >= 0x90;
    return is_longer_than_needed || is_surrogate || is_beyond_unicode ? 0 : size;
}

/// The bytes with which a text begins that are UTF-8: all of them where it is.
inline std::size_t utf8_prefix(std::string_view text) {
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t size = character_size(text.substr(at));
        if (size == 0) break;
        at += size;
    }
    return at;
}

}  // namespace burnish
