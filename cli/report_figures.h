// Pictures with captions and colour keys, as HTML.
#pragma once

#include <string>

#include "image/image.h"

namespace burnish {

/// `more` stands behind the name.
std::string figure(const std::string& name, const std::string& more, const Image& image, bool srgb);

/// Of false_color from 0 to white.
std::string color_key(float white, const std::string& meaning);

std::string loss_text(double loss);

}  // namespace burnish
