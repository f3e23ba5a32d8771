// What is UTF-8, by the table of well-formed bytes of the Unicode standard.
#include "core/utf8.h"

#include <gtest/gtest.h>

#include <string>

namespace burnish {
namespace {

TEST(Utf8, CharactersOfEverySize) {
    for (const char* text :
         {"", "scene", "\x7F", "\xC2\x80", "caf\xC3\xA9", "\xDF\xBF", "\xE0\xA0\x80",
          "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "a\xF4\x8F\xBF\xBFz"})
        EXPECT_EQ(utf8_prefix(text), std::string_view(text).size()) << text;
    EXPECT_EQ(utf8_prefix(std::string(2, '\0')), 2u);
}

TEST(Utf8, EndsWhereBytesAreNoCharacter) {
    for (const char* bytes :
         {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xC2", "\xC2z", "\xC2\xC2", "\xE9 ",
          "\xE0\x9F\xBF", "\xE2\x82", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF", "\xF0\x9F\x98",
          "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFE\xFF", "\xFF\xFE"})
        EXPECT_EQ(utf8_prefix(std::string("ab\xC3\xA9") + bytes), 4u) << bytes;
}

}  // namespace
}  // namespace burnish
