// Block capitals of 5 x 7 pixels, for relief and textures alike.
#pragma once

#include <string_view>

namespace burnish::procedural {

/// Pixels from the left of one letter to the left of the next.
inline constexpr int kLetterAdvance = 6;
inline constexpr int kLetterHeight = 7;

/// How much of (x, y) a line of text covers, in [0, 1], with rounded corners: x in pixels from the
/// left of the text, y in pixels from its top. Letters other than those of kLetters (lettering.cpp)
/// are blank.
double lettering(std::string_view text, double x, double y);

}  // namespace burnish::procedural
