// The name of an ICC profile: its tag `desc`, a text in ASCII (version 2) or UTF-16 (version 4).
// Nothing else of it is read.
#include <algorithm>

#include "core/bytes.h"
#include "image/formats.h"

namespace burnish {

namespace {

constexpr std::size_t kHeader = 128, kTag = 12;

/// Of 32 bits.
std::size_t number(std::string_view bytes, std::size_t at) {
    return number_at(bytes, at, 4, std::endian::big);
}

std::string_view part(std::string_view bytes, std::size_t at, std::size_t size) {
    return at < bytes.size() ? bytes.substr(at, size) : std::string_view();
}

/// A character that can be shown; others as a question mark.
char shown(char c) { return c >= ' ' && c <= '~' ? c : '?'; }

/// Up to a zero.
std::string of_utf16(std::string_view units) {
    std::string text;
    for (std::size_t i = 0; i + 1 < units.size() && (units[i] != 0 || units[i + 1] != 0); i += 2)
        text += units[i] == 0 ? shown(units[i + 1]) : '?';
    return text;
}

std::string text_of(std::string_view tag) {
    if (tag.starts_with("mluc")) {
        constexpr std::size_t kRecord = 16;  // language, length, offset
        const std::size_t offset = number(tag, kRecord + 8);
        if (offset <= kRecord) return {};
        return of_utf16(part(tag, offset, number(tag, kRecord + 4)));
    }
    if (!tag.starts_with("desc")) return {};
    const std::string_view text = part(tag, 12, number(tag, 8));
    std::string name(text.substr(0, text.find('\0')));
    std::ranges::transform(name, name.begin(), shown);
    return name;
}

}  // namespace

std::string formats::profile_name(std::string_view icc) {
    constexpr std::size_t kMaxShown = 80;
    const std::size_t count = number(icc, kHeader);
    for (std::size_t i = 0, at = kHeader + 4; i < count && at + kTag <= icc.size(); ++i, at += kTag)
        if (icc.substr(at, 4) == "desc")
            return text_of(part(icc, number(icc, at + 4), number(icc, at + 8)))
                .substr(0, kMaxShown);
    return {};
}

}  // namespace burnish
